#!/usr/bin/python3
"""Files for hosts: .vdb files by layout and packing, scene.glb, constraint graphs and proxies, as other readers have them.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy and
python3-openvdb.
"""
import json
import os
import struct
import unittest

import numpy as np
import pyopenvdb as vdb

import skipping
import voxel_formats
from cli_test import CommandLine, all_contacts
from geo_file import Geometry
from glb_file import PHYSICS, Glb, volume
from ply_file import read_triangles

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
PIECES = 6


class Hosts(CommandLine):
    def broken(self, *arguments, out=None, pieces=PIECES):
        out = out or self.out
        done = self.run_sherd("fracture", AMPHORA, "-o", out, "--resolution", "48", "--pieces", str(pieces), *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(out, "manifest.json")) as file:
            return json.load(file)

    def grids_of(self, name):
        reported = json.loads(self.run_sherd("inspect", os.path.join(self.out, name), "--json").stdout)
        return {grid["name"] for grid in reported["grids"]}

    def test_one_file_holds_all_fragments(self):
        manifest = self.broken("--write", "vdb", "--vdb", "both", "--density", "2.5")
        names = {f"surface_{i}" for i in range(1, PIECES + 1)}
        self.assertEqual(self.grids_of("fragments.vdb"), names | {"fragment_id"})
        self.assertEqual(manifest["vdb"], "fragments.vdb")
        for fragment in manifest["fragments"]:
            grid = vdb.read(os.path.join(self.out, "fragments.vdb"), f"surface_{fragment['id']}")
            alone = vdb.read(os.path.join(self.out, fragment["files"]["vdb"]), "surface")
            self.assertEqual((grid.gridClass, grid.background, grid.transform), (alone.gridClass, alone.background, alone.transform))
            self.assertEqual([(item.min, item.value) for item in grid.citerOnValues()],
                             [(item.min, item.value) for item in alone.citerOnValues()])
            metadata = grid.metadata
            self.assertEqual(metadata["piece"], f"piece{fragment['id']}")
            self.assertEqual(metadata["mass"], 2.5 * fragment["volume"])
            self.assertEqual((metadata["area_inside"], metadata["area_outside"]),
                             (fragment["fracture_area"], fragment["original_area"]))
            # The principal moments are the eigenvalues of the manifest's inertia, and the quaternion turns to its axes.
            xx, yy, zz, xy, xz, yz = fragment["inertia"]
            inertia = 2.5 * np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            x, y, z, w = metadata["inertia_orient"]
            turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                             [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                             [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
            np.testing.assert_allclose(turn @ np.diag(metadata["inertia"]) @ turn.T, inertia, atol=1e-9 * np.trace(inertia))

    def test_a_single_file_replaces_the_others(self):
        manifest = self.broken("--write", "vdb", "--vdb", "single")
        self.assertEqual(manifest["files"], ["fragments.vdb"])

    def test_packing_changes_bytes_and_not_values(self):
        sizes, values = {}, {}
        for name, options in {"blosc": [], "zip": ["--compress", "zip"], "none": ["--compress", "none"],
                              "half": ["--half"]}.items():
            out = self.path(name)
            manifest = self.broken("--write", "vdb", *options, out=out)
            files = [os.path.join(out, f["files"]["vdb"]) for f in manifest["fragments"]]
            sizes[name] = sum(map(os.path.getsize, files))
            grid = vdb.read(files[0], "surface")
            values[name] = [item.value for item in grid.citerOnValues()]
            self.assertEqual(grid.metadata["is_saved_as_half_float"], name == "half")
            self.assertEqual(grid.gridClass, "level set")
        self.assertEqual(values["zip"], values["blosc"])
        self.assertEqual(values["none"], values["blosc"])
        off = np.abs(np.subtract(values["half"], values["blosc"])).max() / manifest["grid"]["voxel_size"]
        self.assertTrue(0 < off < 0.002, off)
        self.assertLess(sizes["half"], 0.8 * sizes["none"])
        self.assertEqual(len({sizes["blosc"], sizes["zip"], sizes["none"]}), 3)

    def test_fog_is_full_inside_and_empty_outside(self):
        manifest = self.broken("--write", "vdb,fog", "--vdb", "both")
        fragment = manifest["fragments"][0]
        path = os.path.join(self.out, fragment["files"]["vdb"])
        surface, fog = vdb.read(path, "surface"), vdb.read(path, "density")
        self.assertEqual((fog.gridClass, fog.background), ("fog volume", 0.0))
        self.assertEqual(fog.transform, surface.transform)
        band = min(surface.background, -min(item.value for item in surface.citerAllValues()))
        inside = surface.getConstAccessor()
        for item in list(fog.citerOnValues())[::37]:
            value = inside.getValue(item.min)
            self.assertAlmostEqual(item.value, min(1.0, -value / band), delta=1e-5)
            self.assertLess(value, 0)
        self.assertLessEqual({f"density_{i}" for i in range(1, PIECES + 1)}, self.grids_of("fragments.vdb"))

    def test_the_solid_is_written_in_every_format(self):
        self.done("--write", "vdb,mesh,solid", "--mesh-format", "ply,obj,glb")
        with open(os.path.join(self.out, "manifest.json")) as file:
            manifest = json.load(file)
        self.assertEqual(manifest["solid"], {"vdb": "fragments/ball.vdb",
                                             "mesh": [f"meshes/ball.{kind}" for kind in ("ply", "obj", "glb")]})
        reported = json.loads(self.run_sherd("inspect", os.path.join(self.out, "meshes", "ball.ply"), "--json").stdout)
        self.assertTrue(reported["closed"])
        ball = json.loads(self.run_sherd("inspect", self.ball, "--json").stdout)
        self.assertAlmostEqual(reported["volume"] / ball["volume"], 1, delta=0.005)
        grid = vdb.read(os.path.join(self.out, "fragments", "ball.vdb"), "surface")
        self.assertEqual(grid.gridClass, "level set")

    def test_labels_are_the_same_in_every_format(self):
        formats = ("rle", "npy", "npz", "vox", "qstack", "bing")
        manifest = self.broken("--write", "labels", "--voxel-format", ",".join(formats))
        self.assertEqual(manifest["files"], ["labels." + name for name in formats])
        dense = np.load(os.path.join(self.out, "labels.npy"))
        raw = np.fromfile(os.path.join(self.out, "labels.rle"), "u1")
        runs = raw[12:].view([("label", "<u2"), ("length", "<u4")])
        labels = np.repeat(runs["label"], runs["length"]).reshape(raw[:12].view("<u4"))
        np.testing.assert_array_equal(dense, labels)
        self.assertEqual((dense.dtype, list(dense.shape)), (np.dtype("<u2"), manifest["grid"]["dims"]))
        for fragment in manifest["fragments"]:
            self.assertEqual((dense == fragment["id"] + 1).sum(), fragment["voxels"])
        with np.load(os.path.join(self.out, "labels.npz")) as placed:
            np.testing.assert_array_equal(placed["labels"], labels)
            self.assertEqual({key: placed[key].tolist() for key in ("origin", "voxel_size", "index_min")},
                             {key: manifest["grid"][key] for key in ("origin", "voxel_size", "index_min")})
        for name, want in (("vox", voxel_formats.write_vox(labels)), ("qstack", voxel_formats.write_qstack(labels)),
                           ("bing", voxel_formats.write_bing(labels))):
            with open(os.path.join(self.out, "labels." + name), "rb") as file:
                self.assertEqual(file.read(), want, name)

    def test_fragments_break_again_without_runs(self):
        self.broken("--write", "labels,vdb", "--voxel-format", "npz")
        again = os.path.join(self.tmp, "again")
        done = self.run_sherd("fracture", os.path.join(self.out, "manifest.json"), "-o", again, "--only", "1", "--pieces", "2",
                              "--write", "labels", "--voxel-format", "vox,npz")
        self.assertEqual(done.returncode, 0, done.stderr)
        with np.load(os.path.join(again, "labels.npz")) as labels:
            self.assertEqual(len(np.unique(labels["labels"])), PIECES + 2)

    def test_the_papers_mesh_and_stl_as_text_have_the_same_triangles(self):
        manifest = self.broken("--write", "mesh", "--mesh-format", "ply,stl-ascii,binm")
        for fragment in manifest["fragments"]:
            ply, stl, binm = (os.path.join(self.out, file) for file in fragment["files"]["mesh"])
            vertices, triangles, _ = read_triangles(ply)
            with open(stl) as file:
                corners = [line.split()[1:] for line in file if line.startswith("   vertex")]
            np.testing.assert_array_equal(np.array(corners, np.float32).reshape(-1, 3, 3), vertices[triangles].astype(np.float32))
            data = np.fromfile(binm, "<u4")
            rows = data[1:1 + 16 * data[0]].view("<f4").reshape(-1, 16)
            np.testing.assert_array_equal(rows[:, :3], vertices.astype(np.float32))
            self.assertEqual(data[1 + 16 * data[0]], len(triangles))
            np.testing.assert_array_equal(data[2 + 16 * data[0]:].reshape(-1, 4)[:, :3], triangles)
            reported = json.loads(self.run_sherd("inspect", binm, "--json").stdout)
            self.assertTrue(reported["closed"])
        both = self.run_sherd("fracture", AMPHORA, "-o", self.out, "--mesh-format", "stl,stl-ascii")
        self.assertEqual((both.returncode, "same file names" in both.stderr), (2, True))

    def test_stl_has_the_same_triangles(self):
        manifest = self.broken("--write", "mesh", "--mesh-format", "ply,stl")
        for fragment in manifest["fragments"]:
            ply, stl = (os.path.join(self.out, file) for file in fragment["files"]["mesh"])
            vertices, triangles, _ = read_triangles(ply)
            with open(stl, "rb") as file:
                data = file.read()
            self.assertTrue(data.startswith(b"Sherd amphora_"))
            faces = np.frombuffer(data, [("normal", "<f4", 3), ("at", "<f4", (3, 3)), ("zero", "<u2")], offset=84)
            self.assertEqual(struct.unpack_from("<I", data, 80)[0], len(faces))
            np.testing.assert_array_equal(faces["at"], vertices[triangles].astype(np.float32))
            round_about = np.cross(faces["at"][:, 1] - faces["at"][:, 0], faces["at"][:, 2] - faces["at"][:, 0])
            self.assertGreater(np.einsum("ij,ij->i", faces["normal"], round_about).min(), 0)
            reported = json.loads(self.run_sherd("inspect", stl, "--json").stdout)
            self.assertTrue(reported["closed"])

    def test_scene_has_a_body_for_each_fragment(self):
        manifest = self.broken("--write", "scene,mesh", "--density", "3")
        file = Glb(self, os.path.join(self.out, "scene.glb"))
        self.assertEqual(file.json["extensionsUsed"], ["EXT_mesh_manifold", PHYSICS])
        self.assertEqual(file.json["scenes"][0]["nodes"], list(range(PIECES)))
        self.assertEqual([m["name"] for m in file.json["materials"]], ["outside", "inside"])
        for i, fragment in enumerate(manifest["fragments"]):
            node = file.json["nodes"][i]
            self.assertEqual(node["name"], f"amphora_{fragment['id']:03d}")
            self.assertEqual(node["translation"], fragment["centroid"])
            motion = file.physics(i)["motion"]
            self.assertEqual(motion["mass"], 3 * fragment["volume"])
            self.assertAlmostEqual(sum(motion["inertiaDiagonal"]), 3 * sum(fragment["inertia"][:3]), delta=1e-9)
            self.assertAlmostEqual(np.linalg.norm(motion["inertiaOrientation"]), 1)
            at, triangles, merged = file.whole(node["mesh"])
            self.assertIsNotNone(merged, "a closed mesh")
            self.assertAlmostEqual(volume(at, triangles) / fragment["volume"], 1, delta=1e-4)
            np.testing.assert_allclose(at.min(0) + node["translation"], fragment["bbox"]["min"], atol=1e-5)
            np.testing.assert_allclose(at.max(0) + node["translation"], fragment["bbox"]["max"], atol=1e-5)

    def test_a_scene_has_levels_of_detail(self):
        manifest = self.broken("--write", "scene", "--triangles", "60,400,1000000")
        file = Glb(self, os.path.join(self.out, "scene.glb"))
        self.assertEqual(file.json["extensionsUsed"], ["EXT_mesh_manifold", PHYSICS, "MSFT_lod"])
        nodes = file.json["nodes"]
        self.assertEqual(file.json["scenes"][0]["nodes"], list(range(PIECES)))
        children = {child for node in nodes for child in node.get("children", [])}
        cracks = [{}, {}, {}]  # of each level, triangles by their sorted positions
        for i, fragment in enumerate(manifest["fragments"]):
            self.assertNotIn("mesh", nodes[i])
            first = file.physics(i)["collider"]["geometry"]["node"]
            self.assertIn(first, nodes[i]["children"])
            levels = [first, *nodes[first]["extensions"]["MSFT_lod"]["ids"]]
            self.assertEqual(len(levels), 3)  # more triangles than there are make no level
            self.assertEqual(nodes[first]["extras"]["MSFT_screencoverage"], [0.5, 0.25, 0.0])
            self.assertFalse(children & set(levels[1:]), "a scene shows a coarse mesh beside the whole one")
            for k, (level, most) in enumerate(zip(levels, (10**6, 400, 60))):
                self.assertEqual(nodes[level]["name"], f"amphora_{fragment['id']:03d}_LOD{k}")
                at, triangles, merged = file.whole(nodes[level]["mesh"])
                self.assertLessEqual(len(triangles), most)
                self.assertIsNotNone(merged, "a closed mesh")
                self.assertAlmostEqual(volume(at, triangles) / fragment["volume"], 1, delta=(1e-4, 0.1, 0.5)[k])
                for corners in (at[triangles] + nodes[i]["translation"]).round(6) + 0.0:
                    key = tuple(sorted(map(tuple, corners.tolist())))
                    cracks[k][key] = cracks[k].get(key, 0) + 1
        for level in cracks:  # faces of cracks are in two pieces
            self.assertEqual(max(level.values()), 2)
            self.assertGreater(list(level.values()).count(2), PIECES)

    def test_graph_has_a_bond_for_each_contact(self):
        manifest = self.broken("--write", "graph")
        with open(os.path.join(self.out, "graph.json")) as file:
            graph = json.load(file)
        root, chunks = graph["chunks"][0], graph["chunks"][1:]
        self.assertEqual((root["parentChunkIndex"], root["flags"]), (2**32 - 1, 0))
        self.assertAlmostEqual(root["volume"], sum(f["volume"] for f in manifest["fragments"]))
        for chunk, fragment in zip(chunks, manifest["fragments"], strict=True):
            self.assertEqual((chunk["userData"], chunk["parentChunkIndex"], chunk["flags"]), (fragment["id"], 0, 1))
            self.assertEqual((chunk["centroid"], chunk["volume"]), (fragment["centroid"], fragment["volume"]))
        contacts = {(f["id"], c["id"]): c for f in manifest["fragments"] for c in all_contacts(f) if c["id"] > f["id"]}
        bonds = {tuple(b["chunkIndices"]): b for b in graph["bonds"]}
        self.assertEqual(set(bonds), set(contacts))
        self.assertEqual(len(bonds), len(graph["bonds"]))
        for pair, bond in bonds.items():
            for key in ("area", "normal", "centroid"):
                self.assertEqual(bond[key], contacts[pair][key])
        constraints = Geometry(os.path.join(self.out, "graph.geo"))  # geo_test.py compares all of it
        self.assertEqual(sorted(map(tuple, constraints.points + 1)), sorted(bonds))
        for pair, strength in zip(constraints.points + 1, constraints.primitive("strength"), strict=True):
            self.assertEqual(strength, np.float32(1e5 * bonds[tuple(pair)]["area"]))

    def test_withheld_fragments_are_in_no_file(self):
        manifest = self.broken("--write", "vdb,graph,scene,proxy", "--vdb", "single", "--missing", "2")
        left = PIECES - 2
        names = self.grids_of("fragments.vdb")
        self.assertEqual(names, {f"surface_{i}" for i in range(1, left + 1)} | {"fragment_id"})
        with open(os.path.join(self.out, "graph.json")) as file:
            graph = json.load(file)
        self.assertEqual(len(graph["chunks"]), left + 1)
        self.assertTrue(all(max(b["chunkIndices"]) <= left for b in graph["bonds"]))
        scene = Glb(self, os.path.join(self.out, "scene.glb"))
        self.assertEqual(sum("mesh" in node for node in scene.json["nodes"]), left)
        for i, node in enumerate(scene.json["nodes"]):
            if "joint" in scene.physics(i):
                self.assertLessEqual(max(map(int, node["name"].split("_")[1:])), left)
        self.assertEqual(len(manifest["fragments"]), left)

    def test_proxies_are_convex_and_hold_the_fragments(self):
        from scipy.spatial import ConvexHull
        manifest = self.broken("--write", "proxy,mesh")
        for fragment in manifest["fragments"]:
            path = os.path.join(self.out, fragment["files"]["proxy"])
            reported = json.loads(self.run_sherd("inspect", path, "--json").stdout)
            self.assertTrue(reported["closed"])
            with open(path) as file:
                lines = [line.split() for line in file]
            self.assertEqual(lines[0], ["o", os.path.basename(path)[:-4]])
            corners = np.array([line[1:] for line in lines if line[0] == "v"], float)
            hull = ConvexHull(corners)
            self.assertEqual(len(hull.vertices), len(corners))
            self.assertAlmostEqual(reported["volume"] / hull.volume, 1, delta=1e-4)
            self.assertGreater(reported["volume"], fragment["volume"])
            np.testing.assert_allclose(corners.min(0), fragment["bbox"]["min"], atol=1e-5)
            np.testing.assert_allclose(corners.max(0), fragment["bbox"]["max"], atol=1e-5)

    def test_a_gap_moves_every_side_of_a_proxy_inwards(self):
        box = self.path("box.obj", b"".join(
            b"v %d %d %d\n" % (i >> 2 & 1, 2 * (i >> 1 & 1), 4 * (i & 1)) for i in range(8)) +
            b"f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")
        sides = {}
        for gap in ("0", "0.2"):
            out = self.path(f"gap{gap}")
            done = self.run_sherd("fracture", box, "-o", out, "--pieces", "1", "--resolution", "32", "--write", "proxy",
                                  "--proxy-gap", gap)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(os.path.join(out, "proxies", "box_001.obj")) as file:
                corners = np.array([line.split()[1:] for line in file if line[0] == "v"], float)
            sides[gap] = np.ptp(corners, axis=0)
        np.testing.assert_allclose(sides["0"] - sides["0.2"], 0.2, atol=1e-5)

    def test_refuses_values_that_make_no_sense(self):
        for arguments in (["--vdb", "all"], ["--compress", "gzip"], ["--density", "0"], ["--density", "nan"],
                          ["--proxy-gap", "-1"]):
            self.refused(2, self.fracture(*arguments), arguments[0])


if __name__ == "__main__":
    skipping.main()
