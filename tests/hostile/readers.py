"""Which tool reads which file, and how it may end when the file is damaged.

A row: file, kind of damage (mutate.KINDS), command, statuses, weight.
{} in a command is the damaged file, or the run with it; "<" feeds it to standard input. Status 0 is
always possible: damage need not show. 65 is bad data; others are listed where
the content can ask for them: 1 a simulation that diverges or work that cannot
be done, 2 a name in the file that means nothing here, 66 a file that it names.

Each command is given inputs without an end, too: devices and pipes.
"""
import os

CALLS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "calls.py")
SHORT = {
    "EVAL": "evo-eval -j1 --task Walker-v0 --max-steps 2".split(),
    "TRAIN": "evo-train -j1 --task Walker-v0 --train valid/tiny.yaml --steps 2 --out-dir policies".split(),
    "CALLS": ["/usr/bin/python3", CALLS],
}

READERS = [
    ("robots.jsonl", "json", "evo-select <", (65,), 3),
    ("robots.jsonl", "json", "evo-mutate -n 2 {}", (65, 1), 2),
    ("robots.jsonl", "json", "evo-convert {}", (65,), 1),
    ("robots.jsonl", "json", "evo-inspect {}", (65,), 1),
    ("robots.jsonl", "json", "evo-sample -n 1 --avoid {}", (65,), 1),
    ("robots.jsonl", "json", "EVAL --actions random {}", (65, 1, 2), 2),
    ("robots.jsonl", "json", "EVAL --actions random <", (65, 1, 2), 1),
    ("robots.jsonl", "json", "TRAIN {}", (65, 1, 2), 1),
    ("robots.jsonl", "json", "evo-mutate -n 1 --avoid {} valid/one.txt", (65, 1), 1),
    ("robots.jsonl", "json", "evo-neat -n 2 --state-out o.json --avoid {}", (65, 1), 1),
    ("robots.jsonl", "json", "evo-score --by cat {}", (65, 1), 1),
    ("scored.jsonl", "json", "evo-archive -q <", (65,), 1),
    ("scored.jsonl", "json", "evo-suggest -n 1 {}", (65, 1, 2), 2),
    ("scored.jsonl", "json", "evo-select --by=-voxels {}", (65,), 1),
    ("genomes.jsonl", "json", "evo-neat -n 3 --state-in valid/species.json --state-out o.json {}", (65, 1, 2), 2),
    ("robot.json", "json", "evo-inspect robot {}", (65,), 1),
    ("robots.yaml", "text", "evo-convert <", (65,), 3),
    ("letters.txt", "text", "evo-convert {}", (65,), 2),
    ("robot.npz", "binary", "evo-convert {}", (65,), 3),
    ("robot.npz", "binary", "EVAL --actions random {}", (65, 1), 1),
    ("body.npy", "binary", "evo-convert <", (65,), 1),
    ("body.npy", "binary", "evo-mutate -n 1 {}", (65, 1), 1),
    ("numbers.txt", "text", "evo-convert {}", (65,), 2),
    ("lists.json", "json", "evo-inspect {}", (65,), 1),
    ("lists.json", "json", "EVAL --actions random {}", (65, 1), 1),
    ("world.json", "json", "evo-convert {}", (65,), 2),
    ("carrier.json", "json", "evo-convert {} --to task", (65,), 2),
    ("carrier.json", "json", "evo-convert --to task < -", (65,), 1),
    ("world.json", "json", "EVAL --actions random {}", (65, 1), 1),
    ("model.zip", "binary", "evo-convert {}", (65,), 1),
    ("model.zip", "binary", "evo-eval -j1 --max-steps 2 --policy {} valid/one.txt", (65,), 1),
    ("trained.json", "json", "evo-eval -j1 {}", (65, 1, 2, 66), 1),
    ("trained.json", "json", "evo-inspect <", (65,), 1),
    ("species.json", "json", "evo-neat -n 3 --state-in {} --state-out o.json valid/genomes.jsonl", (65, 1, 2), 3),
    ("neat.yaml", "text", "evo-neat -n 3 --shape 3x3 --neat {} --state-out o.json", (65, 1, 2), 2),
    ("neat.cfg", "text", "evo-neat -n 3 --shape 3x3 --neat {} --state-out o.json", (65, 1, 2), 2),
    ("neat.cfg", "text", "evo-inspect {}", (65,), 1),
    ("task.yaml", "text", "evo-inspect task {}", (65, 66, 2), 3),
    ("task.yaml", "text", "evo-convert --task {}", (65, 66, 2), 1),
    ("task.yaml", "text", "evo-env --task {}", (65, 66, 2), 1),
    ("ramp.yaml", "text", "evo-eval -j1 --task {} --max-steps 2 --actions random valid/one.txt", (65, 66, 1, 2), 3),
    ("physics.yaml", "text", "EVAL --actions random --physics {} valid/one.txt", (65, 66, 1, 2), 2),
    ("physics.yaml", "text", "evo-inspect physics {}", (65, 66, 2), 1),
    ("physics.yaml", "text", "evo-bench --sizes 3 --seconds 0.001 --physics {}", (65, 66, 1, 2), 0.3),
    ("training.yaml", "text", "evo-inspect training {}", (65, 66, 2), 1),
    ("training.yaml", "text",
     "evo-train -j1 --task Walker-v0 --steps 512 --train {} --out-dir policies --force --train final_episodes=0 valid/one.txt",
     (65, 66, 1, 2), 2),
    ("run.yaml", "text", "evo-inspect {}", (65,), 1),
    ("actions.csv", "text", "EVAL --actions {} valid/one.txt", (65, 1, 2), 2),
    ("actions.csv", "text", "EVAL --actions - < valid/one.txt", (65, 1, 2), 1),
    ("actions.npy", "binary", "EVAL --actions {} valid/one.txt", (65, 1, 2), 2),
    ("rollout.h5", "hdf5", "EVAL --actions {} valid/one.txt", (65, 1, 2), 2),
    ("rollout.h5", "hdf5", "evo-inspect {}", (65,), 3),
    ("rollout.h5", "hdf5", "evo-convert {}", (65,), 1),
    ("rollout.h5", "hdf5", "evo-convert {} --to minari -o set", (65, 2, 73), 1),
    ("rollout.h5", "hdf5", "EVAL --actions random --draws {} valid/one.txt", (65, 2), 1),
    ("network.h5", "hdf5", "evo-eval -j1 --max-steps 2 --policy {} valid/one.txt", (65, 1, 2), 3),
    ("network.h5", "hdf5", "evo-inspect {}", (65,), 2),
    ("network.h5", "hdf5", "evo-convert --to onnx -o o.onnx {}", (65,), 1),
    ("network.h5", "hdf5", "TRAIN --init {} valid/one.txt", (65, 1, 2), 1),
    ("sine.h5", "hdf5", "evo-eval -j1 --max-steps 2 --policy {} valid/one.txt", (65, 1, 2), 2),
    ("network.h5", "hdf5", "evo-mutate -n 1 {}", (65, 1), 1),
    ("robots.jsonl", "json", "evo-render --grid --size 64x64 {} -o o.png", (65, 1, 2), 0.1),
    ("rollout.h5", "hdf5", "evo-render -j1 --strip 2 --size 64x64 {} -o o.png", (65, 1, 2), 0.1),
    ("requests.jsonl", "json", "evo-env --task Walker-v0 < valid/one.txt", (65,), 1),
    ("one.txt", "text", "CALLS {}", (), 3),
    # A run with one of its files damaged, gone, a folder or a pipe.
    ("run", "run", "evo-report -q {}", (65, 1, 2, 66), 3),
    ("run", "run", "evo-evolve --run {} --plan -q", (65, 1, 2, 66, 73), 3),
    ("run", "run", "evo-inspect --check {}", (65, 1, 2, 66), 1),
    ("run", "run", "evo-inspect --watch {}", (65, 1, 2, 66), 0),  # it may wait for the rest
    ("run", "run", "evo-render --evolution {} -o o.gif --size 64x64", (65, 1, 2, 66), 0.1),
]
READERS = [(file, kind, [full for word in command.split() for full in SHORT.get(word, [word])], statuses, weight)
           for file, kind, command, statuses, weight in READERS]

# What comes again and again. A name's ending says what a tool takes a file for.
FEEDS = {
    "zeros": b"\0",
    "yes": b"y\n",
    "numbers": b"1.0,1.0,1.0,1.0\n",
    "blanks": b" \n",
    "remarks": b"# remark\n",
    "keys": b"a: b\n",
    "brackets": b"[",
    "objects": b'{"a":',
    "HDF5": b"\x89HDF\r\n\x1a\n",
    "archive": b"PK\3\4",
    "array": b"\x93NUMPY\1\0",
    "pickle": b"\x80\4",
    "settings": b"[NEAT]\n",
    "lists": b"[[3,",
    "kinds": b"3 3 4\n",
}
ENDLESS = (1, 2, 65, 66, 73)  # statuses


def endless():
    """Every command with every input that does not end: the command, its file, what the file repeats."""
    commands = {tuple(row[2]) for row in READERS if CALLS not in row[2]}
    for words in sorted(commands):
        yield words, "/dev/zero", b""
        for kind, piece in FEEDS.items():
            endings = ["", ".h5", ".npz", ".json", ".yaml"] if "{}" in words and kind in ("zeros", "HDF5", "array") else [""]
            for ending in endings:
                yield words, "input" + ending, piece
