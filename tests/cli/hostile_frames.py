#!/usr/bin/env python3
"""Frames that no sane client sends to evo-env. Each gets an answer that is whole,
each session ends by itself with status 0 or 65 and at most one line said."""
import json
import random
import struct
import subprocess
import sys

TOOL, ROBOT = sys.argv[1:]
ACTIONS, ENVIRONMENTS = 4, 2


def frame(kind, payload=b"", length=None):
    return struct.pack("<4sI", kind, len(payload) if length is None else length) + payload


def document(value):
    return frame(b"JSON", json.dumps(value).encode())


def step(*values):
    return frame(b"STEP", struct.pack(f"<{len(values)}d", *values))


RESET = document({"reset": {"seed": 1}})
GOOD = step(*[1.0] * 8)


def talk(sent):
    done = subprocess.run(
        [TOOL, "--task", "Walker-v0", "--mode", "binary", "-j", "1", "--envs", "2", ROBOT],
        input=sent, capture_output=True, timeout=30)
    answers, rest = [], done.stdout
    while rest:
        kind, length = struct.unpack_from("<4sI", rest)
        assert len(rest) >= 8 + length, "half an answer"
        answers.append((kind, rest[8 : 8 + length]))
        rest = rest[8 + length :]
    assert done.returncode in (0, 65), (done.returncode, done.stderr)
    assert done.stderr.count(b"\n") == (done.returncode == 65), done.stderr
    assert answers[0][0] == b"JSON", answers[:1]
    return done.returncode, answers[1:]


# (what, the middle of a session, whether the session goes on after it)
cases = [("nothing", b"", True)]
nan, inf = float("nan"), float("inf")
for place in range(8):
    for value in (nan, inf, -inf):
        values = [1.0] * 8
        values[place] = value
        cases.append((f"{value} at {place}", step(*values), True))
for count in (0, 1, 7, 9, 100, 100000):
    cases.append((f"{count} actions", step(*[1.0] * count), True))
for length in (1, 63, 65):
    cases.append((f"{length} bytes of actions", frame(b"STEP", b"\1" * length), True))
for length in (0, 8, 71, 73):
    cases.append((f"a mask of {length} bytes", frame(b"MASK", b"\1" * length), True))
cases.append(("a look with a payload", frame(b"LOOK", b"\0" * 8), True))
for text in (b"", b"{", b"[]", b"null", b"{}", b"\xff\xfe", b"\0" * 50, b"[" * 5000, b'{"a":' * 5000,
             b'{"reset":{"seed":1e99}}', b'{"reset":[]}', b'{"step":[[1]]}', b'"' * 99,
             b'{"picture":{"width":1}}', b'{"picture":{"width":5000}}', b'{"positions":7}',
             b"{" + b",".join(b'"k%d":0' % i for i in range(5000)) + b"}"):
    cases.append((f"JSON {text[:20]!r}", frame(b"JSON", text), True))
for kind in (b"step", b"RSET", b"\0\0\0\0", b"\xff\xff\xff\xff", b"DATA", b"GET "):
    cases.append((f"kind {kind!r}", frame(kind, b"x" * 64), False))
cases.append(("four billion bytes of JSON", frame(b"JSON", b"{}", 0xFFFFFFFF), False))
cases.append(("four billion bytes of actions", frame(b"STEP", b"{}", 0xFFFFFFFF), False))
saved = struct.pack("<3Q", 1, 0, 64)
for text in (b"", b"\0" * 7, struct.pack("<Q", 2**64 - 1), struct.pack("<Q", 2**60) + b"\0" * 99,
             struct.pack("<3Q", 1, 9, 0), struct.pack("<3Q", 1, 2**63, 0), struct.pack("<3Q", 1, 0, 0),
             struct.pack("<3Q", 1, 0, 2**64 - 1), saved, saved + b"0" * 63, saved + b"0" * 64,
             saved + b"\xff" * 64, saved + b"0" * 65, b"\xff" * 1000):
    cases.append((f"LOAD {text[:24]!r}", frame(b"LOAD", text), True))
cases.append(("four billion bytes of states", frame(b"LOAD", saved, 0xFFFFFFFF), False))
for text in (b'{"save":7}', b'{"save":{"environments":[2]}}', b'{"save":{},"step":[]}', b'{"restore":{}}',
             b'{"restore":{"states":["AA==","%%"]}}', b'{"restore":{"states":["AA==","AA=="]}}'):
    cases.append((f"JSON {text!r}", frame(b"JSON", text), True))
cases.append(("half a header", b"STE", False))
for cut in range(1, 72, 7):
    cases.append((f"a step cut after {cut} bytes", GOOD[:cut], False))
generator = random.Random(1)
for n in range(30):
    cases.append((f"noise {n}", generator.randbytes(generator.randrange(1, 200)), False))

_, expected = talk(RESET + GOOD)
assert [kind for kind, _ in expected] == [b"DATA", b"DATA"]
for what, middle, goes_on in cases:
    try:
        status, answers = talk(RESET + middle + (GOOD if goes_on else b""))
        if goes_on:
            # One refusal, and the step after it is the one without it.
            assert status == 0
            assert [kind for kind, _ in answers] == [b"DATA"] + [b"FAIL"] * bool(middle) + [b"DATA"]
            assert answers[-1] == expected[-1]
        elif what.startswith("noise"):
            assert answers[-1][0] == b"FAIL" and status == 65
        else:
            assert [kind for kind, _ in answers] == [b"DATA", b"FAIL"] and status == 65
        assert all(json.loads(text)["error"] for kind, text in answers if kind == b"FAIL")
    except Exception as problem:
        sys.exit(f"{what}: {problem!r}")
# An environment that was never reset.
status, answers = talk(GOOD)
assert status == 0 and answers[0][0] == b"FAIL" and b"reset" in answers[0][1]
# What voxels see is the same in a frame as in a document.
status, answers = talk(RESET + GOOD + frame(b"LOOK") + document({"look": {}}) + document({"voxels": {}}))
assert status == 0 and answers[2][0] == b"VIEW"
looks, voxels = json.loads(answers[3][1])["look"], json.loads(answers[4][1])["voxels"]
expected = [x for look in looks for row in look["local"] for x in row] + [x for look in looks for x in look["task"]]
assert struct.unpack(f"<{len(expected)}d", answers[2][1]) == tuple(expected)
for look, voxel in zip(looks, voxels):
    assert len(look["task"]) == voxel["task_length"]
    assert [len(row) for row in look["local"]] == [voxel["local_length"]] * len(voxel["fixed"])
print(f"{len(cases) + 2} sessions")
