#!/usr/bin/python3
"""Small files that stand for much memory: each is refused with a sentence, before it is taken.  And many small pieces.

SHERD_BIN names the program.  Needs python3-numpy.
"""
import gzip
import io
import json
import os
import re
import resource
import shutil
import struct
import subprocess
import tempfile
import unittest
import zipfile

import numpy as np

import skipping

SHERD = os.environ["SHERD_BIN"]
LIMIT = "500M"
RESIDENT = 1_000_000  # kB: the limit, and the program with its OpenCL compiler
TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
PRIMITIVE = {"attributes": {"POSITION": 0}}


def glb(document, buffer):
    document = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(buffer)}], **document}
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    buffer += b"\0" * (-len(buffer) % 4)
    return (b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(buffer)) + struct.pack("<I", len(text)) + b"JSON" + text
            + struct.pack("<I", len(buffer)) + b"BIN\0" + buffer)


def primitives():
    """6,000 primitives of one accessor without data."""
    return glb({"nodes": [{"mesh": 0}], "accessors": [{"componentType": 5126, "count": 400_000, "type": "VEC3"}],
                "meshes": [{"primitives": [PRIMITIVE] * 6000}]}, b"\0" * 500_000)


def instances():
    """40 times 500,000 instances of a triangle."""
    shown = {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}}
    return glb({"nodes": [shown] * 40, "meshes": [{"primitives": [PRIMITIVE]}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 1_500_000}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                              {"bufferView": 1, "componentType": 5121, "count": 500_000, "type": "VEC3"}]},
               TRIANGLE + b"\1" * 1_500_000)


def names():
    """50,000 nodes that take their names from one mesh."""
    return glb({"nodes": [{"mesh": 0}] * 50_000, "meshes": [{"name": "n" * 500_000, "primitives": [PRIMITIVE]}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]}, TRIANGLE)


def zeros():
    """Two gigabytes of zeros, packed."""
    return gzip.compress(bytes(1 << 24)) * 128


def npz(name, kind, shape, block, blocks):
    out, head = io.BytesIO(), io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": kind, "fortran_order": False, "shape": shape})
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open(name + ".npy", "w") as file:
            file.write(head.getvalue())
            for _ in range(blocks):
                file.write(block)
    return out.getvalue()


MODEL_3MF = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
FAR = ' transform="1e308 0 0 0 1e308 0 0 0 1e308 0 0 0"'  # its solid has no finite triangle, so that it is refused after all else was read


def solid_3mf(attributes=""):
    corners = [(x, y, z) for x in (-10, 10) for y in (-10, 10) for z in (-10, 10)]
    faces = ((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3))
    return (f'<object id="1" {attributes}><mesh><vertices>' + "".join('<vertex x="%d" y="%d" z="%d"/>' % corner for corner in corners)
            + "</vertices><triangles>" + "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % face for face in faces)
            + "</triangles></mesh></object>")


def model_3mf(resources, items=f'<item objectid="1"{FAR}/>'):
    return f'<model unit="millimeter"><resources>{resources}</resources><build>{items}</build></model>'


def package_3mf(model, name="3D/a.model"):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", f'<Relationships><Relationship Target="/{name}" Type="{MODEL_3MF}"/></Relationships>')
        archive.writestr(name, model)
    return out.getvalue()


def block(folder):
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    quads = (0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)
    with open(os.path.join(folder, "block.obj"), "w") as out:
        out.writelines("v %d %d %d\n" % corner for corner in corners)
        out.writelines("f %d %d %d %d\n" % tuple(i + 1 for i in quad) for quad in quads)
    return out.name


class SmallPiecesTest(unittest.TestCase):
    def test_take_no_more_than_is_estimated(self):
        """A level set has 0.3 MB however small it is, and hundreds of them were made at once."""
        with tempfile.TemporaryDirectory() as folder:
            words = [SHERD, "fracture", block(folder), "-o", os.path.join(folder, "out"), "--pieces", "1200", "--resolution", "32",
                     "--write", "labels,vdb,mesh", "--quiet", "--max-memory"]
            refused = subprocess.run([*words, "60M"], capture_output=True, text=True)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            estimate = float(re.search(r"takes up to ([\d.]+) GB", refused.stderr)[1]) * 1e9
            run = subprocess.Popen([*words, "4G"])
            _, status, used = os.wait4(run.pid, 0)
            run.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(run.returncode, 0)
            self.assertLess(used.ru_maxrss * 1024, estimate)


class SamplesTest(unittest.TestCase):
    """Points, correspondences and distance samples are made in blocks, or refused by the names of their options."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.words = [SHERD, "fracture", block(self.folder.name), "-o", os.path.join(self.folder.name, "out"), "--pieces", "2", "--resolution", "32",
                      "--write", "labels", "--quiet"]

    def peak(self, words):
        """Bytes."""
        run = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        said = run.stderr.read()
        run.stderr.close()
        _, status, used = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(run.returncode, 0, said)
        return used.ru_maxrss * 1024

    def test_take_no_more_the_more_they_are(self):
        """300,000 more points would take 60 MB more on two fragments, at 100 bytes each, and so would the others."""
        for few, many in ((["--points", "300000"], ["--points", "600000"]),
                          (["--points", "300000", "--point-format", "npz"], ["--points", "600000", "--point-format", "npz"]),
                          (["--correspondences", "300000"], ["--correspondences", "600000"])):
            with self.subTest(many=many):
                self.assertLess(self.peak(self.words + many), self.peak(self.words + few) + 20_000_000)

    def test_are_refused_by_name_with_the_number_that_fits(self):
        limit = 225_000_000
        words = self.words + ["--point-sampler", "poisson", "--max-memory", str(limit), "--points"]
        refused = subprocess.run([*words, "10000000"], capture_output=True, text=True)
        self.assertEqual(refused.returncode, 2, refused.stderr)
        fits = re.search(r"(\d+) points on a fragment fit beside the fracture; one with 10000000 takes up to [\d.]+ GB of memory, and 0.225 GB may be "
                         r"used \(--points, --max-memory\)", refused.stderr)
        self.assertIsNotNone(fits, refused.stderr)
        self.assertGreater(int(fits[1]), 10_000)
        self.assertLess(self.peak([*words, fits[1]]), limit)

    def test_of_a_dataset_are_refused_by_name(self):
        library = os.path.join(self.folder.name, "library")
        os.mkdir(library)
        block(library)
        run = subprocess.run([SHERD, "dataset", library, "-o", os.path.join(self.folder.name, "set"), "--pieces", "2", "--resolution", "32",
                              "--repeats", "1", "--points", "10000000", "--point-sampler", "poisson", "--max-memory", "1G"], capture_output=True, text=True)
        self.assertRegex(run.stderr, r"block.obj failed: \d+ points on a fragment fit .*\(--points, --max-memory\)")

    def test_of_a_dataset_go_to_the_disk(self):
        """Of 42 MB in a file no more is held than of 20; in an archive too."""
        library = os.path.join(self.folder.name, "library")
        os.mkdir(library)
        block(library)
        for layout in "sherd", "packed":
            words = [SHERD, "dataset", library, "-o", os.path.join(self.folder.name, layout), "--layout", layout, "--pieces", "2", "--resolution", "32",
                     "--repeats", "1", "--write", "labels", "--quiet", "--points"]
            with self.subTest(layout=layout):
                few = self.peak([*words, "700000"])
                shutil.rmtree(os.path.join(self.folder.name, layout))
                self.assertLess(self.peak([*words, "1500000"]), few + 20_000_000)


class HostileMemoryTest(unittest.TestCase):
    def test_a_manifest_of_empty_lists(self):
        """30 MB are parsed to 1 GB."""
        addresses = 1_500_000_000  # all that may be mapped, the program's libraries too
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "manifest.json")
            for count, says in (10, "has no schema|is no manifest|schema"), (10_000_000, r"manifest\.json: reading it takes .*may be used"):
                with open(path, "w") as file:
                    file.write('{"files": [' + ",".join(["[]"] * count) + "]}")
                run = subprocess.run([SHERD, "inspect", path], capture_output=True, text=True,
                                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (addresses, addresses)))
                self.assertEqual(run.returncode, 3, run.stderr)
                self.assertRegex(run.stderr, says)
                self.assertNotIn("--", run.stderr)  # inspect has no option for it

    def refused(self, name, content):
        self.assertLess(len(content), 8_000_000)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, name)
            with open(path, "wb") as file:
                file.write(content)
            run = subprocess.run([SHERD, "fracture", path, "-o", os.path.join(folder, "out"), "--max-memory", LIMIT],
                                 capture_output=True, text=True)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, RESIDENT)  # of the largest
        return run.stderr

    def refused_for_memory(self, name, content):
        self.assertRegex(self.refused(name, content), r"reading it takes [\d.]+ GB of memory or more, and [\d.]+ GB may be used \(--max-memory\)\n$")

    def test_primitives_and_instances(self):
        self.refused_for_memory("a.glb", primitives())
        self.refused_for_memory("b.glb", instances())

    def test_names(self):
        self.refused_for_memory("a.glb", names())

    def test_names_of_3mf(self):
        """A name of 200 kB shown 10,000 times."""
        nested = "".join(f'<object id="{k}"><components>' + f'<component objectid="{k - 1}"/>' * 10 + "</components></object>" for k in range(2, 6))
        name = "n" * 200_000
        said = self.refused("a.3mf", package_3mf(model_3mf(solid_3mf(f'name="{name}"') + nested, f'<item objectid="5"{FAR}/>')))
        self.assertIn("vertices are not finite", said)

    def test_materials_of_3mf(self):
        """20,000 materials of a part whose name has 60 kB."""
        count = 20_000
        bases = '<basematerials id="8">' + '<base name="b" displaycolor="#010203"/>' * count + "</basematerials>"
        more = "".join(f'<triangle v1="0" v2="1" v3="3" pid="8" p1="{i}"/>' for i in range(count))
        model = model_3mf(bases + solid_3mf().replace("</triangles>", more + "</triangles>"))
        self.assertIn("vertices are not finite", self.refused("a.3mf", package_3mf(model, "3D/" + "x" * 60_000 + ".model")))

    def test_packed_zeros(self):
        self.refused_for_memory("a.obj.gz", zeros())
        self.refused_for_memory("b.stl.gz", zeros())
        self.assertIn("found no 'ply'", self.refused("c.ply.gz", zeros()))

    def test_packed_labels(self):
        turns = np.resize(np.array([1, 2], np.uint8), 1 << 20).tobytes()
        self.refused_for_memory("a.npz", npz("labels", "|u1", (512, 1024, 1024), turns, 512))


if __name__ == "__main__":
    skipping.main()
