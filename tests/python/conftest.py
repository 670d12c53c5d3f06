"""Shared by the tests of the Python module, which is installed: the sample, shapes and the program.

Environment: SHERD_DATA the folder with amphora.ply, SHERD_BIN the program of the C++ build.
"""
import os
import pathlib
import signal
import subprocess
import sys

import numpy as np
import pytest

import pysherd

DATA = pathlib.Path(os.environ.get("SHERD_DATA", pathlib.Path(__file__).resolve().parents[2] / "data"))
SHERD = os.environ.get("SHERD_BIN")
AMPHORA = DATA / "amphora.ply"

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it


def cube(side=1.0):
    """Vertices and faces of a cube from the origin."""
    vertices = np.array([[x, y, z] for x in (0, side) for y in (0, side) for z in (0, side)], dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))])
    return vertices, faces


class OnlyDlpack:
    """An array that only DLPack can read."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **keywords):
        return self.array.__dlpack__(**keywords)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def program(mesh, folder, *arguments):
    """Runs the program of the C++ build."""
    if not SHERD:
        pytest.skip("SHERD_BIN does not name the program")
    subprocess.run([SHERD, "fracture", mesh, "-o", folder, "--quiet", *map(str, arguments)], check=True)


def run(code, *arguments, timeout=120, **keywords):
    """Runs Python code in a process of its own."""
    return subprocess.run([sys.executable, "-c", code, *map(str, arguments)], timeout=timeout, capture_output=True, text=True, **keywords)


@pytest.fixture(scope="session")
def amphora():
    return pysherd.voxelize(AMPHORA, resolution=48)


@pytest.fixture(scope="session")
def fracture(amphora):
    return pysherd.fracture(amphora, pieces=6, seed=3)
