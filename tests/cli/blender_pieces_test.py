#!/usr/bin/python3
"""What the Blender add-on's pieces keep of the object, and what they look like.

Environment: as blender_test.py.  The oracle is the object itself: its attributes are known functions of the place that are
linear in each of its triangles, so that every cut has to keep them.
"""
import os
import re
import tomllib

import numpy as np

import blender_test
import skipping

# A ball of quadrilaterals with everything that a mesh may have, scaled, turned, mirrored, in a parent and two collections.
BALL = '''
import math, mathutils

def ball(segments=32, rings=16):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=rings, radius=1)
    thing = bpy.context.active_object
    thing.name = thing.data.name = "Ball"
    mesh = thing.data
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    at = np.array([v.co for v in mesh.vertices])
    corner = np.array([l.vertex_index for l in mesh.loops])
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    for name, k in (("first", 1.0), ("second", 0.5)):
        mesh.uv_layers.new(name=name).data.foreach_set("uv", (k * at[corner][:, :2] + at[corner][:, 2:]).ravel())
    mesh.uv_layers["second"].active = mesh.uv_layers["second"].active_render = True
    for name, kind, domain, field, values in (
            ("bytes", "BYTE_COLOR", "POINT", "color", np.column_stack([0.5 + 0.4 * at, np.full(len(at), 0.25)])),
            ("floats", "FLOAT_COLOR", "CORNER", "color", np.column_stack([3 * at, at[:, 0] + at[:, 1]])[corner]),
            ("heat", "FLOAT", "POINT", "value", at @ [1, 2, 3]),
            ("wind", "FLOAT_VECTOR", "CORNER", "vector", (at[:, [1, 2, 0]])[corner]),
            ("number", "INT", "FACE", "value", np.arange(len(mesh.polygons)) + 7),
            ("north", "BOOLEAN", "FACE", "value", np.array([p.center.z > 0 for p in mesh.polygons])),
            ("id", "INT", "POINT", "value", np.arange(len(at))),
            ("edgy", "FLOAT", "EDGE", "value", np.arange(len(mesh.edges)))):
        mesh.attributes.new(name, kind, domain).data.foreach_set(field, np.ravel(values))
    mesh.color_attributes.active_color = mesh.color_attributes["floats"]
    for name in ("left", "right"):
        group = thing.vertex_groups.new(name=name)
        for v in mesh.vertices:
            if name == "left" or v.co.z > 0.3:
                group.add([v.index], 0.5 + 0.4 * v.co.x, "REPLACE")
    for name in ("one", "two"):
        mesh.materials.append(bpy.data.materials.new(name))
    for p in mesh.polygons:
        p.use_smooth, p.material_index = p.center.x > 0, int(p.center.y > 0)
    for e in mesh.edges:
        e.use_edge_sharp, e.use_seam = e.index % 5 == 0, e.index % 7 == 0
    if bpy.app.version < (4, 1, 0):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.pi
    mesh.normals_split_custom_set((at / np.linalg.norm(at, axis=1, keepdims=True))[corner].astype(np.float32))
    parent = bpy.data.objects.new("Parent", None)
    other = bpy.data.collections.new("Other")
    bpy.context.scene.collection.children.link(other)
    bpy.context.scene.collection.objects.link(parent)
    other.objects.link(thing)
    parent.location, parent.rotation_euler, parent.scale = (1, 2, 3), (0.3, 0.2, 0.1), (2, 1, 1)
    thing.parent = parent
    thing.location, thing.rotation_euler, thing.scale = (0.5, 0, 0), (1, 0, 2), (1, -0.7, 1.5)
    bpy.context.view_layer.update()
    only(thing)
    return thing

def corner_normals(mesh):
    if bpy.app.version < (4, 1, 0):
        mesh.calc_normals_split()
        return [l.normal[:] for l in mesh.loops]
    return [n.vector[:] for n in mesh.corner_normals]

def all_of(thing):
    """A piece with places and normals in the space of the world, and everything on it."""
    mesh, world_of = thing.data, thing.matrix_world
    values = {}
    for a in mesh.attributes:
        field = {"FLOAT_VECTOR": "vector", "FLOAT2": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}.get(a.data_type, "value")
        if not a.name.startswith(".") and a.data_type not in ("STRING", "INT16_2D"):
            values[a.name] = [a.data_type, a.domain, [np.array(getattr(d, field)).tolist() for d in a.data]]
    groups = {g.name: [next((m.weight for m in v.groups if m.group == g.index), -1) for v in mesh.vertices] for g in thing.vertex_groups}
    return {**measures(thing), "at": [(world_of @ v.co)[:] for v in mesh.vertices], "groups": groups, "values": values,
            "polygons": [list(p.vertices) for p in mesh.polygons], "loops": [l.vertex_index for l in mesh.loops],
            "loop_edges": [l.edge_index for l in mesh.loops], "smooth": [p.use_smooth for p in mesh.polygons],
            "material": [mesh.materials[p.material_index].name for p in mesh.polygons], "normals": corner_normals(mesh),
            "sharp": [e.use_edge_sharp for e in mesh.edges], "seam": [e.use_seam for e in mesh.edges],
            "uv": {u.name: [d.uv[:] for d in u.data] for u in mesh.uv_layers}, "parent": thing.parent and thing.parent.name,
            "active": [mesh.uv_layers.active.name, next(u.name for u in mesh.uv_layers if u.active_render),
                       mesh.color_attributes.active_color and mesh.color_attributes.active_color.name],
            "neighbor": [f.value for f in mesh.attributes["neighbor"].data], "collections": [c.name for c in thing.users_collection]}
'''


class Piece:
    """Arrays of what all_of() reports."""

    def __init__(self, found):
        self.__dict__.update(found)
        self.corners = np.array([len(p) for p in self.polygons])
        self.neighbor = np.array(self.neighbor)
        self.inside = self.neighbor > 0
        self.at = np.array(self.at)
        self.loops = np.array(self.loops)
        self.of = np.repeat(np.arange(len(self.polygons)), self.corners)  # polygon of each corner
        self.outer = ~self.inside[self.of]
        self.outer_vertices = np.unique(self.loops[self.outer])

    def area_of_uv(self, name):
        """Of the polygons in the texture, by fans."""
        uv, start = np.array(self.uv[name]), np.cumsum(self.corners) - self.corners
        return np.array([abs(sum(np.cross(uv[s + k] - uv[s], uv[s + k + 1] - uv[s]) for k in range(1, n - 1))) / 2
                         for s, n in zip(start, self.corners)])


class Kept(blender_test.Blender):
    def run_addon(self, script, *more):
        return self.blender(blender_test.ADDON + BALL + script, *more)

    def assert_kept(self, piece, local, source, rounded):
        """local: the places of the piece's vertices in the space of the object; source: what the object has itself; rounded:
        how often colors of 8 bits were, to steps of sRGB of up to 2.28 / 255 of linear light."""
        corner = local[piece.loops]
        outer, vertices = piece.outer, piece.outer_vertices
        close = lambda name, values, expected, which, atol=2e-5: np.testing.assert_allclose(
            np.array(values)[which], expected[which], atol=atol, err_msg=name)
        for name, k in (("first", 1.0), ("second", 0.5)):
            close(name, piece.uv[name], k * corner[:, :2] + corner[:, 2:], outer)
        kind = lambda name: piece.values[name][:2]
        value = lambda name: np.array(piece.values[name][2])
        self.assertEqual(kind("bytes"), ["BYTE_COLOR", "POINT"])
        self.assertEqual(kind("floats"), ["FLOAT_COLOR", "CORNER"])
        close("bytes", value("bytes"), np.column_stack([0.5 + 0.4 * local, np.full(len(local), 0.25)]), vertices,
              rounded * 2.28 / 510)
        close("floats", value("floats"), np.column_stack([3 * corner, corner[:, 0] + corner[:, 1]]), outer, 1e-4)
        close("heat", value("heat"), local @ [1, 2, 3], vertices, 1e-4)
        close("wind", value("wind"), corner[:, [1, 2, 0]], outer)
        close("left", piece.groups["left"], 0.5 + 0.4 * local[:, 0], vertices)
        self.assertTrue((np.array(piece.groups["left"]) >= 0).all(), "inside too, where bones would tear it")
        right = np.array(piece.groups["right"])
        self.assertTrue((right[vertices][local[vertices, 2] < 0] == -1).all())  # a triangle away from its lowest vertex
        self.assertTrue((right[vertices][local[vertices, 2] > 0.6] > 0).all())

        # Faces: each outer one lies in the polygon of the object whose number it has.
        number = value("number") - 7
        outside = ~piece.inside
        self.assertEqual(kind("number"), ["INT", "FACE"])
        middle = np.array([local[p].mean(axis=0) for p in piece.polygons])
        close("plane", np.einsum("ij,ij->i", middle - source["center"][number], source["normal"][number]), np.zeros(len(middle)),
              outside, 1e-2)
        off = np.linalg.norm(middle - source["center"][number], axis=1)
        self.assertLessEqual((off - source["radius"][number])[outside].max(), 1e-5)
        for name, expected in (("north", source["north"]), ("smooth", source["smooth"]), ("material", source["material"])):
            found = piece.smooth if name == "smooth" else piece.material if name == "material" else value("north")
            np.testing.assert_array_equal(np.array(found)[outside], expected[number][outside], err_msg=name)
        whole = outside & (piece.corners == source["corners"][number])
        # Edges between whole polygons are the object's.
        index = value("id")
        for edge, corners in self.edges_between(piece, whole):
            expected = source["edge_of"][tuple(sorted(index[corners]))]
            self.assertEqual((piece.sharp[edge], piece.seam[edge], value("edgy")[edge]),
                             (source["sharp"][expected], source["seam"][expected], expected))
        return whole.sum()

    def edges_between(self, piece, chosen):
        """Edges with a chosen polygon on both sides, and their ends."""
        start = np.cumsum(piece.corners) - piece.corners
        sides = {}
        for p in np.flatnonzero(chosen):
            for k in range(piece.corners[p]):
                sides.setdefault(piece.loop_edges[start[p] + k], []).append(
                    [piece.polygons[p][k], piece.polygons[p][(k + 1) % piece.corners[p]]])
        return [(edge, ends[0]) for edge, ends in sides.items() if len(ends) == 2]

    def source_of(self, found):
        at, polygons = np.array(found["local"]), found["polygons"]
        center = np.array([at[p].mean(axis=0) for p in polygons])
        return {"center": center, "normal": np.array(found["face_normals"]), "corners": np.array([len(p) for p in polygons]),
                "radius": np.array([np.linalg.norm(at[p] - c, axis=1).max() for p, c in zip(polygons, center)]),
                "north": center[:, 2] > 0, "smooth": np.array(found["smooth"]), "material": np.array(found["material"]),
                "edge_of": {tuple(sorted(e)): i for i, e in enumerate(found["edges"])}, "sharp": found["sharp"], "seam": found["seam"]}

    def test_everything_outside_is_the_object_s(self):
        """And of pieces of pieces."""
        reported = self.run_addon('''
thing = ball()
mesh, matrix = thing.data, np.array(thing.matrix_world)
source = {"local": [v.co[:] for v in mesh.vertices], "polygons": [list(p.vertices) for p in mesh.polygons],
          "face_normals": [p.normal[:] for p in mesh.polygons], "smooth": [p.use_smooth for p in mesh.polygons],
          "material": [mesh.materials[p.material_index].name for p in mesh.polygons], "edges": [e.vertices[:] for e in mesh.edges],
          "sharp": [e.use_edge_sharp for e in mesh.edges], "seam": [e.use_seam for e in mesh.edges]}
bpy.ops.object.sherd_fracture(pieces=5, resolution=48, seed=2, rigid_body=False)
bpy.context.view_layer.update()
pieces = sorted(bpy.context.selected_objects, key=lambda p: p.name)
first = [all_of(p) for p in pieces]
only(pieces[0])
bpy.ops.object.sherd_fracture(pieces=3, resolution=48, seed=4, rigid_body=False)
bpy.context.view_layer.update()
again = [all_of(p) for p in bpy.context.selected_objects]
bpy.data.objects["Parent"].location.x += 10
bpy.context.view_layer.update()
answer(source=source, pieces=first, again=again, matrix=matrix, moved=[p.matrix_world.translation[:] for p in pieces[1:]],
       parents={c.name: [k.name for k in c.children] for c in [bpy.context.scene.collection, *bpy.data.collections]})
''')
        source, matrix = self.source_of(reported["source"]), np.array(reported["matrix"])
        inverse = np.linalg.inv(matrix)
        self.assertLess(np.linalg.det(matrix), 0)
        for collection in ("Collection", "Other"):
            self.assertIn("Ball", reported["parents"][collection])
        wholes = 0
        for generation in ("pieces", "again"):
            for found in reported[generation]:
                piece = Piece(found)
                with self.subTest(piece.name):
                    self.assertTrue(piece.closed)
                    self.assertEqual((piece.parent, piece.active), ("Parent", ["second", "second", "floats"]))
                    local = piece.at @ inverse[:3, :3].T + inverse[:3, 3]
                    inner = np.array(piece.values["inside"][2])
                    if generation == "again":  # the faces of old cracks are not the ball's
                        self.assertTrue((inner[piece.inside]).all())
                        self.assertGreater(inner.sum(), piece.inside.sum())
                        levels = np.array(piece.values["level"][2])
                        np.testing.assert_array_equal(np.select([piece.inside, inner], [2, 1], 0), levels)
                        self.assertTrue((np.array(piece.material)[inner] == "Sherd inside").all())
                        for name in piece.uv:
                            self.assertGreater(piece.area_of_uv(name)[inner].min(), 0)
                        piece.inside, piece.outer = inner, ~inner[piece.of]
                        piece.outer_vertices = np.unique(piece.loops[piece.outer])
                    whole = self.assert_kept(piece, local, source, 2 if generation == "pieces" else 3)
                    wholes += whole if generation == "pieces" else 0
                    # Blender keeps 16 bits of two angles, and one normal for corners that differ by less than 0.8 degrees.  Pieces
                    # are interpolated in another space than the ball, which is scaled: by triangles of 0.2, to 0.2 ^ 2 / 4.
                    self.assert_normals(piece, local, inverse, 2e-3 if generation == "pieces" else 0.01)
                    edges = {}
                    for corner, edge in enumerate(piece.loop_edges):
                        edges.setdefault(edge, set()).add(bool(piece.inside[piece.of[corner]]))
                    self.assertTrue(all(piece.sharp[edge] for edge, sides in edges.items() if len(sides) == 2))
        self.assertGreater(wholes, len(source["corners"]) / 3)
        for found, place in zip(reported["pieces"][1:], reported["moved"]):
            np.testing.assert_allclose(place, np.add(found["center"], [10, 0, 0]), atol=1e-4)  # with their parent

    def assert_normals(self, piece, local, inverse, atol):
        """The custom normal at a place of the ball points away from its center."""
        normals = np.array(piece.normals)[piece.outer]
        expected = local[piece.loops[piece.outer]] @ inverse[:3, :3]
        expected /= np.linalg.norm(expected, axis=1, keepdims=True)
        off = np.abs(normals - expected).max(axis=1)
        self.assertLess(off.max(), atol)

    def test_inside_has_material_texture_and_creases(self):
        reported = self.run_addon('''
thing = ball()
bpy.ops.object.sherd_fracture(pieces=5, resolution=48, seed=2, rigid_body=False)
balls = [all_of(p) for p in bpy.context.selected_objects]
bpy.ops.mesh.primitive_cube_add()
bare = bpy.context.active_object
while bare.data.uv_layers:
    bare.data.uv_layers.remove(bare.data.uv_layers[0])
bpy.ops.object.sherd_fracture(pieces=4, resolution=32, rigid_body=False)
answer(balls=balls, bare=[all_of(p) for p in bpy.context.selected_objects])
''')
        for found in reported["balls"] + reported["bare"]:
            piece = Piece(found)
            self.assertTrue(piece.closed)
            self.assertTrue((np.array(piece.material)[piece.inside] == "Sherd inside").all())
            self.assertTrue((np.array(piece.material)[~piece.inside] != "Sherd inside").all())
            self.assertTrue(np.array(piece.smooth)[piece.inside].all())
            self.assertEqual(sorted(piece.uv), ["first", "second"] if "Ball" in piece.name else ["UVMap"])
            area = np.array([np.linalg.norm(sum(np.cross(piece.at[p[k]] - piece.at[p[0]], piece.at[p[k + 1]] - piece.at[p[0]])
                                                for k in range(1, len(p) - 1))) / 2 for p in piece.polygons])
            for name in piece.uv:  # projected along the nearest axis: at most a factor of the square root of 3
                share = (piece.area_of_uv(name) / area)[piece.inside & (area > 1e-6)]
                self.assertGreater(share.min(), 1 / np.sqrt(3) - 0.01)
                self.assertLess(share.max(), 1.01)

    def test_a_texture_looks_the_same_broken(self):
        """Rendered by Cycles before and after, without light: 99.9 % of pixels within 1 of 255."""
        reported = self.run_addon('''
thing = ball()
image = bpy.data.images.new("noise", 64, 64)
image.pixels = np.random.default_rng(1).random(64 * 64 * 4).ravel().tolist()
for name in ("one", "two"):
    material = bpy.data.materials[name]
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    uv, texture, paint, add, shine, out = (nodes.new("ShaderNode" + kind) for kind in (
        "UVMap", "TexImage", "Attribute", "MixRGB", "Emission", "OutputMaterial"))
    uv.uv_map, texture.image, paint.attribute_name = "first" if name == "one" else "second", image, "bytes"
    for a, b in ((uv.outputs["UV"], texture.inputs["Vector"]), (texture.outputs["Color"], add.inputs[1]), (paint.outputs["Color"], add.inputs[2]),
                 (add.outputs["Color"], shine.inputs["Color"]), (shine.outputs[0], out.inputs["Surface"])):
        links.new(a, b)
scene, camera = bpy.context.scene, bpy.data.objects["Camera"]
center = thing.matrix_world.translation
camera.location = center + mathutils.Vector((0, -9, 1))
camera.rotation_euler = (center - camera.location).to_track_quat("-Z", "Y").to_euler()
scene.render.engine, scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", "CPU", 4, False
scene.cycles.use_adaptive_sampling, scene.view_settings.view_transform = False, "Standard"
scene.render.resolution_x = scene.render.resolution_y = 200
scene.render.resolution_percentage = 100
def pixels(name):
    scene.render.filepath = os.path.join(sys.argv[-1], name)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath + ".png")
    return np.rint(255 * np.array(image.pixels[:])).reshape(-1, 4)[:, :3]
before = pixels("before")
bpy.ops.object.sherd_fracture(pieces=8, resolution=48, rigid_body=False)
after = pixels("after")
answer(off=np.abs(before - after).max(axis=1), seen=len(np.unique(before, axis=0)))
''', self.tmp)
        self.assertGreater(reported["seen"], 2000)
        self.assertGreaterEqual((np.array(reported["off"]) <= 1).mean(), 0.999)

    def test_default_cube_has_few_triangles_and_the_same_cracks_at_any_resolution(self):
        reported = self.run_addon('''
found = {}
for resolution in (96, 256):
    only(cube)
    bpy.ops.object.sherd_fracture(**{"original": "KEEP", "rigid_body": False, **({} if resolution == 96 else {"resolution": 256})})
    found[resolution] = [look(p) for p in bpy.context.selected_objects]
    found[resolution] = [{**f, "normals": [q.normal[:] for q in p.data.polygons], "triangles": len(world(p)[1])}
                         for f, p in zip(found[resolution], bpy.context.selected_objects)]
answer(**{str(k): v for k, v in found.items()})
''')
        self.assertEqual(len(reported["96"]), 8)
        self.assertLess(sum(f["triangles"] for f in reported["96"]), 1000)
        few, many = ({(f["properties"]["sherd_fragment"], n): self.plane(f, n) for f in reported[r] for n in set(f["neighbor"]) - {0}}
                     for r in ("96", "256"))
        large = {pair for pair, (area, *_) in few.items() if area > 0.1}  # of a side of 2
        self.assertGreater(len(large), 20)
        self.assertLessEqual(large, set(many))
        for pair in large:
            (area, normal, offset), (area_256, normal_256, offset_256) = few[pair], many[pair]
            self.assertAlmostEqual(area_256, area, delta=0.02)
            self.assertGreater(normal @ normal_256, np.cos(0.02))
            self.assertAlmostEqual(offset_256, offset, delta=0.01)  # half of a voxel of the coarse one
        for one, other in zip(reported["96"], reported["256"]):
            self.assertAlmostEqual(other["volume"], one["volume"], delta=0.005)

    def plane(self, f, neighbor):
        """Area, mean normal and offset of a contact."""
        which = np.array(f["neighbor"]) == neighbor
        area, normal = np.array(f["area"])[which], np.array(f["normals"])[which]
        mean = area @ normal
        mean /= np.linalg.norm(mean)
        return area.sum(), mean, area @ np.array(f["middles"])[which] @ mean / area.sum()

    def test_open_meshes_are_closed_with_few_faces(self):
        """The monkey has holes: its pieces are smooth, coarse, and near the texture that it had."""
        reported = self.run_addon('''
bpy.ops.mesh.primitive_monkey_add()
monkey = bpy.context.active_object
mesh = monkey.data
at = np.array([v.co for v in mesh.vertices])
corner = np.array([l.vertex_index for l in mesh.loops])
while mesh.uv_layers:
    mesh.uv_layers.remove(mesh.uv_layers[0])
for name in ("first", "second"):
    mesh.uv_layers.new(name=name).data.foreach_set("uv", at[corner][:, :2].ravel())
heat = mesh.attributes.new("heat", "FLOAT", "POINT")
heat.data.foreach_set("value", at @ [1, 2, 3])
bpy.ops.object.sherd_fracture(pieces=8, rigid_body=False)
answer(pieces=[all_of(p) for p in bpy.context.selected_objects])
''')
        pieces = [Piece(found) for found in reported["pieces"]]
        self.assertLess(sum(len(p.polygons) for p in pieces), 10000)  # 84,814 evenly
        off = {"first": [], "second": [], "heat": []}
        for p in pieces:
            self.assertTrue(p.closed)
            for name in ("first", "second"):
                off[name].append(np.abs(np.array(p.uv[name]) - p.at[p.loops][:, :2])[p.outer].max(axis=1))
                self.assertGreater(p.area_of_uv(name)[p.inside].sum(), 0)
            off["heat"].append(np.abs(np.array(p.values["heat"][2]) - p.at @ [1, 2, 3])[p.outer_vertices])
        voxel = 2.73 / 96
        for name, values in off.items():
            self.assertLess(np.quantile(np.concatenate(values), 0.98), (3 if name == "heat" else 1) * voxel, name)

    def test_modifiers_and_shape_keys_are_applied(self):
        reported = self.run_addon('''
cube.shape_key_add(name="Basis")
cube.shape_key_add(name="taller").data[0].co.z -= 1
cube.data.shape_keys.key_blocks["taller"].value = 1
cube.modifiers.new("Subdivision", "SUBSURF").levels = 2
bpy.context.view_layer.update()
whole = measures(cube)
import sherd_fracture.job
notes = []
sherd_fracture.job.Job.close, close = lambda job: (notes.extend(job.notes), close(job)), sherd_fracture.job.Job.close
bpy.ops.object.sherd_fracture(pieces=3, resolution=48, rigid_body=False)
pieces = bpy.context.selected_objects
answer(whole=whole, pieces=[measures(p) for p in pieces], notes=notes, left=[len(p.modifiers) for p in pieces],
       quads=sum(len(q.vertices) == 4 for p in pieces for q in p.data.polygons))
''')
        self.assertIn("the modifiers and shape keys of Cube are applied to its pieces", reported["notes"])
        self.assertAlmostEqual(sum(p["volume"] for p in reported["pieces"]), reported["whole"]["volume"], delta=1e-5)
        self.assertEqual(reported["left"], [0, 0, 0])
        self.assertGreater(reported["quads"], 40)  # of 96; the others are cut


class Program(blender_test.Blender):
    """Which program the add-on starts, and how."""

    def test_the_extension_s_program_is_found_and_made_executable(self):
        bundle = self.tmp / "site" / "sherd_program" / "bin"
        bundle.mkdir(parents=True)
        (bundle / "sherd").write_text('#!/bin/sh\necho "$@" > "$OUT/words"\nenv > "$OUT/environment"\nexec ' f'"{os.path.abspath(blender_test.SHERD)}" "$@"\n')
        (bundle / "sherd").chmod(0o644)
        reported = self.blender(blender_test.ADDON + '''
import sherd_fracture.program as own
folder = sys.argv[-1]
os.environ.update(LD_LIBRARY_PATH="/nowhere", PYTHONPATH="/nowhere", OUT=folder)
os.environ.pop("HOME", None)
in_path = own.program(bpy.context)
preferences.binary = ""
sys.path.append(folder + "/site")
bundled = own.program(bpy.context)
result = bpy.ops.object.sherd_fracture(pieces=2, resolution=32, rigid_body=False)
loaded = "sherd_program" in sys.modules
preferences.binary = SHERD
answer(named=in_path, bundled=bundled, result=list(result), loaded=loaded, again=own.program(bpy.context), kept=own.environment(SHERD).get("LD_LIBRARY_PATH"))
''', self.tmp)
        self.assertEqual((reported["named"], reported["again"]), (os.path.abspath(blender_test.SHERD),) * 2)
        self.assertEqual(reported["bundled"], str(bundle / "sherd"))
        self.assertEqual((reported["result"], reported["loaded"]), (["FINISHED"], False))
        self.assertIn("--device builtin", (self.tmp / "words").read_text())
        environment = (self.tmp / "environment").read_text()
        self.assertFalse(re.search("^(LD_LIBRARY_PATH|PYTHONPATH|HOME)=", environment, re.M), environment)
        self.assertEqual(reported["kept"], "/nowhere")  # a program of the user's may need it

    def test_the_manifest_is_the_add_on_s(self):
        manifest = tomllib.loads((blender_test.TOOLS / "sherd_fracture" / "blender_manifest.toml").read_text())
        text = (blender_test.TOOLS / "sherd_fracture" / "__init__.py").read_text()
        version = re.search(r'"version": \((\d+), (\d+), (\d+)\)', text).groups()
        self.assertEqual(manifest["version"], ".".join(version))
        self.assertEqual((manifest["license"], sorted(manifest["permissions"])), (["SPDX:GPL-3.0-or-later"], ["files"]))
        self.assertLessEqual(len(manifest["tagline"]), 64)
        self.assertTrue(all(len(why) <= 64 and why[-1].isalnum() for why in manifest["permissions"].values()))


if __name__ == "__main__":
    skipping.main()
