#!/usr/bin/python3
"""Measure what each option of a fracture leaves of the shortcuts that a network could take.

usage: shortcut_study.py SHERD MESH... [--seeds N]

Breaks every MESH with each set of options and each seed, and measures by `sherd evaluate --statistics`, as means over fractures:
vertices that are a neighbor's too, the power of the grid of voxels and the share of fragments in which it is found, the median gap
between the two sides of cracks and the rms of their difference, in % of the diagonal.  A mesh in the
pose of its file has its own planes along the axes of the grid: these count as the grid.  Prints a table in Markdown.
"""
import argparse
import json
import pathlib
import shlex
import statistics
import sys
import tempfile

from realism_study import run

PIECES, RESOLUTION = 8, 64
NONE = "--roughness 0 --mismatch 0% --scan-noise 0% --missing 0"
SETS = {
    "default": "--surface auto",
    "`--surface smooth`": "--surface smooth",
    "`--interface independent`": "--interface independent",
    "with `--roughness 0.7%`": "--interface independent --roughness 0.7%",
    "with `--mismatch 0.15%`": "--interface independent --mismatch 0.15%",
    "with `--scan-noise 0.05%`": "--interface independent --scan-noise 0.05%",
    "with `--extra-seeds 2n --size-spread 1`": "--interface independent --extra-seeds 2n --size-spread 1",
    "`--preset training`, nothing drawn": "--preset training " + NONE,
    "`--preset training`": "--preset training",
    "`--material stone`": "--material stone",
}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("meshes", nargs="+", type=pathlib.Path, metavar="MESH")
    parser.add_argument("--seeds", type=int, default=3, help="fractures of each mesh and set (default 3)")
    return parser.parse_args()


def figures(sherd, mesh, options, seed, folder):
    """What one fracture leaves; None where it cannot be measured."""
    run(sherd, "fracture", mesh, "-o", folder, "--pieces", PIECES, "--resolution", RESOLUTION, "--seed", seed, "--quiet", "--write",
        "labels,mesh", *shlex.split(options))
    found = json.loads(run(sherd, "evaluate", folder, "--statistics", "--json"))["statistics"]
    joints, grid = found["joints"] or {}, found["grid"] or {}
    return {
        "coincident": 100.0 * found["coincident"],
        "power": grid.get("power"),
        "found": 100.0 * grid["found"] if grid else None,
        "gap": 100.0 * joints["gap"][1] if joints else None,
        "difference": 100.0 * joints["difference"] if joints.get("difference") is not None else None,
    }


def row(sherd, meshes, options, seeds):
    """Means over all fractures of a set."""
    with tempfile.TemporaryDirectory() as folder:
        all_ = [figures(sherd, mesh, options, seed, pathlib.Path(folder) / "pieces") for mesh in meshes for seed in range(seeds)]
    measured = {key: [one[key] for one in all_ if one[key] is not None] for key in all_[0]}
    return {key: statistics.mean(values) if values else None for key, values in measured.items()}


def main():
    args = arguments()
    print("| | coincident, % | power of the grid | found, % | median gap, % | difference, % |")
    print("|---|---|---|---|---|---|")
    for name, options in SETS.items():
        means = row(args.sherd, args.meshes, options, args.seeds)
        print("| " + name + " | " + " | ".join("" if value is None else f"{value:.3g}" for value in means.values()) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
