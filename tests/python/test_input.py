"""Bad input is refused by an exception that names the argument; good input of any dtype and order is taken."""
import types

import numpy as np
import pytest
from conftest import AMPHORA, OnlyDlpack, cube

import pysherd

V, F = cube()


def changed(array, index, value):
    array = array.copy()
    array[index] = value
    return array


BAD_VERTICES = {
    "flat": V.ravel(), "pairs": V[:, :2], "scalar": 3.0, "empty": V[:0], "none": None, "text": "abc", "words": [["a", "b", "c"]],
    "ragged": [[0, 0, 0], [1, 1]], "complex": V.astype(complex), "objects": V.astype(object), "bools": V > 0, "nan": changed(V, (3, 1), np.nan),
    "infinite": changed(V, (0, 0), np.inf), "long": V * 1e38, "huge": np.broadcast_to(np.zeros(3), (10**12, 3)),
    "large": np.broadcast_to(np.zeros(3), (2**32 - 1, 3)),
}  # fmt: skip
BAD_FACES = {
    "flat": F.ravel(), "quads": np.zeros((4, 4), int), "empty": F[:0], "none": None, "floats": F.astype(float), "negative": changed(F, (2, 0), -1),
    "beyond": changed(F, (5, 2), 8), "far": changed(F, (0, 0), 2**40), "unsigned": changed(F.astype(np.uint64), (0, 0), 2**63),
    "text": F.astype(str), "degenerate": np.zeros((3, 3), int), "huge": np.broadcast_to(F[0], (10**13, 3)),
}  # fmt: skip
BAD_VOLUMES = {
    "flat": np.ones((4, 4)), "four": np.ones((2, 2, 2, 2), int), "floats": np.ones((4, 4, 4)), "empty": np.ones((0, 4, 4), int),
    "hollow": np.zeros((4, 4, 4), int), "complex": np.ones((4, 4, 4), complex), "huge": np.broadcast_to(np.uint8(1), (5000, 5000, 5000)),
    "large": np.broadcast_to(np.uint8(1), (4096, 4096, 4096)),
}  # fmt: skip


def refused(name, mesh):
    for function in (pysherd.voxelize, pysherd.fracture):
        with pytest.raises(pysherd.InputError) as caught:
            function(mesh)
        sentence = str(caught.value)
        assert sentence.startswith(name + ": ") and "\n" not in sentence and not sentence.endswith(".")
        assert isinstance(caught.value, (pysherd.Error, ValueError)) and caught.value.code == 3


@pytest.mark.parametrize("name", BAD_VERTICES)
def test_vertices(name):
    refused("vertices", (BAD_VERTICES[name], F))


@pytest.mark.parametrize("name", BAD_FACES)
def test_faces(name):
    refused("faces", (V, BAD_FACES[name]))


@pytest.mark.parametrize("name", BAD_VOLUMES)
def test_volumes(name):
    refused("volume", BAD_VOLUMES[name])


@pytest.mark.parametrize("mesh", [None, 3, (V,), (V, F, F), {}, object()], ids=str)
def test_meshes(mesh):
    refused("mesh", mesh)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.float16, np.int8, np.int64, ">f8", np.longdouble])
@pytest.mark.parametrize("index", [np.int8, np.uint16, np.int32, np.uint32, np.int64, np.uint64, ">i4"])
def test_any_dtype(dtype, index):
    labels = pysherd.fracture((V, F), pieces=3, resolution=16).labels
    assert np.array_equal(pysherd.fracture((V.astype(dtype), F.astype(index)), pieces=3, resolution=16).labels, labels)


def test_any_order():
    labels = pysherd.fracture((V, F), pieces=3, resolution=16).labels
    read_only_v, read_only_f = V.copy(), F.copy()
    read_only_v.flags.writeable = read_only_f.flags.writeable = False
    strided = np.zeros((16, 6))
    strided[::2, ::2] = V
    given = [(np.asfortranarray(V), np.asfortranarray(F)), (read_only_v, read_only_f), (strided[::2, ::2], F), (V.tolist(), F.tolist()),
             [V, F], types.SimpleNamespace(vertices=V, faces=F), types.SimpleNamespace(vertices=V, triangles=F)]  # fmt: skip
    for mesh in given:
        assert np.array_equal(pysherd.fracture(mesh, pieces=3, resolution=16).labels, labels)


def test_dlpack():
    assert len(pysherd.fracture((OnlyDlpack(V), OnlyDlpack(F)), pieces=3, resolution=16)) == 3


def test_arrays_are_not_kept():
    v = V.copy()
    solid = pysherd.voxelize((v, F), resolution=16)
    v[...] = np.nan
    assert len(pysherd.fracture(solid, pieces=2)) == 2


@pytest.mark.parametrize("options, name", [
    ({"pieces": 0}, "pieces"), ({"pieces": "many"}, "pieces"), ({"pieces": 2.5}, "pieces"), ({"pieces": True}, "pieces"),
    ({"pieces": [1, 2]}, "pieces"), ({"pieces": object()}, "pieces"), ({"pieces": 10**30}, "pieces"), ({"seed": -1}, "seed"),
    ({"roughness": "x"}, "roughness"), ({"roughness": float("nan")}, "roughness"), ({"roughness": -1}, "roughness"),
    ({"growth": "fast"}, "growth"), ({"growth": 3}, "growth"), ({"erode_planes": 1}, "erode_planes"), ({"piece": 3}, "piece"),
    ({"resolution": 7}, "resolution"), ({"resolution": 16, "voxel_size": 0.1}, "voxel_size"), ({"mesh_format": ["ply", "ply"]}, "mesh_format"),
    ({"write": "everything"}, "write"), ({"seeds": "s.json", "pieces": 3}, "seeds"), ({"impact": 3}, "impact"), ({"triangles": 3}, "triangles"),
    ({"sdf_type": "float16"}, "sdf_type"), ({"device": 3}, "device"), ({"device": ""}, "device"),
], ids=str)  # fmt: skip
def test_options(options, name):
    with pytest.raises(pysherd.UsageError, match=f"^{name}: |^{name} ") as caught:
        pysherd.fracture((V, F), **options)
    assert isinstance(caught.value, ValueError) and caught.value.code == 2


@pytest.mark.parametrize("call, name", [
    (lambda f: f.points(-1), "points"), (lambda f: f.points("x"), "points"), (lambda f: f.points(10, pieces=3), "pieces"),
    (lambda f: f.render("x.jpg"), "file"), (lambda f: f.render(up="w"), "up"), (lambda f: f.save(3), "folder"), (lambda f: f.save(""), "folder"),
    (lambda f: f.save("x", pieces=3), "pieces"), (lambda f: f.render(3), "file"), (lambda f: pysherd.fracture(f.solid, resolution=20), "resolution"),
    (lambda f: pysherd.voxelize((V, F), pieces=3), "pieces"), (lambda f: pysherd.fracture(pysherd.voxelize((V, F), resolution=16, surface="smooth"), surface="exact"), "surface"),
    (lambda f: list(f.solid.fractures(pieces="2..3")), "pieces"), (lambda f: list(f.solid.fractures(seeds=[0.5])), "seeds"),
    (lambda f: list(f.solid.fractures(pieces=[0])), "pieces"), (lambda f: list(f.solid.fractures(seed=3)), "seed"),
    (lambda f: pysherd.limit_threads(-1), "most"),
])  # fmt: skip
def test_other_arguments(fracture, call, name):
    with pytest.raises(pysherd.UsageError, match=f"^{name}: "):
        call(fracture)


@pytest.mark.parametrize("keywords", [{"explode": -1}, {"size": (8, 8)}, {"size": 3}, {"elevation": 200}, {"azimuth": "x"}], ids=str)
def test_images(fracture, keywords):
    with pytest.raises(pysherd.UsageError):
        fracture.render(**keywords)


def test_files(tmp_path, fracture):
    (tmp_path / "bad.obj").write_text("f 1 2 9001\n")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "own.txt").write_text("x")
    for file in ("absent.obj", "bad.obj", "other", "x.unknown", ""):
        with pytest.raises(pysherd.FileError) as caught:
            pysherd.fracture(str(tmp_path / file) if file else "")
        assert isinstance(caught.value, OSError) and caught.value.code == 3
    for folder in ("absent", "other"):
        with pytest.raises(pysherd.FileError):
            pysherd.load(tmp_path / folder)
    with pytest.raises(pysherd.OutputError) as caught:
        fracture.save(tmp_path / "other")
    assert isinstance(caught.value, OSError) and caught.value.code == 5
    with pytest.raises(pysherd.Error):
        pysherd.fracture((V, F), seeds=tmp_path / "absent.json")


def test_a_device_that_is_not_there():
    with pytest.raises(pysherd.DeviceError) as caught:
        pysherd.fracture((V, F), device="abacus")
    assert caught.value.code == 4


def test_paths_of_every_kind():
    for path in (AMPHORA, str(AMPHORA)):
        assert pysherd.voxelize(path, resolution=16).name == "amphora.ply"
