# A run whose trainings happen elsewhere: something stands in front of each, which may kill it.
load helpers

@test "100 slots, a heavy tail, launches that are killed: nothing is lost, nothing done twice" {
  # Takes some hundredths of a second, as a heavy tail wants, by the robot's id.
  cat > fitness <<'END'
#!/bin/bash
read -r robot
[[ $robot =~ \"id\":\"([0-9a-f]{12})\" ]]
id=${BASH_REMATCH[1]}
number=$((16#${id:0:6}))
sleep 0.0$((1000 / (number % 97 + 3)))
echo "$id" >> scored
echo "${robot%\}},\"fitness\":$number}"
END
  # One launch in twenty is killed before it has begun, or in the middle.
  cat > launch <<'END'
#!/bin/bash
case $((RANDOM % 40)) in
  0) exit 1 ;;
  1) "$@" & sleep 0.05; kill -KILL $! 2> /dev/null; wait $!; exit 137 ;;
esac
exec "$@"
END
  chmod +x fitness launch
  evo-evolve ga --run calm --pop 30 --evals 130 --window 60 --seed 1 --evaluate "$PWD/fitness" --plan -q
  cp -r calm stormy
  mkdir calm-place stormy-place
  sed -i "s#cd [^&]* &&#cd $PWD/calm-place \\&\\&#" calm/Makefile
  sed -i "s#cd [^&]* &&#cd $PWD/stormy-place \\&\\&#" stormy/Makefile
  make -s -C calm -j100
  make -s -C stormy -j100 LAUNCH="$PWD/launch"
  diff calm/history.jsonl stormy/history.jsonl
  [ "$(wc -l < calm/history.jsonl)" -eq 130 ]
  [ "$(sort calm-place/scored | uniq -d | wc -l)" -eq 0 ]
  [ "$(sort -u stormy-place/scored | wc -l)" -eq 130 ]
  [ -z "$(find calm stormy -name '*.running')" ]
}
