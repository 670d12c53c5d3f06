#!/usr/bin/python3
"""The three examples of CONTRIBUTING.md, made from the document in a copy of the sources: an option, a growth rule, a mesh format.

usage: contributing.py [FOLDER]    (in the repository; builds the program and its tests, which takes half an hour on two cores without ccache)

FOLDER is where the copy is made and stays, by default a temporary one.  The option is then in --help, manifests, files of options, what a dataset
draws, docs/cli.md and the schema of manifests; the rule gives the same labels on both devices; the format is read.
"""
import csv
import filecmp
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
import recipes  # noqa: E402


def run(*command, status=0, **environment):
    result = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            env={**os.environ, "OCL_ICD_VENDORS": "pocl.icd", **environment})
    assert result.returncode == status, (command, result.returncode, result.stdout, result.stderr)
    return result.stdout + result.stderr


def copied(copy):
    """Makes the copy; files that are there as they are stay untouched, so that a second run builds little."""
    made = recipes.made((ROOT / "CONTRIBUTING.md").read_text(), lambda name: (ROOT / name).read_text())
    for name in run("git", "-C", ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0"):
        if not name or not (ROOT / name).is_file() or name in made:
            continue
        if not (copy / name).exists() or not filecmp.cmp(ROOT / name, copy / name, shallow=False):
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, copy / name)
    for name, text in made.items():
        recipes.write(copy / name, text)


def option(copy, folder):
    sherd, mesh = copy / "build/release/sherd", ROOT / "data/amphora.ply"
    assert re.search(r"--slack FLOAT:0\.\.1=0 ", run(sherd, "fracture", "--help"))
    assert "0..1" in run(sherd, "fracture", mesh, "-o", folder / "refused", "--slack", "2", status=2)

    def options_of(name, *arguments):
        said = run(sherd, "fracture", mesh, "-o", folder / name, "--resolution", "32", "--write", "labels", *arguments)
        options_of.idle = "--slack does nothing without --min-share" in said
        return json.loads((folder / name / "manifest.json").read_text())["options"]

    assert options_of("usual")["slack"] == 0 and not options_of.idle
    assert options_of("given", "--slack", "0.25")["slack"] == 0.25 and options_of.idle
    (folder / "options.toml").write_text("slack = 0.125\n")
    assert options_of("file", "--config", folder / "options.toml")["slack"] == 0.125
    (folder / "options.json").write_text('{"slack": 0.375}')
    assert options_of("json", "--config", folder / "options.json")["slack"] == 0.375

    # As its use has it: a least share that three fragments cannot have is met with slack.
    run(sherd, "fracture", mesh, "-o", folder / "strict", "--resolution", "32", "--pieces", "3", "--min-share", "0.333", status=2)
    options_of("slack", "--pieces", "3", "--min-share", "0.333", "--slack", "0.9")
    assert not options_of.idle

    (folder / "library").mkdir()
    shutil.copy(mesh, folder / "library")
    run(sherd, "dataset", folder / "library", "-o", folder / "drawn", "--resolution", "32", "--pieces", "2..3", "--repeats", "2", "--slack", "0..0.5")
    with (folder / "drawn" / "index.csv").open() as index:
        drawn = {json.loads(row["options"]).get("slack") for row in csv.DictReader(index) if row["fracture"] != "whole"}
    assert len(drawn) > 1 and all(0 <= float(value) <= 0.5 for value in drawn), drawn
    assert "--slack=0..0.5" in json.loads((folder / "drawn" / "dataset.json").read_text())["options"]

    run(copy / "tools/option_docs.py", sherd)
    assert re.search(r"\| `--slack` \| 0 to 1 \| 0 \|", (copy / "docs/cli.md").read_text())
    schema = json.loads((copy / "docs/manifest.schema.json").read_text())
    jsonschema.validate(json.loads((folder / "given" / "manifest.json").read_text()), schema)
    assert schema["properties"]["options"]["properties"]["slack"]["maximum"] == 1
    for test in "EveryOption", "WrongValues":
        run("/usr/bin/python3", "-B", copy / "tests/cli/options_test.py", test, SHERD_BIN=str(sherd), SHERD_DATA=str(copy / "data"))


def growth_rule(copy, folder):
    sherd, labels = copy / "build/release/sherd", set()
    for device in "builtin", "pocl":
        run(copy / "build/release/tests/sherd_kernel_tests", "--gtest_filter=Columns.*", SHERD_TEST_DEVICE=device)
        out = folder / f"columns-{device}"
        run(sherd, "fracture", ROOT / "data/amphora.ply", "-o", out, "--growth", "columns", "--resolution", "64", "--device", device)
        assert json.loads((out / "manifest.json").read_text())["options"]["grow"]["growth"] == "columns"
        labels.add((out / "labels.rle").read_bytes())
    assert len(labels) == 1
    assert "columns" in re.search(r"^\| `--growth` \|.*", (copy / "docs/cli.md").read_text(), flags=re.M).group()


def mesh_format(copy, folder):
    sherd, cube = copy / "build/release/sherd", folder / "cube.tri"
    corners = [[float(i >> axis & 1) for axis in range(3)] for i in range(8)]
    sides = "0 2 3 1  4 5 7 6  0 1 5 4  2 6 7 3  0 4 6 2  1 3 7 5".split("  ")
    with cube.open("w") as file:
        for a, b, c, d in (map(int, side.split()) for side in sides):
            for triangle in (a, b, c), (a, c, d):
                file.write(" ".join(str(value) for i in triangle for value in corners[i]) + "\n")
    seen = json.loads(run(sherd, "inspect", cube, "--json"))
    assert (seen["vertices"], seen["triangles"], seen["closed"]) == (8, 12, True) and abs(seen["volume"] - 1) < 1e-12, seen
    run(sherd, "fracture", cube, "-o", folder / "cube", "--resolution", "32", "--pieces", "3")
    (folder / "cut.tri").write_text(cube.read_text()[:-5])
    assert "cut.tri:12: " in run(sherd, "inspect", folder / "cut.tri", status=3)
    (folder / "cube.xyzw").write_text("0")
    assert " .tri " in run(sherd, "inspect", folder / "cube.xyzw", status=3)
    fuzz = copy / "build/release/tests/fuzz/sherd_fuzz"
    assert "tri" in run(fuzz, SHERD_FUZZ="list").split()
    run(fuzz)


def unit_tests(copy, folder):
    run(copy / "build/release/tests/sherd_tests", "--gtest_filter=ReadTri.*:ManifestOptions.*:OptionTable.*")


def main():
    def build(*targets):
        return lambda copy, folder: run(copy / "tools/build.sh", "release", *targets, "--", "-DSHERD_TESTS=ON", "-DSHERD_BENCH=OFF")

    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        copy = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else folder / "sherd"
        copied(copy)
        for name, step in (("the program, its kernels' tests and its readers are built", build("sherd_cli", "sherd_kernel_tests", "sherd_fuzz")),
                           ("the option is one row", option), ("the growth rule is a kernel and a row", growth_rule),
                           ("the mesh format is read", mesh_format), ("unit tests are built", build("sherd_tests")), ("and pass", unit_tests)):
            started = time.time()
            step(copy, folder)
            print(f"{name}: {(time.time() - started) / 60:.1f} minutes", flush=True)


if __name__ == "__main__":
    sys.exit(main())
