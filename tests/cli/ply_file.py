"""Reads .ply files that Sherd wrote, by docs/formats.md and not by Sherd."""
import numpy as np

TYPES = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}


def read_ply(path):
    """Comments, and per element the columns of a binary PLY whose lists have the lengths of their first rows."""
    with open(path, "rb") as file:
        head, body = file.read().split(b"end_header\n", 1)
    comments, elements = [], []
    for line in head.decode().splitlines():
        words = line.split()
        if words[0] == "comment":
            comments.append(words[1:])
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        if words[0] == "property":
            elements[-1][2].append(words[1:])
    out, at = {}, 0
    for name, count, properties in elements:
        fields = []
        for p in properties:
            if p[0] == "list":
                length = {"vertex_indices": 3, "texcoord": 6}[p[3]]
                fields += [("n_" + p[3], TYPES[p[1]]), (p[3], TYPES[p[2]], length)]
            else:
                fields.append((p[1], TYPES[p[0]]))
        rows = np.frombuffer(body, fields, count, at)
        at += rows.nbytes
        for field in rows.dtype.names:
            if field.startswith("n_"):
                assert (rows[field] == rows[field[2:]].shape[1]).all()
        out[name] = rows
    assert at == len(body)
    return comments, out["vertex"], out["face"]


def columns(rows, *names):
    return np.column_stack([rows[name] for name in names]).astype(float)


def read_triangles(path):
    """Vertices, triangles and neighbor of a mesh."""
    _, vertex, face = read_ply(path)
    return columns(vertex, *"xyz"), face["vertex_indices"], face["neighbor"]
