"""Options that do nothing, or contradict each other: the same sentences as the program's, with keywords for options."""
import json
import re
import subprocess
import warnings

import numpy as np
import pytest
from conftest import AMPHORA, SHERD, cube
from test_fracture import arguments_of

import pysherd

SETS = [
    {"neighborhood": 26},
    {"metric": "manhattan", "growth": "flood"},
    {"merge_metric": "manhattan"},
    {"erode_size": 3, "erode_on": "fracture"},
    {"interface": "independent", "surface": "labels"},
    {"smoothing": "laplacian", "smooth_weight": 0.4},
    {"triangles": [100], "precision": "double", "write": "labels"},
    {"plain_meshes": True, "mesh_format": "stl"},
    {"voxel_format": "npy", "write": "mesh"},
    {"write": "fog"},
    {"write": ["labels", "solid"], "vdb_compress": "zip"},
    {"point_sampler": "halton"},
    {"sdf_type": "float16", "sdf_samples": 0},
    {"roughness": 1, "growth": "nearest", "metric": "manhattan"},
    {"fill": "parity", "shell_thickness": 0.1},
    {"point_rule": "per-triangle", "point_sampler": "poisson", "points": 3},
    {"grid": "density"},
    {"isovalue": 0.3},
]


def caught(function):
    """Returns what a function warns of, as (sentence, file) pairs, and the sentence of its usage error or None."""
    with warnings.catch_warnings(record=True) as all:
        warnings.simplefilter("always")
        try:
            function()
            error = None
        except pysherd.UsageError as e:
            error = str(e)
    assert {w.category for w in all} <= {pysherd.SherdWarning}
    return [(str(w.message), w.filename) for w in all], error


def in_keywords(sentence):
    return re.sub(r"--([a-z-]+)", lambda name: name[1].replace("-", "_"), sentence)


@pytest.mark.parametrize("options", SETS, ids=lambda o: ",".join(o))
def test_sentences_are_those_of_the_program(options, tmp_path):
    if not SHERD:
        pytest.skip("SHERD_BIN does not name the program")
    given = [a.replace("=True", "") for a in arguments_of({"resolution": 32, "pieces": 3, **options})]
    printed = subprocess.run([SHERD, "fracture", AMPHORA, "-o", tmp_path / "out", "--quiet", *given], capture_output=True, text=True)
    theirs = [in_keywords(line[len("sherd: "):]) for line in printed.stderr.splitlines() if " --" in line]
    ours, error = caught(lambda: pysherd.fracture(AMPHORA, resolution=32, pieces=3, **options))
    about_options = ["warning: " + sentence for sentence, _ in ours if re.match(r"[a-z_]+ (does nothing|fog|solid)", sentence)]
    assert about_options + ([error] if error else []) == theirs
    assert all(file == __file__ for _, file in ours)


def test_each_function_warns_of_its_own_keywords(tmp_path):
    solid = pysherd.voxelize(cube(), resolution=16)
    f = pysherd.fracture(solid, pieces=2, precision="double")
    sentence = "precision does nothing without proxy or boundaries in write, or mesh in write and ply, obj or stl-ascii in mesh_format"
    for call, expected in (
        (lambda: pysherd.fracture(solid, pieces=2, metric="manhattan"), "metric does nothing without growth nearest or chain"),
        (lambda: list(solid.fractures(pieces=2, seeds=range(20), metric="manhattan")), "metric does nothing without growth nearest or chain"),
        (lambda: f.points(0, point_sampler="halton"), "point_sampler does nothing without points, or points in write"),
        (lambda: f.save(tmp_path / "a", write="labels"), sentence),
        (lambda: f.save(tmp_path / "b"), None),
        (lambda: f.points(3), None),
    ):
        found, error = caught(call)
        assert error is None and found == ([(expected, __file__)] if expected else [])


def test_each_function_refuses_what_contradicts():
    solid = pysherd.voxelize(cube(), resolution=16)
    f = pysherd.fracture(solid, pieces=2)
    for call, name in (
        (lambda: pysherd.voxelize(cube(), grid="density"), "grid"),
        (lambda: pysherd.voxelize(cube(), fill="flood", shell_thickness=0.1), "shell_thickness"),
        (lambda: f.points(3, point_rule="per-triangle", point_sampler="poisson"), "point_rule"),
        (lambda: f.save("nowhere", points=3, point_rule="per-triangle", point_sampler="poisson"), "point_rule"),
    ):
        found, error = caught(call)
        assert error.startswith(name + " ") and not found


def test_options_that_do_nothing_with_a_level_set(tmp_path):
    pysherd.fracture(cube(), pieces=2, resolution=16).save(tmp_path / "out", write=["vdb", "solid"])
    file = next((tmp_path / "out" / "fragments").glob("mesh.vdb"))
    found, _ = caught(lambda: pysherd.voxelize(file, fill="parity", isovalue=0.2))
    assert [sentence.split(" does nothing with a level set")[0] for sentence, _ in found] == ["fill", "isovalue"]


def test_warnings_of_an_object_point_at_the_caller():
    found, _ = caught(lambda: pysherd.fracture(AMPHORA, resolution=24, pieces=2))
    assert any("walls" in sentence for sentence, _ in found) and all(file == __file__ for _, file in found)
    solid = pysherd.voxelize(cube(), resolution=24, surface="exact", fill="parity")
    found, _ = caught(lambda: pysherd.fracture(solid, pieces=2, surface="exact")[0].vertices)
    assert [file for sentence, file in found if "smooth surface instead of the exact one" in sentence] == [__file__]


def cube_beside_boxes_that_touch_in_voxels():
    """A cube, and apart from it an open box with a small one a third of a voxel away, which can't be cut: their voxels are joined."""
    size = 6 / (32 - 13 / 3)  # of a voxel at 32 of them
    vertices, faces = cube(2.0)
    low = np.array((5 + size / 3, 0.9, 0.9))
    all_vertices = np.vstack((vertices, vertices + (3, 0, 0), vertices * (2 * size) + low))
    return all_vertices, np.vstack((faces, faces[2:] + 8, faces[2:] + 16))


def test_bodies_that_cannot_be_cut_are_smooth_and_others_exact(tmp_path):
    broken = pysherd.fracture(cube_beside_boxes_that_touch_in_voxels(), resolution=32, pieces=6)
    found, _ = caught(lambda: broken[0].vertices)
    ((sentence, file),) = [each for each in found if "smooth surface" in each[0]]
    assert file == __file__
    places = [np.asarray(f.vertices).mean(axis=0)[0] > 2.5 for f in broken]
    ids = [i + 1 for i, is_smooth in enumerate(places) if is_smooth]
    assert sentence.startswith(f"{len(ids)} of {len(broken)} fragments ha")
    assert 0 < len(ids) < len(broken) and f": {ids[0]}" in sentence and "would be several bodies" in sentence
    assert sum(f.volume for f, is_smooth in zip(broken, places) if not is_smooth) == pytest.approx(8, abs=1e-9)
    for fragment, is_smooth in zip(broken, places):
        neighbors = set(np.asarray(fragment.neighbor).tolist()) - {0}
        assert all(places[n - 1] == is_smooth for n in neighbors)
    found, _ = caught(lambda: broken.save(tmp_path / "out", write="mesh"))
    assert [s for s, _ in found if sentence in s]
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    assert [f["id"] for f in manifest["fragments"] if f["surface"] == "smooth"] == ids == manifest["smooth_bodies"][0]["fragments"]
