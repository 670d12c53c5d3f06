#!/usr/bin/python3
"""`sherd fracture --material`: the same as its options in docs/materials.md, and what overrides it.

Environment: SHERD_BIN the program.
"""
import json
import os
import re
import unittest

from cli_test import CommandLine, tree
from documents_test import ROOT

NAMES = ("ceramic", "stone", "glass", "tempered", "plaster", "wood", "concrete", "ice")


def documented():
    """The options of each material, by the table of its page."""
    page = (ROOT / "docs/materials.md").read_text()
    return {name: options.split() for name, options in re.findall(r"^\| `(\w+)` \| `(--[^`]+)` \|$", page, re.M)}


class Materials(CommandLine):
    def broke(self, *options, pieces="4"):
        out = self.path(f"out{len(os.listdir(self.tmp))}")
        result = self.run_sherd("fracture", self.ball, "-o", out, "--resolution", "48", "--pieces", pieces, "--write", "labels", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        with open(os.path.join(out, "manifest.json")) as file:
            return tree(out)["labels.rle"], json.load(file)["options"]

    def test_each_is_the_same_as_its_options(self):
        options = documented()
        self.assertEqual(tuple(options), NAMES)
        seen = set()
        for name, same in options.items():
            with self.subTest(material=name):
                labels, recorded = self.broke("--material", name)
                self.assertEqual(recorded.pop("material"), name)
                self.assertEqual((labels, recorded), self.broke(*same))
                seen.add(json.dumps(recorded["grow"], sort_keys=True) + labels)
        self.assertEqual(len(seen), len(NAMES))

    def test_none_changes_nothing(self):
        labels, recorded = self.broke("--material", "none")
        self.assertNotIn("material", recorded)
        self.assertEqual((labels, recorded), self.broke())

    def test_options_that_are_given_override_it_wherever_they_stand(self):
        given = ("--roughness", "2", "--growth", "flood", "--erode-iterations", "0", "--grain", "none")
        for name in ("plaster", "wood"):
            before, after = self.broke(*given, "--material", name), self.broke("--material", name, *given)
            self.assertEqual(before, after)
            grow = before[1]["grow"]
            self.assertEqual((grow["growth"], grow["roughness"], grow["hurst"], before[1]["erode"]["iterations"]), ("flood", 2, 0.8, 0))
            self.assertNotIn("grain", grow)
            self.assertEqual(grow.get("propagation_hurst"), 1 if name == "wood" else None)

    def test_it_overrides_a_preset_in_what_both_set(self):
        for order in (("--preset", "paper", "--material", "stone"), ("--material", "stone", "--preset", "paper")):
            _, options = self.broke(*order)
            self.assertEqual((options["grow"]["growth"], options["grow"]["roughness"]), ("sequential", "1%"))
            self.assertEqual((options["surface"]["of"], options["material"]), ("labels", "stone"))

    def test_options_of_a_file_override_it(self):
        config = self.path("options.toml")
        with open(config, "w") as file:
            file.write('material = "stone"\nroughness = "1,0.5"\n')
        self.assertEqual(self.broke("--config", config), self.broke("--material", "stone", "--roughness", "1,0.5"))

    def test_one_piece_and_few_voxels(self):
        for name in NAMES:
            with self.subTest(material=name):
                self.broke("--material", name, pieces="1")
                out = self.path("small" + name)
                result = self.run_sherd("fracture", self.ball, "-o", out, "--resolution", "8", "--pieces", "3", "--material", name, "--write", "labels,mesh")
                self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_dataset_draws_no_material(self):
        folder = self.path("meshes")
        os.mkdir(folder)
        os.symlink(self.ball, os.path.join(folder, "ball.obj"))
        command = ("dataset", folder, "-o", self.path("set"), "--resolution", "24", "--pieces", "2..2", "--repeats", "2..2", "--write", "labels")
        result = self.run_sherd(*command, "--material", "stone|wood")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("--material", result.stderr)
        result = self.run_sherd(*command, "--material", "stone", "--erode-iterations", "0..2")
        self.assertEqual(result.returncode, 0, result.stderr)
        again = self.run_sherd(*command, "--material", "stone", "--erode-iterations", "0..2", "--resume")
        self.assertEqual(again.returncode, 0, again.stderr)
        other = self.run_sherd(*command, "--material", "stone", "--erode-iterations", "0..2", "--roughness", "0", "--resume")
        self.assertEqual(other.returncode, 2, other.stderr)


if __name__ == "__main__":
    unittest.main()
