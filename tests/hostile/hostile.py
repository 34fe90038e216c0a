#!/usr/bin/python3
"""Feeds damaged files, endless ones and senseless options to every tool and looks how it ends.

    hostile.py [--runs N] [--first K] [--seed S] [--jobs J] [--keep DIR]

How a run has to end: docs/hostile.md. Runs are numbered from 0, or from K; --only N
does one again, and --keep leaves the damaged files of failures in a folder. The tools
are found in $EVO_BIN, the data in $EVO_SOURCE.
"""
import argparse
import contextlib
import multiprocessing
import os
import random
import shutil
import signal
import sys
import tempfile
import threading
import typing

import mutate
import options
import readers
import valid

SECONDS = 20.0  # of processor time: what runs on and on, however slow the machine
KILOBYTES = 200_000
PATIENCE = 120  # s of wall time until a run counts as hanging
RUN_KINDS = {".h5": "hdf5", ".json": "json", ".jsonl": "json"}


class Endless(typing.NamedTuple):
    name: str
    piece: bytes


class Suite:
    def __init__(self, folder, seed):
        self.folder = folder
        self.seed = seed
        self.options = list(options.cases())
        random.Random(seed).shuffle(self.options)
        self.endless = list(readers.endless())
        random.Random(seed).shuffle(self.endless)
        self.weights = [row[4] for row in readers.READERS]
        valid = os.path.join(folder, "valid")
        self.run = sorted(os.path.relpath(os.path.join(place, name), valid)
                          for place, _, names in os.walk(os.path.join(valid, "run")) for name in names)

    def plan(self, number):
        """Command, file with its damaged bytes or what it repeats or none, statuses."""
        if number % 3 == 2:
            words = self.options[number // 3 % len(self.options)]
            return words, None, options.STATUSES
        if number % 6 == 3 and number // 6 < len(self.endless):
            words, name, piece = self.endless[number // 6]
            return words, Endless(name, piece), readers.ENDLESS
        generator = random.Random(f"{self.seed}/{number}")
        file, kind, words, statuses, _ = generator.choices(readers.READERS, self.weights)[0]
        if kind == "run":
            file = generator.choice(self.run)
            kind = RUN_KINDS.get(os.path.splitext(file)[1], "text")
            if generator.random() < 0.2:
                return words, (file, generator.choice(["gone", "folder", "pipe"])), statuses
        with open(os.path.join(self.folder, "valid", file), "rb") as source:
            data = source.read()
        for _ in range(generator.choice([1, 1, 1, 2, 3])):
            try:
                data = generator.choice(mutate.KINDS[kind])(generator, data)
            except (OSError, ValueError, RuntimeError, LookupError, TypeError, OverflowError):
                pass  # already damaged beyond what h5py can change
        return words, (file, data), statuses


def execute(words, feed, patience):
    """Status (negative: signal), processor seconds, kilobytes, hanging, stderr."""
    with open("stderr", "w+b") as errors, open(feed or os.devnull, "rb") as source, \
            open("stdout", "wb") as output:
        child = os.posix_spawnp(words[0], words, os.environ, file_actions=[
            (os.POSIX_SPAWN_DUP2, source.fileno(), 0), (os.POSIX_SPAWN_DUP2, output.fileno(), 1),
            (os.POSIX_SPAWN_DUP2, errors.fileno(), 2)])
        hanging = []

        def end(*_):
            hanging.append(True)
            os.kill(child, signal.SIGKILL)

        signal.signal(signal.SIGALRM, end)
        signal.alarm(patience)
        _, status, used = os.wait4(child, 0)
        signal.alarm(0)
        errors.seek(0)
        code = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
        return code, used.ru_utime + used.ru_stime, used.ru_maxrss, bool(hanging), errors.read()


def fault_of(code, seconds, kilobytes, hanging, words, statuses):
    if hanging:
        return f"no end after {PATIENCE} s"
    if code < 0:
        return f"signal {-code}"
    if code != 0 and code not in statuses:
        return f"status {code}"
    if seconds > SECONDS:
        return f"{seconds:.1f} s of processor time"
    if kilobytes > KILOBYTES:
        return f"{kilobytes // 1000} MB"
    try:
        text = words.decode()
    except UnicodeDecodeError:
        return "bytes that are not UTF-8 on standard error"
    if any(ord(c) < 32 and c != "\n" or 127 <= ord(c) < 160 for c in text):
        return "control characters on standard error"
    said = [line for line in text.splitlines() if ": warning: " not in line]
    if code != 0 and len(said) != 1:
        return f"{len(said)} lines on standard error"
    if "unexpected failure" in text:
        return "an unexpected failure"
    return None


def clean():
    for entry in os.scandir("."):
        if entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry.path)
        elif entry.name != "valid":
            os.unlink(entry.path)


def lay_out(file, data):
    """The damaged file in the current folder, or the run that it belongs to. Its name."""
    name = target = "input" + os.path.splitext(file)[1]
    if file.startswith("run/"):
        name = "run"
        target = file
        shutil.copytree(os.path.realpath("valid/run"), name)
        os.unlink(target)
    if data == "folder":
        os.mkdir(target)
    elif data == "pipe":
        os.mkfifo(target)
    elif data != "gone":
        with open(target, "wb") as output:
            output.write(data)
    return name


@contextlib.contextmanager
def endless(name, piece):
    """A pipe that gives the piece again and again until its reader is gone; a device is there."""
    stop = threading.Event()

    def feed():
        with contextlib.suppress(BrokenPipeError), open(name, "wb", buffering=0) as out:
            while not stop.is_set():
                out.write(piece * (65536 // len(piece)))

    if not piece:
        yield name
        return
    os.mkfifo(name)
    writer = threading.Thread(target=feed)
    writer.start()
    yield name
    stop.set()
    os.close(os.open(name, os.O_RDONLY | os.O_NONBLOCK))  # a tool that never opened it leaves its writer waiting
    writer.join()


def attempt(number):
    """A fault, or nothing."""
    words, damaged, statuses = suite.plan(number)
    with contextlib.ExitStack() as stack:
        name = None
        if isinstance(damaged, Endless):
            name = stack.enter_context(endless(*damaged))
        elif damaged:
            name = lay_out(*damaged)
        feed = name if "<" in words else None
        words = [word.replace("{}", name) if name else word for word in words if word != "<"]
        code, seconds, kilobytes, hanging, said = execute(words, feed, PATIENCE)
    fault = fault_of(code, seconds, kilobytes, hanging, said, statuses)
    if fault:
        repeated = isinstance(damaged, Endless)
        fault = f"run {number}: {words}: {fault}: {said[:300]!r}" + (f", fed {damaged.piece!r}" if repeated else "")
        if keep and damaged and not repeated:
            copy = shutil.copytree if os.path.isdir(name) else shutil.copy
            copy(name, os.path.join(keep, f"{number}-{name}"))
    clean()
    return fault


def enter(folder, seed, kept):
    global suite, keep
    suite, keep = Suite(folder, seed), kept
    place = tempfile.mkdtemp(dir=folder)
    os.symlink(os.path.join(folder, "valid"), os.path.join(place, "valid"))
    os.chdir(place)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", type=int)
    parser.add_argument("--keep")
    asked = parser.parse_args()
    os.environ["PATH"] = os.environ["EVO_BIN"] + ":" + os.environ["PATH"]
    os.environ.pop("MAKELEVEL", None)
    kept = os.path.abspath(asked.keep) if asked.keep else None
    if kept:
        os.makedirs(kept, exist_ok=True)
    numbers = [asked.only] if asked.only is not None else range(asked.first, asked.first + asked.runs)
    with tempfile.TemporaryDirectory() as folder:
        valid.make(os.path.join(folder, "valid"), os.environ["EVO_SOURCE"])
        with multiprocessing.Pool(asked.jobs, enter, (folder, asked.seed, kept)) as pool:
            faults = list(filter(None, pool.imap_unordered(attempt, numbers, chunksize=20)))
    for fault in faults:
        print(fault)
    print(f"{len(numbers)} runs, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
