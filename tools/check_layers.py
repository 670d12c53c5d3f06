#!/usr/bin/python3
"""Checks which folder of src/ includes which: a folder may include those above it in ROOMS, and itself.

usage: check_layers.py [--svg FILE]

Prints the graph: for each folder those it includes, with the number of #include lines.  A public header counts as the lowest folder
that knows its types.  Ends with status 1 where an edge points up, two units (a header with its source) include each other on any way, two
modules of a Python package import each other, two files define types of one name, a folder has too many files, the program includes what is neither public nor in base/, a folder or a header is not listed, there are too
many headers, or the diagram in docs/images/rooms.svg does not match this graph; --svg writes it.
"""
import argparse
import ast
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
DRAWING = ROOT / "docs" / "images" / "rooms.svg"

ROOMS = ["base", "base/text", "base/files", "cl", "mesh", "mesh/search", "mesh/attributes", "mesh/repair", "intersect", "intersect/arrange", "clean",
         "voxelize/leaves", "voxelize/fill", "voxelize/bodies", "voxelize", "seed/draw", "seed", "grow/fields", "grow/sized", "grow/splits", "grow", "erode",
         "remesh", "remesh/decimate", "remesh/resample", "remesh/parts", "cut", "interface/cells", "interface", "surface/exact", "surface", "points", "appearance", "pipeline",
         "evaluate/cracks", "evaluate", "render", "chart", "formats", "formats/arrays", "formats/mesh", "formats/ply", "formats/obj", "formats/gltf", "formats/usd", "formats/geo",
         "formats/mesh_files", "formats/voxels", "formats/points", "formats/images", "options", "viewer", "folder/manifest", "folder/files", "folder/read",
         "folder", "dataset/store", "dataset/journal", "dataset/layouts", "dataset/report", "dataset/recipe", "dataset/assemblage", "dataset", "assimp_program", "cli/terminal", "cli/arguments",
         "cli/evaluate", "cli/doctor", "cli",
         "cgal"]  # implements an interface of cli/: docs/decisions/0005-licenses.md

HEADERS = {  # include/sherd/, by the lowest room that knows its types
    "base": "error progress",
    "cl": "device",
    "mesh": "coords mesh",
    "voxelize/leaves": "solid",
    "seed/draw": "seeds",
    "grow/fields": "labels growth",
    "remesh": "fragments",
    "points": "points",
    "pipeline": "fracture",
    "evaluate/cracks": "evaluate",
    "render": "render",
    "formats": "files",
    "options": "options",
    "folder/manifest": "folder",
    "dataset/store": "dataset",
    "cli": "sherd",  # includes all the others
}
ROOM_OF_HEADER = {f"sherd/{name}.h": room for room, names in HEADERS.items() for name in names.split()}


def room_of(path):
    """The room of a file, relative to the repository; None if it has none."""
    if path.parts[0] == "include":
        return ROOM_OF_HEADER.get("/".join(path.parts[1:]))
    room = "/".join(path.parts[1:-1])
    return room if room in ROOMS else None


def included_room(include):
    if include.startswith("sherd/"):
        return ROOM_OF_HEADER.get(include, "?")
    if not (ROOT / "src" / include).is_file():
        return None  # another library's, a kernel's
    return room_of(pathlib.Path("src") / include)


MOST_HEADERS = 18  # besides sherd.h: one concept each
MOST_FILES = 30  # of a room: what one person can keep in mind
PACKAGES = ["python/pysherd", "tools/blender/sherd_fracture"]
MANY_FORMATS = {"formats/mesh"}  # what the readers and writers of meshes share


def read_graph():
    """Returns ({(room, included room): lines}, faults)."""
    edges, faults = collections.Counter(), []
    headers = len(ROOM_OF_HEADER) - 1
    if headers > MOST_HEADERS:
        faults.append(f"there are {headers} public headers besides sherd.h, at most {MOST_HEADERS} are allowed")
    files = [f for top in ("src", "include") for f in sorted((ROOT / top).rglob("*")) if f.suffix in (".h", ".cpp")]
    for file in files:
        path = file.relative_to(ROOT)
        room = room_of(path)
        if room is None:
            faults.append(f"{path} is in no folder of ROOMS or HEADERS")
            continue
        for include in re.findall(r'^#include ["<]([^">]+)[">]', file.read_text(), re.MULTILINE):
            other = included_room(include)
            if other == "?":
                faults.append(f"{path}: {include} is in none of HEADERS")
            elif other is not None and other != room:
                edges[room, other] += 1
                if ROOMS.index(other) > ROOMS.index(room):
                    faults.append(f"{path} includes {include}: {other} is above {room}")
                if room.startswith("cli") and not other.startswith(("base", "cli")) and not include.startswith("sherd/"):
                    faults.append(f"{path} includes {include}: the program uses public headers, base/ and itself only")
    return edges, faults


def read_units():
    """Returns {unit: units that it includes}, a unit being a path in src/ without its suffix."""
    units = collections.defaultdict(set)
    for file in (ROOT / "src").rglob("*"):
        if file.suffix not in (".h", ".cpp"):
            continue
        unit = str(file.relative_to(ROOT / "src").with_suffix(""))
        for include in re.findall(r'^#include "([^"]+)\.h"', file.read_text(), re.MULTILINE):
            if include != unit and (ROOT / "src" / f"{include}.h").is_file():
                units[unit].add(include)
    return units


def read_modules():
    """Returns {module: modules that it imports}, also where a function imports them; a module being a path without its suffix."""
    modules = collections.defaultdict(set)
    for file in (file for package in PACKAGES for file in (ROOT / package).glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            if not isinstance(node, ast.ImportFrom) or node.level != 1:
                continue
            for name in [node.module] if node.module else [alias.name for alias in node.names]:
                other = file.with_name(f"{name.split('.')[0]}.py")
                if other != file and other.is_file():
                    modules[str(file.relative_to(ROOT).with_suffix(""))].add(str(other.relative_to(ROOT).with_suffix("")))
    return modules


def circles(units, verb):
    """Returns a sentence for each set of units that include or import each other."""
    below = {}

    def reached(unit):
        found, left = set(), [unit]
        while left:
            for other in units.get(left.pop(), ()):
                if other not in found:
                    found.add(other)
                    left.append(other)
        return found

    for unit in units:
        below[unit] = reached(unit)
    rings = {tuple(sorted({unit} | {o for o in below[unit] if unit in below.get(o, ())})) for unit in units if unit in below[unit]}
    return [f"{', '.join(ring)} {verb} each other" for ring in sorted(rings)]


def crowded():
    """Returns a sentence for each room with too many files."""
    counts = collections.Counter(room_of(f.relative_to(ROOT)) for f in (ROOT / "src").rglob("*") if f.suffix in (".h", ".cpp"))
    return [f"src/{room} has {count} files, at most {MOST_FILES} are allowed" for room, count in sorted(counts.items(), key=str)
            if count > MOST_FILES and room not in MANY_FORMATS]


def defined_twice():
    """Returns a sentence for each name that two files give to types of the same namespace: a breach of one definition that no linker reports."""
    files = collections.defaultdict(set)
    for file in (file for folder in ("src", "include") for file in (ROOT / folder).rglob("*") if file.suffix in (".h", ".cpp")):
        namespaces = []
        for line in file.read_text().split("\n"):
            if opened := re.match(r"namespace ?([\w:]*) ?\{", line):
                namespaces.append(opened[1])
            elif re.match(r"\}  ?// namespace", line):
                namespaces.pop()
            # Neither a member of another class nor a specialization, both of which are named after another type.
            elif (defined := re.match(r"(?:struct|class|union) (?:\w+\(.*\) )?(\w+)(?: final)? (?:: [^:].*)?\{", line)) and "" not in namespaces:
                files["::".join([*namespaces, defined[1]])].add(str(file.relative_to(ROOT)))
    return [f"{name} is defined in {' and '.join(sorted(found))}" for name, found in sorted(files.items()) if len(found) > 1]


def without_shortcuts(edges):
    """Returns the edges that no longer path implies."""
    below = collections.defaultdict(set)
    for room, other in sorted(edges, key=lambda e: ROOMS.index(e[0])):
        below[room] |= {other} | below[other]
    return [(room, other) for room, other in edges
            if not any(other in below[middle] for start, middle in edges if start == room and middle != other)]


def drawing_of(edges):
    """The graph as SVG: each folder above all that it includes; implied edges are left out."""
    edges = {e: n for e, n in edges.items() if "assimp_program" not in e}
    rooms = [r for r in ROOMS if any(r in e for e in edges)]
    floor = {}
    for room in rooms:
        floor[room] = max([floor[b] + 1 for a, b in edges if a == room and b in floor], default=0)
    floors = [[r for r in rooms if floor[r] == level] for level in range(max(floor.values()) + 1)]
    width, height, box = 1000, 78, 128
    at = {}
    for level, row in enumerate(reversed(floors)):
        for i, room in enumerate(row):
            aside = 70 * (1, -1, 0)[level % 3]  # so that few lines run behind boxes
            at[room] = (round(width * (i + 1) / (len(row) + 1)) + aside, 34 + level * height)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {len(floors) * height}" font-family="sans-serif" '
             'font-size="14">', f'<rect width="{width}" height="{len(floors) * height}" fill="#fcfcfa"/>']
    for room, other in sorted(without_shortcuts(edges), key=lambda e: (ROOMS.index(e[0]), ROOMS.index(e[1]))):
        (x, y), (u, v) = at[room], at[other]
        lines.append(f'<path d="M{x} {y + 15}C{x} {y + 50} {u} {v - 50} {u} {v - 15}" fill="none" stroke="#8a8f98"/>')
    for room in rooms:
        x, y = at[room]
        lines.append(f'<rect x="{x - box // 2}" y="{y - 15}" width="{box}" height="30" rx="5" fill="#e3ecf5" stroke="#4a6a8a"/>')
        lines.append(f'<text x="{x}" y="{y + 5}" text-anchor="middle">{room}</text>')
    return "\n".join(lines + ["</svg>", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--svg", metavar="FILE", type=pathlib.Path, help="write the drawing")
    arguments = parser.parse_args()
    edges, faults = read_graph()
    faults += circles(read_units(), "include") + circles(read_modules(), "import") + crowded() + defined_twice()
    for room in ROOMS:
        below = [f"{other} {edges[room, other]}" for other in ROOMS if edges[room, other]]
        print(f"{room}: {', '.join(below) or 'nothing'}")
    drawing = drawing_of(edges)
    if arguments.svg:
        arguments.svg.write_text(drawing)
    if not DRAWING.is_file() or DRAWING.read_text() != drawing:
        faults.append(f"{DRAWING.relative_to(ROOT)} is not the diagram of this graph (--svg writes it)")
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
