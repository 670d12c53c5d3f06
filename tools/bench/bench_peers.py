#!/usr/bin/python3
"""Break one mesh by Sherd and by other programs, in one run, and print a table in Markdown.

usage: bench_peers.py [options] SHERD LEVEL_SET_FRACTURE [MESH.ply]     (default: data/amphora.ply)

    Cell Fracture        Blender's add-on, default options except the number of seeds: cuts the mesh itself, by booleans
    Python stack         pyopenvdb, NumPy and scikit-image (tools/bench/python_stack.py): voxels of the nearest seed
    LevelSetFracture     OpenVDB's, cutters are the cells of the seeds (tests/bench/level_set_fracture.cpp)
    Sherd                `sherd fracture --write mesh`, and `sherd dataset --write mesh`, its pictures and index included

Each starts from the file and writes each fragment's mesh.  All but Cell Fracture have the same number of voxels along the
longest side.  Each runs twice: one fracture in a process, and several, which start and read (and voxelize) once.  Times are
of the whole process with its children.  "Closed" are meshes whose edges are each passed as often in one direction as in
the other, equal vertices merged.

A program that is missing, or fails, is a row that says why; the exit status is 0.  Needs Debian's python3-numpy; blender,
python3-openvdb and python3-skimage for their rows.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
COLUMNS = ["program", "fractures", "fragments", "wall s", "CPU s", "fragments per CPU s", "peak memory", "closed"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", type=pathlib.Path, help="the program")
    parser.add_argument("level_set_fracture", type=pathlib.Path, help="the program of tests/bench")
    parser.add_argument("mesh", type=pathlib.Path, nargs="?", default=HERE.parents[1] / "data" / "amphora.ply",
                        help="closed, a binary .ply of triangles")
    parser.add_argument("--pieces", type=int, default=10, help="default 10")
    parser.add_argument("--resolution", type=int, default=128, help="default 128")
    parser.add_argument("--fractures", type=int, default=20, help="most fractures in one process (default 20)")
    parser.add_argument("--seconds", type=float, default=45, help="CPU seconds of a process, which limit its fractures (default 45)")
    parser.add_argument("--timeout", type=float, default=300, help="seconds for one process (default 300)")
    parser.add_argument("--blender", default="blender", help="the program")
    return parser.parse_args()


class Missing(Exception):
    """Why a program cannot be compared, as a sentence."""


def need_python(options):
    try:
        subprocess.run(["/usr/bin/python3", "-c", "import pyopenvdb, skimage"], check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        raise Missing("not run: /usr/bin/python3 lacks pyopenvdb or scikit-image (Debian's python3-openvdb, python3-skimage)")


def need_program(program, package):
    if shutil.which(program) is None:
        raise Missing(f"not run: {program} is missing ({package})")


def cell_fracture(options, folder, count):
    return [options.blender, "--background", "--factory-startup", "--python-exit-code", 1, "--python",
            HERE.parent / "studies" / "cell_fracture_in_blender.py", "--", options.mesh, folder, options.pieces, 1, count]


def python_stack(options, folder, count):
    return ["/usr/bin/python3", "-B", HERE / "python_stack.py", options.mesh, folder, options.pieces, 1, options.resolution, count]


def level_set_fracture(options, folder, count):
    return [options.level_set_fracture, options.mesh, folder, options.pieces, 1, options.resolution, count]


def sherd(options, folder, count):
    common = ["--resolution", options.resolution, "--write", "mesh", "--quiet", "-o", folder, "--pieces", options.pieces]
    if count == 1:
        return [options.sherd, "fracture", options.mesh, "--seed", 1, *common]
    library = folder.with_name("library")
    library.mkdir(exist_ok=True)
    shutil.copy(options.mesh, library)
    return [options.sherd, "dataset", library, "--repeats", count, *common]


# Name, what one process of several fractures is, its files, what it needs, its command.
PEERS = [
    ("Cell Fracture", "", "pieces*/*.obj", lambda o: need_program(o.blender, "Debian's blender, which has the add-on"), cell_fracture),
    ("Python stack", "", "*/*.ply", need_python, python_stack),
    ("LevelSetFracture", "", "*/*.ply", lambda o: need_program(o.level_set_fracture, "target level_set_fracture"), level_set_fracture),
    ("Sherd", ", dataset", "**/meshes/*.ply", lambda o: need_program(o.sherd, "target sherd_cli"), sherd)]


def measured(command, timeout):
    """Wall-clock and CPU seconds and peak memory in bytes of a process and its children."""
    with tempfile.TemporaryFile("w+") as said:
        started = time.perf_counter()
        child = subprocess.Popen([*map(str, command)], stdout=said, stderr=said, env={**os.environ, "OCL_ICD_VENDORS": "none"})
        while True:
            done, status, usage = os.wait4(child.pid, os.WNOHANG)
            seconds = time.perf_counter() - started
            if done:
                break
            if seconds > timeout:
                child.kill()
                os.wait4(child.pid, 0)
                child.returncode = -9
                raise Missing(f"more than {timeout:.0f} s")
            time.sleep(0.005)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            said.seek(0)
            lines = [line.strip() for line in said if line.strip()]
            error = next((line for line in lines if "error" in line.lower()), lines[-1] if lines else "no message")
            raise Missing(f"failed ({child.returncode}): {error[:150]}")
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def count_closed(folder, pattern):
    """Fragments and how many are closed, counted in another process: a child's peak memory includes its parent's."""
    done = subprocess.run([sys.executable, "-B", __file__, "--closed", folder, pattern], capture_output=True, text=True)
    if done.returncode != 0:
        raise Missing(f"its files cannot be read: {done.stderr.strip().splitlines()[-1]}")
    return tuple(map(int, done.stdout.split()))


def row(options, peer, count):
    """Prints a row, and returns its CPU seconds."""
    name, several, pattern, _, command = peer
    with tempfile.TemporaryDirectory(prefix="sherd-peers-") as scratch:
        folder = pathlib.Path(scratch) / "out"
        wall, cpu, peak = measured(command(options, folder, count), options.timeout)
        fragments, closed = count_closed(folder, pattern)
    print(f"| {name}{several if count > 1 else ''} | {count} | {fragments} | {wall:.2f} | {cpu:.2f} | {fragments / cpu:.1f} "
          f"| {peak / 1e6:.0f} MB | {closed}/{fragments} |", flush=True)
    return cpu


def main():
    options = arguments()
    options.mesh = options.mesh.resolve()
    print(f"`{options.mesh.name}` in {options.pieces} pieces, {options.resolution} voxels along the longest side, "
          f"{len(os.sched_getaffinity(0))} cores\n\n| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}", flush=True)
    for peer in PEERS:
        try:
            peer[3](options)
            cpu = row(options, peer, 1)
            several = max(2, min(options.fractures, int(options.seconds / cpu)))
            if options.fractures > 1:
                row(options, peer, several)
        except Missing as reason:
            print(f"| {peer[0]} | {reason} |" + " |" * (len(COLUMNS) - 2), flush=True)


def closed_meshes(folder, pattern):
    import numpy as np

    sys.path.insert(0, str(HERE.parent / "studies"))
    from mesh_file import read_ply

    def corners(path):
        if path.suffix == ".ply":
            ply = read_ply(path)
            return np.column_stack([ply["vertex"][axis] for axis in "xyz"]), ply["face"]["vertex_indices"]
        words = [line.split() for line in path.read_text().splitlines()]
        return (np.array([w[1:4] for w in words if w[:1] == ["v"]], float),
                np.array([w[1:4] for w in words if w[:1] == ["f"]], int).reshape(-1, 3) - 1)

    def is_closed(path):
        vertices, faces = corners(path)
        if len(faces) == 0:
            return False
        merged = np.unique(vertices, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)[faces]
        start, end = merged.ravel(), np.roll(merged, -1, axis=1).ravel()
        edge = np.unique(np.minimum(start, end) * len(vertices) + np.maximum(start, end), return_inverse=True)[1]
        return not np.bincount(edge, np.sign(end - start)).any()

    paths = [path for path in pathlib.Path(folder).glob(pattern) if "whole" not in path.parts]  # a dataset's intact meshes
    print(len(paths), sum(map(is_closed, paths)))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--closed"]:
        closed_meshes(*sys.argv[2:])
    else:
        main()
