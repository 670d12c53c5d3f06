#!/usr/bin/python3
"""Compare Sherd's fragments with those of Blender's add-on Cell Fracture on the same meshes.

usage: cell_fracture_study.py SHERD RESULTS.csv MESH... [options]

Breaks every mesh (closed; .obj, .ply, .stl or .off) by Cell Fracture, with its default options except
the number of seeds, and by `sherd fracture` into the resulting number of pieces.  `sherd evaluate --mesh` measures both
against the mesh in Blender, scaled to a longest side of 2.  RESULTS.csv gets two rows per
fracture; existing rows are not run again.  Prints a table in Markdown.

Needs Debian's blender (3.4.1), which includes the add-on.  A build without SHERD_GPL=ON leaves self-intersections out.
"""
import argparse
import csv
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

KEY = ["mesh", "seeds", "random_seed", "program"]
METRICS = ["fragments", "effective", "convexity", "convex_of", "sound", "open", "non_manifold", "bound_volume",
           "crossing", "crossing_pairs", "mean_angle", "under_10_degrees", "surface_error", "gap", "overlap",
           "volume_error"]
CELL, SHERD = "Cell Fracture", "Sherd"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("results", type=pathlib.Path, help="CSV file, made or continued")
    parser.add_argument("meshes", nargs="+", type=pathlib.Path, metavar="MESH")
    parser.add_argument("--seeds", type=int, nargs="+", default=[5, 10, 20], metavar="N", help="default: 5 10 20")
    parser.add_argument("--repeats", type=int, default=3, help="random seeds 1..REPEATS (default 3)")
    parser.add_argument("--resolution", type=int, default=128, help="of Sherd (default 128)")
    parser.add_argument("--blender", default="blender", help="the program")
    return parser.parse_args()


def run(command, **more):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise RuntimeError(f"{(done.stderr or done.stdout).strip()}\n(ran: {' '.join(map(str, command))})")
    return done.stdout


def evaluate(options, folder, whole):
    command = [options.sherd, "evaluate", folder, "--mesh", whole, "--json"]
    try:
        report = json.loads(run([*command, "--cgal"]))
    except RuntimeError as error:
        if "SHERD_GPL" not in str(error):
            raise
        report = json.loads(run(command))
    verdicts = [f["cgal"] for f in report["fragments"] if "cgal" in f]
    quality, error, gap = report["quality"], report["surface_error"], report["gap"]
    return {"fragments": report["pieces"], "effective": report["effective_pieces"], "convexity": report["convexity"],
            "convex_of": sum(f["convexity"] is not None for f in report["fragments"]), "sound": report["sound"],
            "open": report["open"],
            "non_manifold": sum(not f["quality"]["manifold"] and f["quality"]["closed"] for f in report["fragments"]),
            "bound_volume": sum(v["bounds_volume"] for v in verdicts) if verdicts else "",
            "crossing": sum(bool(v["self_intersections"]) for v in verdicts) if verdicts else "",
            "crossing_pairs": sum(v["self_intersections"] or 0 for v in verdicts) if verdicts else "",
            "mean_angle": quality["mean_smallest_angle"], "under_10_degrees": quality["under_10_degrees"],
            "surface_error": error["of_diagonal"]["mean"] if error else "",
            "gap": gap["of_diagonal"]["mean"] if gap else "", "overlap": report["overlap"]["share"],
            "volume_error": report["whole"]["volume_error"]}


def break_both(options, mesh, seeds, seed):
    """The two rows of one fracture."""
    with tempfile.TemporaryDirectory(prefix="sherd-cells-") as folder:
        folder = pathlib.Path(folder)
        script = pathlib.Path(__file__).with_name("cell_fracture_in_blender.py")
        run([options.blender, "--background", "--factory-startup", "--python-exit-code", 1, "--python", script, "--",
             mesh, folder / "cells", seeds, seed])
        whole = folder / "cells" / "whole.obj"
        cells = evaluate(options, folder / "cells" / "pieces", whole)
        run([options.sherd, "fracture", whole, "-o", folder / "sherd", "--pieces", cells["fragments"], "--seed", seed,
             "--resolution", options.resolution, "--write", "mesh", "--quiet"])
        ours = evaluate(options, folder / "sherd", whole)
    case = {"mesh": mesh.name, "seeds": seeds, "random_seed": seed}
    return [{**case, "program": CELL, **cells}, {**case, "program": SHERD, **ours}]


def observe_all(options):
    rows = []
    if options.results.exists():
        with options.results.open(newline="") as text:
            rows = list(csv.DictReader(text))
    known = {tuple(row[k] for k in KEY) for row in rows}
    with options.results.open("a", newline="") as text:
        writer = csv.DictWriter(text, KEY + METRICS)
        if not rows:
            writer.writeheader()
        for mesh in options.meshes:
            for seeds in options.seeds:
                for seed in range(1, options.repeats + 1):
                    if (mesh.name, str(seeds), str(seed), SHERD) in known:
                        continue
                    fresh = break_both(options, mesh, seeds, seed)
                    writer.writerows(fresh)
                    text.flush()
                    rows += [{k: "" if v is None else str(v) for k, v in row.items()} for row in fresh]
                    print(mesh.name, seeds, seed, file=sys.stderr)
    return rows


def mean(rows, metric):
    values = [float(row[metric]) for row in rows if row[metric] != ""]
    return statistics.fmean(values) if values else None


def total(rows, metric):
    return sum(int(row[metric] or 0) for row in rows)


def formatted(value, pattern):
    return "-" if value is None else pattern % value


def line(name, seeds, cells, ours):
    text = f"| {name} | {seeds} | {formatted(mean(cells, 'fragments'), '%.1f')} "
    for rows in (cells, ours):
        text += f"| {formatted(mean(rows, 'convexity'), '%.4f')} "
    text += f"| {total(cells, 'fragments') - total(cells, 'convex_of')} "
    for rows in (cells, ours):
        text += f"| {total(rows, 'sound')}/{total(rows, 'fragments')} "
    return text + "|"


def table(options, rows):
    names = [mesh.name for mesh in options.meshes]
    rows = [row for row in rows if row["mesh"] in names]
    print("| mesh | seeds | pieces | convexity, Cell Fracture | convexity, Sherd | left out | sound, Cell Fracture "
          "| sound, Sherd |\n|---|---|---|---|---|---|---|---|")
    for name in names:
        for seeds in map(str, options.seeds):
            case = [row for row in rows if (row["mesh"], row["seeds"]) == (name, seeds)]
            print(line(name, seeds, *([r for r in case if r["program"] == p] for p in (CELL, SHERD))))
    print(line("all", "", *([r for r in rows if r["program"] == p] for p in (CELL, SHERD))))
    print("\n| of all fragments | Cell Fracture | Sherd |\n|---|---|---|")
    counts = [("open", "open"), ("closed, not manifold", "non_manifold"), ("bound a volume (CGAL)", "bound_volume"),
              ("intersect themselves (CGAL)", "crossing"),
              ("pairs of triangles that cross (CGAL)", "crossing_pairs"), ("sound", "sound"),
              ("fragments", "fragments")]
    lengths = [("effective number", "effective", 1, "%.2f"), ("mean smallest angle, degrees", "mean_angle", 1, "%.1f"),
               ("triangles with an angle under 10 degrees", "under_10_degrees", 100, "%.2f %%"),
               ("surface error, of the diagonal", "surface_error", 100, "%.4f %%"),
               ("gap, of the diagonal", "gap", 100, "%.4f %%"), ("overlap", "overlap", 100, "%.4f %%"),
               ("volume error, where none is open", "volume_error", 100, "%+.3f %%")]
    both = [[r for r in rows if r["program"] == p] for p in (CELL, SHERD)]
    for title, metric in counts:
        print(f"| {title} | " + " | ".join(str(total(part, metric)) for part in both) + " |")
    for title, metric, scale, pattern in lengths:
        values = [mean(part, metric) for part in both]
        print(f"| {title} | " + " | ".join(formatted(v if v is None else scale * v, pattern) for v in values) + " |")


def main():
    options = arguments()
    table(options, observe_all(options))


if __name__ == "__main__":
    main()
