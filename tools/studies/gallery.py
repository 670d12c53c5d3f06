#!/usr/bin/python3
"""Make the gallery: docs/gallery.md and its images, each with its command.

usage: gallery.py SHERD FOLDER            writes FOLDER/gallery.md and FOLDER/images/gallery/*
       gallery.py --inputs FOLDER         writes only the meshes and seeds that the commands use

With FOLDER docs it makes the gallery of this repository, in some ten minutes on two cores.  Its only input is
data/amphora.ply; it generates block, plate and ball.  Figure numbers are those of "Generating implicit object fragment datasets for machine
learning".

Needs Debian's python3-numpy, python3-pil and python3-matplotlib, blender for Figure 15, and a C++ compiler with libopenvdb-dev: cost.vdb is an
Int32 grid, which Debian's python3-openvdb does not read.
"""
import argparse
import json
import math
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image, ImageDraw

from mesh_file import read_mesh, read_ply

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIDE = 288  # pixels, the longest side of an image


# ---- inputs ----------------------------------------------------------------------------------------------------------

def box(x, y, z):
    corners = [(i * x, j * y, k * z) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    return corners, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def ball(meridians=96):
    rows = meridians // 2
    points, faces = [(0.0, 1.0, 0.0)], []
    for r in range(1, rows):
        t = math.pi * r / rows
        for s in range(meridians):
            p = 2 * math.pi * s / meridians
            points.append((math.sin(t) * math.cos(p), math.cos(t), -math.sin(t) * math.sin(p)))
    points.append((0.0, -1.0, 0.0))

    def at(r, s):
        return 1 + (r - 1) * meridians + s % meridians

    for s in range(meridians):
        faces.append((0, at(1, s), at(1, s + 1)))
        faces += [(at(r, s), at(r + 1, s), at(r + 1, s + 1), at(r, s + 1)) for r in range(1, rows - 1)]
        faces.append((len(points) - 1, at(rows - 1, s + 1), at(rows - 1, s)))
    return points, faces


def gear(teeth=14):
    """A prism over a star: sharp edges all around."""
    ring = [((1.0 if k % 2 else 0.78) * math.cos(math.pi * k / teeth), (1.0 if k % 2 else 0.78) * math.sin(math.pi * k / teeth))
            for k in range(2 * teeth)]
    points = [(x, y, z) for z in (0, 0.4) for x, y in ring] + [(0, 0, 0), (0, 0, 0.4)]
    faces = []
    for k in range(2 * teeth):
        n, up = (k + 1) % (2 * teeth), 2 * teeth
        faces += [(k, n, up + n, up + k), (n, k, 2 * up), (up + k, up + n, 2 * up + 1)]
    return points, faces


def write_obj(path, mesh):
    points, faces = mesh
    path.write_text("".join("v %.9g %.9g %.9g\n" % p for p in points) +
                    "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in faces))


def write_seeds(path, positions):
    seeds = [{"fragment": i + 1, "position": p} for i, p in enumerate(positions)]
    path.write_text(json.dumps({"schema": "sherd-seeds/1", "seeds": seeds}, indent=1) + "\n")


def write_inputs(folder):
    write_obj(folder / "block.obj", box(1, 1, 1))
    write_obj(folder / "plate.obj", box(1, 1, 0.15))
    write_obj(folder / "ball.obj", ball())
    write_obj(folder / "gear.obj", gear())
    write_seeds(folder / "bricks.json", [[x / 8, (2 * row + 1) / 10, 0.075] for row in range(5)
                                         for x in ([1, 3, 5, 7] if row % 2 == 0 else [0.5, 2, 4, 6, 7.5])])
    write_seeds(folder / "four.json", [[0.25, 0.27, 0.5], [0.74, 0.25, 0.5], [0.3, 0.76, 0.5], [0.77, 0.72, 0.5]])
    write_seeds(folder / "six.json", [[-0.116, 0.237, 0.056], [-0.099, 0.315, 0.010], [-0.007, 0.100, -0.081],
                                      [-0.046, 0.276, -0.113], [-0.071, 0.146, -0.074], [0.003, 0.093, 0.070]])
    shutil.copy(ROOT / "data/amphora.ply", folder / "amphora.ply")


# ---- groups of the gallery ------------------------------------------------------------------------------------------

class Group:
    """Fractures of one mesh that differ in one option."""

    def __init__(self, key, title, text, mesh, base, items, columns=4):
        self.key, self.title, self.text, self.mesh, self.base = key, title, text, mesh, base
        self.items, self.columns = items, columns  # items: (name, options, caption)


EYE = "ray:0.6,0.6,0.84,-0.539,-0.342,-0.77"  # from the camera of preview.png towards the belly of the amphora
VOXEL_FACES = "--pieces 6 --seed 3 --resolution 96 --surface labels"
ERODE = "--pieces 6 --seed 3 --resolution 96 --erode-iterations"

CHAPTERS = [
    ("Pieces and voxels", [
        Group("pieces", "--pieces", "Number of fragments.", "amphora.ply", "--seed 3", [
            ("3", "--pieces 3", "three"), ("8", "--pieces 8", "the default"), ("25", "--pieces 25", "25"),
            ("100", "--pieces 100", "100")]),
        Group("seed", "--seed", "Another seed, another fracture; the same seed, the same bytes.", "amphora.ply",
              "--pieces 8", [("1", "--seed 1", ""), ("2", "--seed 2", ""), ("4", "--seed 4", "")], 3),
        Group("resolution", "--resolution and --voxel-size",
              "Voxels along the longest side, or the voxel size in the mesh's unit. The same seed gives the same cracks at any "
              "resolution, so that a coarse fracture shows what a fine one will be.", "amphora.ply",
              "--pieces 8 --seed 3", [
                  ("64", "--resolution 64", "the wall is one and a half voxels thick"),
                  ("128", "--resolution 128", "the automatic choice"),
                  ("256", "--resolution 256", ""),
                  ("512", "--resolution 512", ""),
                  ("size", "--voxel-size 0.004", "4 mm: the amphora is in meters")], 5),
        Group("up", "--up", "The axis that points up in `preview.png`; the fragments stay the same.", "plate.obj",
              "--pieces 6 --seed 3", [("y", "--up y", "the default"), ("z", "--up z", "rotated")], 2),
    ]),
    ("Growth", [
        Group("growth", "--growth", "Growth from the same six seeds.", "plate.obj", "--pieces 6 --seed 3", [
            ("flood", "--growth flood", "layer by layer over voxel faces: cracks follow axes and diagonals, like the steps of "
             "Figure 3"),
            ("nearest", "--growth nearest", "the nearest seed: a Voronoi diagram"),
            ("chain", "--growth chain", "the Discrete Voronoi Chain: in a convex solid the same cracks"),
            ("euclid", "--growth euclid", "the default: nearest seed, disconnected voxels regrown")]),
        Group("growth-amphora", "--growth on a solid with gaps",
              "A flood follows the neck and the handle; the distance to the nearest seed crosses gaps.",
              "amphora.ply", "--pieces 6 --seed 3", [
                  ("flood", "--growth flood", "cracks where fronts meet, curved and stepped"),
                  ("euclid", "--growth euclid", "cracks along planes through the whole vessel")], 2),
        Group("neighborhood", "--neighborhood", "Neighbors of a voxel in a flood.", "plate.obj",
              "--pieces 6 --seed 3 --growth flood", [
                  ("6", "--neighborhood 6", "6 faces (von Neumann): fronts are octahedra"),
                  ("26", "--neighborhood 26", "faces, edges and corners (Moore): fronts are cubes")], 2),
        Group("metric", "--metric", "The distance of `nearest` and `chain`.", "plate.obj",
              "--pieces 6 --seed 3 --growth nearest", [
                  ("euclidean", "--metric euclidean", "straight cracks in any direction"),
                  ("chebyshev", "--metric chebyshev", "like a flood over 26 neighbors"),
                  ("manhattan", "--metric manhattan", "like a flood over 6")], 3),
        Group("roughness", "--roughness", "Cracks with the relief of broken stone: the rms height in voxels, measured over "
              "a tenth of the solid.", "block.obj", "--pieces 5 --seed 4", [
                  ("0", "--roughness 0", "smooth"), ("1", "--roughness 1", "fine"),
                  ("3", "--roughness 3", "rugged, the first overhangs"),
                  ("6", "--roughness 6", "so steep that cracks overhang and open pits in the outer faces")]),
        Group("hurst", "--roughness r,H", "The Hurst exponent: the share of short waves in the height, visible at contact "
              "boundaries.", "plate.obj", "--pieces 6 --seed 3", [
                  ("05", "--roughness 3,0.5", "H 0.5: rough in detail"), ("08", "--roughness 3,0.8", "H 0.8: the default"),
                  ("10", "--roughness 3,1", "H 1: smooth in detail")], 3),
        Group("grain", "--grain", "Anisotropy: lengths along a direction are scaled down (wood) or up (slate).", "block.obj",
              "--pieces 9 --seed 2", [
                  ("none", "", "no grain"), ("wood", "--grain 0,1,0,6", "splinters along y"),
                  ("slant", "--grain 1,2,0,6 --roughness 1", "oblique splinters, rough"),
                  ("slate", "--grain 0,1,0,-0.75", "plates across y")]),
        Group("isolated", "--isolated", "Extra seeds can disconnect a part of a fragment from its first seed.", "plate.obj",
              "--pieces 5 --seed 8 --extra-seeds 6n --resolution 64", [
                  ("regrow", "--isolated regrow", "the default: violet and green grew into it; every fragment is connected"),
                  ("keep", "--isolated keep", "the orange island at the right stays")], 2),
        Group("min-share", "--min-share",
              "Seeds of small fragments are drawn again. Here the mean share is a tenth of the solid.", "plate.obj", "--pieces 10 --seed 1", [
                  ("0", "--min-share 0", "any size"), ("05", "--min-share 0.05", "no less than 5 %"),
                  ("08", "--min-share 0.08", "no less than 8 %")], 3),
        Group("balance", "--balance", "Seeds move to the centers of their fragments (Lloyd iterations).", "plate.obj",
              "--pieces 10 --seed 1", [
                  ("0", "--balance 0", "none"), ("1", "--balance 1", "one step"), ("5", "--balance 5", "five"),
                  ("40", "--balance 40", "forty: nearly equal sizes")]),
        Group("missing", "--missing",
              "Withheld fragments. The manifest lists them; the others keep their positions.", "amphora.ply", "--pieces 12 --seed 3", [
                  ("0", "--missing 0", "all twelve"), ("3", "--missing 3", "three withheld"),
                  ("half", "--missing 0.5", "half of them withheld")], 3),
    ]),
    ("Seeds", [
        Group("sampler", "--sampler", "Distribution of seeds. Figure 5 below has the histograms.", "plate.obj",
              "--pieces 16 --seed 5", [
                  ("uniform", "--sampler uniform", "anywhere: large and small"),
                  ("halton", "--sampler halton", "a low-discrepancy sequence: more even"),
                  ("gaussian", "--sampler gaussian", "small in the center, large at the edge"),
                  ("poisson", "--sampler poisson", "with a minimum distance between seeds")]),
        Group("seeds-on", "--seeds-on", "Voxels that seeds are drawn from.", "ball.obj", "--pieces 10 --seed 2", [
            ("volume", "--seeds-on volume", "seeds lie inside too"),
            ("surface", "--seeds-on surface", "every fragment has original surface")], 2),
        Group("extra", "--extra-seeds", "Extra seeds, given to the nearest fragment: less convex fragments.", "plate.obj",
              "--pieces 6 --seed 3", [
                  ("0", "--extra-seeds 0", "none"), ("1n", "--extra-seeds 1n", "one per fragment"),
                  ("2n", "--extra-seeds 2n", "two"), ("6n", "--extra-seeds 6n", "six")]),
        Group("merge-metric", "--merge-metric",
              "The distance for extra seeds: with another metric some of them go to another fragment.", "plate.obj", "--pieces 6 --seed 3 --extra-seeds 2n", [
                  ("chebyshev", "--merge-metric chebyshev", "the default: the seed right of the center goes to yellow"),
                  ("euclidean", "--merge-metric euclidean", "it goes to violet"),
                  ("manhattan", "--merge-metric manhattan", "it goes to red")], 3),
        Group("size-spread", "--size-spread", "Uneven sizes: some fragments get more of the extra seeds, others fewer.", "plate.obj",
              "--pieces 6 --seed 3 --extra-seeds 6n", [
                  ("0", "--size-spread 0", "none"), ("05", "--size-spread 0.5", "a factor of 1.4 between fragments"),
                  ("1", "--size-spread 1", "a factor of 2"), ("2", "--size-spread 2", "a factor of 4: one fragment gets most of them")], 4),
        Group("seed-file", "--seeds", "Seeds from a file, in the format of `--write seeds`.", "plate.obj", "", [
            ("bricks", "--seeds bricks.json", "a wall"),
            ("flood", "--seeds bricks.json --growth flood", "a wall, flooded"),
            ("rough", "--seeds bricks.json --roughness 1", "a rough wall")], 3),
    ]),
    ("Impacts", [
        Group("impact", "--impact", "An impact at a point: here 20 of 24 seeds are scattered around the center of the front. "
              "The last number is their standard deviation, in world units or as the paper's bias n.", "plate.obj", "--pieces 24 --seed 1", [
                  ("none", "", "no impact"),
                  ("003", "--impact 0.5,0.5,0.15,20,0.03", "standard deviation of 3 % of the side"),
                  ("010", "--impact 0.5,0.5,0.15,20,0.1", "10 %"),
                  ("025", "--impact 0.5,0.5,0.15,20,0.25", "25 %"),
                  ("n2", "--impact 0.5,0.5,0.15,20,n=2", "n = 2: a standard deviation of side / &radic;24"),
                  ("n5", "--impact 0.5,0.5,0.15,20,n=5", "n = 5, the default"),
                  ("n15", "--impact 0.5,0.5,0.15,20,n=15", "n = 15"),
                  ("n100", "--impact 0.5,0.5,0.15,20,n=100", "n = 100")]),
        Group("impacts", "Several impacts", "Each `--impact` adds one; `--impacts` places them at random.", "plate.obj",
              "--seed 1", [
                  ("two", "--pieces 24 --impact 0.2,0.8,0.15,10,0.05 --impact 0.8,0.3,0.15,10,0.05",
                   "top left and bottom right"),
                  ("random", "--pieces 24 --impacts 3", "three at random"),
                  ("alone", "--pieces 8", "eight pieces, no impact"),
                  ("merge", "--pieces 8 --impact 0.5,0.5,0.15,16,0.1,merge",
                   "`merge`: still eight; the impact's seeds only bend nearby cracks")]),
    ]),
    ("Figure 6: an impact by a ray", [
        Group("figure6", "--impact ray:",
              "The paper selects an impact on the screen. A ray from the camera, origin and direction, "
              "hits the first solid voxel; `ray:` below is the center of the image.", "amphora.ply", "--seed 1", [
                  ("before", "--pieces 4", "four fragments, no impact"),
                  ("ray", "--pieces 18 --impact " + EYE + ",14,0.03", "eighteen, 14 of them from an impact with sigma 3 cm"),
                  ("wide", "--pieces 18 --impact " + EYE + ",14,0.08", "8 cm"),
                  ("rough", "--pieces 18 --roughness 1 --resolution 192 --impact " + EYE + ",14,0.03",
                   "rough, and finer")]),
    ]),
    ("Erosion", [
        Group("erode-iterations", "--erode-iterations", "Iterations of erosion of cracks. The original surface stays.", "plate.obj",
              "--pieces 6 --seed 3 --resolution 96", [
                  ("0", "--erode-iterations 0", "not at all"), ("1", "--erode-iterations 1", "once"),
                  ("3", "--erode-iterations 3", "three times"), ("6", "--erode-iterations 6", "six times")]),
        Group("erode-threshold", "--erode-threshold", "The least filled share of the shape. At 1 each iteration removes a layer; below, only "
              "edges and corners.", "plate.obj", ERODE + " 6 --erode-size 5", [
                  ("10", "--erode-threshold 1", "all of the crack recedes"),
                  ("08", "--erode-threshold 0.8", "less"), ("07", "--erode-threshold 0.7", "edges become round"),
                  ("05", "--erode-threshold 0.5", "almost no change")]),
        Group("erode-probability", "--erode-probability", "Voxels are tested at random: pitted cracks.", "plate.obj",
              ERODE + " 4", [
                  ("10", "--erode-probability 1", "always"), ("05", "--erode-probability 0.5", "half of the voxels"),
                  ("02", "--erode-probability 0.2", "20 %"), ("005", "--erode-probability 0.05", "5 %")]),
        Group("erode-on", "--erode-on", "The surface to erode.", "amphora.ply",
              "--pieces 8 --seed 3 --resolution 192 --erode-iterations 2 --erode-probability 0.3", [
                  ("fracture", "--erode-on fracture", "the default: the cracks"),
                  ("all", "--erode-on all", "the whole surface"),
                  ("gentle", "--erode-on all --erode-threshold 0.7", "the whole surface, less")], 3),
        Group("erode-islands", "--erode-islands", "Islands that erosion splits off.", "plate.obj",
              ERODE + " 12 --erode-probability 0.5", [
                  ("erode", "--erode-islands erode", "the default: removed, every fragment is connected"),
                  ("keep", "--erode-islands keep", "kept, as voxels of their fragment")], 2),
    ]),
    ("Surfaces", [
        Group("surface", "--surface and --interface", "Meshes of the same voxels.", "amphora.ply",
              "--pieces 6 --seed 3 --resolution 64", [
                  ("smooth", "--surface smooth", "the default: the original surface and smooth cracks, one mesh of all "
                   "fragments"),
                  ("independent", "--interface independent", "each fragment meshed by random points of its surface"),
                  ("labels", "--surface labels", "voxel faces"),
                  ("paper", "--preset paper", "the paper's options: labels, smoothed")]),
        Group("exact", "--surface exact", "The outside of a mesh with sharp edges.", "gear.obj", "--pieces 7 --seed 2 --resolution 64 --roughness 1", [
            ("smooth", "--surface smooth", "the default: edges on those of the input, which resolves what is larger than a voxel"),
            ("exact", "--surface exact", "the input's own triangles, cut by the cracks")], 2),
        Group("sharp", "Sharp edges and --resolution", "Edges of the default surface lie on those of the mesh.", "gear.obj", "--pieces 7 --seed 2", [
            (str(n), f"--resolution {n}", "") for n in (24, 64, 128, 256)]),
        Group("figure8", "Figure 8: --smooth-boundary-weight", "Voxel faces, smoothed without cracks, and with cracks.", "amphora.ply", VOXEL_FACES + " --smoothing laplacian --smooth-weight 0.9 --smooth-iterations 0.048k --smooth-boundary-iterations 0.048k", [
                  ("0", "--smooth-boundary-weight 0", "cracks keep voxel faces"),
                  ("02", "--smooth-boundary-weight 0.2", "the paper's"),
                  ("09", "--smooth-boundary-weight 0.9", "as strong as elsewhere: contact boundaries recede")], 3),
    ]),
]

HISTOGRAMS = [  # mesh plate.obj
    ("figure5-sampler", "One image, and the shares of 20 fractures, seeds 1 to 20, ten pieces each.",
     "--pieces 10 --resolution 96", [
         ("uniform", "--sampler uniform"), ("halton", "--sampler halton"), ("gaussian", "--sampler gaussian"),
         ("poisson", "--sampler poisson")]),
    ("figure5-spread", "Two impacts with 8 of 20 seeds each, increasingly concentrated: many small fragments and "
     "a few large ones.", "--pieces 20 --resolution 96", [
         (f"n{n}", f"--impact 0.25,0.7,0.15,8,n={n} --impact 0.75,0.3,0.15,8,n={n}") for n in (2, 10, 50, 250)]),
    ("figure5-extra", "Extra seeds bend the cracks and hardly change the distribution of shares.", "--pieces 10 --resolution 96", [
        (k, f"--extra-seeds {k}") for k in ("0", "1n", "2n", "6n")]),
]
SEEDS = range(1, 21)
SHOWN_SEED = 5

SHAPES = ["cross", "square", "ellipse"]
SIZES = [3, 5, 7]
FIGURE7 = "--pieces 1 --resolution 48 --erode-on all --erode-iterations 6 --erode-threshold 0.57"


# ---- running and rendering ---------------------------------------------------------------------------------------------

def command(mesh, options):
    mesh = "data/amphora.ply" if mesh == "amphora.ply" else mesh
    return " ".join(f"sherd fracture {mesh} -o pieces {options}".split())


class Runner:
    def __init__(self, sherd, work):
        self.sherd, self.work, self.count = pathlib.Path(sherd).resolve(), work, 0

    def fracture(self, mesh, options, write):
        """Break a mesh; returns the folder, which the next call replaces."""
        self.count += 1
        line = [str(self.sherd), "fracture", mesh, "-o", "pieces", *shlex.split(options), "--write", write, "--quiet"]
        done = subprocess.run(line, cwd=self.work, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{done.stderr.strip()}\n(ran: {shlex.join(line)})")
        if done.stderr:
            print(f"{options}: {done.stderr.strip()}", file=sys.stderr)
        return self.work / "pieces"

    def rendered(self, folder, words):
        subprocess.run([str(self.sherd), "render", *words.split(), "-o", "image.png"], cwd=folder, check=True)
        return Image.open(folder / "image.png").convert("RGB")

    def preview(self, mesh, options):
        return Image.open(self.fracture(mesh, options, "preview") / "preview.png").convert("RGB")


def colored_box(image):
    """Bounding box of the fragments: ground and shadow are gray."""
    pixels = np.asarray(image).astype(int)
    mask = pixels.max(axis=2) - pixels.min(axis=2) > 24
    rows, columns = np.flatnonzero(mask.sum(axis=1) > 1), np.flatnonzero(mask.sum(axis=0) > 1)
    return columns[0], rows[0], columns[-1] + 1, rows[-1] + 1


def cropped(images, side=SIDE):
    """The images, with one crop that contains all fragments of each."""
    boxes = np.array([colored_box(image) for image in images])
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    margin = int(0.04 * max(high - low)) + 6
    low, high = np.maximum(low - margin, 0), np.minimum(high + margin, images[0].size)
    scale = side / max(high - low)
    size = tuple(int(round(s)) for s in (high - low) * scale)
    return [image.crop((*low, *high)).resize(size, Image.LANCZOS) for image in images]


class Page:
    def __init__(self, folder):
        self.images = folder / "images" / "gallery"
        self.images.mkdir(parents=True, exist_ok=True)
        self.path, self.lines = folder / "gallery.md", []

    def text(self, *lines):
        self.lines += [*lines, ""]

    def photo(self, name, image):
        image.save(self.images / f"{name}.jpg", quality=80, optimize=True)
        return self.image_tag(f"{name}.jpg", image.width)

    def drawing(self, name, image):
        image.convert("RGB").quantize(64, dither=Image.Dither.NONE).save(self.images / f"{name}.png", optimize=True)
        return self.image_tag(f"{name}.png", image.width)

    def image_tag(self, file, width):
        return f'<img src="images/gallery/{file}" width="{width}" alt="{file.rsplit(".", 1)[0]}">'

    def table(self, cells, columns):
        """Cells [(image, caption)], in rows of `columns`."""
        for start in range(0, len(cells), columns):
            row = cells[start:start + columns]
            self.lines += ["| " + " | ".join(cell[0] for cell in row) + " |", "|" + "---|" * len(row)]
            self.text("| " + " | ".join(cell[1] for cell in row) + " |")

    def commands(self, lines):
        self.text("```", *lines, "```")

    def finish(self):
        self.path.write_text("\n".join(self.lines).rstrip() + "\n")


def show_group(page, runner, group):
    page.text(f"### `{group.title}`" if group.title.startswith("--") else f"### {group.title}", "", group.text)
    options = [" ".join(f"{group.base} {item[1]}".split()) for item in group.items]
    images = cropped([runner.preview(group.mesh, o) for o in options])
    cells = []
    for (name, own, words), image in zip(group.items, images):
        label = f"`{own}`" if own and len(own) < 40 else ""
        cells.append((page.photo(f"{group.key}-{name}", image), "<br>".join(part for part in (label, words) if part)))
    page.table(cells, group.columns if group.columns * images[0].width <= 1000 else 2)
    page.commands([command(group.mesh, o) for o in options])


def cubes(cells, colors, width, height, scale, center):
    """Unit cubes [n, 3] with colors [n, 3], from the right and above, y up."""
    image = Image.new("RGB", (2 * width, 2 * height), "white")
    draw = ImageDraw.Draw(image)
    a, e = math.radians(32), math.radians(26)  # azimuth and elevation of the eye
    eye = np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)])
    right = np.array([math.cos(a), 0.0, -math.sin(a)])
    up = np.cross(eye, right)
    filled = {tuple(c) for c in cells}
    faces = [((1, 0, 0), [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)], 0.66),
             ((0, 1, 0), [(0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)], 1.0),
             ((0, 0, 1), [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], 0.83)]
    for i in np.argsort(cells @ eye, kind="stable"):
        for normal, corners, light in faces:
            if tuple(cells[i] + normal) in filled:
                continue
            p = (cells[i] + np.array(corners) - center) * 2 * scale
            fill = tuple(int(c * light) for c in colors[i])
            draw.polygon([(width + q @ right, height - q @ up) for q in p], fill=fill,
                         outline=tuple(int(0.8 * c) for c in fill))
    return image.resize((width, height), Image.LANCZOS)


COST_READER = r"""
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <cstdio>

int main(int, char** arguments) {
  openvdb::initialize();
  openvdb::io::File file(arguments[1]);
  file.open();
  const auto grid = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("cost"));
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Coord c = value.getCoord();
    const int row[4] = {c.x(), c.y(), c.z(), *value};
    std::fwrite(row, sizeof(int), 4, stdout);
  }
}
"""


def read_labels(path):
    raw = path.read_bytes()
    dims = np.frombuffer(raw, "<u4", 3)
    runs = np.frombuffer(raw, [("label", "<u2"), ("length", "<u4")], offset=12)
    return np.repeat(runs["label"], runs["length"]).reshape(dims)


PALETTE = np.array([(222, 122, 138), (108, 168, 224), (96, 190, 160), (226, 184, 92)])


def show_figure3(page, runner):
    page.text("## Figure 3: ten steps", "", "The voxels that a flood of four seeds has reached after ten steps, from the grid of "
              "`--write cost`: a voxel's value is its arrival cost, shown as rings. Cut open at the "
              "seeds. Below, the fragments after the whole flood.")
    source, program = runner.work / "read_cost.cpp", runner.work / "read_cost"
    source.write_text(COST_READER)
    subprocess.run(["g++", "-std=c++17", "-O1", source, "-o", program, "-lopenvdb", "-ltbb"], check=True)
    cells, previews, lines = [], [], []
    for neighbors in (26, 6):
        options = f"--seeds four.json --resolution 48 --growth flood --neighborhood {neighbors}"
        folder = runner.fracture("block.obj", options, "labels,cost,preview")
        labels = read_labels(folder / "labels.rle")
        rows = np.frombuffer(subprocess.run([program, folder / "cost.vdb"], check=True, stdout=subprocess.PIPE).stdout,
                             np.int32).reshape(-1, 4)
        low = np.array(json.loads((folder / "manifest.json").read_text())["grid"]["index_min"])
        reached = rows[(rows[:, 3] <= 10) & (rows[:, 2] <= rows[rows[:, 3] == 0, 2].max())]
        owner = labels[tuple((reached[:, :3] - low).T)].astype(int) - 2
        shade = np.where(reached[:, 3] % 2 == 0, 1.0, 0.8)[:, None]
        image = cubes(reached[:, :3], PALETTE[owner % 4] * shade, SIDE, SIDE, 5.2, low + [24, 24, 20])
        words = {26: "26 neighbors (Moore): cubes", 6: "6 neighbors (von Neumann): octahedra"}[neighbors]
        cells.append((page.drawing(f"figure3-{neighbors}", image), words))
        previews.append(Image.open(folder / "preview.png").convert("RGB"))
        lines.append(command("block.obj", options + " --write labels,cost,preview"))
    page.table(cells, 2)
    page.table([(page.photo(f"figure3-{n}-whole", image), f"`--neighborhood {n}`")
                for n, image in zip((26, 6), cropped(previews))], 2)
    page.commands(lines)


def histogram(shares, most, title):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(3.2, 2.0), dpi=100)
    axes.hist(100 * shares, bins=np.linspace(0, most, 31), color="#6c8cbf")
    axes.axvline(100 * shares.mean(), color="#b04a4a", linewidth=1)
    axes.set_xlabel("share of the solid, %", fontsize=8)
    axes.set_ylabel("fragments", fontsize=8)
    axes.set_title(title, fontsize=8)
    axes.tick_params(labelsize=7)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.tight_layout(pad=0.4)
    figure.canvas.draw()
    image = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[:, :, :3].copy())
    plt.close(figure)
    return image


def show_figure5(page, runner):
    page.text("## Figure 5: volumes by sampler, sigma and extra seeds", "", "The red line is the mean share.")
    for key, text, base, items in HISTOGRAMS:
        page.text(text)
        options = [f"{base} {own}" for _, own in items]
        shares = []
        for o in options:
            manifests = [json.loads((runner.fracture("plate.obj", f"{o} --seed {s}", "seeds") / "manifest.json").read_text())
                         for s in SEEDS]
            shares.append(np.array([f["share"] for m in manifests for f in m["fragments"]]))
        most = math.ceil(20 * max(np.quantile(s, 0.995) for s in shares)) * 5
        images = cropped([runner.preview("plate.obj", f"{o} --seed {SHOWN_SEED}") for o in options], 240)
        cells = []
        for (name, own), image, share in zip(items, images, shares):
            title = f"{len(share)} fragments, standard deviation {100 * share.std():.1f} %"
            plot = page.drawing(f"{key}-{name}-shares", histogram(share, most, title))
            label = own if own.count("--") == 1 else "n = " + name[1:]
            cells.append((page.photo(f"{key}-{name}", image) + "<br>" + plot, f"`{label}`"))
        page.table(cells, 2)
        page.commands([command("plate.obj", f"{o} --seed {SHOWN_SEED}") for o in options])


def shape_cells(shape, size, planes):
    """The cells of include/sherd/labels.h; with planes the sections by the three axis planes."""
    r = size // 2
    grid = np.stack(np.meshgrid(*[np.arange(-r, r + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    zeros = (grid == 0).sum(axis=1)
    inside = {"cross": zeros >= 2, "square": zeros >= 0, "ellipse": (grid**2).sum(axis=1) <= r * r}[shape]
    return grid[inside & (zeros >= 1)] if planes else grid[inside]


def show_figure7(page, runner):
    page.text("## Figure 7: erosion shapes", "",
              "The cells of each `--erode-shape` at size 5, and their effect on a block at sizes 3, 5 and 7: six iterations, and a voxel stays if 57 "
              "% of its shape is filled. A flat face fills more than that, an edge or corner less, so "
              "edges become round. With `--erode-planes`, as in the paper, the three sections are "
              "tested separately, and one below the threshold suffices. A cross in 3-D is well filled "
              "on an edge: it erodes corners only. Cross and ellipse of size 3 have the same cells, and "
              "no effect here. The rest of a flat face is half a voxel above the eroded region beside "
              "it, because erosion removes whole voxels.")
    for planes in (False, True):
        for shape in SHAPES:
            flags = f"--erode-shape {shape}" + (" --erode-planes" if planes else "")
            key = f"figure7-{shape}" + ("-planes" if planes else "")
            cells = shape_cells(shape, 5, planes)
            count = f"3 times {(cells[:, 0] == 0).sum()} cells" if planes else f"{len(cells)} cells"
            colors = np.where((cells == 0).all(axis=1)[:, None], (200, 110, 110), (130, 160, 205))
            row = [(page.drawing(key, cubes(cells, colors, 150, 150, 19, np.full(3, 0.5))), count)]
            options = [f"{FIGURE7} {flags} --erode-size {size}" for size in SIZES]
            for size, image in zip(SIZES, cropped([runner.preview("block.obj", o) for o in options], 220)):
                row.append((page.photo(f"{key}-{size}", image), f"`--erode-size {size}`"))
            page.text(f"`{flags}`")
            page.table(row, 4)
            page.commands([command("block.obj", o) for o in options])


def view():
    """Right, up and towards the eye: from the right and above, y up."""
    a, e = math.radians(35), math.radians(20)
    eye = np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)])
    right = np.array([math.cos(a), 0.0, -math.sin(a)])
    return np.array([right, np.cross(eye, right), eye])


def framed(points, size):
    """Projects points to an image of twice this size; returns pixel positions and depth."""
    seen = points @ view().T
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    scale = 1.88 * size / max(high - low)
    position = (seen[:, :2] - (low + high) / 2) * scale
    return np.column_stack([size + position[:, 0], size - position[:, 1]]), seen[:, 2]


def wires(path, size):
    """A mesh with its edges; faces towards other fragments are lighter."""
    points, triangles, neighbor = read_mesh(path)
    position, depth = framed(points, size)
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None] + 1e-30
    light = 0.55 + 0.45 * np.clip(normals @ (view()[2] + 0.5 * view()[1]) / 1.12, 0, 1)
    image = Image.new("RGB", (2 * size, 2 * size), "white")
    draw = ImageDraw.Draw(image)
    for t in np.argsort(depth[triangles].mean(axis=1), kind="stable"):
        if normals[t] @ view()[2] <= 0:
            continue
        color = np.array((226, 184, 92) if neighbor[t] == 0 else (244, 232, 205)) * light[t]
        draw.polygon([tuple(q) for q in position[triangles[t]]], fill=tuple(int(c) for c in color), outline=(90, 80, 60))
    return image.resize((size, size), Image.LANCZOS)


def dots(path, size):
    """Visible points on a fragment; on cracks they are red."""
    vertex = read_ply(path)["vertex"]
    points = np.column_stack([vertex[axis] for axis in "xyz"]).astype(float)
    normals = np.column_stack([vertex["n" + axis] for axis in "xyz"])
    position, _ = framed(points, size)
    image = Image.new("RGB", (2 * size, 2 * size), "white")
    draw = ImageDraw.Draw(image)
    for (x, y), neighbor, towards in zip(position, vertex["neighbor"], normals @ view()[2]):
        if towards > 0:
            draw.ellipse([x - 3, y - 3, x + 3, y + 3], fill=(60, 80, 120) if neighbor == 0 else (190, 80, 70))
    return image.resize((size, size), Image.LANCZOS)


def read_obj(path):
    """Vertices, and polygons split into triangles."""
    points, triangles = [], []
    for line in path.read_text().split("\n"):
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(w.split("/")[0]) - 1 for w in words[1:]]
            triangles += [(corners[0], a, b) for a, b in zip(corners[1:], corners[2:])]
    return np.array(points), np.array(triangles)


HUES = np.array([(222, 122, 138), (108, 168, 224), (96, 190, 160), (226, 184, 92), (166, 134, 214), (232, 150, 96),
                 (140, 190, 90), (200, 130, 190), (110, 130, 200), (190, 170, 130)])


def apart(pieces, eye, size):
    """Pieces [(vertices, triangles)] moved apart, seen from `eye`; y up."""
    right = np.cross([0.0, 1.0, 0.001], eye)
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(eye, right), eye])
    middle = np.mean([vertices.mean(axis=0) for vertices, _ in pieces], axis=0)
    corners, colors = [], []
    for i, (vertices, triangles) in enumerate(pieces):
        moved = vertices + 0.35 * (vertices.mean(axis=0) - middle)
        corners.append((moved @ axes.T)[triangles])
        colors.append(np.tile(HUES[i % len(HUES)], (len(triangles), 1)))
    corners, colors = np.concatenate(corners), np.concatenate(colors)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None] + 1e-30
    light = 0.45 + 0.55 * np.clip(normals @ np.array([0.3, 0.5, 0.81]), 0, 1)
    flat = corners[:, :, :2]
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    scale = 1.9 * size / max(high - low)
    image = Image.new("RGB", (2 * size, 2 * size), "white")
    draw = ImageDraw.Draw(image)
    for t in np.argsort(corners[:, :, 2].mean(axis=1), kind="stable"):
        if normals[t, 2] <= 0:
            continue
        position = (flat[t] - (low + high) / 2) * scale
        draw.polygon([(size + x, size - y) for x, y in position], fill=tuple(int(c) for c in colors[t] * light[t]))
    return image.resize((size, size), Image.LANCZOS)


def show_figure15(page, runner):
    # The amphora's handles are separate components; the add-on's booleans need a single one.
    whole = runner.fracture("amphora.ply", "--pieces 1", "mesh") / "meshes/amphora_001.ply"
    shutil.copy(whole, runner.work / "whole.ply")
    script = ROOT / "tools/studies/cell_fracture_in_blender.py"
    subprocess.run(["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", script, "--",
                    runner.work / "whole.ply", runner.work / "cells", "8", "1"], check=True, stdout=subprocess.DEVNULL)
    theirs = [read_obj(path) for path in sorted((runner.work / "cells/pieces").glob("*.obj"))]
    options = f"--pieces {len(theirs)} --seed 3 --mesh-format obj"
    folder = runner.fracture("amphora.ply", options, "mesh") / "meshes"
    ours = [read_obj(path) for path in sorted(folder.glob("*.obj"))]
    page.text("### Figure 15: beside Cell Fracture", "", f"The amphora in {len(ours)} pieces, seen from the front, the back and "
              "above: by Blender's add-on Cell Fracture, with 8 seeds ([convexity.md](convexity.md) has "
              "metrics), and by Sherd. The add-on's input is the mesh of the intact solid: the "
              "amphora's handles overlap its wall, and the add-on's booleans leave such cells uncut.")
    cells = []
    for key, words, pieces in (("cells", "Cell Fracture", theirs), ("sherd", "Sherd", ours)):
        for view_key, eye in (("front", [0, 0, 1]), ("back", [0, 0, -1]), ("top", [0, 1, 0])):
            name = f"figure15-{key}-{view_key}"
            cells.append((page.drawing(name, apart(pieces, np.array(eye, float), 240)), f"{words}, {view_key}"))
    page.table(cells, 3)
    page.commands([command("amphora.ply", options)])


def show_figure9(page, runner):
    page.text("### Figure 9: `--triangles` and `--adaptivity`", "",
              "A fragment of the amphora as extracted, decimated, and simplified in flat regions. Faces "
              "of cracks are lighter; neighbors share them.")
    base, cells, lines = "--pieces 8 --seed 1 --resolution 96", [], []
    for key, own, file in (("all", "", ""), ("2000", "--triangles 2000", "_t2000"), ("300", "--triangles 300", "_t300"),
                           ("adaptive", "--adaptivity 0.1", "")):
        options = f"{base} {own}".strip()
        path = runner.fracture("amphora.ply", options, "mesh") / "meshes" / f"amphora_005{file}.ply"
        count = len(read_ply(path)["face"])
        cells.append((page.drawing(f"figure9-{key}", wires(path, SIDE)), (f"`{own}`<br>" if own else "") + f"{count} triangles"))
        lines.append(command("amphora.ply", options))
    page.table(cells, 2)
    page.commands(lines)


def show_creases(page):
    """Images by crease_pictures.py, of meshes that are not in the repository."""
    page.text("### Creases of open, overlapping and thin meshes", "",
              "Fragments close up in Blender at 64, 96, 128 and 256 voxels: without creases above, with them below. Creases less than a voxel apart,"
              " as the monkey's eyes and the tires at 64, are not kept.")
    for name, words in (("monkey", "Blender's monkey, which is open"), ("tray", "a tray of one voxel's thickness, with holes"), ("car", "a tire"),
                        ("gearbox", "overlapping gears"), ("goblet", "the rim of a goblet")):
        page.text(f'<img src="images/creases/{name}.jpg" width="1200" alt="{words}">', "", words.capitalize() + ".")


def show_materials(page):
    """The section that material_pictures.py wrote."""
    first, last = "<!-- materials -->", "<!-- end of materials -->"
    section = (ROOT / "docs/gallery.md").read_text().split(first)[1].split(last)[0]
    page.text(first + section + last)


def show_merged(page, runner):
    page.text("### `--adaptivity auto`", "",
              "A fragment of a block, whose faces are flat: by default the triangles in each plane are merged.")
    cells, lines = [], []
    for key, own in (("none", "--adaptivity 0"), ("auto", "--adaptivity auto")):
        options = f"--pieces 8 --seed 1 --resolution 64 {own}"
        path = runner.fracture("block.obj", options, "mesh") / "meshes" / "block_005.ply"
        count = len(read_ply(path)["face"])
        cells.append((page.drawing(f"merged-{key}", wires(path, SIDE)), f"`{own}`<br>{count} triangles"))
        lines.append(command("block.obj", options))
    page.table(cells, 2)
    page.commands(lines)


def show_figure11(page, runner):
    page.text("### Figure 11: `--point-sampler`", "", "1000 points on a fragment; those on cracks are red.")
    base, cells, lines = "--pieces 8 --seed 1 --points 1000", [], []
    for sampler, words in (("uniform", "independent: clusters and holes"), ("halton", "low-discrepancy, by Halton's sequence"),
                           ("poisson", "with a minimum distance")):
        options = f"{base} --point-sampler {sampler}"
        path = runner.fracture("amphora.ply", options, "seeds") / "points" / "amphora_005.ply"
        cells.append((page.drawing(f"figure11-{sampler}", dots(path, SIDE)), f"`--point-sampler {sampler}`<br>{words}"))
        lines.append(command("amphora.ply", options))
    page.table(cells, 3)
    page.commands(lines)


def show_render(page, runner):
    page.text("## Images of a fracture", "", "`sherd render` renders a finished fracture, its level sets or hulls, or any mesh.")
    options = "--pieces 8 --seed 1 --write mesh,proxy"
    folder = runner.fracture("amphora.ply", options, "mesh,proxy")
    page.commands([command("amphora.ply", options)])
    for title, items in (
            ("`--view`", [("front", "pieces --view front"), ("top", "pieces --view top"), ("behind", "pieces --view 215,-10")]),
            ("`--explode`", [("together", "pieces --explode 0"), ("apart", "pieces --explode 1")]),
            ("Other inputs", [("piece", "pieces/meshes/amphora_002.ply"), ("hulls", "pieces/proxies")])):
        page.text(f"### {title}")
        lines = [f"sherd render {words} -o image.png" for _, words in items]
        images = cropped([runner.rendered(folder.parent, words) for _, words in items], 230)
        cells = [(page.photo(f"render-{name}", image), f"`{words.split(' ', 1)[-1]}`")
                 for (name, words), image in zip(items, images)]
        page.table(cells, 3)
        page.commands(lines)


INTRODUCTION = """# Gallery

Images of what each option does, each with its command. `tools/studies/pictures.sh` makes this page and its
images: `preview.png`, with the same crop in a row, scaled down. `tools/studies/gallery.py --inputs .` writes the other
inputs: `block.obj` (side 1), `plate.obj` (1 by 1 by 0.15, the front at z = 0.15), `ball.obj` (radius 1), `gear.obj` (radius 1, 14 teeth), and seeds.

Options without an image: `--device` and `--threads` change only the time, `--write`, `--json`, `--quiet` and the files for
hosts (`--vdb` and following) select the output, and those of distances (`--sdf-samples` and its type) do not change fragments. [cli.md](cli.md) has the meaning and range of every option."""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", nargs="?", help="the program")
    parser.add_argument("folder", type=pathlib.Path, help="docs, or another output folder")
    parser.add_argument("--inputs", action="store_true", help="only write the meshes and seeds to FOLDER")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    if options.inputs:
        write_inputs(options.folder)
        return
    if not options.sherd:
        parser.error("the program is missing, as in gallery.py build/release/sherd docs")
    with tempfile.TemporaryDirectory(prefix="sherd-gallery-") as work:
        runner, page = Runner(options.sherd, pathlib.Path(work)), Page(options.folder)
        write_inputs(runner.work)
        page.text(INTRODUCTION)
        for title, groups in CHAPTERS:
            page.text(f"## {title}")
            for group in groups:
                print(group.key, flush=True)
                show_group(page, runner, group)
            if title == "Surfaces":
                print("figures 9 and 11", flush=True)
                show_creases(page)
                show_figure9(page, runner)
                show_merged(page, runner)
                show_figure11(page, runner)
                if shutil.which("blender"):
                    show_figure15(page, runner)
                else:
                    print("Figure 15 is skipped: it needs Debian's blender", file=sys.stderr)
            if title == "Growth":
                show_figure3(page, runner)
            if title == "Seeds":
                print("figure5", flush=True)
                show_figure5(page, runner)
        print("figure7", flush=True)
        show_figure7(page, runner)
        print("images", flush=True)
        show_render(page, runner)
        show_materials(page)
        page.finish()
        size = sum(f.stat().st_size for f in page.images.iterdir())
        print(f"{runner.count} fractures, {len(list(page.images.iterdir()))} images, {size} bytes")


if __name__ == "__main__":
    main()
