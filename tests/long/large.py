#!/usr/bin/python3
"""A ball in a box of more than 2^31 voxels, a thousand million of them inside: its pieces add up to it.

usage: large.py SHERD [RESOLUTION]    (default: 1300, which takes two minutes, 8 GB of memory and 2 GB of disk)

The voxels of `labels.rle` and the volumes of the meshes are added up here, and compared with the ball's; `sherd evaluate`
looks at the meshes' edges.  Needs Debian's python3-numpy.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

STEPS = 400  # of latitude: the polyhedron has 0.999974 of the ball's volume


def write_ball(path):
    """Return its volume."""
    polar = np.linspace(0, np.pi, STEPS + 1)[1:-1, None]
    round_ = np.linspace(0, 2 * np.pi, 2 * STEPS, endpoint=False)[None]
    ring = np.stack([np.sin(polar) * np.cos(round_), np.sin(polar) * np.sin(round_),
                     np.cos(polar) + 0 * round_], -1).reshape(-1, 3)
    points = np.concatenate([[[0, 0, 1]], ring, [[0, 0, -1]]]).astype("<f4")
    at = 1 + np.arange(len(ring)).reshape(-1, 2 * STEPS)
    beside = np.roll(at, -1, 1)
    a, b, c, d = (x.ravel() for x in (at[:-1], beside[:-1], at[1:], beside[1:]))
    top, bottom = 0 * at[0], 0 * at[0] + len(points) - 1
    faces = np.concatenate([np.stack(t, 1) for t in ((top, at[0], beside[0]), (a, c, d), (a, d, b),
                                                     (bottom, beside[-1], at[-1]))])
    records = np.zeros(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    records["count"], records["corners"] = 3, faces
    header = ("ply\nformat binary_little_endian 1.0\n"
              f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
              f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + points.tobytes() + records.tobytes())
    return volume(points.astype(float), faces)


def volume(points, faces):
    a, b, c = points[faces[:, 0]], points[faces[:, 1]], points[faces[:, 2]]
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def mesh_volume(ply):
    """Of vertices of three doubles or floats, then what else there is, and faces of three corners: by the header."""
    kinds = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "int": "<i4", "uint": "<u4"}
    data = ply.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            fields = elements[-1][2]
            if words[1] == "list":
                fields += [("count", kinds[words[2]]), ("corners", kinds[words[3]], 3)]
            else:
                fields.append((words[2], kinds[words[1]]))
    arrays = {}
    for name, count, fields in elements:
        arrays[name] = np.frombuffer(data, np.dtype(fields), count, end)
        end += arrays[name].nbytes
    assert (arrays["face"]["count"] == 3).all()
    points = np.stack([arrays["vertex"][axis].astype(float) for axis in "xyz"], 1)
    return volume(points, arrays["face"]["corners"])


def main(sherd, resolution="1300"):
    with tempfile.TemporaryDirectory() as scratch:
        ball, out = pathlib.Path(scratch) / "ball.ply", pathlib.Path(scratch) / "out"
        whole = write_ball(ball)
        process = subprocess.Popen([sherd, "fracture", ball, "-o", out, "--resolution", resolution, "--pieces", "10",
                                    "--write", "labels,mesh", "--quiet"])
        _, status, usage = os.wait4(process.pid, 0)
        assert status == 0

        with open(out / "manifest.json") as file:
            manifest = json.load(file)
        voxel = manifest["grid"]["voxel_size"] ** 3
        rle = np.fromfile(out / "labels.rle", np.uint8)
        dims = rle[:12].view("<u4").astype(np.uint64)
        runs = rle[12:].view([("label", "<u2"), ("length", "<u4")])
        assert runs["length"].sum(dtype=np.uint64) == dims.prod(), "runs fill the box"
        inside = np.array([runs["length"][runs["label"] == fragment["id"] + 1].sum(dtype=np.uint64)
                           for fragment in manifest["fragments"]])
        assert [int(n) for n in inside] == [fragment["voxels"] for fragment in manifest["fragments"]]
        volumes = np.array([mesh_volume(out / fragment["files"]["mesh"]) for fragment in manifest["fragments"]])
        off = {"voxels": inside.sum() * voxel / whole - 1, "meshes": volumes.sum() / whole - 1,
               "a piece": np.abs(volumes / (inside * voxel) - 1).max()}
        # A chord of one voxel lies 1 / 8r voxels within a sphere of r, which takes 3 / 8r^2 of the volume; the diagonals of
        # its squares, and of cubes, more.  A piece has sides that voxels follow in steps, too.
        radius = int(resolution) / 2
        assert max(abs(off["voxels"]), abs(off["meshes"])) < 3 / radius**2 and off["a piece"] < 20 / radius**2, off

        told = subprocess.run([sherd, "evaluate", out, "--json"], capture_output=True, text=True)
        assert told.returncode == 0, told.stderr
        evaluated = json.loads(told.stdout)
        assert evaluated["sound"] == evaluated["pieces"] == len(inside), evaluated["sound"]
        print(f"{dims.prod() / 1e9:.2f} thousand million voxels, {inside.sum() / 1e9:.2f} inside, in {len(inside)} pieces; "
              f"voxels are off by {off['voxels']:.1e}, meshes by {off['meshes']:.1e}; {usage.ru_maxrss / 1e6:.1f} GB")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*sys.argv[1:])
