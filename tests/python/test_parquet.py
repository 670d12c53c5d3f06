"""Datasets as Parquet: what pyarrow and pandas read again, beside the files themselves; what is refused."""
import hashlib
import json
import os
import subprocess
import sys
import tracemalloc

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


def test_damaged_recipes_are_named(tmp_path):
    out = made(tmp_path, "--repeats", "1..1", "--pieces", "2..2")
    recipe = json.loads((out / "recipe.json").read_text())
    for change in ({"sha256": 7}, {"license": [1]}, {"object": 3}, {"license": "\ud800"}):
        (out / "recipe.json").write_text(json.dumps({**recipe, "meshes": [{**recipe["meshes"][0], **change}, *recipe["meshes"][1:]]}))
        with pytest.raises(pysherd.FileError, match="recipe.json: is damaged"):
            write_parquet(out, tmp_path / "parquet")


def test_compressed_points_are_named(tmp_path):
    out = made(tmp_path, "--compress", "zstd", "--repeats", "1..1", "--pieces", "2..2")
    with pytest.raises(pysherd.FileError, match=r"\.npz\.zst is compressed; make the dataset without --compress"):
        write_parquet(out, tmp_path / "parquet")


def test_files_of_earlier_splits_are_removed(tmp_path):
    (tmp_path / "parquet").mkdir()
    for name in ("train.parquet", "val.parquet", "test.parquet", "notes.txt"):
        (tmp_path / "parquet" / name).write_text("old")
    one = made(tmp_path, "--split", "1/0/0", "--repeats", "1..1", "--pieces", "2..2")
    assert write_parquet(one, tmp_path / "parquet") == [tmp_path / "parquet" / "train.parquet"]
    assert sorted(p.name for p in (tmp_path / "parquet").iterdir()) == ["notes.txt", "train.parquet"]
    (one / "index.jsonl").write_text("{}\n")
    with pytest.raises(pysherd.FileError):  # and what fails removes none
        write_parquet(one, tmp_path / "parquet")
    assert sorted(p.name for p in (tmp_path / "parquet").iterdir()) == ["notes.txt", "train.parquet"]


def test_points_take_their_size_in_memory(tmp_path):
    """Of eight fractures with 300,000 points each, at 32 bytes a point, no more than four are held, however few the rows."""
    out, count = tmp_path / "out", 150_000
    (out / "points").mkdir(parents=True)
    (out / "dataset.json").write_text(json.dumps({"layout": "sherd", "seed": 0, "options": ""}))
    random = np.random.default_rng(1)
    files = {}
    for own in (1, 2):
        files[own] = f"points/{own}.npz"
        normals = random.random((count, 3), np.float32)
        np.savez(out / files[own], positions=normals + own, normals=normals, neighbor=np.full(count, 3 - own, np.int32))
    sums = {own: hashlib.sha256((out / name).read_bytes()).hexdigest() for own, name in files.items()}
    with open(out / "index.jsonl", "w") as index:
        for repeat in range(8):
            for own in (1, 2):
                row = {"object": "a", "fracture": f"2f_{repeat}", "split": "train", "pieces": 2, "repeat": repeat, "seed": 1, "options": {}, "withheld": False,
                       "id": own, "share": 0.5, "volume": 1.0, "contacts": [[3 - own, 1.0]], "files": [files[own]], "sha256": [sums[own]]}
                index.write(json.dumps(row) + "\n")
    tracemalloc.start()
    path, = write_parquet(out, tmp_path / "parquet")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2.5 * 4 * 2 * count * 32  # four fractures, and as much to join them
    file = pq.ParquetFile(path)
    assert file.num_row_groups == 2 and file.metadata.num_rows == 8
    row = file.read_row_group(1, columns=["positions", "fragment", "neighbor"]).slice(3, 1)
    positions = row.column("positions").combine_chunks().flatten().flatten().to_numpy().reshape(-1, 3)
    assert np.array_equal(positions, np.concatenate([np.load(out / files[own])["positions"] for own in (1, 2)]))
    fragment, neighbor = (row.column(name).combine_chunks().flatten().to_numpy() for name in ("fragment", "neighbor"))
    assert np.array_equal(fragment, np.repeat([1, 2], count)) and np.array_equal(neighbor, 3 - fragment)


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
