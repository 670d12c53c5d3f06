"""Pickles and damages of them, for test_pickles.py and tests/long/pickles.py.

An outcome of a damaged pickle is "refused" (pysherd.InputError), "same" (an equal object), "python" (an exception of pickle itself, or an object
that is none of ours, where the damage lies outside of our states), else a sentence about what must not be.
"""
import os
import pickle
import random
import traceback

import numpy as np
from conftest import AMPHORA, cube

import pysherd
from pysherd import _core

BEGIN = b"sherd\0\0\3"  # of each state
SUM = 4  # bytes of its checksum

BOX = """mtllib box.mtl
g left
usemtl painted
{corners}
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/1 2/2 4/3 3/4
f 5/1 7/2 8/3 6/4
f 1/1 5/2 6/3 2/4
g right
f 3/1 4/2 8/3 7/4
f 1/1 3/2 7/3 5/4
f 2/1 6/2 8/3 4/4
"""
# What the state of pickle itself may raise where its own operations are damaged.
PYTHONS = (pickle.UnpicklingError, EOFError, AttributeError, ImportError, LookupError, TypeError, ValueError, MemoryError, OverflowError)


def subjects(folder):
    """Objects of every kind that is pickled, by names."""
    (folder / "box.obj").write_text(BOX.format(corners="\n".join("v {} {} {}".format(*v) for v in cube()[0])))
    (folder / "box.mtl").write_text("newmtl painted\nKd 0.5 0.25 1\nmap_Kd wood.png\n")
    plain = pysherd.voxelize(cube(), resolution=12)
    f = pysherd.fracture(plain, pieces=3, seed=2)
    f.render(folder / "wood.png", size=(16, 16))
    f.save(folder / "saved", write=["labels", "mesh", "solid", "vdb"])
    ball = np.sum((np.indices((12, 12, 12)) - 5.5) ** 2, axis=0) < 25
    level_set = pysherd.voxelize(next((folder / "saved" / "fragments").glob("*.vdb")))
    assert not level_set._core.keeps_mesh
    return {
        "textured": pysherd.voxelize(folder / "box.obj", resolution=12), "scan": pysherd.voxelize(AMPHORA, resolution=16), "arrays": plain,
        "volume": pysherd.voxelize(ball), "level set": level_set, "fracture": f, "exact": pysherd.fracture(cube(), pieces=2, resolution=12, surface="exact"),
        "fragment": f[1], "several": [f[0], f, plain], "loaded": pysherd.load(folder / "saved"), "options": pysherd.Options(pieces=3, grain=(0, 0, 1, 2)),
    }  # fmt: skip


def content(value):
    """What makes a thing equal to another."""
    if isinstance(value, list):
        return [content(item) for item in value]
    if isinstance(value, pysherd.Fragment):
        return value.id, content(value._fracture)
    if isinstance(value, pysherd.Fracture):
        return len(value), value.seed, sorted(value.options.items(), key=str), value.labels.tobytes()
    if isinstance(value, pysherd.Solid):
        return value.shape, value.voxels, value.voxel_size, value.name, value.origin.tolist(), value._core.given, value._core.state
    return type(value), dict(value)


def states_in(data):
    """Returns where the states in a pickle begin and end."""
    places, at = [], data.find(BEGIN)
    while at >= 0:
        end = at + 24 + int.from_bytes(data[at + 16 : at + 24], "little") + SUM
        places.append((at, end))
        at = data.find(BEGIN, end)
    return places


def damaged(data, rng):
    """Returns damaged bytes, and where the first and the last that may differ are in the original."""
    out, at, kind = bytearray(data), rng.randrange(len(data)), rng.randrange(8)
    if kind == 0:  # a cut
        return bytes(out[:at]), at, len(data)
    if kind == 1:  # bytes left out
        end = min(len(data), at + rng.choice((1, 2, 8, 100)))
        return bytes(out[:at] + out[end:]), at, end
    if kind == 2:  # bytes that come twice
        end = min(len(data), at + rng.choice((1, 4, 64)))
        return bytes(out[:end] + out[at:]), at, end
    if kind == 3:  # a block of zeros
        end = min(len(data), at + rng.choice((4, 16, 512)))
        out[at:end] = bytes(end - at)
    elif kind == 4:  # a word of bytes that are dangerous as numbers
        word = rng.choice((b"\xff\xff\xff\xff", b"\0\0\0\x80", b"\0\0\xc0\x7f", b"\0\0\0\0\0\0\xf8\x7f", b"\xff" * 8))
        end = min(len(data), at + len(word))
        out[at:end] = word[: end - at]
    elif kind == 5:  # two parts in each other's place
        other, size = rng.randrange(len(data)), rng.choice((1, 8, 32))
        at, other = min(at, other), max(at, other)
        size = min(size, len(data) - other, max(1, other - at))
        out[at : at + size], out[other : other + size] = out[other : other + size], out[at : at + size]
        end = other + size
    else:  # a byte, or a bit of it
        out[at], end = (rng.randrange(256) if kind == 6 else out[at] ^ 1 << rng.randrange(8)), at + 1
    return bytes(out), at, end


def one(data, seed, places):
    """Returns damaged bytes, and whether all damage is within a state and leaves all where it was."""
    out, first, last = damaged(data, generator(seed))
    return out, len(out) == len(data) and any(begin <= first and last <= end for begin, end in places)


def is_raised_in_pysherd(exception):
    folder = os.path.dirname(pysherd.__file__)
    return any(frame.filename.startswith(folder) for frame in traceback.extract_tb(exception.__traceback__))


def outcome(data, is_within, expected):
    """Unpickles; exceptions of pickle itself are right where damage is outside of our states."""
    try:
        value = pickle.loads(data)
    except pysherd.InputError as e:
        return "refused" if "\n" not in str(e) else f"InputError of several lines: {e}"
    except PYTHONS as e:
        return f"{type(e).__name__}: {e}" if is_within or isinstance(e, pysherd.Error) or is_raised_in_pysherd(e) else "python"
    if type(value) is type(expected) and content(value) == content(expected):
        return "same"
    is_ours = is_within or type(value).__module__.startswith("pysherd")  # else pickle itself made something else
    return f"another object: {value!r}" if is_ours else "python"


def forged(state, rng):
    """Returns a state whose content is damaged and whose checksum is right."""
    kind = state[8:16].rstrip(b"\0").decode()
    inside, _, _ = damaged(state[24:-SUM], rng)
    return _core.sealed(kind, inside)


def use(value):
    """Does what would crash by numbers that were not checked."""
    if isinstance(value, pysherd.Solid):
        value = pysherd.fracture(value, pieces=2)
    if isinstance(value, pysherd.Fracture):
        value.labels, value.contacts, value.points(3), value[0].vertices


def forgery(state, rng, folder):
    """Unpickles a state that was forged, and uses what comes out; returns the outcome."""
    from pysherd._pickles import solid_again

    try:
        value = solid_again(forged(state, rng))
    except pysherd.InputError:
        return "refused"
    except Exception as e:
        return f"{type(e).__name__}: {e}"
    try:
        use(value)
        pysherd.fracture(value, pieces=2).save(folder, write="mesh", mesh_format=["obj", "glb", "ply"])
    except pysherd.Error as e:
        return "refused later" if e.code in (2, 3) else f"{type(e).__name__}: {e}"
    return "used"


def generator(seed):
    return random.Random(seed)
