"""Reads and writes voxel files by docs/formats.md and not by Sherd.  Labels are uint16 [x, y, z]."""
import struct

import numpy as np


def read_rle(raw):
    dims = np.frombuffer(raw, "<u4", 3)
    runs = np.frombuffer(raw, [("label", "<u2"), ("length", "<u4")], offset=12)
    return np.repeat(runs["label"], runs["length"]).reshape(dims)


def write_rle(labels, old=False):
    flat = labels.reshape(-1)
    starts = np.flatnonzero(np.r_[True, flat[1:] != flat[:-1]])
    lengths = np.diff(np.r_[starts, flat.size])
    record = "<H6xQ" if old else "<HI"
    return struct.pack("<3I", *labels.shape) + b"".join(
        struct.pack(record, flat[start], length) for start, length in zip(starts, lengths))


def cube(labels, centered):
    side = max(labels.shape)
    start = [(side - n) // 2 if centered else 0 for n in labels.shape]
    out = np.zeros((side,) * 3, labels.dtype)
    out[tuple(slice(a, a + n) for a, n in zip(start, labels.shape))] = labels
    return out


def write_bing(labels):
    padded = cube(labels, True)
    return struct.pack("<3I", *padded.shape) + padded.astype("<u2").tobytes()


# ---- Quad-stacks

def _stack(column):
    """The labels of a column's intervals, and where each ends."""
    ends = np.r_[np.flatnonzero(column[1:] != column[:-1]) + 1, len(column)]
    return [int(column[e - 1]) for e in ends], [int(e) for e in ends]


def write_qstack(labels, widest=255):
    nx, ny, nz = labels.shape
    stacks = [[_stack(labels[x, y]) for y in range(ny)] for x in range(nx)]

    def build(x0, x1, y0, y1):  # [box, intervals (label, ends [x, y]), children]
        box = (x0, x1, y0, y1)
        first = stacks[x0][y0][0]
        narrow = max(x1 - x0, y1 - y0) <= widest
        if narrow and all(stacks[x][y][0] == first for x in range(x0, x1) for y in range(y0, y1)):
            return [box, [(label, np.array([[stacks[x][y][1][i] for y in range(y0, y1)] for x in range(x0, x1)]))
                          for i, label in enumerate(first)], []]
        xm, ym = x0 + (x1 - x0 + 1) // 2, y0 + (y1 - y0 + 1) // 2
        children = [build(*b) for b in ((x0, xm, y0, ym), (x0, xm, ym, y1), (xm, x1, y0, ym), (xm, x1, ym, y1))
                    if b[0] < b[1] and b[2] < b[3]]
        node, place = [box, [], children], 0
        while narrow and place < len(children[0][1]):
            label = children[0][1][place][0]
            if label != 65535 and all(place < len(c[1]) and c[1][place][0] == label for c in children):
                ends = np.zeros((x1 - x0, y1 - y0), int)
                for (a, b, c, d), intervals, _ in children:
                    ends[a - x0:b - x0, c - y0:d - y0] = intervals.pop(place)[1]
                node[1].append((label, ends))
            place += 1
        return node

    nodes = []

    def walk(node):
        if node[1]:
            nodes.append(node)
        for child in node[2]:
            walk(child)

    walk(build(0, nx, 0, ny))
    out = struct.pack("<Q3HQ", 2, nx, ny, nz, len(nodes))
    for (x0, x1, y0, y1), intervals, _ in nodes:
        out += struct.pack("<Q4I", len(intervals), x1, y1, x0, y0)
        for label, ends in intervals:
            out += struct.pack("<BBH", x1 - x0, y1 - y0, label) + ends.astype("<u2").tobytes()
    return out


def read_qstack(raw):
    two, nx, ny, nz, count = struct.unpack_from("<Q3HQ", raw)
    assert two == 2
    at, columns = 22, {}
    for _ in range(count):
        intervals, x1, y1, x0, y0 = struct.unpack_from("<Q4I", raw, at)
        at += 24
        for _ in range(intervals):
            width, height, label = struct.unpack_from("<BBH", raw, at)
            assert (width, height) == (x1 - x0, y1 - y0) and intervals > 0
            ends = np.frombuffer(raw, "<u2", width * height, at + 4).reshape(width, height)
            at += 4 + ends.nbytes
            for x in range(width):
                for y in range(height):
                    columns.setdefault((x0 + x, y0 + y), []).append((int(ends[x, y]), label))
    assert at == len(raw)
    labels = np.zeros((nx, ny, nz), np.uint16)
    for (x, y), stack in columns.items():
        z = 0
        for end, label in sorted(stack):
            labels[x, y, z:end] = label
            z = end
        assert z == nz
    assert len(columns) == nx * ny
    return labels


# ---- MagicaVoxel

def _chunk(name, content, children=b""):
    return name + struct.pack("<2i", len(content), len(children)) + content + children


def _text(text):
    return struct.pack("<i", len(text)) + text.encode()


def _dict(entries):
    return struct.pack("<i", len(entries)) + b"".join(_text(k) + _text(v) for k, v in entries.items())


def transform(node, child, layer=-1, **frame):
    return _chunk(b"nTRN", struct.pack("<i", node) + _dict({}) + struct.pack("<4i", child, -1, layer, 1) + _dict(frame))


def group(node, children):
    return _chunk(b"nGRP", struct.pack("<i", node) + _dict({}) + struct.pack(f"<{len(children) + 1}i", len(children), *children))


def shape(node, model, **attributes):
    return _chunk(b"nSHP", struct.pack("<i", node) + _dict({}) + struct.pack("<2i", 1, model) + _dict(attributes))


def model(size, voxels):
    """`voxels` are rows x, y, z, color."""
    rows = np.array(voxels, "u1").reshape(-1, 4)
    return (_chunk(b"SIZE", struct.pack("<3i", *size)) +
            _chunk(b"XYZI", struct.pack("<i", len(rows)) + rows.tobytes()))


def vox_file(chunks, version=150):
    return b"VOX " + struct.pack("<i", version) + _chunk(b"MAIN", b"", chunks)


def write_vox(labels):
    """The paper's layout: labels from 2 on, their colors one lower."""
    at = np.argwhere(labels >= 2)  # x slowest
    colors = labels[tuple(at.T)] - 1
    at = at[:, [0, 2, 1]]
    low, high = at.min(axis=0), at.max(axis=0)
    cubes, models, nodes = {}, b"", b""
    for place, voxel, color in zip(map(tuple, at // 126), at % 126, colors):
        cubes.setdefault(place, []).append([*voxel, color])
    for i, (place, voxels) in enumerate(cubes.items()):
        models += model((126, 126, 126), voxels)
        t = [(p + 0.5) * 126 - (l + (h - l) * 0.5) * (axis < 2) for axis, (p, l, h) in enumerate(zip(place, low, high))]
        nodes += transform(2 + 2 * i, 3 + 2 * i, 0, _t=" ".join(str(int(np.floor(v))) for v in t))
        nodes += shape(3 + 2 * i, i, _f="0")
    return vox_file(models + transform(0, 1) + group(1, [2 + 2 * i for i in range(len(cubes))]) + nodes)


def read_vox(raw):
    """Colors of a file whose transforms have translations only, in the grid's axes, over their tight box."""
    assert raw[:8] == b"VOX " + struct.pack("<i", 150) and raw[8:12] == b"MAIN"
    at, sizes, models, shifts, shown, palette = 20, [], [], {}, {}, None
    assert struct.unpack_from("<2i", raw, 12) == (0, len(raw) - 20)
    while at < len(raw):
        name, (length, children) = raw[at:at + 4], struct.unpack_from("<2i", raw, at + 4)
        assert children == 0
        body = raw[at + 12:at + 12 + length]
        at += 12 + length
        if name == b"SIZE":
            sizes.append(struct.unpack("<3i", body))
        elif name == b"XYZI":
            models.append(np.frombuffer(body, "u1", offset=4).reshape(-1, 4))
            assert len(models[-1]) == struct.unpack_from("<i", body)[0]
        elif name == b"nTRN":
            node, _, child, _, _, _, entries = struct.unpack_from("<7i", body)
            if entries:
                key, length = body[32:34], struct.unpack_from("<i", body, 34)[0]
                assert key == b"_t" and 38 + length == len(body)
                shifts[child] = [int(v) for v in body[38:].split()]
        elif name == b"nSHP":
            node, _, count, which = struct.unpack_from("<4i", body)
            shown[node] = which
        elif name == b"RGBA":
            palette = np.frombuffer(body, "u1").reshape(256, 4)
    rows = []
    for node, which in shown.items():
        voxels = models[which].astype(int)
        rows.append(np.c_[voxels[:, :3] - np.array(sizes[which]) // 2 + shifts[node], voxels[:, 3]])
    rows = np.concatenate(rows)[:, [0, 2, 1, 3]]
    rows[:, :3] -= rows[:, :3].min(axis=0)
    colors = np.zeros(rows[:, :3].max(axis=0) + 1, np.uint16)
    colors[tuple(rows[:, :3].T)] = rows[:, 3]
    return colors, palette
