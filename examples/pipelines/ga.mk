# The same as rules: make -f ga.mk RUN=runs/rules -j8. Killed, it continues where it was.
RUN := runs/rules
TASK := Walker-v0

$(RUN)/best.json: $(RUN)/scores-2.jsonl
	evo-select --keep 1 $< -o $@

$(RUN)/population-0.jsonl:
	mkdir -p $(RUN)
	evo-sample -n 6 --seed 1 -o $@
$(RUN)/population-1.jsonl: $(RUN)/scores-0.jsonl
	$(call breed,0)
$(RUN)/population-2.jsonl: $(RUN)/scores-1.jsonl
	$(call breed,1)

$(RUN)/scores-%.jsonl: $(RUN)/population-%.jsonl
	evo-train --task $(TASK) --steps 8192 --seed 1 --out-dir $(RUN)/policies --resume $< -o $@

breed = evo-select --keep 3 $< -o $(RUN)/survivors.jsonl && \
  evo-convert --to ids $(RUN)/population-*.jsonl -o $(RUN)/seen.txt && \
  evo-mutate -n 3 --seed $(1) --avoid $(RUN)/seen.txt $(RUN)/survivors.jsonl -o $(RUN)/children.jsonl && \
  evo-convert $(RUN)/survivors.jsonl $(RUN)/children.jsonl -o $@
