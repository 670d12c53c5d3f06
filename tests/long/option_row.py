#!/usr/bin/python3
"""A new option is one row: a copy of the sources gets a field, its row and its use, and nothing else.

usage: option_row.py    (in the repository; builds the program, which takes five minutes on two cores)

The option is then in --help, manifests, files of options, what a dataset draws, docs/cli.md and the schema of manifests.
"""
import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import jsonschema

ROOT = pathlib.Path(__file__).resolve().parents[2]
EDITS = [  # file, where, what is put in front of it
    ("include/sherd/labels.h", "  int balance = 0;  ///< Lloyd iterations", "  double slack = 0.0;  ///< share of minShare that a fragment may lack, 0..1\n"),
    ("src/options/growth_rows.cpp", '    {.name = "share-tries",', """    {.name = "slack",
     .group = "Growth",
     .value = V::number(kShares, &ShareOptions::slack, kShare),
     .help = "Share of the least share that a fragment may lack",
     .key = "slack",
     .drawn = true},
"""),
]
USE = ("src/grow/shares.cpp", "std::ceil(options.minShare * ", "std::ceil((1.0 - options.slack) * options.minShare * ")


def run(*command, status=0):
    result = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert result.returncode == status, (command, result.returncode, result.stdout, result.stderr)
    return result.stdout + result.stderr


def edit(folder, name, old, new):
    file = folder / name
    text = file.read_text()
    assert text.count(old) == 1, (name, old, text.count(old))
    file.write_text(text.replace(old, new))


def main():
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        copy = folder / "sherd"
        for name in run("git", "-C", ROOT, "ls-files", "-z").split("\0"):
            if name and (ROOT / name).is_file():
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, copy / name)
        for name, where, what in EDITS:
            edit(copy, name, where, what + where)
        edit(copy, *USE)
        run(copy / "tools/build.sh", "release", "sherd_cli", "--", "-DSHERD_TESTS=OFF", "-DSHERD_BENCH=OFF")
        sherd, mesh = copy / "build/release/sherd", ROOT / "data/amphora.ply"

        assert re.search(r"--slack FLOAT:0\.\.1=0 ", run(sherd, "fracture", "--help"))
        assert "0..1" in run(sherd, "fracture", mesh, "-o", folder / "refused", "--slack", "2", status=2)

        def options_of(name, *arguments):
            run(sherd, "fracture", mesh, "-o", folder / name, "--resolution", "32", "--write", "labels", *arguments)
            return json.loads((folder / name / "manifest.json").read_text())["options"]

        assert options_of("usual")["slack"] == 0
        assert options_of("given", "--slack", "0.25")["slack"] == 0.25
        (folder / "options.toml").write_text("slack = 0.125\n")
        assert options_of("file", "--config", folder / "options.toml")["slack"] == 0.125
        (folder / "options.json").write_text('{"slack": 0.375}')
        assert options_of("json", "--config", folder / "options.json")["slack"] == 0.375

        # As its use has it: a least share that three fragments cannot have is met with slack.
        run(sherd, "fracture", mesh, "-o", folder / "strict", "--resolution", "32", "--pieces", "3", "--min-share", "0.333", status=2)
        options_of("slack", "--pieces", "3", "--min-share", "0.333", "--slack", "0.9")

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
    print("a new option is one row: help, manifests, files of options, draws, cli.md and the schema have it")


if __name__ == "__main__":
    sys.exit(main())
