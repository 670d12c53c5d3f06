"""Reads the meshes that Sherd writes (docs/formats.md), for the studies and the gallery."""
import numpy as np

TYPES = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}
LENGTHS = {"vertex_indices": 3, "texcoord": 6}


def read_ply(path):
    """The elements of a binary PLY file, as arrays with a field per property."""
    raw = path.read_bytes()
    body = raw.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in raw[:body].decode().split("\n"):
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            name = words[4]
            elements[-1][2].extend([("count of " + name, TYPES[words[2]]), (name, TYPES[words[3]], LENGTHS[name])])
        elif words[:1] == ["property"]:
            elements[-1][2].append((words[2], TYPES[words[1]]))
    arrays = {}
    for name, count, fields in elements:
        dtype = np.dtype(fields)
        arrays[name] = np.frombuffer(raw, dtype, count, body)
        for field in set(LENGTHS) & set(dtype.names):
            if (arrays[name]["count of " + field] != LENGTHS[field]).any():
                raise ValueError(f"{path}: has polygons, which only --surface exact of polygons writes; triangles are needed")
        body += count * dtype.itemsize
    return arrays


def read_mesh(path):
    """Vertices [n, 3], triangles [m, 3] and neighbors [m] of a fragment's mesh."""
    ply = read_ply(path)
    vertices = np.column_stack([ply["vertex"][axis] for axis in "xyz"]).astype(float)
    return vertices, ply["face"]["vertex_indices"], ply["face"]["neighbor"]
