#!/usr/bin/python3
"""Break every mesh of a folder into 8 pieces at 128 voxels and write a table of defects and results: docs/robustness.md.

usage: robustness.py SHERD FOLDER CHECKER.py OUT.md [--pictures FOLDER]
  FOLDER   meshes, with reference values in stats.csv, if it exists: file, svol, ...
  CHECKER  an independent checker of finished fractures: exit status 0 if all checks hold
  --pictures  folder for a .jpg of each mesh that the page shows
Needs numpy and, for images, PIL.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import tempfile

SHOWN = {"bun_zipper.ply": "y", "teapot.stl": "z", "lionstatue.obj": "y", "blackVase_scan.ply": "z",
         "simple_vase_open.obj": "z", "spider.obj": "y", "2CylinderEngine.glb": "y", "cycloidal.ply": "z"}
NAMES = {"boundary_edges": "open", "non_manifold_edges": "non-manifold", "misoriented_edges": "misoriented",
         "duplicate_triangles": "doubled", "degenerate_triangles": "degenerate", "dropped_vertices": "not finite"}


def truths(folder):
    path = folder / "stats.csv"
    if not path.exists():
        return {}
    with open(path) as file:
        return {row["file"]: row for row in csv.DictReader(file)}


def first_line(sentence):
    return sentence.strip().split("\n")[0].removeprefix("sherd: ")


def holds(sherd, mesh, checker, out):
    """Whether all checks hold.  The checker cannot read texture coordinates: such a mesh is checked without them."""
    run = subprocess.run(["/usr/bin/python3", checker, out], capture_output=True, text=True)
    if "faces that are not triangles" not in run.stderr:
        return run.returncode == 0
    bare, pieces = out.parent / "bare.stl", out.parent / "bare"
    subprocess.run([sherd, "convert", mesh, bare], capture_output=True, check=True)
    subprocess.run([sherd, "fracture", bare, "-o", pieces, "--pieces", "8", "--resolution", "128", "--quiet"], capture_output=True, check=True)
    return subprocess.run(["/usr/bin/python3", checker, pieces], capture_output=True).returncode == 0


def row_of(sherd, mesh, checker, truth, out, up):
    run = subprocess.run([sherd, "fracture", mesh, "-o", out, "--pieces", "8", "--resolution", "128", "--up", up, "--json"],
                         capture_output=True, text=True)
    name = mesh.name
    if run.returncode == 3:
        return f"| {name} | refused: {first_line(run.stderr).removeprefix(f'{mesh}: ').removeprefix(f'{name}: ')} | | | | | | |", True
    if run.returncode != 0:
        return f"| {name} | FAILED with status {run.returncode}: {first_line(run.stderr)} | | | | | | |", False
    result = json.loads(run.stdout)
    report = result["report"]
    good = holds(sherd, mesh, checker, out)
    found = [f"{report[key]} {word}" for key, word in NAMES.items() if report.get(key)]
    if report["flipped_components"]:
        found.append(f"{report['flipped_components']} of {report['components']} components inside out")
    volume, known = report["solid_volume"], ""
    closed = truth and truth["watertight"] == "True" and truth["svol"]
    if closed and int(truth["si_disjoint"] or 0) == 0:
        known = f"{100 * (volume / abs(float(truth['svol'])) - 1):+.2f} %"
    walls = report["walls"]
    thin = f"{100 * walls['thin_share']:.2g} %" if walls["thin_share"] else ""
    cells = [name, ", ".join(found) or "none", report["fill"], f"{volume:.4g}", known, thin,
             f"{result['fragments']}, {'hold' if good else 'do not hold'}", f"{result['seconds']['total']:.1f} s"]
    return "| " + " | ".join(cells) + " |", good


def save_image(out, target):
    from PIL import Image
    image = Image.open(out / "preview.png").convert("RGB")
    image.thumbnail((640, 640))
    image.save(target, quality=80)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("sherd")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("checker")
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path)
    arguments = parser.parse_args()
    known, rows, good = truths(arguments.folder), [], True
    for mesh in sorted(arguments.folder.iterdir(), key=lambda path: path.name.lower()):
        if mesh.suffix.lower() in (".md", ".csv", ".bin"):
            continue
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "pieces"
            row, fine = row_of(arguments.sherd, mesh, arguments.checker, known.get(mesh.name), out,
                              SHOWN.get(mesh.name, "z"))
            rows.append(row)
            good &= fine
            print(row, flush=True)
            if arguments.pictures and mesh.name in SHOWN and (out / "preview.png").exists():
                save_image(out, arguments.pictures / f"{mesh.stem}.jpg")
    head = ["| mesh | found | filled by | volume | off the truth | thin walls | fragments | time |", "|---" * 8 + "|"]
    arguments.table.write_text("\n".join(head + rows) + "\n")
    return 0 if good else 1


if __name__ == "__main__":
    raise SystemExit(main())
