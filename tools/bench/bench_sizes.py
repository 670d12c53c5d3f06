#!/usr/bin/python3
"""Break one mesh at increasing resolutions, and print the time of each stage as a table in Markdown.

usage: bench_sizes.py SHERD MESH [RESOLUTION...]    (default: 64 128 256 512 1024)

Ten pieces with `.vdb`, `.rle` and `.ply`, each size once, after a warm-up of PoCL's kernel cache.  Beside the
seconds of a stage is its least memory traffic (data read and written once) per second, as a share of the machine's copy
bandwidth: bytes that all cores copy between arrays larger than the caches, measured in the same run.

    voxelize   distances of the band, 4 bytes: some three voxels per face of the meshes
    grow       a bit per inside voxel and 2 bytes for its label
    extract    distances and labels of the band, and the meshes: 24 bytes a vertex, 14 a triangle
    write      the files' bytes, read and written

Needs Debian's python3-numpy.
"""
import concurrent.futures
import json
import multiprocessing.pool
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "studies"))
from mesh_file import read_ply  # noqa: E402

STAGES = ("voxelize", "grow", "extract", "write")


def copy_bandwidth():
    """Bytes read and written per second, the best of five."""
    cores = len(os.sched_getaffinity(0))
    arrays = [(np.ones(1 << 25), np.zeros(1 << 25)) for _ in range(cores)]
    best = 0.0
    with multiprocessing.pool.ThreadPool(cores) as pool:
        for _ in range(5):
            begin = time.perf_counter()
            pool.map(lambda pair: np.copyto(pair[1], pair[0]), arrays)
            best = max(best, 2 * sum(a.nbytes for a, _ in arrays) / (time.perf_counter() - begin))
    return best


def broken(sherd, mesh, resolution, out):
    """The report of one run, and its peak memory in bytes."""
    process = subprocess.Popen([sherd, "fracture", mesh, "-o", out, "--pieces", "10", "--resolution", str(resolution),
                                "--write", "labels,vdb,mesh", "--json"], stdout=subprocess.PIPE)
    report = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"bench_sizes.py: {sherd} failed at {resolution}")
    return json.loads(report), usage.ru_maxrss * 1024


def least_bytes(report, folder):
    vertices = faces = 0
    for ply in (folder / "meshes").iterdir():
        mesh = read_ply(ply)
        vertices, faces = vertices + len(mesh["vertex"]), faces + len(mesh["face"])
    band = 3 * faces
    files = sum(f.stat().st_size for f in folder.rglob("*") if f.is_file())
    return faces, {"voxelize": 4 * band, "grow": report["voxels"] * (2 + 1 / 8),
                   "extract": 6 * band + 24 * vertices + 14 * faces, "write": 2 * files}


def main(sherd, mesh, *resolutions):
    with concurrent.futures.ProcessPoolExecutor(1) as another:  # a child's peak memory includes its parent's
        bandwidth = another.submit(copy_bandwidth).result()
    print(f"`{pathlib.Path(mesh).name}`, copy bandwidth {bandwidth / 1e9:.1f} GB/s.\n")
    print("| resolution | voxels inside | faces | " + " | ".join(STAGES) + " | total | ns a voxel | peak memory |")
    print("|" + "---|" * (len(STAGES) + 6))
    with tempfile.TemporaryDirectory() as scratch:
        for i, resolution in enumerate((64, *map(int, resolutions or (64, 128, 256, 512, 1024)))):
            folder = pathlib.Path(scratch) / str(i)
            report, peak = broken(sherd, mesh, resolution, folder)
            if i == 0:
                continue
            faces, least = least_bytes(report, folder)
            seconds = report["seconds"]
            cells = [f"{seconds[s]:.2f} s, {100 * least[s] / seconds[s] / bandwidth:.1f} %" for s in STAGES]
            print(f"| {resolution} | {report['voxels'] / 1e6:.2f} M | {faces / 1e6:.2f} M | " + " | ".join(cells) +
                  f" | {seconds['total']:.2f} s | {1e9 * seconds['total'] / report['voxels']:.0f} | {peak / 1e9:.2f} GB |",
                  flush=True)
            subprocess.run(["rm", "-r", folder], check=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
