#!/usr/bin/python3
"""The look of a mesh on its fragments, and `--mesh-format`: files read by parsers of this test's own.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy.
"""
import json
import os
import struct
import unittest
import zipfile
import zlib

import numpy as np

import skipping
from cli_test import CommandLine, tree
from glb_file import Glb
from ply_file import columns, read_ply

INSIDE = np.array([224, 214, 196])


def png(pixels):
    """A picture [h, w, 3] of bytes as PNG."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    h, w, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", w, h, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


PICTURE = png(np.arange(4 * 4 * 3, dtype=np.uint8).reshape(4, 4, 3))


def color_at(p):
    """0..1, linear in the place, so that it is known between corners too."""
    return 0.5 + 0.2 * p


def drum(colors=True, segments=48, rings=12):
    """A closed drum about y as OBJ: u once round its side, whose material is `side`, v up; caps of another material."""
    angle = 2 * np.pi * np.arange(segments) / segments
    ring = np.column_stack([np.cos(angle), 0 * angle, np.sin(angle)])
    levels = np.linspace(-1, 1, rings + 1)
    v = np.concatenate([ring + [0, y, 0] for y in levels] + [[[0, -1, 0], [0, 1, 0]]])
    lines = ["mtllib drum.mtl", "o drum"]
    for p in v:
        lines.append("v " + " ".join(f"{x:.9g}" for x in ([*p, *color_at(p)] if colors else p)))
    lines += [f"vt {i / segments:.9g} {j / rings:.9g}" for j in range(rings + 1) for i in range(segments + 1)]
    lines.append("usemtl side of it")
    for j in range(rings):
        for i in range(segments):
            corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]  # quads
            lines.append("f " + " ".join(f"{b * segments + a % segments + 1}/{b * (segments + 1) + a + 1}"
                                         for a, b in corners))
    lines.append("usemtl cap")
    for j, middle in ((0, len(v) - 1), (rings, len(v))):
        for i in range(segments):
            a, b = j * segments + i + 1, j * segments + (i + 1) % segments + 1
            lines.append(f"f {middle} {a} {b}" if j == 0 else f"f {middle} {b} {a}")
    return ("\n".join(lines) + "\n").encode()


def srgb(linear):
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def surface(corners):
    """Triangles [m, 3, 3] as a set, whatever their order and first corner."""
    return {min((a, b, c), (b, c, a), (c, a, b)) for a, b, c in (tuple(map(tuple, t)) for t in corners.tolist())}


class Look(CommandLine):
    def drum(self, library=b"newmtl side of it\nKd 1 1 1\nmap_Kd paint.png\nnewmtl cap\nKd 0.25 0.5 0.75\n", **more):
        if library is not None:
            self.path("drum.mtl", library)
        self.path("paint.png", PICTURE)
        return self.path("drum.obj", drum(**more))

    def done(self, *arguments, **more):
        return super().done("--surface", "smooth", *arguments, **more)

    def pieces(self):
        with open(os.path.join(self.out, "manifest.json")) as file:
            return json.load(file)

    def at(self, name):
        return os.path.join(self.out, name)

    def package(self, name, resources, properties):
        """A cube of side 1 as 3MF, two triangles a side in the order -x +x -y +y -z +z, with attributes of each side's triangles."""
        corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        sides = (0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)
        triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}" {p}/><triangle v1="{a}" v2="{c}" v3="{d}" {p}/>'
                            for (a, b, c, d), p in zip(sides, properties))
        model = ('<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" '
                 f'xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02"><resources>{resources}<object id="1"><mesh><vertices>'
                 + "".join('<vertex x="%d" y="%d" z="%d"/>' % c for c in corners)
                 + f'</vertices><triangles>{triangles}</triangles></mesh></object></resources><build><item objectid="1"/></build></model>')
        path = self.path(name)
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
            file.writestr("3D/3dmodel.model", model)
        return path

    def test_colors_of_triangles_of_3mf(self):
        """Each side of a cube has a color, which its faces have in the fragments' .ply and .glb."""
        colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0], [0, 255, 255], [90, 60, 30]])
        group = '<m:colorgroup id="3">' + "".join('<m:color color="#%02X%02X%02X"/>' % tuple(c) for c in colors) + "</m:colorgroup>"
        mesh = self.package("cube.3mf", group, [f'pid="3" p1="{i}"' for i in range(6)])
        super().done("--surface", "exact", "--mesh-format", "ply,glb", mesh=mesh)
        for fragment in self.pieces()["fragments"]:
            ply, glb = fragment["files"]["mesh"]
            _, vertex, face = read_ply(self.at(ply))
            outside = face["vertex_indices"][face["neighbor"] == 0]
            # A vertex has one color, on an edge of the cube that of one of its sides.
            self.check_sides(columns(vertex, "x", "y", "z")[outside], columns(vertex, "red", "green", "blue")[outside], colors, False)
            for material, triangles, attributes in Glb(self, self.at(glb)).primitives():
                if material["name"] != "inside":
                    tint = np.round(255 * srgb(attributes["COLOR_0"][:, :3] / 65535))
                    self.check_sides(attributes["POSITION"][triangles], tint[triangles], colors, True)

    def check_sides(self, corners, tint, colors, by_corner):
        """Triangles [m, 3, 3] on the sides of the cube have their side's color at each corner, or one of its vertex's sides."""
        self.assertGreater(len(corners), 0)
        for at, found in zip(corners, tint):
            side = [2 * k + int(at[0, k]) for k in range(3) if np.ptp(at[:, k]) == 0 and at[0, k] in (0, 1)]
            self.assertEqual(len(side), 1)
            for v, color in zip(at, found):
                sides = side if by_corner else [2 * k + int(v[k]) for k in range(3) if v[k] in (0, 1)]
                self.assertIn(tuple(color), {tuple(colors[i]) for i in sides}, (at, found))

    def test_base_materials_of_3mf(self):
        group = ('<basematerials id="3"><base name="clay" displaycolor="#BC8040"/><base name="glaze" displaycolor="#0000FF"/></basematerials>')
        mesh = self.package("cube.3mf", group, ['pid="3" p1="0"'] * 5 + ['pid="3" p1="1"'])
        super().done("--surface", "exact", "--mesh-format", "obj", mesh=mesh)
        library = [n for n in tree(self.out) if n.endswith(".mtl")]
        with open(self.at(library[0])) as file:
            text = file.read()
        self.assertIn("newmtl clay", text)
        self.assertIn("newmtl glaze", text)
        used = {}
        for fragment in self.pieces()["fragments"]:
            v, material = [], None
            with open(self.at(fragment["files"]["mesh"])) as file:
                for words in map(str.split, file):
                    if words[:1] == ["v"]:
                        v.append([float(x) for x in words[1:4]])
                    elif words[:1] == ["usemtl"]:
                        material = words[1]
                    elif words[:1] == ["f"]:
                        z = [v[int(w.split("/")[0]) - 1][2] for w in words[1:]]
                        used.setdefault(material, set()).add(min(z) == max(z) == 1)
        self.assertEqual(used["glaze"], {True})
        self.assertEqual(used["clay"], {False})

    def test_ply(self):
        self.done("--write", "mesh", "--adaptivity", "0", mesh=self.drum(), pieces=4)
        h = self.pieces()["grid"]["voxel_size"]
        for piece in self.pieces()["fragments"]:
            comments, v, f = read_ply(self.at(piece["files"]["mesh"]))
            self.assertEqual(comments, [["material", "0", "side_of_it", "0"], ["material", "1", "cap"],
                                        ["material", "2", "inside"], ["TextureFile", "paint.png"]])
            place, color = columns(v, "x", "y", "z"), columns(v, "red", "green", "blue")
            corners, uv = f["vertex_indices"], f["texcoord"].reshape(-1, 3, 2)
            inside = f["neighbor"] > 0
            self.assertTrue((f["material"][inside] == 2).all() and (f["material"][~inside] < 2).all())
            self.assertTrue((uv[inside] == 0).all())
            # Vertices: original where a face round them is; edges of the drum are rounded over a voxel.
            original = np.zeros(len(v), bool)
            original[corners[~inside]] = True
            self.assertTrue((color[~original] == INSIDE).all())
            off = abs(color[original] - 255 * color_at(place[original])).max(axis=1)
            self.assertLess(np.median(off), 1)
            self.assertLess(off.max(), 255 * 0.2 * h + 1)
            self.assertTrue((v["neighbor"][np.setdiff1d(corners[~inside], corners[inside])] == 0).all())
            self.assertTrue((v["neighbor"][corners[inside]] > 0).all())
            # Texture coordinates are the place's, and no face spans the seam at angle 0.
            side = f["material"] == 0
            self.assertLess(np.ptp(uv[side][:, :, 0], axis=1).max(), 2 * h / (2 * np.pi))
            turn = np.arctan2(place[:, 2], place[:, 0])[corners[side]] / (2 * np.pi)
            apart = uv[side][:, :, 0] - turn
            # A corner beyond the seam has the seam's coordinate, which is at most a face's width away.
            self.assertLess(abs(apart - np.round(apart)).max(), 2 * h / (2 * np.pi))
            self.assertLess(abs(uv[side][:, :, 1] - (place[:, 1][corners[side]] + 1) / 2).max(), h / 2)
            # A face is of the cap or the side, whichever is nearer by more than a voxel.
            a, b, c = (place[corners[:, k]] for k in range(3))
            middle, normal = (a + b + c) / 3, np.cross(b - a, c - a)
            to_cap, to_side = 1 - abs(middle[:, 1]), 1 - np.hypot(middle[:, 0], middle[:, 2])
            self.assertTrue((f["material"][~inside & (to_cap + h < to_side)] == 1).all())
            self.assertTrue((f["material"][~inside & (to_side + h < to_cap)] == 0).all())
            normals = columns(v, "nx", "ny", "nz")
            self.assertLess(abs(np.linalg.norm(normals, axis=1) - 1).max(), 1e-6)
            summed = np.zeros_like(normals)
            for k in range(3):
                np.add.at(summed, corners[:, k], normal)
            self.assertGreater(np.mean((summed * normals).sum(axis=1) > 0), 0.999)

    def test_points_do_not_depend_on_attributes(self):
        """Faces are cut along seams, of which points and the figures of fragments show nothing."""
        mesh = self.drum()
        trees, measures = [], []
        for write in ("mesh", "labels"):
            self.done("--write", write, "--points", "300", "--adaptivity", "0", mesh=mesh, pieces=4)
            trees.append(tree(self.at("points")))
            measures.append([(p["volume"], p["area"], p["fracture_area"]) for p in self.pieces()["fragments"]])
        self.assertEqual(trees[0], trees[1])
        np.testing.assert_allclose(measures[0], measures[1], rtol=1e-9)

    def test_seams_are_straight(self):
        """Edges between faces of different materials lie where the drum's caps begin, and seams at angle 0."""
        self.done("--write", "mesh", "--adaptivity", "0", mesh=self.drum(), pieces=4)
        h = self.pieces()["grid"]["voxel_size"]
        borders = {"material": [], "texture": []}
        for piece in self.pieces()["fragments"]:
            _, v, f = read_ply(self.at(piece["files"]["mesh"]))
            place, corners = columns(v, "x", "y", "z"), f["vertex_indices"]
            uv, material = f["texcoord"].reshape(-1, 3, 2), f["material"]
            at = {}
            for i in np.flatnonzero(f["neighbor"] == 0):
                for k in range(3):
                    edge = (corners[i, k], corners[i, (k + 1) % 3])
                    at[edge] = i, uv[i, k], uv[i, (k + 1) % 3]
            for (a, b), (i, u, w) in at.items():
                if a > b or (b, a) not in at:
                    continue
                j, w2, u2 = at[b, a]
                if material[i] != material[j]:
                    borders["material"] += [place[a], place[b]]
                elif max(abs(u - u2).max(), abs(w - w2).max()) > 0.5:
                    borders["texture"] += [place[a], place[b]]
        caps, seam = np.array(borders["material"]), np.array(borders["texture"])
        self.assertGreater(min(len(caps), len(seam)), 50)
        # The rim has facets of 48 sides, 0.002 deep; beside cracks it is rounded by half a voxel at most, and a face may be
        # turned so far that it takes the other side's attributes.
        off = np.hypot(1 - abs(caps[:, 1]), 1 - np.hypot(caps[:, 0], caps[:, 2])) / h
        self.assertLess(np.percentile(off, 90), 0.1)
        self.assertLess(np.percentile(off, 99), 0.5)
        self.assertGreater(seam[:, 0].min(), 0)
        self.assertLess(np.percentile(abs(seam[:, 2]), 95) / h, 0.02)

    def test_all_formats_agree(self):
        self.done("--write", "mesh", "--mesh-format", "glb,ply,obj", "--triangles", "300", mesh=self.drum())
        manifest = self.pieces()
        self.assertIn("meshes/drum.mtl", manifest["files"])
        self.assertIn("meshes/paint.png", manifest["files"])
        for name in ("drum.mtl", "paint.png"):
            self.assertTrue(os.path.isfile(self.at("meshes/" + name)))
        with open(self.at("meshes/paint.png"), "rb") as file:
            self.assertEqual(file.read(), PICTURE)
        with open(self.at("meshes/drum.mtl")) as file:
            self.assertIn("newmtl side_of_it\nKd 1 1 1\nillum 1\nmap_Kd paint.png\n", file.read())
        for piece in manifest["fragments"]:
            self.assertEqual(piece["files"]["mesh"],
                             [f"meshes/drum_{piece['id']:03}.{kind}" for kind in ("glb", "ply", "obj")])
            for glb, ply, obj in (piece["files"]["mesh"], piece["decimated"][0]["file"]):
                self.compare(glb, ply, obj)
        self.assertEqual(self.run_sherd("evaluate", self.out, "--samples", "100").returncode, 0)

    def compare(self, glb, ply, obj):
        _, v, f = read_ply(self.at(ply))
        place = np.column_stack([v["x"], v["y"], v["z"]])
        whole = surface(place[f["vertex_indices"]])
        file = Glb(self, self.at(glb))
        name = os.path.basename(glb)[:-4]
        self.assertEqual([n["name"] for n in file.json["nodes"]], [name])
        reported = []
        for material, indices, attributes in file.primitives():
            reported.append(material["name"])
            at = attributes["POSITION"]
            corners = f["material"] == ["side_of_it", "cap", "inside"].index(material["name"])
            self.assertEqual(surface(at[indices]), surface(place[f["vertex_indices"][corners]]))
            neighbor = attributes["_NEIGHBOR"][:, 0]
            self.assertEqual((neighbor == 0).all(), material["name"] != "inside")
            self.assertLessEqual(set(neighbor), set(f["neighbor"]))
            colors = 255 * srgb(attributes["COLOR_0"][:, :3] / 65535)
            if material["name"] == "inside":
                self.assertLess(abs(colors - INSIDE).max(), 0.1)
            else:
                self.assertLess(abs(colors - 255 * color_at(at)).max(), 255 * 0.2 * 0.2)
            self.assertEqual("baseColorTexture" in material["pbrMetallicRoughness"], material["name"] == "side_of_it")
            # Its v runs downwards; by the faces of the .ply, in their order.
            uv = attributes["TEXCOORD_0"][indices] * [1, -1] + [0, 1]
            self.assertLess(abs(uv - f["texcoord"][corners].reshape(-1, 3, 2)).max(), 1e-6)
        self.assertIn("inside", reported)
        if "side_of_it" in reported:
            self.assertEqual([file.view(i["bufferView"]) for i in file.json["images"]], [PICTURE])
        with open(self.at(obj)) as text:
            lines = [line.split() for line in text]
        self.assertEqual(lines[:2], [["mtllib", "drum.mtl"], ["o", name]])
        vertices = np.array([line[1:] for line in lines if line[0] == "v"], np.float32)
        self.assertTrue((vertices[:, :3] == place).all())
        self.assertLess(abs(255 * vertices[:, 3:] - columns(v, "red", "green", "blue")).max(), 0.01)
        faces = [[c.split("/") for c in line[1:]] for line in lines if line[0] == "f"]
        self.assertEqual(surface(vertices[[[int(c[0]) - 1 for c in face] for face in faces], :3]), whole)
        self.assertLessEqual({line[1] for line in lines if line[0] == "usemtl"}, {"side_of_it", "cap", "inside"})
        counts = [sum(line[0] == kind for line in lines) for kind in ("vt", "vn")]
        for k, count in ((1, counts[0]), (2, counts[1])):
            used = [int(c[k]) for face in faces for c in face if c[k]]
            self.assertTrue(1 <= min(used) and max(used) <= count)
        for path in (glb, obj):
            reported = json.loads(self.run_sherd("inspect", self.at(path), "--json").stdout)
            self.assertEqual((reported["closed"], reported["boundary_edges"], reported["triangles"]), (True, 0, len(f)))

    def test_stl_and_binm_have_the_same_levels(self):
        """The triangles of the .ply files, of the whole and the decimated meshes, as these formats hold them."""
        self.done("--write", "mesh", "--mesh-format", "ply,stl,binm", "--triangles", "300", mesh=self.drum())
        for piece in self.pieces()["fragments"]:
            for ply, stl, binm in (piece["files"]["mesh"], piece["decimated"][0]["file"]):
                _, v, f = read_ply(self.at(ply))
                expected = surface(columns(v, "x", "y", "z").astype(np.float32)[f["vertex_indices"]])
                with open(self.at(stl), "rb") as file:
                    data = file.read()
                count, = struct.unpack_from("<I", data, 80)
                facets = np.frombuffer(data, np.dtype([("numbers", "<f4", (4, 3)), ("attribute", "<u2")]), count, 84)
                self.assertEqual((len(data), surface(facets["numbers"][:, 1:])), (84 + 50 * count, expected))
                with open(self.at(binm), "rb") as file:
                    data = file.read()
                vertices, = struct.unpack_from("<I", data)
                faces, = struct.unpack_from("<I", data, 4 + 64 * vertices)
                at = np.frombuffer(data, "<f4", 16 * vertices, 4).reshape(-1, 16)[:, :3]
                corners = np.frombuffer(data, "<u4", 4 * faces, 8 + 64 * vertices).reshape(-1, 4)[:, :3]
                self.assertEqual((len(data), surface(at[corners])), (8 + 64 * vertices + 16 * faces, expected))

    def test_a_scene_has_colors_and_coordinates_at_each_level(self):
        """Those of the pieces' own .glb files, which test_all_formats_agree compares with the input."""
        self.done("--write", "mesh,scene", "--mesh-format", "glb", "--triangles", "300", mesh=self.drum())
        scene = Glb(self, self.at("scene.glb"))
        for i, piece in enumerate(self.pieces()["fragments"]):
            first = scene.physics(i)["collider"]["geometry"]["node"]
            levels = [first, *scene.json["nodes"][first]["extensions"]["MSFT_lod"]["ids"]]
            names = [piece["files"]["mesh"], piece["decimated"][0]["file"]]
            self.assertEqual(len(levels), len(names))
            for level, name in zip(levels, names):
                mine, own = (list(file.primitives(mesh)) for file, mesh in ((scene, scene.json["nodes"][level]["mesh"]), (Glb(self, self.at(name)), 0)))
                self.assertEqual([m["name"] for m, _, _ in mine], [m["name"] for m, _, _ in own])
                for (_, triangles, attributes), (_, others, of) in zip(mine, own):
                    np.testing.assert_array_equal(triangles, others)
                    for key in ("COLOR_0", "TEXCOORD_0"):
                        np.testing.assert_array_equal(attributes[key], of[key])
                    at = attributes["POSITION"] + np.array(scene.json["nodes"][i]["translation"])
                    np.testing.assert_allclose(at, of["POSITION"], atol=1e-6)

    def test_plain_meshes(self):
        self.done("--write", "mesh", "--mesh-format", "ply,obj,glb")
        for piece in self.pieces()["fragments"]:
            glb, ply, obj = (self.at(piece["files"]["mesh"][k]) for k in (2, 0, 1))
            comments, v, f = read_ply(ply)
            self.assertEqual(comments, [])
            self.assertEqual(v.dtype.names, ("x", "y", "z", "nx", "ny", "nz", "neighbor"))
            self.assertEqual(f.dtype.names, ("n_vertex_indices", "vertex_indices", "neighbor"))
            names = set()
            for material, indices, attributes in Glb(self, glb).primitives():
                names.add(material["name"])
                self.assertEqual(set(attributes), {"POSITION", "NORMAL", "_NEIGHBOR"})
            self.assertEqual(names, {"outside", "inside"})
            with open(obj) as text:
                self.assertEqual({line.split()[1] for line in text if line.startswith("usemtl")}, names)
        self.assertIn("meshes/ball.mtl", self.pieces()["files"])

    def test_each_side_of_a_card_keeps_its_material_and_texture(self):
        # A card of 2 x 1 from both sides, u from the left on its front and from the right behind, beside a box.
        box = np.array([(x, y, z) for x in (3, 4) for y in (0, 1) for z in (0, 1)])
        lines = ["mtllib card.mtl", *(f"v {x} {y} {z}" for x, y, z in ((0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), *box))]
        lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "usemtl front", "f 1/1 2/2 3/3 4/4", "usemtl behind", "f 4/3 3/4 2/1 1/2", "usemtl box"]
        faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        lines += ["f " + " ".join(f"{5 + c}/{k + 1}" for k, c in enumerate(face)) for face in faces]
        self.path("card.obj", "\n".join(lines).encode())
        self.path("card.mtl", b"newmtl front\nKd 1 0 0\nnewmtl behind\nKd 0 0 1\nnewmtl box\nKd 0 1 0\n")
        result = self.run_sherd("fracture", self.path("card.obj"), "-o", self.out, "--pieces", "4", "--resolution", "64", "--write", "mesh",
                                "--mesh-format", "obj", "--surface", "exact")
        self.assertEqual(result.returncode, 0, result.stderr)
        seen = {"front": 0.0, "behind": 0.0}
        for name in os.listdir(self.at("meshes")):
            if name.endswith(".obj"):
                self.add_card(self.at("meshes/" + name), seen)
        for side, area in seen.items():
            self.assertAlmostEqual(area, 2.0, places=5, msg=side)

    def add_card(self, path, seen):
        """Adds the areas of a fragment's faces that lie on the sides of the card, whose texture coordinates it checks."""
        v, vt, material = [], [], None
        with open(path) as file:
            lines = file.readlines()
        for line in lines:
            kind, *words = line.split() or ["#"]
            if kind == "v":
                v.append([float(x) for x in words[:3]])
            elif kind == "vt":
                vt.append([float(x) for x in words])
            elif kind == "usemtl":
                material = words[0]
            elif kind == "f" and material in seen:
                corners = [[int(n) - 1 for n in word.split("/")[:2]] for word in words]
                at = np.array([v[c[0]] for c in corners])
                for k in range(1, len(at) - 1):
                    normal = np.cross(at[k] - at[0], at[k + 1] - at[0]) / 2
                    if abs(normal[2]) < 1e-9:
                        continue  # between the sides
                    self.assertEqual(normal[2] > 0, material == "front")
                    seen[material] += abs(normal[2])
                    u = at[:, 0] / 2 if material == "front" else 1 - at[:, 0] / 2
                    np.testing.assert_allclose([vt[c[1]] for c in corners], np.column_stack([u, at[:, 1]]), atol=1e-5)

    def test_what_is_missing_is_told(self):
        result = self.done("--write", "mesh", mesh=self.drum(library=None))
        self.assertEqual(result.stderr, "sherd: warning: drum.obj: its material library 'drum.mtl' is not there, "
                                        "so it is left out\n")
        secret = self.path("secret.png", PICTURE)
        os.mkdir(os.path.join(self.tmp, "in"))
        with open(os.path.join(self.tmp, "in", "drum.obj"), "wb") as file:
            file.write(drum())
        for name in ("../secret.png", secret, "gone.png"):
            self.path("in/drum.mtl", b"newmtl side of it\nmap_Kd " + name.encode() + b"\n")
            result = self.done("--mesh-format", "obj,glb", mesh=os.path.join(self.tmp, "in", "drum.obj"))
            self.assertIn("sherd: warning: drum.obj: its texture '" + name[:40], result.stderr)
            self.assertFalse([n for n in tree(self.out) if n.endswith(".png") and n.startswith("meshes")])

    def test_the_same_bytes_by_any_number_of_threads(self):
        mesh, trees = self.drum(), []
        for threads in ("1", "3"):
            out = os.path.join(self.tmp, "out" + threads)
            self.done("--write", "mesh", "--mesh-format", "ply,obj,glb", "--threads", threads, mesh=mesh, out=out)
            trees.append(tree(out))
        self.assertEqual(trees[0], trees[1])

    def test_a_piece_can_be_broken_again_with_its_look(self):
        self.done("--write", "mesh", "--mesh-format", "glb", mesh=self.drum(), pieces=2)
        again = os.path.join(self.tmp, "again")
        self.done("--write", "mesh", mesh=self.at("meshes/drum_001.glb"), out=again, pieces=2)
        _, v, f = read_ply(os.path.join(again, "meshes/drum_001_001.ply"))
        self.assertEqual(len(v.dtype.names), 10)
        self.assertTrue((f["material"][f["neighbor"] > 0] == f["material"].max()).all())

    def test_usage(self):
        for value in ("fbx", "ply,ply", "", "ply,"):
            self.refused(2, self.fracture("--mesh-format", value), "--mesh-format", "ply, obj, glb, stl, stl-ascii, binm")
        self.nothing_written()


if __name__ == "__main__":
    skipping.main()
