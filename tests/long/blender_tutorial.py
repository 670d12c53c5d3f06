"""The steps of docs/tutorial-blender.md in Blender, and its pictures: docs/images/blender-*.jpg.

usage: blender -b --factory-startup --python-exit-code 1 --python blender_tutorial.py -- SHERD FOLDER [SAMPLES]

Without a window, by Cycles on the processor: three minutes at the 48 samples of the documents.  Fails where a step does not come out as described.
"""
import math
import os
import pathlib
import sys

import bpy
import numpy as np

sys.path.insert(0, os.environ.get("SHERD_ADDON", str(pathlib.Path(__file__).resolve().parents[2] / "tools" / "blender")))
import sherd_fracture  # noqa: E402

SHERD, FOLDER, *MORE = sys.argv[sys.argv.index("--") + 1:]
SIZE = 640, 400


def texture(size=512):
    """Marble: veins are where a sum of waves, bent by one another, is near zero."""
    x, y = np.meshgrid(*2 * [np.linspace(0, 2 * math.pi, size, endpoint=False)])
    bent = np.sin(3 * x + 2 * np.sin(2 * y + 1) + np.sin(5 * x - 3 * y)) + 0.5 * np.sin(7 * y + 2 * np.cos(4 * x) + 2)
    vein = np.exp(-12 * np.abs(bent))[..., None]
    color = (1 - vein) * np.array([0.80, 0.74, 0.66]) + vein * np.array([0.25, 0.10, 0.06])
    image = bpy.data.images.new("marble", size, size)
    image.pixels.foreach_set(np.dstack([color, np.ones((size, size))]).astype(np.float32).ravel())
    image.pack()
    return image


def marble():
    material = bpy.data.materials.new("Marble")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    picture = nodes.new("ShaderNodeTexImage")
    picture.image = texture()
    shader = nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.35
    material.node_tree.links.new(picture.outputs["Color"], shader.inputs["Base Color"])
    return material


def statue():
    """A monkey's bust on a plinth, 1.6 m high, with texture coordinates."""
    bpy.ops.mesh.primitive_cube_add(size=0.8, location=(0, 0, 0.25))
    parts = [bpy.context.active_object]
    parts[0].scale.z = 0.5 / 0.8
    bpy.ops.mesh.primitive_cone_add(vertices=64, radius1=0.32, radius2=0.18, depth=0.7, location=(0, 0.05, 0.8))
    parts.append(bpy.context.active_object)
    bpy.ops.mesh.primitive_monkey_add(size=1.0, location=(0, -0.05, 1.2), rotation=(-0.25, 0, 0))
    parts.append(bpy.context.active_object)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.fill_holes(sides=0)  # at the eyes
    bpy.ops.object.mode_set(mode="OBJECT")
    smooth = parts[2].modifiers.new("Subdivision", "SUBSURF")
    smooth.levels = 2
    bpy.ops.object.modifier_apply(modifier=smooth.name)
    bpy.ops.object.shade_smooth()
    chosen(*parts)
    bpy.ops.object.join()
    made = bpy.context.active_object
    made.name = "Statue"
    bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.cube_project(cube_size=1.5)
    bpy.ops.object.mode_set(mode="OBJECT")
    made.data.materials.clear()
    made.data.materials.append(marble())
    return made


def chosen(*things):
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[-1]


def studio():
    """A floor, a camera and two lamps."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    bpy.ops.mesh.primitive_plane_add(size=40)
    floor = bpy.context.active_object
    bpy.ops.rigidbody.object_add(type="PASSIVE")
    floor.rigid_body.friction = 0.8
    bpy.ops.object.camera_add(location=(2.6, -3.6, 1.75), rotation=(math.radians(76), 0, math.radians(36)))
    scene = bpy.context.scene
    scene.camera = bpy.context.active_object
    scene.camera.data.lens = 42
    bpy.ops.object.light_add(type="AREA", location=(3, -3, 4), rotation=(math.radians(48), 0, math.radians(45)))
    bpy.context.active_object.data.energy, bpy.context.active_object.data.size = 220, 2
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.6, 0.8, 1)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.max_bounces = int(MORE[0]) if MORE else 48, False, 3
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = *SIZE, 100
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 82
    scene.view_settings.view_transform = "Standard"


def render(name):
    bpy.context.scene.render.filepath = os.path.join(FOLDER, f"blender-{name}.jpg")
    bpy.ops.render.render(write_still=True)


def places(pieces):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return np.array([p.evaluated_get(depsgraph).matrix_world.translation for p in pieces])


def parted(pieces, first):
    """How many pieces are more than 2 cm nearer to or farther from the largest one than they were."""
    largest = max(range(len(pieces)), key=lambda i: pieces[i]["sherd_volume"])
    away = lambda at: np.linalg.norm(at - at[largest], axis=1)
    return int((np.abs(away(places(pieces)) - away(first)) > 0.02).sum())


def colored(pieces, on):
    """Pieces in colors of their own, or in their materials again."""
    bpy.context.view_layer.material_override = None
    for piece in pieces if on else ():
        hue = (piece["sherd_fragment"] * 0.618) % 1
        piece.color = (*(0.55 + 0.35 * math.cos(2 * math.pi * (hue + k / 3)) for k in range(3)), 1)
    if on:
        material = bpy.data.materials.new("By piece")
        material.use_nodes = True
        info = material.node_tree.nodes.new("ShaderNodeObjectInfo")
        material.node_tree.links.new(info.outputs["Color"], material.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
        for piece in pieces:
            for slot in piece.material_slots:
                slot.link, slot.material = "OBJECT", material


def paint(thing):
    """The vertex group that weight painting makes: 1 on the head's upper half, falling to 0 at the neck."""
    group = thing.vertex_groups.new(name="hit")
    for vertex in thing.data.vertices:
        weight = min(max((vertex.co.z - 0.95) / 0.45, 0), 1)
        if weight:
            group.add([vertex.index], weight, "REPLACE")


def main():
    sherd_fracture.register()
    os.environ["PATH"] = os.path.dirname(os.path.abspath(SHERD)) + os.pathsep + os.environ["PATH"]
    scene = bpy.context.scene
    studio()
    thing = statue()
    render("statue")

    paint(thing)
    options = {"pieces": 24, "resolution": 160, "seed": 5, "material": "STONE", "weight_group": "hit"}
    chosen(thing)
    bpy.ops.object.sherd_fracture(**options, preview=True)
    preview = bpy.context.selected_objects
    assert len(preview) == 24 and thing.hide_get()
    colored(preview, True)
    render("preview")

    chosen(preview[0])
    bpy.ops.object.sherd_fracture(**options, density=2600, strength=1000)
    pieces = bpy.context.selected_objects
    assert len(pieces) == 24 and not [o for o in bpy.data.objects if o.name.startswith("Statue_001.")]

    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.22, location=(0.1, -0.15, 4.2), segments=48, ring_count=24)
    ball = bpy.context.active_object
    bpy.ops.object.shade_smooth()
    bpy.ops.rigidbody.object_add(type="ACTIVE")
    ball.rigid_body.collision_shape, ball.rigid_body.mass = "SPHERE", 350
    for piece in pieces:
        piece.rigid_body.friction = 0.8
    first = places(pieces)
    for frame in range(1, 61):
        scene.frame_set(frame)
        if frame == 16:
            assert parted(pieces, first) == 0, "glue does not hold until the ball strikes"
        if frame in (20, 60):
            render(f"frame-{frame}")
    count = parted(pieces, first)
    print("pieces that parted:", count)
    assert 4 <= count < 24, count


main()
