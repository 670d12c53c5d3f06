#!/usr/bin/python3
"""Scenes in USD as a parser of this test's own has them: pieces, materials, joints, levels, archives, and names that are hostile.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy.
tests/long/usd.py reads the same files with OpenUSD and others.
"""
import os
import pathlib
import struct
import zipfile

import numpy as np

import skipping
from appearance_test import PICTURE, drum
from cli_test import CommandLine, all_contacts, joined, sphere, write_obj
from ply_file import columns, read_ply, read_triangles
from usd_file import read_usda

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
APART = 0.5  # of the distance from the center of mass, how far pieces move in the variant `exploded`


def rotation(w, x, y, z):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


class Usd(CommandLine):
    def broken(self, *options, mesh=AMPHORA, out=None, pieces=6, write="usd,mesh"):
        return self.written(write, *options, mesh=mesh, out=out, pieces=pieces)

    def scene(self, out=None):
        """Metadata, root, and the pieces by their paths, of which every array is checked."""
        with open(os.path.join(out or self.out, "scene.usda"), encoding="utf-8") as file:
            metadata, root = read_usda(file.read())
        self.assertEqual((metadata["defaultPrim"], root.kind), (root.name, "Xform"))
        self.assertEqual([c.name for c in root.children], ["materials", "pieces", "joints"])
        pieces = {path: prim for path, prim in root.walk() if "PhysicsRigidBodyAPI" in prim.metadata.get("apiSchemas", [])}
        for path, prim in pieces.items():
            self.check_mesh(prim.child(prim.name), root)
            for other in pieces:
                self.assertFalse(other.startswith(path + "/"), "a rigid body in another")
        return metadata, root, pieces

    def check_mesh(self, mesh, root):
        self.assertEqual(mesh.kind, "Mesh")
        self.assertLessEqual({"PhysicsCollisionAPI", "PhysicsMeshCollisionAPI", "MaterialBindingAPI"}, set(mesh.metadata["apiSchemas"]))
        self.assertEqual(mesh.values["physics:approximation"], "convexHull")
        faces = len(mesh.values["faceVertexCounts"])
        corners, points = np.array(mesh.values["faceVertexIndices"]), np.array(mesh.values["points"])
        self.assertEqual(set(mesh.values["faceVertexCounts"]), {3})
        self.assertEqual(len(corners), 3 * faces)
        self.assertEqual(set(corners), set(range(len(points))))
        self.assertEqual(mesh.values["extent"], [tuple(points.min(axis=0)), tuple(points.max(axis=0))])
        for name, of in mesh.values.items():
            if not name.startswith("primvars:") or name.endswith(":indices"):
                continue
            rate = mesh.properties[name]["interpolation"]
            if rate == "uniform":
                self.assertEqual(len(of), faces)
            else:
                indices = mesh.values[name + ":indices"]
                self.assertEqual((rate, len(indices), set(indices)), ("faceVarying", 3 * faces, set(range(len(of)))), name)
        length = np.linalg.norm(mesh.values["primvars:normals"], axis=1)
        self.assertLess(abs(length - 1).max(), 2e-4)
        # Subsets are a partition of the faces, and each has a material of its own.
        self.assertEqual(mesh.values["subsetFamily:materialBind:familyType"], "partition")
        materials = {path: prim for path, prim in root.walk() if prim.kind == "Material"}
        indices, bound = [], []
        for subset in mesh.children:
            self.assertEqual((subset.kind, subset.values["elementType"], subset.values["familyName"]), ("GeomSubset", "face", "materialBind"))
            indices += subset.values["indices"]
            bound.append(subset.values["material:binding"])
            self.assertEqual(materials[bound[-1]].name, subset.name)
        self.assertEqual(sorted(indices), list(range(faces)))
        self.assertEqual(len(set(bound)), len(bound))

    def piece_of(self, pieces, fragment):
        return next((path, prim) for path, prim in pieces.items() if path.endswith(f"_{fragment['id']:03}"))

    def check_masses(self, manifest, pieces, density):
        for fragment in manifest["fragments"]:
            _, prim = self.piece_of(pieces, fragment)
            self.assertAlmostEqual(prim.values["physics:mass"] / (density * fragment["volume"]), 1, delta=1e-6)
            self.assertEqual(prim.values["physics:centerOfMass"], (0, 0, 0))
            self.assertEqual(list(prim.values["xformOp:translate"]), fragment["centroid"])
            xx, yy, zz, xy, xz, yz = fragment["inertia"]
            inertia = density * np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            turn = rotation(*prim.values["physics:principalAxes"])
            np.testing.assert_allclose(turn @ np.diag(prim.values["physics:diagonalInertia"]) @ turn.T, inertia, atol=2e-6 * np.trace(inertia))

    def check_joints(self, manifest, root, pieces, strength):
        joints = {tuple(map(int, j.name.split("_")[1:])): j for j in root.child("joints").children}
        contacts = {(f["id"], c["id"]): (f, c) for f in manifest["fragments"] for c in all_contacts(f) if f["id"] < c["id"]}
        kept = {f["id"] for f in manifest["fragments"]}
        contacts = {pair: both for pair, both in contacts.items() if pair[1] in kept}
        self.assertEqual(sorted(joints), sorted(contacts))
        for pair, joint in joints.items():
            self.assertEqual(joint.kind, "PhysicsFixedJoint")
            contact = contacts[pair][1]
            self.assertAlmostEqual(joint.values["physics:breakForce"] / (strength * contact["area"]), 1, delta=1e-6)
            ends = []
            for k in (0, 1):
                body = pieces[joint.values[f"physics:body{k}"]]
                self.assertTrue(body.name.endswith(f"_{pair[k]:03}"))
                ends.append(np.add(body.values["xformOp:translate"], joint.values[f"physics:localPos{k}"]))
                self.assertEqual(joint.values[f"physics:localRot{k}"], (1, 0, 0, 0))
            for end in ends:
                np.testing.assert_allclose(end, contact["centroid"], atol=1e-5)
        return joints

    def check_points(self, manifest, pieces):
        for fragment in manifest["fragments"]:
            _, prim = self.piece_of(pieces, fragment)
            mesh = prim.child(prim.name)
            vertices, triangles, neighbor = read_triangles(os.path.join(self.out, fragment["files"]["mesh"]))
            at = np.array(mesh.values["points"]) + prim.values["xformOp:translate"]
            np.testing.assert_allclose(at, vertices, atol=2 * np.spacing(np.float32(np.abs(vertices).max())))
            self.assertEqual(mesh.values["faceVertexIndices"], triangles.ravel().tolist())
            self.assertEqual(mesh.values["primvars:neighbor"], neighbor.tolist())
            inside = [s for s in mesh.children if s.name == "inside"]
            self.assertEqual([s.values["indices"] for s in inside], [np.flatnonzero(neighbor).tolist()])

    def test_a_scene_has_what_manifest_and_meshes_have(self):
        manifest = self.broken("--growth", "sequential", "--density", "2.5", "--joint-strength", "3", "--up", "z", "--unit", "cm", pieces=9)
        self.assertEqual(manifest["usd"], "scene.usda")
        self.assertIn("scene.usda", manifest["files"])
        metadata, root, pieces = self.scene()
        self.assertEqual((metadata["upAxis"], metadata["metersPerUnit"]), ("Z", 0.01))
        self.assertEqual(len(pieces), 9)
        # Kilograms, and forces in kilograms, seconds and the scene's centimeters.
        self.check_masses(manifest, pieces, 2.5 * 0.01**3)
        self.check_points(manifest, pieces)
        self.assertGreater(len(self.check_joints(manifest, root, pieces, 3 * 0.01)), 7)
        self.assertEqual({c.name for c in root.child("materials").children}, {"outside", "inside"})
        # A piece is in the Xforms of the splits that it comes from.
        for fragment in manifest["fragments"]:
            path, _ = self.piece_of(pieces, fragment)
            levels, split = [], fragment["split"]
            while split:
                levels.insert(0, f"split{split}")
                split = manifest["splits"][split - 1]["parent"]
            self.assertEqual(path.split("/")[3:-1], levels)
        self.assertEqual(len([p for p, _ in root.walk() if "/split" in p and p.split("/")[-1].startswith("split")]), 8)

    def test_levels_of_detail_are_variants(self):
        manifest = self.broken("--triangles", "60,400")
        with open(os.path.join(self.out, "scene.usda"), encoding="utf-8") as file:
            _, root = read_usda(file.read())
        pieces = {path: prim for path, prim in root.walk() if "PhysicsRigidBodyAPI" in prim.metadata.get("apiSchemas", [])}
        self.assertEqual(len(pieces), 6)
        for fragment in manifest["fragments"]:
            _, prim = self.piece_of(pieces, fragment)
            self.assertEqual((prim.metadata["variants"], prim.metadata["variantSets"], prim.children), ({"lod": "LOD0"}, "lod", []))
            self.assertEqual(sorted(prim.variants["lod"]), ["LOD0", "LOD1", "LOD2"])
            names = [fragment["files"]["mesh"], *(d["file"] for d in reversed(fragment["decimated"]))]
            for level, name in enumerate(names):
                mesh = prim.variants["lod"][f"LOD{level}"].child(prim.name)
                self.check_mesh(mesh, root)
                vertices, triangles, _ = read_triangles(os.path.join(self.out, name))
                at = np.array(mesh.values["points"]) + prim.values["xformOp:translate"]
                np.testing.assert_allclose(at, vertices, atol=2 * np.spacing(np.float32(np.abs(vertices).max())))
                self.assertEqual(mesh.values["faceVertexIndices"], triangles.ravel().tolist())

    def test_pieces_are_apart_in_one_variant(self):
        manifest = self.broken("--growth", "sequential")
        _, root, pieces = self.scene()
        self.assertEqual(root.metadata["variants"], {"preview": "whole"})
        self.assertEqual(root.metadata["variantSets"], "preview")
        weights = np.array([f["volume"] for f in manifest["fragments"]])
        centers = np.array([f["centroid"] for f in manifest["fragments"]])
        middle = weights @ centers / weights.sum()
        self.assertEqual(sorted(root.variants["preview"]), ["exploded", "whole"])
        for name, variant in root.variants["preview"].items():
            self.assertEqual(variant.child("pieces").specifier, "over")
            shifts = {path: prim.values["xformOp:translate:apart"] for path, prim in variant.walk() if prim.values}
            self.assertEqual(set(shifts), set(pieces))
            for fragment in manifest["fragments"]:
                path, prim = self.piece_of(pieces, fragment)
                self.assertEqual(prim.values["xformOpOrder"], ["xformOp:translate:apart", "xformOp:translate"])
                away = APART * (np.array(fragment["centroid"]) - middle) if name == "exploded" else 0
                np.testing.assert_allclose(shifts[path], away + np.zeros(3), atol=1e-9)

    def test_surface_attributes_are_primvars_and_materials(self):
        self.path("drum.obj", drum())
        self.path("drum.mtl", b"newmtl side of it\nKd 0.5 1 1\nmap_Kd the@wood.png\nnewmtl cap\nKd 0.25 0.5 1\n")
        self.path("the@wood.png", PICTURE)
        manifest = self.broken("--surface", "smooth", mesh=self.path("drum.obj"), pieces=4)
        _, root, pieces = self.scene()
        materials = {m.name: m for m in root.child("materials").children}
        self.assertEqual(sorted(materials), ["cap", "inside", "side_of_it"])
        texture = materials["side_of_it"].child("texture")
        self.assertEqual(texture.values["inputs:file"], "./meshes/the@wood.png")
        self.assertTrue(os.path.exists(os.path.join(self.out, texture.values["inputs:file"])))
        self.assertEqual(texture.values["inputs:scale"], (0.5, 1, 1, 1))
        prims = dict(root.walk())
        for path, prim in prims.items():
            for name, value in prim.values.items():
                if name.endswith(".connect"):
                    target, output = value.rsplit(".", 1)
                    self.assertIn(output, prims[target].types, path)
        for fragment in manifest["fragments"]:
            _, prim = self.piece_of(pieces, fragment)
            mesh = prim.child(prim.name)
            _, vertex, face = read_ply(os.path.join(self.out, fragment["files"]["mesh"]))
            st = np.array(mesh.values["primvars:st"])[mesh.values["primvars:st:indices"]]
            np.testing.assert_array_equal(st.reshape(-1, 6).astype(np.float32), face["texcoord"])
            # Colors are linear: a byte of sRGB returns, where a vertex has one color.
            color = np.array(mesh.values["primvars:displayColor"])[mesh.values["primvars:displayColor:indices"]]
            back = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1 / 2.4) - 0.055) * 255
            self.assertLess(abs(back - back.round()).max(), 1e-3)
            of_corner = columns(vertex, "red", "green", "blue")[face["vertex_indices"].ravel()]
            outer = np.repeat(face["neighbor"], 3) == 0
            self.assertGreater((abs(back - of_corner).max(axis=1) < 0.01)[outer].mean(), 0.8)

    def test_an_archive_holds_the_same_aligned(self):
        self.path("drum.obj", drum(colors=False))
        self.path("drum.mtl", "newmtl side of it\nmap_Kd größe.png\n".encode())
        self.path("größe.png", PICTURE)
        for out in (self.out, self.path("again")):
            manifest = self.broken("--usd-format", "usda,usdz", mesh=self.path("drum.obj"), out=out, pieces=4, write="usd")
        self.assertEqual(manifest["usd"], ["scene.usda", "scene.usdz"])
        self.assertEqual(sorted(manifest["files"]), ["meshes/größe.png", "scene.usda", "scene.usdz"])
        data = [[pathlib.Path(out, name).read_bytes() for name in manifest["usd"]] for out in (self.out, self.path("again"))]
        self.assertEqual(data[0], data[1])
        with zipfile.ZipFile(os.path.join(self.out, "scene.usdz")) as archive:
            self.assertIsNone(archive.testzip())
            files = archive.infolist()
            self.assertEqual([f.filename for f in files], ["scene.usda", "meshes/größe.png"])
            for file in files:
                name, extra = struct.unpack_from("<2H", data[0][1], file.header_offset + 26)
                self.assertEqual((file.compress_type, (file.header_offset + 30 + name + extra) % 64), (zipfile.ZIP_STORED, 0))
            self.assertEqual(archive.read("scene.usda"), data[0][0])
            self.assertEqual(archive.read("meshes/größe.png"), PICTURE)

    def test_volumes_are_in_the_text_only(self):
        manifest = self.broken("--usd-volumes", "--usd-format", "usda,usdz", write="usd,vdb", pieces=3)
        _, root, pieces = self.scene()
        for fragment in manifest["fragments"]:
            path, prim = self.piece_of(pieces, fragment)
            volume = prim.child("volume")
            self.assertEqual((volume.kind, volume.values["field:surface"]), ("Volume", path + "/volume/surface"))
            np.testing.assert_array_equal(volume.values["xformOp:translate"], np.negative(fragment["centroid"]))
            self.assertEqual(volume.child("surface").values, {"fieldName": "surface", "filePath": "./" + fragment["files"]["vdb"]})
        with zipfile.ZipFile(os.path.join(self.out, "scene.usdz")) as archive:
            self.assertEqual(archive.namelist(), ["scene.usda"])
            self.assertNotIn(b"vdb", archive.read("scene.usda"))

    def test_plain_meshes_have_points_and_triangles_only(self):
        """The points, triangles, masses and joints of the scene with all else, and no material or texture anywhere."""
        self.path("paint.png", PICTURE)
        self.path("drum.mtl", b"newmtl side of it\nmap_Kd paint.png\nnewmtl cap\nKd 0.25 0.5 0.75\n")
        mesh, full = self.path("drum.obj", drum()), self.path("full")
        options = ("--triangles", "300", "--usd-format", "usda,usdz")
        self.broken(*options, mesh=mesh, out=full, pieces=4, write="usd")
        manifest = self.broken(*options, "--plain-meshes", mesh=mesh, pieces=4, write="usd")
        self.assertIs(manifest["options"]["plain_meshes"], True)
        self.assertEqual(sorted(manifest["files"]), ["scene.usda", "scene.usdz"])
        self.assertFalse(os.path.exists(os.path.join(self.out, "meshes")))
        roots = []
        for folder in full, self.out:
            with open(os.path.join(folder, "scene.usda"), encoding="utf-8") as file:
                roots.append(read_usda(file.read())[1])
        self.assertEqual([c.name for c in roots[1].children], ["pieces", "joints"])
        full, plain = ({path: prim for path, prim in root.walk() if not path.startswith(f"/{root.name}/materials")
                        and prim.kind != "GeomSubset"} for root in roots)
        self.assertEqual(list(plain), list(full))
        lost = ("primvars:", "subsetFamily:")
        count = 0
        for path, prim in plain.items():
            self.assertEqual(prim.values, {k: v for k, v in full[path].values.items() if not k.startswith(lost)}, path)
            for name, level in prim.variants.get("lod", {}).items():
                child, other = level.children[0], full[path].variants["lod"][name].children[0]
                self.assertEqual(child.children, [])
                self.assertEqual(child.metadata["apiSchemas"], ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"])
                self.assertEqual(child.values, {k: v for k, v in other.values.items() if not k.startswith(lost)})
                count += 1
        self.assertEqual(count, 8)
        with zipfile.ZipFile(os.path.join(self.out, "scene.usdz")) as archive:
            self.assertEqual(archive.namelist(), ["scene.usda"])
            self.assertEqual(archive.read("scene.usda"), pathlib.Path(self.out, "scene.usda").read_bytes())

    def test_withheld_pieces_have_no_joints(self):
        manifest = self.broken("--growth", "sequential", "--missing", "0.4", pieces=8)
        _, root, pieces = self.scene()
        self.assertEqual(len(pieces), len(manifest["fragments"]))
        self.assertGreater(len(manifest["withheld"]), 1)
        self.check_joints(manifest, root, pieces, 1e5)
        self.check_points(manifest, pieces)

    def test_one_piece_and_two_components(self):
        manifest = self.broken(pieces=1)
        _, root, pieces = self.scene()
        self.assertEqual((len(pieces), root.child("joints").children), (1, []))
        self.check_masses(manifest, pieces, 1000)
        two = self.path("two.obj")
        write_obj(two, joined(sphere(), sphere(center=(5, 0, 0), radius=0.8)))
        manifest = self.broken("--growth", "sequential", mesh=two, pieces=5, out=self.path("two"))
        _, root, pieces = self.scene(self.path("two"))
        self.assertEqual(len(pieces), 5)
        self.check_joints(manifest, root, pieces, 1e5)

    def test_names_are_no_syntax(self):
        text = drum(colors=False).replace(b"usemtl side of it", b'usemtl a"}{</x>').replace(b"usemtl cap", b'usemtl a_}_<_x>')
        for name in ('7 "q" \\ <x>@{', "split", "größe", "'#"):
            with self.subTest(name):
                mesh = self.path(name + ".obj", text)
                self.path("drum.mtl", b'newmtl a"}{</x>\nKd 1 0 0\nnewmtl a_}_<_x>\nKd 0 1 0\n')
                out = self.path("out of it")
                manifest = self.broken("--usd-volumes", "--usd-format", "usda,usdz", mesh=mesh, out=out, write="usd,vdb", pieces=2)
                _, root, pieces = self.scene(out)
                self.assertEqual(len(pieces), 2)
                self.assertEqual(sorted(m.name for m in root.child("materials").children), ["a_____x_", "a_____x__2", "inside"])
                for fragment in manifest["fragments"]:
                    _, prim = self.piece_of(pieces, fragment)
                    path = prim.child("volume").child("surface").values["filePath"]
                    self.assertEqual(path, "./" + fragment["files"]["vdb"])

    def test_a_later_fracture_replaces_it(self):
        self.broken("--usd-format", "usda,usdz")
        self.broken(write="mesh")
        self.assertFalse([name for name in os.listdir(self.out) if name.startswith("scene")])

    def test_refusals(self):
        for options, words in ((("--write", "usd", "--usd-format", "usdc"), ("--usd-format", "usdc")),
                               (("--write", "usd", "--usd-format", "usda,usda"), ("--usd-format",)),
                               (("--write", "usd", "--joint-strength", "0"), ("--joint-strength",)),
                               (("--write", "usd", "--unit", "-1"), ("--unit",))):
            with self.subTest(options):
                self.refused(2, self.fracture(*options), *words)
                self.assertFalse(os.path.exists(self.out))


if __name__ == "__main__":
    skipping.main()
