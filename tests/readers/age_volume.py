"""Makes a volume of OpenVDB's format 220 of an uncompressed one of format 224, and has OpenVDB read it:
python3 age_volume.py NEW OLD"""
import struct
import sys
import zlib

import pyopenvdb

data = open(sys.argv[1], "rb").read()
place = 0


def take(count):
    global place
    place += count
    return data[place - count:place]


def number():
    return struct.unpack("<I", take(4))[0]


def text():
    return take(number())


def metadata():
    return [(text(), text(), text()) for _ in range(number())]


def put_text(value):
    return struct.pack("<I", len(value)) + value


def put_metadata(entries):
    return struct.pack("<I", len(entries)) + b"".join(put_text(part) for entry in entries for part in entry)


def zipped(values):
    packed = zlib.compress(values)
    if len(packed) < len(values):
        return struct.pack("<q", len(packed)) + packed
    return struct.pack("<q", -len(values)) + values


def is_on(mask, i):
    return mask[i // 8] >> (i % 8) & 1


magic, _, _, _, identifier = take(8), number(), take(8), take(1), take(36)
metadata()
assert number() == 1, "one grid"
name, kind, parent = text(), text(), text()
take(24)
assert number() == 0, "no compression"
told = [entry for entry in metadata() if not entry[0].startswith(b"file_")]
body = put_metadata(told) + put_text(text()) + take(5 * 24) + take(4) + take(4)
tiles, nodes = number(), number()
assert tiles == 0
body += struct.pack("<II", tiles, nodes)
leaves = []


def inner(bits, edge, origin, child):
    """Old arrays have no value where there is a child."""
    global body
    count = 1 << (3 * bits)
    children, active, told = take(count // 8), take(count // 8), take(1)[0]
    assert told in (0, 6), told
    values = take(4 * count)
    body += children + active
    body += zipped(b"".join(values[4 * i:4 * i + 4] for i in range(count) if not is_on(children, i)))
    for i in (i for i in range(count) if is_on(children, i)):
        steps = (i >> (2 * bits), i >> bits & (1 << bits) - 1, i & (1 << bits) - 1)
        child([o + edge * step for o, step in zip(origin, steps)])


def leaf(origin):
    global body
    body += take(64)
    leaves.append(origin)


for _ in range(nodes):
    corner = take(12)
    body += corner
    inner(5, 128, struct.unpack("<3i", corner), lambda origin: inner(4, 8, origin, leaf))
values = len(body)
for origin in leaves:
    active, told = take(64), take(1)[0]
    assert told in (0, 6), told
    body += active + struct.pack("<3i", *origin) + b"\1" + zipped(take(2048))
head = magic + struct.pack("<III", 220, 3, 0) + b"\1\1" + identifier + put_metadata([])
head += struct.pack("<I", 1) + put_text(name) + put_text(kind) + put_text(parent)
begin = len(head) + 24
with open(sys.argv[2], "wb") as old:
    old.write(head + struct.pack("<3q", begin, begin + values, begin + len(body)) + body)


def voxels(path):
    return {item.min: item.value for item in pyopenvdb.readAll(path)[0][0].citerOnValues()}


assert voxels(sys.argv[1]) == voxels(sys.argv[2])
