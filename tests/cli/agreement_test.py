#!/usr/bin/python3
"""The files of a fracture agree with each other: labels.rle, the .vdb files and the manifest, voxel for voxel (promises 1 and 3).

SHERD_BIN names the program, SHERD_DATA the folder with amphora.ply.  Read by NumPy and Debian's python3-openvdb.
"""
import json
import os
import pathlib
import unittest

import numpy as np
import pyopenvdb as vdb

import skipping
from cli_test import CommandLine
from ply_file import read_triangles

AMPHORA = os.path.join(os.environ["SHERD_DATA"], "amphora.ply")


def labels_of(folder, grid):
    """labels.rle as an array [x, y, z]."""
    raw = (folder / "labels.rle").read_bytes()
    dims = tuple(np.frombuffer(raw, "<u4", 3))
    assert dims == tuple(grid["dims"]), (dims, grid["dims"])
    runs = np.frombuffer(raw, [("label", "<u2"), ("length", "<u4")], offset=12)
    return np.repeat(runs["label"], runs["length"]).reshape(dims)


def inside_of(file, grid):
    """Where a level set is negative, in the box of labels.rle; nothing of it may lie outside."""
    level_set = vdb.read(str(file), "surface")
    values = np.empty([n + 2 for n in grid["dims"]], np.float32)
    level_set.copyToArray(values, ijk=tuple(i - 1 for i in grid["index_min"]))
    inside = values < 0
    for axis in range(3):
        for side in 0, -1:
            assert not inside.take(side, axis).any(), f"{file}: it reaches out of the box of labels.rle"
    return inside[1:-1, 1:-1, 1:-1]


def disagreements(folder):
    """What is wrong with a fracture's files, a sentence each."""
    folder = pathlib.Path(folder)
    manifest = json.loads((folder / "manifest.json").read_text())
    grid, found = manifest["grid"], []
    labels = labels_of(folder, grid)
    counts = np.bincount(labels.ravel(), minlength=len(manifest["fragments"]) + 2)
    if len(counts) != len(manifest["fragments"]) + 2:
        found.append("labels.rle has a label of no fragment")
    if counts[1] != grid["eroded_voxels"] or counts[1:].sum() != grid["solid_voxels"]:
        found.append("the manifest counts other voxels than labels.rle has")
    owned = np.zeros(labels.shape, np.uint16)
    for fragment in manifest["fragments"]:
        own = labels == fragment["id"] + 1
        inside = inside_of(folder / fragment["files"]["vdb"], grid)
        if own.sum() != fragment["voxels"]:
            found.append(f"fragment {fragment['id']}: {own.sum()} voxels in labels.rle, {fragment['voxels']} in the manifest")
        if (own & ~inside).any():
            found.append(f"fragment {fragment['id']}: {(own & ~inside).sum()} of its voxels lie outside its level set")
        if (inside & (labels > 1) & ~own).any():
            found.append(f"fragment {fragment['id']}: its level set holds {(inside & (labels > 1) & ~own).sum()} voxels of others")
        if (inside & (labels == 0)).any():
            found.append(f"fragment {fragment['id']}: its level set holds {(inside & (labels == 0)).sum()} voxels outside the solid")
        owned += inside
    if (owned > 1).any():
        found.append(f"{(owned > 1).sum()} voxels lie in two level sets")
    return found


def neighbor_disagreements(folder):
    """What is wrong with the manifest's contacts and areas by the faces of the .ply files, a sentence each."""
    folder = pathlib.Path(folder)
    fragments = json.loads((folder / "manifest.json").read_text())["fragments"]
    areas, found = {}, []
    for fragment in fragments:
        vertices, triangles, neighbor = read_triangles(folder / fragment["files"]["mesh"])
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        areas[fragment["id"]] = {int(other): area[neighbor == other].sum() for other in np.unique(neighbor)}
        for key, total in (("area", area.sum()), ("original_area", area[neighbor == 0].sum()), ("fracture_area", area[neighbor != 0].sum())):
            if abs(total - fragment[key]) > 1e-5 * area.sum():
                found.append(f"fragment {fragment['id']}: {key} is {fragment[key]}, its faces have {total}")
    for fragment in fragments:
        own = fragment["id"]
        contacts = {contact["id"]: contact for contact in fragment["contacts"]}
        for other in set(areas[own]) - {0} - set(contacts):
            found.append(f"fragment {own} has faces towards {other} and no contact")
        for other in set(areas[own]) & set(contacts):
            mean = (areas[own][other] + areas[other].get(own, 0.0)) / 2
            if abs(mean - contacts[other]["area"]) > 1e-4 * mean:
                found.append(f"the contact of {own} and {other} has an area of {contacts[other]['area']}, their faces have {mean}")
    return found


class Agreement(CommandLine):
    SETS = ((), ("--roughness", "2"), ("--growth", "chain", "--sampler", "poisson"), ("--growth", "flood", "--neighborhood", "26"),
            ("--erode-iterations", "2", "--erode-probability", "0.5"), ("--erode-iterations", "1", "--erode-on", "all", "--missing", "2"),
            ("--interface", "independent"), ("--surface", "labels"), ("--preset", "paper"), ("--half", "--compress", "none"))

    def each_agrees(self, sets, write, wrong_with):
        for i, options in enumerate(sets):
            with self.subTest(options):
                out = self.path(f"out{i}")
                result = self.run_sherd("fracture", AMPHORA, "-o", out, "--pieces", "9", "--resolution", "96", "--write", write, *options)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(wrong_with(out), [])

    def test_labels_level_sets_and_manifest(self):
        self.each_agrees(self.SETS, "labels,vdb", disagreements)

    def test_contacts_and_areas_are_those_of_the_faces(self):
        sets = ((), ("--roughness", "1"), ("--interface", "independent"), ("--surface", "labels"))
        self.each_agrees(sets, "mesh", neighbor_disagreements)

    def test_a_swap_of_half_the_voxels_of_two_labels_is_found(self):
        self.done("--write", "labels,vdb")
        folder = pathlib.Path(self.out)
        self.assertEqual(disagreements(folder), [])
        raw = (folder / "labels.rle").read_bytes()
        runs = np.frombuffer(raw, [("label", "<u2"), ("length", "<u4")], offset=12).copy()
        first, second = np.flatnonzero(runs["label"] == 2), np.flatnonzero(runs["label"] == 3)
        half = min(len(first), len(second)) // 2
        runs["label"][first[:half]], runs["label"][second[:half]] = 3, 2
        (folder / "labels.rle").write_bytes(raw[:12] + runs.tobytes())
        found = disagreements(folder)
        for words in "of its voxels lie outside its level set", "voxels of others":
            self.assertTrue(any(words in sentence for sentence in found), found)


if __name__ == "__main__":
    skipping.main()
