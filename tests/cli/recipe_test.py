#!/usr/bin/python3
"""Recipes of datasets: what they hold, by hashes of this test's own, that they make the same dataset again, and what is refused.

Environment: SHERD_BIN the program.
"""
import hashlib
import json
import os
import shutil

import skipping
from cli_test import CommandLine, joined, sphere, tree, write_obj

OF_THE_RUN = ("journal/", "run", "report.html")
SMALL = ("--resolution", "20", "--pieces", "2..3", "--repeats", "2..1", "--sampler", "uniform|poisson", "--roughness", "0..1")


def dataset(folder):
    return {name: sum for name, sum in tree(folder).items() if not name.startswith(OF_THE_RUN)}


def hashed(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


class Recipe(CommandLine):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.library = os.path.join(cls.data, "library")
        os.makedirs(os.path.join(cls.library, "vases"))
        write_obj(os.path.join(cls.library, "ball.obj"), sphere())
        write_obj(os.path.join(cls.library, "vases", "two.obj"), joined(sphere(), sphere(center=(1.5, 0, 0), radius=0.8)))
        with open(os.path.join(cls.library, "vases", "bad.obj"), "w") as file:
            file.write("v 0 0 0\nf 1 2 3\n")

    def run_dataset(self, *arguments, out=None, library=None):
        return self.run_sherd("dataset", library or self.library, "-o", out or self.out, *arguments)

    def made(self, *arguments, out=None):
        run = self.run_dataset(*SMALL, *arguments, out=out)
        self.assertEqual(run.returncode, 0, run.stderr)
        with open(os.path.join(out or self.out, "recipe.json")) as file:
            return json.load(file)

    def again(self, recipe, *arguments, out=None, library=None):
        return self.run_dataset("--recipe", recipe, *arguments, out=out or self.path("again"), library=library)

    def changed(self, change):
        """The path of a recipe of `self.out` with a change."""
        with open(os.path.join(self.out, "recipe.json")) as file:
            recipe = json.load(file)
        change(recipe)
        with open(self.path("changed.json"), "w") as file:
            json.dump(recipe, file)
        return self.path("changed.json")

    def test_it_lists_meshes_licenses_and_what_came_out(self):
        licenses = self.path("licenses.tsv")
        with open(licenses, "w") as file:
            file.write("# made for the test\nvases/*\tCC-BY-4.0\r\nball.obj\tCC0-1.0\n*\tunknown\n")
        recipe = self.made("--licenses", licenses)
        self.assertEqual([m["object"] for m in recipe["meshes"]], ["ball.obj", "vases/bad.obj", "vases/two.obj"])
        self.assertEqual([m["license"] for m in recipe["meshes"]], ["CC0-1.0", "CC-BY-4.0", "CC-BY-4.0"])
        for mesh in recipe["meshes"]:
            self.assertEqual(mesh["sha256"], hashed(os.path.join(self.library, mesh["object"])))
        self.assertEqual([o["object"] for o in recipe["objects"]], ["ball.obj", "vases/two.obj"])
        self.assertLess(os.path.getsize(os.path.join(self.out, "recipe.json")), 1200)
        for made in recipe["objects"]:
            everything, folder = "", os.path.join("objects", made["object"][:-len(".obj")])
            for fracture, digest in zip(("whole", "2f_0", "2f_1", "3f_0"), made["fractures"], strict=True):
                at = os.path.join(self.out, folder, fracture)
                names = sorted(os.path.relpath(os.path.join(top, name), self.out) for top, _, files in os.walk(at) for name in files)
                lines = "".join(f"{hashed(os.path.join(self.out, name))}  {name}\n" for name in names)
                self.assertEqual(hashlib.sha256(lines.encode()).hexdigest()[:8], digest, (fracture, names))
                everything += lines
            self.assertEqual(hashlib.sha256(everything.encode()).hexdigest(), made["sha256"])

    def licenses(self, text):
        with open(self.path("licenses"), "w", encoding="utf-8", newline="") as file:
            file.write(text)
        return "--licenses", self.path("licenses")

    def stated(self, recipe):
        return [m.get("license") for m in recipe["meshes"]]

    def test_the_first_pattern_goes_before_others_and_a_path_before_all(self):
        self.assertEqual(self.stated(self.made(*self.licenses("*\tany\nvases/*\tvase\nball.obj\tball\n"))), ["ball", "any", "any"])
        recipe = self.made(*self.licenses("\ufeffvases/t*\tfirst\nvases/*\tsecond\nb*\tthird\n*\tlast"), "--replace")
        self.assertEqual(self.stated(recipe), ["third", "second", "first"])

    def test_licenses_without_a_mesh_are_named(self):
        text = self.licenses("balls.obj\tx\nvases/*\ty\n*.stl\tz\nvases/two.obj\ty\n")
        for more in (("--match", "b*"), ("--dry-run",)):
            run = self.run_dataset(*SMALL, *text, *more)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn("licenses: 2 of 4 licenses match no mesh, the first is of balls.obj", run.stderr)
        run = self.run_dataset(*SMALL, *self.licenses("*\tx\n*o*\ty\n"), "--dry-run")
        self.assertNotIn("match no mesh", run.stderr)

    def test_a_run_without_licenses_keeps_those_of_the_dataset(self):
        files = ("dataset.json", "recipe.json")
        self.made(*self.licenses("vases/*\tCC-BY-4.0\n"))
        before = [hashed(os.path.join(self.out, name)) for name in files]
        self.assertEqual(self.stated(self.made("--resume")), [None, "CC-BY-4.0", "CC-BY-4.0"])
        self.assertEqual([hashed(os.path.join(self.out, name)) for name in files], before)
        self.assertEqual(self.stated(self.made("--resume", *self.licenses("ball.obj\tCC0-1.0\n"))), ["CC0-1.0", None, None])

    def test_shards_without_licenses_keep_those_of_the_first(self):
        for i, more in ((1, self.licenses("*\tCC0-1.0\n")), (2, ("--resume",))):
            run = self.run_dataset(*SMALL, "--shard", f"{i}/2", *more)
            self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.run_sherd("merge", self.out).returncode, 0)
        with open(os.path.join(self.out, "recipe.json")) as file:
            self.assertEqual(self.stated(json.load(file)), ["CC0-1.0"] * 3)

    def test_it_makes_the_same_dataset_again_in_every_layout(self):
        for layout in ("sherd", "packed", "paper", "bb", "pfpp"):
            with self.subTest(layout):
                out, again = self.path(layout), self.path(f"{layout} again")
                self.made("--layout", layout, "--preset", "training", out=out)
                shutil.copytree(self.library, self.path(f"{layout} library"))
                write_obj(self.path(f"{layout} library/vases/another.obj"), sphere(radius=3))
                run = self.again(os.path.join(out, "recipe.json"), out=again, library=self.path(f"{layout} library"))
                self.assertEqual(run.returncode, 0, run.stderr)
                self.assertEqual(dataset(again), dataset(out))

    def test_shards_make_the_same_and_may_be_resumed(self):
        self.made()
        recipe = os.path.join(self.out, "recipe.json")
        for i in (1, 2, 1):
            run = self.again(recipe, "--shard", f"{i}/2", *(["--resume"] if os.path.exists(self.path("again")) else []))
            self.assertEqual(run.returncode, 0, run.stderr)
        merged = self.run_sherd("merge", self.path("again"))
        self.assertEqual(merged.returncode, 0, merged.stderr)
        self.assertEqual(dataset(self.path("again")), dataset(self.out))

    def test_other_files_are_named(self):
        self.made()

        def other_hash(recipe):
            recipe["objects"][1]["sha256"] = "0" * 64
            recipe["objects"][1]["fractures"][2] = "0" * 8

        run = self.again(self.changed(other_hash))
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("vases/two.obj: 1 of 4 fractures", run.stderr)
        self.assertIn("1 of 3 meshes gave other files than the recipe's", run.stderr)
        self.assertNotIn("sherd 0.0.1", run.stderr)

        def other_version(recipe):
            other_hash(recipe)
            recipe["program"] = "0.0.1"

        run = self.again(self.changed(other_version), "--replace")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("it was made by sherd 0.0.1", run.stderr)
        run = self.again(self.changed(lambda r: r["objects"].pop(0)), "--replace")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("ball.obj: could be broken, and could not in the recipe's dataset", run.stderr)

    def test_other_files_do_not_replace_a_dataset(self):
        self.made()
        recipe = self.changed(lambda r: r["objects"][0].update(sha256="0" * 64, fractures=["0" * 8] * 4))
        again = self.path("again")
        self.assertEqual(self.run_dataset("--resolution", "16", "--pieces", "2", out=again).returncode, 0)
        before = tree(again)
        run = self.again(recipe, "--replace", "--verify")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("1 of 3 meshes gave other files than the recipe's, so " + again + " keeps its dataset", run.stderr)
        self.assertIn("files are whole", run.stdout)
        self.assertEqual({name: sum for name, sum in tree(again).items() if not name.startswith(".sherd-replacing")}, before)
        self.assertEqual(self.run_sherd("merge", again).returncode, 0)
        self.assertEqual(dataset(again), dataset(self.out))

    def test_other_files_are_verified_too(self):
        self.made()
        recipe = self.changed(lambda r: r["objects"][0].update(sha256="0" * 64))
        run = self.again(recipe, "--verify")
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("files are whole", run.stdout)
        self.assertIn("1 of 3 meshes gave other files than the recipe's", run.stderr)

    def test_other_meshes_are_refused_before_anything_is_made(self):
        self.made()
        recipe = os.path.join(self.out, "recipe.json")
        library = self.path("library")
        shutil.copytree(self.library, library)
        write_obj(os.path.join(library, "ball.obj"), sphere(radius=1.01))
        run = self.again(recipe, library=library)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("ball.obj: is another file than that of the recipe", run.stderr)
        run = self.again(recipe, "--dry-run", library=library)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("ball.obj: is another file than that of the recipe", run.stderr)
        os.remove(os.path.join(library, "ball.obj"))
        run = self.again(recipe, library=library)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("lacks 1 of 3 meshes, the first is ball.obj", run.stderr)
        self.assertFalse(os.path.exists(self.path("again")))

    def test_options_of_the_dataset_are_refused(self):
        self.made()
        recipe = os.path.join(self.out, "recipe.json")
        for option in (("--pieces", "3"), ("--seed", "1"), ("--preset", "training"), ("--match", "b*"), ("--layout", "bb"), ("--licenses", recipe)):
            run = self.again(recipe, *option)
            self.assertEqual(run.returncode, 2, (option, run.stderr))
            self.assertIn(f"{option[0]} can't be given with --recipe", run.stderr)
        self.assertEqual(self.again(recipe, "--threads", "1", "--verify", "--strict").returncode, 3)  # vases/bad.obj, as before
        self.assertEqual(self.again(recipe, "--threads", "1", "--replace").returncode, 0)

    def test_assemblages_have_none(self):
        run = self.run_sherd("assemblage", self.library, "-o", self.out, "--objects", "2..2", "--resolution", "20", "--pieces", "2..2", "--match", "*o*")
        self.assertFalse(os.path.exists(os.path.join(self.out, "recipe.json")), run.stderr)

        for option in ("--recipe", "--licenses"):
            run = self.run_sherd("assemblage", self.library, "-o", self.path("refused"), option, "/dev/null")
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(option, run.stderr)
            self.assertFalse(os.path.exists(self.path("refused")))
        run = self.run_dataset("--objects", "2..2", "--resolution", "20", "--match", "*o*", *self.licenses("*\tCC0-1.0\n"), "--dry-run")
        self.assertIn("--licenses does nothing with --objects", run.stderr)

    def test_a_recipe_of_many_meshes_is_read(self):
        self.made()
        large = self.path("large.json")
        with open(os.path.join(self.out, "recipe.json")) as file, open(large, "w") as out:
            out.write(file.read() + " " * (65 << 20))
        run = self.again(large, "--dry-run")
        self.assertEqual(run.returncode, 0, run.stderr)

    def test_a_damaged_recipe_is_a_sentence(self):
        self.made()
        with open(os.path.join(self.out, "recipe.json")) as file:
            text = file.read()
        kinds = (None, 7, -1.5, True, "x", [], {}, [7], [{}], "../../etc")
        damaged = [text[:len(text) * k // 12] for k in range(12)] + ["[" * 100000, "\0", '{"schema": "sherd-recipe/2"}']
        recipe = json.loads(text)
        for key in recipe:
            if key == "program":
                continue
            damaged += [json.dumps({**recipe, key: kind}) for kind in kinds if not (key == "drawn" and kind == []) and not (key == "objects" and kind == [])]
        for key in ("meshes", "objects"):
            first = recipe[key][0]
            for field in first:
                damaged += [json.dumps({**recipe, key: [{**first, field: kind}, *recipe[key][1:]]}) for kind in kinds
                            if not (field == "fractures" and kind == []) and (field, kind) != ("object", "x")]
            damaged.append(json.dumps({**recipe, key: [first, first]}))
        damaged.append(json.dumps({**recipe, "options": "--pieces=2..3 --no-such-option=7"}))
        for i, content in enumerate(damaged):
            with open(self.path("damaged.json"), "w") as file:
                file.write(content)
            run = self.again(self.path("damaged.json"), out=self.path(f"damaged {i}"))
            self.assertIn(run.returncode, (2, 3), (content[:300], run.stderr))
            self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
        for path in (self.path("none.json"), self.library, "/dev/zero", "/dev/null"):
            run = self.again(path)
            self.assertEqual(run.returncode, 3, run.stderr)

    def test_damaged_licenses_are_a_sentence(self):
        for content in ("ball.obj CC0", "\tCC0", "ball.obj\t", "ball.obj\tCC0\nvases"):
            with open(self.path("licenses"), "w") as file:
                file.write(content)
            run = self.run_dataset(*SMALL, "--licenses", self.path("licenses"))
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn("has no license; a line is", run.stderr)
        run = self.run_dataset(*SMALL, *self.licenses("a\tx\n*\tx\n# a\n*\tx\n"))
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("licenses:4: * has a license in an earlier line", run.stderr)
        for path in (self.path("none"), self.library, "/dev/zero"):
            self.assertEqual(self.run_dataset(*SMALL, "--licenses", path).returncode, 3)


if __name__ == "__main__":
    skipping.main()
