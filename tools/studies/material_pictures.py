#!/usr/bin/python3
"""Render every material on a vessel, a plate and a statue, and measure how each differs from none.

usage: material_pictures.py SHERD FOLDER [options]

Breaks data/amphora.ply, a plate of 1 x 1 x 0.04 and a statue by `sherd fracture --material NAME`, renders them with `sherd render`, and writes

- FOLDER/images/materials/SOLID-MATERIAL.jpg: the fragments moved apart, and beside it one fragment from near its largest crack;
- the section on materials of FOLDER/gallery.md: the images with their commands;
- the table of FOLDER/materials.md: figures of the meshes;
- with --sheet N, FOLDER/sheet-SOLID.jpg: the images in a random order (N is its seed), numbered, and FOLDER/key.json: which is which.

With FOLDER docs it makes those of this repository.

The figures: the share of break in the fragments' area; the crack's waviness, the area of each contact by that of its projection onto the plane
through it, less 1; how far cracks follow the up axis, the mean square of its product with their normals (1/3 where none is preferred); elongation,
of the extents of a fragment along its principal axes the largest by the middle one; the largest share; the effective number of fragments, 1 / sum of
squared shares, by their number; contacts per fragment; and the share of eroded voxels.  Means over all fragments or contacts of all solids.

Needs Debian's python3-numpy and python3-pil.
"""
import argparse
import json
import math
import pathlib
import random
import shlex
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from gallery import box, write_obj
from mesh_file import read_mesh

ROOT = pathlib.Path(__file__).resolve().parents[2]
MATERIALS = ["none", "ceramic", "stone", "glass", "tempered", "plaster", "wood", "concrete", "ice"]
FEW, MANY = 16, 150  # pieces; many of tempered glass, which breaks everywhere at once
SIDE = 300  # pixels, the width of each half of an image


TITLES = {"vessel": "A vessel", "plate": "A plate", "statue": "A statue"}
GALLERY = f"""## Materials

`--material`: the fragments moved apart, and one of them from near its largest crack. [materials.md](materials.md) has what each sets, and why.
{FEW} pieces, and {MANY} of tempered glass. `thin_plate.obj` is a box of 1 x 1 x 0.04. The statue is a lion by tomburtonwood (thing 25832, CC BY-SA 3.0, as modified by O. Stein); its images are
under the same license.
"""


class Solid:
    """A mesh, how it is broken, and from where it is seen."""

    def __init__(self, name, mesh, options, view, explode, up="y", height=1.0):
        self.name, self.mesh, self.options, self.view, self.explode, self.up, self.height = name, mesh, options, view, explode, up, int(SIDE * height)


def solids(statue):
    found = [Solid("vessel", "data/amphora.ply", "--seed 4", "35,20", 0.3),
             Solid("plate", "thin_plate.obj", "--seed 3", "0,35", 0.15, up="z", height=0.65)]
    if statue:
        found.append(Solid("statue", str(statue), "--seed 5", "40,15", 0.3))
    return found


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", help="the program")
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER", help="made; images there are replaced")
    parser.add_argument("--statue", type=pathlib.Path, help="its mesh; without it there is none")
    parser.add_argument("--resolution", type=int, default=256, help="voxels along the longest side (default 256)")
    parser.add_argument("--materials", default=",".join(MATERIALS), help="which, separated by commas (default all)")
    parser.add_argument("--only", default="vessel,plate,statue", help="which solids (default all)")
    parser.add_argument("--more", default="", help="further options of every fracture")
    parser.add_argument("--sheet", type=int, metavar="N", help="also write sheets in a random order, by this seed")
    parser.add_argument("--quality", type=int, default=72, help="of the .jpg files (default 72)")
    return parser.parse_args()


# ---- figures of the meshes ------------------------------------------------------------------------------------------

def areas_and_normals(vertices, triangles):
    corner = vertices[triangles]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(cross, axis=1)
    return area / 2, cross / np.maximum(area, 1e-300)[:, None]


def principal_extents(points):
    """Extents along the principal axes, largest first."""
    centered = points - points.mean(axis=0)
    axes = np.linalg.svd(centered, full_matrices=False)[2]
    along = centered @ axes.T
    return along.max(axis=0) - along.min(axis=0)


class Figures:
    """Sums over the fragments of one material."""

    def __init__(self):
        self.area = self.broken = self.projected = self.contact_area = self.upward = 0.0
        self.elongation, self.contacts, self.largest, self.effective, self.eroded = [], [], [], [], []

    def add(self, folder, up):
        manifest = json.loads((folder / "manifest.json").read_text())
        fragments = manifest["fragments"]
        for fragment in fragments:
            self.add_fragment(*read_mesh(folder / fragment["files"]["mesh"]), up)
        share = np.array([f["share"] for f in fragments])
        self.largest.append(share.max())
        self.effective.append(1 / (share**2).sum() * share.sum()**2 / len(share))
        grid = manifest["grid"]
        self.eroded.append(grid["eroded_voxels"] / grid["solid_voxels"])

    def add_fragment(self, vertices, triangles, neighbor, up):
        area, normal = areas_and_normals(vertices, triangles)
        self.area += area.sum()
        self.broken += area[neighbor != 0].sum()
        self.upward += (area * normal[:, "xyz".index(up)]**2)[neighbor != 0].sum()
        self.elongation.append(np.divide(*principal_extents(vertices)[:2]))
        others = [n for n in np.unique(neighbor[neighbor != 0])]
        self.contacts.append(len(others))
        for other in others:
            on = neighbor == other
            mean = (area[on, None] * normal[on]).sum(axis=0)
            if area[on].sum() < 0.01 * area.sum():
                continue
            self.contact_area += area[on].sum()
            self.projected += np.linalg.norm(mean)

    def row(self):
        mean = [np.mean(values) for values in (self.elongation, self.largest, self.effective, self.contacts, self.eroded)]
        return [f"{self.broken / self.area:.1%}", f"{self.contact_area / self.projected - 1:.3f}", f"{self.upward / self.broken:.2f}",
                f"{mean[0]:.2f}", f"{mean[1]:.1%}", f"{mean[2]:.2f}", f"{mean[3]:.1f}", f"{mean[4]:.1%}"]


FIGURES = ["share of break", "waviness", "along up", "elongation", "largest share", "effective number", "contacts", "eroded"]


# ---- images ---------------------------------------------------------------------------------------------------------

def colored_box(image):
    """Bounding box of the fragments: ground and shadow are gray."""
    pixels = np.asarray(image).astype(int)
    mask = pixels.max(axis=2) - pixels.min(axis=2) > 20
    rows, columns = np.flatnonzero(mask.sum(axis=1) > 2), np.flatnonzero(mask.sum(axis=0) > 2)
    return columns[0], rows[0], columns[-1] + 1, rows[-1] + 1


def rendered(options, path, view, explode, up, size):
    with tempfile.TemporaryDirectory(prefix="sherd-material-") as folder:
        file = pathlib.Path(folder) / "image.png"
        subprocess.run([options.sherd, "render", path, "-o", file, "--view", view, "--explode", str(explode), "--up", up,
                        "--size", f"{size}x{size}"], check=True)
        return Image.open(file).convert("RGB")


def fitted(image, width, height):
    """The fragments of an image, as large as they fit."""
    x0, y0, x1, y1 = colored_box(image)
    scale = min((width - 8) / (x1 - x0), (height - 8) / (y1 - y0))
    half = np.array([width, height]) / scale / 2
    middle = np.array([x0 + x1, y0 + y1]) / 2
    low = np.clip(middle - half, 0, None)
    return image.resize((width, height), Image.LANCZOS, box=(*low, *np.minimum(low + 2 * half, image.size)))


def azimuth_and_elevation(direction, up):
    """The view from a direction, by docs/cli.md: azimuth about the up axis, from the front."""
    right, back = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[up]
    front, side = {"y": ((0, 0, 1), (1, 0, 0)), "z": ((0, -1, 0), (1, 0, 0)), "x": ((0, 0, 1), (0, -1, 0))}[up]
    del right, back
    return (math.degrees(math.atan2(np.dot(direction, side), np.dot(direction, front))),
            math.degrees(math.asin(np.clip(direction["xyz".index(up)] / np.linalg.norm(direction), -1, 1))))


def near_view(folder, up):
    """The fragment with the largest contact, and the view onto it: 35 degrees beside its normal, and from above."""
    best = (0.0, None, None)
    for path in sorted((folder / "meshes").glob("*.ply")):
        vertices, triangles, neighbor = read_mesh(path)
        area, normal = areas_and_normals(vertices, triangles)
        for other in np.unique(neighbor[neighbor != 0]):
            on = neighbor == other
            mean = (area[on, None] * normal[on]).sum(axis=0)
            if np.linalg.norm(mean) > best[0]:
                best = (np.linalg.norm(mean), path, mean)
    azimuth, elevation = azimuth_and_elevation(best[2], up)
    return best[1], f"{(azimuth + 35) % 360:.0f},{np.clip(0.5 * elevation + 15, -60, 60):.0f}"


def picture(options, folder, solid):
    """The whole moved apart, and the largest crack near by."""
    whole = rendered(options, folder / "meshes", solid.view, solid.explode, solid.up, 3 * SIDE)
    path, view = near_view(folder, solid.up)
    near = rendered(options, path, view, 0, solid.up, 3 * SIDE)
    image = Image.new("RGB", (2 * SIDE, solid.height), "white")
    image.paste(fitted(whole, SIDE, solid.height), (0, 0))
    image.paste(fitted(near, SIDE, solid.height), (SIDE, 0))
    return image


def sheet(images, names, columns=3):
    """The images [name: image] in the order of names, numbered."""
    rows = math.ceil(len(names) / columns)
    width, height = images[names[0]].size
    out = Image.new("RGB", (columns * (width + 6), rows * (height + 6)), "white")
    draw = ImageDraw.Draw(out)
    font = ImageFont.load_default()
    for i, name in enumerate(names):
        at = ((i % columns) * (width + 6), (i // columns) * (height + 6))
        out.paste(images[name], at)
        draw.rectangle((*at, at[0] + 22, at[1] + 16), fill="white")
        draw.text((at[0] + 5, at[1] + 2), str(i + 1), fill="black", font=font)
    return out


def replace_section(path, name, text):
    """Replace what stands between the two comments of a section, which is added where there is none."""
    first, last = f"<!-- {name} -->", f"<!-- end of {name} -->"
    page = path.read_text() if path.exists() else ""
    if first not in page:
        page += ("\n" if page else "") + f"{first}\n{last}\n"
    before, rest = page.split(first)
    path.write_text(f"{before}{first}\n{text.rstrip()}\n{last}" + rest.split(last)[1])


# ---- all of it ------------------------------------------------------------------------------------------------------

def fracture(options, work, solid, material):
    pieces = MANY if material == "tempered" else FEW
    words = f"--material {material} --pieces {pieces} {solid.options} --resolution {options.resolution} {options.more}".split()
    mesh = ROOT / solid.mesh if solid.mesh.startswith("data/") else pathlib.Path(solid.mesh)
    mesh = work / mesh if solid.name == "plate" else mesh
    line = [options.sherd, "fracture", mesh, "-o", work / "pieces", *words, "--write", "mesh", "--quiet"]
    done = subprocess.run(line, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{done.stderr.strip()}\n(ran: {shlex.join(map(str, line))})")
    return work / "pieces", f"sherd fracture {pathlib.Path(solid.mesh).name if solid.name == 'statue' else solid.mesh} -o pieces {' '.join(words)}"


def table(header, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, ["---"] * len(header), *rows])


def main():
    options = arguments()
    options.sherd = str(pathlib.Path(options.sherd).resolve())
    images_folder = options.folder / "images" / "materials"
    images_folder.mkdir(parents=True, exist_ok=True)
    names = options.materials.split(",")
    figures = {name: Figures() for name in names}
    lines, keys = GALLERY.split("\n"), {}
    with tempfile.TemporaryDirectory(prefix="sherd-materials-") as folder:
        work = pathlib.Path(folder)
        points, quads = box(1, 1, 0.04)  # in triangles: exact surfaces keep polygons, which mesh_file does not read
        write_obj(work / "thin_plate.obj", (points, [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]))
        for solid in solids(options.statue):
            if solid.name not in options.only.split(","):
                continue
            images, commands = {}, []
            for name in names:
                pieces, command = fracture(options, work, solid, name)
                figures[name].add(pieces, "y")
                images[name] = picture(options, pieces, solid)
                images[name].save(images_folder / f"{solid.name}-{name}.jpg", quality=options.quality, optimize=True)
                commands.append(command)
                shutil.rmtree(pieces)
                print(f"{solid.name} {name}: done", file=sys.stderr)
            cells = [f'<img src="images/materials/{solid.name}-{name}.jpg" width="{SIDE}" alt="{solid.name}, {name}"><br>`{name}`' for name in names]
            lines += [f"### {TITLES[solid.name]}", ""]
            lines += [table(cells[:3], [cells[i:i + 3] for i in range(3, len(cells), 3)]), "", "```", *commands, "```", ""]
            if options.sheet is not None:
                order = list(names)
                random.Random(f"{options.sheet} {solid.name}").shuffle(order)
                sheet(images, order).save(options.folder / f"sheet-{solid.name}.jpg", quality=85)
                keys[solid.name] = {str(i + 1): name for i, name in enumerate(order)}
    rows = [[name, *figures[name].row()] for name in names]
    replace_section(options.folder / "gallery.md", "materials", "\n".join(lines))
    replace_section(options.folder / "materials.md", "figures", table(["material", *FIGURES], rows))
    if options.sheet is not None:
        (options.folder / "key.json").write_text(json.dumps(keys, indent=1) + "\n")
    print(table(["material", *FIGURES], rows))


if __name__ == "__main__":
    main()
