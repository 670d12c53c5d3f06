"""What a fracture gives, and that it is what the program gives."""
import gc
import json
import pickle
import warnings
import weakref

import numpy as np
import pytest
from conftest import AMPHORA, cube, program

import pysherd

# Names of rows with values, as keywords: every group of the table, and what changes how meshes are made.
SETS = [
    {},
    {"pieces": 1},
    {"pieces": 20, "seed": 18446744073709551615},
    {"roughness": 1.0},
    {"roughness": "0.8%,0.6"},
    {"extra_seeds": "2n", "merge_metric": "euclidean"},
    {"extra_seeds": "4n", "size_spread": 2},
    {"growth": "flood", "neighborhood": 26},
    {"growth": "nearest", "metric": "manhattan"},
    {"growth": "chain"},
    {"grain": (0, 1, 0, 3)},
    {"roughness": (2, 0.75), "propagation": (1, 0, 0, 0.6)},
    {"material": "wood"},
    {"material": "plaster", "roughness": "1%", "grain": (0, 1, 0, 2)},
    {"sampler": "poisson", "seeds_on": "surface"},
    {"impacts": 2, "pieces": 7},
    {"impact": [(0.1357, 0.2515, 0.0, 3), "ray:0,1,0,0,-1,0,2"], "pieces": 9},
    {"min_share": 0.05, "balance": 2},
    {"erode_iterations": 2, "erode_probability": 0.5, "erode_shape": "square"},
    {"missing": 2, "drop_share": 0.01},
    {"surface": "labels", "smooth_iterations": 3},
    {"surface": "exact"},
    {"bodies": "keep"},
    {"interface": "independent", "adaptivity": 0.5},
    {"preset": "paper", "resolution": 40, "pieces": 5},
    {"preset": "training", "resolution": 40, "pieces": 5},
    {"smooth_iterations": "0.05k", "smooth_boundary_iterations": 2, "smoothing": "laplacian", "triangles": [200]},
    {"voxel_size": 0.01, "fill": "shell", "shell_thickness": 0.02},
]


def arguments_of(options):
    """The options as the command line has them."""
    for keyword, value in options.items():
        name = "--" + keyword.replace("_", "-")
        values = value if keyword == "impact" else [value]
        for one in values:
            yield f"{name}={one if not isinstance(one, (tuple, list)) else ','.join(map(str, one))}"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("options", SETS, ids=lambda o: ",".join(o) or "defaults")
def test_the_program_gives_the_same(options, tmp_path):
    options = {"pieces": 6, "seed": 5, **({} if "voxel_size" in options else {"resolution": 40}), **options}
    program(AMPHORA, tmp_path / "program", *arguments_of(options), "--precision=double", "--voxel-format=npy", "--write=labels,mesh")
    f = pysherd.fracture(AMPHORA, **options)
    theirs = np.load(tmp_path / "program" / "labels.npy").astype(int) - 1  # 0 of the file: outside, 1: in no fragment
    assert np.array_equal(np.select([theirs < 0, theirs == 0], [0, 65535], theirs), f.labels)
    manifest = json.loads((tmp_path / "program" / "manifest.json").read_text())
    read = pysherd.load(tmp_path / "program")
    assert len(f) == len(read) == len(manifest["fragments"])
    for own, other, listed in zip(f, read, manifest["fragments"]):
        assert np.array_equal(own.vertices, other.vertices)
        assert np.array_equal(own.faces, other.faces)
        assert np.array_equal(own.neighbor, other.neighbor)
        assert own.voxels == listed["voxels"]
        assert own.volume == pytest.approx(listed["volume"], rel=1e-9)


def files_of(folder):
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_saving_writes_what_the_program_writes(tmp_path):
    options = {"pieces": 5, "seed": 2, "resolution": 40, "roughness": 1}
    program(AMPHORA, tmp_path / "program", *arguments_of(options), "--write=labels,vdb,mesh,preview,seeds,scene,graph,viewer", "--points=50")
    f = pysherd.fracture(AMPHORA, **options)
    f.contacts  # measured before: nothing of it is left in what is written
    f.save(tmp_path / "module", write=["labels", "vdb", "mesh", "preview", "seeds", "scene", "graph", "viewer"], points=50)
    theirs, ours = files_of(tmp_path / "program"), files_of(tmp_path / "module")
    assert theirs.keys() == ours.keys()
    assert [name for name in theirs if theirs[name] != ours[name]] == []


def test_options_of_a_material_are_read_back(tmp_path):
    """What overrides a material does so again, also where it is the default, or no value."""
    own = {"pieces": 3, "resolution": 24, "material": "wood", "roughness": "0.8%", "grain": "none", "propagation": "none"}
    pysherd.fracture(cube(2.0), **own).save(tmp_path / "one", write=["labels", "vdb", "mesh"])
    options = pysherd.load(tmp_path / "one").options
    assert (options["material"], options["grain"], options["propagation"]) == ("wood", "none", "none")
    again = pysherd.fracture(cube(2.0), **options)
    assert np.array_equal(again.labels, pysherd.fracture(cube(2.0), **own).labels)


def test_points_are_those_of_the_program(tmp_path):
    program(AMPHORA, tmp_path / "p", "--pieces=4", "--resolution=40", "--points=100", "--point-format=npz", "--write=points")
    points = pysherd.fracture(AMPHORA, pieces=4, resolution=40).points(100)
    for i, file in enumerate(sorted((tmp_path / "p" / "points").glob("*.npz")), 1):
        theirs, own = np.load(file), points.fragment == i
        assert np.array_equal(theirs["positions"], points.positions[own].astype(np.float32))
        assert np.array_equal(theirs["neighbor"], points.neighbor[own])


def test_source_faces_are_those_of_the_program(tmp_path):
    """As a .ply has them, whose faces have a count, three corners, a neighbor and the face of the input."""
    for name, options in ("smooth", {}), ("exact", {"surface": "exact"}):
        options = {"pieces": 4, "resolution": 40, "source_faces": True, **options}
        program(AMPHORA, tmp_path / name, *(f"--{k.replace('_', '-')}" if v is True else f"--{k}={v}" for k, v in options.items()), "--write=mesh")
        f = pysherd.fracture(AMPHORA, **options)
        for own in f:
            head, body = (tmp_path / name / "meshes" / f"amphora_00{own.id}.ply").read_bytes().split(b"end_header\n", 1)
            assert head.endswith(b"property int neighbor\nproperty int source_face\n")
            faces = np.frombuffer(body[-21 * len(own.faces):], [("n", "u1"), ("at", "<i4", 3), ("neighbor", "<i4"), ("source", "<i4")])
            assert np.array_equal(faces["source"], own.source_faces)
            assert own.source_faces is own.source_faces and own.source_faces.dtype == np.int32
            assert np.array_equal(own.source_faces == -1, own.neighbor != 0)
        f.save(tmp_path / "saved")
        saved, written = ({n: b for n, b in files_of(tmp_path / folder).items() if n.endswith(".ply")} for folder in ("saved", name))
        assert saved == written


def test_source_faces_of_arrays_are_rows(fracture):
    vertices, faces = cube()
    faces = np.concatenate([[[0, 0, 1]], faces])  # the first one is dropped
    f = pysherd.fracture((vertices, faces), pieces=3, resolution=24, source_faces=True, surface="exact")
    assert set(np.concatenate([own.source_faces for own in f])) == {-1, *range(1, len(faces))}
    assert fracture[0].source_faces is None


def test_points_are_shared_by_area(fracture):
    points = fracture.points(1000, share_points=True, point_sampler="halton")
    assert len(points.positions) == len(points.normals) == len(points.neighbor) == 1000
    counts = np.bincount(points.fragment, minlength=len(fracture) + 1)[1:]
    areas = np.array([f.area for f in fracture])
    assert np.abs(counts - 1000 * areas / areas.sum()).max() <= 1
    assert np.allclose(np.linalg.norm(points.normals, axis=1), 1)


def test_more_points_than_memory_holds_are_refused():
    f = pysherd.fracture(cube(2.0), pieces=1000, seed=1, resolution=32)
    with pytest.raises(pysherd.UsageError, match=r"sampling 10000000000 points on 1000 fragments takes up to 1\.04e\+03 GB of memory, and [\d.]+ GB may be used"):
        f.points(10_000_000)


def test_points_of_meshes_with_surfaces_of_their_own(amphora):
    f = pysherd.fracture(amphora, pieces=3, interface="independent")
    assert len(f.points(20).positions) == 60


def test_fragments_fill_the_cube():
    f = pysherd.fracture(cube(2.0), pieces=5, seed=1, resolution=32)
    assert sum(g.volume for g in f) == pytest.approx(8, rel=0.02)
    for g in f:
        corners = g.vertices[g.faces]
        volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        assert volume == pytest.approx(g.volume, rel=1e-9)
        assert g.fracture_area < g.area
        assert g.inertia.shape == (3, 3) and g.centroid.shape == (3,)


def test_labels_and_contacts_agree(fracture):
    labels = fracture.labels
    assert labels.dtype == np.uint16 and labels.shape == fracture.solid.shape
    assert set(np.unique(labels)) == {0, *range(1, len(fracture) + 1)}
    pairs = set()
    for axis in range(3):
        a, b = np.moveaxis(labels, axis, 0)[:-1], np.moveaxis(labels, axis, 0)[1:]
        touching = (a != b) & (a > 0) & (b > 0)
        pairs |= {tuple(sorted(p)) for p in zip(a[touching].tolist(), b[touching].tolist())}
    assert pairs == {tuple(p) for p in fracture.contacts.fragments.tolist()}
    sparse = fracture.sparse_labels
    assert np.array_equal(labels[tuple(sparse.voxels.T)], sparse.labels)
    assert len(sparse.labels) == fracture.solid.voxels


def test_many_fractures_equal_single_ones(amphora):
    many = list(amphora.fractures(pieces=range(2, 5), seeds=range(8), extra_seeds="2n"))
    assert [(len(f), f.seed) for f in many] == [(p, s) for p in (2, 3, 4) for s in range(8)]
    for f in many[::7]:
        own = pysherd.fracture(amphora, pieces=len(f), seed=f.seed, extra_seeds="2n")
        assert np.array_equal(f.labels, own.labels)
        assert np.array_equal(f[0].vertices, own[0].vertices)
        assert f.options == own.options


def test_arrays_survive_their_owner():
    f = pysherd.fracture(cube(), pieces=2, resolution=16)
    arrays = [f[0].vertices, f[0].faces, f[0].neighbor, f.labels, f.contacts.area, *f.points(10)]
    copies = [a.copy() for a in arrays]
    del f
    for _ in range(20):
        pysherd.fracture(cube(), pieces=3, resolution=16)[0].vertices
    for array, copy in zip(arrays, copies):
        assert np.array_equal(array, copy)
        assert array.flags.writeable
        array[...] = 0  # its own memory


def test_what_is_written_into_arrays_changes_nothing_else(amphora):
    """Also where points and images need the meshes, whose arrays are given away: they are made again then."""
    for options in ({}, {"surface": "labels"}, {"surface": "exact"}):
        solid = pysherd.voxelize(AMPHORA, resolution=32, surface="exact") if "exact" in options.values() else amphora
        untouched, f = (pysherd.fracture(solid, pieces=3, **options) for _ in range(2))
        f[1].vertices[...] = np.nan
        f[2].faces[...] = 0
        assert np.isnan(f[1].vertices).all()  # the same array at each reading
        assert np.array_equal(f.points(50).positions, untouched.points(50).positions)
        assert np.array_equal(f.render(size=(64, 64)), untouched.render(size=(64, 64)))
        assert f[1].volume == untouched[1].volume
        assert np.array_equal(f[0].vertices, untouched[0].vertices) and np.isnan(f[1].vertices).all()


def test_a_fracture_is_freed_without_the_garbage_collector(amphora):
    gc.disable()
    try:
        f = pysherd.fracture(amphora, pieces=3)
        seen, core = [g.vertices for g in f], weakref.ref(f)
        del f
        assert core() is None and len(seen) == 3
    finally:
        gc.enable()


def test_arrays_leave_by_dlpack(fracture):
    assert np.array_equal(np.from_dlpack(fracture[0].vertices), fracture[0].vertices)


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_pickles(amphora, fracture, protocol):
    def again(value):
        return pickle.loads(pickle.dumps(value, protocol))

    assert again(pysherd.Options(pieces=3, grain=(0, 0, 1, 2))) == pysherd.Options(pieces=3, grain=(0, 0, 1, 2))
    solid = again(amphora)
    assert (solid.shape, solid.voxels, solid.name, solid.options) == (amphora.shape, amphora.voxels, amphora.name, amphora.options)
    assert np.array_equal(pysherd.fracture(solid, pieces=6, seed=3).labels, fracture.labels)
    f = again(fracture)
    assert np.array_equal(f.labels, fracture.labels) and np.array_equal(f[1].vertices, fracture[1].vertices)
    error = again(pysherd.UsageError("a", ["erode-on"]))
    assert (type(error), str(error), error.options) == (pysherd.UsageError, "a", ("erode_on",))


TEXTURED = """mtllib box.mtl
g left
usemtl painted
{corners}
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
f 1/1/1 2/2/1 4/3/1 3/4/1
f 5/1/1 7/2/1 8/3/1 6/4/1
f 1/1/1 5/2/1 6/3/1 2/4/1
g right
f 3/1/1 4/2/1 8/3/1 7/4/1
f 1/1/1 3/2/1 7/3/1 5/4/1
f 2/1/1 6/2/1 8/3/1 4/4/1
"""


@pytest.mark.parametrize("surface", ["smooth", "exact"])
def test_a_pickle_keeps_what_was_read_of_a_mesh(fracture, tmp_path, surface):
    """Textures, materials, polygons, objects and counts: the files of what is unpickled are the same."""
    corners = "\n".join("v {} {} {}".format(*v) for v in cube()[0])
    (tmp_path / "box.obj").write_text(TEXTURED.format(corners=corners))
    (tmp_path / "box.mtl").write_text("newmtl painted\nKd 0.5 0.25 1\nmap_Kd wood.png\n")
    fracture.render(tmp_path / "wood.png", size=(16, 16))
    f = pysherd.fracture(tmp_path / "box.obj", pieces=3, resolution=24, surface=surface)
    again = pickle.loads(pickle.dumps(f))
    for name, one in (("a", f), ("b", again)):
        one.save(tmp_path / name, write=["mesh", "labels"], mesh_format=["obj", "ply", "glb"])
    first, second = files_of(tmp_path / "a"), files_of(tmp_path / "b")
    assert any(name.endswith(".png") for name in first) and b"painted" in first["meshes/box_001.obj"]
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []


def test_volumes(tmp_path):
    ball = np.sum((np.indices((20, 20, 20)) - 9.5) ** 2, axis=0) < 81
    for volume in (ball, ball.astype(np.int64), np.asfortranarray(ball.astype(np.uint8)), ball[::-1]):
        f = pysherd.fracture(volume, pieces=3)
        assert np.array_equal(f.labels > 0, volume[1:-1, 1:-1, 1:-1])
    assert f.voxel_size == 1 and f.origin.tolist() == [1, 1, 1]
    np.save(tmp_path / "ball.npy", ball.astype(np.uint16))
    assert np.array_equal(pysherd.fracture(tmp_path / "ball.npy", pieces=3).labels, pysherd.fracture(ball, pieces=3).labels)
    assert np.array_equal(pickle.loads(pickle.dumps(f)).labels, f.labels)


def test_a_level_set_is_broken_on_its_own_voxels_and_pickled(fracture, tmp_path):
    fracture.save(tmp_path / "out", write=["vdb", "solid"])
    solid = pysherd.voxelize(tmp_path / "out" / "fragments" / "amphora.vdb")
    assert solid.voxels == fracture.solid.voxels
    f = pysherd.fracture(solid, pieces=4)
    assert np.array_equal(pickle.loads(pickle.dumps(f)).labels, f.labels)


def test_a_loaded_fracture_is_the_saved_one(fracture, tmp_path):
    fracture.save(tmp_path / "out", precision="double")
    f = pysherd.load(tmp_path / "out")
    assert np.array_equal(f.labels, fracture.labels) and np.array_equal(f.origin, fracture.origin)
    assert np.array_equal(f[2].vertices, fracture[2].vertices)
    assert np.allclose(f.contacts.area, fracture.contacts.area) and np.array_equal(f.contacts.fragments, fracture.contacts.fragments)
    assert (f.options["pieces"], f.seed, f.solid) == (6, 3, None)
    assert len(f.points(5).positions) == 30
    assert np.array_equal(pickle.loads(pickle.dumps(f)).labels, f.labels)
    with pytest.raises(pysherd.UsageError, match="was loaded"):
        f.save(tmp_path / "other")


def test_a_recentered_object_is_the_one_at_the_origin(tmp_path):
    vertices, faces = cube(10.0)
    vertices, offset = np.asarray(vertices, float) - 5, np.array([500000.0, 4500000.0, 100.0])
    given = {"resolution": 24, "pieces": 3}
    near = pysherd.fracture((vertices, faces), impact="5,1,2,2", **given)
    far = pysherd.fracture((vertices + offset, faces), impact="500005,4500001,102,2", recenter=True, **given)
    assert np.array_equal(far.offset, offset) and np.array_equal(far.solid.offset, offset) and not near.offset.any()
    assert all(np.array_equal(a.vertices, b.vertices) for a, b in zip(near, far))
    far.save(tmp_path / "out", write=["labels", "vdb", "mesh"])
    with open(tmp_path / "out" / "manifest.json") as file:
        manifest = json.load(file)
    assert manifest["offset"] == offset.tolist() and manifest["options"]["recenter"] is True
    assert manifest["options"]["seeds"]["impacts"][0]["point"] == [500005, 4500001, 102]
    loaded = pysherd.load(tmp_path / "out")
    assert np.array_equal(loaded.offset, offset) and loaded.options["recenter"] is True
    again = pickle.loads(pickle.dumps(far))
    assert np.array_equal(again.offset, offset) and np.array_equal(again[0].vertices, far[0].vertices)
    solid = pysherd.voxelize((vertices + offset, faces), resolution=24, recenter=True)
    assert np.array_equal(pysherd.fracture(pickle.loads(pickle.dumps(solid)), pieces=3, impact="500005,4500001,102,2")[1].vertices, near[1].vertices)
    with pytest.raises(pysherd.UsageError, match="recenter"):
        pysherd.fracture(solid, recenter=True)


def test_images(fracture, tmp_path):
    image = fracture.render(tmp_path / "x.png", explode=0.3, size=(80, 60))
    assert image.shape == (60, 80, 3) and image.dtype == np.uint8 and image.std() > 1
    assert (tmp_path / "x.png").read_bytes().startswith(b"\x89PNG")
    fracture.render(tmp_path / "x.exr", size=(32, 32))
    assert (tmp_path / "x.exr").stat().st_size > 0


def test_to_trimesh(fracture):
    pytest.importorskip("trimesh")
    assert all(mesh.is_watertight for mesh in fracture.to_trimesh())


def test_what_is_not_read_is_not_made(amphora):
    f = pysherd.fracture(amphora, pieces=4)
    f.labels, f.contacts, f.points(5)
    assert list(f._kept) == [False]  # measured, without meshes


def flat():
    """A fracture of a solid whose planes are merged in meshes."""
    return pysherd.fracture(cube(), pieces=4, resolution=24, seed=1, surface="smooth")


def test_points_of_merged_planes_make_no_meshes():
    f, meshed = flat(), flat()
    assert len(meshed[0].faces) < len(pysherd.fracture(cube(), pieces=4, resolution=24, seed=1, adaptivity=0, surface="smooth")[0].faces) / 2  # they are merged
    for options in ({}, {"share_points": True}, {"share_points": True, "point_sampler": "halton"}):
        points, same = f.points(300, **options), meshed.points(300, **options)
        assert all(map(np.array_equal, points, same))
    assert getattr(f, "_kept", {}) == {}
    plain = pysherd.fracture(cube(), pieces=4, resolution=24, seed=1, adaptivity=0, surface="smooth")
    assert all(map(np.array_equal, f.points(300, share_points=True), plain.points(300, share_points=True)))  # those of the surfaces before merging
    assert np.array_equal(f._sampled.contacts()[0], f.contacts.fragments)


@pytest.mark.parametrize("write", ["points", "points,mesh"])
def test_points_shared_on_merged_planes_are_those_of_the_program(tmp_path, write):
    """Whether or not it writes meshes, whose areas differ a little."""
    vertices, faces = cube()
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "cube.obj").write_text("\n".join(lines) + "\n")
    program(tmp_path / "cube.obj", tmp_path / "p", "--pieces=4", "--resolution=24", "--seed=1", "--surface=smooth", "--points=997", "--share-points", "--point-format=npz",
            f"--write={write}")  # fmt: skip
    points = flat().points(997, share_points=True)
    for i, file in enumerate(sorted((tmp_path / "p" / "points").glob("*.npz")), 1):
        assert np.array_equal(np.load(file)["positions"], points.positions[points.fragment == i].astype(np.float32))


def test_a_sequence(fracture):
    assert [g.id for g in fracture] == [1, 2, 3, 4, 5, 6]
    assert fracture[-1].id == 6 and [g.id for g in fracture[1:3]] == [2, 3]
    with pytest.raises(IndexError):
        fracture[6]


def test_bodies_that_overlap_are_united_or_kept():
    (v, f), (w, g) = cube(), cube()
    mesh = np.concatenate([v, w + [0.5, 0, 0]]), np.concatenate([f, g + len(v)])
    for bodies, volume in (("unite", 1.5), ("keep", 2.0)):
        with warnings.catch_warnings(action="ignore"):  # which says that they were united
            found = pysherd.fracture(mesh, bodies=bodies, surface="exact", pieces=6, resolution=40)
            assert sum(p.volume for p in found) == pytest.approx(volume, rel=1e-12)
        assert len(found) == 6
    with pytest.raises(pysherd.UsageError, match="bodies"):
        pysherd.fracture(mesh, bodies="keep", fill="parity")


def test_decimated_meshes_share_their_cracks():
    fracture = pysherd.fracture(cube(), pieces=4, resolution=32, surface="smooth", adaptivity=0, triangles=[400, 80])
    for level, most in enumerate((400, 80)):
        cracks = {}
        for fragment in fracture:
            assert len(fragment.coarse) == 2
            vertices, faces, neighbor = fragment.coarse[level]
            assert faces.shape == (len(neighbor), 3) and len(faces) <= most < len(fragment.faces)
            for face, other in zip(vertices[faces], neighbor):
                if other:
                    cracks.setdefault(frozenset(map(tuple, face)), set()).add((fragment.id, other))
        assert cracks and all({(b, a) for a, b in sides} == sides for sides in cracks.values())
    assert pysherd.fracture(cube(), pieces=2, resolution=16)[0].coarse == []


@pytest.mark.parametrize("formats", ["ply", "glb,obj,ply"])
def test_decimated_meshes_are_loaded(tmp_path, formats):
    fracture = pysherd.fracture(cube(), pieces=4, resolution=32, triangles=[400, 80])
    fracture.save(tmp_path / "kept", write="mesh", mesh_format=formats, precision="double")
    for made, read in zip(fracture, pysherd.load(tmp_path / "kept"), strict=True):
        for one, other in zip(made.coarse, read.coarse, strict=True):
            for expected, found in zip(one, other, strict=True):
                assert np.array_equal(expected, found)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("options", ({}, {"growth": "sequential"}, {"min_share": 0}), ids=str)
def test_a_preset_draws_for_each_of_many_fractures(options):
    """What one seed draws does not depend on the others that are broken with it."""
    solid = pysherd.voxelize(AMPHORA, resolution=32)
    seeds = [3, 4, 5]
    together = list(solid.fractures(pieces=[5], seeds=seeds, preset="training", **options))
    roughness = set()
    for seed, fracture in zip(seeds, together):
        alone = pysherd.fracture(solid, pieces=5, seed=seed, preset="training", **options)
        assert np.array_equal(fracture.labels, alone.labels)
        assert [np.array_equal(a.vertices, b.vertices) for a, b in zip(fracture, alone)] == [True] * len(alone)
        roughness.add(fracture.options["roughness"])
    assert len(roughness) == len(seeds)


def test_what_a_preset_draws_makes_options_matter(recwarn):
    solid = pysherd.voxelize(AMPHORA, resolution=24)
    pysherd.fracture(solid, pieces=3, preset="training", mismatch_common=0.5, missing_rule="any")
    assert not [w for w in recwarn if "does nothing" in str(w.message)]
