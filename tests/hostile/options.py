"""Every option of every tool with values that nobody should give it."""
import re
import subprocess

# Commands that are quick and succeed as they stand.
TOOLS = {
    "evo-sample": "-n 1",
    "evo-mutate": "-n 1 valid/one.txt",
    "evo-select": "valid/scored.jsonl",
    "evo-suggest": "-q -n 1",
    "evo-neat": "-n 2 --shape 2x2 --state-out o.json",
    "evo-convert": "valid/robots.jsonl",
    "evo-inspect": "valid/robot.json",
    "evo-eval": "-j1 --task Walker-v0 --actions random --max-steps 2 valid/one.txt",
    "evo-train": "-j1 --task Walker-v0 --train valid/tiny.yaml --steps 2 --out-dir policies --force valid/one.txt",
    "evo-bench": "--sizes 3 --seconds 0.001",
    "evo-report": "valid",
    "evo-evolve": "neat --run r --pop 3 --evals 6 --steps 512 --shape 2x2 --plan -q",
}
VALUES = [
    "", " ", "0", "-1", "1.5", "nan", "inf", "-inf", "1e308", "1e999", "99999999999999999999",
    "2147483648", "0x10", "1,2,3", ",", "5x5x5", "0x0", "x", "é", b"\xff", b"\x1b[31m", "A" * 5000,
    "%s%n", "[", "{", '{"a":', "=", "a=b", "gravity=nan", "/", ".", "no/such", "/dev/null", "-",
]
# Values that mean what they say: long work, files in the root of the file system.
MEANT = {
    ("evo-evolve", "--run", "/"),
    ("evo-bench", "--seconds", "1.5"),
    *(("evo-train", option, "2147483648") for option in ("--steps", "--founder-steps", "--seed")),
}
STATUSES = (1, 2, 65, 66, 73, 74)


def options_of(tool):
    text = subprocess.run([tool, "--help"], check=True, stdout=subprocess.PIPE).stdout.decode()
    return re.findall(r"^  (?:-\w, |    )(--[a-z-]+) [A-Z{|.]", text, re.MULTILINE)


def cases():
    for tool, words in TOOLS.items():
        for option in options_of(tool):
            for value in VALUES:
                if (tool, option, value) not in MEANT:
                    yield [tool, *words.split(), option, value]
