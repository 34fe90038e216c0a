#!/usr/bin/python3
"""Gives every input of every tool something without end: devices and pipes.

    endless.py [--every N] [--verbose]

Nothing of it is what the tool reads, so the tool must say so and end, with a
documented status and one line, before it has taken more than 200 MB or 20 s of
processor time; and it must not wait for an end that never comes. The tools are
found in $EVO_BIN, the data in $EVO_SOURCE.
"""
import argparse
import os
import sys
import tempfile
import threading

import hostile
import valid

EVAL = ["evo-eval", "-j1", "--task", "Walker-v0", "--max-steps", "2"]
RANDOM = [*EVAL, "--actions", "random"]
TRAIN = ["evo-train", "-j1", "--task", "Walker-v0", "--steps", "512", "--out-dir", "policies"]

# Commands; {} is the input, "<" gives it on standard input.
INPUTS = [
    ["evo-select", "<"],
    ["evo-select", "{}"],
    ["evo-archive", "<"],
    ["evo-archive", "{}"],
    ["evo-mutate", "-n", "1", "{}"],
    ["evo-mutate", "-n", "1", "--avoid", "{}", "valid/one.txt"],
    ["evo-sample", "-n", "1", "--avoid", "{}"],
    ["evo-suggest", "-n", "1", "{}"],
    ["evo-neat", "-n", "2", "--state-out", "o.json", "--state-in", "valid/species.json", "{}"],
    ["evo-neat", "-n", "2", "--state-out", "o.json", "--state-in", "{}", "valid/genomes.jsonl"],
    ["evo-neat", "-n", "2", "--state-out", "o.json", "--neat", "{}"],
    ["evo-neat", "-n", "2", "--state-out", "o.json", "--avoid", "{}"],
    ["evo-convert", "<"],
    ["evo-convert", "{}"],
    ["evo-convert", "--to", "npz", "-o", "o.npz", "{}"],
    ["evo-convert", "--to", "json", "{}"],
    ["evo-convert", "--to", "onnx", "-o", "o.onnx", "{}"],
    ["evo-convert", "--to", "minari", "-o", "set", "{}"],
    ["evo-convert", "--to", "task", "{}"],
    ["evo-convert", "--to", "task", "<", "-"],
    ["evo-convert", "--task", "{}"],
    ["evo-inspect", "<"],
    ["evo-inspect", "{}"],
    ["evo-inspect", "robot", "{}"],
    ["evo-inspect", "task", "{}"],
    ["evo-inspect", "physics", "{}"],
    ["evo-inspect", "training", "{}"],
    ["evo-inspect", "--check", "{}"],
    ["evo-inspect", "--watch", "{}"],
    [*RANDOM, "<"],
    [*RANDOM, "{}"],
    [*EVAL, "--policy", "{}", "valid/one.txt"],
    [*EVAL, "--actions", "{}", "valid/one.txt"],
    [*EVAL, "--actions", "-", "<", "valid/one.txt"],
    [*RANDOM, "--draws", "{}", "valid/one.txt"],
    [*RANDOM, "--physics", "{}", "valid/one.txt"],
    ["evo-eval", "-j1", "--actions", "random", "--task", "{}", "valid/one.txt"],
    [*TRAIN, "{}"],
    [*TRAIN, "--init", "{}", "valid/one.txt"],
    [*TRAIN, "--train", "{}", "valid/one.txt"],
    [*TRAIN, "--physics", "{}", "valid/one.txt"],
    ["evo-render", "<", "-o", "o.png"],
    ["evo-render", "{}", "-o", "o.png"],
    ["evo-render", "--evolution", "{}", "-o", "o.gif"],
    ["evo-report", "{}", "-o", "o.html"],
    ["evo-evolve", "--run", "{}"],
    ["evo-score", "--by", "cat", "{}"],
    ["evo-bench", "--sizes", "3", "--physics", "{}"],
    ["evo-env", "--task", "{}"],
    ["evo-env", "--task", "Walker-v0", "<", "valid/one.txt"],
]
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
ENDINGS = ["", ".h5", ".npz", ".json", ".yaml"]
STATUSES = (1, 2, 65, 66, 73)
PATIENCE = 60  # s of wall time, after which a tool waits or reads on for ever


def feed(pipe, piece, stop):
    """Writes until the reader is gone."""
    data = piece * (65536 // len(piece))
    try:
        with open(pipe, "wb", buffering=0) as out:
            while not stop.is_set():
                out.write(data)
    except BrokenPipeError:
        pass


def attempt(words, name, piece):
    """A fault, or nothing."""
    device = piece is None
    path = name if device else "input" + name
    stop = threading.Event()
    writer = None
    if not device:
        os.mkfifo(path)
        writer = threading.Thread(target=feed, args=(path, piece, stop))
        writer.start()
    given = [word.replace("{}", path) for word in words if word != "<"]
    code, seconds, kilobytes, hanging, said = hostile.execute(
        given, path if "<" in words else None, PATIENCE)
    if writer:
        # A tool that never opened the pipe leaves its writer waiting.
        stop.set()
        os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
        writer.join()
        os.unlink(path)
    fault = (f"no end after {PATIENCE} s" if hanging else
             hostile.fault_of(code, seconds, kilobytes, hanging, said, STATUSES))
    return fault and f"{given}, {name or piece}: {fault}: {said[:200]!r}"


def cases():
    for words in INPUTS:
        yield words, "/dev/zero", None
        for kind, piece in FEEDS.items():
            endings = ENDINGS if "{}" in words and kind in ("zeros", "HDF5", "array") else [""]
            for ending in endings:
                yield words, ending, piece


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--every", type=int, default=1)
    asked = parser.parse_args()
    os.environ["PATH"] = os.environ["EVO_BIN"] + ":" + os.environ["PATH"]
    runs, faults = 0, []
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        valid.make("valid", os.environ["EVO_SOURCE"])
        for words, name, piece in list(cases())[::asked.every]:
            fault = attempt(words, name, piece)
            runs += 1
            if fault:
                faults.append(fault)
                print(fault, flush=True)
            elif asked.verbose:
                print(words, name, piece, flush=True)
        os.chdir("/")
    print(f"{runs} endless inputs, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
