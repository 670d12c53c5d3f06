"""Whatever is given for whatever argument: it is used, or refused by an exception of pysherd that names it.  Iterators may have no end."""
import decimal
import fractions
import inspect
import itertools
import os
import pathlib
import warnings

import numpy as np
import pytest
from conftest import cube

import pysherd
from pysherd import _options

V, F = cube()


class Rude:
    """An object whose own methods fail."""

    def __repr__(self):
        raise RuntimeError("no")

    def __float__(self):
        raise ValueError("no")


def inside_itself():
    values = []
    values.append(values)
    return values


def raw(name):
    return os.fsdecode(name)


# Made anew for each use: iterators are used up.
HOSTILE = {
    "none in a list": lambda: [None], "true": lambda: True, "numpy's true": lambda: np.True_, "huge": lambda: 10**19, "huger": lambda: 10**400,
    "hugest": lambda: 10**5000, "negative": lambda: -1, "least": lambda: -(10**19), "nan": lambda: float("nan"), "infinite": lambda: float("inf"),
    "tiny": lambda: 5e-324, "large": lambda: 1.7e308, "complex": lambda: 1j, "numpy's complex": lambda: np.complex64(1j),
    "decimal": lambda: decimal.Decimal("sNaN"), "large decimal": lambda: decimal.Decimal("1e9999"), "fraction": lambda: fractions.Fraction(10**400, 3),
    "empty": lambda: "", "null": lambda: "a\0b", "surrogate": lambda: "\ud800", "raw": lambda: raw(b"\xff\xfe"), "long": lambda: "9" * 5000,
    "lines": lambda: "a\nb", "bytes": lambda: b"abc", "path": lambda: pathlib.Path("absent"), "path of bytes": lambda: BytesPath(),
    "scalar array": lambda: np.array(3), "scalar array of nothing": lambda: np.array(None), "scalar array of text": lambda: np.array("x"),
    "scalar array of nan": lambda: np.array(np.nan), "scalar array of huge": lambda: np.array(10**30), "date": lambda: np.datetime64("2020-01-01"),
    "record": lambda: np.zeros((), "i4,f4"), "array": lambda: np.arange(4.0), "rows": lambda: np.ones((2, 3)), "cube": lambda: np.ones((2, 2, 2)),
    "no rows": lambda: np.zeros((0, 3)), "array of objects": lambda: np.array([None, "x", Rude()], object), "array of nan": lambda: np.full((2, 4), np.nan),
    "list": lambda: [], "mixed": lambda: [1, "a", None], "nested": lambda: [[[1]]], "within itself": inside_itself, "set": lambda: {1, 2},
    "dictionary": lambda: {"a": 1}, "object": object, "rude": Rude, "class": lambda: int, "function": lambda: print, "endless": itertools.count,
    "endless texts": lambda: itertools.repeat("x"), "endless in a list": lambda: [itertools.count()], "generator": lambda: (i for i in (1, 2)),
    "slice": lambda: slice(3), "range": lambda: range(3), "memory": lambda: memoryview(b"abc"), "ellipsis": lambda: ...,
}  # fmt: skip


class BytesPath:
    def __fspath__(self):
        return b"\xffabsent"


def tried(call, name):
    """Calls; an exception must be ours, and of one line that names what is wrong."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            call()
        except pysherd.UsageError as e:
            assert name is None or str(e).startswith(name), str(e)[:300]
            assert "incompatible function arguments" not in str(e)
        except pysherd.Error as e:
            assert e.code in (3, 5), repr(e)[:300]


@pytest.mark.parametrize("value", HOSTILE)
def test_options(value):
    """Every keyword of the table."""
    for keyword in _options.ROWS:
        tried(lambda: pysherd.Options(**{keyword: HOSTILE[value]()}), keyword)


@pytest.mark.parametrize("value", HOSTILE)
def test_arguments_of_a_fracture(fracture, value, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made, solid = HOSTILE[value], fracture.solid
    keywords = {"explode", "azimuth", "elevation", "up", "size", "file"}
    assert keywords | {"progress"} == set(list(inspect.signature(pysherd.Fracture.render).parameters)[1:])
    for keyword in sorted(keywords):
        size = {} if keyword == "size" else {"size": (16, 16)}
        tried(lambda: fracture.render(**{keyword: made(), **size}), keyword)
    tried(lambda: fracture.points(made()), "points")
    tried(lambda: fracture.save(made(), write="labels"), "folder")
    tried(lambda: pysherd.load(made()), "folder")
    tried(lambda: pysherd.fracture(solid, pieces=2, device=made()), "device") if isinstance(made(), str) is False else None
    if not callable(made()):
        tried(lambda: pysherd.fracture(solid, pieces=2, progress=made()), "progress")
    for argument in ("pieces", "seeds"):
        tried(lambda: list(itertools.islice(solid.fractures(**{"pieces": 2, argument: made()}), 2)), argument)
    tried(lambda: pysherd.limit_threads(made()), "most")
    pysherd.limit_threads(0)


@pytest.mark.parametrize("value", HOSTILE)
def test_meshes(value):
    """A range and a list of numbers may be used as an index; all else is refused as a mesh, or as vertices or faces."""
    made = HOSTILE[value]
    for mesh in (lambda: made(), lambda: (made(), F), lambda: (V, made()), lambda: [made(), made()]):
        tried(lambda: pysherd.voxelize(mesh(), resolution=8), None)
    for keyword in ("device", "progress", "resolution"):
        if not (keyword == "progress" and callable(made())) and not (keyword == "device" and isinstance(made(), str)):
            tried(lambda: pysherd.voxelize((V, F), **{"resolution": 8, keyword: made()}), keyword)


def test_devices_by_any_name():
    for name in ("a\0b", "\ud800", "", raw(b"\xff")):
        with pytest.raises((pysherd.UsageError, pysherd.DeviceError)) as caught:
            pysherd.fracture((V, F), pieces=2, resolution=8, device=name)
        assert "incompatible" not in str(caught.value)


@pytest.mark.parametrize("call, named", [
    (lambda f: f.render(size=10**19), "size: 10000000000000000000 is no pair"), (lambda f: f.render(size=(10**19, 64)), "size: 10000000000000000000 is not"),
    (lambda f: f.render(explode=10**400), "explode: "), (lambda f: f.render(explode=float("nan")), "explode: nan is not a number in 0..100"),
    (lambda f: f.render(size=(80.5, 60)), "size: 80.5 is not a whole number in 16..16384"), (lambda f: f.render(elevation=91), "elevation: 91"),
    (lambda f: pysherd.fracture((V, F), impact=np.array(3)), "impact: a list is needed"), (lambda f: pysherd.fracture((V, F), pieces=10**5000), "pieces: a value"),
    (lambda f: pysherd.fracture((V, F), impact=itertools.count()), "impact: more than 65536 values"), (lambda f: pysherd.fracture((V, F), progress=3), "progress: 3"),
    (lambda f: list(f.solid.fractures(seeds=[-1])), "seeds: -1"), (lambda f: list(f.solid.fractures(seeds=[2**64])), "seeds: "),
    (lambda f: pysherd.fracture((V, F), seeds="a\0b"), "seeds: 'a.x00b' has a null"), (lambda f: list(f.solid.fractures(seeds=b"12")), "seeds: "),
])  # fmt: skip
def test_usage_errors_by_name(fracture, call, named):
    with pytest.raises(pysherd.UsageError, match="^" + named):
        call(fracture)


def test_arrays_are_values_too(fracture):
    """Of the right number of them."""
    solid = pysherd.voxelize((V, F), resolution=12)
    listed = pysherd.fracture(solid, pieces=np.array(3), impact=[(0, 0, 1, 2)], grain=(0, 1, 0, 2), seed=np.uint64(5)).labels
    for impact in (np.array([[0, 0, 1, 2]]), np.array([0.0, 0, 1, 2]), [np.array([0, 0, 1, 2], np.float32)], [[0, 0, np.array(1), 2]]):
        own = pysherd.fracture(solid, pieces=np.int8(3), impact=impact, grain=np.array([0, 1, 0, 2]), seed=5).labels
        assert np.array_equal(own, listed)
    f = next(solid.fractures(pieces=np.array(2), seeds=np.array(3)))
    assert (len(f), f.seed) == (2, 3) and len(list(solid.fractures(pieces=2, seeds=np.arange(3)))) == 3
    assert fracture.render(size=np.array([32, 16])).shape == (16, 32, 3)


# --- seeds without an end


def test_seeds_are_taken_as_fractures_are():
    solid, taken = pysherd.voxelize((V, F), resolution=8), []

    def seeds():
        for seed in itertools.count():
            taken.append(seed)
            yield seed

    fractures = solid.fractures(pieces=(2,), seeds=seeds())
    assert [next(fractures).seed for _ in range(20)] == list(range(20)) and len(taken) <= 32
    assert next(solid.fractures(pieces=3, seeds=itertools.count(7))).seed == 7
    assert len(next(solid.fractures(pieces=itertools.count(2)))) == 2
    endless = solid.fractures(pieces=(2, 3), seeds=itertools.count())
    assert [(len(f), f.seed) for f in itertools.islice(endless, 20)] == [(2, seed) for seed in range(20)]


def test_each_number_of_pieces_has_each_seed_of_an_iterator():
    solid = pysherd.voxelize((V, F), resolution=8)
    for pieces in ([2, 3], iter([2, 3]), range(2, 4)):
        for seeds in ([4, 5, 6], iter([4, 5, 6]), (s for s in (4, 5, 6)), range(4, 7)):
            pieces = list(pieces)
            assert [(len(f), f.seed) for f in solid.fractures(pieces, seeds)] == [(p, s) for p in (2, 3) for s in (4, 5, 6)]
    assert list(solid.fractures(2, iter(()))) == list(solid.fractures((), 3)) == []


@pytest.mark.parametrize("bad", ["raises", "x"])
def test_what_ends_an_iterator_comes_after_the_fractures_before(bad):
    def seeds():
        yield from (1, 2, 3)
        if bad == "raises":
            raise KeyError("own")
        yield bad

    fractures = pysherd.voxelize((V, F), resolution=8).fractures(pieces=2, seeds=seeds())
    assert [next(fractures).seed for _ in range(3)] == [1, 2, 3]
    with pytest.raises(KeyError if bad == "raises" else pysherd.UsageError):
        next(fractures)


# --- paths of any bytes


@pytest.fixture
def raw_folder(tmp_path):
    folder = os.path.join(os.fsencode(tmp_path), b"f\xff\xfe")
    os.mkdir(folder)
    return folder


def spelled(path):
    """A path as bytes, as text, and as objects."""

    class Path:
        def __init__(self, of):
            self.of = of

        def __fspath__(self):
            return self.of

    return path, os.fsdecode(path), pathlib.Path(os.fsdecode(path)), Path(path)


def test_paths_of_any_bytes(raw_folder, fracture):
    fracture.save(os.path.join(raw_folder, b"first"), write=["mesh", "labels", "solid", "vdb"])
    mesh = os.path.join(raw_folder, b"m\xe9.stl")
    with open(mesh, "wb") as file:
        corners = V[F].astype("<f4")
        file.write(bytes(80) + len(F).to_bytes(4, "little") + b"".join(bytes(12) + c.tobytes() + bytes(2) for c in corners))
    for number, path in enumerate(spelled(mesh)):
        solid = pysherd.voxelize(path, resolution=8)
        assert os.fsencode(solid.name) == b"m\xe9.stl" and len(pysherd.fracture(path, pieces=2, resolution=8)) == 2
        assert "m" in repr(solid)
    for path in spelled(os.path.join(raw_folder, b"out\xff")):
        fracture.save(path, write=["mesh", "labels", "solid", "vdb"])
        for loaded in (path, os.path.join(os.fsencode(path), b"manifest.json")):
            assert np.array_equal(pysherd.load(loaded).labels, fracture.labels)
    for ending in (b".png", b".exr"):
        for path in spelled(os.path.join(raw_folder, b"i\xff" + ending)):
            fracture.render(path, size=(16, 16))
            assert os.path.getsize(path) > 0
            os.remove(path)
    grid = os.path.join(raw_folder, b"g\xff.vdb")
    os.link(os.path.join(raw_folder, b"first", b"fragments", os.listdir(os.path.join(raw_folder, b"first", b"fragments"))[0]), grid)
    assert os.fsencode(pysherd.voxelize(grid).name) == b"g\xff.vdb"


def test_options_that_are_paths_of_any_bytes(raw_folder, fracture):
    fracture.save(os.path.join(raw_folder, b"first"), write=["seeds", "labels"])
    seeds = os.path.join(raw_folder, b"first", b"seeds.json")
    for path in spelled(seeds):
        assert len(pysherd.fracture(fracture.solid, seeds=path)) == len(fracture)
    absent = os.path.join(raw_folder, b"a\xff.obj")
    for path in spelled(absent):
        for options in ({"guide": path, "growth": "sequential"}, {"guide": [path], "growth": "sequential"}, {"seeds": path}):
            with pytest.raises(pysherd.Error) as caught:
                pysherd.fracture(fracture.solid, **options)
            assert os.fsencode(str(caught.value)).startswith(absent) or b"a\xff.obj" in os.fsencode(str(caught.value))


def test_errors_name_paths_of_any_bytes(raw_folder, fracture):
    absent = os.path.join(raw_folder, b"a\xff.obj")
    for call in (pysherd.voxelize, pysherd.fracture, pysherd.load):
        for path in spelled(absent):
            with pytest.raises(pysherd.FileError) as caught:
                call(path)
            assert absent in os.fsencode(str(caught.value))
    with open(os.path.join(raw_folder, b"x"), "w"):
        pass
    with pytest.raises(pysherd.OutputError) as caught:
        fracture.save(raw_folder)
    assert b"\xff\xfe" in os.fsencode(str(caught.value))


def test_a_gltf_that_names_raw_bytes_is_an_error_with_its_file(tmp_path):
    head = '{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"%s"}],"meshes":[{"primitives":[{"attributes":{}}]}],"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}]}'
    for uri in (b"%ff%fe.bin", b"\xff\xfe.bin", b"%00.bin", b"data:;base64,\xff"):
        (tmp_path / "a.gltf").write_bytes(head.encode().replace(b"%s", uri))
        with pytest.raises(pysherd.FileError, match="^a.gltf: "):
            pysherd.voxelize(tmp_path / "a.gltf")
