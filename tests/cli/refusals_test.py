#!/usr/bin/python3
"""Options, sizes, files of options and outputs that cannot be what was meant: each is refused, or warned of, by name.

Environment: SHERD_BIN the program.
"""
import os
import unittest

from cli_test import CommandLine, sphere, tree, write_obj


class Outputs(CommandLine):
    def test_a_file_of_a_fracture_is_not_replaced(self):
        self.done("--write", "labels,mesh,preview,vdb", "--voxel-format", "rle,npy")
        os.symlink(self.out, self.path("link"))
        was = tree(self.out)
        mesh = "meshes/ball_001.ply"
        for words, name in ((("evaluate", self.out, "--samples", "20", "--csv"), "manifest.json"),
                            (("evaluate", self.out, "--samples", "20", "--plot"), mesh),
                            (("evaluate", self.out, "--samples", "20", "--csv"), "meshes/../labels.rle"),
                            (("render", self.out, "-o"), "preview.png"),
                            (("render", os.path.join(self.out, mesh), "-o"), "preview.png"),
                            (("convert", os.path.join(self.out, "labels.rle")), "labels.npy"),
                            (("convert", os.path.join(self.out, "labels.npy")), "labels.rle"),
                            (("convert", self.ball), mesh)):
            for folder in self.out, self.path("link"):
                with self.subTest(words=words, name=name):
                    self.refused(2, self.run_sherd(*words, os.path.join(folder, name)), os.path.basename(name), "name another file")
        self.assertEqual(tree(self.out), was)

    def test_what_is_read_is_not_replaced(self):
        for name in "a.obj", "b.obj":
            write_obj(self.path(name), sphere())
        was = tree(self.tmp)
        self.refused(2, self.run_sherd("evaluate", self.tmp, "--samples", "20", "--csv", self.path("b.obj")), "b.obj")
        os.mkdir(self.path("whole"))
        write_obj(self.path("whole/ball.obj"), sphere())
        self.refused(2, self.run_sherd("evaluate", self.tmp, "--mesh", self.path("whole/ball.obj"), "--samples", "20", "--plot",
                                       self.path("whole/ball.obj")), "ball.obj")
        self.assertEqual({n: s for n, s in tree(self.tmp).items() if "whole" not in n}, was)

    def test_other_files_beside_a_fracture_are_written(self):
        self.done("--write", "labels,mesh")
        out = os.path.join(self.out, "meshes", "table.csv")
        result = self.run_sherd("evaluate", self.out, "--samples", "20", "--csv", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        for _ in range(2):
            result = self.run_sherd("convert", os.path.join(self.out, "labels.rle"), os.path.join(self.out, "again.npy"))
            self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
