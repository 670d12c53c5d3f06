"""Reads `.binp` files by docs/formats.md and not by Sherd: points in the order of the file."""
import math
import struct

import numpy as np

HEADER = "<20sI3BQdBd6d"
EPSILON = float(np.finfo(np.float32).eps)


def bytes_of(code, frequencies, count):
    """`count` bytes out of range code, and how many bytes of code they took."""
    mask, top, bottom = 0xffffffff, 1 << 24, 1 << 16
    low, span, value, at = 0, mask, int.from_bytes(code[:4], "big"), 4
    out = bytearray()
    for _ in range(count):
        span //= frequencies[256]
        part = ((value - low) & mask) // span
        symbol = int(np.searchsorted(frequencies, part, side="right")) - 1
        out.append(symbol)
        low = (low + frequencies[symbol] * span) & mask
        span *= frequencies[symbol + 1] - frequencies[symbol]
        while True:
            if (low ^ (low + span) & mask) >= top:
                if span >= bottom:
                    break
                span = -low & (bottom - 1)
            value = (value << 8 | code[at]) & mask
            at += 1
            span, low = (span << 8) & mask, (low << 8) & mask
    return bytes(out), at


def read_binp(raw):
    """Header fields and positions [n, 3]."""
    magic, frame, whole, centers, colors, points, voxel, bits, step, *box = struct.unpack_from(HEADER, raw)
    assert magic == b"<PCL-OCT-COMPRESSED>" and (frame, whole, centers, colors, bits) == (1, 1, 1, 0, 8)
    assert struct.calcsize(HEADER) == 100
    low, high = np.array(box[:3]), np.array(box[3:])
    size, = struct.unpack_from("<Q", raw, 100)
    frequencies = [int(f) for f in struct.unpack_from("<257I", raw, 108)]
    assert frequencies[0] == 0 and frequencies[256] < 65536 and all(a < b for a, b in zip(frequencies, frequencies[1:]))
    code = raw[108 + 4 * 257:]
    tree, used = bytes_of(code, frequencies, size)
    assert used == len(code)
    cells = max(2, *(math.ceil((h - l - EPSILON) / voxel) for l, h in zip(low, high)))
    depth = math.ceil(math.log2(cells) - EPSILON)
    assert ((2 ** depth * voxel - (high - low)) / 2 <= EPSILON).all()
    positions, at = [], 0

    def walk(key, level):
        nonlocal at
        if level == depth:
            positions.append((np.array(key) + 0.5) * voxel + low)
            return
        children = tree[at]
        at += 1
        assert children
        for child in range(8):
            if children >> child & 1:
                walk([k << 1 | child >> 2 - axis & 1 for axis, k in enumerate(key)], level + 1)

    walk([0, 0, 0], 0)
    assert at == size and len(positions) == points
    return {"voxel": voxel, "step": step, "low": low, "high": high}, np.array(positions)
