"""Datasets as Parquet: what pyarrow and pandas read again, beside the files themselves; what is refused."""
import json
import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import AMPHORA
from documents import write_cube

import pysherd
from pysherd.parquet import write_parquet

pq = pytest.importorskip("pyarrow.parquet")

SMALL = {"--resolution": "20", "--pieces": "2..4", "--repeats": "2..1", "--points": "40", "--point-format": "npz", "--write": "labels", "--seed": "3"}


def made(folder, *options, command="dataset"):
    library = folder / "library"
    write_cube(library / "cube.obj", 1)
    write_cube(library / "other" / "box.obj", 2)
    (library / "amphora.ply").write_bytes(AMPHORA.read_bytes())
    (folder / "licenses").write_text("*.ply\tMIT\n")
    small = [word for name, value in SMALL.items() if name not in options for word in (name, value)]
    subprocess.run([os.environ["SHERD_BIN"], command, library, "-o", folder / "out", *small, *options], check=True, capture_output=True)
    return folder / "out"


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    folder = tmp_path_factory.mktemp("parquet")
    return made(folder, "--preset", "training", "--poses", "--split", "2/1/0", "--licenses", folder / "licenses")


def index(dataset):
    """The rows of the index by object and fracture, without those of intact objects."""
    fractures = {}
    for line in open(dataset / "index.jsonl"):
        row = json.loads(line)
        if row["fracture"] != "whole":
            fractures.setdefault((row["object"], row["fracture"]), []).append(row)
    return fractures


def test_rows_are_the_fractures_with_their_points(dataset, tmp_path):
    files = write_parquet(dataset, tmp_path / "out")
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == sorted(p.name for p in files)
    rows = [row for path in files for row in pq.read_table(path).to_pylist()]
    fractures = index(dataset)
    hashes = {m["object"]: m for m in json.loads((dataset / "recipe.json").read_text())["meshes"]}
    assert {(row["object"], row["fracture"]) for row in rows} == set(fractures) and len(rows) == len(fractures) == 12
    for row in rows:
        all_of_it = fractures[row["object"], row["fracture"]]
        kept = [fragment for fragment in all_of_it if not fragment["withheld"]]
        assert row["id"] == [fragment["id"] for fragment in kept] and row["share"] == [fragment["share"] for fragment in kept]
        assert all(row[name] == all_of_it[0][name] for name in ("split", "pieces", "repeat", "seed"))
        assert json.loads(row["options"]) == all_of_it[0]["options"] and "roughness" in row["options"]
        assert row["source"] == row["object"] and row["sha256"] == hashes[row["object"]]["sha256"]
        assert row["license"] == ("MIT" if row["object"] == "amphora.ply" else None) and row["mesh"] is None
        fragment = np.array(row["fragment"])
        for at, own in enumerate(kept):
            points = np.load(dataset / next(name for name in own["files"] if name.endswith(".npz")))
            assert np.array_equal(np.array(row["positions"], np.float32)[fragment == own["id"]], points["positions"])
            assert np.array_equal(np.array(row["normals"], np.float32)[fragment == own["id"]], points["normals"])
            assert np.array_equal(np.array(row["neighbor"])[fragment == own["id"]], points["neighbor"])
            assert row["rotation"][at] == own["rotation"] and row["truth_translation"][at] == own["truth_translation"]
        assert {(c["a"], c["b"]): c["area"] for c in row["contacts"]} == {(f["id"], b): area for f in kept for b, area in f["contacts"] if b > f["id"]}


def test_columns_have_types(dataset, tmp_path):
    path = write_parquet(dataset, tmp_path)[0]
    schema = pq.read_schema(path)
    types = {name: str(schema.field(name).type) for name in schema.names}
    assert types["positions"] == types["normals"] == "list<element: fixed_size_list<element: float>[3]>"
    assert types["seed"] == "uint64" and types["neighbor"] == types["fragment"] == types["id"] == "list<element: int32>"
    assert types["rotation"] == "list<element: fixed_size_list<element: double>[4]>" and types["options"] == types["sha256"] == "string"
    assert json.loads(schema.metadata[b"sherd"]) == {name: json.loads((dataset / "dataset.json").read_text())[name] for name in ("layout", "seed", "options")}


def test_splits_are_files(dataset, tmp_path):
    for path in write_parquet(dataset, tmp_path):
        objects = set(pq.read_table(path, columns=["object"]).column("object").to_pylist())
        assert objects == set((dataset / f"{path.stem}.txt").read_text().split())


def test_pandas_reads_them(dataset, tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = pandas.concat([pandas.read_parquet(path) for path in write_parquet(dataset, tmp_path)])
    assert len(frame) == 12 and np.stack(frame.iloc[0].positions).shape == (len(frame.iloc[0].fragment), 3)


def test_an_assemblage_has_meshes_and_no_recipe(tmp_path):
    out = made(tmp_path, "--objects", "2..2", "--split", "1/0/0", "--repeats", "1..1", command="assemblage")
    rows = pq.read_table(*write_parquet(out, tmp_path / "parquet")).to_pylist()
    assert rows and all(set(row["mesh"]) <= {"cube.obj", "other/box.obj", "amphora.ply"} and len(set(row["mesh"])) == 2 for row in rows)
    assert all(row["sha256"] is None and row["source"] is None for row in rows)


def test_breaking_bads_tree_has_the_same_columns(tmp_path):
    out = made(tmp_path, "--layout", "bb", "--split", "1/0/0")
    row = pq.read_table(*write_parquet(out, tmp_path / "parquet")).to_pylist()[0]
    assert len(row["positions"]) == 40 * len(row["id"]) and np.abs(row["positions"]).max() < 0.51


def test_other_folders_are_refused(dataset, tmp_path):
    for folder in (tmp_path, dataset / "index.jsonl", tmp_path / "absent"):
        with pytest.raises(pysherd.FileError):
            write_parquet(folder, tmp_path / "out")
    out = made(tmp_path, "--point-format", "ply")
    with pytest.raises(pysherd.FileError, match="no points in .npz"):
        write_parquet(out, tmp_path / "out2")
    packed = made(tmp_path / "packed", "--layout", "packed")
    with pytest.raises(pysherd.FileError, match="layout packed"):
        write_parquet(packed, tmp_path / "out2")
    with pytest.raises(pysherd.OutputError):
        write_parquet(dataset, dataset / "index.jsonl")


@pytest.mark.parametrize("change", [
    lambda row: row.update(seed="x"), lambda row: row.update(split="../x"), lambda row: row.pop("files"), lambda row: row.update(sha256=["0" * 64] * 3),
    lambda row: row.update(files=["../points/x.npz"]), lambda row: row.update(files=7), lambda row: row.update(contacts=[[1]]), lambda row: row.update(id=2**40),
    lambda row: row.update(object=[1]), lambda row: row.update(share="much"), lambda row: row.pop("fracture"),
])  # fmt: skip
def test_a_damaged_index_is_one_sentence(tmp_path, change):
    out = made(tmp_path)
    lines = (out / "index.jsonl").read_text().splitlines()
    row = json.loads(lines[1])
    change(row)
    (out / "index.jsonl").write_text("\n".join([lines[0], json.dumps(row), *lines[2:]]) + "\n")
    with pytest.raises(pysherd.FileError):
        write_parquet(out, tmp_path / "parquet")
    assert list((tmp_path / "parquet").iterdir()) == []


def test_damaged_points_are_found(tmp_path):
    out = made(tmp_path)
    path = next(out.rglob("points/*.npz"))
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    with pytest.raises(pysherd.FileError, match="differs from its checksum"):
        write_parquet(out, tmp_path / "parquet")


def test_the_command(dataset, tmp_path):
    command = [sys.executable, "-m", "pysherd.parquet"]
    run = subprocess.run([*command, dataset, tmp_path / "out"], capture_output=True, text=True)
    assert run.returncode == 0 and sorted(run.stdout.splitlines()) == [str(p) for p in sorted((tmp_path / "out").iterdir())]
    assert subprocess.run(command, capture_output=True).returncode == 2
    failed = subprocess.run([*command, tmp_path, tmp_path], capture_output=True, text=True)
    assert failed.returncode == 3 and failed.stderr.startswith("pysherd: ") and len(failed.stderr.splitlines()) == 1


def test_pyarrow_is_named_where_it_lacks(dataset, tmp_path):
    code = f"import sys; sys.modules['pyarrow'] = None\nimport pysherd.parquet\npysherd.parquet.write_parquet({str(dataset)!r}, {str(tmp_path)!r})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "ImportError: pysherd.parquet.write_parquet needs pyarrow, which is not installed: pip install pyarrow" in run.stderr
