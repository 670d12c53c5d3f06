#!/usr/bin/python3
"""Breaking fragments of a fracture again: ids, options, history and folders, read by parsers of the tests' own.

Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.  Needs Debian's python3-numpy and python3-jsonschema.
"""
import json
import os
import pathlib
import shutil
import unittest

import numpy as np

import skipping
from appearance_test import png
from cli_test import CommandLine, tree
from exact_test import areas, gear, texcoord, write_textured
from ply_file import columns, read_ply
from textured_pieces import formats_of, mesh_files, surfaces


class Again(CommandLine):
    """The first fracture is the class's: `self.first`, of five fragments."""
    OPTIONS = ("--seed", "41", "--material", "stone", "--write", "labels,vdb,mesh,seeds", "--mesh-format", "obj,ply", "--voxel-format", "npy,rle",
               "--half", "--up", "z", "--precision", "double")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.first = os.path.join(cls.data, "first")
        test = cls()
        test.out = cls.first
        test.done(*cls.OPTIONS, out=cls.first, pieces=5)

    def runTest(self):
        pass

    def again(self, folder, *arguments, out=None):
        result = self.run_sherd("fracture", folder, "-o", out or self.out, *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return self.manifest(out or self.out)


class Ids(Again):
    def test_those_of_others_stay_and_new_ones_follow_the_last(self):
        before = self.manifest(self.first)
        after = self.again(self.first, "--only", "4,2", "--pieces", "3")
        self.assertEqual([f["id"] for f in after["fragments"]], list(range(1, 10)))
        self.assertEqual([f["parent"] for f in after["fragments"]], [1, 2, 3, 4, 5, 2, 2, 4, 4])
        self.assertEqual(after["only"], [2, 4])
        old, new = (np.load(os.path.join(folder, "labels.npy")) for folder in (self.first, self.out))
        parents = np.array([0, 1, *(f["parent"] + 1 for f in after["fragments"])])
        np.testing.assert_array_equal(parents[new], old)  # voxel by voxel
        for fragment in after["fragments"]:
            self.assertEqual(fragment["voxels"], np.count_nonzero(new == fragment["id"] + 1))
        for own in (1, 3, 5):
            for key in ("voxels", "share", "files"):
                self.assertEqual(after["fragments"][own - 1][key], before["fragments"][own - 1][key])

    def test_five_breaks_in_a_row(self):
        folder = self.first
        for at in range(5):
            out = self.path(f"at{at}")
            after = self.again(folder, "--only", "3", "--pieces", "2", "--write", "labels,vdb", out=out)
            self.assertEqual(len(after["fragments"]), 6 + at)
            self.assertEqual([f["parent"] for f in after["fragments"]], [1, 2, 3, 4, 5, *range(6, 6 + at), 3])
            self.assertEqual([entry["seed"] for entry in after["history"]], list(range(41, 42 + at)))
            self.assertEqual([entry["fragments"] for entry in after["history"]], list(range(5, 6 + at)))
            self.assertEqual([entry.get("only") for entry in after["history"]], [None] + at * [[3]])
            folder = out
        self.assertEqual(after["history"][0]["source"], self.manifest(self.first)["source"])
        self.assertEqual(after["history"][0]["options"], self.manifest(self.first)["options"])
        self.assertEqual(after["history"][4]["options"], self.manifest(self.path("at3"))["options"])

    def test_a_history_is_bounded(self):
        shutil.copytree(self.first, self.path("long"))
        manifest = self.manifest(self.first)
        entry = {"fragments": 5, "seed": 1}
        manifest["only"] = [1]
        manifest["history"] = [dict(entry, seed=k) for k in range(300)] + [{"foreign": 1}, 7, dict(entry, fragments=0), dict(entry, seed=-1)]
        manifest["history"].append(dict(entry, options={"long": "x" * 100_000}, only=["a"], source=[], foreign=2))
        pathlib.Path(self.path("long"), "manifest.json").write_text(json.dumps(manifest))
        after = self.again(self.path("long"), "--only", "1", "--pieces", "2", "--write", "labels")
        self.assertEqual(len(after["history"]), 64)
        self.assertEqual(after["history"][-2], entry)
        self.assertEqual([e["seed"] for e in after["history"]][:2] + [after["history"][-1]["seed"]], [0, 239, 41])
        self.assertEqual(after["history_omitted"], 302 - 64)
        self.assertLess(os.path.getsize(os.path.join(self.out, "manifest.json")), 100_000)


class Folders(Again):
    def test_a_folder_is_taken_as_its_manifest_is(self):
        self.again(self.first, "--only", "1", "--pieces", "2")
        self.again(os.path.join(self.first, "manifest.json"), "--only", "1", "--pieces", "2", out=self.path("other"))
        self.again(self.first + "/", "--only", "1", "--pieces", "2", out=self.path("slash"))
        self.assertEqual(tree(self.out), tree(self.path("other")))
        self.assertEqual(tree(self.out), tree(self.path("slash")))

    def test_in_place(self):
        self.again(self.first, "--only", "2", "--pieces", "3", out=self.path("beside"))
        shutil.copytree(self.first, self.out)
        self.again(self.out, "--only", "2", "--pieces", "3")
        self.assertEqual(tree(self.out), tree(self.path("beside")))
        listed = {*self.manifest()["files"], "manifest.json"}
        self.assertEqual({name for name in tree(self.out) if not name.endswith("/")}, listed)

    def test_in_place_a_refused_run_changes_nothing(self):
        shutil.copytree(self.first, self.out)
        before = tree(self.out)
        self.refused(2, self.run_sherd("fracture", self.out, "-o", self.out, "--only", "6"), "fragment 6")
        self.assertEqual(tree(self.out), before)

    def test_what_is_no_fracture_is_refused(self):
        os.mkdir(self.path("empty"))
        self.refused(3, self.run_sherd("fracture", self.path("empty"), "-o", self.out, "--only", "1"), "manifest.json")
        self.refused(3, self.run_sherd("fracture", self.path("absent"), "-o", self.out, "--only", "1"), "absent")
        self.refused(3, self.run_sherd("fracture", self.first, "-o", self.out), "--only")


class Inherited(Again):
    def without(self, options, *keys):
        return {key: value for key, value in options.items() if key not in keys}

    def test_options_are_those_of_before(self):
        before, after = self.manifest(self.first), self.again(self.first, "--only", "2", "--pieces", "3")
        own = ("pieces", "seed", "resolution", "fill", "erode", "missing")
        self.assertEqual(self.without(after["options"], *own), self.without(before["options"], *own))
        self.assertEqual(after["options"]["seed"], 42)
        self.assertEqual(after["options"]["pieces"], 7)
        kinds = lambda manifest: {os.path.splitext(name)[0].rstrip("0123456789") + os.path.splitext(name)[1] for name in manifest["files"]}
        self.assertEqual(kinds(after), kinds(before))
        self.assertEqual(sorted(after["files"][:2]), ["labels.npy", "labels.rle"])

    def test_options_that_are_given_come_first(self):
        after = self.again(self.first, "--only", "2", "--pieces", "3", "--seed", "7", "--mesh-format", "stl", "--roughness", "0", "--up", "y",
                           "--write", "labels,mesh,preview")
        options = after["options"]
        self.assertEqual((options["seed"], options["material"], options["grow"]["roughness"], options["up"]), (7, "stone", 0, "y"))
        self.assertEqual({os.path.splitext(name)[1] for name in after["files"]}, {".stl", ".npy", ".rle", ".png"})

    def test_another_material_brings_its_own_options(self):
        """As if the fracture had been broken with it, but for what a refracture does not do."""
        for material in ("glass", "wood", "none"):
            with self.subTest(material):
                self.done("--material", material, "--write", "labels", out=self.path("plain"))
                expected = self.manifest(self.path("plain"))["options"]
                options = self.again(self.first, "--only", "2", "--pieces", "3", "--material", material, "--write", "labels")["options"]
                self.assertEqual(self.without(options["grow"], "outer_steps"), self.without(expected["grow"], "outer_steps"))
                self.assertEqual(options.get("sizes"), expected.get("sizes"))
                self.assertEqual(options.get("material"), expected.get("material"))

    def test_text_of_stl_stays_text(self):
        self.done("--write", "labels,vdb,mesh", "--mesh-format", "stl-ascii,glb", out=self.path("text"))
        self.again(self.path("text"), "--only", "1", "--pieces", "2")
        with open(os.path.join(self.out, "meshes", "ball_001.stl")) as file:
            self.assertTrue(file.readline().startswith("solid"))

    def test_places_of_the_whole_are_not(self):
        self.done("--write", "labels,vdb", "--impact", "0,0,1,2", "--drop-share", "0.001", "--erode-iterations", "1", out=self.path("hit"))
        options = self.again(self.path("hit"), "--only", "1", "--pieces", "2")["options"]
        self.assertEqual((options["seeds"]["impacts"], options["erode"], options["missing"]), ([], {"iterations": 0}, 0))
        self.assertNotIn("drop_share", options)

    def test_an_option_that_does_nothing_is_judged_with_those_of_before(self):
        self.done("--growth", "nearest", "--write", "labels,vdb", out=self.path("nearest"))
        run = lambda folder: self.run_sherd("fracture", folder, "-o", self.out, "--only", "1", "--pieces", "2", "--metric", "manhattan")
        self.assertNotIn("--metric", run(self.path("nearest")).stderr)
        self.assertIn("--metric", run(self.first).stderr)

    def test_damaged_options_are_refused(self):
        shutil.copytree(self.first, self.path("bad"))
        for key, value in (("seed", -1), ("grow", {"growth": "magic"}), ("up", 7), ("min_share", [])):
            manifest = self.manifest(self.first)
            manifest["options"][key] = value
            pathlib.Path(self.path("bad"), "manifest.json").write_text(json.dumps(manifest))
            with self.subTest(key):
                result = self.run_sherd("fracture", self.path("bad"), "-o", self.out, "--only", "1")
                if key != "min_share":
                    self.refused(3, result, "manifest.json", "damaged")
                self.assertIn(result.returncode, (0, 3))


class Attributes(CommandLine):
    """Of a gear with texture coordinates that are linear in the position, and two materials: caps across z, and sides."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = pathlib.Path(cls.data) / "gear.obj"
        write_textured(cls.mesh, *gear())

    def broken_twice(self, formats, *options):
        first = self.path("first-" + formats)
        self.done("--write", "labels,vdb,mesh,proxy", "--mesh-format", formats, *options, mesh=str(self.mesh), pieces=12, out=first)
        self.out = self.path("again-" + formats)
        result = self.run_sherd("fracture", first, "--only", "3", "--pieces", "4", "-o", self.out)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual({f["surface"] for f in self.manifest()["fragments"]}, {"exact"})
        return first

    def test_files_of_the_others_are_what_they_were(self):
        for formats in ("ply,obj,glb,stl", "obj", "ply", "glb"):
            with self.subTest(formats):
                first = self.broken_twice(formats)
                before, after = tree(first), tree(self.out)
                beside = {c["id"] for c in self.manifest(first)["fragments"][2]["contacts"]}
                self.assertGreater(len(beside), 1)
                self.assertLess(len(beside), 11)
                same = set()
                for fragment in self.manifest(first)["fragments"]:
                    files = fragment["files"]
                    for name in (files["vdb"], files["proxy"], *([files["mesh"]] if isinstance(files["mesh"], str) else files["mesh"])):
                        holds_neighbors = name.endswith((".ply", ".glb"))
                        if fragment["id"] != 3 and not (holds_neighbors and fragment["id"] in beside):
                            self.assertEqual(after[name], before[name], name)
                            same.add(name)
                self.assertGreater(len(same), 20)

    def test_only_the_neighbors_of_those_beside_change(self):
        first = self.broken_twice("ply,obj")
        for fragment in self.manifest(first)["fragments"]:
            if fragment["id"] == 3:
                continue
            name = fragment["files"]["mesh"][0] if fragment["files"]["mesh"][0].endswith(".ply") else fragment["files"]["mesh"][1]
            (old_comments, *old), (new_comments, *new) = (read_ply(os.path.join(folder, name)) for folder in (first, self.out))
            self.assertEqual(old_comments, new_comments)
            for before, after in zip(old, new):
                for column in before.dtype.names:
                    if column != "neighbor":
                        np.testing.assert_array_equal(after[column], before[column], column)
            changed = old[1]["neighbor"] != new[1]["neighbor"]
            self.assertLessEqual(set(old[1]["neighbor"][changed]), {3})
            self.assertLessEqual(set(new[1]["neighbor"][changed]), {13, 14, 15})

    def test_the_new_ones_have_the_attributes_of_the_input(self):
        for formats in ("ply,obj", "obj,ply,glb"):
            with self.subTest(formats):
                self.broken_twice(formats)
                parents = {f["id"]: f for f in self.manifest()["fragments"] if f["parent"] == 3}
                self.assertEqual(sorted(parents), [3, 13, 14, 15])
                seen = 0
                for fragment in parents.values():
                    comments, vertex, face = read_ply(os.path.join(self.out, next(n for n in fragment["files"]["mesh"] if n.endswith(".ply"))))
                    names = [words[2] for words in comments if words[0] == "material"]
                    self.assertEqual(names, ["sides", "caps", "inside"])
                    v, t = columns(vertex, *"xyz"), face["vertex_indices"]
                    outer = face["neighbor"] == 0
                    np.testing.assert_array_equal(face["material"][~outer], 2)
                    normal = np.cross(v[t[:, 1]] - v[t[:, 0]], v[t[:, 2]] - v[t[:, 0]])
                    for of, uv, n, material in zip(v[t[outer]], face["texcoord"][outer].reshape(-1, 3, 2), normal[outer], face["material"][outer]):
                        np.testing.assert_allclose(uv, [texcoord(p) for p in of], atol=1e-6)
                        if np.linalg.norm(n) > 1e-9:
                            self.assertEqual(material, int(abs(n[2]) > 0.5 * np.linalg.norm(n)))
                        seen += 1
                self.assertGreater(seen, 20)

    def test_obj_alone_has_coordinates_and_materials_again(self):
        self.broken_twice("obj")
        for fragment in self.manifest()["fragments"]:
            if fragment["parent"] != 3:
                continue
            v, vt, material, outer = [], [], None, 0
            for line in pathlib.Path(self.out, fragment["files"]["mesh"]).read_text().splitlines():
                words = line.split()
                if words[:1] == ["v"]:
                    v.append([float(x) for x in words[1:4]])
                elif words[:1] == ["vt"]:
                    vt.append([float(x) for x in words[1:3]])
                elif words[:1] == ["usemtl"]:
                    material = words[1]
                elif words[:1] == ["f"] and material != "inside":
                    for corner in words[1:]:
                        at, uv, *_ = (int(k) - 1 if k else None for k in corner.split("/"))
                        np.testing.assert_allclose(vt[uv], texcoord(v[at]), atol=1e-6)
                        outer += 1
            self.assertGreater(outer, 0)
        library = pathlib.Path(self.out, "meshes", "gear.mtl")
        self.assertEqual(library.read_bytes(), pathlib.Path(self.path("first-obj"), "meshes", "gear.mtl").read_bytes())

    def test_other_options_write_the_others_anew(self):
        """Files of another precision, or without neighbors, are not those of before."""
        first = self.broken_twice("ply")
        for options in (("--precision", "single"), ("--plain-meshes",)):
            result = self.run_sherd("fracture", first, "--only", "3", "--pieces", "2", "-o", self.path("other"), *options)
            self.assertEqual(result.returncode, 0, result.stderr)
            for fragment in self.manifest(first)["fragments"]:
                name = fragment["files"]["mesh"]
                sizes = [os.path.getsize(os.path.join(folder, name)) for folder in (self.path("other"), first)]
                if fragment["id"] != 3:
                    self.assertLess(*sizes)

    def test_five_breaks_in_a_row(self):
        folder = self.broken_twice("ply,obj")
        untouched = {f["id"] for f in self.manifest(folder)["fragments"]} - {3}
        for at in range(4):
            out = self.path(f"row{at}")
            result = self.run_sherd("fracture", self.out, "--only", "3", "--pieces", "2", "-o", out)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.out = out
        before, after = tree(folder), tree(out)
        for own in untouched:
            name = f"meshes/gear_{own:03}.obj"
            self.assertEqual(before[name], after[name])
        result = self.run_sherd("evaluate", out, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)


class Formats(CommandLine):
    """A gear whose sides and caps have a texture each, broken again and again in files of all formats."""
    OPTIONS = ("--write", "labels,vdb,mesh,usd,houdini", "--precision", "double")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.mesh = pathlib.Path(cls.data) / "gear.obj"
        write_textured(cls.mesh, *gear())
        generator = np.random.default_rng(5)
        cls.images = {}
        for name in ("sides", "caps"):
            cls.images[name] = generator.integers(0, 256, (16, 16, 3), np.uint8)
            (pathlib.Path(cls.data) / f"{name}.png").write_bytes(png(cls.images[name]))
        library = "".join(f"newmtl {name}\nKd 1 1 1\nmap_Kd {name}.png\n" for name in cls.images)
        cls.mesh.with_suffix(".mtl").write_text(library)

    def first(self, formats, *options, pieces=8):
        out = self.path("first-" + formats)
        self.done(*self.OPTIONS, "--mesh-format", formats, *options, mesh=str(self.mesh), pieces=pieces, out=out)
        return out

    def broken_in_a_row(self, first, breaks):
        """Breaks the last fragment each time.  Files of fragments that are neither broken nor, where files have neighbors, beside one stay."""
        folder = first
        for at in range(breaks):
            before = self.manifest(folder)
            own = len(before["fragments"]) if at > 0 else 3
            out = self.path(f"{os.path.basename(first)}-{at}")
            result = self.run_sherd("fracture", folder, "--only", str(own), "--pieces", "2", "-o", out)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            beside = {c["id"] for c in before["fragments"][own - 1]["contacts"]}
            old, new = tree(folder), tree(out)
            for fragment in before["fragments"]:
                for name in mesh_files(fragment):
                    if fragment["id"] != own and not (name.endswith((".ply", ".glb")) and fragment["id"] in beside):
                        self.assertEqual(new[name], old[name], name)
            self.check_textures(out)
            folder = out
        result = self.run_sherd("evaluate", folder, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        self.assertEqual((report["sound"], report["quality"]["flipped_edges"]), (report["pieces"], 0))
        return folder

    def texels(self, name, uv):
        """Colors [n, 3] of a texture between the centers of its texels, rows from above, repeated."""
        image = self.images[name].astype(float)
        at = np.column_stack([uv[:, 0], 1 - uv[:, 1]]) * image.shape[0] - 0.5
        low = np.floor(at).astype(int)
        x, y = (at - low).T[:, :, None]
        side = image.shape[0]
        of = lambda dx, dy: image[(low[:, 1] + dy) % side, (low[:, 0] + dx) % side]
        return (of(0, 0) * (1 - x) + of(1, 0) * x) * (1 - y) + (of(0, 1) * (1 - x) + of(1, 1) * x) * y

    def check_textures(self, folder):
        """At a point of each triangle of the original surface the color is that of the input there, in each format."""
        weights = np.random.default_rng(7).dirichlet((1, 1, 1), 1)[0]
        found = surfaces(self, folder, self.manifest(folder))
        for end, (corners, uv, names) in found.items():
            area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
            self.assertAlmostEqual(area.sum() / self.area, 1, delta=1e-5, msg=end)  # all of it, once
            point, at = (np.einsum("k,mkd->md", weights, values) for values in (corners, uv))
            for name in self.images:
                own = (names == name) & (area > 1e-9)
                self.assertGreater(own.sum(), 10)
                flat = np.ptp(corners[own][:, :, 2], axis=1) < 1e-6
                self.assertEqual(set(flat), {name == "caps"}, (end, name))
                expected = self.texels(name, np.array([texcoord(p) for p in point[own]]))
                np.testing.assert_allclose(self.texels(name, at[own]), expected, atol=0.05, err_msg=end)
        kept = [path.read_bytes() for path in pathlib.Path(folder, "meshes").glob("*.png")]
        self.assertEqual(sorted(kept), sorted(map(png, self.images.values())) if found else [])  # each once
        self.assertEqual(bool(found), not formats_of(self.manifest(folder)).isdisjoint((".ply", ".obj", ".glb")))

    @property
    def area(self):
        return areas(*gear()).sum()

    def test_textures_stay_where_they_are(self):
        self.broken_in_a_row(self.first("ply,obj,glb,stl,binm"), 2)

    def test_a_crack_of_which_one_side_is_broken_again_stays_a_crack(self):
        """Of the third break a face of fragment 3 is the whole of what two fragments have parts of, and no voxels of these touch its own."""
        for formats in ("ply", "obj"):
            with self.subTest(formats):
                self.broken_in_a_row(self.first(formats), 3)


if __name__ == "__main__":
    skipping.main()
