#!/usr/bin/python3
"""Study the crack between two pieces of a block: flatness of smooth cracks, roughness of rough ones.

usage: crack_study.py SHERD OUTFOLDER [options]

Breaks a block of sides 1, 1, 0.5 by two given seeds, whose bisector is a plane across its middle, and measures the crack:

- Rough (`--growth euclid --roughness r,H`, labels): the height over the plane, column by column; the height-height
  correlation C(d) = <(h(x+d) - h(x))^2>^(1/2) along both axes of the plane, whose slope in log-log axes is the Hurst
  exponent; and the rms height in windows of a tenth of the block, which r defines.
- Anisotropic (`--propagation 1,0,0,H`): the correlation along propagation and along the front separately.
- Smooth: distances of the voxel faces between the two pieces, and of the mesh vertices on the crack, to the
  plane, for an axis-aligned plane and three tilted ones.

OUTFOLDER keeps the heights, one .npy per fracture, and the metrics of smooth cracks; existing ones are not run again.  Prints
tables in Markdown and draws the plot.  All lengths are in voxels.

Needs Debian's python3-numpy, and python3-matplotlib for the plot.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from mesh_file import read_mesh

# Half the way from seed 1 to seed 2, in voxels at 512: across the middle of the block, and whole, so that the seeds are
# centers of voxels and the plane is known exactly.
ALIGNED = (0, 0, 64)
TILTED = ((12, 7, 60), (25, 0, 60), (-10, 17, 61))
ROUGH = [  # way to seed 2, roughness, Hurst exponent, share of the random seeds
    (ALIGNED, 3, 0.8, 1.0), (ALIGNED, 6, 0.8, 0.6), (ALIGNED, 6, 0.5, 0.4), (ALIGNED, 1, 0.8, 0.4),
    (TILTED[0], 6, 0.8, 0.4)]
ANISOTROPIC = [(3, 0.75, 0.6, 2.0), (6, 0.75, 0.6, 0.8)]  # roughness, exponents along front and propagation, share of the seeds
# Distances of the fits along propagation and front, in voxels at 512: from two of the least spacings, 2 and 6 voxels, to a
# fifth of the block, above which a crack has few independent waves.
FITTED = ((4, 108), (12, 108))
STRAIGHT = 0.03  # a range of C(d) is straight if the fitted line is within this share of all points


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("folder", type=pathlib.Path, metavar="OUTFOLDER", help="made or continued")
    parser.add_argument("--resolution", type=int, default=512, help="voxels along the block's long sides (default 512)")
    parser.add_argument("--seeds", type=int, default=5, help="random seeds of the rough cracks (default 5)")
    parser.add_argument("--only-anisotropic", action="store_true", help="only the cracks with two exponents")
    parser.add_argument("--plot", type=pathlib.Path, help="PNG to draw, such as docs/images/hurst.png; that of two exponents is named -anisotropic")
    return parser.parse_args()


def write_block(file):
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 0.5)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    file.write_text("".join("v %g %g %g\n" % c for c in corners) +
                    "".join("f %d %d %d %d\n" % tuple(i + 1 for i in s) for s in sides))


def seed_voxels(way, resolution):
    """The two seeds, index space: `way` from the center, to both sides."""
    half = np.round(np.array(way) * resolution / 512).astype(int)
    middle = np.array([resolution, resolution, resolution // 2]) // 2
    between = (0, 0, 1) if way == ALIGNED else (0, 0, 0)  # between two layers of voxels, so that no voxel is equidistant
    return middle - half, middle + half - between


def fracture(options, way, folder, *more):
    """Break the block; its folder then holds the files."""
    block, seeds = folder / "block.obj", folder / "seeds.json"
    write_block(block)
    entries = [{"fragment": k + 1, "position": ((voxel + 0.5) / options.resolution).tolist()}
               for k, voxel in enumerate(seed_voxels(way, options.resolution))]
    seeds.write_text(json.dumps({"schema": "sherd-seeds/1", "seeds": entries}))
    done = subprocess.run([options.sherd, "fracture", block, "-o", folder / "pieces", "--seeds", seeds, "--growth", "euclid",
                           "--resolution", str(options.resolution), "--quiet", *more], stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"crack_study.py: {done.stderr.strip()}")
    return folder / "pieces"


def read_labels(file):
    """Fragment ids [x, y, z]; see docs/formats.md."""
    raw = file.read_bytes()
    dims = np.frombuffer(raw, "<u4", 3)
    runs = np.frombuffer(raw, [("label", "<u2"), ("length", "<u4")], offset=12)
    return np.repeat(runs["label"].astype(np.uint8) - 1, runs["length"]).reshape(dims)


def plane(way, resolution):
    """A point of the bisector (index space) and its unit normal."""
    a, b = seed_voxels(way, resolution)
    return (a + b) / 2, (b - a) / np.linalg.norm(b - a)


def heights(labels, way):
    """Heights of the crack over the plane [x, y], and the share of columns that meet the crack more than once.

    The crack of a column lies above its voxels of piece 1, which is exact if the column meets it once.
    """
    below = labels == 1
    changes = (below[:, :, 1:] != below[:, :, :-1]).sum(axis=2)
    point, normal = plane(way, labels.shape[0])
    x, y = np.indices(labels.shape[:2])
    z = below.sum(axis=2) - 0.5
    return (x - point[0]) * normal[0] + (y - point[1]) * normal[1] + (z - point[2]) * normal[2], (changes > 1).mean()


def rough_case(options, way, roughness, hurst, seed, propagation=None):
    """Heights and the share of overhanging columns of one rough crack; `propagation`: the exponent along x."""
    along = "" if propagation is None else "_P%g" % propagation
    name = "rough_%d_%d_%d_r%g_H%g%s_s%d_at%d.npz" % (*way, roughness, hurst, along, seed, options.resolution)
    more = [] if propagation is None else ["--propagation", f"1,0,0,{propagation}"]
    kept = options.folder / name
    if not kept.exists():
        with tempfile.TemporaryDirectory(prefix="sherd-crack-") as folder:
            pieces = fracture(options, way, pathlib.Path(folder), "--roughness", f"{roughness},{hurst}", "--seed", str(seed),
                              "--write", "labels", *more)
            height, overhanging = heights(read_labels(pieces / "labels.rle"), way)
        np.savez_compressed(kept.with_suffix(".part.npz"), height=height.astype(np.float32), overhanging=overhanging)
        os.replace(kept.with_suffix(".part.npz"), kept)
        print(f"{name}: done", file=sys.stderr)
    with np.load(kept) as stored:
        return stored["height"].astype(float), float(stored["overhanging"])


def correlations(height, distances):
    """C(d)^2 along x and along y, over all pairs."""
    return np.array([[((height[d:] - height[:-d])**2).mean() for d in distances],
                     [((height[:, d:] - height[:, :-d])**2).mean() for d in distances]])


def correlation(height, distances):
    """The mean of both."""
    return correlations(height, distances).mean(axis=0)


def window_rms(height):
    """Rms height within windows of a tenth of the longer side, about each window's mean."""
    side = round(max(height.shape) / 10)
    nx, ny = (n // side for n in height.shape)
    windows = height[:nx * side, :ny * side].reshape(nx, side, ny, side)
    return np.sqrt(windows.var(axis=(1, 3)).mean())


def slope(distances, c):
    return np.polyfit(np.log(distances), np.log(c), 1)


def straight_range(distances, c):
    """First and last index of the widest range in which log C is a line within STRAIGHT."""
    best = (0, 1)
    for i in range(len(c)):
        for j in range(i + 2, len(c)):
            line = np.polyval(slope(distances[i:j + 1], c[i:j + 1]), np.log(distances[i:j + 1]))
            wider = distances[j] / distances[i] > distances[best[1]] / distances[best[0]]
            if wider and np.abs(np.log(c[i:j + 1]) - line).max() <= STRAIGHT:
                best = (i, j)
    return best


def mean_and_error(values, digits=3):
    error = np.std(values, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else float("nan")
    return f"{np.mean(values):.{digits}f} ± {error:.{digits}f}"


def distances_at(resolution):
    distances = np.unique(np.round(2.0**np.arange(0, 8.01, 0.25)).astype(int))
    return distances[distances <= resolution // 3]


def anisotropic_cracks(options):
    """Rows of the table, and the curves to draw, for each direction."""
    rows, curves = [], []
    distances = distances_at(options.resolution)
    for roughness, front, propagation, share in ANISOTROPIC:
        squares, rms = [], []
        for seed in range(1, max(2, round(share * options.seeds)) + 1):
            height, _ = rough_case(options, ALIGNED, roughness, front, seed, propagation)
            squares.append(correlations(height, distances))
            rms.append(window_rms(height))
        for axis, (name, asked) in enumerate((("propagation", propagation), ("front", front))):
            c = np.sqrt(np.mean([s[axis] for s in squares], axis=0))
            fitted = [i for i, d in enumerate(distances) if FITTED[axis][0] <= d * 512 / options.resolution <= FITTED[axis][1]]
            first, last = fitted[0], fitted[-1]

            def fit(values):
                return slope(distances[fitted], values[fitted])[0]

            off = np.abs(np.log(c[fitted]) - np.polyval(slope(distances[fitted], c[fitted]), np.log(distances[fitted]))).max()
            rows.append([name, f"{roughness}", f"{asked}", f"{len(squares)}", mean_and_error([fit(np.sqrt(s[axis])) for s in squares]),
                         f"{fit(c):.3f}", f"{distances[first]} to {distances[last]}", f"{off:.1%}", mean_and_error(rms, 2)])
            curves.append((f"r = {roughness}, along {name}, {asked}", distances, c, (first, last), fit(c)))
    return rows, curves


def rough_cracks(options):
    """Rows of the table, and the curves to draw: (name, distances, C, range, slope)."""
    rows, curves = [], []
    distances = distances_at(options.resolution)
    for way, roughness, hurst, share in ROUGH:
        squares, rms, overhanging = [], [], []
        for seed in range(1, max(2, round(share * options.seeds)) + 1):
            height, over = rough_case(options, way, roughness, hurst, seed)
            squares.append(correlation(height, distances))
            rms.append(window_rms(height))
            overhanging.append(over)
        c = np.sqrt(np.mean(squares, axis=0))
        normal = plane(way, options.resolution)[1]
        steps = np.sqrt(1 + (normal[:2] / normal[2])**2)  # a step along x or y is longer on a tilted plane
        along = distances * steps.mean()
        first, last = straight_range(along, c)
        fits = [slope(along[first:last + 1], np.sqrt(s[first:last + 1]))[0] for s in squares]
        fixed = [slope(along[(distances >= 4) & (distances <= 128)], np.sqrt(s[(distances >= 4) & (distances <= 128)]))[0]
                 for s in squares]
        name = "aligned" if way == ALIGNED else "tilted"
        rows.append([name, f"{roughness}", f"{hurst}", f"{len(squares)}", mean_and_error(fits),
                     f"{along[first]:.0f} to {along[last]:.0f} ({np.log10(along[last] / along[first]):.2f})",
                     mean_and_error(fixed), mean_and_error(rms, 2), f"{np.mean(rms) / roughness - 1:+.1%}",
                     f"{np.mean(overhanging):.2%}"])
        curves.append((f"r = {roughness}, H = {hurst}" + (", tilted" if way != ALIGNED else ""), along, c, (first, last),
                       np.mean(fits)))
    return rows, curves


def rms_and_most(values):
    return [float(np.sqrt((values**2).mean())), float(np.abs(values).max())]


def smooth_case(options, way):
    """Rms and maximum distance to the plane: of voxel faces, of mesh vertices, of these without the contact boundary."""
    kept = options.folder / ("smooth_%d_%d_%d_at%d.json" % (*way, options.resolution))
    if not kept.exists():
        point, normal = plane(way, options.resolution)
        with tempfile.TemporaryDirectory(prefix="sherd-crack-") as folder:
            pieces = fracture(options, way, pathlib.Path(folder), "--write", "labels,mesh")
            labels = read_labels(pieces / "labels.rle")
            faces = []
            for axis in range(3):
                a, b = np.delete(labels, -1, axis), np.delete(labels, 0, axis)
                at = np.argwhere(a != b).astype(float)
                at[:, axis] += 0.5
                faces.append((at - point) @ normal)
            vertices, inner = [], []
            for file in sorted((pieces / "meshes").glob("*.ply")):
                v, corner, neighbor = read_mesh(file)
                off = (v.astype(float) * options.resolution - 0.5 - point) @ normal
                crack = np.unique(corner[neighbor != 0])
                vertices.append(off[crack])
                inner.append(off[np.setdiff1d(crack, corner[neighbor == 0])])
        metrics = [rms_and_most(np.concatenate(part)) for part in (faces, vertices, inner)]
        kept.write_text(json.dumps(metrics))
        print(f"{kept.name}: done", file=sys.stderr)
    return json.loads(kept.read_text())


def smooth_cracks(options):
    rows = []
    for way in (ALIGNED, *TILTED):
        normal = plane(way, options.resolution)[1]
        tilt = np.degrees(np.arccos(normal[2]))
        rows.append(["(%.3f, %.3f, %.3f)" % tuple(normal), f"{tilt:.1f}°",
                     *[f"{rms:.3f} ({most:.2f})" for rms, most in smooth_case(options, way)]])
    return rows


def table(header, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, ["---"] * len(header), *rows])


def plot(options, curves, file):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(6.4, 4.4), dpi=150)
    colors = ["#1b6ca8", "#d98324", "#7a3b69", "#4f7942", "#b03a3a", "#5d6d7e"]
    for (name, along, c, (first, last), fit), color, marker in zip(curves, colors * 9, "osD^vP" * 9):
        axes.loglog(along, c, marker, markersize=3.2, color=color, label=f"{name}: slope {fit:.2f}")
        line = np.polyval(slope(along[first:last + 1], c[first:last + 1]), np.log(along[first:last + 1]))
        axes.loglog(along[first:last + 1], np.exp(line), color=color, linewidth=1.1)
    axes.axhline(np.sqrt(1 / 6), color="black", linewidth=0.6, linestyle=":")
    axes.annotate("whole voxels alone", (along[-1], np.sqrt(1 / 6)), ha="right", va="bottom", fontsize=7)
    axes.set_xlabel("distance d along the crack, voxels")
    axes.set_ylabel("height-height correlation C(d), voxels")
    axes.grid(which="major", linewidth=0.4, alpha=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(file, metadata={"Software": None})


def show_anisotropic(options):
    rows, curves = anisotropic_cracks(options)
    print(table(["along", "r", "exponent asked", "seeds", "slope of each", "of the mean", "over d", "off the line, at most",
                 "rms in windows"], rows), end="\n\n")
    if options.plot:
        plot(options, curves, options.plot.with_stem(options.plot.stem + "-anisotropic"))


def main():
    options = arguments()
    options.folder.mkdir(parents=True, exist_ok=True)
    if options.only_anisotropic:
        return show_anisotropic(options)
    rows, curves = rough_cracks(options)
    print(table(["plane", "r", "H", "seeds", "slope", "over d (decades)", "slope, d 4 to 128", "rms in windows", "off r",
                 "overhanging"], rows), end="\n\n")
    if options.plot:
        plot(options, curves, options.plot)
    show_anisotropic(options)
    print(table(["normal", "tilt", "voxel faces: rms (most)", "mesh vertices", "these without the contact boundary"],
                smooth_cracks(options)))


if __name__ == "__main__":
    main()
