#!/usr/bin/python3
"""--source-faces: the face of the input on which each face of a fragment lies, as computed here from the file's faces.

Of exact surfaces a face lies in the plane of its face of the input and inside of it, and the parts of a face have its area together.
Of smooth ones no face of the input is nearer to the centroid, where a face that is turned away counts as farther.

Environment: SHERD_BIN the program.  Needs Debian's python3-numpy.
"""
import json
import os
import struct
import unittest

import numpy as np

from cli_test import CommandLine, joined, sphere, tree, write_obj
from exact_input_test import polygons as gear_of_polygons
from exact_input_test import write as write_polygons

TURNED, TILTED = 2.0, 0.01  # of a face's longest edge: docs/decisions/0013-surface-attributes.md
NONE = -1


def cube(center=(0.0, 0.0, 0.0), side=1.0):
    """Vertices and quads of a box that is turned, so that its planes are none of the axes'."""
    q, _ = np.linalg.qr(np.array([[3.0, 1, 2], [1, 4, 1], [2, 1, 5]]))
    q = q * np.linalg.det(q)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * side / 2
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return np.array(corners @ q.T + center), faces


def read_ply(path):
    """Vertices, and faces of any length with their neighbor and source_face."""
    with open(path, "rb") as file:
        head, body = file.read().split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    counts = [int(line.split()[2]) for line in lines if line.startswith("element")]
    kind = "<f8" if "property double x" in lines else "<f4"
    at_face = next(i for i, line in enumerate(lines) if line.startswith("element face"))
    names = [line.split()[-1] for line in lines[at_face + 2:]]
    assert names == ["neighbor", "source_face"], names  # and no attributes, in this test
    rows = np.frombuffer(body, [("at", kind, 3), ("normal", "<f4", 3), ("neighbor", "<i4")], counts[0])
    at, faces = rows.nbytes, []
    for _ in range(counts[1]):
        n = body[at]
        faces.append((np.array(struct.unpack_from(f"<{n}i", body, at + 1)), *struct.unpack_from("<2i", body, at + 1 + 4 * n)))
        at += 9 + 4 * n
    assert at == len(body)
    return rows["at"].astype(float), faces


def vector_area(points):
    """Half the sum of cross products: of a flat polygon its area times its normal."""
    p = points - points[0]
    return np.cross(p[1:-1], p[2:]).sum(axis=0) / 2


def distance_inside(points, p):
    """How far a point in the plane of a flat polygon lies outside of it: 0 for those inside."""
    normal = vector_area(points)
    normal /= np.linalg.norm(normal)
    inside, nearest = False, np.inf
    axis = np.abs(normal).argmax()
    u, v = [i for i in range(3) if i != axis]
    for a, b in zip(points, np.roll(points, -1, axis=0)):
        if (a[v] > p[v]) != (b[v] > p[v]) and p[u] < a[u] + (p[v] - a[v]) / (b[v] - a[v]) * (b[u] - a[u]):
            inside = not inside
        along = b - a
        t = np.clip((p - a) @ along / (along @ along), 0, 1) if along.any() else 0.0
        nearest = min(nearest, np.linalg.norm(a + t * along - p))
    return 0.0 if inside else nearest


def distances(p, a, b, c):
    """From points p to triangles a, b, c: [points, triangles]."""
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=-1, keepdims=True)
    unit = np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)
    to = p[:, None] - a
    height = np.einsum("pti,ti->pt", to, unit)
    above = size[:, 0] > 0
    best = np.full(height.shape, np.inf)
    for u, v in ((a, b), (b, c), (c, a)):
        along, off = v - u, p[:, None] - u
        above = above & (np.einsum("pti,ti->pt", off, np.cross(unit, along)) >= 0)
        length = np.maximum((along * along).sum(-1), 1e-300)
        t = np.clip(np.einsum("pti,ti->pt", off, along) / length, 0, 1)
        best = np.minimum(best, np.linalg.norm(off - t[..., None] * along, axis=-1))
    return np.where(above, np.minimum(np.abs(height), best), best)


class SourceFaces(CommandLine):
    def pieces(self, mesh, *options, out=None, pieces=6, **more):
        """Of each fragment the mesh, after a check of what holds for all."""
        out = out or self.out
        self.done("--write", "mesh", "--precision", "double", "--source-faces", *options, mesh=mesh, out=out, pieces=pieces, **more)
        with open(os.path.join(out, "manifest.json")) as file:
            self.manifest = json.load(file)
        self.assertIs(self.manifest["options"]["source_faces"], True)
        found = [read_ply(os.path.join(out, f["files"]["mesh"])) for f in self.manifest["fragments"]]
        for _, faces in found:
            for _, neighbor, source in faces:
                if neighbor:
                    self.assertEqual(source, NONE)
        return found

    def expect_exact(self, mesh, vertices, faces, dropped=(), **more):
        """Every part of a face of the file lies in it, and all of them are it."""
        found = self.pieces(mesh, "--surface", "exact", **more)
        self.assertNotIn("exact_failure", self.manifest)
        scale = np.ptp(np.asarray(vertices), axis=0).max()
        area = np.zeros(len(faces))
        for at, own in found:
            for corners, neighbor, source in own:
                if neighbor:
                    continue
                self.assertTrue(0 <= source < len(faces))
                whole = np.asarray(vertices, float)[list(faces[source])]
                normal = vector_area(whole)
                normal /= np.linalg.norm(normal)
                for p in at[corners]:
                    self.assertLess(abs((p - whole[0]) @ normal), 1e-9 * scale)
                    self.assertLess(distance_inside(whole, p), 1e-9 * scale)
                area[source] += np.linalg.norm(vector_area(at[corners]))
        for i, face in enumerate(faces):
            expected = 0.0 if i in dropped else np.linalg.norm(vector_area(np.asarray(vertices, float)[list(face)]))
            self.assertAlmostEqual(area[i], expected, delta=1e-9 * scale * scale, msg=f"face {i}")

    def expect_nearest(self, found, vertices, triangles, flipped=False, nowhere=lambda centroids: np.zeros(len(centroids), bool)):
        """No triangle is nearer to the centroid by the rule of decision 13.  `nowhere`: that lie where a hole was closed."""
        v, t = np.asarray(vertices, float), np.asarray(triangles)
        a, b, c = v[t[:, 0]], v[t[:, 1]], v[t[:, 2]]
        normals = np.cross(b - a, c - a)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0) * (-1 if flipped else 1)
        scale, seen = np.ptp(v, axis=0).max(), 0
        for at, faces in found:
            outside = [(at[corners], source) for corners, neighbor, source in faces if not neighbor]
            corners = np.array([p for p, _ in outside])
            source = np.array([s for _, s in outside])
            centroid = corners.mean(axis=1)
            closed = nowhere(centroid)
            self.assertTrue((source[closed] == NONE).all())
            corners, source, centroid = corners[source != NONE], source[source != NONE], centroid[source != NONE]
            edges = corners - np.roll(corners, 1, axis=1)
            size = np.linalg.norm(edges, axis=2).max(axis=1)
            own = np.cross(edges[:, 1], edges[:, 2])
            own /= np.linalg.norm(own, axis=1, keepdims=True)
            agreement = own @ normals.T
            far = distances(centroid, a, b, c) + size[:, None] * (np.where(agreement > 0, 0, TURNED) + TILTED * (1 - agreement))
            self.assertLess((far[np.arange(len(far)), source] - far.min(axis=1)).max(), 1e-9 * scale)
            seen += len(far)
        self.assertGreater(seen, 0)
        return seen

    # --- exact surfaces

    def test_exact_quads_of_a_box(self):
        vertices, faces = cube()
        mesh = self.path("box.obj")
        write_polygons(mesh, vertices, faces)
        self.expect_exact(mesh, vertices, faces)

    def test_exact_polygons_that_are_not_convex(self):
        vertices, faces = gear_of_polygons()
        mesh = self.path("gear.obj")
        write_polygons(mesh, vertices, faces)
        self.expect_exact(mesh, vertices, faces)

    def test_exact_triangles_of_a_ball_with_roughness(self):
        vertices, faces = sphere(10, 16)
        mesh = self.path("ball.obj")
        write_obj(mesh, (vertices, faces))
        vertices = np.array([[float(f"{x:.9g}") for x in v] for v in vertices])
        self.expect_exact(mesh, vertices, faces, pieces=4)

    def test_exact_after_repairs(self):
        """Flipped, repeated and degenerate triangles, corners that are no numbers, and one of two boxes inside out."""
        one, quads = cube()
        two, _ = cube((3.0, 0.2, 0.1), 0.7)
        triangles = [t for q in quads for t in (q[:3], (q[0], q[2], q[3]))]
        vertices = np.concatenate([one, two, [[9.0, 9.0, 9.0], [np.nan, 0.0, 0.0]]])
        faces = list(triangles)
        faces[3] = faces[3][::-1]
        faces.insert(1, (0, 0, 5))  # two corners are one
        faces.insert(4, faces[2])  # the same again
        faces.insert(0, (17, 1, 2))  # not finite
        faces += [tuple(8 + i for i in t)[::-1] for t in triangles]
        mesh = self.path("broken.obj")
        with open(mesh, "w") as out:
            out.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
            out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in faces)
        self.assertEqual(faces[5], faces[3])  # and of these the first is kept
        dropped = {0, 2, 5}
        self.expect_exact(mesh, np.nan_to_num(vertices[:16]), faces_without_numbers(faces, dropped), dropped)

    def test_exact_ply_and_off_with_faces_of_two_corners(self):
        vertices, faces = cube()
        faces = [(0, 1), *faces[:2], (3,), *faces[2:]]
        dropped = {0, 3}
        ply = self.path("box.ply")
        with open(ply, "w") as out:
            out.write(f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
                      f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
            out.writelines("%r %r %r\n" % tuple(map(float, v)) for v in vertices)
            out.writelines(" ".join(map(str, (len(f), *f))) + "\n" for f in faces)
        off = self.path("box.off")
        with open(off, "w") as out:
            out.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
            out.writelines("%r %r %r\n" % tuple(map(float, v)) for v in vertices)
            out.writelines(" ".join(map(str, (len(f), *f))) + "\n" for f in faces)
        for mesh in ply, off:
            with self.subTest(mesh=mesh):
                self.expect_exact(mesh, vertices, faces_without_numbers(faces, dropped), dropped)

    def test_objects_have_the_numbers_of_the_file(self):
        meshes = [sphere(8, 12), sphere(8, 12, (5.0, 0, 0))]
        vertices, faces = joined(*meshes)
        half = len(faces) // 2
        mesh = self.path("objects.obj")
        with open(mesh, "w") as out:
            out.writelines("v %r %r %r\n" % tuple(map(float, v)) for v in vertices)
            for name, own in (("far", faces[half:]), ("near", faces[:half])):
                out.write(f"o {name}\n")
                out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in own)
        self.done("--write", "mesh", "--source-faces", "--split-objects", "--surface", "exact", mesh=mesh, pieces=2)
        for name, numbers in (("far", range(half)), ("near", range(half, 2 * half))):
            seen = set()
            for i in (1, 2):
                _, own = read_ply(os.path.join(self.out, name, "meshes", f"objects_00{i}.ply"))
                seen |= {source for _, neighbor, source in own if not neighbor}
            self.assertEqual(seen, set(numbers))

    # --- smooth surfaces, and those of labels

    def test_nearest_by_the_rule(self):
        vertices, faces = sphere(12, 20)
        mesh = self.path("ball.obj")
        with open(mesh, "w") as out:
            out.writelines("v %r %r %r\n" % tuple(v) for v in vertices)
            out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in faces)
        for options in ([], ["--surface", "labels"], ["--roughness", "2"], ["--adaptivity", "0.3"], ["--interface", "independent"],
                        ["--erode-iterations", "2", "--erode-on", "fracture"]):
            with self.subTest(options=options):
                found = self.pieces(mesh, *options, pieces=4)
                self.assertGreater(self.expect_nearest(found, vertices, faces), 100)

    def test_merged_and_decimated_faces(self):
        vertices, faces = cube()
        mesh = self.path("box.obj")
        write_polygons(mesh, vertices, faces)
        triangles = [t for q in faces for t in (q[:3], (q[0], q[2], q[3]))]
        found = self.pieces(mesh, "--triangles", "60")
        found += [read_ply(os.path.join(self.out, f["decimated"][0]["file"])) for f in self.manifest["fragments"]]
        # Triangles of a quad share its plane, and which of them is nearest makes no difference.
        found = [(at, [(c, n, s if s == NONE else 2 * s) for c, n, s in own]) for at, own in found]
        for at, own in found:
            for corners, neighbor, source in own:
                if not neighbor:
                    centroid = at[corners].mean(axis=0)
                    pair = [np.array([vertices[list(t)][k] for t in triangles[source:source + 2]]) for k in range(3)]
                    every = distances(centroid[None], *(np.array([vertices[t[k]] for t in triangles]) for k in range(3)))
                    self.assertLess(distances(centroid[None], *pair).min(), every.min() + 0.05)

    def test_a_mesh_inside_out(self):
        vertices, faces = sphere(12, 20)
        mesh = self.path("ball.obj")
        with open(mesh, "w") as out:
            out.writelines("v %r %r %r\n" % tuple(v) for v in vertices)
            out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t[::-1]) for t in faces)
        self.expect_nearest(self.pieces(mesh), vertices, [t[::-1] for t in faces], flipped=True)

    def test_no_face_where_a_hole_was_closed(self):
        vertices, faces = sphere(24, 48)
        low = 0.72
        kept = [f for f in faces if max(vertices[i][2] for i in f) < low]
        rim = max(vertices[i][2] for f in kept for i in f)
        mesh = self.path("open.obj")
        with open(mesh, "w") as out:
            out.writelines("v %r %r %r\n" % tuple(v) for v in vertices)
            out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in kept)
        voxel = 2 / 32
        for fill in "winding", "parity":
            with self.subTest(fill=fill):
                found = self.pieces(mesh, "--fill", fill, pieces=4)

                def over_the_hole(p):
                    return np.hypot(p[:, 0], p[:, 1]) < np.sqrt(1 - rim ** 2) - 2 * voxel if fill == "winding" else np.zeros(len(p), bool)

                def above(p):
                    return over_the_hole(p) & (p[:, 2] > 0)

                self.expect_nearest(found, vertices, kept, nowhere=above)
                flat = [(at[c].mean(axis=0), s) for at, own in found for c, n, s in own if not n]
                closed = [p for p, s in flat if s == NONE]
                self.assertGreater(len(closed), 20)
                for p, s in flat:
                    if p[2] < rim - 2 * voxel and np.linalg.norm(p) > 1 - voxel:
                        self.assertNotEqual(s, NONE)

    def test_a_shell_and_the_intact_solid(self):
        vertices, faces = sphere(12, 20)
        half = [f for f in faces if max(vertices[i][2] for i in f) < 0.1]
        mesh = self.path("bowl.obj")
        with open(mesh, "w") as out:
            out.writelines("v %r %r %r\n" % tuple(v) for v in vertices)
            out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in half)
        found = self.pieces(mesh, "--fill", "shell", "--write", "mesh,solid")
        found.append(read_ply(os.path.join(self.out, "meshes", "bowl.ply")))
        for _, own in found:
            for _, neighbor, source in own:
                self.assertEqual(source == NONE, neighbor != 0)

    # --- what does not have it

    def test_without_it_all_else_is_the_same(self):
        options = ("--surface", "smooth", "--write", "mesh,labels", "--mesh-format", "ply,obj")
        self.done(*options)
        self.done(*options, "--source-faces", out=self.path("with"))
        self.done(*options, "--source-faces", out=self.path("again"))
        without, with_it = tree(self.out), tree(self.path("with"))
        self.assertEqual(with_it, tree(self.path("again")))
        differ = {name for name in without if without[name] != with_it[name]}
        self.assertEqual(differ, {"manifest.json", *(f"meshes/ball_00{i}.ply" for i in (1, 2, 3))})
        for i in (1, 2, 3):
            with open(os.path.join(self.out, "meshes", f"ball_00{i}.ply"), "rb") as file:
                head, body = file.read().split(b"end_header\n", 1)
            self.assertNotIn(b"source_face", head)
            count = [int(line.split()[2]) for line in head.splitlines() if line.startswith(b"element")]
            at, own = read_ply(os.path.join(self.path("with"), "meshes", f"ball_00{i}.ply"))
            rows = np.frombuffer(body, [("n", "u1"), ("at", "<i4", 3), ("neighbor", "<i4")], count[1], 28 * count[0])
            self.assertTrue((rows["at"] == [c for c, _, _ in own]).all())

    def test_where_it_does_nothing(self):
        for options in (["--mesh-format", "obj"], ["--plain-meshes"], ["--write", "labels"]):
            with self.subTest(options=options):
                result = self.done("--source-faces", *options)
                self.assertRegex(result.stderr, r"sherd: warning: --source-faces does nothing")
        volume = self.path("block.npy")
        np.save(volume, np.ones((9, 9, 9), np.uint16))
        result = self.done("--source-faces", "--write", "mesh", mesh=volume)
        self.assertIn("--source-faces does nothing with a volume", result.stderr)
        with open(os.path.join(self.out, "meshes", "block_001.ply"), "rb") as file:
            self.assertNotIn(b"source_face", file.read(1000))

    def test_fragments_broken_again_are_refused(self):
        self.done()
        before = tree(self.out)
        result = self.run_sherd("fracture", os.path.join(self.out, "manifest.json"), "-o", self.path("again"), "--only", "1", "--source-faces")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("--source-faces", result.stderr)
        self.assertEqual(tree(self.out), before)

    def test_a_dataset(self):
        library = self.path("library")
        os.mkdir(library)
        vertices, faces = sphere(10, 16)
        with open(os.path.join(library, "ball.obj"), "w") as out:
            out.writelines("v %r %r %r\n" % tuple(v) for v in vertices)
            out.writelines("f %d %d %d\n" % tuple(i + 1 for i in t) for t in faces)
        result = self.run_sherd("dataset", library, "-o", self.out, "--resolution", "32", "--pieces", "3..3", "--repeats", "1..1", "--write", "mesh",
                                "--precision", "double", "--source-faces")
        self.assertEqual(result.returncode, 0, result.stderr)
        meshes = [os.path.join(at, name) for at, _, names in os.walk(self.out) for name in names if name.endswith(".ply")]
        self.assertEqual(len(meshes), 4)  # and the intact one
        self.expect_nearest([read_ply(m) for m in meshes], vertices, faces)


def faces_without_numbers(faces, dropped):
    """The faces, with one of no area in the place of those that are dropped."""
    return [(0, 0, 0) if i in dropped else f for i, f in enumerate(faces)]


if __name__ == "__main__":
    unittest.main()
