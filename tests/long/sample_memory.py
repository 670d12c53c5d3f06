#!/usr/bin/python3
"""Random options with points, correspondences and distance samples under --max-memory: the peak is at most the limit and 200 MB.

usage: SHERD_BIN=... [SHERD_DATA=...] sample_memory.py [COUNT] [SEED]

A run is refused with a sentence, which names an option, or keeps the limit.  Prints a line for each run.
"""
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

SHERD = os.environ["SHERD_BIN"]
DATA = pathlib.Path(os.environ.get("SHERD_DATA", pathlib.Path(__file__).resolve().parents[2] / "data"))
MORE = 200_000_000


def options_of(rng):
    """The words of a fracture."""
    def count(most):
        return str(round(10 ** rng.uniform(2, most)))
    words = ["--pieces", str(rng.randint(1, 24)), "--resolution", str(rng.choice([32, 48, 64, 96, 128])), "--seed", str(rng.randint(0, 999))]
    sampler = rng.choice(["uniform", "halton", "poisson"])
    rule = rng.choice(["area", "per-triangle"]) if sampler != "poisson" else "area"
    if rng.random() < 0.8:
        words += ["--points", count(5 if sampler == "poisson" else 6.5) if rng.random() < 0.8 else "10000000", "--point-sampler", sampler,
                  "--point-rule", rule, "--point-format", ",".join(rng.sample(["ply", "npz", "binp"], rng.randint(1, 2)))]
        words += ["--share-points"] if rng.random() < 0.6 else []
    if rng.random() < 0.6:
        words += ["--correspondences", count(7)]
    if rng.random() < 0.6:
        words += ["--sdf-samples", count(5) if rng.random() < 0.7 else "10000000", "--sdf-type", rng.choice(["float32", "float16"])]
    words += ["--write", ",".join(rng.sample(["labels", "vdb", "mesh", "preview", "boundaries", "scene", "usd", "graph", "houdini", "viewer", "proxy",
                                              "solid"], rng.randint(1, 5)))]
    if rng.random() < 0.3:
        words += ["--voxel-format", ",".join(rng.sample(["rle", "npy", "npz", "vox", "qstack", "bing"], 2))]
    return words


def run(words):
    """Status, peak bytes, standard error."""
    started = subprocess.Popen(words, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    said = started.stderr.read()
    started.stderr.close()
    _, status, used = os.wait4(started.pid, 0)
    started.returncode = os.waitstatus_to_exitcode(status)
    return started.returncode, used.ru_maxrss * 1024, said


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    rng = random.Random(int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    faults = refused = contradicting = 0
    worst = -1e18
    for i in range(count):
        words, limit = options_of(rng), rng.choice([250, 300, 400, 500, 700, 1000]) * 1_000_000
        with tempfile.TemporaryDirectory() as folder:
            status, peak, said = run([SHERD, "fracture", str(DATA / "amphora.ply"), "-o", folder + "/out", "--quiet", "--max-memory", str(limit), *words])
        errors = [line for line in said.splitlines() if "warning:" not in line]
        is_refused = status == 2 and len(errors) == 1 and re.search(r"--max-memory\)$", errors[0])
        # An .npz file holds 4 GiB, whatever memory there is.
        is_refused = is_refused or status == 5 and len(errors) == 1 and re.search(r"at most 4 GiB, .* \(--correspondences\)$", errors[0])
        contradicts = status == 2 and len(errors) == 1 and not is_refused
        good = (status == 0 or bool(is_refused) or contradicts) and peak <= limit + MORE
        faults += not good
        refused += bool(is_refused)
        contradicting += contradicts
        worst = max(worst, peak - limit) if status == 0 else worst
        print(f"{'' if good else 'FAULT '}{i} status {status} peak {peak / 1e6:.0f} of {limit / 1e6:.0f} MB {' '.join(words)} {errors[-1:]}", flush=True)
    print(f"{count} runs, {refused} refused, {faults} faults; most above the limit {worst / 1e6:.0f} MB")
    sys.exit(1 if faults or not 0 < refused < count - contradicting else 0)


if __name__ == "__main__":
    main()
