#!/usr/bin/env python3
"""Compares fractures from Python, meshes as arrays, with the same from C++ (tests/bench/fracture_loop.cpp), in turn.

usage: python_overhead.py MESH    (with the Python that pysherd is installed for, after tools/test_python.sh)

Ratios are medians of those of the rounds: of the time that passes, and of the processors' time, which is the steadier one on a machine with
other work.
"""
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import pysherd

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROUNDS = 21


def compiled(folder):
    """Returns the C++ program, which links the library of the installed module's build."""
    program = pathlib.Path(folder) / "fracture_loop"
    shared = ROOT / "build" / "release" / "shared"
    subprocess.run(["g++", "-std=c++20", "-O2", "-DOPENVDB_ABI_VERSION_NUMBER=10", ROOT / "tests" / "bench" / "fracture_loop.cpp", f"-I{ROOT / 'include'}",
                    "-I/usr/include/Imath", f"-L{shared}", f"-Wl,-rpath,{shared}", "-lsherd", "-lopenvdb", "-ltbb", "-o", program], check=True)
    return program


def in_cpp(program, mesh, resolution, count):
    """Returns seconds and processor seconds for each fracture, and the faces of all."""
    printed = subprocess.run([program, mesh, str(resolution), str(count)], stdout=subprocess.PIPE, check=True, text=True).stdout.split()
    return float(printed[0]), float(printed[1]), int(printed[2])


def in_python(solid, count):
    faces, start, own = 0, time.perf_counter(), time.process_time()
    for seed in range(count):
        for fragment in pysherd.fracture(solid, pieces=8, seed=seed):
            fragment.vertices, fragment.neighbor
            faces += len(fragment.faces)
    return (time.perf_counter() - start) / count, (time.process_time() - own) / count, faces


def main():
    mesh = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        program = compiled(folder)
        for resolution, count in ((64, 20), (128, 10)):
            solid = pysherd.voxelize(mesh, resolution=resolution)
            in_python(solid, 2)  # as fracture_loop does before it measures
            pairs = []
            for _ in range(ROUNDS):
                cpp, python = in_cpp(program, mesh, resolution, count), in_python(solid, count)
                assert cpp[2] == python[2]
                pairs.append((cpp, python))
            for kind, name in enumerate(("passed", "processors'")):
                ratio = statistics.median(python[kind] / cpp[kind] for cpp, python in pairs)
                one, other = (1000 * statistics.median(p[side][kind] for p in pairs) for side in (0, 1))
                print(f"{resolution} voxels, {name} time: C++ {one:.2f} ms, Python {other:.2f} ms a fracture, ratio {ratio:.3f}")


if __name__ == "__main__":
    main()
