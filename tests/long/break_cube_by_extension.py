"""Install the extension into Blender's profile, break the default cube by it, and look at the pieces.

usage: break_cube_by_extension.py EXTENSION.zip    (by a Python with bpy)
"""
import os
import sys

import bpy


def closed(mesh):
    sides = [(t[k], t[(k + 1) % len(t)]) for t in (list(p.vertices) for p in mesh.polygons) for k in range(len(t))]
    return len(set(sides)) == len(sides) and {(b, a) for a, b in sides} == set(sides)


bpy.ops.extensions.package_install_files(filepath=sys.argv[-1], repo="user_default", enable_on_install=True)
name = "bl_ext.user_default.sherd_fracture"
assert name in bpy.context.preferences.addons
program = sys.modules[name + ".program"].program(bpy.context)
assert program.endswith("/sherd_program/bin/sherd"), program
cube = bpy.data.objects["Cube"]
bpy.context.view_layer.objects.active = cube
cube.select_set(True)
assert bpy.ops.object.sherd_fracture() == {"FINISHED"}
pieces = bpy.context.selected_objects
assert len(pieces) == 8, pieces
assert all(closed(piece.data) for piece in pieces)
assert abs(sum(piece["sherd_volume"] for piece in pieces) - 8) < 1e-4
loaded = open("/proc/self/maps").read()
assert "sherd" not in loaded and loaded.count("libopenvdb") > 0, "its libraries must not be loaded into Blender"
count = sum(len(polygon.vertices) - 2 for piece in pieces for polygon in piece.data.polygons)
print(f"Blender {bpy.app.version_string}: {len(pieces)} pieces of {count} triangles by {program}", flush=True)
os._exit(0)
