#!/usr/bin/python3
"""A ball in a box of more than 2^31 voxels, a thousand million of them inside: its pieces add up to it.

usage: large.py SHERD [RESOLUTION]    (default: 1300, which takes two minutes, 8 GB of memory and 2 GB of disk; where the device has no buffer
of 2.3 GB for that, as many voxels as it has one for, which is printed)

The voxels of `labels.rle` and the volumes of the meshes are added up here, and compared with the ball's; `sherd evaluate`
looks at the meshes' edges.  Needs what tests/cli/cli_test.py needs.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

if len(sys.argv) not in (2, 3):
    sys.exit(__doc__)
os.environ["SHERD_BIN"] = sys.argv[1]
sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "cli"))
from cli_test import sphere, write_obj
from ply_file import columns, read_ply

FULL, FULL_BUFFER = 1300, 2278 << 20  # bytes of the largest buffer that this resolution needs
STEPS = 400  # of latitude: the polyhedron has 0.999974 of the ball's volume


def volume(points, faces):
    a, b, c = points[faces[:, 0]], points[faces[:, 1]], points[faces[:, 2]]
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def mesh_volume(ply):
    _, vertices, faces = read_ply(ply)
    return volume(columns(vertices, *"xyz"), faces["vertex_indices"])


def resolution_for(sherd):
    """1300, or what the device's largest buffer holds."""
    devices = json.loads(subprocess.run([sherd, "devices", "--json"], stdout=subprocess.PIPE, check=True).stdout)["devices"]
    largest = next(device["largest_buffer_bytes"] for device in devices if device["chosen"])
    if largest >= FULL_BUFFER:
        return FULL
    fitting = int(FULL * (largest / FULL_BUFFER) ** (1 / 3)) // 10 * 10
    print(f"the device allows buffers of {largest >> 20} MiB, {FULL_BUFFER >> 20} are needed for {FULL} voxels: {fitting} here")
    return fitting


def main(sherd, resolution=None):
    resolution = resolution or str(resolution_for(sherd))
    with tempfile.TemporaryDirectory() as scratch:
        ball, out = pathlib.Path(scratch) / "ball.obj", pathlib.Path(scratch) / "out"
        mesh = sphere(STEPS, 2 * STEPS)
        write_obj(ball, mesh)
        whole = volume(*map(np.array, mesh))
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

        reported = subprocess.run([sherd, "evaluate", out, "--json"], capture_output=True, text=True)
        assert reported.returncode == 0, reported.stderr
        evaluated = json.loads(reported.stdout)
        assert evaluated["sound"] == evaluated["pieces"] == len(inside), evaluated["sound"]
        print(f"{dims.prod() / 1e9:.2f} thousand million voxels, {inside.sum() / 1e9:.2f} inside, in {len(inside)} pieces; "
              f"voxels are off by {off['voxels']:.1e}, meshes by {off['meshes']:.1e}; {usage.ru_maxrss / 1e6:.1f} GB")


if __name__ == "__main__":
    main(*sys.argv[1:])
