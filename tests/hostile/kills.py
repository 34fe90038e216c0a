#!/usr/bin/python3
"""Kills every tool that writes files, fills its disk, and takes its memory away.

    kills.py [--kills N]

A tool killed at any moment leaves its output whole or not at all, and at most a hidden
file beside it; given again, it ends with the same bytes. On a full disk it ends with 74 and
leaves nothing, without memory with 1. The tools are found in $EVO_BIN, the data in
$EVO_SOURCE. Runs are killed by tests/cli/evolve.bats.
"""
import argparse
import filecmp
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import valid

# Command, and the files it makes. @ is the folder of valid files.
TOOLS = [
    ("evo-sample -n 2000 -o o.jsonl", "o.jsonl"),
    ("evo-mutate -n 1000 @/robots.jsonl -o o.jsonl", "o.jsonl"),
    ("evo-select @/many.jsonl -o o.jsonl", "o.jsonl"),
    ("evo-suggest -q -n 5 @/scored.jsonl -o o.jsonl", "o.jsonl"),
    ("evo-neat -n 200 --state-out s.json -o o.jsonl", "s.json o.jsonl"),
    ("evo-convert @/many.jsonl -o o.yaml", "o.yaml"),
    ("evo-convert @/rollout.h5 --to minari -o set", "set"),
    ("evo-eval --task Walker-v0 --actions random @/robots.jsonl --rollout r/ -o o.jsonl", "o.jsonl"),
    ("evo-train --task Walker-v0 --steps 1280 @/one.txt --out-dir p -o o.jsonl --checkpoint-every 64 --resume"
     " --train hidden=8 --train environments=2 --train rollout=32 --train final_episodes=2", "o.jsonl p/{id}.policy.h5"),
    ("evo-render @/one.txt -o o.png", "o.png"),
    ("evo-render -j2 @/rollout.h5 --size 64x64 -o o.gif", "o.gif"),
]
faults = []


def fault(*words):
    faults.append(" ".join(map(str, words)))
    print(faults[-1], flush=True)


def same(a, b):
    if os.path.isdir(a):
        compared = filecmp.dircmp(a, b)
        return not (compared.left_only or compared.right_only or compared.diff_files)
    return filecmp.cmp(a, b, shallow=False)


def hidden(folder):
    return [name for _, folders, files in os.walk(folder) for name in folders + files
            if name.startswith(".")]


def run(words, folder, **options):
    return subprocess.run(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          **options)


def resolve(text, folder, identity):
    return [word.replace("@", folder).replace("{id}", identity) for word in text.split()]


def is_spare(name):
    """Until it is renamed, a file or a folder has a hidden name of its own."""
    return name.startswith(".set.") or name.endswith(".tmp")


def kill_tool(words, outputs, kills, folder):
    whole = tempfile.mkdtemp(dir=folder)
    start = time.monotonic()
    done = run(words, whole)
    took = time.monotonic() - start
    if done.returncode != 0:
        return fault(words, "failed:", done.stderr)
    generator = random.Random(1)
    place = tempfile.mkdtemp(dir=folder)
    signals = [signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP]
    for number in range(kills):
        child = subprocess.Popen(words, cwd=place, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL)
        try:
            child.wait(generator.random() * took)
        except subprocess.TimeoutExpired:
            child.send_signal(signals[number % len(signals)])
            child.wait()
        for output in outputs:
            path = os.path.join(place, output)
            if os.path.exists(path) and not same(path, os.path.join(whole, output)):
                fault(words, "kill", number, "left another", output)
        left = [name for name in hidden(place) if not is_spare(name)]
        if left:
            fault(words, "kill", number, "left", left)
        if number % 5 == 4:
            shutil.rmtree(place)
            os.makedirs(place)
    again = run(words, place)
    exists = b"exists already" in again.stderr
    if again.returncode != 0 and not exists:
        fault(words, "after kills:", again.returncode, again.stderr)
    for output in outputs:
        if not same(os.path.join(place, output), os.path.join(whole, output)):
            fault(words, "after kills: another", output)


def full_disk(words, outputs, folder):
    """On a file system of 8 kB, in a mount namespace of its own."""
    disk = tempfile.mkdtemp(dir=folder)
    script = ('mount -t tmpfs -o size=8k none "$0" && cd "$0" && dd if=/dev/zero of=fill bs=1k '
              '2>/dev/null; "$@" >&2; status=$?; ls -A | grep -vxF -e fill -e p -e r >&3; exit $status')
    listed, listing = os.pipe()
    done = subprocess.run(["unshare", "-m", "bash", "-c", "exec 3>&%d; %s" % (listing, script), disk,
                           *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          pass_fds=[listing])
    os.close(listing)
    left = os.read(listed, 10000).decode().split()
    os.close(listed)
    if done.returncode not in (73, 74) or done.stderr.count(b"\n") != 1:
        fault(words, "on a full disk:", done.returncode, done.stderr)
    if left:
        fault(words, "on a full disk left", left)


def no_memory(words, megabytes, folder):
    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
    done = run(words, tempfile.mkdtemp(dir=folder), preexec_fn=limit)
    # 127: not even the program's libraries fit; 74: HDF5 had none for writing.
    if done.returncode not in (0, 1, 74, 127) or (done.returncode == 1 and
                                                  done.stderr.count(b"\n") != 1):
        fault(words, f"in {megabytes} MB:", done.returncode, done.stderr[-300:])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=5)
    asked = parser.parse_args()
    os.environ["PATH"] = os.environ["EVO_BIN"] + ":" + os.environ["PATH"]
    for name in ("MAKELEVEL", "MAKEFLAGS"):
        os.environ.pop(name, None)
    mounts = subprocess.run(["unshare", "-m", "mount", "-t", "tmpfs", "none", "/mnt"],
                            stderr=subprocess.DEVNULL).returncode == 0
    with tempfile.TemporaryDirectory() as folder:
        made = os.path.join(folder, "valid")
        valid.make(made, os.environ["EVO_SOURCE"])
        with open(os.path.join(made, "many.jsonl"), "wb") as file:
            file.write(valid.run("jq", "-c", ".fitness = 1",
                                 input=valid.run("evo-sample", "-n", "1000")))
        identity = valid.run("jq", "-r", ".id", os.path.join(made, "robot.json")).decode().strip()
        for words, outputs in TOOLS:
            words, outputs = (resolve(text, made, identity) for text in (words, outputs))
            kill_tool(words, outputs, asked.kills, folder)
            if mounts:
                full_disk(words, outputs, folder)
            # The drawing library ends the process itself when it gets no memory.
            for megabytes in (20, 60, 150, 400) if words[0] != "evo-render" else ():
                no_memory(words, megabytes, folder)
    print(f"{asked.kills * len(TOOLS)} kills, {len(TOOLS) if mounts else 'no'} full disks, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
