"""Damage done to valid files: bytes, numbers, lines, JSON values, HDF5 parts.

Every function takes a random.Random and the bytes of a valid file and returns
other bytes; the same generator gives the same damage.
"""
import io
import json
import re

import h5py
import numpy

TOKENS = [
    b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e999", b"-1", b"0", b"1.5",
    b"18446744073709551616", b"-9223372036854775809", b"2147483648", b"0x10", b"null",
    b"true", b"~", b"''", b'""', b"[]", b"{}", b"[[", b"}}", b": :", b"&a", b"*a", b"!!binary",
    b"---", b"...", b"%", b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"\xc0\x80", b"\xed\xa0\x80",
    b"\x1b[31m", b"\r", b"\n\n", b"\t", b"%s%n", b"A" * 3000, b"[" * 200, b"{\"a\":" * 120,
]
JSON_VALUES = [
    None, True, -1, 0, 2**63, -(2**63) - 1, 1e308, 0.5, "", "\x1b[2J", "x" * 3000, [], {}, [[]],
    [None], {"": None}, "\u0000", "..", "/etc/passwd", [1, 2, 3], 10**30,
]


def span(random, data, longest=64):
    begin = random.randrange(len(data) + 1)
    return begin, min(len(data), begin + random.randrange(1, longest))


def truncate(random, data):
    return data[: random.randrange(len(data) + 1)]


def flip_bits(random, data):
    changed = bytearray(data)
    for _ in range(random.choice([1, 1, 2, 8, 64])):
        if changed:
            changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


def overwrite(random, data):
    begin, end = span(random, data)
    filler = random.choice([b"\x00", b"\xff", b"\x7f", b"9", None])
    fresh = random.randbytes(end - begin) if filler is None else filler * (end - begin)
    return data[:begin] + fresh + data[end:]


def insert_token(random, data):
    at = random.randrange(len(data) + 1)
    return data[:at] + random.choice(TOKENS) + data[at:]


def cut(random, data):
    begin, end = span(random, data, 256)
    return data[:begin] + data[end:]


def repeat(random, data):
    begin, end = span(random, data, 256)
    return data[:end] + data[begin:end] * random.choice([1, 2, 50]) + data[end:]


def swap(random, data):
    a, b = span(random, data), span(random, data)
    (a0, a1), (b0, b1) = sorted([a, b])
    if a1 > b0:
        return flip_bits(random, data)
    return data[:a0] + data[b0:b1] + data[a1:b0] + data[a0:a1] + data[b1:]


def replace_number(random, data):
    numbers = list(re.finditer(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?", data))
    if not numbers:
        return insert_token(random, data)
    at = random.choice(numbers)
    return data[: at.start()] + random.choice(TOKENS[:12]) + data[at.end() :]


def replace_word(random, data):
    words = list(re.finditer(rb"[A-Za-z_][A-Za-z_0-9-]*", data))
    if not words:
        return insert_token(random, data)
    at, other = random.choice(words), random.choice(words)
    fresh = random.choice([other.group(), at.group() + b"x", random.choice(TOKENS)])
    return data[: at.start()] + fresh + data[at.end() :]


def shuffle_lines(random, data):
    lines = data.split(b"\n")
    kind = random.randrange(4)
    at = random.randrange(len(lines))
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines.insert(at, lines[at])
    elif kind == 2:
        lines[at] = b" " * random.randrange(1, 9) + lines[at]
    else:
        random.shuffle(lines)
    return b"\n".join(lines)


def places(value, path=()):
    """Paths of all values in a document."""
    yield path
    if isinstance(value, dict):
        for key, item in value.items():
            yield from places(item, path + (key,))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from places(item, path + (index,))


def change_json(random, data):
    """One value, of the right form around it, that is not what it should be."""
    lines = data.split(b"\n")
    at = 0 if not data.startswith(b"{\"") else random.randrange(max(1, len(lines) - 1))
    try:
        document = json.loads(lines[at] if data.startswith(b"{\"") else data)
    except ValueError:
        return insert_token(random, data)
    path = random.choice(list(places(document)))
    if not path:
        document = random.choice(JSON_VALUES)
    else:
        parent = document
        for step in path[:-1]:
            parent = parent[step]
        kind = random.randrange(4)
        if kind == 0:
            del parent[path[-1]]
        elif kind == 1 and isinstance(parent, dict):
            parent[str(path[-1]) + "_"] = parent.pop(path[-1])
        elif kind == 2 and isinstance(parent, list):
            parent.extend([parent[path[-1]]] * random.choice([1, 30]))
        else:
            parent[path[-1]] = random.choice(JSON_VALUES)
    text = json.dumps(document).encode()
    if not data.startswith(b"{\""):
        return text
    lines[at] = text
    return b"\n".join(lines)


def change_hdf5(random, data):
    """A dataset or attribute of another shape, type or value, or none."""
    image = io.BytesIO(data)
    with h5py.File(image, "r+") as file:
        owners = ["/"]
        datasets = []
        file.visititems(
            lambda name, item: (datasets if isinstance(item, h5py.Dataset) else owners).append(name)
        )
        attributes = [(owner, name) for owner in owners for name in file[owner].attrs]
        if attributes and (not datasets or random.random() < 0.5):
            owner, name = random.choice(attributes)
            place = file[owner].attrs
            kind = random.randrange(4)
            if kind == 0:
                del place[name]
            elif kind == 1:
                place[name] = random.choice([-1, 0, 2.5, 1e308, float("nan"), 2**40, "", "x", "\x1b[2J"])
            elif kind == 2:
                place[name] = numpy.zeros(random.choice([(0,), (3,), (2, 2)]))
            else:
                text = place[name]
                text = text.encode() if isinstance(text, str) else b"[1, 2]"
                damaged = random.choice([truncate, insert_token, replace_number])(random, text)
                place[name] = damaged.replace(b"\x00", b"").decode("utf-8", "replace")
        elif datasets:
            name = random.choice(datasets)
            values = file[name][()]
            kind = random.randrange(5)
            del file[name]
            if kind == 0:
                pass
            elif kind == 1:
                file[name] = numpy.zeros(random.choice([(), (0,), (1,), (5, 5), (2, 3, 4)]))
            elif kind == 2:
                file[name] = "text"
            elif kind == 3:
                file.create_group(name)
            else:
                values = numpy.array(values)
                if values.size and values.dtype.kind in "iuf":
                    flat = values.reshape(-1)
                    extreme = {"f": [float("nan"), float("inf"), 1e30, -1e30]}.get(
                        values.dtype.kind, [0, 1, 127])
                    flat[random.randrange(flat.size)] = random.choice(extreme)
                file[name] = values
    return image.getvalue()


BYTES = [truncate, flip_bits, overwrite, insert_token, cut, repeat, swap]
TEXT = BYTES + [replace_number, replace_number, replace_word, replace_word, shuffle_lines]
KINDS = {
    "binary": BYTES,
    "text": TEXT,
    "json": TEXT + [change_json] * 6,
    "hdf5": BYTES + [change_hdf5] * 5,
}
