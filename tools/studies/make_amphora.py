#!/usr/bin/python3
"""Make the sample amphora: a surface of revolution with wall, foot and lip, and two handles.

The body is one profile rotated about the y axis: along the underside of the foot, up the outside,
over the lip, and down the inside to the floor.  Each handle is a separate closed tube whose ends
lie within the wall, so the file has three closed components that overlap; a solid unites them.

Meters, y up, the foot stands on y = 0.  Needs numpy.  Equal arguments give equal bytes.
"""
import argparse
import math
import pathlib

import numpy as np

WALL = 0.0105  # thickness of the wall
SEGMENTS = 144  # around the axis, at detail 1
HANDLE_SEGMENTS = 32  # around a handle's section, at detail 1
HANDLE_HALF_WIDTH = 0.0125  # along the vessel's wall
HANDLE_HALF_DEPTH = 0.0085  # away from it

# Control points (radius, height).  A repeated point is a corner.
UNDERSIDE = [(0.0, 0.013), (0.018, 0.0125), (0.033, 0.009), (0.040, 0.0012), (0.0425, 0.0)]
FOOT = [(0.0425, 0.0), (0.0500, 0.0), (0.0545, 0.0024), (0.0560, 0.0075), (0.0545, 0.0126),
        (0.0490, 0.0158), (0.0425, 0.0195), (0.0398, 0.0260), (0.0412, 0.0330)]
BODY = [(0.0412, 0.0330), (0.0500, 0.0470), (0.0690, 0.0760), (0.0960, 0.1230), (0.1210, 0.1800),
        (0.1345, 0.2350), (0.1335, 0.2730), (0.1180, 0.3060), (0.0910, 0.3290), (0.0670, 0.3455),
        (0.0545, 0.3640), (0.0500, 0.3870), (0.0500, 0.4080), (0.0535, 0.4260)]
LIP = [(0.0535, 0.4260), (0.0590, 0.4330), (0.0665, 0.4370), (0.0702, 0.4410), (0.0690, 0.4468),
       (0.0625, 0.4499), (0.0545, 0.4488), (0.0478, 0.4425), (0.0443, 0.4330)]
FLOOR = [(0.0300, 0.0545), (0.0130, 0.0485), (0.0, 0.0475)]

# In the plane z = 0, from within the shoulder's wall to within the neck's.
HANDLE = [(0.1078, 0.3102), (0.1210, 0.3290), (0.1300, 0.3560), (0.1270, 0.3860),
          (0.1100, 0.4065), (0.0860, 0.4125), (0.0640, 0.4065), (0.0447, 0.4020)]


def spline(points, per_span=64):
    """A natural cubic spline through points [n, 2], parametrized by the square root of the chord."""
    p = np.asarray(points, float)
    h = np.sqrt(np.hypot(*np.diff(p, axis=0).T))
    n = len(p)
    # Second derivatives m from the tridiagonal system, solved by elimination: no LAPACK, whose last
    # bits differ between builds.
    m = np.zeros_like(p)
    diagonal, right = np.ones(n), np.zeros_like(p)
    for i in range(1, n - 1):
        rate = (p[i + 1] - p[i]) / h[i] - (p[i] - p[i - 1]) / h[i - 1]
        factor = h[i - 1] / diagonal[i - 1] if i > 1 else 0.0
        diagonal[i] = 2.0 * (h[i - 1] + h[i]) - factor * h[i - 1]
        right[i] = 6.0 * rate - factor * right[i - 1]
    for i in range(n - 2, 0, -1):
        m[i] = (right[i] - h[i] * m[i + 1]) / diagonal[i]
    spans = []
    for i in range(n - 1):
        b = np.linspace(0.0, 1.0, per_span, endpoint=False)[:, None]
        a = 1.0 - b
        spans.append(a * p[i] + b * p[i + 1] +
                     ((a**3 - a) * m[i] + (b**3 - b) * m[i + 1]) * h[i] ** 2 / 6.0)
    return np.concatenate(spans + [p[-1:]])


def resample(curve, count, curvature_length):
    """`count` points along a fine polyline, denser where it bends.

    curvature_length  weight of one radian of rotation, as a length
    """
    step = np.diff(curve, axis=0)
    length = np.hypot(*step.T)
    angle = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    rotation = np.concatenate([[0.0], np.abs(np.diff(angle))])
    rotation = np.convolve(rotation, np.ones(15) / 15.0, mode="same")  # density changes gradually
    position = np.concatenate([[0.0], np.cumsum(length + curvature_length * rotation)])
    where = np.linspace(0.0, position[-1], count)
    return np.stack([np.interp(where, position, curve[:, k]) for k in (0, 1)], axis=1)


def inside_of(curve):
    """The curve moved inwards, to its left, by the wall."""
    tangent = np.gradient(curve, axis=0)
    tangent /= np.hypot(*tangent.T)[:, None]
    return curve + WALL * np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)


def profile(detail):
    """The profile [n, 2] from axis to axis, solid on its left."""
    underside, foot, lip = spline(UNDERSIDE), spline(FOOT), spline(LIP)
    body = spline(BODY)
    wall = inside_of(body)[::-1]
    # Inside, the wall's offset runs from under the lip down to where the floor begins.
    wall = wall[(wall[:, 1] < 0.4200) & (wall[:, 1] > 0.0760)]
    inner = spline(np.concatenate([lip[-1:], wall[::40], wall[-1:], FLOOR]))
    pieces = [(underside, 12, 0.02), (foot, 26, 0.02), (body, 62, 0.08), (lip, 24, 0.02),
              (inner, 66, 0.08)]
    parts = [resample(curve, max(4, round(count * detail)), weight) for curve, count, weight in pieces]
    curve = np.concatenate([parts[0]] + [part[1:] for part in parts[1:]])
    return np.maximum(curve, 0.0)  # the foot's spline swings a fifth of a millimeter below the ground


def revolved(curve, segments):
    """Rotate a profile whose ends lie on the axis: vertices [n, 3], triangles [m, 3]."""
    rings = curve[1:-1]
    angles = [2.0 * math.pi * k / segments for k in range(segments)]
    cosine, sine = np.array([math.cos(a) for a in angles]), np.array([math.sin(a) for a in angles])
    ring_vertices = np.stack([rings[:, :1] * cosine, np.repeat(rings[:, 1:], segments, axis=1),
                              rings[:, :1] * sine], axis=2).reshape(-1, 3)
    poles = np.array([[0.0, curve[0, 1], 0.0], [0.0, curve[-1, 1], 0.0]])
    return np.concatenate([ring_vertices, poles]), closed_tube(len(rings), segments)


def closed_tube(rings, segments):
    """Triangles of `rings` rings and two poles after them, counter-clockwise seen from outside."""
    k = np.arange(segments)
    n = (k + 1) % segments
    first = np.stack([np.full(segments, rings * segments), k, n], axis=1)
    base = (np.arange(rings - 1) * segments)[:, None]
    a, b, c, d = base + k, base + n, base + segments + k, base + segments + n
    walls = np.stack([np.stack([a, c, b], axis=2), np.stack([b, c, d], axis=2)], axis=2)
    top = (rings - 1) * segments
    last = np.stack([np.full(segments, rings * segments + 1), top + n, top + k], axis=1)
    return np.concatenate([first, walls.reshape(-1, 3), last])


def handle(detail):
    """The handle on the side of +x: vertices, triangles."""
    path = resample(spline(HANDLE), max(8, round(72 * detail)), 0.03)
    tangent = np.gradient(path, axis=0)
    tangent /= np.hypot(*tangent.T)[:, None]
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    along = np.linspace(-1.0, 1.0, len(path))
    swell = 1.0 + 0.22 * along**6  # the potter's thumb: wider where the handle meets the vessel
    segments = max(8, round(HANDLE_SEGMENTS * detail))
    angles = [2.0 * math.pi * k / segments for k in range(segments)]
    cosine, sine = np.array([math.cos(a) for a in angles]), np.array([math.sin(a) for a in angles])
    depth = HANDLE_HALF_DEPTH * swell[:, None] * cosine
    width = HANDLE_HALF_WIDTH * swell[:, None] * sine
    vertices = np.stack([path[:, :1] + normal[:, :1] * depth, path[:, 1:] + normal[:, 1:] * depth,
                         width], axis=2).reshape(-1, 3)
    poles = np.concatenate([path[[0, -1]], np.zeros((2, 1))], axis=1)
    return np.concatenate([vertices, poles]), closed_tube(len(path), segments)[:, ::-1]


def amphora(detail):
    """Vertices [n, 3] and triangles [m, 3] of body, right handle, left handle, in this order."""
    body = revolved(profile(detail), max(12, round(SEGMENTS * detail)))
    right = handle(detail)
    left = (right[0] * [-1.0, 1.0, -1.0], right[1])  # rotated by 180 degrees about the y axis
    vertices, triangles, offset = [], [], 0
    for part_vertices, part_triangles in (body, right, left):
        vertices.append(part_vertices)
        triangles.append(part_triangles + offset)
        offset += len(part_vertices)
    # Rounding to a nanometer removes last bits that differ between machines, and negative zeros.
    return np.round(np.concatenate(vertices), 9) + 0.0, np.concatenate(triangles)


def ply(vertices, triangles):
    """The bytes of a binary little-endian PLY file."""
    header = (f"ply\nformat binary_little_endian 1.0\n"
              f"element vertex {len(vertices)}\n"
              f"property float x\nproperty float y\nproperty float z\n"
              f"element face {len(triangles)}\n"
              f"property list uchar int vertex_indices\nend_header\n")
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corner", "<i4", 3)])
    faces["count"], faces["corner"] = 3, triangles
    return header.encode("ascii") + vertices.astype("<f4").tobytes() + faces.tobytes()


def main():
    parser = argparse.ArgumentParser(description="Make the sample amphora as a binary PLY file.")
    parser.add_argument("file", type=pathlib.Path, help="the .ply to write")
    parser.add_argument("--detail", type=float, default=1.0, metavar="F",
                        help="multiplies the number of triangles, 0.1 to 400 (default: %(default)s)")
    arguments = parser.parse_args()
    if not 0.1 <= arguments.detail <= 400.0:
        parser.error(f"--detail is {arguments.detail}; it goes from 0.1 to 400")
    vertices, triangles = amphora(math.sqrt(arguments.detail))
    arguments.file.write_bytes(ply(vertices, triangles))
    print(f"{arguments.file}: {len(vertices)} vertices, {len(triangles)} triangles")


if __name__ == "__main__":
    main()
