#!/usr/bin/python3
"""Reproduces the paper's Table 1: storage of fragments in every format, plain and zipped.

usage: table1.py SHERD VESSEL_FOLDER [--per-vessel N] [--seed S]

VESSEL_FOLDER holds meshes of vessels; the table in docs/formats.md is of 20, made by make_vessels.py --scale 0.2.  The paper
broke 200 into 2 to 10 pieces, 15 times for 2 pieces and 5 times for 10, interpolated between, at 64 and at 128 voxels: 87 grids of
fragments and one of the intact object per vessel.  Here each vessel is broken N times at each resolution, with another number of
pieces each time; the mean size for a number of pieces is weighted by the paper's repeats, for 200 vessels.

Meshes are the paper's (--preset paper), decimated to 5000 triangles: the sizes of its files imply some 4600.  It sampled 4096 points on
each.  Files are zipped separately at zlib's highest level.  GB are 2^30 bytes, as in the paper.
"""
import argparse
import collections
import pathlib
import subprocess
import tempfile
import zlib

PAPER = {  # 64 zipped, 64 plain, 128 zipped, 128 plain
    "raw grid (.bing)": (0.09, 8.59, 0.57, 68.75), "MagicaVoxel (.vox)": (5.09, 17.19, 44.88, 137.52),
    "runs (.rle)": (0.08, 1.99, 0.32, 8.10), "QuadStack (.qstack)": (0.21, 0.92, 0.65, 2.94),
    "points (.ply)": (4.34, 8.22, 4.38, 8.22), "points (.xyz)": (3.93, 9.13, 3.96, 9.12),
    "points (.binp)": (0.97, 0.98, 1.00, 1.04), "mesh (.obj)": (4.98, 13.89, 5.80, 16.42),
    "mesh (.stl, text)": (17.37, 79.82, 16.40, 94.61), "mesh (.binm)": (4.23, 16.92, 4.85, 19.84)}
ROWS = {"labels.bing": "raw grid (.bing)", "labels.vox": "MagicaVoxel (.vox)", "labels.rle": "runs (.rle)",
        "labels.qstack": "QuadStack (.qstack)", "labels.npz": "array (.npz)", "vdb": "level sets (.vdb)",
        "half": "level sets (.vdb, half)", "points.ply": "points (.ply)", "points.xyz": "points (.xyz)",
        "points.binp": "points (.binp)", "mesh.obj": "mesh (.obj)", "mesh.stl": "mesh (.stl, text)",
        "mesh.binm": "mesh (.binm)"}
VESSELS = 200
REPEATS = {n: int(15 + (5 - 15) * (n - 2) / 8) for n in range(2, 11)}


def zipped(data):
    """Bytes of its entry in a ZIP file: deflated, two headers and the end, names of 30 bytes."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return len(packer.compress(data)) + len(packer.flush()) + 30 + 46 + 22 + 2 * 30


def fractured(sherd, mesh, pieces, resolution, seed):
    """Per kind of file, the bytes of one fracture's, plain and zipped."""
    sizes = collections.defaultdict(lambda: [0, 0])

    def run(*options):
        subprocess.run([sherd, "fracture", mesh, "-o", folder, "--preset", "paper", "--pieces", str(pieces), "--resolution",
                        str(resolution), "--seed", str(seed), "--quiet", *options], check=True)

    def count(kind, path):
        data = path.read_bytes()
        sizes[kind][0] += len(data)
        sizes[kind][1] += zipped(data)

    with tempfile.TemporaryDirectory() as folder:
        run("--write", "labels,vdb,mesh", "--voxel-format", "rle,npz,vox,qstack,bing", "--mesh-format", "obj,stl-ascii,binm",
            "--triangles", "5000", "--points", "4096", "--point-format", "ply,xyz,binp")
        root = pathlib.Path(folder)
        for path in root.glob("labels.*"):
            count(path.name, path)
        for path in root.glob("fragments/*.vdb"):
            count("vdb", path)
        for path in root.glob("points/*"):
            count("points" + path.suffix, path)
        for path in root.glob("meshes/*_t5000.*"):
            count("mesh" + path.suffix, path)
        run("--write", "vdb", "--half")
        for path in root.glob("fragments/*.vdb"):
            count("half", path)
    return sizes


def gigabytes(samples):
    """[kind] GB, plain and zipped, of the whole data set of the paper."""
    totals = collections.defaultdict(lambda: [0.0, 0.0])
    for pieces, repeats in REPEATS.items():
        of_pieces = samples[pieces]
        for sizes in of_pieces:
            for kind, both in sizes.items():
                for i, size in enumerate(both):
                    totals[kind][i] += size / len(of_pieces) * repeats * VESSELS / 2 ** 30
    for kind, both in totals.items():  # the intact vessel: a separate grid
        for i in range(2):
            both[i] *= 88 / 87 if kind.startswith("labels") else 449 / 448
    return totals


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sherd")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--per-vessel", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    vessels = sorted(p for p in arguments.folder.iterdir() if p.suffix in (".ply", ".obj", ".stl"))
    if len(vessels) * arguments.per_vessel < len(REPEATS):
        parser.error("fewer fractures than numbers of pieces; raise --per-vessel")
    tables = {}
    for resolution in (64, 128):
        samples, case = collections.defaultdict(list), 0
        for vessel in vessels:
            for _ in range(arguments.per_vessel):
                pieces = 2 + case % 9
                samples[pieces].append(fractured(arguments.sherd, vessel, pieces, resolution, arguments.seed + case))
                case += 1
        tables[resolution] = gigabytes(samples)
    print("| | 64 | 128 | paper, 64 | paper, 128 |\n|---|---|---|---|---|")
    for kind, name in ROWS.items():
        cells = [f"{tables[r][kind][1]:.2f} ({tables[r][kind][0]:.2f})" for r in (64, 128)]
        if name in PAPER:
            a, b, c, d = PAPER[name]
            cells += [f"{a:.2f} ({b:.2f})", f"{c:.2f} ({d:.2f})"]
        else:
            cells += ["", ""]
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
