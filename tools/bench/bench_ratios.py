#!/usr/bin/python3
"""Print what `sherd_bench` measured as ratios to programs that do the same or less, as a table in Markdown.

usage: bench_ratios.py RESULTS.json    (of sherd_bench --benchmark_format=json; tools/bench/bench.sh --ratios runs it)

Ratios are of medians of the wall-clock time in one run: Sherd's to the other's.
"""
import json
import pathlib
import sys

# What is compared, Sherd's benchmark, the other's.
PAIRS = [
    *[(f"flood, ball of {n} voxels, to a serial queue over a dense array", f"grow/device/{n}/0", f"grow/serial_queue/{n}") for n in (128, 256, 512)],
    *[(f"flood, ball of {n} voxels, to the paper's two stacks on PoCL", f"grow/device/{n}/0", f"grow/two_stacks/{n}") for n in (128, 256, 512)],
    *[(f"voxelizing {t} triangles at {n} voxels, to `meshToLevelSet`", f"voxelize/{s}/{n}", f"meshToLevelSet/{s}/{n}")
      for s, t, n in ((24, "2,304", 128), (98, "38,416", 128), (392, "614,656", 128), (581, "1,350,244", 128), (581, "1,350,244", 512))],
    ("extraction of a ball, to `volumeToMesh` of its fragments", "extract/shared", "extract/bare_meshes"),
    ("the same, `--interface independent`", "extract/independent", "extract/bare_meshes"),
    ("extraction in a dataset, to `volumeToMesh` of its fragments", "library/extract", "library/bare_meshes"),
    ("the same with level sets", "library/extract_level_sets", "library/bare_meshes")]


def medians(results):
    """Milliseconds by name, without the suffixes of benchmarks."""
    units = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
    runs = {}
    for run in json.loads(results)["benchmarks"]:
        if run.get("aggregate_name", "median") == "median":
            runs[run["run_name"].removesuffix("/real_time")] = run["real_time"] * units[run["time_unit"]]
    return runs


def main(path):
    measured = medians(pathlib.Path(path).read_text())
    print("| | Sherd | other | ratio |\n|---|---|---|---|")
    for name, own, other in PAIRS:
        if own in measured and other in measured:
            print(f"| {name} | {measured[own]:,.1f} ms | {measured[other]:,.1f} ms | {measured[own] / measured[other]:.2f} |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
