#!/usr/bin/python3
"""Draw fragments of two programs close up, at several resolutions: a row of images each, one sheet for each mesh.

usage: crease_pictures.py SHERD BEFORE MESHES OUT

SHERD and BEFORE are programs, as of today and as of a version without creases; MESHES is a folder with
1002_tray_bottom.STL, 99865_car.stl, gearbox_assembly.ply.gz and vase_goblet.stl.  Blender adds its own monkey, which is open.
OUT receives <name>.jpg: BEFORE above, SHERD below, 64, 96, 128 and 256 voxels from left to right.

Needs Debian's blender, which renders the fragments' .obj files by Cycles on the processor, and python3-pil.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

RESOLUTIONS = [64, 96, 128, 256]
SIDE = 300  # pixels of an image

# Name: mesh, what is looked at in shares of the bounding box, from where, width in shares of its longest side, up.
VIEWS = {
    "monkey": ("monkey.obj", (0.5, 0.55, 0.8), (0.1, 0.3, 1.0), 0.75, (0, 1, 0)),
    "tray": ("1002_tray_bottom.STL", (0.15, 0.15, 0.9), (-0.5, -0.7, 0.8), 0.4, (0, 0, 1)),
    "car": ("99865_car.stl", (0.2, 0.12, 0.5), (0.3, -0.9, 0.5), 0.4, (0, 0, 1)),
    "gearbox": ("gearbox_assembly.ply.gz", (0.5, 0.5, 0.75), (0.6, -0.8, 0.5), 0.45, (0, 0, 1)),
    "goblet": ("vase_goblet.stl", (0.5, 0.5, 0.92), (0.6, -0.8, 0.5), 0.45, (0, 0, 1)),
}


def blender(*words):
    line = ["blender", "--background", "--python", __file__, "--", *map(str, words)]
    done = subprocess.run(line, capture_output=True, text=True)
    if done.returncode != 0 or "Error" in done.stderr:
        raise RuntimeError(f"{done.stdout}{done.stderr}")


def main(sherd, before, meshes, out):
    from PIL import Image
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="sherd-creases-") as folder:
        work = pathlib.Path(folder)
        blender("monkey", work / "monkey.obj")
        for name, (mesh, *view) in VIEWS.items():
            source = work / mesh if name == "monkey" else meshes / mesh
            sheet = Image.new("RGB", (SIDE * len(RESOLUTIONS), 2 * SIDE))
            for column, resolution in enumerate(RESOLUTIONS):
                for row, program in enumerate((before, sherd)):
                    subprocess.run([program, "fracture", source, "-o", work / "pieces", "--pieces", "10", "--seed", "1", "--resolution", str(resolution),
                                    "--write", "mesh", "--mesh-format", "obj", "--quiet"], check=True)
                    blender("render", work / "pieces" / "meshes", json.dumps(view), work / "image.png")
                    sheet.paste(Image.open(work / "image.png").convert("RGB"), (SIDE * column, SIDE * row))
            sheet.save(out / f"{name}.jpg", quality=80, optimize=True)
            print(name, flush=True)


def write_monkey(path):
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_monkey_add()
    bpy.ops.export_scene.obj(filepath=path, use_materials=False, use_normals=False, use_uvs=False)


def render(folder, view, image):
    import bpy
    import numpy
    from mathutils import Euler, Matrix, Vector
    at, eye, width, up = json.loads(view)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for path in sorted(pathlib.Path(folder).glob("*.obj")):
        bpy.ops.import_scene.obj(filepath=str(path), axis_forward="Y", axis_up="Z")
    for material in bpy.data.materials:
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (0.55, 0.56, 0.58, 1.0)
        shader.inputs["Roughness"].default_value = 0.6
    corners = numpy.array([o.matrix_world @ Vector(c) for o in bpy.data.objects if o.type == "MESH" for c in o.bound_box])
    low, high = corners.min(axis=0), corners.max(axis=0)
    side = float((high - low).max())

    scene = bpy.context.scene
    away = Vector(eye).normalized()
    right = Vector(up).cross(away).normalized()
    turned = Matrix((right, away.cross(right), away)).transposed()
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale, camera.clip_start, camera.clip_end = "ORTHO", side * width, side * 1e-3, side * 10.0
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = Vector(low + (high - low) * numpy.array(at)) + 3.0 * side * away
    scene.camera.rotation_euler = turned.to_euler()
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = 3.0, 0.05
    sun = bpy.data.objects.new("sun", light)
    sun.rotation_euler = (turned.to_quaternion() @ Euler((-0.6, -0.7, 0.0)).to_quaternion()).to_euler()
    for thing in (scene.camera, sun):
        scene.collection.objects.link(thing)
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs[0].default_value, background.inputs[1].default_value = (0.9, 0.92, 0.95, 1.0), 0.45
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 32, False
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = image
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    if "--background" in sys.argv:
        verb, *words = sys.argv[sys.argv.index("--") + 1:]
        (write_monkey if verb == "monkey" else render)(*words)
    elif len(sys.argv) == 5:
        main(*map(pathlib.Path, sys.argv[1:]))
    else:
        sys.exit(__doc__.split("\n\n")[1])
