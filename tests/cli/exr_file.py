"""An OpenEXR reader of our own, for ZIP-compressed scan lines: what a picture's channels hold."""
import struct
import zlib

import numpy as np

TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}
LINES = 16  # in a ZIP block


def text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def attributes(data):
    """Name to (type, bytes), and where the header ends."""
    assert struct.unpack_from("<2I", data) == (20000630, 2), "no plain scan-line OpenEXR"
    found, at = {}, 8
    while data[at]:
        name, at = text(data, at)
        kind, at = text(data, at)
        size, = struct.unpack_from("<i", data, at)
        found[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    return found, at + 1


def channels(data):
    """Names, ascending, and types."""
    found, at = [], 0
    while data[at]:
        name, at = text(data, at)
        kind, _, x, y = struct.unpack_from("<iiii", data, at)
        assert (x, y) == (1, 1)
        found.append((name, TYPES[kind]))
        at += 16
    return found


def unpacked(block, size):
    if len(block) == size:
        return block
    steps = np.frombuffer(zlib.decompress(block), np.uint8)
    assert len(steps) == size
    mixed = (np.cumsum(steps, dtype=np.int64) - 128 * np.arange(size)).astype(np.uint8)
    plain = np.empty(size, np.uint8)
    plain[0::2], plain[1::2] = mixed[:(size + 1) // 2], mixed[(size + 1) // 2:]
    return plain.tobytes()


def read_exr(path):
    """Channel name to array [height, width]."""
    with open(path, "rb") as file:
        data = file.read()
    header, at = attributes(data)
    assert header["compression"][1] == b"\x03", "not ZIP"
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    kinds = channels(header["channels"][1])
    picture = {name: np.empty((height, width), kind) for name, kind in kinds}
    blocks = (height + LINES - 1) // LINES
    for offset in struct.unpack_from(f"<{blocks}Q", data, at):
        first, size = struct.unpack_from("<2i", data, offset)
        lines = min(LINES, bottom + 1 - first)
        line = width * sum(kind.itemsize for _, kind in kinds)
        block, place = unpacked(data[offset + 8:offset + 8 + size], lines * line), 0
        for y in range(first - top, first - top + lines):
            for name, kind in kinds:
                picture[name][y] = np.frombuffer(block, kind, width, place)
                place += width * kind.itemsize
    return picture
