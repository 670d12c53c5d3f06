#!/usr/bin/python3
"""Break real meshes by random options, and let an independent checker judge each result.

usage: random_options.py SHERD MESH_FOLDER CHECKER.py [--runs 300] [--seed 0] [--only I]

Run I draws a mesh, a number of pieces, a resolution and options from its own seed, so --only I repeats one run; it prints its
command.  Conditions: Sherd breaks the mesh or refuses it with an error (statuses 2 and 3), the checker finds no
fault, and `sherd evaluate` finds every mesh closed, manifold and outward, decimated ones too.  A fault is printed as one line with its
command, and so is a refusal.  Faults of solids thinner than a voxel at an explicit resolution are counted separately, because the
surface cannot represent them; so are fragments that erosion left with nearly no voxel half a voxel deep, whose meshes are smaller than their
voxels.  --isolated keep is not drawn, because its fragments may have several components; with --erode-islands keep they may too.
The surface error of simplified meshes (--adaptivity) may exceed the limit by that value, of decimated ones by half a voxel.
Meshes that options move away from the level set (voxel faces, smoothed, simplified, decimated) need not lie on it, nor have
their neighbor within the checker's 3/4 voxel.
"""
import argparse
import glob
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile

import pyopenvdb

PYTHON = "/usr/bin/python3"  # Debian's: numpy, scipy and pyopenvdb are there
KINDS = (".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".fbx", ".gz")
THIN_SHARE = 0.01  # the report's "thinnest" ignores 1 % of the area
MOVING = ("--surface", "--adaptivity", "--smooth-iterations")  # --surface is drawn with "labels" only
OF_COMPONENTS = ("6-connected part", "separate bodies")
OF_LEVEL_SET = ("are not on its level set", "do not face what they say")


def number(draw, low, high):
    return f"{draw.uniform(low, high):.3g}"


def drawn(draw):
    """Options of one run, each group with a probability."""
    options = []

    def perhaps(chance, *words):
        if draw.random() < chance:
            options.extend(words)
            return True
        return False

    def one_of(chance, name, *values):
        perhaps(chance, name, draw.choice(values))

    one_of(0.5, "--sampler", "uniform", "halton", "gaussian", "poisson")
    one_of(0.3, "--seeds-on", "volume", "surface")
    if perhaps(0.3, "--extra-seeds", draw.choice(("1n", "2n", "5"))):
        one_of(0.5, "--merge-metric", "euclidean", "chebyshev", "manhattan")
        one_of(0.3, "--size-spread", "1", "2.5")
    perhaps(0.15, "--impacts", str(draw.randint(1, 3)))
    growth = draw.choice(("euclid", "flood", "nearest", "chain"))
    options.extend(("--growth", growth))
    if growth == "flood":
        one_of(0.5, "--neighborhood", "6", "26")
    if growth in ("nearest", "chain"):
        one_of(0.5, "--metric", "euclidean", "chebyshev", "manhattan")
    if growth in ("euclid", "flood"):
        perhaps(0.2, "--grain", "1,2,0.5," + number(draw, -0.7, 6))
    if growth != "chain":
        perhaps(0.3, "--roughness", number(draw, 0.3, 3))
    perhaps(0.1, "--balance", str(draw.randint(1, 5)))
    perhaps(0.1, "--drop-share", number(draw, 0, 0.05))
    perhaps(0.1, "--missing", draw.choice(("1", "0.2")))
    if perhaps(0.4, "--erode-iterations", str(draw.randint(1, 3))):
        one_of(0.5, "--erode-shape", "cross", "square", "ellipse")
        one_of(0.3, "--erode-size", "3", "5")
        one_of(0.5, "--erode-on", "fracture", "all")
        one_of(0.3, "--erode-islands", "erode", "keep")
        perhaps(0.3, "--erode-probability", number(draw, 0.3, 1))
        perhaps(0.2, "--erode-threshold", number(draw, 0.6, 1))
        perhaps(0.2, "--erode-planes")
    if not perhaps(0.15, "--surface", "labels"):
        one_of(0.5, "--interface", "shared", "independent")
    perhaps(0.2, "--adaptivity", number(draw, 0.05, 0.8))
    if perhaps(0.3, "--smooth-iterations", draw.choice(("2", "10", "0.048k"))):
        perhaps(0.5, "--smooth-boundary-iterations", draw.choice(("2", "10")))
    perhaps(0.3, "--triangles", draw.choice(("500", "2000")))
    if growth == "euclid" and draw.random() < 0.6:  # drawn last, so that the other options of a run stay as they were
        options[options.index("euclid")] = "sequential"
        one_of(0.3, "--split-power", "0", "0.5", "2")
        one_of(0.3, "--split-offset", "0", "0.3")
        one_of(0.3, "--split-tilt", "0", "60")
    one_of(0.2, "--material", "ceramic", "stone", "glass", "plaster", "wood", "concrete", "ice", "tempered")
    if growth == "euclid" or growth == "nearest" and "--metric" not in options:
        one_of(0.3, "--sizes", "uniform", "lognormal:0.6", "exponential", "power:1.6")
    return options


def command_of(index, seed, meshes):
    draw = random.Random(f"{seed}/{index}")
    words = ["fracture", draw.choice(meshes), "--seed", str(draw.randrange(1000)),
             "--pieces", str(draw.choice((1, 2, 3, 5, 8, 13, 30, 80)))]
    resolution = draw.choice((None, 24, 48, 64, 96, 128))
    if resolution is not None:
        words += ["--resolution", str(resolution)]
    return words + drawn(draw) + ["--write", "labels,vdb,mesh"], resolution


def run(words, log):
    with open(log, "w") as err:
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=err, text=True)
    return done.returncode, done.stdout


def last_line(path):
    lines = open(path).read().strip().split("\n")
    return lines[-1]


def judged(sherd, checker, folder, log):
    """Faults that the checker and `sherd evaluate` find in a folder."""
    faults = []
    status, text = run([PYTHON, checker, folder, "--json"], log)
    if text:
        faults += json.loads(text)["faults"]
    elif status != 0:
        faults.append("the checker stopped: " + last_line(log))
    status, text = run([sherd, "evaluate", folder, "--samples", "1", "--json"], log)
    if status != 0:
        return faults + [f"evaluate: status {status}, {last_line(log)}"]
    for fragment in json.loads(text)["fragments"]:
        quality = fragment["quality"]
        if not (quality["closed"] and quality["manifold"] and quality["outward"]):
            faults.append(f"fragment {fragment['id']}: mesh is not sound")
    return faults


def use_decimated(folder):
    """Replace the meshes by the decimated ones."""
    for fragment in json.load(open(os.path.join(folder, "manifest.json")))["fragments"]:
        shutil.copyfile(os.path.join(folder, fragment["decimated"][0]["file"]), os.path.join(folder, fragment["files"]["mesh"]))


def of_volume(folder, fault):
    """Returns the fragment of a volume fault and the difference; None for another fault."""
    found = re.fullmatch(r"fragment (\d+): mesh volume ([^,]*), (.*) by voxels", fault)
    if found is None:
        return None
    fragments = json.load(open(os.path.join(folder, "manifest.json")))["fragments"]
    return next(f for f in fragments if f["id"] == int(found[1])), abs(float(found[2]) - float(found[3]))


def is_shallow(folder, fault):
    """Whether most voxels of the fragment lie less than half a voxel below the surface of its level set, and it lacks no more than these.

    A deeper voxel is whole in the mesh; of a layer of one voxel, which erosion at random leaves, the mesh may have a quarter.
    """
    found = of_volume(folder, fault)
    if found is None:
        return False
    fragment, lacking = found
    grid = pyopenvdb.read(os.path.join(folder, fragment["files"]["vdb"]), "surface")
    voxel_size = grid.transform.voxelSize()[0]
    shallow = sum(1 for value in grid.citerOnValues() if -0.5 * voxel_size < value.value < 0.0)
    return shallow >= 0.5 * fragment["voxels"] and lacking <= shallow * voxel_size ** 3


def is_simplified(folder, fault, off, voxel_size):
    """Whether the volume error is within that of a surface error of the checker's half a voxel plus `off`."""
    found = of_volume(folder, fault)
    return found is not None and found[1] < (0.5 + off) * voxel_size * found[0]["area"]


def option(words, name, default=None):
    return words[words.index(name) + 1] if name in words else default


def judged_by_options(sherd, checker, words, folder, voxel_size, decimated=False):
    """Faults of a folder's meshes, without those that the options imply."""
    faults = judged(sherd, checker, folder, os.path.join(folder, "..", "log"))
    if decimated or any(name in words for name in MOVING):
        faults = [fault for fault in faults if not fault.endswith(OF_LEVEL_SET)]
    if option(words, "--erode-islands") == "keep":
        faults = [fault for fault in faults if not any(text in fault for text in OF_COMPONENTS)]
    off = float(option(words, "--adaptivity", 0)) + 0.5 * decimated
    return [fault for fault in faults if off == 0 or not is_simplified(folder, fault, off, voxel_size)]


def faults_of(sherd, checker, words, folder):
    """Faults of one run, the refusal message or None, and "thin" or "shallow" if the faults are of features thinner than a voxel."""
    log = os.path.join(folder, "log")
    pieces = os.path.join(folder, "pieces")
    shutil.rmtree(pieces, ignore_errors=True)
    status, text = run([sherd] + words + ["-o", pieces, "--json"], log)
    if status in (2, 3):
        return [], last_line(log), None
    if status != 0:
        return [f"status {status}: {last_line(log)}"], None, None
    report = json.loads(text)
    walls = report["report"]["walls"] if report["report"] else None
    faults = judged_by_options(sherd, checker, words, pieces, report["voxel_size"])
    asked = int(option(words, "--pieces"))
    if report["fragments"] != max(asked, report["components"]):
        faults.append(f"{report['fragments']} fragments, expected {asked} of {report['components']} components")
    decimated = not faults and "--triangles" in words
    if decimated:
        use_decimated(pieces)
        faults = judged_by_options(sherd, checker, words, pieces, report["voxel_size"], decimated)
    what = "thin" if walls is not None and walls["thin_share"] > THIN_SHARE else None
    if faults and all(is_shallow(pieces, fault) for fault in faults):
        what = "shallow"
    return ["decimated: " * decimated + fault for fault in faults], None, what


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("sherd")
    parser.add_argument("meshes")
    parser.add_argument("checker")
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int)
    args = parser.parse_args()
    os.environ["OCL_ICD_VENDORS"] = "pocl.icd"
    meshes = sorted(m for m in glob.glob(os.path.join(args.meshes, "*")) if m.lower().endswith(KINDS))
    refused = thin = failed = 0
    runs = range(args.runs) if args.only is None else [args.only]
    with tempfile.TemporaryDirectory() as folder:
        for index in runs:
            words, resolution = command_of(index, args.seed, meshes)
            faults, refusal, what = faults_of(args.sherd, args.checker, words, folder)
            if refusal is not None:
                refused += 1
                print(f"refused {index}: {refusal} | {' '.join(words)}", flush=True)
            if not faults:
                continue
            allowed = what == "shallow" or what == "thin" and resolution is not None
            thin += allowed
            failed += not allowed
            print(f"{what if allowed else 'FAULT'} {index}: {'; '.join(faults[:3])}"
                  f"{f'; and {len(faults) - 3} more' if len(faults) > 3 else ''} | {' '.join(words)}", flush=True)
    print(f"{len(runs)} runs, {refused} refused, {thin} with faults of features thinner than a voxel; {failed} faults")
    sys.exit(failed > 0)


main()
