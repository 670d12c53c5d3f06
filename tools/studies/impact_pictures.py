#!/usr/bin/python3
"""Strike a pane, a plate, a bottle and a statue with every material, render them, and measure where small pieces lie.

usage: impact_pictures.py SHERD FOLDER [options]

Breaks four generated meshes by `sherd fracture --material NAME --impact POINT,...`, once by a count of pieces and once by an energy, and writes

- FOLDER/images/impacts-count.png and impacts-energy.png: a row for each mesh, a column for each material, struck from the front;
- the section on impacts of FOLDER/gallery.md: the two images with their commands;
- the table of FOLDER/materials.md: for each mesh and material the number of pieces, and the median distance of those below the median volume to the
  point, in % of the longest side, at two resolutions;
- with --inputs only the four meshes, into FOLDER.

With FOLDER docs it makes those of this repository.  Needs Debian's python3-numpy and python3-pil.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from gallery import box, write_obj
from material_pictures import MATERIALS, fitted, replace_section, table

SIDE = 150  # pixels of an image in the sheet
COLORS = 144  # of a sheet
RESOLUTIONS = (96, 256)
STRIKES = {"count": ("{point},25", "--pieces 25"), "energy": ("{point},energy=4", "--pieces 80")}
NAMES = MATERIALS[1:]


def turned(profile, steps):
    """The closed surface of revolution about y of (radius, height) from the bottom's rim to where it ends, inside or on top."""
    points = [(r * math.cos(2 * math.pi * i / steps), y, r * math.sin(2 * math.pi * i / steps)) for r, y in profile for i in range(steps)]
    faces = []
    for k in range(len(profile) - 1):
        for i in range(steps):
            j = (i + 1) % steps
            faces.append((k * steps + i, (k + 1) * steps + i, (k + 1) * steps + j, k * steps + j))
    last = (len(profile) - 1) * steps
    return points, faces + [tuple(range(steps)), tuple(last + i for i in reversed(range(steps)))]


def plate():
    return turned([(0.30, 0), (0.34, 0.01), (0.62, 0.09), (0.97, 0.17), (1.0, 0.20), (0.96, 0.21), (0.62, 0.14), (0.32, 0.06)], 128)


def bottle():
    outside = [(0.30, 0), (0.33, 0.03), (0.33, 1.0), (0.30, 1.12), (0.14, 1.32), (0.12, 1.40), (0.12, 1.62), (0.14, 1.64), (0.14, 1.70)]
    return turned(outside + [(0.09, 1.70), (0.09, 1.42), (0.11, 1.33), (0.26, 1.12), (0.29, 1.0), (0.29, 0.06)], 128)


def statue():
    """A figure on a pedestal."""
    return turned([(0.50, 0), (0.50, 0.12), (0.38, 0.16), (0.34, 0.24), (0.36, 0.5), (0.30, 0.85), (0.33, 1.10), (0.40, 1.30), (0.36, 1.42), (0.17, 1.50),
                   (0.14, 1.58), (0.19, 1.66), (0.24, 1.80), (0.23, 1.92), (0.16, 2.04), (0.06, 2.10)], 96)


class Solid:
    """A mesh, where it is struck, and from where it is seen."""

    def __init__(self, name, mesh, point, view, explode, up="y"):
        self.name, self.mesh, self.point, self.view, self.explode, self.up = name, mesh, point, view, explode, up


SOLIDS = [Solid("pane", box(1, 1, 0.02), "0.45,0.55,0.02", "15,10", 0.1),
          Solid("plate", plate(), "0.3,0.065,0.15", "20,50", 0.15),
          Solid("bottle", bottle(), "0,0.6,0.33", "20,10", 0.2),
          Solid("statue", statue(), "0,1.2,0.36", "25,10", 0.3)]


def command(solid, name, strike, resolution):
    impact, pieces = STRIKES[strike]
    return (f"sherd fracture {solid.name}.obj -o pieces --material {name} --impact {impact.format(point=solid.point)} {pieces} "
            f"--resolution {resolution} --seed 1")


def fracture(options, work, line, where):
    words = line.split()
    words[0], words[2], words[4] = options.sherd, work / words[2], where
    done = subprocess.run([*words, "--write", "mesh", "--quiet"], stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{done.stderr.strip()}\n(ran: {line})")
    if done.stderr:
        print(f"{line}\n  {done.stderr.strip()}", file=sys.stderr)


def distance_of_small(folder, solid):
    """The number of pieces, and the median distance from the point to those below the median volume, in % of the longest side."""
    fragments = json.loads((folder / "manifest.json").read_text())["fragments"]
    volumes = np.array([f["volume"] for f in fragments])
    centers = np.array([f["centroid"] for f in fragments])
    side = np.ptp(np.array(solid.mesh[0]), axis=0).max()
    apart = np.linalg.norm(centers - np.array([float(x) for x in solid.point.split(",")[:3]]), axis=1)
    return len(fragments), 100 * np.median(apart[volumes <= np.median(volumes)]) / side


def rendered(options, folder, solid):
    file = folder / "image.png"
    subprocess.run([options.sherd, "render", folder / "meshes", "-o", file, "--view", solid.view, "--explode", str(solid.explode), "--up", solid.up,
                    "--size", f"{4 * SIDE}x{4 * SIDE}"], check=True)
    return fitted(Image.open(file).convert("RGB"), SIDE, SIDE)


def sheet(images):
    """The images by (mesh, material), in rows and columns with the materials' names."""
    out = Image.new("RGB", (SIDE * len(NAMES), 16 + SIDE * len(SOLIDS)), "white")
    draw, font = ImageDraw.Draw(out), ImageFont.load_default()
    for column, name in enumerate(NAMES):
        draw.text((SIDE * column + 6, 2), name, fill="black", font=font)
        for row, solid in enumerate(SOLIDS):
            out.paste(images[solid.name, name], (SIDE * column, 16 + SIDE * row))
    return out.quantize(COLORS, dither=Image.Dither.NONE)


def gallery():
    lines = ["## Impacts on materials", "", "`--impact` at one point, seen from the side that is struck, with each material: 25 pieces, and as many as an energy of 4 makes.",
             "`tools/studies/impact_pictures.py --inputs` writes the meshes. [materials.md](materials.md#impacts) has where small pieces lie.", ""]
    for strike, title in (("count", "By a count of pieces"), ("energy", "By an energy")):
        lines += [f"### {title}", "", f"![A pane, a plate, a bottle and a statue of eight materials, struck](images/impacts-{strike}.png)", "", "```"]
        lines += [command(solid, "glass", strike, RESOLUTIONS[1]) for solid in SOLIDS] + ["```", ""]
    return "\n".join(lines)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER", help="made; images there are replaced")
    parser.add_argument("--inputs", action="store_true", help="write the meshes only")
    parser.add_argument("--each", type=pathlib.Path, metavar="FOLDER", help="also keep each image, larger, here")
    return parser.parse_args()


def main():
    options = arguments()
    options.sherd = str(pathlib.Path(options.sherd).resolve())
    images = options.folder / "images"
    (options.folder if options.inputs else images).mkdir(parents=True, exist_ok=True)
    if options.inputs:
        for solid in SOLIDS:
            write_obj(options.folder / f"{solid.name}.obj", solid.mesh)
        return
    found, sheets = {}, {strike: {} for strike in STRIKES}
    with tempfile.TemporaryDirectory(prefix="sherd-impacts-") as folder:
        work = pathlib.Path(folder)
        for solid in SOLIDS:
            write_obj(work / f"{solid.name}.obj", solid.mesh)
        for strike in STRIKES:
            for solid in SOLIDS:
                for name in NAMES:
                    for resolution in RESOLUTIONS:
                        where = work / f"{strike}-{solid.name}-{name}-{resolution}"
                        fracture(options, work, command(solid, name, strike, resolution), where)
                        found[strike, solid.name, name, resolution] = distance_of_small(where, solid)
                    sheets[strike][solid.name, name] = rendered(options, where, solid)
                    if options.each:
                        options.each.mkdir(parents=True, exist_ok=True)
                        (where / "image.png").replace(options.each / f"{solid.name}-{name}-{strike}.png")
            sheet(sheets[strike]).save(images / f"impacts-{strike}.png", optimize=True)
    rows = []
    for solid in SOLIDS:
        for strike in STRIKES:
            cells = ["{} / {}, {:.0f} / {:.0f}".format(*(found[strike, solid.name, name, r][k] for k in (0, 1) for r in RESOLUTIONS)) for name in NAMES]
            rows.append([solid.name, STRIKES[strike][0].replace("{point},", ""), *cells])
    replace_section(options.folder / "gallery.md", "impacts", gallery())
    replace_section(options.folder / "materials.md", "impacts", table(["mesh", "impact", *NAMES], rows))


if __name__ == "__main__":
    main()
