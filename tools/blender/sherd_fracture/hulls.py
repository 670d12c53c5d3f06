# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pieces' convex hulls overlap, although the pieces may not touch."""
import numpy as np

STEPS = 100
TOUCH = 2e-3  # of the smaller one's extent: hulls that overlap by less are no obstacle


def corners_of(piece, matrix):
    """Vertices in world space, of a piece that lies by `matrix`: its own, or for one that Blender has not placed yet its
    location's."""
    at = np.empty((len(piece.data.vertices), 3), np.float32)
    piece.data.vertices.foreach_get("co", at.ravel())
    matrix = np.array(matrix, float)
    return at @ matrix[:3, :3].T + matrix[:3, 3]


def overlap(one, other):
    """Whether the hulls of two sets of points overlap.  The difference of the sets, of which the point nearest to zero is
    searched, step by step towards its farthest corner (Frank and Wolfe, 1956), has zero outside if a step finds a
    direction in which all of it lies beyond zero."""
    low, high = np.maximum(one.min(axis=0), other.min(axis=0)), np.minimum(one.max(axis=0), other.max(axis=0))
    slack = TOUCH * min(np.ptp(one, axis=0).max(), np.ptp(other, axis=0).max())
    if (low > high - slack).any():
        return False
    nearest = one.mean(axis=0) - other.mean(axis=0)
    for _ in range(STEPS):
        length = np.linalg.norm(nearest)
        if length < 1e-12:
            return True
        corner = one[np.argmin(one @ nearest)] - other[np.argmax(other @ nearest)]
        if corner @ nearest > -slack * length:
            return False
        step = corner - nearest
        nearest = nearest + min(max(-(nearest @ step) / (step @ step), 0), 1) * step
    return True


def overlapping(corners, left_out):
    """Pairs of numbers whose hulls overlap, the lower first, but those left out; a generator that gives (number, None) after
    each number, so that its user may stop."""
    numbers = sorted(corners)
    low = np.array([corners[each].min(axis=0) for each in numbers]).reshape(-1, 3)
    high = np.array([corners[each].max(axis=0) for each in numbers]).reshape(-1, 3)
    for i, one in enumerate(numbers):
        near = i + 1 + np.flatnonzero((low[i + 1:] < high[i]).all(axis=1) & (high[i + 1:] > low[i]).all(axis=1))
        for other in (numbers[j] for j in near):
            if (one, other) not in left_out and overlap(corners[one], corners[other]):
                yield one, other
        yield one, None
