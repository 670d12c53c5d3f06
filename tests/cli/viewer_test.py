#!/usr/bin/python3
"""`sherd view` and `--write viewer`: the page holds the fracture's meshes and figures, and nothing leads out of it.

tests/long/viewer.py opens pages in a browser.  Environment: SHERD_BIN the program, SHERD_DATA the folder with amphora.ply.
"""
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest

import numpy as np

from appearance_test import PICTURE
from cli_test import SHERD, CommandLine, joined, sphere, tree, write_obj
from ply_file import read_triangles
from viewer_page import Page, checksum, open_edges

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")
HOSTILE = "<img src=x onerror=alert(1)><!--<script>\"'&amp;{{script}}.obj"


class Viewer(CommandLine):
    def viewed(self, *arguments, folder=None, status=0):
        page = self.path("page.html")
        result = self.run_sherd("view", folder or self.out, "-o", page, *arguments)
        self.assertEqual((result.returncode, result.stdout), (0, page + "\n"), result.stderr)
        self.said = result.stderr
        return Page(page)

    def mesh_of(self, id):
        return read_triangles(os.path.join(self.out, self.manifest()["fragments"][id - 1]["files"]["mesh"]))

    def both(self, *arguments, **more):
        """The page written with a fracture, and that of `sherd view`."""
        self.done("--write", "mesh,viewer", *arguments, **more)
        return Page(os.path.join(self.out, "viewer.html")), self.viewed()


class Meshes(Viewer):
    def test_positions_are_half_a_step_of_the_mesh_at_most(self):
        for page in self.both(pieces=6):
            self.assertEqual(len(page.pieces), 6)
            box = np.array(page.scene["size"])
            self.assertAlmostEqual(page.scene["step"], box.max() / 65535, delta=1e-9 * box.max())
            for id, piece in page.pieces.items():
                vertices, triangles, neighbor = self.mesh_of(id)
                # In order of the neighbor, and of the file among those of one: the page's order of triangles.
                order = np.argsort(neighbor, kind="stable")
                self.assertEqual(len(piece.triangles), len(triangles))
                own = piece.positions[piece.triangles]
                # A .ply has single precision, so its vertices are up to an ulp of the coordinates off.
                np.testing.assert_array_less(np.abs(own - vertices[triangles[order]]), page.scene["step"] / 2 + 2e-7 * np.abs(vertices).max())
                np.testing.assert_array_equal(piece.neighbor, neighbor[order])

    def test_closed_meshes_stay_closed_and_neighbors_joined(self):
        for page in self.both("--roughness", "1", pieces=9):
            self.assertEqual({open_edges(piece) for piece in page.pieces.values()}, {0})
            corners = {id: {tuple(c) for c in piece.grid[piece.triangles[piece.neighbor > 0]].reshape(-1, 3)} for id, piece in page.pieces.items()}
            for id, piece in page.pieces.items():
                for other in set(piece.neighbor) - {0}:
                    shared = {tuple(c) for c in piece.grid[piece.triangles[piece.neighbor == other]].reshape(-1, 3)}
                    self.assertLessEqual(shared, corners[other])

    def test_normals_point_out_of_their_faces(self):
        for page in self.both(pieces=4):
            for piece in page.pieces.values():
                np.testing.assert_allclose(np.linalg.norm(piece.normals, axis=1), 1, atol=1e-12)
                a, b, c = (piece.positions[piece.triangles[:, k]] for k in range(3))
                face = np.cross(b - a, c - a)
                size = np.linalg.norm(face, axis=1)
                big = size > 0.2 * np.median(size)
                agree = np.einsum("ij,ij->i", face[big] / size[big, None], piece.normals[piece.triangles[big, 0]])
                self.assertGreater(np.quantile(agree, 0.01), 0.5)
                # On the ball's own surface normals are those of the ball.
                outer = np.unique(piece.triangles[piece.neighbor == 0])
                radial = piece.positions[outer] / np.linalg.norm(piece.positions[outer], axis=1)[:, None]
                self.assertGreater(np.median(np.einsum("ij,ij->i", radial, piece.normals[outer])), 0.99)

    def test_lines_are_where_neighbors_change(self):
        for page in self.both(pieces=5):
            for piece in page.pieces.values():
                _, vertex = np.unique(piece.grid, axis=0, return_inverse=True)
                vertex, around = vertex.reshape(-1), {}
                for triangle, neighbor in zip(vertex[piece.triangles], piece.neighbor):
                    for k in range(3):
                        around.setdefault(frozenset((triangle[k], triangle[(k + 1) % 3])), set()).add(neighbor)
                expected = {edge for edge, neighbors in around.items() if len(neighbors) > 1}
                lines = {frozenset(pair) for pair in vertex[piece.lines].tolist() if pair[0] != pair[1]}
                self.assertEqual(lines, expected)
                self.assertGreater(len(lines), 10)

    def test_a_piece_of_more_corners_than_two_bytes_count(self):
        done = self.run_sherd("fracture", AMPHORA, "-o", self.out, "--pieces", "2", "--resolution", "330", "--write", "mesh",
                              "--surface", "smooth")
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.viewed()
        self.assertGreater(max(piece["vertices"] for piece in page.scene["pieces"]), 65536)
        self.assertEqual({open_edges(piece) for piece in page.pieces.values()}, {0})

    def test_textures_and_colors_arrive(self):
        mtl, texture = self.path("ball.mtl", b"newmtl skin\nmap_Kd skin.png\n"), self.path("skin.png", PICTURE)
        vertices, faces = sphere(rows=12, columns=24)
        lines = ["mtllib ball.mtl", "usemtl skin"] + ["v %r %r %r" % tuple(v) for v in vertices]
        lines += ["vt %r %r" % (0.5 + v[0] / 2, 0.5 + v[1] / 2) for v in vertices]
        lines += ["f " + " ".join("%d/%d" % (i + 1, i + 1) for i in face) for face in faces]
        mesh = self.path("ball.obj", "\n".join(lines).encode() + b"\n")
        for page in self.both(mesh=mesh, pieces=3):
            self.assertEqual(page.textures, [PICTURE])
            self.assertEqual(page.scene["textures"], ["image/png"])
            inside = [m["inside"] for m in page.scene["materials"]]
            self.assertEqual(inside.count(True), 1)
            for piece in page.pieces.values():
                outer = piece.neighbor == 0
                self.assertEqual({page.scene["materials"][m]["texture"] for m in piece.material[outer]}, {0})
                self.assertTrue(all(inside[m] for m in piece.material[~outer]))
                at = np.unique(piece.triangles[outer])
                # The texture lies on the ball by its x and y; the surface is up to a voxel from the mesh.
                np.testing.assert_allclose(piece.texcoords[at], 0.5 + piece.positions[at, :2] / 2, atol=0.05)
        self.assertTrue(os.path.exists(mtl) and os.path.exists(texture))

    def test_missing_pieces_are_ghosts(self):
        for page, isWhole in zip(self.both("--missing", "2", pieces=8), (True, False)):
            missing = [piece for piece in page.scene["pieces"] if piece.get("missing")]
            self.assertEqual([piece["id"] for piece in missing], [7, 8])
            for piece in missing:
                mesh = page.pieces[piece["id"]]
                self.assertGreater(len(mesh.triangles), 0)
                if isWhole:
                    self.assertEqual(open_edges(mesh), 0)
                    continue
                # From the files only the faces of neighbors towards it are known: seen from its side.
                seen = {tuple(map(tuple, np.sort(t, axis=0))) for t in mesh.grid[mesh.triangles].tolist()}
                towards = {tuple(map(tuple, np.sort(t, axis=0))) for other in page.pieces.values()
                           for t in other.grid[other.triangles[other.neighbor == piece["id"]]].tolist()}
                self.assertEqual(seen, towards)

    def test_level_sets_are_meshed(self):
        self.done("--write", "vdb", pieces=4)
        page = self.viewed()
        for piece, own in zip(page.scene["pieces"], self.manifest()["fragments"]):
            mesh = page.pieces[piece["id"]]
            self.assertEqual(open_edges(mesh), 0)
            a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
            self.assertAlmostEqual(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6, own["volume"], delta=0.1 * own["volume"])


class Figures(Viewer):
    def test_figures_are_the_manifests(self):
        for page in self.both("--missing", "1", pieces=7):
            manifest = self.manifest()
            self.assertEqual(page.scene["title"], manifest["source"]["file"])
            for piece, own in zip(page.scene["pieces"], manifest["fragments"] + manifest["withheld"], strict=True):
                for key in ("id", "voxels", "volume", "share", "area", "fracture_area", "centroid", "inertia"):
                    self.assertEqual(piece[key], own[key], key)
                self.assertEqual(piece["contacts"], [[c["id"], c["area"]] for c in sorted(own["contacts"] + own.get("thin_contacts", []), key=lambda c: c["id"])])
            self.assertEqual(page.scene["pieces"][0].get("missing"), None)

    def test_splits_are_the_manifests(self):
        for page in self.both("--growth", "sequential", pieces=7):
            manifest = self.manifest()
            self.assertEqual(page.scene["splits"], [split["parent"] for split in manifest["splits"]])
            self.assertEqual([piece["split"] for piece in page.scene["pieces"]], [f["split"] for f in manifest["fragments"]])

    def test_unit_axis_and_density(self):
        self.done("--write", "mesh,viewer", "--up", "z")
        written = Page(os.path.join(self.out, "viewer.html")).scene
        self.assertEqual((written["unit"], written["up"], written["density"]), ("m", "z", 1000))
        scene = self.viewed("--unit", "mm", "--up", "x").scene
        self.assertEqual((scene["unit"], scene["up"]), ("mm", "x"))
        self.assertEqual(self.viewed().scene["up"], "z")

    def test_figures_that_are_no_numbers_are_left_out(self):
        self.done("--write", "mesh")
        manifest = self.manifest()
        manifest["fragments"][0].update(inertia="none", centroid=[1, "two", 3])
        manifest["fragments"][1]["contacts"] = [7, {"id": "x"}, {"id": 1}]
        manifest["withheld"] = ["a word", {"id": 4, "area": None}]
        with open(os.path.join(self.out, "manifest.json"), "w") as file:
            json.dump(manifest, file)
        scene = self.viewed().scene
        self.assertEqual(scene["pieces"][0]["inertia"], [None] * 6)
        self.assertEqual(scene["pieces"][1]["contacts"], [[1, None]])
        self.assertEqual([piece["id"] for piece in scene["pieces"]], [1, 2, 3, 4])


class Safe(Viewer):
    def closed_page(self, page, title):
        """Nothing of the page leads out, and what it runs are its own style and program."""
        elements = page.elements
        policy = elements.of("meta", **{"http-equiv": "Content-Security-Policy"})[0][1]["content"]
        rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
        scripts = [e for e in elements.of("script") if "type" not in e[1]]
        styles = elements.of("style")
        self.assertEqual((len(scripts), len(styles)), (1, 1))
        self.assertEqual(rules, {"default-src": "'none'", "script-src": checksum(scripts[0][2]), "style-src": checksum(styles[0][2]),
                                 "base-uri": "'none'", "form-action": "'none'"})
        # What could load something, or run: none of it.
        for tag, attributes, _ in elements.all:
            self.assertNotIn(tag, ("img", "link", "iframe", "object", "embed", "base", "video", "audio"))
            for name in attributes:
                self.assertFalse(name in ("src", "href", "action", "srcset", "style", "background") or name.startswith("on"), (tag, name))
        self.assertEqual(re.findall(r"https?:|@import|url\(|\bfetch\(|XMLHttpRequest|WebSocket|sendBeacon|localStorage|\beval\(|innerHTML", scripts[0][2] + styles[0][2]), [])
        self.assertEqual(elements.of("title")[0][2], title)
        self.assertEqual(elements.of("h1")[0][2], title)
        self.assertEqual(page.scene["title"], title)

    def test_names_do_no_harm(self):
        mesh = self.path(HOSTILE)
        shutil.copy(self.ball, mesh)
        for page in self.both(mesh=mesh):
            self.closed_page(page, HOSTILE)
        # A manifest is untrusted too.
        manifest = self.manifest()
        manifest["source"]["file"] = "a</script><script>alert(1)</script></title><!--\u2028"
        with open(os.path.join(self.out, "manifest.json"), "w") as file:
            json.dump(manifest, file)
        page = self.viewed("--unit", "</script>")
        self.closed_page(page, manifest["source"]["file"])
        self.assertEqual(page.scene["unit"], "</script>")

    def test_the_page_is_small(self):
        self.done("--write", "mesh,viewer", pieces=2)
        page = Page(os.path.join(self.out, "viewer.html"))
        data = sum(len(e[2]) for e in page.elements.of("script") if "type" in e[1])
        self.assertLess(len(page.bytes) - data, 1_000_000)
        self.assertLess(len(page.bytes) - data, 150_000)  # as it is; a library would be seen here

    def test_same_bytes_twice(self):
        first, viewed = (page.bytes for page in self.both(pieces=9))
        self.assertEqual(self.viewed().bytes, viewed)
        again = self.done("--write", "mesh,viewer", "--threads", "1", pieces=9, out=self.path("again"))
        with open(os.path.join(self.path("again"), "viewer.html"), "rb") as file:
            self.assertEqual(file.read(), first, again.stderr)

    def test_a_limit_simplifies_and_says_so(self):
        done = self.run_sherd("fracture", AMPHORA, "-o", self.out, "--pieces", "9", "--resolution", "128", "--write", "mesh")
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = self.viewed()
        self.assertEqual(self.said, "")
        self.assertNotIn("simplified", whole.scene)
        for limit in (1_000_000, 200_000):
            page = self.viewed("--max-size", str(limit))
            self.assertRegex(self.said, r"\Asherd: warning: the meshes are simplified to cells of 1/\d+ of the object[^\n]*\(--max-size\)\n\Z")
            data = sum(len(e[2]) for e in page.elements.of("script", class_="meshes"))
            self.assertLessEqual(data, limit)
            self.assertGreater(data, limit / 3)  # and not much less than it may have
            self.assertEqual({open_edges(piece) for piece in page.pieces.values()}, {0})
            cell = 1.01 * max(whole.scene["size"]) / page.scene["simplified"]
            for id, piece in page.pieces.items():
                for side in (np.min, np.max):  # no vertex moves out of its cell
                    np.testing.assert_allclose(side(piece.positions, axis=0), side(whole.pieces[id].positions, axis=0), atol=cell)

    def break_ball_with(self, name, image):
        texture = self.path(name, image)
        self.path("ball.mtl", f"newmtl skin\nmap_Kd {name}\n".encode())
        vertices, faces = sphere(rows=8, columns=16)
        lines = ["mtllib ball.mtl", "usemtl skin"] + ["v %r %r %r" % tuple(v) for v in vertices] + ["vt 0 0"]
        lines += ["f " + " ".join(f"{i + 1}/1" for i in face) for face in faces]
        self.done("--write", "mesh", mesh=self.path("ball.obj", "\n".join(lines).encode() + b"\n"))
        self.assertTrue(os.path.exists(texture))

    def test_textures_that_fill_the_page_are_left_out(self):
        self.break_ball_with("noise.png", PICTURE + bytes(300_000))
        self.assertEqual(len(self.viewed().textures), 1)
        self.assertEqual(len(self.viewed("--max-size", "500K").textures), 0)
        self.assertIn("textures", self.said)

    def test_textures_that_browsers_do_not_show_are_left_out(self):
        self.break_ball_with("skin.tif", b"II*\0" + bytes(300_000))
        page = self.viewed()
        self.assertEqual((page.textures, page.scene["textures"]), ([], []))
        self.assertEqual({material["texture"] for material in page.scene["materials"]}, {-1})


class Command(Viewer):
    def test_writes_beside_the_folder(self):
        self.done("--write", "mesh")
        before = tree(self.out)
        for given, where, named in (("out", self.tmp, "out.html"), ("out/", self.tmp, "out.html"), (self.out, "/", self.out + ".html"),
                                    (".", self.out, self.out + ".html"), ("out/manifest.json", self.tmp, self.out + ".html")):
            result = self.run_sherd("view", given, cwd=where)
            self.assertEqual((result.returncode, result.stderr), (0, ""), given)
            self.assertEqual(os.path.realpath(os.path.join(where, result.stdout.strip())), os.path.realpath(os.path.join(where, named)), given)
            os.remove(self.out + ".html")
        self.assertEqual(tree(self.out), before)

    def test_the_manifest_lists_the_page(self):
        self.done("--write", "mesh,viewer")
        self.assertEqual(self.manifest()["viewer"], "viewer.html")
        self.assertIn("viewer.html", self.manifest()["files"])
        result = self.run_sherd("view", self.out, "-o", os.path.join(self.out, "viewer.html"))
        self.refused(2, result, "viewer.html", "listed")
        self.done("--write", "labels")  # replaces the fracture, with its page
        self.assertEqual(sorted(tree(self.out)), ["labels.rle", "manifest.json"])

    def test_refuses_what_is_no_fracture(self):
        self.refused(3, self.run_sherd("view", self.path("absent")), "absent")
        os.mkdir(self.path("empty"))
        self.refused(3, self.run_sherd("view", self.path("empty")), "empty", "manifest.json")
        self.refused(3, self.run_sherd("view", self.ball), "ball.obj")
        self.done("--write", "labels")
        self.refused(3, self.run_sherd("view", self.out), "neither meshes nor level sets")
        self.done("--write", "mesh")
        os.remove(os.path.join(self.out, self.manifest()["fragments"][1]["files"]["mesh"]))
        self.refused(3, self.run_sherd("view", self.out), "_002.ply")
        self.refused(2, self.run_sherd("view", self.out, "--max-size", "none"), "--max-size")
        self.refused(2, self.run_sherd("view", self.out, "--unit", 17 * "x"), "--unit")
        self.refused(2, self.run_sherd("view"), "PATH")
        self.assertEqual(os.listdir(self.tmp).count("out.html"), 0)

    def test_a_folder_that_cannot_be_written(self):
        self.done("--write", "mesh")
        self.refused(5, self.run_sherd("view", self.out, "-o", self.path("none/page.html")), "none")
        os.mkdir(self.path("page.html"))
        self.refused(5, self.run_sherd("view", self.out, "-o", self.path("page.html")), "page.html")

    def test_a_full_disk_leaves_the_page_that_was_there(self):
        self.done("--write", "mesh")
        page = self.path("page.html", b"before")

        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

        self.refused(5, self.run_sherd("view", self.out, "-o", page, preexec_fn=small), "page.html")
        with open("/dev/full", "w") as full:
            self.refused(5, self.run_sherd("view", self.out, "-o", page, stdout=full), "standard output")
        with open(page, "rb") as file:
            self.assertEqual(file.read(), b"before")
        self.assertEqual(sorted(os.listdir(self.tmp)), ["out", "page.html"])

    def test_an_interrupt_leaves_nothing(self):
        done = self.run_sherd("fracture", AMPHORA, "-o", self.out, "--pieces", "40", "--resolution", "192", "--write", "mesh")
        self.assertEqual(done.returncode, 0, done.stderr)
        process = subprocess.Popen([SHERD, "view", self.out, "--max-size", "100K"], cwd=self.tmp, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while process.poll() is None:  # until it has worked for a tenth of a second, however busy the machine is
            with open(f"/proc/{process.pid}/stat") as file:
                user, system = map(int, file.read().rsplit(")", 1)[1].split()[11:13])
            if (user + system) / os.sysconf("SC_CLK_TCK") >= 0.1:
                process.send_signal(signal.SIGINT)
                break
            time.sleep(0.005)
        out, said = process.communicate(timeout=60)
        if process.returncode == 0:
            self.skipTest("it was done before the signal came")
        self.assertEqual((process.returncode, out), (130, ""), said)
        self.assertRegex(said, r"\Asherd: interrupted; \S+ is as it was before\n\Z")
        self.assertEqual(os.listdir(self.tmp), ["out"])

    def test_two_at_once_write_a_whole_page(self):
        self.done("--write", "mesh")
        page = self.path("page.html")
        both = [subprocess.Popen([SHERD, "view", self.out, "-o", page], stdout=subprocess.PIPE, stderr=subprocess.PIPE) for _ in range(2)]
        self.assertEqual([p.communicate() and p.returncode for p in both], [0, 0])
        self.assertEqual(Page(page).bytes, self.viewed().bytes)

    def test_needs_no_home(self):
        self.done("--write", "mesh")
        result = self.run_sherd("view", self.out, env={"PATH": "/usr/bin:/bin"}, cwd=self.tmp)
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_opens_only_when_asked(self):
        self.done("--write", "mesh")
        os.mkdir(self.path("bin"))
        opener = self.path("bin/xdg-open", b'#!/bin/sh\necho "$1" >> "$SEEN"\n')
        os.chmod(opener, 0o755)
        seen = self.path("seen")
        environment = {"PATH": self.path("bin") + ":/usr/bin:/bin", "SEEN": seen}
        self.assertEqual(self.run_sherd("view", self.out, env=environment).returncode, 0)
        self.assertFalse(os.path.exists(seen))
        self.assertEqual(self.run_sherd("view", self.out, "--open", env=environment).returncode, 0)
        with open(seen) as file:
            self.assertEqual(file.read(), self.out + ".html\n")
        os.chmod(opener, 0o644)
        result = self.run_sherd("view", self.out, "--open", env={"PATH": self.path("bin")})
        self.assertEqual((result.returncode, result.stderr.count("\n")), (0, 1))
        self.assertIn("xdg-open", result.stderr)

    def test_two_components(self):
        write_obj(self.path("pair.obj"), joined(sphere(), sphere(center=(3, 0, 0))))
        for page in self.both(mesh=self.path("pair.obj"), pieces=5):
            self.assertEqual({open_edges(piece) for piece in page.pieces.values()}, {0})


class Dataset(Viewer):
    def test_the_report_links_to_pages(self):
        library = self.path("library")
        os.makedirs(os.path.join(library, "a b#"))
        for name in ("a b#/50% ball.obj", "ball.obj"):
            shutil.copy(self.ball, os.path.join(library, name))
        plain, linked = self.path("plain"), self.path("linked")
        for out, more in ((plain, ()), (linked, ("--viewers",))):
            result = self.run_sherd("dataset", library, "-o", out, "--resolution", "24", "--pieces", "2..4", "--repeats", "2..1", "--write", "labels", *more)
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertFalse([name for name in tree(plain) if name.endswith(".html") and name != "report.html"])
        from viewer_page import Elements
        from urllib.parse import unquote
        with open(os.path.join(linked, "report.html")) as file:
            links = [unquote(e[1]["href"]) for e in Elements(file.read()).of("a")]
        pages = sorted(name for name in tree(linked) if name.endswith(".html") and name != "report.html")
        self.assertEqual(sorted(links), pages)
        self.assertGreaterEqual(len(pages), 4)
        for name in pages:
            page = Page(os.path.join(linked, name))
            pieces = int(re.search(r"\.(\d+)f_\d+\.html$", name).group(1))
            self.assertEqual({open_edges(piece) for piece in page.pieces.values()}, {0})
            self.assertEqual(len(page.pieces), pieces)
        # The pages are no part of the dataset.
        with open(os.path.join(plain, "index.csv")) as a, open(os.path.join(linked, "index.csv")) as b:
            self.assertEqual(a.read(), b.read())


if __name__ == "__main__":
    unittest.main()
