"""Break a mesh by Blender's add-on Cell Fracture with default options; run by cell_fracture_study.py and bench_peers.py.

usage: blender --background --factory-startup --python-exit-code 1 --python cell_fracture_in_blender.py
         -- MESH FOLDER PIECES SEED [FRACTURES]

Writes FOLDER/whole.obj and FOLDER/pieces/piece_0.obj, piece_1.obj, ...; further FRACTURES, by the next random seeds, go to
FOLDER/pieces_1, pieces_2, ...  The mesh is scaled to a longest side of 2, like
Blender's default cube, because the add-on's margin, noise and tolerances are lengths.
"""
import pathlib
import random
import sys

import addon_utils
import bpy
import mathutils


def read(path):
    """Vertices and polygons, equal vertices merged."""
    if path.suffix.lower() == ".off":
        words = iter(path.read_text().split()[1:])
        counts = [int(next(words)) for _ in range(3)]
        corners = [tuple(float(next(words)) for _ in range(3)) for _ in range(counts[0])]
        polygons = [[int(next(words)) for _ in range(int(next(words)))] for _ in range(counts[1])]
    else:
        readers = {".obj": bpy.ops.wm.obj_import, ".ply": bpy.ops.import_mesh.ply, ".stl": bpy.ops.import_mesh.stl}
        readers[path.suffix.lower()](filepath=str(path))
        parts = [thing for thing in bpy.context.scene.objects if thing.type == "MESH"]
        corners, polygons = [], []
        for part in parts:
            first = len(corners)
            corners += [tuple(v.co) for v in part.data.vertices]
            polygons += [[first + i for i in p.vertices] for p in part.data.polygons]
            bpy.data.objects.remove(part)
    index_of = {}
    number = [index_of.setdefault(corner, len(index_of)) for corner in corners]
    return list(index_of), [[number[i] for i in polygon] for polygon in polygons]


def scaled(vertices):
    low, high = ([pick(v[axis] for v in vertices) for axis in range(3)] for pick in (min, max))
    scale = 2 / max(b - a for a, b in zip(low, high))
    return [tuple(scale * (v[k] - (low[k] + high[k]) / 2) for k in range(3)) for v in vertices]


def write(path, thing):
    mesh = thing.data
    mesh.calc_loop_triangles()
    lines = ["v %.9g %.9g %.9g\n" % tuple(thing.matrix_world @ v.co) for v in mesh.vertices]
    lines += ["f %d %d %d\n" % tuple(i + 1 for i in t.vertices) for t in mesh.loop_triangles]
    path.write_text("".join(lines))


def fracture(whole, folder, pieces, seed):
    folder.mkdir()
    whole.hide_set(False)  # the add-on hides it
    bpy.ops.object.select_all(action="DESELECT")
    bpy.context.view_layer.objects.active = whole
    whole.select_set(True)
    random.seed(seed)  # the add-on shuffles the vertices that it selects seeds from
    mathutils.noise.seed_set(seed)
    bpy.ops.object.add_fracture_cell_objects(source_limit=pieces)
    bpy.context.view_layer.update()
    cells = [thing for thing in bpy.context.scene.objects if thing.type == "MESH" and thing != whole]
    for i, cell in enumerate(sorted(cells, key=lambda thing: thing.name)):
        write(folder / f"piece_{i}.obj", cell)
    for cell in cells:
        bpy.data.objects.remove(cell)


def main():
    source, folder, pieces, seed, *fractures = sys.argv[sys.argv.index("--") + 1:]
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True)
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    vertices, polygons = read(pathlib.Path(source))
    mesh = bpy.data.meshes.new("whole")
    mesh.from_pydata(scaled(vertices), [], polygons)
    mesh.validate()
    whole = bpy.data.objects.new("whole", mesh)
    bpy.context.collection.objects.link(whole)
    write(folder / "whole.obj", whole)
    addon_utils.enable("object_fracture_cell")
    for i in range(int(fractures[0]) if fractures else 1):
        fracture(whole, folder / (f"pieces_{i}" if i else "pieces"), int(pieces), int(seed) + i)


main()
