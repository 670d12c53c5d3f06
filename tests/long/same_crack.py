#!/usr/bin/python3
"""The same crack at two resolutions: fractures of random meshes and seeds in 8 pieces, at 96 and at 256 voxels.

usage: same_crack.py SHERD MESHES PAIRS [OPTION...]    (about three seconds for each pair on two cores)

A pair agrees where the centroid of each fragment moves by at most a hundredth of the longest side.  Prints those that do not, with what the
program says about the solid: another number of components, walls or gaps thinner than a voxel.
"""
import json
import math
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

SUFFIXES = {".obj", ".ply", ".stl", ".off", ".glb", ".gltf", ".fbx", ".dae", ".3mf"}


def broken(sherd, mesh, seed, resolution, folder, options):
    """The manifest of a fracture, or None, and what is printed."""
    run = subprocess.run([sherd, "fracture", mesh, "-o", folder, "--pieces", "8", "--seed", str(seed), "--resolution", str(resolution),
                          "--write", "labels", "--json", *options], capture_output=True, text=True)
    if run.returncode:
        return None, run.stderr
    manifest = json.loads((folder / "manifest.json").read_text())
    return manifest, json.loads(run.stdout)


def longest_side(manifest):
    low = [min(f["bbox"]["min"][a] for f in manifest["fragments"]) for a in range(3)]
    high = [max(f["bbox"]["max"][a] for f in manifest["fragments"]) for a in range(3)]
    return max(h - l for l, h in zip(low, high))


def main():
    sherd, meshes, pairs, options = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
    files = sorted(p for p in meshes.iterdir() if p.suffix.lower() in SUFFIXES)
    draw = random.Random(7)
    worst, agree = [], 0
    while len(worst) < pairs:
        mesh, seed = draw.choice(files), draw.randrange(1, 10**6)
        with tempfile.TemporaryDirectory() as temp:
            temp = pathlib.Path(temp)
            coarse, of_coarse = broken(sherd, mesh, seed, 96, temp / "coarse", options)
            fine, of_fine = broken(sherd, mesh, seed, 256, temp / "fine", options)
        if coarse is None or fine is None:
            print(f"{mesh.name} seed {seed}: left out, {(of_coarse if coarse is None else of_fine).strip()}", flush=True)
            continue
        side = longest_side(fine)
        ends = list(zip(coarse["fragments"], fine["fragments"]))
        moved = max(math.dist(a["centroid"], b["centroid"]) / side for a, b in ends)
        worst.append(moved)
        if moved <= 0.01 and len(coarse["fragments"]) == len(fine["fragments"]):
            agree += 1
            continue
        thin = [report["report"]["walls"]["thinnest_voxels"] for report in (of_coarse, of_fine)]
        lost = 1 - of_coarse["report"]["solid_volume"] / of_fine["report"]["solid_volume"]
        print(f"{mesh.name} seed {seed}: {100 * moved:.1f} %; components {of_coarse['components']} and {of_fine['components']}, "
              f"thinnest walls {thin[0]:.2g} and {thin[1]:.2g} voxels, {100 * lost:.1f} % of the volume between them", flush=True)
    print(f"{agree} of {pairs} pairs agree within 1 %; median {100 * statistics.median(worst):.2f} %")


main()
