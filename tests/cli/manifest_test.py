#!/usr/bin/python3
"""Manifests that somebody else wrote: every command that reads one refuses them with a sentence, and opens nothing outside.

SHERD_BIN names the program.
"""
import json
import os
import shutil
import unittest

import manifests
import skipping
from cli_test import CommandLine

LONG = "x" * 300


class Manifests(CommandLine):
    def setUp(self):
        super().setUp()
        self.done("--write", "labels,vdb,mesh")
        with open(os.path.join(self.out, "manifest.json")) as file:
            self.manifest = json.load(file)

    def hold(self, manifest):
        with open(os.path.join(self.out, "manifest.json"), "w") as file:
            file.write(manifest if isinstance(manifest, str) else json.dumps(manifest))

    def commands(self):
        manifest = os.path.join(self.out, "manifest.json")
        again = ("fracture", manifest, "--only", "1", "-o", self.path("again"))
        picture = ("render", self.out, "-o", self.path("x.png"), "--size", "32x32")
        return {"inspect": ("inspect", self.out), "evaluate": ("evaluate", self.out), "render": picture, "fracture": again}

    def each_refuses(self, *words, among=("inspect", "evaluate", "render", "fracture")):
        for name, arguments in self.commands().items():
            if name in among:
                with self.subTest(command=name):
                    self.refused(3, self.run_sherd(*arguments), "manifest.json", *words)
                    self.assertFalse(os.path.exists(self.path("x.png")) or os.path.exists(self.path("again")))

    def changed(self, change):
        manifest = json.loads(json.dumps(self.manifest))
        change(manifest)
        return manifest

    def test_what_we_write_is_read(self):
        for name, arguments in self.commands().items():
            with self.subTest(command=name):
                result = self.run_sherd(*arguments)
                self.assertEqual(result.returncode, 0, result.stderr)

    def test_the_schema_refuses_what_is_changed(self):
        """Each key less, and a foreign one more, wherever there is an object."""
        def objects(value, at=()):
            if isinstance(value, dict):
                yield at
            for key, below in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
                yield from objects(below, (*at, key))

        def at(value, keys):
            for key in keys:
                value = value[key]
            return value

        self.assertEqual(manifests.faults_of(self.manifest), [])
        optional = {"mesh_precision", "rounded_crossings", "report", "resolution", "fill", "vdb", "mesh", "plain_meshes", "up", "file_vertices", "vertices", "triangles",
                    "degenerate_triangles", "thinnest_voxels", "resolution_to_hold", "name"}
        for keys in objects(self.manifest):
            more = self.changed(lambda manifest: at(manifest, keys).update(foreign=1))
            self.assertNotEqual(manifests.faults_of(more), [], keys)
            for key in at(self.manifest, keys):
                less = self.changed(lambda manifest: at(manifest, keys).pop(key))
                if key not in optional:
                    self.assertNotEqual(manifests.faults_of(less), [], (*keys, key))

    def test_the_schema_refuses_null_for_a_number(self):
        """JSON has it for what is not a finite number."""
        def numbers(value, at=()):
            for key, below in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
                if isinstance(below, (int, float)):
                    yield (*at, key)
                yield from numbers(below, (*at, key))

        found = list(numbers(self.manifest))
        self.assertGreater(len(found), 100)
        for *keys, key in found[::7]:
            def change(manifest):
                for step in keys:
                    manifest = manifest[step]
                manifest[key] = None
            self.assertNotEqual(manifests.faults_of(self.changed(change)), [], (*keys, key))

    def test_texts_that_are_no_manifests(self):
        deep = '{"schema": "sherd/2", "a": ' + "[" * 100000 + "]" * 100000 + "}"
        for text in ("", "{", "[]", "null", '{"schema": "sherd/3"}', '{"schema": ["sherd/2"]}', '{"schema": "sherd/2"}', deep,
                     '{"schema": "sherd/2", "a": 1e999}', "\xff\xfe"):
            self.hold(text)
            self.each_refuses()

    def test_files_outside_the_folder(self):
        shutil.copy(self.ball, self.path("stolen.ply"))
        for name in ("../stolen.ply", self.path("stolen.ply"), "meshes/../../stolen.ply", "a\0b", LONG, "y/" * 3000 + "y"):
            def change(manifest):
                manifest["files"].append(name)
                manifest["fragments"][0]["files"] = {"mesh": name, "vdb": name}
            self.hold(self.changed(change))
            self.each_refuses("leaves the folder")

    def test_links_that_leave_the_folder(self):
        for kind, command in (("mesh", "evaluate"), ("mesh", "render"), ("vdb", "fracture")):
            name = self.manifest["fragments"][0]["files"][kind]
            inside, outside = os.path.join(self.out, name), self.path("outside")
            os.rename(inside, outside)
            os.symlink(outside, inside)
            self.each_refuses("symbolic link", among=(command,))
            os.remove(inside)
            os.rename(outside, inside)
        os.rename(os.path.join(self.out, "labels.rle"), self.path("labels.rle"))
        os.symlink("../labels.rle", os.path.join(self.out, "labels.rle"))
        self.each_refuses("symbolic link", among=("fracture",))

    def test_fields(self):
        def ids(manifest):
            manifest["fragments"][1]["id"] = 1

        def huge(manifest):
            manifest["fragments"][1]["id"] = 1 << 62

        def share(manifest):
            manifest["fragments"][0]["share"] = -1

        def size(manifest):
            manifest["grid"]["voxel_size"] = 0

        def corner(manifest):
            manifest["grid"]["index_min"] = [1 << 31, 0, 0]

        def kind(manifest):
            manifest["fragments"] = {"1": manifest["fragments"][0]}

        for change in (ids, huge, share, size, corner, kind):
            with self.subTest(change=change.__name__):
                self.hold(self.changed(change))
                self.each_refuses("is damaged")

    def test_paths_that_cannot_be(self):
        for path in (LONG, "y/" * 3000 + "y", self.path("absent"), self.path("loop")):
            if path.endswith("loop"):
                os.symlink("loop", path)
            for arguments in (("inspect", path), ("inspect", path + ".rle"), ("inspect", path + ".vdb"), ("evaluate", path),
                              ("render", path, "-o", self.path("x.png")), ("inspect", path + ".obj"),
                              ("fracture", path + ".obj", "-o", self.path("again")),
                              ("fracture", self.ball, "--seeds", path, "-o", self.path("again")),
                              ("fracture", path, "--only", "1", "-o", self.path("again"))):
                with self.subTest(arguments=[a[:40] for a in arguments]):
                    self.refused(3, self.run_sherd(*arguments))


if __name__ == "__main__":
    skipping.main()
