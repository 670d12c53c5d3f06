"""Pickles: the same object again, and an InputError for what is damaged, forged, or of another version."""
import collections
import copyreg
import json
import os
import pickle
import struct
import warnings
import zlib

import damages
import numpy as np
import pytest
from conftest import cube, run

import pysherd
from pysherd import _core
from pysherd._options import _options_again
from pysherd._pickles import broken_again, fragment_again, loaded_again, parts_again, solid_again

OURS = {"solid": solid_again, "fracture": broken_again, "loaded": loaded_again, "again": parts_again, "fragment": fragment_again, "options": _options_again}


@pytest.fixture(scope="module")
def subjects(tmp_path_factory):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return damages.subjects(tmp_path_factory.mktemp("pickles"))


NAMES = ["textured", "arrays", "volume", "level set", "fracture", "exact", "fragment", "several", "loaded", "options"]


@pytest.mark.parametrize("name", NAMES)
def test_what_issolid_again_is_the_same(subjects, name):
    data = pickle.dumps(subjects[name])
    assert damages.outcome(data, True, subjects[name]) == "same"
    assert 1 <= len(damages.states_in(data)) <= 4


@pytest.mark.parametrize("name", NAMES)
def test_a_damaged_pickle_is_refused_or_the_same(subjects, name):
    """Where the damage is in our states; tests/long/pickles.py does this 2000 times with all, each in a process that may crash."""
    data = pickle.dumps(subjects[name])
    places, number, seen = damages.states_in(data), 0, 0
    while number < 40 or seen < 10:  # a small state is hit less often than the rest of its pickle
        number += 1
        out, is_within = damages.one(data, f"{name} {number}", places)
        if is_within:  # else operations of pickle are damaged, which may take any memory
            assert damages.outcome(out, True, subjects[name]) in ("refused", "same"), number
            seen += 1


@pytest.mark.parametrize("name", ["textured", "volume", "fracture", "options", "fragment"])
def test_each_byte_of_a_state_is_checked(subjects, name):
    data = pickle.dumps(subjects[name])
    for begin, end in damages.states_in(data):
        for at in [*range(begin, min(begin + 40, end)), *range(max(begin, end - 8), end)]:
            changed = bytearray(data)
            changed[at] ^= 1 << at % 8
            assert damages.outcome(bytes(changed), True, subjects[name]) == "refused", at


@pytest.mark.parametrize("ours", OURS)
@pytest.mark.parametrize("state", [(), (None,), ({"name": b""},), (b"",), (b"x" * 99, 2), ("text",), (bytearray(99),), (1, 2, 3)], ids=repr)
def test_any_arguments_are_refused(ours, state):
    """A damaged pickle may call the functions that it names with any: such as the dictionary that a state once was."""
    with pytest.raises(pysherd.InputError, match="^this pickle of (a |options)"):
        OURS[ours](*state)


def test_a_fracture_of_given_seeds_is_saved_and_pickled(subjects, tmp_path):
    """Its options have no number of pieces, which cannot be given with seeds."""
    subjects["fracture"].save(tmp_path / "first", write=["seeds", "labels"])
    f = pysherd.fracture(subjects["fracture"].solid, seeds=tmp_path / "first" / "seeds.json")
    f.save(tmp_path / "second", write=["labels", "mesh"])
    assert "pieces" not in f.options and len(f) == 3
    assert np.array_equal(pickle.loads(pickle.dumps(f)).labels, f.labels)
    (tmp_path / "first" / "seeds.json").unlink()
    assert np.array_equal(pysherd.load(tmp_path / "second").labels, f.labels)


@pytest.mark.parametrize("number", [1, 9])
def test_another_version_is_named(subjects, number):
    state = bytearray(subjects["arrays"]._core.state)
    state[7] = number
    with pytest.raises(pysherd.InputError, match=f"another version of pysherd.*format {number}, and format 3 is read; make it again"):
        solid_again(bytes(state))


def test_a_state_of_another_kind_is_refused(subjects):
    with pytest.raises(pysherd.InputError, match="another kind"):
        _options_again(subjects["arrays"]._core.state)


def test_a_fracture_of_another_solid_is_refused(subjects):
    solid, (function, (_, state)) = pysherd.voxelize(cube(2), resolution=12), copyreg.dispatch_table[pysherd.Fracture](subjects["fracture"])
    with pytest.raises(pysherd.InputError, match="the solid of another fracture"):
        function(solid, state)


# The content of a solid's state, field by field: arrays have their length before them, lists a 1 and theirs.


def array(items):
    data = np.ascontiguousarray(items)
    return struct.pack("<Q", len(data)) + data.tobytes()


def text(value):
    return struct.pack("<Q", len(value)) + value


def several(items):
    return struct.pack("<QQ", 1, len(items)) + b"".join(items)


def one(number, kind="Q"):
    return struct.pack("<Q" + kind, 1, number)


def state_of_format_1(**fields):
    """As solids were pickled before they had an offset, with a right checksum."""
    state = bytearray(_core.sealed("solid", b"".join(value for key, value in solid_fields(**fields).items() if key != "offset"))[:-4])
    state[7] = 1
    return bytes(state) + zlib.crc32(state).to_bytes(4, "little")


def solid_state(**fields):
    """A state of a cube, whose checksum is right, with some fields replaced."""
    return _core.sealed("solid", b"".join(solid_fields(**fields).values()))


def solid_fields(**fields):
    vertices, faces = cube()
    content = {
        "given": several([text(b"resolution") + text(b"12")]), "own_voxel_size": one(0.0, "d"), "level_set": text(b""),
        "offset": array(np.zeros((0, 3))), "name": text(b"mesh"), "stem": text(b"mesh"), "sha256": text(b"0" * 64),
        "vertices": array(vertices), "triangles": array(faces.astype(np.uint32)), "neighbor": array([]), "texcoords": array([]), "colors": array([]), "material": array([]), "normals": array([]), "materials": several([]),
        "textures": several([]), "objects": several([]), "object_of_triangle": array([]), "polygons": array([]), "grids": several([]),
        "warnings": several([]), "file_vertices": one(8), "degenerate": one(0), "dropped_vertices": one(0), "dropped_triangles": one(0),
        "isovalue": several([]),
        "unit": one(1.0, "d"), "up": one(b"y", "c"), "unit_from": one(0, "i"), "up_from": one(0, "i"),
    }  # fmt: skip
    assert fields.keys() <= content.keys()
    return {**content, **fields}


def test_the_state_that_forgeries_begin_with_is_right():
    assert solid_again(solid_state()).voxels == pysherd.voxelize(cube(), resolution=12).voxels
    state = solid_state()
    assert zlib.crc32(state[:-4]) == int.from_bytes(state[-4:], "little")


def test_a_solid_of_an_older_version_is_refused():
    with pytest.raises(pysherd.InputError, match="^this pickle of a solid is of another version of pysherd or damaged: its state has format 1, and format 3 is read; make it again$"):
        solid_again(state_of_format_1())


V, F = cube()
MATERIAL = text(b"m") + struct.pack("<Q3f", 1, 1, 1, 1)


@pytest.mark.parametrize("named, fields", [
    ("triangle 1 uses vertex 8, there are 8", {"triangles": array(np.where(F == F[0, 0], 8, F).astype(np.uint32))}),
    ("uses vertex 4294967295", {"triangles": array(np.full((1, 3), -1, np.int32))}),
    ("has an offset that is not finite", {"offset": array(np.array([[0.0, np.nan, 0.0]]))}),
    ("has several offsets", {"offset": array(np.zeros((2, 3)))}),
    ("has equal corners", {"triangles": array(np.zeros((2, 3), np.uint32))}),
    ("vertex 3 is not finite", {"vertices": array(np.where(np.arange(8)[:, None] == 2, np.nan, V))}),
    ("is 1e\\+40 long along x", {"vertices": array(V * 1e40)}),
    ("neither a mesh nor a level set", {"triangles": array(np.zeros((0, 3), np.uint32))}),
    ("both a mesh and a level set", {"level_set": text(b"x")}),
    ("has 11 materials for 12 triangles", {"material": array(np.zeros(11, np.uint32)), "materials": several([MATERIAL + one(-1, "i") + text(b"")])}),
    ("has 13 texture coordinates for 12", {"texcoords": array(np.zeros((13, 6), np.float32))}),
    ("has 1 normals for 12", {"normals": array(np.zeros((1, 9), np.float32))}),
    ("normals is no unit vector", {"normals": array(np.zeros((12, 9), np.float32))}),
    ("has 3 colors for 12", {"colors": array(np.zeros((3, 9), np.uint8))}),
    ("has 2 neighbors for 12", {"neighbor": array(np.zeros(2, np.uint16))}),
    ("has 2 objects for 12", {"object_of_triangle": array(np.zeros(2, np.uint32))}),
    ("has 2 places in faces for 12", {"polygons": array(np.zeros((2, 4), np.uint32))}),
    ("has material 7, there are 0", {"material": array(np.full(12, 7, np.uint32))}),
    ("has object 1, there are 1", {"object_of_triangle": array(np.ones(12, np.uint32)), "objects": several([text(b"a")])}),
    ("has texture 3, there are 0", {"materials": several([MATERIAL + one(3, "i") + text(b"")])}),
    ("has texture -2, there are 0", {"materials": several([MATERIAL + one(-2, "i") + text(b"")])}),
    ("is no object of JSON", {"materials": several([MATERIAL + one(-1, "i") + text(b'{"a":' * 20000 + b"1" + b"}" * 20000)])}),
    ("color that is not finite", {"materials": several([text(b"m") + struct.pack("<Q3f", 1, 1, np.nan, 1) + one(-1, "i") + text(b"")])}),
    ("arrays do not fill its state", {"vertices": struct.pack("<Q", 2**61) + V.tobytes()}),
    ("arrays do not fill its state", {"textures": struct.pack("<QQ", 1, 2**60)}),
    ("arrays do not fill its state", {"isovalue": several([]) + b"x"}),
    ("arrays do not fill its state", {"isovalue": several([one(0.5, "d")] * 2)}),
    ("isovalue that is not finite", {"isovalue": several([one(np.inf, "d")])}),
    ("whose size is no length", {"own_voxel_size": one(np.nan, "d")}),
    ("whose size is no length", {"own_voxel_size": one(-1.0, "d")}),
    ("coordinates without a unit", {"unit": one(np.nan, "d")}),
    ("coordinates without a unit", {"unit": one(0.0, "d")}),
    ("coordinates without a unit", {"up": one(b"w", "c")}),
    ("coordinates without a unit", {"up_from": one(7, "i")}),
    ("name that is none of a file", {"stem": text(b"../../x")}),
    ("name that is none of a file", {"name": text(b"a\0b")}),
    ("resolution: ", {"given": several([text(b"resolution") + text(b"1e9")])}),
    ("level set of this pickle cannot be read", {"level_set": text(b"no vdb"), "triangles": array(np.zeros((0, 3), np.uint32))}),
], ids=lambda v: v if isinstance(v, str) else "-".join(v))  # fmt: skip
def test_a_forged_state_is_refused_as_a_file_is(named, fields):
    with pytest.raises(pysherd.InputError, match=named) as caught:
        solid_again(solid_state(**fields))
    assert "\n" not in str(caught.value) and not str(caught.value).endswith(".")


def test_voxels_that_are_too_many_for_the_memory_are_refused():
    with pytest.raises(pysherd.InputError, match="voxel|memory"):
        solid_again(solid_state(own_voxel_size=one(1e-12, "d")))


@pytest.mark.parametrize("name", ["textured", "arrays", "volume", "exact"])
def test_states_with_a_right_checksum_are_checked_too(subjects, name, tmp_path):
    solid = subjects[name] if isinstance(subjects[name], pysherd.Solid) else subjects[name].solid
    rng, found = damages.generator(name), collections.Counter()
    for _ in range(12):
        found[damages.forgery(solid._core.state, rng, tmp_path / "out")] += 1
    assert set(found) <= {"refused", "used", "refused later"} and found["refused"] > 0


@pytest.mark.parametrize("content", [b"", b"3", b"null", b"[]", b"[[],0]", b'[[["pieces","3"]],"x"]', b"[" * 100000])
def test_a_forged_fracture_is_refused(subjects, content):
    with pytest.raises(pysherd.InputError):
        broken_again(subjects["arrays"], _core.sealed("fracture", content))
    with pytest.raises((pysherd.InputError, pysherd.FileError)):
        loaded_again(_core.sealed("fracture", content))


@pytest.mark.parametrize("given", [[["pieces", "0"]], [["pieces", "x"]], [["pieces"]], 3, [[3, 4]], [["seeds", "absent.json"]]], ids=str)
def test_options_of_a_forged_fracture_are_checked(subjects, given):
    state = _core.sealed("fracture", json.dumps([given, subjects["arrays"]._identity]).encode())
    with pytest.raises(pysherd.InputError):
        broken_again(subjects["arrays"], state)


@pytest.mark.parametrize("index", [b"", b"x", b"3", b"-1", b"1e3", b"9" * 5000])
def test_a_forged_fragment_is_refused(subjects, index):
    with pytest.raises(pysherd.InputError):
        fragment_again(subjects["fracture"], _core.sealed("fragment", index))


@pytest.mark.parametrize("content", [b"", b"x", pickle.dumps(3), pickle.dumps({"piece": 3}), pickle.dumps({"pieces": 0}), pickle.dumps({3: 3})])
def test_forged_options_are_refused(content):
    with pytest.raises(pysherd.InputError):
        _options_again(_core.sealed("options", content))


FULL = """
import pickle, resource, sys, pysherd
state = pickle.loads(open(sys.argv[1], "rb").read())
from pysherd._pickles import solid_again
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
try:
    solid_again(state)
except pysherd.OutputError as e:
    print("refused:", e)
"""


def test_a_full_disk_is_an_output_error(subjects, tmp_path):
    """A level set is read from a temporary file, which may not be written whole: by a limit on the size of files, as by a full disk."""
    (tmp_path / "state").write_bytes(pickle.dumps(subjects["level set"]._core.state))
    (tmp_path / "tmp").mkdir()
    done = run(FULL, tmp_path / "state", env={**os.environ, "TMPDIR": str(tmp_path / "tmp")})
    assert "refused: " in done.stdout and "too large after 4 kB" in done.stdout, done.stdout + done.stderr
    assert list((tmp_path / "tmp").iterdir()) == []


def test_a_level_set_of_a_named_grid_is_pickled(subjects, tmp_path):
    solid = subjects["level set"]
    f = pysherd.fracture(solid, pieces=2)
    f.save(tmp_path / "out", write=["vdb", "solid"])
    named = pysherd.voxelize(next((tmp_path / "out" / "fragments").glob("*.vdb")), grid="surface")
    assert np.array_equal(pysherd.fracture(pickle.loads(pickle.dumps(named)), pieces=2).labels, pysherd.fracture(named, pieces=2).labels)


@pytest.mark.parametrize("content", [b"", b"3", b"[]", b"[[9],[]]", b"[[0],[]]", b"[[],[]]", b'[["x"],[]]', b'[[1],[["pieces","x"]]]', b'[1,2]'])
def test_forged_parts_are_refused(subjects, content):
    with pytest.raises(pysherd.InputError):
        parts_again(subjects["fracture"], _core.sealed("fracture", content))
