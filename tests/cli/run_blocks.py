#!/usr/bin/env python3
"""Runs the command blocks of Markdown files, each file in a folder of its own, top
to bottom: run_blocks.py [--in-full | --update] FILE...

Blocks are those fenced as sh, each in a shell of its own, and indented lines after a
"$ " with what they print, which is compared. Large numbers are made smaller first: from the
first such command on nothing is compared. Python fences are run, too.

With --in-full the indented commands are run as they stand, and all that they print is
compared; with --update it is written into the file.
"""
import os
import re
import subprocess
import sys
import tempfile

ROUNDS = r"printf 'rounds:\\n  - {pop: %d, evals: %d, steps: 2048}\\n  - {pop: %d, evals: %d, steps: 2048}\\n' > small.yaml; "
SMALLER = [  # what costs hours of a core
    (r"--steps \d+ --train sequence", "--steps 16384 --train sequence"),
    (r"--founder-steps \d+", "--founder-steps 2048"), (r"steps: \d+", "steps: 2048"),
    (r"--by-sequence --steps \d+", "--by-sequence --steps 49152"),
    (r"(?<!by-)sequence --steps \d+", "sequence --steps 16384"), (r"moments --steps \d+", "moments --steps 8192"),
    (r'(?<!sequence )(?<!sequence\)" )(?<!moments )--steps \d+\b(?!-| --train sequence)', "--steps 2048"),
    (r"--evals (?!1\b)\d+", "--evals 4"), (r"--pop (?!1\b)\d+", "--pop 3"),
    (r'--seeds "[^"]*"', '--seeds "1 2"'), (r"-j8", "-j2"),
    (r"(evo evolve (?!(?:.|\\\n)*(?:--no-video|--evaluate))[\w. ]+) --run", r"\1 --video gif --video-options '--size 160x90 --speed 25' --run"),
    (r"--episodes \d+", "--episodes 2"), (r"-o walk\.mp4", "-o walk.gif --size 160x90"),
    (r"evo evolve recipe easier", ROUNDS % (1, 1, 1, 1) + "evo evolve recipe ./small.yaml"),
    (r"evo evolve recipe (?:moments|network)", ROUNDS % (3, 4, 3, 4) + "evo evolve recipe ./small.yaml"),
    (r"num_envs=16", "num_envs=4"), (r"--array=1-12", "--array=1-8"),
    (r"(modular\b[^\n]*?)--steps 2048", r"\1--steps 8192"), (r"evo evolve modular", "evo evolve modular --children 1 --champions 1"),
    (r"evo-sample -n (?:64|128|500)", "evo-sample -n 4"), (r"--keep (?:16|64)", "--keep 3"),
    (r'--methods "([^" ]+ [^" ]+) [^"]*"', r'--methods "\1"'),
]
COMMIT = (r"(\d+\.\d+\.\d+) \(([0-9a-f]{7,40}[+]?|no commit)\)", r"\1 (commit)")  # of the build that wrote a text


def smaller(command):
    for pattern, replacement in SMALLER:
        command = re.sub(pattern, replacement, command)
    return command


def blocks(text):
    """(kind, command, output or None) in order."""
    for fence, indented in re.findall(r"^```(\w+\n[\s\S]*?)^```|((?:^    .*\n|^\n(?=    ))+)", text,
                                      re.M):
        if fence:
            kind, code = fence.split("\n", 1)
            # Gymnasium's are run by bindings/python/tests, where Gymnasium is.
            if kind == "sh" or kind == "python" and "gymnasium" not in code:
                yield kind, code, None
            continue
        lines = [line[4:] for line in indented.split("\n")]
        while lines:
            line = lines.pop(0)
            if not line.startswith("$ "):
                continue
            command = line[2:]
            while command.endswith(("|", "\\")) and lines:
                command += "\n" + lines.pop(0)
            output = []
            while lines and not lines[0].startswith("$ "):
                output.append(lines.pop(0))
            yield "sh", command, "\n".join(output).strip("\n")


def indented(lines):
    return "".join(f"    {line}\n" if line else "\n" for line in lines.split("\n"))


def run(path, in_full, update):
    with open(path) as file:
        text = file.read()
    found = [block for block in blocks(text) if not in_full or block[2] is not None]
    assert found, f"{path}: no commands"
    changed, compared = False, 0
    # Jobs of a cluster may still be ending when it goes.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        for kind, command, output in found:
            less = command if in_full else smaller(command)
            changed = changed or less != command
            interpreter = ["bash", "-euo", "pipefail", "-c"] if kind == "sh" else ["/usr/bin/python3", "-c"]
            done = subprocess.run([*interpreter, less], cwd=folder, capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(f"{path}: status {done.returncode}\n{less}\n{done.stdout}{done.stderr}")
            if output and not changed:
                compared += 1
                if re.sub(*COMMIT, done.stdout.strip("\n")) == re.sub(*COMMIT, output):
                    continue
                if update:
                    text = text.replace(indented(f"$ {command}\n{output}"), indented(f"$ {command}\n{done.stdout.strip()}"))
                    continue
                sys.exit(f"{path}:\n{less}\nprinted\n{done.stdout}\nbut the text says\n{output}")
    if update:
        with open(path, "w") as file:
            file.write(text)
    print(f"{path}: {len(found)} commands, {compared} outputs compared")


if __name__ == "__main__":
    os.environ["PATH"] = os.environ["EVO_BIN"] + ":/usr/bin:" + os.environ["PATH"]  # Debian's Python
    os.environ["PYTHONPATH"] = os.environ["EVO_SOURCE"] + "/bindings/python"  # as installed
    options = [word for word in sys.argv[1:] if word.startswith("--")]
    for name in sys.argv[1 + len(options):]:
        run(name, bool(options), "--update" in options)
