#!/usr/bin/python3
"""The same bytes on every device: 21 fractures and three datasets on the built-in device, PoCL and Mesa's rusticl.

usage: devices.py SHERD    (about twenty minutes on two cores, most of them rusticl's)
"""
import hashlib
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

AMPHORA = pathlib.Path(__file__).resolve().parents[2] / "data" / "amphora.ply"
DEVICES = {  # name: its environment
    "builtin": {},
    "Portable": {"OCL_ICD_VENDORS": "pocl.icd"},
    "llvmpipe": {"OCL_ICD_VENDORS": "rusticl.icd", "RUSTICL_ENABLE": "llvmpipe"},
}
EVERY_FILE = "--write labels,vdb,mesh,preview,seeds,boundaries,cost,fog,solid,scene,usd,graph,houdini,viewer,proxy"
FRACTURES = [  # mesh, options
    ("amphora.ply", "--pieces 6"),
    ("amphora.ply", f"--pieces 9 {EVERY_FILE} --voxel-format rle,npy,npz,vox,qstack,bing --mesh-format ply,obj,glb,stl,binm"),
    ("amphora.ply", "--growth flood --neighborhood 26 --extra-seeds 2n"),
    ("amphora.ply", "--growth chain --metric chebyshev --write labels,mesh,cost"),
    ("amphora.ply", "--growth nearest --metric manhattan --isolated keep --surface labels"),
    ("amphora.ply", "--roughness 1.5,0.7 --points 500 --point-format ply,xyz,npz,binp"),
    ("amphora.ply", "--erode-iterations 2 --erode-size 5 --erode-probability 0.7"),
    ("amphora.ply", "--erode-iterations 1 --erode-shape square --erode-on all --erode-planes --erode-islands keep"),
    ("amphora.ply", "--impact ray:0,0.2,1,0,0,-1,3 --impacts 2 --pieces 12"),
    ("amphora.ply", "--sampler halton --seeds-on surface --balance 4 --min-share 0.02"),
    ("amphora.ply", "--sampler poisson --missing 2 --drop-share 0.05 --pieces 15"),
    ("amphora.ply", "--surface labels --smooth-iterations 0.05k --smoothing laplacian --smooth-weight 0.9"),
    ("amphora.ply", "--adaptivity 0.3"),
    ("amphora.ply", "--triangles 2000,500"),
    ("amphora.ply", "--interface independent"),
    ("amphora.ply", "--preset paper --points 200"),
    ("amphora.ply", "--grain 0,1,0,2 --sdf-samples 300 --correspondences 50"),
    ("cup.obj", "--fill shell --vdb both --half --compress zip"),
    ("cup.obj", "--pieces 20 --up z --sampler gaussian"),
    ("boxes.obj", "--pieces 5 --mesh-format obj,glb"),
    ("boxes.obj", "--split-objects"),
]
DATASETS = [
    "--pieces 2..4 --repeats 2..1",
    "--pieces 3 --repeats 3 --layout packed --erode-iterations 0..2 --roughness 0..1.5",
    "--pieces 2..3 --repeats 2..1 --layout bb --missing 0..0.4 --compress zip --distinct 0.1",
]


def write_obj(path, points, faces):
    path.write_text("".join("v %g %g %g\n" % p for p in points) + "".join("f %d %d %d\n" % tuple(k + 1 for k in f) for f in faces))


def write_library(folder):
    """The amphora, an open cup, and two boxes of which one lies on the other."""
    shutil.copy(AMPHORA, folder)
    n = 24
    ring = [(math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)) for i in range(n)]
    sides = [f for i in range(n) for j in [(i + 1) % n] for f in ((i, j, n + j), (i, n + j, n + i), (2 * n, j, i))]
    write_obj(folder / "cup.obj", [(x, y, z) for z in (0.0, 1.5) for x, y in ring] + [(0.0, 0.0, 0.0)], sides)
    box = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    sides = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
    on_top = [(0.2 + 0.5 * x, 0.3 + 0.5 * y, 1 + 2 * z) for x, y, z in box]
    write_obj(folder / "boxes.obj", box + on_top, sides + [tuple(k + 8 for k in f) for f in sides])


def run(sherd, device, *args):
    subprocess.run([sherd, *args, "--device", device, "--quiet"], check=True, env={**os.environ, **DEVICES[device]},
                   stdout=subprocess.DEVNULL)


def digests(folder):
    """Hashes of the files; without a dataset's reports of a run, which have its times."""
    return {str(p.relative_to(folder)): hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(folder.rglob("*"))
            if p.is_file() and not p.name.startswith("run") and p.name != "report.html"}


def main():
    sherd = pathlib.Path(sys.argv[1]).resolve()
    for device, env in DEVICES.items():
        found = subprocess.run([sherd, "devices"], env={**os.environ, **env}, capture_output=True, text=True, check=True).stdout
        if device not in found:
            sys.exit(f"there is no device {device}")
    files, failed = 0, 0
    with tempfile.TemporaryDirectory() as temp:
        temp = pathlib.Path(temp)
        library = temp / "library"
        library.mkdir()
        write_library(library)
        jobs = [("fracture", library / mesh, "--resolution", "64", "--seed", str(i), *options.split())
                for i, (mesh, options) in enumerate(FRACTURES)]
        jobs += [("dataset", library, "--resolution", "40", *options.split()) for options in DATASETS]
        for job in jobs:
            made = {}
            for device in DEVICES:
                run(sherd, device, *job, "-o", temp / "out")
                made[device] = digests(temp / "out")
                shutil.rmtree(temp / "out")
            first = made["builtin"]
            files += len(first)
            for device, other in made.items():
                differ = [name for name in sorted(first.keys() | other.keys()) if first.get(name) != other.get(name)]
                if differ or not first:
                    failed += 1
                    print(f"builtin and {device} differ: sherd {' '.join(map(str, job))}: {', '.join(differ)}", file=sys.stderr)
    print(f"{files} files of {len(jobs)} runs on {len(DEVICES)} devices: {'the same' if not failed else f'{failed} runs differ'}")
    return failed != 0


sys.exit(main())
