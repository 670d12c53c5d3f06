"""Items of each layout: keys, shapes and dtypes as the loaders of the networks give them, and poses that put fragments together.

The tables and formulas are written from those loaders (GARF 2d489c0, RPF bf812e2, PuzzleFusion++ e249a25, Jigsaw 41713e1,
multi_part_assembly e95a946), with a reader of quaternions of its own.
"""
import numpy as np
import pytest
import torch
from conftest import AMPHORA

import pysherd
from pysherd.torch import FractureDataset, collate, collate_fragments

# B: the batch, P: most fragments, N: points
TABLES = {
    "garf": (20, 5000, {
        "index": "i8 B", "num_parts": "i8 B", "pointclouds": "f4 B N 3", "pointclouds_gt": "f4 B N 3", "pointclouds_normals": "f4 B N 3",
        "pointclouds_normals_gt": "f8 B N 3", "fracture_surface_gt": "i1 B N", "quaternions": "f4 B P 4", "translations": "f4 B P 3",
        "points_per_part": "i8 B P", "graph": "b1 B P P", "scale": "f4 B P 1", "ref_part": "b1 B P", "removal": "i8 B", "redundancy": "i8 B",
        "mesh_scale": "f8 B"}, ["name", "removal_pieces", "redundant_pieces", "pieces"]),
    "rpf": (64, 5000, {
        "index": "i8 B", "num_parts": "i8 B", "overlap_threshold": "f8 B", "pointclouds": "f4 B N 3", "pointclouds_gt": "f4 B N 3",
        "pointclouds_normals": "f4 B N 3", "pointclouds_normals_gt": "f4 B N 3", "rotations": "f4 B P 3 3", "translations": "f4 B P 3",
        "points_per_part": "i8 B P", "scales": "f4 B", "anchor_parts": "b1 B P", "anchor_indices": "b1 B N", "init_rotation": "f4 B 3 3",
    }, ["name", "dataset_name"]),
    "pfpp": (20, 1000, {
        "data_id": "i8 B", "part_valids": "f4 B P", "num_parts": "i8 B", "ref_part": "b1 B P", "part_pcs_gt": "f4 B P N 3", "graph": "b1 B P P",
        "part_pcs": "f4 B P N 3", "part_rots": "f4 B P 4", "part_trans": "f4 B P 3", "part_scale": "f4 B P 1", "init_pose_r": "f8 B 4",
        "init_pose_t": "f8 B 3"}, ["mesh_file_path"]),
    "jigsaw": (20, 5000, {
        "part_pcs": "f4 B N 3", "gt_pcs": "f4 B N 3", "part_valids": "f4 B P", "part_quat": "f4 B P 4", "part_trans": "f4 B P 3", "n_pcs": "i8 B P",
        "data_id": "i8 B", "critical_label_thresholds": "f4 B N"}, []),
    "mpa": (20, 1000, {
        "part_pcs": "f4 B P N 3", "part_quat": "f4 B P 4", "part_trans": "f4 B P 3", "part_valids": "f4 B P", "data_id": "i8 B",
        "instance_label": "f4 B P 0", "part_label": "f4 B P 0", "part_ids": "f4 B P", "valid_matrix": "f4 B P P"}, []),
}  # fmt: skip
TYPES = {"i8": torch.int64, "i1": torch.int8, "f4": torch.float32, "f8": torch.float64, "b1": torch.bool}


def stream(layout, items=3, **options):
    return FractureDataset(AMPHORA, layout=layout, items=items, **{"resolution": 32, "pieces": "2..6", **options})


@pytest.mark.parametrize("layout", TABLES)
def test_batches_have_the_loaders_keys_shapes_and_types(layout):
    most, points, arrays, strings = TABLES[layout]
    batch = collate(list(stream(layout)))
    assert set(batch) == set(arrays) | set(strings)
    for key, text in arrays.items():
        dtype, *shape = text.split()
        assert batch[key].dtype == TYPES[dtype], key
        assert batch[key].shape == tuple({"B": 3, "P": most, "N": points}.get(n) or int(n) for n in shape if n != "0") + (0,) * ("0" in shape), key
    assert all(len(batch[key]) == 3 and all(isinstance(text, str) for text in batch[key]) for key in strings)
    assert torch.utils.data.default_collate(list(stream(layout))).keys() == batch.keys()  # which those loaders use


def rotated(quaternion, points):
    """Rotates by a quaternion w, x, y, z, by the formula of Rodrigues."""
    axis, w = np.asarray(quaternion[1:], float), float(quaternion[0])
    return points + 2 * np.cross(axis, np.cross(axis, points) + w * points)


def parts(counts):
    ends = np.cumsum(counts[counts > 0])
    return [slice(end - count, end) for count, end in zip(counts[counts > 0], ends)]


def test_garf_fragments_go_back():
    data = stream("garf")
    for item in data:
        f = data.fracture(item["index"])
        assert item["num_parts"] == len(f) == (item["points_per_part"] > 0).sum() and item["points_per_part"].sum() == 5000
        assert item["points_per_part"][: len(f)].min() >= 20 and np.abs(item["pointclouds"]).max() <= 1
        for i, part in enumerate(parts(item["points_per_part"])):
            q, t = item["quaternions"][i], item["translations"][i]
            assert np.allclose(rotated(q, item["pointclouds"][part] * item["scale"][i]) + t, item["pointclouds_gt"][part], atol=1e-5)
            assert np.allclose(rotated(q, item["pointclouds_normals"][part]), item["pointclouds_normals_gt"][part], atol=1e-5)
            assert np.abs(np.linalg.norm(q) - 1) < 1e-6 and np.abs(np.abs(item["pointclouds"][part]).max() - 1) < 1e-6
        assert item["ref_part"].sum() == 1 and np.argmax(item["ref_part"]) == np.argmax(item["points_per_part"])
        pairs = {tuple(pair) for pair in f.contacts.fragments - 1}
        assert {(i, j) for i, j in np.argwhere(item["graph"]) if i < j} == pairs and np.array_equal(item["graph"], item["graph"].T)
        assert np.abs(np.abs(item["pointclouds_gt"]).max() - 0.5) < 0.02  # a box of side 1


def test_labels_are_those_of_the_fracture():
    """Points of a fracture surface lie on a fragment's faces that have a neighbor, and no others do."""
    from scipy.spatial import cKDTree

    data = stream("fragments", points=200, pieces=4, resolution=48)
    for item in data:
        f = data.fracture(item["index"])
        assert f.seed == item["seed"] and len(f) == item["fragments"]
        for i, fragment in enumerate(f):
            middles = fragment.vertices[fragment.faces].mean(axis=1)
            world = item["positions"][i] * item["size"] + item["center"]
            distance, near = cKDTree(middles).query(world)
            assert distance.max() < 2 * f.voxel_size
            inside = np.array([len(set(fragment.neighbor[faces])) == 1 for faces in cKDTree(middles).query_ball_point(world, 2 * f.voxel_size)])
            assert inside.mean() > 0.3  # away from the edges of the crack, where the nearest face may be another's
            assert np.array_equal(fragment.neighbor[near[inside]], item["neighbor"][i][inside])


def test_rpf_fragments_go_back():
    for item in stream("rpf"):
        anchor = int(np.argmax(item["points_per_part"]))
        assert item["anchor_parts"].sum() == 1 and item["anchor_parts"][anchor]
        for i, part in enumerate(parts(item["points_per_part"])):
            r, t = item["rotations"][i], item["translations"][i]
            assert np.allclose(item["pointclouds"][part] @ r.T + t, item["pointclouds_gt"][part], atol=1e-5)
            assert np.allclose(item["pointclouds_normals"][part] @ r.T, item["pointclouds_normals_gt"][part], atol=1e-5)
            assert np.abs(np.linalg.det(r) - 1) < 1e-5 and np.allclose(r, np.eye(3)) == (i == anchor)
            assert item["anchor_indices"][part].all() == (i == anchor) == item["anchor_indices"][part].any()
        assert np.abs(item["pointclouds_gt"].mean(axis=0)).max() < 1e-5
        whole = item["pointclouds_gt"] @ item["init_rotation"].T * item["scales"]  # as it was before the first rotation
        assert np.ptp(whole, axis=0).max() == pytest.approx(1, abs=0.02) and np.ptp(whole, axis=0).argmax() == 1  # the amphora stands along y


def test_pfpp_fragments_go_back_to_the_reference():
    for item in stream("pfpp"):
        ref, parts = int(np.argmax(item["ref_part"])), item["num_parts"]
        spans = [np.ptp(item["part_pcs_gt"][i]) for i in range(parts)]
        assert item["ref_part"].sum() == 1 and ref == int(np.argmax(spans)) and item["part_valids"].sum() == parts
        for i in range(parts):
            moved = rotated(item["part_rots"][i], item["part_pcs"][i] * item["part_scale"][i]) + item["part_trans"][i]
            back = rotated(item["init_pose_r"], moved + item["init_pose_t"])
            assert np.allclose(back, item["part_pcs_gt"][i], atol=1e-5)
        assert np.abs(item["part_trans"][ref]).max() < 1e-5 and np.abs(item["part_pcs"]).max() == pytest.approx(1)
        assert not item["part_pcs"][parts:].any() and not item["part_pcs_gt"][parts:].any() and (item["part_scale"][parts:] == 1).all()


def test_jigsaw_labels_by_its_own_rule_are_exact():
    data = stream("jigsaw", items=2)
    own = list(stream("points", points=5000, items=2, seed=0))
    for item, of in zip(data, own):
        labels, each = np.zeros(5000, bool), parts(item["n_pcs"])
        for i, part in enumerate(each):
            assert np.allclose(rotated(item["part_quat"][i], item["part_pcs"][part]) + item["part_trans"][i], item["gt_pcs"][part], atol=1e-5)
            others = np.concatenate([item["gt_pcs"][other] for other in each if other is not part])
            nearest = torch.cdist(torch.from_numpy(item["gt_pcs"][part]), torch.from_numpy(others)).min(dim=1).values.numpy()
            labels[part] = nearest < item["critical_label_thresholds"][part]
        assert item["n_pcs"][: len(each)].min() >= 30 and item["n_pcs"].sum() == 5000
        assert np.abs(labels.mean() - (of["neighbor"] != 0).mean()) < 0.05 and 0.01 < labels.mean() < 0.8  # other points of the same fracture
        assert np.array_equal(labels, item["critical_label_thresholds"] > 0)


def test_mpa_fragments_go_back_and_fill_the_box():
    for item in stream("mpa"):
        valid = item["part_valids"] > 0
        whole = np.concatenate([rotated(q, p) + t for q, p, t in zip(item["part_quat"][valid], item["part_pcs"][valid], item["part_trans"][valid])])
        assert np.ptp(whole, axis=0).max() == pytest.approx(1, abs=0.05) and not item["part_pcs"][~valid].any()
        assert item["part_ids"].tolist()[: valid.sum()] == list(range(valid.sum())) and item["valid_matrix"].sum() == valid.sum() ** 2


def test_our_own_items():
    data = stream("points", points=300)
    for item in data:
        assert item["positions"].shape == item["normals"].shape == (300, 3) and item["neighbor"].shape == item["fragment"].shape == (300,)
        assert item["fragment"].max() == item["fragments"] and (item["neighbor"] != item["fragment"]).all() and item["mesh"] == 0
        assert item["name"] == f"amphora.ply/fractured_{item['index']}"
        f = data.fracture(item["index"])
        assert np.allclose(item["positions"] * item["size"] + item["center"], f.points(300, share_points=True).positions, atol=1e-6)


def test_batches_of_fragments():
    items = list(stream("fragments", points=50))
    batch = collate_fragments(items)
    counts = [item["fragments"] for item in items]
    assert len(set(counts)) > 1 and batch["positions"].shape == (sum(counts), 50, 3) and batch["neighbor"].dtype == torch.int64
    assert torch.bincount(batch["item"]).tolist() == counts == batch["fragments"].tolist() and len(batch["name"]) == 3
    assert torch.equal(batch["normals"][batch["item"] == 1], torch.from_numpy(items[1]["normals"]))
    assert isinstance(collate(items)["positions"], list)


@pytest.mark.parametrize("layout", TABLES)
@pytest.mark.parametrize("pieces", [1, "1", "1..4", range(1, 3)])
def test_a_single_piece_is_refused_where_pairs_are_needed(layout, pieces):
    with pytest.raises(pysherd.UsageError, match=f"^pieces: layout {layout} holds 2 to {TABLES[layout][0]} fragments, not 1$"):
        stream(layout, pieces=pieces)


@pytest.mark.parametrize("options, named", [
    ({"layout": "gart"}, "layout: 'gart' is not one of points, fragments, garf"), ({"layout": "garf", "pieces": "1..4"}, "pieces: layout garf holds 2 to 20"),
    ({"layout": "garf", "pieces": 30}, "pieces: layout garf holds 2 to 20 fragments, not 30"), ({"layout": "garf", "points": 100}, "points: .* at least 400"),
    ({"points": 0}, "points"), ({"points": 2.5}, "points"), ({"items": 0}, "items"), ({"items": 2, "rank": 0, "world_size": 3}, "items: 2 .* 3 ranks"), ({"repeats": 0}, "repeats"), ({"cache_bytes": -1}, "cache_bytes"),
    ({"on_error": "stop"}, "on_error"), ({"rank": 2, "world_size": 2}, "rank"), ({"rank": 1}, "rank"), ({"device": ""}, "device"), ({"seed": True}, "seed"),
])  # fmt: skip
def test_arguments_are_refused_by_name(options, named):
    with pytest.raises(pysherd.UsageError, match=named):
        FractureDataset(AMPHORA, **options)
