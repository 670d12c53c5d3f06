#!/usr/bin/python3
"""Compare Sherd with Blender's add-on Cell Fracture: seconds, pieces, volume kept and closed pieces, as a Markdown table.

usage: comparison.py SHERD MESH... [options]

Every mesh (closed; .obj, .ply, .stl or .off) is broken by both programs, one after the other, into the same
numbers of pieces.  Both start from the same file: the mesh in Blender, scaled to a longest side of 2.  Cell
Fracture has its default options except the number of seeds; Sherd has its defaults, then --surface exact.  All are
measured by `sherd evaluate --mesh`.

Seconds are wall-clock time.  "fracture" is the fracture alone: for Cell Fracture from the add-on's call to its objects
(sorting seeds, cells, booleans, splitting islands), without the start of Blender and reading the mesh; for Sherd from the
mesh in memory to the fragments' meshes in memory (voxels, seeds, growth, surfaces), without reading and writing.
"whole run" is the whole program, including start, reading and writing.

The volume kept is that of the closed pieces, relative to the input's: an open piece has none.  "closed" and "sound"
are counts out of all pieces of all repeats; sound is closed, manifold, oriented outwards and without triangles that are
degenerate or duplicate.  "triangles" are those of all pieces, the median of the repeats.  "off the input" is how far points
on the pieces' original surface are from the input's on average, relative to its diagonal.

Needs Debian's blender (3.4.1), which includes the add-on.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

COLUMNS = ["asked", "got", "fracture, s", "whole run, s", "volume kept", "closed", "sound", "triangles", "off the input"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("meshes", nargs="+", type=pathlib.Path, metavar="MESH")
    parser.add_argument("--pieces", type=int, nargs="+", default=[10, 50], metavar="N", help="default: 10 50")
    parser.add_argument("--repeats", type=int, default=1, help="random seeds 1..REPEATS (default 1)")
    parser.add_argument("--resolution", type=int, default=128, help="of Sherd (default 128)")
    parser.add_argument("--timeout", type=float, default=900, help="seconds for one fracture (default 900)")
    parser.add_argument("--blender", default="blender", help="the program")
    return parser.parse_args()


def timed_run(command, timeout):
    started = time.perf_counter()
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=timeout)
    seconds = time.perf_counter() - started
    if done.returncode != 0:
        raise RuntimeError(f"{(done.stderr or done.stdout).strip()}\n(ran: {' '.join(map(str, command))})")
    return done.stdout, seconds


def measured(options, folder, whole):
    """Metrics of a folder.  A piece without triangles, which Cell Fracture sometimes makes, counts as got and not closed."""
    empty = [path for path in folder.glob("*.obj") if "\nf " not in path.read_text()]
    for path in empty:
        path.unlink()
    report = json.loads(timed_run([options.sherd, "evaluate", folder, "--mesh", whole, "--samples", 100, "--json"],
                                options.timeout)[0])
    closed = [f for f in report["fragments"] if f["quality"]["closed"]]
    return {"triangles": sum(f["quality"]["triangles"] for f in report["fragments"]), "off": report["surface_error"]["of_diagonal"]["mean"],
            "got": report["pieces"] + len(empty), "kept": sum(f["volume"] for f in closed) / report["whole"]["volume"],
            "closed": len(closed), "sound": report["sound"]}


def cell_fracture(options, mesh, folder, pieces, seed):
    """Runs this file inside Blender (below), which runs cell_fracture_in_blender.py."""
    output, whole_run = timed_run([options.blender, "--background", "--factory-startup", "--python-exit-code", 1,
                                 "--python", __file__, "--", mesh, folder, pieces, seed], options.timeout)
    seconds = next(float(line.split()[1]) for line in output.splitlines() if line.startswith("cell_fracture_seconds "))
    return {"fracture": seconds, "run": whole_run,
            **measured(options, folder / "pieces", folder / "whole.obj")}


def sherd(options, whole, folder, pieces, seed, surface):
    output, whole_run = timed_run([options.sherd, "fracture", whole, "-o", folder, "--pieces", pieces, "--seed", seed,
                                 "--resolution", options.resolution, "--write", "mesh", "--surface", surface, "--json"], options.timeout)
    stages = json.loads(output)["seconds"]
    seconds = sum(stages[stage] for stage in ("voxelize", "components", "seed", "grow", "extract"))
    return {"fracture": seconds, "run": whole_run, **measured(options, folder, whole)}


def row(name, program, asked, results):
    def median(key):
        return statistics.median(r[key] for r in results)

    if not results:
        return f"| {name} | {program} | {asked} | | more than the time limit | | | | | | |"
    got = sorted({r["got"] for r in results})
    total = sum(r["got"] for r in results)
    kept = statistics.fmean(r["kept"] for r in results)
    return (f"| {name} | {program} | {asked} | {' to '.join(map(str, got[:1] + got[1:][-1:]))} "
            f"| {median('fracture'):.1f} | {median('run'):.1f} | {100 * kept:.2f} % "
            f"| {sum(r['closed'] for r in results)}/{total} | {sum(r['sound'] for r in results)}/{total} "
            f"| {median('triangles'):,.0f} | {100 * median('off'):.5f} % |")


def main():
    options = arguments()
    print(f"| mesh | program | {' | '.join(COLUMNS)} |\n|{'---|' * (len(COLUMNS) + 2)}")
    for mesh in options.meshes:
        for pieces in options.pieces:
            cells, smooth, exact = [], [], []
            for seed in range(1, options.repeats + 1):
                with tempfile.TemporaryDirectory(prefix="sherd-comparison-") as folder:
                    folder = pathlib.Path(folder)
                    try:
                        cells.append(cell_fracture(options, mesh, folder / "cells", pieces, seed))
                    except subprocess.TimeoutExpired:
                        print(f"{mesh.name}, {pieces}: Cell Fracture exceeded the time limit", file=sys.stderr)
                    for surface, results in (("smooth", smooth), ("exact", exact)):
                        if (folder / "cells" / "whole.obj").exists():
                            results.append(sherd(options, folder / "cells" / "whole.obj", folder / surface, pieces, seed, surface))
            for program, results in (("Cell Fracture", cells), ("Sherd", smooth), ("Sherd, exact", exact)):
                print(row(mesh.name, program, pieces, results), flush=True)


def inside_blender():
    """Measure the add-on's time while cell_fracture_in_blender.py breaks the mesh."""
    import runpy

    import addon_utils
    import object_fracture_cell

    addon_utils.enable("object_fracture_cell")
    work = object_fracture_cell.main

    def clocked(*arguments, **more):
        started = time.perf_counter()
        work(*arguments, **more)
        print("cell_fracture_seconds", time.perf_counter() - started, flush=True)

    object_fracture_cell.main = clocked  # called by the add-on's operator
    runpy.run_path(str(pathlib.Path(__file__).with_name("cell_fracture_in_blender.py")), run_name="__main__")


if __name__ == "__main__":
    try:
        import bpy  # noqa: F401
    except ImportError:
        main()
    else:
        inside_blender()
