#!/usr/bin/python3
"""Study how extra seeds change the convexity of the pieces: the experiment of the paper's Figure 14.

usage: convexity_study.py SHERD RESULTS.csv VESSEL... [options]

Breaks every vessel (a closed mesh) into each number of pieces, with each number of extra seeds and each random seed, by
`sherd fracture`, and takes the mean convexity of the pieces from `sherd evaluate`.  RESULTS.csv gets a row per fracture;
existing rows are not run again, so a stopped study continues.  Prints a table in Markdown and
draws the plot.

A fracture counts as one observation: its pieces are not independent.  A mean's standard error is over the fractures.
A difference is between fractures of the same vessel, pieces and seed, and averaged per vessel; its standard error
is over the vessels, so it generalizes to similar vessels.

Needs Debian's python3-numpy, and python3-matplotlib for the plot.
"""
import argparse
import concurrent.futures
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

COLUMNS = ["vessel", "resolution", "samples", "pieces", "extra_seeds", "seed", "fragments", "convexity"]
KEY = COLUMNS[:6]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("results", type=pathlib.Path, help="CSV file, made or continued")
    parser.add_argument("vessels", nargs="+", type=pathlib.Path, metavar="VESSEL", help="a closed mesh")
    parser.add_argument("--pieces", type=int, nargs="+", default=range(3, 9), metavar="N", help="default: 3 to 8")
    parser.add_argument("--seeds", type=int, default=20, help="random seeds 1..SEEDS per setting (default 20)")
    parser.add_argument("--extra-seeds", nargs="+", default=["0", "1n", "2n"], metavar="E",
                        help="values of sherd's --extra-seeds (default 0 1n 2n); it is not passed for 0")
    parser.add_argument("--resolution", type=int, default=128, help="voxels along the longest side (default 128)")
    parser.add_argument("--samples", type=int, default=5000, help="surface points per fragment (default 5000)")
    parser.add_argument("--jobs", type=int, default=1, help="fractures at a time, one thread each if more than one")
    parser.add_argument("--plot", type=pathlib.Path, help="PNG to draw, such as docs/images/convexity.png")
    return parser.parse_args()


def run(command, threads):
    limits = {"POCL_MAX_PTHREAD_COUNT": str(threads)} if threads else {}
    done = subprocess.run(command, env={**os.environ, **limits}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{done.stderr.strip()}\n(ran: {' '.join(map(str, command))})")
    return done.stdout


def observe(options, vessel, case):
    """Break one vessel; the row of the results."""
    threads = 1 if options.jobs > 1 else 0
    with tempfile.TemporaryDirectory(prefix="sherd-convexity-") as folder:
        extra = [] if case["extra_seeds"] == "0" else ["--extra-seeds", case["extra_seeds"]]
        limits = ["--threads", str(threads)] if threads else []
        run([options.sherd, "fracture", vessel, "-o", folder, "--pieces", case["pieces"], "--seed", case["seed"],
             "--resolution", case["resolution"], "--write", "mesh", "--quiet", *extra, *limits], threads)
        report = json.loads(run([options.sherd, "evaluate", folder, "--samples", case["samples"], "--json"], threads))
    return {**case, "fragments": str(report["pieces"]), "convexity": repr(report["convexity"])}


def cases(options):
    for vessel in options.vessels:
        for seed in range(1, options.seeds + 1):
            for pieces in options.pieces:
                for extra in options.extra_seeds:
                    values = [vessel.name, options.resolution, options.samples, pieces, extra, seed]
                    yield vessel, dict(zip(KEY, map(str, values)))


def read_results(file):
    if not file.exists():
        return {}
    with file.open(newline="") as text:
        return {tuple(row[k] for k in KEY): row for row in csv.DictReader(text)}


def observe_all(options):
    """The rows of all cases, in their order; new ones are appended to the file when they finish."""
    wanted = list(cases(options))
    known = read_results(options.results)
    missing = [(vessel, case) for vessel, case in wanted if tuple(case.values()) not in known]
    fresh = not options.results.exists()
    with options.results.open("a", newline="") as text, \
            concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        writer = csv.DictWriter(text, COLUMNS)
        if fresh:
            writer.writeheader()
        futures = [pool.submit(observe, options, vessel, case) for vessel, case in missing]
        try:
            for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
                row = future.result()
                known[tuple(row[k] for k in KEY)] = row
                writer.writerow(row)
                text.flush()
                if sys.stderr.isatty():
                    print(f"\r{done} of {len(missing)} fractures", end="", file=sys.stderr)
        finally:
            for future in futures:
                future.cancel()
    if missing and sys.stderr.isatty():
        print(file=sys.stderr)
    return [known[tuple(case.values())] for _, case in wanted]


def values_by_setting(options, rows):
    """Convexity as an array [pieces, extra seeds, vessel, seed]: the order of the rows is known."""
    values = np.array([float(row["convexity"]) for row in rows])
    shape = (len(options.vessels), options.seeds, len(options.pieces), len(options.extra_seeds))
    return values.reshape(shape).transpose(2, 3, 0, 1)


def standard_error(values):
    return values.std(ddof=1) / np.sqrt(values.size) if values.size > 1 else float("nan")


def mean_and_error(values, sign=""):
    error = standard_error(values)
    return f"{values.mean():{sign}.4f} ± {error:.4f}" if np.isfinite(error) else f"{values.mean():{sign}.4f}"


def table(options, values):
    extra = options.extra_seeds
    steps = [f"{b} less {a}" for a, b in zip(extra, extra[1:])]
    lines = ["| pieces | " + " | ".join(extra + steps) + " |", "|---" * (1 + len(extra) + len(steps)) + "|"]
    names = [str(n) for n in options.pieces] + ["all"]
    for name, cell in zip(names, [*values, values.mean(axis=0)]):  # [extra seeds, vessel, seed]
        means = [mean_and_error(v.ravel()) for v in cell]
        differences = [mean_and_error((b - a).mean(axis=1), "+") for a, b in zip(cell, cell[1:])]
        lines.append(f"| {name} | " + " | ".join(means + differences) + " |")
    lines.append("")
    lines.append(f"Vessels: {len(options.vessels)}; seeds: {options.seeds}; voxels along the longest side: "
                 f"{options.resolution}; points per fragment: {options.samples}.")
    if len(extra) > 1:
        falling = (np.diff(values.mean(axis=3), axis=1) < 0).all(axis=1)  # [pieces, vessel]
        lines.append(f"Convexity falls at each step of extra seeds ({', '.join(extra)}) in {falling.sum()} of "
                     f"{falling.size} pairs of vessel and pieces, and for {falling.all(axis=0).sum()} of "
                     f"{falling.shape[1]} vessels at every number of pieces.")
    return "\n".join(lines)


def plot(options, values):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(6.4, 4.0), dpi=150)
    count = len(options.extra_seeds)
    for k, (name, color, marker) in enumerate(zip(options.extra_seeds, ["#1b6ca8", "#d98324", "#7a3b69", "#4f7942"] * 9,
                                                   "osD^" * 9)):
        means = [cell[k].mean() for cell in values]
        errors = [standard_error(cell[k].ravel()) for cell in values]
        at = np.array(options.pieces) + 0.06 * (k - (count - 1) / 2)  # side by side, so that bars stay apart
        label = "no extra seeds" if name == "0" else f"{name.replace('1n', 'n')} extra seeds"
        axes.errorbar(at, means, yerr=np.nan_to_num(errors), label=label, color=color, marker=marker, markersize=4.5, linewidth=1.3,
                      capsize=2.5)
    axes.set_xticks(list(options.pieces))
    axes.set_xlabel("pieces n")
    axes.set_ylabel("convexity, mean of the pieces")
    axes.grid(axis="y", linewidth=0.4, alpha=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(options.plot, metadata={"Software": None})


def main():
    options = arguments()
    options.pieces = list(options.pieces)
    if len({vessel.name for vessel in options.vessels}) < len(options.vessels):
        sys.exit("convexity_study.py: two vessels have the same file name")
    try:
        rows = observe_all(options)
    except RuntimeError as error:
        sys.exit(f"convexity_study.py: {error}")
    values = values_by_setting(options, rows)
    print(table(options, values))
    if options.plot:
        plot(options, values)


if __name__ == "__main__":
    main()
