#!/usr/bin/env python3
"""Compares fractures from Python, meshes copied to arrays, with the same from C++ (tests/bench/fracture_loop.cpp), in turn.

usage: python_overhead.py MESH    (with the Python that pysherd is installed for, after tools/test_python.sh)
"""
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import pysherd

ROOT = pathlib.Path(__file__).resolve().parents[1]
ROUNDS = 9


def compiled(folder):
    """Returns the C++ program, which links the library of the installed module's build."""
    program = pathlib.Path(folder) / "fracture_loop"
    shared = ROOT / "build" / "release" / "shared"
    subprocess.run(["g++", "-std=c++20", "-O2", "-DOPENVDB_ABI_VERSION_NUMBER=10", ROOT / "tests" / "bench" / "fracture_loop.cpp", f"-I{ROOT / 'include'}",
                    "-I/usr/include/Imath", f"-L{shared}", f"-Wl,-rpath,{shared}", "-lsherd", "-lopenvdb", "-ltbb", "-o", program], check=True)
    return program


def in_cpp(program, mesh, resolution, count):
    printed = subprocess.run([program, mesh, str(resolution), str(count)], stdout=subprocess.PIPE, check=True, text=True).stdout.split()
    return float(printed[0]), int(printed[1])


def in_python(solid, count):
    faces, start = 0, time.perf_counter()
    for seed in range(count):
        for fragment in pysherd.fracture(solid, pieces=8, seed=seed):
            fragment.vertices, fragment.neighbor
            faces += len(fragment.faces)
    return (time.perf_counter() - start) / count, faces


def main():
    mesh = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        program = compiled(folder)
        for resolution, count in ((64, 60), (128, 20)):
            solid = pysherd.voxelize(mesh, resolution=resolution)
            pairs = []
            for _ in range(ROUNDS):
                (cpp, expected), (python, faces) = in_cpp(program, mesh, resolution, count), in_python(solid, count)
                assert faces == expected
                pairs.append((cpp, python))
            ratio = statistics.median(python / cpp for cpp, python in pairs)
            cpp, python = (statistics.median(p) for p in zip(*pairs))
            print(f"{resolution} voxels: C++ {1000 * cpp:.2f} ms, Python {1000 * python:.2f} ms a fracture, ratio {ratio:.3f}")


if __name__ == "__main__":
    main()
