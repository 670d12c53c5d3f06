#!/usr/bin/python3
"""The unit and the upward axis of meshes: where files say them, what is assumed, and that masses, scenes, images and the viewer follow
them.  The judge is a box of 1 x 2 x 4 in known units and readers of this test's own; tests/python/test_units.py has trimesh.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import json
import os
import re
import zipfile

import numpy as np

import skipping
from cli_test import CommandLine, joined, write_obj, write_stl
from geo_file import Geometry
from glb_file import PHYSICS, Glb
from png_file import read_png
from usd_file import read_usda
from viewer_page import Page

SIDES = np.array([1.0, 2.0, 4.0])
FACES = [(0, 2, 6, 4), (1, 5, 7, 3), (0, 4, 5, 1), (2, 3, 7, 6), (0, 1, 3, 2), (4, 6, 7, 5)]  # vertices x + 2 y + 4 z


def box(scale=1.0):
    """Vertices and triangles of the box."""
    v = [tuple(scale * SIDES * [i & 1, i >> 1 & 1, i >> 2]) for i in range(8)]
    return v, [t for a, b, c, d in FACES for t in ((a, b, c), (a, c, d))]


def write_off(path, mesh):
    v, f = mesh
    with open(path, "w") as out:
        out.write(f"OFF\n{len(v)} {len(f)} 0\n")
        out.writelines("%r %r %r\n" % p for p in v)
        out.writelines("3 %d %d %d\n" % t for t in f)


def write_ply(path, mesh):
    v, f = mesh
    with open(path, "w") as out:
        out.write(f"ply\nformat ascii 1.0\nelement vertex {len(v)}\nproperty double x\nproperty double y\nproperty double z\n"
                  f"element face {len(f)}\nproperty list uchar int vertex_indices\nend_header\n")
        out.writelines("%r %r %r\n" % p for p in v)
        out.writelines("3 %d %d %d\n" % t for t in f)


def write_fbx(path, mesh, settings):
    v, f = mesh
    numbers = ",".join(repr(x) for p in v for x in p)
    corners = ",".join(f"{a},{b},{-c - 1}" for a, b, c in f)
    with open(path, "w") as out:
        out.write("; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}\n"
                  f"GlobalSettings:  {{\n\tVersion: 1000\n\tProperties70:  {{\n{settings}\t}}\n}}\n"
                  f'Objects:  {{\n\tGeometry: 1000, "Geometry::box", "Mesh" {{\n\t\tVertices: *{3 * len(v)} {{\n\t\t\ta: {numbers}\n\t\t}}\n'
                  f"\t\tPolygonVertexIndex: *{3 * len(f)} {{\n\t\t\ta: {corners}\n\t\t}}\n\t\tGeometryVersion: 124\n\t}}\n"
                  '\tModel: 2000, "Model::box", "Mesh" {\n\t\tVersion: 232\n\t}\n}\n'
                  'Connections:  {\n\tC: "OO",2000,0\n\tC: "OO",1000,2000\n}\n')


def write_dae(path, mesh, asset):
    v, f = mesh
    numbers, corners = " ".join(repr(x) for p in v for x in p), " ".join(str(i) for t in f for i in t)
    with open(path, "w") as out:
        out.write('<?xml version="1.0"?>\n<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">\n'
                  f'<asset>{asset}</asset><library_geometries><geometry id="box"><mesh><source id="p"><float_array id="a" count="{3 * len(v)}">'
                  f'{numbers}</float_array><technique_common><accessor source="#a" count="{len(v)}" stride="3"><param name="X" type="float"/>'
                  '<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">'
                  f'<input semantic="POSITION" source="#p"/></vertices><triangles count="{len(f)}"><input semantic="VERTEX" source="#v" offset="0"/>'
                  f'<p>{corners}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">'
                  '<node id="n"><instance_geometry url="#box"/></node></visual_scene></library_visual_scenes>'
                  '<scene><instance_visual_scene url="#s"/></scene></COLLADA>\n')


def write_3mf(path, mesh, attributes):
    v, f = mesh
    model = (f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- <model unit="foot"> --><model {attributes} xml:lang="en-US" '
             'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1" type="model"><mesh><vertices>'
             + "".join('<vertex x="%r" y="%r" z="%r"/>' % p for p in v) + "</vertices><triangles>"
             + "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % t for t in f)
             + '</triangles></mesh></object></resources><build><item objectid="1"/></build></model>')
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("[Content_Types].xml", '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
                      '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
                      '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
        file.writestr("_rels/.rels", '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
                      '<Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        file.writestr("3D/3dmodel.model", model)


def matrix_of(node):
    """[4, 4] of a node's translation, rotation and scale."""
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    matrix = np.eye(4)
    matrix[:3, :3] = turn * node.get("scale", [1, 1, 1])
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def placed(glb):
    """[n, 3] all vertices of a glTF file in its own space, and the matrix of each node."""
    nodes = glb.json["nodes"]
    points, worlds = [], {}
    stack = [(i, np.eye(4)) for i in glb.json["scenes"][glb.json["scene"]]["nodes"]]
    while stack:
        i, above = stack.pop()
        worlds[i] = above @ matrix_of(nodes[i])
        if "mesh" in nodes[i]:
            positions = glb.whole(nodes[i]["mesh"])[0].astype(float)
            points.append(positions @ worlds[i][:3, :3].T + worlds[i][:3, 3])
        stack += [(child, worlds[i]) for child in nodes[i].get("children", [])]
    return np.concatenate(points), worlds


class Units(CommandLine):
    def inspected(self, path):
        result = self.run_sherd("inspect", path, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        return (found["unit"]["meters"], found["unit"]["from"], found["up"]["axis"], found["up"]["from"]), found

    def stl(self, name="box.stl"):
        """100 x 200 x 400 mm."""
        write_stl(self.path(name), box(100))
        return self.path(name)

    def test_files_without_them_have_those_of_their_format(self):
        millimeters, meters = (0.001, "format", "z", "format"), (1, "format", "y", "format")
        for name, write, expected in (("a.stl", write_stl, millimeters), ("a.off", write_off, millimeters), ("a.obj", write_obj, meters), ("a.ply", write_ply, meters)):
            write(self.path(name), box())
            self.assertEqual(self.inspected(self.path(name))[0], expected, name)

    def test_fbx_says_both(self):
        axes = "".join(f'\t\tP: "{key}", "int", "Integer", "",{value}\n' for key, value in (("UpAxis", 2), ("UpAxisSign", 1), ("FrontAxis", 1), ("FrontAxisSign", -1)))
        for centimeters, meters, unit in ((1, 0.01, "file"), (2.54, 0.0254, "file"), (100, 1, "file"), (1e300, 1, "format")):
            write_fbx(self.path("a.fbx"), box(), axes + f'\t\tP: "UnitScaleFactor", "double", "Number", "",{centimeters}\n')
            found, report = self.inspected(self.path("a.fbx"))
            self.assertEqual(found, (meters, unit, "z", "file"))
            # Coordinates are the file's own.
            self.assertEqual(np.subtract(report["box_max"], report["box_min"]).tolist(), SIDES.tolist())

    def test_collada_is_in_meters_and_says_its_axis(self):
        for asset, up in (("<unit meter='0.5'/><up_axis>Z_UP</up_axis>", ("z", "file")), ("<up_axis> X_UP </up_axis>", ("x", "file")),
                          ("<!-- <up_axis>Z_UP</up_axis> --><up_axis>Y_UP</up_axis>", ("y", "file")), ("", ("y", "format")),
                          ("<up_axis>UP</up_axis>", ("y", "format"))):
            write_dae(self.path("a.dae"), box(), asset)
            self.assertEqual(self.inspected(self.path("a.dae"))[0], (1, "file", *up), asset)

    def test_3mf_says_its_unit_and_z_is_up(self):
        for attributes, unit in (("unit='inch'", (0.0254, "file")), ('requiredextensions="" unit = "micron"', (1e-6, "file")), ("", (0.001, "format")),
                                 ("unit='parsec'", (0.001, "format"))):
            write_3mf(self.path("a.3mf"), box(), attributes)
            self.assertEqual(self.inspected(self.path("a.3mf"))[0], (*unit, "z", "format"), attributes)

    def test_one_line_has_the_size_and_where_it_is_from(self):
        write_obj(self.path("box.obj"), box(0.1))
        for mesh, options, words in ((self.stl(), (), "box.stl: 400 mm high, z up (assumed for .stl: --up, --unit)"),
                                     (self.stl(), ("--unit", "in"), "box.stl: 400 in high (unit as given), z up (assumed for .stl: --up)"),
                                     (self.path("box.obj"), ("--up", "x", "--unit", "ft"), "box.obj: 0.1 ft high, x up (as given)"),
                                     (self.path("box.obj"), (), "box.obj: 0.2 m high, y up (assumed for .obj: --up, --unit)"),
                                     (self.path("box.obj"), ("--unit", "1e9"), "box.obj: 2e+05 km high (unit as given), y up (assumed for .obj: --up)")):
            result = self.done("--write", "labels", *options, mesh=mesh)
            self.assertIn(words, result.stdout.splitlines())
        report = json.loads(self.done("--write", "labels", "--json", mesh=self.stl()).stdout)
        self.assertAlmostEqual(report["height_meters"], 0.4, places=9)
        self.assertEqual((report["unit"], report["up"]), ({"name": "mm", "meters": 0.001, "from": "format"}, {"axis": "z", "from": "format"}))

    def test_a_unit_that_is_none_is_refused(self):
        for unit in ("0", "-1", "1e300", "1e-300", "nan", "inf", "yard", "", "MM"):
            self.refused(2, self.fracture("--unit", unit), "--unit")
        self.nothing_written()

    def test_manifest_records_what_was_used(self):
        manifest = self.written("labels", mesh=self.stl())
        self.assertEqual(manifest["source"]["unit"], {"name": "mm", "meters": 0.001, "from": "format"})
        self.assertEqual(manifest["source"]["up"], {"axis": "z", "from": "format"})
        self.assertFalse({"up", "unit"} & set(manifest["options"]))
        manifest = self.written("labels", "--up", "x", "--unit", "0.5", mesh=self.stl())
        self.assertEqual((manifest["source"]["unit"], manifest["source"]["up"]), ({"meters": 0.5, "from": "option"}, {"axis": "x", "from": "option"}))
        self.assertEqual((manifest["options"]["up"], manifest["options"]["unit"]), ("x", 0.5))

    def test_fragments_have_those_of_their_manifest(self):
        manifest = self.written("mesh,vdb", mesh=self.stl())
        files = manifest["fragments"][0]["files"]
        self.assertEqual(self.inspected(os.path.join(self.out, files["mesh"]))[0], (0.001, "format", "z", "format"))
        for name in files["mesh"], files["vdb"]:
            again = self.written("labels", mesh=os.path.join(self.out, name), out=self.path("again"))
            self.assertEqual((again["source"]["unit"]["meters"], again["source"]["up"]["axis"]), (0.001, "z"), name)

    def test_glb_scene_is_in_meters_and_weighs_what_it_should(self):
        for up, rotated in (("z", [0, 2, 1]), ("x", [2, 0, 1]), ("y", [0, 1, 2])):  # x up: x goes to y, y to z, z to x
            manifest = self.written("scene", "--density", "2500", "--joint-strength", "1e6", "--up", up, mesh=self.stl())
            file = Glb(self, os.path.join(self.out, "scene.glb"))
            points, worlds = placed(file)
            np.testing.assert_allclose(points.max(axis=0) - points.min(axis=0), 0.1 * SIDES[rotated], rtol=1e-5)
            masses = [file.physics(i)["motion"]["mass"] for i in sorted(worlds) if "motion" in file.physics(i)]
            self.assertAlmostEqual(sum(masses), 2500 * 0.1 * 0.2 * 0.4, places=3)
            for fragment, mass in zip(manifest["fragments"], masses):
                self.assertAlmostEqual(mass, 2500 * fragment["volume"] * 1e-9, places=9)
            # Kilograms and meters: the trace is twice the sum of squared distances, and that of millimeters a million times.
            for i, fragment in enumerate(manifest["fragments"]):
                inertia = sum(file.physics(i)["motion"]["inertiaDiagonal"])
                self.assertAlmostEqual(inertia / (2500 * 1e-15 * sum(fragment["inertia"][:3])), 1, places=6)
            contacts = {(f["id"], c["id"]): c["area"] for f in manifest["fragments"] for c in f["contacts"]}
            joints = [node for node in file.json["nodes"] if "breakForce" in node.get("extras", {})]
            self.assertTrue(joints)
            for node in joints:
                one, other = map(int, re.findall(r"\d+", node["name"]))
                self.assertAlmostEqual(node["extras"]["breakForce"] / (1e6 * 1e-6 * contacts[one, other]), 1, places=9)

    def test_glb_pieces_are_in_meters_and_read_back_to_the_bit(self):
        for options in (), ("--plain-meshes",):
            self.written("mesh,solid", "--mesh-format", "glb,ply", "--precision", "single", *options, mesh=self.stl())
            for name in ("box", "box_001", "box_002", "box_003"):
                file = os.path.join(self.out, "meshes", name)
                points, _ = placed(Glb(self, file + ".glb"))
                report, found = self.inspected(file + ".glb")
                self.assertEqual(report, (0.001, "file", "z", "file"))
                other = self.inspected(file + ".ply")[1]
                self.assertEqual((found["box_min"], found["box_max"]), (other["box_min"], other["box_max"]))
                high = np.subtract(found["box_max"], found["box_min"])
                np.testing.assert_allclose(points.max(axis=0) - points.min(axis=0), 0.001 * high[[0, 2, 1]], rtol=1e-5)
            self.assertEqual(self.run_sherd("evaluate", self.out).returncode, 0)

    def test_convert_gives_glb_its_size_and_back(self):
        for a, b in (("box.stl", "box.glb"), ("box.glb", "back.stl")):
            self.stl()
            self.assertEqual(self.run_sherd("convert", self.path(a), self.path(b)).returncode, 0)
        points, _ = placed(Glb(self, self.path("box.glb")))
        np.testing.assert_allclose(points.max(axis=0) - points.min(axis=0), [0.1, 0.4, 0.2], rtol=1e-6)
        with open(self.path("box.stl"), "rb") as one, open(self.path("back.stl"), "rb") as other:
            self.assertEqual(*(sorted(map(tuple, np.frombuffer(f.read()[84:], "<12f4, <u2")["f0"][:, 3:].tolist())) for f in (one, other)))

    def test_a_foreign_root_is_applied(self):
        """Only a root with just the transform that the asset names is the one of ours."""
        self.stl()
        self.run_sherd("convert", self.path("box.stl"), self.path("box.glb"))
        with open(self.path("box.glb"), "rb") as file:
            data = file.read()
        # Three bytes of the scale, as an editor that keeps `extras` might change them.
        changed = data.replace(b'"scale":[0.001,0.001,0.001]', b'"scale":[0.002,0.002,0.002]')
        self.assertNotEqual(changed, data)
        report, found = self.inspected(self.path("other.glb", changed))
        self.assertEqual(report, (1, "file", "y", "file"))
        np.testing.assert_allclose(np.subtract(found["box_max"], found["box_min"]), [0.2, 0.8, 0.4], rtol=1e-6)

    def test_usd_says_its_unit_and_weighs_what_it_should(self):
        manifest = self.written("usd", "--density", "2500", "--joint-strength", "1e6", mesh=self.stl())
        metadata, root = self.stage()
        self.assertEqual((metadata["metersPerUnit"], metadata["upAxis"], metadata["kilogramsPerUnit"]), (0.001, "Z", 1))
        masses = [prim.values["physics:mass"] for _, prim in root.walk() if "physics:mass" in prim.values]
        self.assertAlmostEqual(sum(masses), 2500 * 0.1 * 0.2 * 0.4, places=3)
        # Kilograms, seconds and millimeters: a newton is 1000 of them.
        contacts = {(f["id"], c["id"]): c["area"] for f in manifest["fragments"] for c in f["contacts"]}
        joints = root.child("joints").children
        self.assertTrue(joints)
        for joint in joints:
            one, other = map(int, re.findall(r"\d+", joint.name))
            self.assertAlmostEqual(joint.values["physics:breakForce"] / (1e6 * 1e-6 * contacts[one, other] * 1000), 1, places=5)

    def stage(self):
        with open(os.path.join(self.out, "scene.usda"), encoding="utf-8") as file:
            return read_usda(file.read())

    def test_usd_is_rotated_where_x_points_up(self):
        self.written("usd", "--up", "x", mesh=self.stl())
        metadata, root = self.stage()
        self.assertEqual(metadata["upAxis"], "Y")
        w, x, y, z = root.values["xformOp:orient"]
        turn = matrix_of({"rotation": [x, y, z, w]})[:3, :3]
        np.testing.assert_allclose(turn @ [1, 0, 0], [0, 1, 0], atol=1e-12)
        self.assertEqual(root.values["xformOpOrder"], ["xformOp:orient"])

    def test_graph_and_constraints_are_in_kilograms_and_newtons(self):
        manifest = self.written("graph", "--density", "2500", "--joint-strength", "1e6", mesh=self.stl())
        with open(os.path.join(self.out, "graph.json")) as file:
            graph = json.load(file)
        self.assertAlmostEqual(sum(chunk.get("mass", 0) for chunk in graph["chunks"]), 2500 * 0.1 * 0.2 * 0.4, places=3)
        areas = sorted(c["area"] for f in manifest["fragments"] for c in f["contacts"] if f["id"] < c["id"])
        strengths = Geometry(os.path.join(self.out, "graph.geo")).attributes["primitive", "strength"]
        # A pascal by a square millimeter is a millionth of a newton.
        np.testing.assert_allclose(sorted(strengths), areas, rtol=1e-5)

    def test_images_stand_up_by_themselves(self):
        """A box in STL and the same rotated to y up in PLY have the same image, bit for bit."""
        v, f = joined(box(100), ([(x + 300, y, z / 2) for x, y, z in box(100)[0]], box()[1]))
        write_stl(self.path("two.stl"), (v, f))
        write_ply(self.path("two.ply"), ([(x, z, -y) for x, y, z in v], f))
        for name in ("two.stl", "two.ply"):
            result = self.run_sherd("render", self.path(name), "-o", self.path(name + ".png"), "--size", "96x64")
            self.assertEqual(result.returncode, 0, result.stderr)
        one, other = (read_png(self.path(name + ".png")) for name in ("two.stl", "two.ply"))
        np.testing.assert_array_equal(one, other)
        self.run_sherd("render", self.path("two.stl"), "-o", self.path("side.png"), "--size", "96x64", "--up", "y")
        self.assertTrue((read_png(self.path("side.png")) != one).any())

    def test_a_fracture_is_rendered_as_it_stands(self):
        self.written("mesh,preview,viewer", "--unit", "cm", "--density", "2500", mesh=self.stl())
        shots = {}
        for options in (), ("--up", "z"), ("--up", "y"):
            self.run_sherd("render", self.out, "-o", self.path("a.png"), "--size", "96x64", *options)
            shots[options] = read_png(self.path("a.png"))
        np.testing.assert_array_equal(shots[()], shots["--up", "z"])
        self.assertTrue((shots[()] != shots["--up", "y"]).any())
        # The preview is the image of the same view.
        self.run_sherd("render", self.out, "-o", self.path("a.png"))
        far = np.abs(read_png(self.path("a.png")) - read_png(os.path.join(self.out, "preview.png")))
        self.assertLess(np.mean(far > 8), 0.01)
        written = Page(os.path.join(self.out, "viewer.html")).scene
        self.run_sherd("view", self.out, "-o", self.path("page.html"))
        for scene in written, Page(self.path("page.html")).scene:
            self.assertEqual((scene["unit"], scene["up"]), ("cm", "z"))
            self.assertAlmostEqual(scene["density"], 2500 * 1e-6, places=9)  # kilograms in a cubic centimeter


if __name__ == "__main__":
    skipping.main()
