#!/usr/bin/env python3
"""Breaks a fracture again five times over, in files of each format: fragments that are not touched keep their bytes, the texture is where it was,
and one process that breaks five times gives what five processes give.  trimesh reads the same files and finds the same colors.

usage: again_formats.py    (with SHERD_BIN, SHERD_DATA, and the Python that pysherd, trimesh and Pillow are installed for)
"""
import os
import pathlib
import sys
import unittest
import warnings

import numpy as np
import trimesh

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
import again_test  # noqa: E402
import pysherd  # noqa: E402
from exact_test import texcoord  # noqa: E402
from textured_pieces import mesh_files  # noqa: E402

warnings.simplefilter("ignore")  # of small fragments
BREAKS = 5
FORMATS = ("ply", "obj", "glb", "stl", "stl-ascii", "binm", "ply,glb", "obj,stl", "glb,obj,ply,stl,binm")


class Long(again_test.Formats):
    def check_in_trimesh(self, folder):
        """Points that trimesh samples on the fragments' files have the colors of the input there."""
        generator = np.random.default_rng(3)
        count = 0
        for fragment in self.manifest(folder)["fragments"]:
            for name in (n for n in mesh_files(fragment) if n.endswith((".obj", ".glb"))):
                scene = trimesh.load(os.path.join(folder, name), process=False, force="scene")
                for mesh in scene.dump():
                    material = mesh.visual.material
                    if material.name not in self.images:
                        continue
                    image = getattr(material, "image", None) or material.baseColorTexture
                    np.testing.assert_array_equal(np.array(image.convert("RGB")), self.images[material.name])
                    points, face = trimesh.sample.sample_surface(mesh, 50, seed=int(generator.integers(1 << 30)))
                    weights = trimesh.triangles.points_to_barycentric(mesh.triangles[face], points)
                    uv = np.einsum("nk,nkd->nd", weights, mesh.visual.uv[mesh.faces[face]])
                    expected = self.texels(material.name, np.array([texcoord(p) for p in points]))
                    np.testing.assert_allclose(self.texels(material.name, uv), expected, atol=0.05, err_msg=name)
                    count += len(points)
        return count

    def test_each_format(self):
        for surface in ("exact", "smooth"):
            for formats in FORMATS:
                with self.subTest(formats, surface=surface):
                    if surface == "smooth":  # whose other fragments are extracted again
                        folder = self.first(formats, "--surface", "smooth")
                        for at in range(BREAKS):
                            out = self.path(f"smooth-{formats}-{at}")
                            result = self.run_sherd("fracture", folder, "--only", "3", "--pieces", "2", "-o", out)
                            self.assertEqual((result.returncode, result.stderr), (0, ""))
                            folder = out
                        result = self.run_sherd("evaluate", folder, "--json")
                        self.assertEqual(result.returncode, 0, result.stderr)
                        continue
                    folder = self.broken_in_a_row(self.first(formats), BREAKS)
                    count = self.check_in_trimesh(folder)
                    self.assertEqual(count > 0, "obj" in formats or "glb" in formats)

    def test_one_process_gives_what_five_give(self):
        options = {"write": ("labels", "vdb", "mesh", "usd", "houdini"), "precision": "double"}
        for formats in ("ply", "ply,glb", "obj,ply"):
            with self.subTest(formats):
                first = self.first(formats)
                by_five = self.broken_in_a_row(first, BREAKS)
                fracture = pysherd.load(first)
                for at in range(BREAKS):
                    fracture = fracture.broken(len(fracture) if at > 0 else 3, pieces=2)
                by_one = self.path("one-" + formats)
                fracture.save(by_one, mesh_format=formats.split(","), **options)
                other = pysherd.load(by_five)
                np.testing.assert_array_equal(fracture.labels, other.labels)
                self.assertEqual([f.id for f in fracture], [f.id for f in other])
                for mine, theirs in zip(fracture, other):
                    np.testing.assert_array_equal(mine.vertices[mine.faces], theirs.vertices[theirs.faces])
                    np.testing.assert_array_equal(mine.neighbor, theirs.neighbor)
                self.check_textures(by_one)


if __name__ == "__main__":
    tests = sys.argv[1:] or ["Long.test_each_format", "Long.test_one_process_gives_what_five_give"]
    unittest.main(argv=[sys.argv[0], *tests])
