"""Items of a stream of fractures, as the loaders of published networks give them: keys, shapes and dtypes.

Each layout is a function from a `Sample` to a dictionary of arrays, numbers and strings.  Positions are in a box of side 1 around 0,
that of the intact object, as in Breaking Bad.  Rotations are scalar-first quaternions, or matrices, that take a fragment back.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Callable, NamedTuple

import numpy as np

from . import _core, _jobs
from ._fracture import Fracture

Array = np.ndarray[Any, Any]
Item = dict[str, Any]


class Sample(NamedTuple):
    """Points on the fragments of a fracture."""

    positions: list[Array]
    """of each fragment (n, 3) float64, in the box of side 1"""
    normals: list[Array]
    """of each fragment (n, 3) float64"""
    neighbor: list[Array]
    """of each fragment (n,) int64, 0 on the original surface"""
    areas: Array
    """(fragments,) in the box of side 1"""
    graph: Array
    """(most, most) bool, which fragments touch"""
    center: Array
    """(3,) float64, of the object's box, world units"""
    size: float
    """longest side of the object's box, world units"""
    name: str
    number: int
    mesh: int
    seed: int
    random: np.random.Generator
    object: Array
    """(fragments,) int64, which object of the item each fragment is of, from 0"""


class Layout(NamedTuple):
    """How many points an item has, and what is made of them."""

    make: Callable[[Sample], Item]
    counts: Callable[[Array, int], list[int]]
    """points of each fragment, from areas and the number"""
    points: int
    """default number of points"""
    fragments: int
    """most fragments; 0: any number"""
    least: int
    """points that each fragment has"""


# --- how many points


def equal_counts(areas: Array, points: int) -> list[int]:
    """As many on each fragment."""
    return [points] * len(areas)


def shared_counts(areas: Array, points: int) -> list[int]:
    """By area: the largest remainders get one more, as `Fracture.points` has them with ``share_points``."""
    exact = points * areas / areas.sum()
    each = np.floor(exact).astype(np.int64)
    each[np.argsort(each - exact, kind="stable")[: points - each.sum()]] += 1
    return [int(n) for n in each]


def counts_above(least: int, areas: Array, points: int) -> list[int]:
    """`least` on each fragment, the others by area, the remainder on the largest (GARF, RPF)."""
    each = least + ((points - least * len(areas)) * (areas / areas.sum())).astype(np.int64)
    each[np.argmax(each)] += points - each.sum()
    return [int(n) for n in each]


def counts_from(least: int, areas: Array, points: int) -> list[int]:
    """By area, and what is missing to `least` from those with most (Jigsaw)."""
    each = np.ceil(areas * points / areas.sum()).astype(np.int64)
    each[np.argmax(each)] -= each.sum() - points
    missing = int(np.maximum(least - each, 0).sum())
    each = np.maximum(each, least)
    while missing > 0:
        most = np.argmax(each)
        taken = min(missing, int(each[most]) - least)
        each[most] -= taken
        missing -= taken
    return [int(n) for n in each]


# --- sampling


def sample_of(f: Fracture, layout: Layout, points: int, texts: list[tuple[str, str]], box: Any, **named: Any) -> Sample:
    """Samples a fracture.

    Parameters
    ----------
    texts : list
        Options of the points.
    box : pair
        Lowest and highest corner of the intact surface.
    **named
        The other members of the sample.
    """
    sampled = f._sampled
    areas = np.array([sampled.area(i) for i in range(len(f))])
    counts = layout.counts(areas, points)
    positions, normals, neighbor, _ = _jobs.finish(_core.points(f._core, [("points", str(max(counts))), *texts], counts))
    low, high = map(np.array, box)
    center, size = (low + high) / 2, float((high - low).max())
    most, pairs, ends = layout.fragments or len(f), sampled.contacts()[0] - 1, np.cumsum(counts)[:-1]
    graph = np.zeros((most, most), bool)
    graph[pairs[:, 0], pairs[:, 1]] = graph[pairs[:, 1], pairs[:, 0]] = True
    return Sample(np.split((positions - center) / size, ends), np.split(normals, ends), np.split(neighbor.astype(np.int64), ends),
                  areas / size**2, graph, center, size, object=np.zeros(len(f), np.int64), **named)  # fmt: skip


_APART = 1.5  # of objects of an item, along x; each has a box of side 1


def sample_of_several(samples: list[Sample], random: np.random.Generator) -> Sample:
    """Puts objects side by side along x, the first around 0, as one sample, whose name has all their names.

    The fragments of all are in a random order, in which those of each object keep theirs.
    """
    first, counts = samples[0], [len(sample.positions) for sample in samples]
    objects = random.permutation(np.repeat(np.arange(len(samples)), counts))
    graph = np.zeros((max(len(first.graph), len(objects)),) * 2, bool)
    columns: list[list[Any]] = [[None] * len(objects) for _ in range(3)]
    areas, withheld = np.zeros(len(objects)), len(objects)
    for k, sample in enumerate(samples):
        places = np.flatnonzero(objects == k)
        own = len(places)
        graph[np.ix_(places, places)] = sample.graph[:own, :own]
        areas[places] = sample.areas
        most = max(int(n.max(initial=0)) for n in sample.neighbor)
        ids = np.concatenate([[0], places + 1, withheld + 1 + np.arange(max(most - own, 0))])  # those that are withheld follow all others
        withheld += max(most - own, 0)
        for place, *values in zip(places, sample.positions, sample.normals, sample.neighbor):
            for column, value in zip(columns, (values[0] + (_APART * k, 0, 0), values[1], ids[values[2]])):
                column[place] = value
    name = ";".join(sample.name for sample in samples)
    return first._replace(positions=columns[0], normals=columns[1], neighbor=columns[2], areas=areas, graph=graph, name=name, object=objects)


# --- poses


def _rotation(random: np.random.Generator) -> tuple[Array, Array]:
    """Returns a random rotation, uniform over all, as a matrix, and its inverse as a quaternion w, x, y, z."""
    q = random.standard_normal(4)
    w, x, y, z = q / np.linalg.norm(q)
    matrix = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    return matrix, np.array([w, -x, -y, -z])


class _Posed(NamedTuple):
    """Fragments that are moved to 0 and rotated: positions @ rotation.T + translation is where they were."""

    positions: list[Array]
    normals: list[Array]
    quaternions: Array
    rotations: Array
    translations: Array


def _posed(sample: Sample, fixed: int = -1) -> _Posed:
    """Gives each fragment a random pose; that of `fixed` is only moved."""
    posed = []
    for i, (assembled, normals) in enumerate(zip(sample.positions, sample.normals)):
        matrix, inverse = _rotation(sample.random) if i != fixed else (np.eye(3), np.array([1.0, 0.0, 0.0, 0.0]))
        center = assembled.mean(axis=0)
        posed.append(((assembled - center) @ matrix.T, normals @ matrix.T, inverse, matrix.T, center))
    columns = [list(column) for column in zip(*posed)]
    return _Posed(columns[0], columns[1], *map(np.stack, columns[2:]))


def _padded(values: Any, most: int, dtype: Any = np.float32) -> Array:
    values = np.asarray(values)
    padded = np.zeros((most, *values.shape[1:]), dtype)
    padded[: len(values)] = values
    return padded


def _joined(parts: list[Array], dtype: Any = np.float32) -> Array:
    return np.concatenate(parts).astype(dtype)


def _valid(sample: Sample) -> Array:
    return _padded(np.ones(len(sample.positions)), len(sample.graph))


def _first_of_most(values: Array, most: int) -> Array:
    chosen = np.zeros(most, bool)
    chosen[np.argmax(values)] = True
    return chosen


# --- our own


def _own(sample: Sample) -> Item:
    return {"name": sample.name, "index": sample.number, "mesh": sample.mesh, "seed": sample.seed, "center": sample.center, "size": sample.size}


def points_item(sample: Sample) -> Item:
    counts = [len(p) for p in sample.positions]
    return {
        "positions": _joined(sample.positions), "normals": _joined(sample.normals), "neighbor": _joined(sample.neighbor, np.int64),
        "fragment": np.repeat(np.arange(1, len(counts) + 1), counts), "fragments": len(counts),
        "object": np.repeat(sample.object, counts), **_own(sample),
    }  # fmt: skip


def fragments_item(sample: Sample) -> Item:
    return {
        "positions": np.stack(sample.positions).astype(np.float32), "normals": np.stack(sample.normals).astype(np.float32),
        "neighbor": np.stack(sample.neighbor), "fragments": len(sample.positions), "object": sample.object, **_own(sample),
    }  # fmt: skip


# --- those of published networks


def garf_item(sample: Sample) -> Item:
    most, posed = len(sample.graph), _posed(sample)
    counts = np.array([len(p) for p in posed.positions])
    scale = np.array([np.abs(p).max() for p in posed.positions])
    return {
        "index": sample.number, "name": sample.name, "num_parts": len(counts),
        "pointclouds": _joined([p / s for p, s in zip(posed.positions, scale)]), "pointclouds_gt": _joined(sample.positions),
        "pointclouds_normals": _joined(posed.normals), "pointclouds_normals_gt": _joined(sample.normals, np.float64),
        "fracture_surface_gt": (_joined(sample.neighbor, np.int64) != 0).astype(np.int8),
        "quaternions": _padded(posed.quaternions, most), "translations": _padded(posed.translations, most),
        "points_per_part": _padded(counts, most, np.int64), "graph": sample.graph, "scale": _padded(scale, most)[:, None],
        "ref_part": _first_of_most(counts, most), "removal": 0, "redundancy": 0, "removal_pieces": "", "redundant_pieces": "",
        "pieces": ",".join(f"piece_{i}" for i in range(len(counts))), "mesh_scale": 1.0,
    }  # fmt: skip


def rpf_item(sample: Sample) -> Item:
    most, random = len(sample.graph), sample.random
    counts = np.array([len(p) for p in sample.positions])
    anchor = int(np.argmax(counts))
    middle = np.concatenate(sample.positions).mean(axis=0)
    scale = np.abs(np.concatenate(sample.positions) - middle).max() * random.uniform(0.75, 1.25)
    whole, _ = _rotation(random)
    rotated = sample._replace(positions=[(p - middle) / scale @ whole.T for p in sample.positions], normals=[n @ whole.T for n in sample.normals])
    posed = _posed(rotated, fixed=anchor)
    return {
        "index": sample.number, "name": sample.name,
        "overlap_threshold": np.sqrt(2 * sample.areas.sum() / counts.sum() + 1e-4), "dataset_name": "sherd", "num_parts": len(counts),
        "pointclouds": _joined(posed.positions), "pointclouds_gt": _joined(rotated.positions),
        "pointclouds_normals": _joined(posed.normals), "pointclouds_normals_gt": _joined(rotated.normals),
        "rotations": _padded(posed.rotations, most), "translations": _padded(posed.translations, most),
        "points_per_part": _padded(counts, most, np.int64), "scales": np.array(scale, np.float32),
        "anchor_parts": _first_of_most(counts, most), "anchor_indices": np.repeat(np.arange(len(counts)) == anchor, counts),
        "init_rotation": whole.T.astype(np.float32),
    }  # fmt: skip


def pfpp_item(sample: Sample) -> Item:
    most, pieces = len(sample.graph), np.stack(sample.positions)
    ref = _first_of_most(pieces.max(axis=(1, 2)) - pieces.min(axis=(1, 2)), most)
    whole, quaternion = _rotation(sample.random)
    moved = pieces @ whole.T
    center = moved[np.argmax(ref)].mean(axis=0)
    posed = _posed(sample._replace(positions=list(moved - center)))
    parts = _padded(posed.positions, most)
    scale = np.abs(parts).max(axis=(1, 2), keepdims=True)
    scale[scale == 0] = 1
    return {
        "data_id": sample.number, "part_valids": _valid(sample), "mesh_file_path": sample.name, "num_parts": len(pieces), "ref_part": ref,
        "part_pcs_gt": _padded(pieces, most), "graph": sample.graph, "part_pcs": parts / scale, "part_rots": _padded(posed.quaternions, most),
        "part_trans": _padded(posed.translations, most), "part_scale": scale[:, :, 0], "init_pose_r": quaternion, "init_pose_t": center,
    }  # fmt: skip


_ALL = 10.0  # above every distance within the box: Jigsaw labels a point if another fragment has one nearer than its threshold


def jigsaw_item(sample: Sample) -> Item:
    most, posed = len(sample.graph), _posed(sample)
    return {
        "part_pcs": _joined(posed.positions), "gt_pcs": _joined(sample.positions), "part_valids": _valid(sample),
        "part_quat": _padded(posed.quaternions, most), "part_trans": _padded(posed.translations, most),
        "n_pcs": _padded([len(p) for p in posed.positions], most, np.int64), "data_id": sample.number,
        "critical_label_thresholds": np.where(_joined(sample.neighbor, np.int64) != 0, _ALL, 0).astype(np.float32),
    }  # fmt: skip


def mpa_item(sample: Sample) -> Item:
    most, posed, valid = len(sample.graph), _posed(sample), _valid(sample)
    return {
        "part_pcs": _padded(posed.positions, most), "part_quat": _padded(posed.quaternions, most),
        "part_trans": _padded(posed.translations, most), "part_valids": valid, "data_id": sample.number,
        "instance_label": np.zeros((most, 0), np.float32), "part_label": np.zeros((most, 0), np.float32),
        "part_ids": _padded(np.arange(len(posed.positions)), most), "valid_matrix": np.outer(valid, valid),
    }  # fmt: skip


# Without local functions: a data set with its layout is pickled for workers that are spawned.
LAYOUTS = {
    "points": Layout(points_item, shared_counts, 5000, 0, 0),
    "fragments": Layout(fragments_item, equal_counts, 1024, 0, 1),
    "garf": Layout(garf_item, partial(counts_above, 20), 5000, 20, 20),
    "rpf": Layout(rpf_item, partial(counts_above, 20), 5000, 64, 20),
    "pfpp": Layout(pfpp_item, equal_counts, 1000, 20, 1),
    "jigsaw": Layout(jigsaw_item, partial(counts_from, 30), 5000, 20, 30),
    "mpa": Layout(mpa_item, equal_counts, 1000, 20, 1),
}
