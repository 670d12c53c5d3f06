"""Fragments that are broken again, in memory and from files."""

import json
import pickle

import numpy as np
import pytest
from conftest import cube, program

import pysherd


def broken(**options):
    return pysherd.fracture(cube(), **{"pieces": 6, "resolution": 40, "seed": 7, **options})


def assert_same(first, second, meshes=True):
    assert len(first) == len(second)
    assert np.array_equal(first.labels, second.labels)
    for a, b in zip(first, second):
        assert (a.id, a.voxels) == (b.id, b.voxels)
        assert a.volume == pytest.approx(b.volume, rel=1e-12)
        if meshes:
            assert np.array_equal(a.vertices, b.vertices) and np.array_equal(a.faces, b.faces)


@pytest.mark.parametrize("surface", ["exact", "smooth"])
def test_the_others_keep_their_ids_and_the_parts_fill_the_broken_one(surface):
    whole = broken(surface=surface)
    again = whole.broken([3, 5], pieces=4)
    assert len(again) == 12 and again.parents == [1, 2, 3, 4, 5, 6, 3, 3, 3, 5, 5, 5]
    assert again.seed == whole.seed + 1 and again.solid is whole.solid
    for old in whole:
        parts = [new for new in again if again.parents[new.id - 1] == old.id]
        assert sum(part.voxels for part in parts) == old.voxels
        if surface == "exact":
            assert sum(part.volume for part in parts) == pytest.approx(old.volume, rel=1e-9)
            if old.id not in (3, 5):
                assert np.array_equal(parts[0].vertices[parts[0].faces], old.vertices[old.faces])


@pytest.mark.parametrize("surface", ["exact", "smooth", "labels"])
def test_it_is_what_the_program_makes_of_the_folder(surface, tmp_path):
    whole = broken(surface=surface, material="stone")
    whole.save(tmp_path / "first", precision="double")
    program(tmp_path / "first", tmp_path / "second", "--only", "2", "--pieces", "5")
    other = pysherd.load(tmp_path / "second")
    again = whole.broken(2, pieces=5)
    assert np.array_equal(again.labels, other.labels)
    loaded = pysherd.load(tmp_path / "first").broken(2, pieces=5)
    assert np.array_equal(again.labels, loaded.labels)
    if surface == "exact":
        for mine, theirs, read in zip(again, other, loaded):
            assert mine.volume == pytest.approx(theirs.volume, rel=1e-9)
            assert mine.volume == pytest.approx(read.volume, rel=1e-9)
    again.save(tmp_path / "third")
    mine, theirs = (json.loads((tmp_path / name / "manifest.json").read_text()) for name in ("third", "second"))
    assert mine["only"] == theirs["only"] == [2]
    assert [f["parent"] for f in mine["fragments"]] == [f["parent"] for f in theirs["fragments"]]
    assert mine["options"]["material"] == theirs["options"]["material"]
    assert "sha256" in mine["source"] and "fracture_sha256" in theirs["source"]
    assert [(b["seed"], b["fragments"]) for b in mine["history"]] == [(b["seed"], b["fragments"]) for b in theirs["history"]]


def test_five_times_in_a_row():
    fracture = whole = broken(surface="exact")
    for k in range(5):
        before = fracture
        fracture = before.broken(len(before), pieces=3, material="stone" if k == 2 else None)
        assert len(fracture) == len(before) + 2
        for old, new in zip(list(before)[:-1], fracture):
            assert np.array_equal(old.vertices[old.faces], new.vertices[new.faces])
    assert sum(f.volume for f in fracture) == pytest.approx(sum(f.volume for f in whole), rel=1e-9)
    assert fracture.solid is whole.solid


def test_pickles(tmp_path):
    whole = broken()
    again = whole.broken(1, pieces=3).broken(2, pieces=3, roughness=1.0)
    assert_same(pickle.loads(pickle.dumps(again)), again)
    whole.save(tmp_path / "first", precision="double")
    loaded = pysherd.load(tmp_path / "first").broken(1, pieces=3)
    assert loaded.solid is None
    assert_same(pickle.loads(pickle.dumps(loaded)), loaded)


@pytest.mark.parametrize("options", [{"erode_iterations": 2}, {"missing": 0.34}])
def test_what_is_in_no_fragment_stays_out(options):
    whole = broken(**options)
    again = whole.broken(1, pieces=3)
    assert len(again) == len(whole) + 2
    assert sum(f.voxels for f in again) == sum(f.voxels for f in whole)
    for old, new in zip(list(whole)[1:], list(again)[1:]):
        assert old.voxels == new.voxels


def test_what_holds_for_the_whole_is_refused():
    whole = broken()
    for wrong in ({"resolution": 64}, {"missing": 0.5}, {"nothing": 1}):
        with pytest.raises(pysherd.UsageError, match=next(iter(wrong))):
            whole.broken(1, pieces=2, **wrong)
    for ids in (0, 7, [], [1, 9], "1", None, 1.5):
        with pytest.raises(pysherd.UsageError, match="ids"):
            whole.broken(ids, pieces=2)


def test_it_can_be_cancelled():
    whole = broken(resolution=96)
    with pytest.raises(pysherd.Cancelled):
        whole.broken(1, pieces=3, progress=lambda stage, fraction: False)
    assert len(whole.broken(1, pieces=3)) == 8


@pytest.mark.parametrize("write, mesh_format", [("mesh", "ply"), ("mesh,labels", "obj"), ("mesh,vdb", "glb"), ("mesh", "stl")])
@pytest.mark.parametrize("surface", ["exact", "smooth"])
def test_voxels_are_made_again_from_meshes(surface, write, mesh_format, tmp_path):
    whole = broken(surface=surface)
    whole.save(tmp_path / "first", write=write, mesh_format=mesh_format)
    again = pysherd.load(tmp_path / "first").broken(3, pieces=4)
    assert again.parents == [1, 2, 3, 4, 5, 6, 3, 3, 3]
    assert again.labels.shape == whole.labels.shape
    parents = np.array([0, *again.parents])[again.labels]
    differs = parents != whole.labels
    assert differs.mean() < 0.01
    for old in whole:
        parts = [new for new in again if again.parents[new.id - 1] == old.id]
        assert sum(part.volume for part in parts) == pytest.approx(old.volume, rel=1e-5 if surface == "exact" else 0.03)
    assert sum(f.volume for f in again) == pytest.approx(1.0, rel=1e-5 if surface == "exact" else 3e-3)


@pytest.mark.parametrize("key, value", [("origin", [1e9, 0, 0]), ("origin", [1e300, 0, 0]), ("voxel_size", 1e-9), ("voxel_size", 1e9)])
def test_meshes_that_do_not_fit_their_grid_are_refused(key, value, tmp_path):
    broken(pieces=3).save(tmp_path / "first", write="mesh")
    file = tmp_path / "first" / "manifest.json"
    manifest = json.loads(file.read_text())
    manifest["grid"][key] = value
    file.write_text(json.dumps(manifest))
    with pytest.raises(pysherd.FileError):
        pysherd.load(tmp_path / "first").broken(1, pieces=2)


def test_a_folder_that_is_gone_is_a_file_error(tmp_path):
    broken(pieces=3).save(tmp_path / "first", write="mesh")
    loaded = pysherd.load(tmp_path / "first")
    (tmp_path / "first" / "manifest.json").unlink()
    with pytest.raises(pysherd.FileError, match="manifest.json"):
        loaded.broken(1, pieces=2)


def test_two_fragments_with_one_mesh_are_refused(tmp_path):
    broken(pieces=3).save(tmp_path / "first", write="mesh")
    file = tmp_path / "first" / "manifest.json"
    manifest = json.loads(file.read_text())
    manifest["fragments"][1]["files"]["mesh"] = manifest["fragments"][0]["files"]["mesh"]
    file.write_text(json.dumps(manifest))
    with pytest.raises(pysherd.FileError, match="fragment 2"):
        pysherd.load(tmp_path / "first").broken(1, pieces=2)


def test_a_folder_with_neither_meshes_nor_voxels_is_refused(tmp_path):
    broken().save(tmp_path / "first", write="labels")
    with pytest.raises(pysherd.FileError, match="neither meshes"):
        pysherd.load(tmp_path / "first").broken(1, pieces=3)
