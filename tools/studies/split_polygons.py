"""The exact polygons of a plate that was broken by splits: its rectangle, cut by the recorded planes in their order.

Where two cracks meet in a T-junction, the older piece gets no corner: only the polygon that is cut gets any.  A straight
cut gives two corners to each of the two pieces, so n pieces of a rectangle have four in the mean, whatever the cuts are.

Needs Debian's python3-numpy.
"""
import numpy as np

RIM = 0  # the number of an edge that no split made


def halves(polygon, normal, distance, split):
    """A convex polygon on both sides of a line.  Each corner has the number of the split that made the edge after it."""
    sides = [[], []]
    for (corner, edge), (following, _) in zip(polygon, polygon[1:] + polygon[:1]):
        here, there = corner @ normal - distance, following @ normal - distance
        sides[int(here > 0)].append((corner, edge))
        if (here > 0) != (there > 0):
            crossing = corner + (following - corner) * (here / (here - there))
            sides[int(here > 0)].append((crossing, split))
            sides[int(there > 0)].append((crossing, edge))
    return sides


def depth(polygon, point):
    """How far inside all edges of a convex polygon, in ascending order about it, a point is; below 0 outside."""
    corners = np.array([corner for corner, _ in polygon])
    edges = np.roll(corners, -1, axis=0) - corners
    from_corners = point - corners
    areas = edges[:, 0] * from_corners[:, 1] - edges[:, 1] * from_corners[:, 0]
    return (areas / np.maximum(np.linalg.norm(edges, axis=1), 1e-300)).min()


def take(polygons, points):
    """Removes the polygon that the points are in, as a manifest does not record which side of a plane a piece is on."""
    return polygons.pop(max(range(len(polygons)), key=lambda i: min(depth(polygons[i], point) for point in points)))


def polygons_of(manifest, sides):
    """By fragment, its polygon in the middle of a plate with a corner at the origin that is thin along z."""
    splits = {split["id"]: split for split in manifest["splits"]}
    within = {split: [] for split in splits}  # centroids of the fragments that come of the piece
    for fragment in manifest["fragments"]:
        split = fragment["split"]
        while split:
            within[split].append(np.array(fragment["centroid"][:2]))
            split = splits[split]["parent"]
    rectangle = [(0, 0), (sides[0], 0), (sides[0], sides[1]), (0, sides[1])]
    pieces = {0: [[(np.array(corner, float), RIM) for corner in rectangle]]}
    for number in sorted(splits):
        polygon = take(pieces[splits[number]["parent"]], within[number])
        normal, distance = np.array(splits[number]["plane"]["normal"]), splits[number]["plane"]["distance"]
        pieces[number] = halves(polygon, normal[:2], distance - normal[2] * sides[2] / 2, number)
    return {fragment["id"]: take(pieces[fragment["split"]], [np.array(fragment["centroid"][:2])])
            for fragment in manifest["fragments"]}


def edge_lengths(polygon):
    corners = np.array([corner for corner, _ in polygon])
    return np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)


def has_rim(polygon):
    return any(edge == RIM for _, edge in polygon)
