#!/usr/bin/python3
"""Objects of any size: scaling the input by a power of two scales all results by it, to the last bit, and changes nothing else.

SHERD_BIN names the program; SHERD_SCALES=all tries every shape, surface and scale.  Needs Debian's python3-numpy and python3-openvdb.
"""
import json
import os
import re
import unittest

import numpy as np

import ply_file
import skipping
from cli_test import CommandLine, sphere

ALL = os.environ.get("SHERD_SCALES") == "all"
SCALES = range(-40, 41, 5) if ALL else (-40, -17, 40)  # exponents of two
EXTREME = (-100, -60, 60, 100)  # 8e-31 .. 1e30


def cube():
    v = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    f = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    return v, f


def torus(rows=16, columns=32, tube=0.4):
    v, f = [], []
    for i in range(rows):
        for j in range(columns):
            a, b = 2 * np.pi * i / rows, 2 * np.pi * j / columns
            r = 1 + tube * np.cos(a)
            v.append((r * np.cos(b), r * np.sin(b), tube * np.sin(a)))
            n = (i + 1) % rows * columns
            f += [(i * columns + j, i * columns + (j + 1) % columns, n + (j + 1) % columns), (i * columns + j, n + (j + 1) % columns, n + j)]
    return v, [t[::-1] for t in f]


SHAPES = {"cube": cube(), "ball": sphere(12, 24), "torus": torus()}


def write_scaled(path, mesh, exponent):
    """With all digits.  Coordinates are of single precision, which scaled ones are too."""
    with open(path, "w") as file:
        for p in mesh[0]:
            file.write("v %r %r %r\n" % tuple(float(np.float32(x)) * 2.0 ** exponent for x in p))
        for t in mesh[1]:
            file.write("f %d %d %d\n" % tuple(i + 1 for i in t))


def numbers(value, path=""):
    """The numbers of JSON, by path."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, f"{path}.{key}")
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from numbers(item, f"{path}[{i}]")
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path, value


class Scales(CommandLine):
    def fracture(self, name, exponent, *arguments):
        out = self.path(f"{name}_{exponent}_{len(os.listdir(self.tmp))}")
        mesh = self.path(name + ".obj")
        write_scaled(mesh, SHAPES[name], exponent)
        run = self.run_sherd("fracture", mesh, "-o", out, "--pieces", "4", "--resolution", "20", *arguments)
        self.assertEqual(run.returncode, 0, run.stderr)
        return out

    def bytes_of(self, *parts):
        with open(os.path.join(*parts), "rb") as file:
            return file.read()

    def assert_scaled(self, one, other, exponent):
        """JSON whose lengths, areas, volumes and moments are scaled, and all else is equal."""
        one, other = dict(numbers(one)), dict(numbers(other))
        self.assertEqual(set(one), set(other))
        for path, value in one.items():
            if other[path] == value:
                continue
            powers = [p for p in range(-3, 6) if other[path] == value * 2.0 ** (p * exponent)]
            self.assertEqual(len(powers), 1, f"{path}: {value} became {other[path]}")

    def assert_same_files(self, whole, scaled, exponent):
        self.assertEqual(self.bytes_of(whole, "labels.rle"), self.bytes_of(scaled, "labels.rle"))
        meshes = sorted(os.listdir(os.path.join(whole, "meshes")))
        self.assertEqual(meshes, sorted(os.listdir(os.path.join(scaled, "meshes"))))
        for name in meshes:
            (_, v, f), (_, w, g) = (ply_file.read_ply(os.path.join(out, "meshes", name)) for out in (whole, scaled))
            self.assertTrue((ply_file.columns(v, "x", "y", "z") * 2.0 ** exponent == ply_file.columns(w, "x", "y", "z")).all(), name)
            for column in f.dtype.names:
                self.assertTrue((f[column] == g[column]).all(), (name, column))
        manifests = [json.loads(self.bytes_of(out, "manifest.json")) for out in (whole, scaled)]
        for manifest in manifests:
            self.assertEqual("vdb_unit" in manifest["grid"], manifest["grid"]["voxel_size"] < 2.0 ** -16)
            manifest["grid"].pop("vdb_unit", None)
        self.assert_scaled(*manifests, exponent)

    def test_files_are_scaled_to_the_last_bit(self):
        variants = {"ball": ("smooth",), "cube": ("exact",), "torus": ("labels",)}
        for name in SHAPES:
            for surface in ("smooth", "exact", "labels") if ALL else variants[name]:
                arguments = ("--surface", surface, "--write", "labels,mesh,vdb", *(() if surface == "exact" else ("--erode-iterations", "1")))
                whole = self.fracture(name, 0, *arguments)
                for exponent in (*SCALES, *(EXTREME if ALL else EXTREME[1:3])):
                    with self.subTest(shape=name, surface=surface, exponent=exponent):
                        self.assert_same_files(whole, self.fracture(name, exponent, *arguments), exponent)

    def test_volumes_are_in_a_unit_that_openvdb_takes(self):
        import pyopenvdb
        for exponent in (0, -17, -60):
            out = self.fracture("ball", exponent, "--write", "vdb,fog", "--vdb", "files")
            grid = json.loads(self.bytes_of(out, "manifest.json"))["grid"]
            for level in pyopenvdb.readAll(os.path.join(out, "fragments", "ball_001.vdb"))[0]:
                unit = level.metadata.get("world_units_per_unit", 1.0)
                self.assertEqual(unit, grid.get("vdb_unit", 1.0))
                self.assertEqual(level.transform.voxelSize(), (grid["voxel_size"] / unit,) * 3)
                self.assertTrue(level.transform.info())  # asks for the matrix
                self.assertGreaterEqual(level.transform.voxelSize()[0], 2.0 ** -16)

    def test_usd_scales_its_volumes(self):
        for exponent in (0, -30):
            out = self.fracture("ball", exponent, "--write", "vdb,usd", "--usd-volumes")
            unit = json.loads(self.bytes_of(out, "manifest.json"))["grid"].get("vdb_unit", 1.0)
            volumes = self.bytes_of(out, "scene.usda").decode().split('def Volume "volume"')[1:]
            self.assertEqual(len(volumes), 4)
            for volume in volumes:
                scale = re.search(r"double3 xformOp:scale = \((\S+), (\S+), (\S+)\)", volume)
                self.assertEqual({float(x) for x in scale.groups()} if scale else {1.0}, {unit})
                order = re.search(r"xformOpOrder = \[(.*)\]", volume)[1]
                self.assertEqual(order, '"xformOp:translate"' + (', "xformOp:scale"' if scale else ""))

    def test_16_bits_hold_huge_voxels(self):
        import pyopenvdb
        out = self.fracture("ball", 40, "--write", "labels,vdb", "--half")
        unit = json.loads(self.bytes_of(out, "manifest.json"))["grid"]["vdb_unit"]
        level = pyopenvdb.readAll(os.path.join(out, "fragments", "ball_001.vdb"))[0][0]
        self.assertTrue(np.isfinite(level.background) and level.background * unit > 2.0 ** 35)
        again = self.path("again")
        run = self.run_sherd("fracture", os.path.join(out, "manifest.json"), "--only", "1", "-o", again, "--pieces", "2")
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_other_commands_take_objects_of_any_size(self):
        known = {}

        def same(key, value):
            self.assertEqual(known.setdefault(key, value), value, key)

        for exponent in (0, -17, -60):
            out = self.fracture("torus", exponent, "--write", "labels,mesh,vdb,solid,proxy")
            for command in ("evaluate", out, "--json"), ("inspect", os.path.join(out, "meshes", "torus_001.ply"), "--json"):
                run = self.run_sherd(*command)
                self.assertEqual(run.returncode, 0, run.stderr)
                report = json.loads(run.stdout)
                self.assert_scaled(known.setdefault(command[0], report), report, exponent)
            for number, source in enumerate((out, os.path.join(out, "fragments", "torus_001.vdb"))):
                image = self.path("image.png")
                run = self.run_sherd("render", source, "-o", image, "--size", "64x64")
                self.assertEqual(run.returncode, 0, run.stderr)
                same(("image", number), self.bytes_of(image))
            for source, more in (("manifest.json", ("--only", "1")), ("fragments/torus.vdb", ())):
                again = self.path("again_" + source[-4:] + str(exponent))
                run = self.run_sherd("fracture", os.path.join(out, source), *more, "-o", again, "--pieces", "3", "--write", "labels,vdb")
                self.assertEqual(run.returncode, 0, run.stderr)
                same(source, self.bytes_of(again, "labels.rle"))

    def test_lengths_without_single_precision_are_refused(self):
        for exponent, words in ((-110, "supported are 1e-30 to 1e+37"), (124, "at most 1e37")):
            mesh = self.path("ball.obj")
            write_scaled(mesh, SHAPES["ball"], exponent)
            self.refused(3, self.run_sherd("fracture", mesh, "-o", self.out, "--resolution", "20"), words)


if __name__ == "__main__":
    skipping.main()
