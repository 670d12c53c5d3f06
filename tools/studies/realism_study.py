#!/usr/bin/python3
"""Study the shapes of fragments beside those of nature: faces, vertices, corners, contacts, sizes and roughness.

usage: realism_study.py SHERD RESULTS.csv block|plate|vessels|crack [MESH...] [options]

- block: a cube in 500 pieces.  Where cells are those of seeds (`euclid`, `nearest`), the exact cells of the same seeds,
  clipped to the block, are computed by scipy, and their faces compared with the measured ones.
- plate: 1 x 1 x 1/32 in 100 pieces: corners of the pieces that have no part of the rim.  Those of `sequential` are compared
  with the polygons that the recorded splits cut out of the plate.
- vessels: each MESH in 7, 9, 11, 28 and 60 pieces: contacts per piece.
- crack: a block of sides 0.5, 1, 1 in 2 pieces, by two seeds whose bisector is a plane across its middle, with
  `--options "--roughness ..."`: Hurst exponents along z, the propagation, and along y, the front.

Breaks by `sherd fracture` and measures by `sherd evaluate --statistics`.  RESULTS.csv gets a row per fracture; existing rows are
not run again, so a stopped study continues.  Prints a table in Markdown.  A mean's standard error is over the fractures.

Needs Debian's python3-numpy and python3-scipy.
"""
import argparse
import csv
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile

import numpy as np
import scipy.spatial

import split_polygons

KEY = ["study", "mesh", "growth", "options", "resolution", "pieces", "seed"]
MEANS = ["interior_faces", "interior_vertices", "interior_neighbors", "faces", "flat_faces", "flat_vertices", "corners",
         "contacts", "neighbors"]
METRICS = ["faces_by", *MEANS, "interior", "cornered", "break_share", "exponential_p", "lognormal_s", "lognormal_p", "tau",
           "tau_p", "least_orientation", "hurst_propagation", "hurst_front", "exact_faces", "exact_faces_counted",
           "exact_vertices", "same_faces", "same_vertices", "face_difference", "exact_corners_all", "exact_corners",
           "exact_corners_counted", "same_corners", "corner_difference"]
PIECES = {"block": [500], "plate": [100], "vessels": [7, 9, 11, 28, 60], "crack": [2]}
SIDES = {"block": (1, 1, 1), "plate": (1, 1, 1 / 32), "crack": (0.5, 1, 1)}
CRACK_SEEDS = [(0.125, 0.5, 0.5), (0.375, 0.5, 0.5)]
POTS = {7: "2.9", 9: "3.3", 11: "3.1, 3.8", 28: "4.9", 31: "4.0"}  # real pots of so many sherds, docs/realism.md


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("results", type=pathlib.Path, help="CSV file, made or continued")
    parser.add_argument("study", choices=PIECES)
    parser.add_argument("meshes", nargs="*", type=pathlib.Path, metavar="MESH", help="vessels, closed meshes")
    parser.add_argument("--growth", nargs="+", default=["euclid"], help="default: euclid")
    parser.add_argument("--pieces", type=int, nargs="+", metavar="N")
    parser.add_argument("--seeds", type=int, default=5, help="random seeds 1..SEEDS (default 5)")
    parser.add_argument("--resolution", type=int, default=128, help="voxels along the longest side (default 128)")
    parser.add_argument("--options", default="", help="further options of sherd fracture, one string")
    return parser.parse_args()


def run(*command):
    done = subprocess.run([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{done.stderr.strip()}\n(ran: {' '.join(map(str, command))})")
    return done.stdout


def write_box(path, sides):
    corners = [[sides[axis] * (i >> axis & 1) for axis in range(3)] for i in range(8)]
    faces = [(1, 5, 7), (1, 7, 3), (2, 4, 8), (2, 8, 6), (1, 2, 6), (1, 6, 5), (3, 7, 8), (3, 8, 4), (1, 3, 4), (1, 4, 2),
             (5, 6, 8), (5, 8, 7)]
    path.write_text("".join("v %r %r %r\n" % tuple(c) for c in corners) + "".join("f %d %d %d\n" % f for f in faces))


def exact_cells(seeds, sides):
    """Of each cell in a box, {neighbor: area}, below 0 for walls, and the number of vertices.

    The walls are planes between seeds and their mirror images.
    """
    images = [seeds]
    for axis in range(3):
        for wall in (0.0, sides[axis]):
            image = seeds.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            images.append(image)
    diagram = scipy.spatial.Voronoi(np.concatenate(images))
    cells = [{} for _ in seeds]
    for pair, ridge in zip(diagram.ridge_points, diagram.ridge_vertices):
        if -1 in ridge or min(pair) >= len(seeds):
            continue
        corners = diagram.vertices[ridge]
        edges = corners - corners[0]
        area = np.linalg.norm(np.cross(edges[1:-1], edges[2:]).sum(axis=0)) / 2
        for a, b in (pair, pair[::-1]):
            if a < len(seeds):
                cells[a][int(b) if b < len(seeds) else -1 - int(b)] = area
    return cells, [len(diagram.regions[diagram.point_region[i]]) for i in range(len(seeds))]


def beside_exact(folder, sides, report):
    """Figures of the cells that touch no wall, exact and measured."""
    listed = json.loads((folder / "seeds.json").read_text())["seeds"]
    cells, vertices = exact_cells(np.array([seed["position"] for seed in listed]), sides)
    measured = {fragment["id"]: fragment for fragment in report["fragments"]}
    least = report["statistics"]["least_area"]
    inner = [i for i, cell in enumerate(cells) if min(cell) >= 0]
    counted = np.array([sum(area >= least for area in cells[i].values()) for i in inner])
    found = np.array([measured[listed[i]["fragment"]]["faces"] for i in inner])
    return {"exact_faces": np.mean([len(cells[i]) for i in inner]), "exact_faces_counted": counted.mean(),
            "exact_vertices": np.mean([vertices[i] for i in inner]), "same_faces": found.mean(),
            "same_vertices": np.mean([measured[listed[i]["fragment"]]["vertices"] for i in inner]),
            "face_difference": np.abs(found - counted).mean()}


def beside_polygons(folder, sides, report):
    """Corners of a plate's pieces, exact and measured.

    Counted are corners whose edges are at least a voxel long: shorter ones have no voxels of their own.
    """
    polygons = split_polygons.polygons_of(json.loads((folder / "manifest.json").read_text()), sides)
    unit = report["statistics"]["unit"]
    measured = {fragment["id"]: fragment["corners"] for fragment in report["fragments"]}
    inner = [i for i in polygons if not split_polygons.has_rim(polygons[i])]
    both = [i for i in inner if measured[i] is not None]
    counted = np.array([(split_polygons.edge_lengths(polygons[i]) >= unit).sum() for i in both])
    found = np.array([measured[i] for i in both])
    return {"exact_corners_all": np.mean([len(polygon) for polygon in polygons.values()]),
            "exact_corners": np.mean([len(polygons[i]) for i in inner]), "exact_corners_counted": counted.mean(),
            "same_corners": found.mean(), "corner_difference": np.abs(found - counted).mean()}


def metrics(report):
    statistics = report["statistics"]
    row = {name: statistics[name]["mean"] if statistics[name] else "" for name in MEANS}
    for name, of in (("interior", "interior_faces"), ("cornered", "corners")):
        row[name] = statistics[of]["count"] if statistics[of] else 0
    sizes = statistics["sizes"]
    for name, fit, value in (("exponential_p", "exponential", "p"), ("lognormal_s", "lognormal", "s"),
                             ("lognormal_p", "lognormal", "p"), ("tau", "power", "tau"), ("tau_p", "power", "p")):
        row[name] = sizes[fit][value] if sizes[fit] else ""
    row["faces_by"], row["break_share"] = statistics["faces_by"], statistics["break_share"]
    row["least_orientation"] = statistics["orientation"]["values"][2] if statistics["orientation"] else ""
    for along in statistics["hurst"]:
        row["hurst_" + along["direction"]] = along["exponent"]
    return row


def observe(options, mesh, case):
    """Break one mesh; the row of the results."""
    with tempfile.TemporaryDirectory(prefix="sherd-realism-") as folder:
        folder = pathlib.Path(folder)
        if mesh is None:
            mesh = folder / case["mesh"]
            write_box(mesh, SIDES[case["study"]])
        if case["study"] == "crack":
            given = folder / "seeds.json"
            given.write_text(json.dumps({"schema": "sherd-seeds/1", "seeds": [
                {"fragment": i + 1, "position": list(at)} for i, at in enumerate(CRACK_SEEDS)]}))
            number = ["--seeds", given]
        else:
            number = ["--pieces", case["pieces"]]
        cells = case["study"] == "block" and case["growth"] in ("euclid", "nearest")
        run(options.sherd, "fracture", mesh, "-o", folder / "pieces", *number, "--seed", case["seed"],
            "--resolution", case["resolution"], "--growth", case["growth"], "--write", "mesh,seeds" if cells else "mesh",
            "--quiet", *shlex.split(case["options"]))
        propagation = ["--propagation", "0,0,1"] if case["study"] == "crack" else []
        report = json.loads(run(options.sherd, "evaluate", folder / "pieces", "--statistics", "--json", *propagation))
        row = {**case, **metrics(report)}
        if cells and not case["options"]:
            row |= beside_exact(folder / "pieces", SIDES["block"], report)
        if case["study"] == "plate" and case["growth"] == "sequential" and not case["options"]:
            row |= beside_polygons(folder / "pieces", SIDES["plate"], report)
    return {name: str(row.get(name, "")) for name in KEY + METRICS}


def cases(options):
    for mesh in options.meshes or [None]:
        for growth in options.growth:
            for pieces in options.pieces or PIECES[options.study]:
                for seed in range(1, options.seeds + 1):
                    values = [options.study, mesh.name if mesh else options.study + ".obj", growth, options.options,
                              options.resolution, pieces, seed]
                    yield mesh, dict(zip(KEY, map(str, values)))


def observe_all(options):
    known = {}
    if options.results.exists():
        with options.results.open(newline="") as text:
            known = {tuple(row[k] for k in KEY): row for row in csv.DictReader(text)}
    fresh, rows = not options.results.exists(), []
    with options.results.open("a", newline="") as text:
        writer = csv.DictWriter(text, KEY + METRICS)
        if fresh:
            writer.writeheader()
        for mesh, case in cases(options):
            row = known.get(tuple(case.values()))
            if row is None:
                row = observe(options, mesh, case)
                writer.writerow(row)
                text.flush()
                print(*case.values(), file=sys.stderr)
            rows.append(row)
    return rows


def mean(rows, metric, digits=2):
    values = np.array([float(row[metric]) for row in rows if row[metric] != ""])
    if values.size == 0:
        return "-"
    error = f" ± {values.std(ddof=1) / np.sqrt(values.size):.{digits}f}" if values.size > 1 else ""
    return f"{values.mean():.{digits}f}{error}"


def table(options, rows):
    columns = {
        "block": [("faces", "interior_faces"), ("vertices", "interior_vertices"), ("neighbors", "interior_neighbors"),
                  ("pieces away from the border", "interior"), ("faces, all pieces, with those of the block", "flat_faces"),
                  ("faces of the exact cells", "exact_faces"), ("at the same cutoff", "exact_faces_counted"),
                  ("measured on the same pieces", "same_faces"), ("mean difference by piece", "face_difference"),
                  ("vertices of the exact cells", "exact_vertices"), ("measured", "same_vertices")],
        "plate": [("corners", "corners"), ("pieces without rim", "cornered"), ("neighbors", "neighbors"), ("faces of cracks", "faces"),
                  ("exact corners, all pieces", "exact_corners_all"), ("without rim", "exact_corners"),
                  ("with edges of a voxel or more", "exact_corners_counted"), ("measured on the same pieces", "same_corners"),
                  ("mean difference by piece", "corner_difference")],
        "vessels": [("contacts", "contacts"), ("neighbors", "neighbors"), ("break area", "break_share")],
        "crack": [("along propagation", "hurst_propagation"), ("along the front", "hurst_front")]}[options.study]
    sizes = [("p, exponential", "exponential_p"), ("s, lognormal", "lognormal_s"), ("tau, power", "tau")]
    if options.study in ("block", "plate"):
        columns += sizes
    pots = options.study == "vessels"
    print("| growth | pieces | fractures | " + " | ".join(name for name, _ in columns) + (" | real pots |" if pots else " |"))
    print("|---" * (3 + len(columns) + pots) + "|")
    for growth in options.growth:
        for pieces in options.pieces or PIECES[options.study]:
            some = [r for r in rows if (r["growth"], r["pieces"]) == (growth, str(pieces))]
            cells = [mean(some, metric, 3 if metric in ("break_share", "lognormal_s", "tau", "exponential_p") else 2)
                     for _, metric in columns]
            print(f"| {growth} | {pieces} | {len(some)} | " + " | ".join(cells) + (f" | {POTS.get(pieces, '-')} |" if pots else " |"))


def main():
    options = arguments()
    if bool(options.meshes) != (options.study == "vessels"):
        sys.exit("realism_study.py: vessels needs meshes, the others make theirs")
    try:
        rows = observe_all(options)
    except RuntimeError as error:
        sys.exit(f"realism_study.py: {error}")
    table(options, rows)


if __name__ == "__main__":
    main()
