#!/usr/bin/python3
"""Reads Houdini's geometry with HouIO, a reader and writer of its files that knows nothing of Sherd.

usage: geo.py PROGRAM HOUIO    (needs Debian's python3-numpy and a C++20 compiler)

HOUIO is a folder of its sources, github.com/Ahmed-Hindy/houio, with its build in HOUIO/build:
  cmake -S HOUIO -B HOUIO/build -DCMAKE_BUILD_TYPE=Release -DHOUIO_BUILD_TESTS=OFF && cmake --build HOUIO/build
It has no license, so nothing of it is fetched or kept here.  Commit 3cfdbfd was compared with Houdini 20.0 to 22.0 by its authors.

Fails unless HouIO finds no fault, has the primitives, attributes and groups that the test's own reader (tests/cli/geo_file.py) has, and these
are those of manifest.json.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
from geo_file import Geometry

AMPHORA = HERE.parents[1] / "data" / "amphora.ply"


def compiled(houio, folder):
    dump = folder / "geo_dump"
    subprocess.run(["c++", "-std=c++20", "-O1", "-I", houio / "include", HERE / "geo_dump.cpp", houio / "build" / "libhouio.a", "-o", dump], check=True)
    return dump


def compare(dump, path):
    """What HouIO reads, equal to what the test's own reader does."""
    read = json.loads(subprocess.run([dump, path], check=True, stdout=subprocess.PIPE).stdout)
    own = Geometry(path)
    assert read["counts"] == [own.point_count, own.vertex_count, own.primitive_count]
    names = {(owner, name) for owner in ("point", "vertex", "primitive") for name in read[owner]}
    assert names == set(own.attributes), names
    for (owner, name), values in own.attributes.items():
        found = read[owner][name]
        assert found["size"] == (values.shape[1] if values.ndim == 2 else 1)
        expected = values.ravel()
        found = np.array(found["values"], expected.dtype)
        assert np.array_equal(found, expected), (path, name)
    assert {p["closed"] for p in read["primitives"]} <= {own.closed}
    assert [p["points"] for p in read["primitives"]] == own.points.tolist()
    assert list(read["groups"]) == list(own.groups) and all(np.array_equal(read["groups"][g], own.groups[g]) for g in own.groups)
    return read


def check(program, dump, folder, *options, mesh=AMPHORA):
    out = folder / "out"
    subprocess.run([program, "fracture", mesh, "-o", out, "--quiet", "--write", "houdini", "--resolution", "64", "--joint-strength", "3", *options], check=True)
    manifest = json.loads((out / "manifest.json").read_text())
    pieces, graph = (compare(dump, out / name) for name in ("pieces.geo", "graph.geo"))
    names = pieces["primitive"]["name"]["values"]
    assert list(dict.fromkeys(names)) == [f"piece{f['id']}" for f in manifest["fragments"]] == graph["point"]["name"]["values"]
    neighbor = np.array(pieces["primitive"]["neighbor"]["values"])
    assert np.array_equal(pieces["groups"]["inside"], neighbor > 0) and np.array_equal(pieces["groups"]["outside"], neighbor == 0)
    bonds = {(f["id"], c["id"]): c["area"] for f in manifest["fragments"] for c in f["contacts"] if f["id"] < c["id"]}
    ends = [tuple(p + 1 for p in primitive["points"]) for primitive in graph["primitives"]]
    assert sorted(ends) == sorted(bonds)
    strength = np.array([3 * bonds[pair] for pair in ends], np.float32)
    assert np.array_equal(np.array(graph["primitive"]["strength"]["values"], np.float32), strength)
    print(f"{len(names)} polygons of {len(manifest['fragments'])} pieces, {len(ends)} constraints, "
          f"vertex attributes {sorted(pieces['vertex'])}, groups {sorted(pieces['groups'])} and {sorted(graph['groups'])}: equal")


def main():
    program, houio = map(pathlib.Path, sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        dump = compiled(houio.resolve(), folder)
        check(program, dump, folder, "--pieces", "30")
        check(program, dump, folder, "--pieces", "12", "--growth", "sequential")
        check(program, dump, folder, "--pieces", "1")
        box = folder / "box.obj"
        box.write_text(cube())
        check(program, dump, folder, "--pieces", "5", "--surface", "exact", mesh=box)


def cube():
    """A box with two materials, texture coordinates, colors and normals, as OBJ."""
    lines = ["v %d %d %d 0.5 %g 1" % (i >> 2 & 1, i >> 1 & 1, i & 1, i / 8) for i in range(8)]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "vn -1 0 0", "vn 1 0 0", "vn 0 -1 0", "vn 0 1 0", "vn 0 0 -1", "vn 0 0 1"]
    for n, face in enumerate(((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))):
        lines.append("usemtl " + ("one" if n < 3 else "two"))
        lines.append("f " + " ".join(f"{v}/{k + 1}/{n + 1}" for k, v in enumerate(face)))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
