# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The user's choices as options of `sherd fracture`."""
from .export_mesh import DENSITY

ADAPTIVITY = 0.05  # voxels: of the smooth surface, where the exact one fails; cracks of exact ones have what auto has
PREVIEW = 32  # voxels along the longest side


def options(choices, position, weighted):
    """Words for sherd: what the user changed, so that the material decides about the rest.  A preview has the cracks of the
    final at a low resolution, so lengths in voxels become shares of the object."""
    resolution = min(choices.resolution, PREVIEW) if choices.preview else choices.resolution
    words = ["--pieces", choices.pieces, "--resolution", resolution, "--seed", choices.seed,
             "--surface", choices.surface.lower()]
    if choices.surface == "AUTO":
        words += ["--adaptivity", ADAPTIVITY]
    if choices.material != "NONE":
        words += ["--material", choices.material.lower()]
    words += growth_of(choices)
    length = (lambda voxels: f"{100 * voxels / choices.resolution:.6g}%") if choices.preview else "{:.6g}".format
    if choices.wear:
        words += ["--erode-iterations", length(choices.wear)]
    if choices.roughness > 0:
        words += ["--roughness", length(choices.roughness)]
    if weighted:
        words += ["--density-attribute", DENSITY]
    words += impact_of(choices, position)
    return [str(word) for word in words]


def options_again(choices, piece, position):
    """Words for sherd that break a piece in the folder of its fracture, whose other options it takes over: a Finished."""
    words = [piece.folder, "--only", piece.fragment, "--pieces", choices.pieces, "--seed", choices.seed,
             "--material", choices.material.lower(), *growth_of(choices)]
    if choices.roughness > 0:
        words += ["--roughness", f"{choices.roughness:.6g}"]
    words += impact_of(choices, None if position is None else piece.fracture_place(position))
    return [str(word) for word in words]


def growth_of(choices):
    return [] if choices.growth == "AUTO" else ["--growth", choices.growth.lower()]


def impact_of(choices, position):
    if position is None:
        return []
    parts = [f"{x:.9g}" for x in position] + [str(choices.impact_pieces)]
    if choices.impact_spread > 0:
        parts.append(f"{choices.impact_spread:.6g}")
    return ["--impact=" + ",".join(parts)]  # one word: it may begin with a minus
