#!/usr/bin/python3
"""Dataset runs that must not harm anything: names that the dataset needs itself, links, damaged journals, bad folders.

Environment: SHERD_BIN the program; SHERD_SWEEP=N changes N files of each layout.  Needs Debian's python3-numpy.
"""
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import tempfile
import unittest

import skipping
from cli_test import sphere, tree, write_obj
from dataset_test import Dataset, dataset

LAYOUTS = "sherd", "packed", "paper", "bb", "hdf5", "pfpp"
TREES = "sherd", "paper", "bb"  # with a folder for each object
QUICK = ("--pieces", "2", "--repeats", "1", "--write", "labels,mesh", "--points", "0", "--resolution", "16")


def quick(layout):
    return ("--layout", layout, *QUICK) if layout != "pfpp" else ("--layout", "pfpp", *(a if a != "0" else "5" for a in QUICK))


def sealed(lines):
    """Lines of a journal with their checksums, see docs/formats.md."""
    before, text = "", ""
    for line in lines:
        before = hashlib.sha256((before + line[:-1]).encode()).hexdigest()[:16]
        text += f'{line[:-1]},"sum":"{before}"}}\n'
    return text


def unsealed(text):
    return [re.sub(r',"sum":"[0-9a-f]{16}"}$', "}", line) for line in text.splitlines()]


class Safety(Dataset):
    def library_of(self, *names, folder="names"):
        library = self.path(folder)
        for i, name in enumerate(names):
            os.makedirs(os.path.dirname(os.path.join(library, name)), exist_ok=True)
            write_obj(os.path.join(library, name), sphere(8, 16, radius=1 + i / 10))
        return library

    def fresh(self):
        self.out = os.path.join(tempfile.mkdtemp(dir=self.tmp), "out")
        return self.out


class Names(Safety):
    def test_names_that_the_dataset_keeps_for_itself(self):
        names = ("journal.obj", "Index.csv.obj", "index.csv/a.obj", "dataset.json.obj", "report.html.obj", "run_1_of_2.json.obj",
                 "Report.html/ball.obj", "ball.obj", "ball.jsonl/a.obj", "ball.whole.png/a.obj", "ball.2f_0.png/a.obj", "ball.zip/a.obj",
                 "ball.zip.partial/a.obj", "library/ball.obj", "data_split/a.obj", "data_list/a.obj", "library.train.txt/a.obj", "journal_/a.obj",
                 "journal__.obj", "train.txt/a.obj")
        library = self.library_of(*names)
        for layout in LAYOUTS:
            with self.subTest(layout=layout):
                self.fresh()
                arguments = (*quick(layout), "--verify")
                forecast = self.done(*arguments[:-1], "--dry-run", library=library)
                first = self.done(*arguments, library=library)
                warnings = [[line for line in run.stderr.splitlines() if "for itself" in line] for run in (forecast, first)]
                self.assertEqual(*warnings)
                before = dataset(self.out)
                rows = self.rows()
                self.assertEqual({r["object"] for r in rows}, set(names))
                self.assertEqual({r["folder"] for r in rows if r["object"] == "ball.jsonl/a.obj"},
                                 {"objects/ball.jsonl_/a" if layout in ("sherd", "packed") else "ball.jsonl_/a"})
                owners = {}  # of each folder of an object
                for r in rows if layout in TREES else []:
                    for name in r["files"]:
                        below = 3 if layout == "sherd" else 2 if layout == "bb" and r["fracture"] != "whole" else 1
                        owners.setdefault(name.lower().rsplit("/", below)[0], set()).add(r["object"])
                self.assertEqual({folder: own for folder, own in owners.items() if len(own) != 1}, {})
                self.assertEqual(len(owners), len(names) if layout in TREES else 0)
                moved = {r["object"]: r["folder"] for r in rows if "folder" in r}
                self.assertEqual("journal.obj" in moved, layout == "paper")
                for name in moved:  # each is reported, alone or with others
                    self.assertIn("warning: ", first.stderr)
                    self.assertIn("'" + moved[name].removeprefix("objects/").removeprefix("library/").split("/")[0], first.stderr)
                self.done(*arguments, "--resume", library=library)
                self.assertEqual(dataset(self.out), before)
                # All of an object anew leaves the others as they were.
                for journal in ("journal_" if layout == "paper" else "journal") + ".jsonl", "ball.jsonl":
                    os.remove(os.path.join(self.out, "journal", journal))
                self.done(*arguments, "--resume", library=library)
                self.assertEqual(dataset(self.out), before)

    def test_a_library_without_such_names_is_as_it_was(self):
        run = self.done(*QUICK)
        self.assertNotIn("warning", run.stderr)
        with open(os.path.join(self.out, "index.csv")) as file:
            self.assertTrue(file.readline().endswith(",truth_translation\n"))
        self.assertFalse([r for r in self.rows() if "folder" in r])

    def test_a_name_with_its_extension_may_be_another_s_without(self):
        library = self.library_of("a.obj", "a.obj.obj")
        shutil.copy(os.path.join(library, "a.obj"), os.path.join(library, "a.stl"))  # fails, but has its name
        self.done(*QUICK, "--verify", library=library)
        self.assertEqual(sorted(os.listdir(os.path.join(self.out, "objects"))), ["a.obj", "a.obj.obj"])

    def test_library_and_output_lie_apart(self):
        library = self.library_of("a.obj")
        os.symlink(library, self.path("link"))
        inside = os.path.join(library, "out")
        for lib, out in ((library, inside), (library, os.path.join(self.path("link"), "out")), (self.path("link"), inside),
                         (library, library), (library, self.tmp), (library, os.path.join(library, ".hidden"))):
            for more in (), ("--resume",):
                with self.subTest(library=lib, out=out, more=more):
                    self.refused(2, self.dataset(*QUICK, *more, library=lib, out=out), "lib")
        self.assertEqual(list(tree(library)), ["a.obj"])
        os.mkdir(self.path("full"))
        os.rename(os.path.join(library, "a.obj"), os.path.join(self.path("full"), "a.obj"))
        listed = self.path("list.txt", b"full/a.obj\n")
        self.refused(2, self.dataset(*QUICK, library=listed, out=self.path("full")), "a.obj")
        os.rename(os.path.join(self.path("full"), "a.obj"), os.path.join(library, "a.obj"))
        self.refused(2, self.dataset(*QUICK, "--dry-run", library=library, out=inside), "lies in the library")
        os.rename(os.path.join(library, "a.obj"), os.path.join(self.path("full"), "a.obj"))
        # Beside each other, one's name the beginning of the other's, they are apart.
        self.done(*QUICK, library=self.path("full"), out=self.path("full2"))


class Links(Safety):
    def elsewhere(self):
        folder = tempfile.mkdtemp(dir=self.tmp)
        os.mkdir(os.path.join(folder, "sub"))
        for name in "mine.txt", "sub/mine.txt":
            with open(os.path.join(folder, name), "w") as file:
                file.write("mine")
        return folder

    def test_links_in_place_of_the_datasets_own(self):
        folders = {"sherd": ("objects", "objects/ball", "journal", "journal/vases"), "packed": ("objects", "journal"),
                   "paper": ("vases", "ball", "vases/egg"), "bb": ("library", "library/ball", "data_split", "data_list", "journal"),
                   "hdf5": ("parts", "journal"), "pfpp": ("pc_data", "pc_data/vases", "matching_data", "matching_data/library", "journal")}
        files = {"sherd": ("journal/ball.jsonl", "dataset.json", "index.csv", "run.json", "report.html"),
                 "packed": ("objects/ball.zip", "objects/ball.zip.partial"), "paper": ("train.txt",), "bb": ("library.train.txt",),
                 "hdf5": ("fractures.hdf5", "fractures.hdf5.json"), "pfpp": ("train.txt",)}
        for layout in LAYOUTS:
            self.fresh()
            arguments = quick(layout)
            self.done(*arguments)
            for name in folders[layout] + files[layout]:
                with self.subTest(layout=layout, name=name):
                    out = os.path.join(tempfile.mkdtemp(dir=self.tmp), "out")
                    shutil.copytree(self.out, out)
                    foreign = self.elsewhere()
                    place = os.path.join(out, name)
                    if not name.startswith("journal"):
                        os.remove(os.path.join(out, "journal", "ball.jsonl"))
                        os.remove(os.path.join(out, "journal", "vases", "egg.jsonl"))
                    if os.path.isdir(place):
                        shutil.rmtree(place)
                        os.symlink(foreign, place)
                    else:
                        if os.path.exists(place):
                            os.remove(place)
                        os.symlink(os.path.join(foreign, "mine.txt"), place)
                    was = tree(foreign)
                    run = self.dataset(*arguments, "--resume", out=out)
                    self.assertEqual(tree(foreign), was)
                    self.assertIn(run.returncode, (3, 5) if name != "dataset.json" else (2, 3, 5), run.stderr)
                    self.assertIn(os.path.basename(name), run.stderr)
                    self.assertTrue(os.path.islink(place))

    def test_a_run_that_is_refused_for_a_link_writes_nothing(self):
        os.mkdir(self.out)
        os.symlink(self.elsewhere(), os.path.join(self.out, ".sherd-1-1.tmp"))  # anything else is refused before
        os.symlink(self.elsewhere(), os.path.join(self.out, "objects"))
        before = tree(self.out)
        self.refused(5, self.dataset(*QUICK), "objects")
        self.assertEqual(tree(self.out), before)

    def test_links_below_an_object_are_removed_and_not_followed(self):
        self.done(*QUICK)
        before, foreign = dataset(self.out), self.elsewhere()
        was = tree(foreign)
        os.remove(os.path.join(self.out, "journal", "ball.jsonl"))
        os.symlink(foreign, os.path.join(self.out, "objects", "ball", "more"))
        shutil.rmtree(os.path.join(self.out, "objects", "ball", "whole"))
        os.symlink(foreign, os.path.join(self.out, "objects", "ball", "whole"))
        self.done(*QUICK, "--resume")
        self.assertEqual((dataset(self.out), tree(foreign)), (before, was))

    def test_what_is_read_back_lies_below(self):
        self.done(*QUICK)
        secret = self.path("secret.rle", b"secret")
        labels = os.path.join(self.out, "objects/ball/2f_0/labels.rle")
        os.remove(labels)
        os.symlink(secret, labels)
        run = self.dataset(*QUICK, "--resume", "--verify")
        self.assertEqual(run.returncode, 3)
        self.assertIn("labels.rle: is absent, or a symbolic link", run.stderr)
        plan = os.path.join(self.out, "dataset.json")
        with open(plan) as file:
            text = file.read()
        with open(plan, "w") as file:
            file.write(text.replace('"folder": "ball"', '"folder": "../../ball"'))
        self.refused(3, self.run_sherd("merge", self.out), "dataset.json", "../../ball")


class Journals(Safety):
    def test_damaged_ones_are_named_with_the_line(self):
        self.done(*QUICK, "--poses")
        journal = os.path.join(self.out, "journal", "ball.jsonl")
        with open(journal) as file:
            text = file.read()
        lines = unsealed(text)
        self.assertEqual(len(lines), 4)  # the object, whole, a fracture, done
        self.assertEqual(sealed(lines), text)

        def changed(number, change):
            line = json.loads(lines[number])
            change(line)
            return sealed([json.dumps(line) if i == number else text for i, text in enumerate(lines)])

        def put(*keys):
            value = keys[-1]

            def change(line):
                for key in keys[:-2]:
                    line = line[key]
                if value is None:
                    del line[keys[-2]]
                else:
                    line[keys[-2]] = value
            return change

        bad = [(1, "nothing\n"), (1, "\n"), (1, "\0" * 40 + "\n"), (1, sealed(["[1]"])), (1, sealed(['{"a": 1}'])), (1, sealed(["[" * 5000 + "]"])),
               (2, sealed([lines[0], lines[0]])), (1, sealed(lines[1:])), (5, sealed(lines + lines[1:2])),
               (1, sealed(['{"object":"other.obj"' + lines[0][lines[0].index(","):]] + lines[1:]))]
        for keys in (("sha256", "ab"), ("sha256", 3), ("object", 5), ("sha256", None)):
            bad.append((1, changed(0, put(*keys))))
        for key in ("pieces", "repeat", "attempt", "seed", "options", "labels", "fragments", "files", "archive"):
            for value in (None, -1, 1.5, "x", True):
                bad.append((3, changed(2, put(key, value))))
        for key in ("id", "voxels", "share", "volume", "vertices", "faces", "contacts", "files"):
            for value in (None, "x", True, {}):
                bad.append((3, changed(2, put("fragments", 1, key, value))))
        bad += [(3, changed(2, put(*keys))) for keys in (
            ("fracture", "../../x"), ("fracture", "3f_0"), ("fragments", 0, "id", 65535), ("fragments", 0, 7), ("fragments", 0, "withheld", 1),
            ("fragments", 0, "contacts", 0, [1]), ("fragments", 0, "files", 0, "objects/other.ply"), ("files", 0, 0, "../x"), ("files", 0, 0, "/x"),
            ("files", 0, 1, -4), ("files", 0, 2, "AB" * 32), ("files", 0, ["a"]), ("options", {"roughness": 1}), ("labels", 0, "x.rle"),
            ("fragments", 0, "pose", "rotation", [1, 2, 3]), ("fragments", 0, "pose", "center", None), ("fragments", 0, "pose", 3))]
        bad.append((4, changed(3, put("files", [["../x", 1, "ab"]]))))
        for number, text in bad:
            with self.subTest(line=number, text=text[-200:]):
                with open(journal, "w") as file:
                    file.write(text)
                # Of which one may be read on: a journal that is not done is, when the object's turn comes.
                said = ": is the journal of other.obj" if "other.obj" in text else f":{number}: is damaged"
                self.refused(3, self.run_sherd("merge", self.out), "ball.jsonl" + said, "remove the file", "(--resume)")
        self.refused(3, self.dataset(*QUICK, "--poses", "--resume"), "ball.jsonl:4: is damaged")
        verified = self.dataset(*QUICK, "--poses", "--resume", "--verify", "--match", "vases*")
        self.assertEqual(verified.returncode, 0, verified.stderr)
        os.remove(journal)
        self.done(*QUICK, "--poses", "--resume", "--verify")

    def test_a_changed_digit_is_named_and_does_not_reach_the_index(self):
        self.done(*QUICK)
        index = self.file("index.jsonl")
        journal = os.path.join(self.out, "journal", "ball.jsonl")
        with open(journal) as file:
            text = file.read()
        lines = text.splitlines(keepends=True)
        digits = [i for i, c in enumerate(text) if c.isdigit() and text[i - 1] in "0123456789.["]
        changes = [text[:i] + str((int(text[i]) + 1) % 10) + text[i + 1:] for i in random.Random(5).sample(digits, 6)]
        changes += ["".join(lines[:1] + lines[2:]), "".join([lines[0], lines[2], lines[1], lines[3]]), "".join(lines[:2] + lines[1:])]
        for changed in changes:
            with open(journal, "w") as file:
                file.write(changed)
            number = next(i for i, (a, b) in enumerate(zip(lines, changed.splitlines(keepends=True))) if a != b) + 1
            self.refused(3, self.run_sherd("merge", self.out), f"ball.jsonl:{number}: is damaged: does not match its checksum")
            self.assertEqual(self.file("index.jsonl"), index)

    def test_whatever_is_written_is_read(self):
        everything = ("--write", "labels,vdb,mesh,preview,seeds,boundaries,cost,fog,solid,scene,usd,graph,houdini,viewer,proxy", "--voxel-format", "rle,npy,npz",
                      "--points", "20", "--point-format", "ply,xyz", "--sdf-samples", "20", "--correspondences", "5", "--vdb", "both",
                      "--triangles", "100", "--poses", "--missing", "1", "--roughness", "0..1")
        for layout, packing in zip(LAYOUTS, ("none", "zip", "zstd", "none")):
            with self.subTest(layout=layout, packing=packing):
                self.fresh()
                mesh = () if layout == "bb" else ("--mesh-format", "ply,obj,glb,stl")
                arguments = ("--layout", layout, "--compress", packing, "--match", "ball*", "--pieces", "3", "--repeats", "2", *everything, *mesh)
                self.done(*arguments, "--verify")
                self.done(*arguments, "--resume", "--verify")

    def test_one_that_is_cut_off_is_gone_on_with(self):
        self.done(*QUICK)
        before = dataset(self.out)
        journal = os.path.join(self.out, "journal", "ball.jsonl")
        with open(journal, "rb") as file:
            text = file.read()
        for size in (0, 10, text.index(b"\n"), text.index(b"\n") + 1, len(text) - 30, len(text) - 1):
            with open(journal, "wb") as file:
                file.write(text[:size])
            self.done(*QUICK, "--resume")
            self.done(*QUICK, "--resume", "--verify")
            self.assertEqual(dataset(self.out), before)


class Changes(Safety):
    """Whatever is changed in a finished dataset, --verify finds it."""

    def verified(self, *arguments):
        return self.dataset(*arguments, "--match", "ball*", "--resume", "--verify")

    def test_an_archive_is_compared_whole(self):
        self.done(*quick("packed"), "--match", "ball*")
        archive = os.path.join(self.out, "objects", "ball.zip")
        with open(archive, "rb") as file:
            whole = file.read()
        for damage in whole + b"more", whole + whole, b"x" + whole:
            with open(archive, "wb") as file:
                file.write(damage)
            run = self.verified(*quick("packed"))
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn("objects/ball.zip: differs from what was written", run.stderr)
        with open(archive, "wb") as file:
            file.write(whole)
        self.assertEqual(self.verified(*quick("packed")).returncode, 0)

    def test_a_change_of_any_file_is_found(self):
        draw = random.Random(7)
        for layout in LAYOUTS:
            whole, out = self.path("whole_" + layout), self.path("out_" + layout)
            self.out = whole
            self.done(*quick(layout), "--match", "ball*", "--verify")
            self.out = out
            names = [name for name in sorted(tree(whole)) if name[-1] != "/"]
            for _ in range(int(os.environ.get("SHERD_SWEEP", 3))):
                name = draw.choice(names)
                shutil.rmtree(out, ignore_errors=True)
                shutil.copytree(whole, out)
                with open(os.path.join(out, name), "r+b") as file:
                    data = file.read()
                    at, kind = draw.randrange(len(data) or 1), draw.choice(("flip", "append", "cut")) if data else "append"
                    if kind == "flip":
                        file.seek(at)
                        file.write(bytes([data[at] ^ 1 << draw.randrange(8)]))
                    elif kind == "append":
                        file.write(draw.choice((data, b"\0", b"\n")) or b"x")
                    else:
                        file.truncate(at)
                with self.subTest(layout=layout, name=name, kind=kind, at=at):
                    run = self.verified(*quick(layout))
                    found = run.returncode in (2, 3) or "made again" in run.stderr  # an HDF5 file is
                    self.assertTrue(found, run.stdout + run.stderr)

    def test_what_was_written_anew_is_whole_again(self):
        self.done(*QUICK, "--match", "ball*")
        for name in "index.jsonl", "train.txt", "dataset.json", "report.html":
            with open(os.path.join(self.out, name), "ab") as file:
                file.write(b" ")
            run = self.verified(*QUICK)
            self.assertEqual(run.returncode, 3, run.stderr)
            self.assertIn(name + ": differs from what was written", run.stderr)
            self.assertEqual(self.verified(*QUICK).returncode, 0)
        image = next(name for name in sorted(tree(self.out)) if name.endswith(".png"))
        with open(os.path.join(self.out, image), "ab") as file:
            file.write(b" ")
        for _ in range(2):  # images are not written anew
            self.assertIn(image + ": differs", self.verified(*QUICK).stderr)

    def test_sha256sum_reads_the_checksums(self):
        library = self.library_of("a.obj", "b c/d\\e.obj")
        self.done(*quick("bb"), library=library)
        run = subprocess.run(["sha256sum", "--check", "--strict", "--quiet", "journal/SHA256SUMS"], cwd=self.out)
        self.assertEqual(run.returncode, 0)


class Failures(Safety):
    def failures(self):
        with open(os.path.join(self.out, "failures.jsonl")) as lines:
            return {line["object"]: line["reason"] for line in map(json.loads, lines)}

    def test_for_want_of_time_or_memory_they_are_tried_again(self):
        self.done(*QUICK, "--match", "ball*")
        whole = dataset(self.out)
        for short in ("--object-timeout", "0.001"), ("--max-memory", "1M"), ("--max-memory", "100"):
            self.fresh()
            for more in (), ("--resume",):
                run = self.dataset(*QUICK, "--match", "ball*", *short, *more)
                self.assertEqual(run.returncode, 3, run.stderr)
                self.assertIn("(" + short[0] + ")" if "time" in short[0] else short[0], run.stderr)
                self.assertEqual(set(self.failures()), {"ball.obj"})
            self.done(*QUICK, "--match", "ball*", "--resume")
            self.assertEqual(dataset(self.out), whole)

    def test_of_a_bad_mesh_they_stay_until_it_is_another(self):
        library = self.library_of("a.obj", "b.obj")
        bad = os.path.join(library, "c.obj")
        with open(bad, "w") as file:
            file.write("f 1 2 3\n")
        self.done(*QUICK, library=library)
        failed, journal = self.failures(), self.file("journal/c.jsonl")
        self.assertEqual(set(failed), {"c.obj"})
        self.assertNotIn("failed", self.done(*QUICK, "--resume", library=library).stderr)
        self.assertEqual((self.failures(), self.file("journal/c.jsonl")), (failed, journal))
        shutil.copy(os.path.join(library, "a.obj"), bad)
        self.done(*QUICK, "--resume", "--verify", library=library)
        self.assertEqual(self.failures(), {})
        self.assertEqual({row["object"] for row in self.rows()}, {"a.obj", "b.obj", "c.obj"})

    def test_damaged_volumes_among_good_meshes_are_named(self):
        library = self.library_of(*(f"good_{i}.obj" for i in range(10)))
        self.assertEqual(self.run_sherd("fracture", os.path.join(library, "good_0.obj"), "-o", self.path("volume"), "--pieces", "1",
                                        "--resolution", "12", "--write", "solid,vdb").returncode, 0)
        with open(self.path("volume/fragments/good_0.vdb"), "rb") as file:
            volume = file.read()
        for i in range(10):
            with open(os.path.join(library, f"bad_{i}.vdb"), "wb") as file:
                file.write(volume[:i * len(volume) // 10])
        for layout in LAYOUTS:
            with self.subTest(layout=layout):
                self.fresh()
                for more in (), ("--resume", "--verify"):
                    self.done(*quick(layout), *more, library=library)
                    self.assertEqual(set(self.failures()), {f"bad_{i}.vdb" for i in range(10)})
                    self.assertEqual({row["object"] for row in self.rows()}, {f"good_{i}.obj" for i in range(10)})


class Library(Safety):
    def test_what_cannot_be_looked_at_is_skipped(self):
        library = self.library_of("a.obj", "shut/b.obj", "sub/c.obj")
        os.symlink("nowhere.obj", os.path.join(library, "broken.obj"))
        os.symlink("loop.obj", os.path.join(library, "loop.obj"))
        os.symlink("sub", os.path.join(library, "linked"))
        os.mkfifo(os.path.join(library, "pipe.obj"))
        os.symlink("nowhere.txt", os.path.join(library, "notes.txt"))  # is no mesh in any case
        os.chmod(os.path.join(library, "shut"), 0)
        self.addCleanup(os.chmod, os.path.join(library, "shut"), 0o755)
        skipped = ["broken.obj", "linked", "loop.obj", "pipe.obj"]
        more = {}
        if os.geteuid() == 0:  # whom no permissions bind
            os.chmod(self.tmp, 0o777)
            more = {"user": 65534, "group": 65534, "extra_groups": [],
                    "env": {**os.environ, "HOME": self.tmp, "XDG_CACHE_HOME": self.path("cache"), "TMPDIR": self.tmp}}
        run = self.done(*QUICK, library=library, **more)
        self.assertEqual({r["object"] for r in self.rows()}, {"a.obj", "sub/c.obj"})
        warnings = [line for line in run.stderr.splitlines() if line.startswith("sherd: warning: ")]
        self.assertEqual([os.path.basename(w.split(": ")[2]) for w in warnings], sorted(skipped + ["shut"]), run.stderr)
        self.assertIn("permission denied", run.stderr)
        self.assertIn(", 5 paths skipped", run.stdout)
        events = [json.loads(line) for line in self.done(*QUICK, "--resume", "--json", library=library, **more).stdout.splitlines()]
        self.assertEqual((events[-1]["skipped"], len([e for e in events if e["event"] == "warning"])), (5, 5))


if __name__ == "__main__":
    skipping.main()
