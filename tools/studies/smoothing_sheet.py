#!/usr/bin/python3
"""Make the paper's Figure 10: a fracture of voxel faces with increasing smoothing, by iterations and by weight.

usage: smoothing_sheet.py SHERD MESH OUT.png

Above the iterations go from 0.01 to 0.08 of the voxels along the longest side, below the weight from 0.1 to 0.6.  Needs Debian's
python3-pil.
"""
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw

SIDE = 320
ROWS = [[("iterations", f"{share:g}k", share, 0.6) for share in (0.01, 0.03, 0.05, 0.08)],
        [("weight", f"{weight:g}", 0.048, weight) for weight in (0.1, 0.25, 0.4, 0.6)]]


def main():
    sherd, mesh, out = sys.argv[1:]
    sheet = Image.new("RGB", (4 * SIDE, 2 * (SIDE + 20)), "white")
    draw = ImageDraw.Draw(sheet)
    with tempfile.TemporaryDirectory() as folder:
        for y, row in enumerate(ROWS):
            for x, (name, value, share, weight) in enumerate(row):
                pieces, image = pathlib.Path(folder, f"{y}{x}"), f"{folder}/image.png"
                subprocess.run([sherd, "fracture", mesh, "-o", pieces, "--pieces", "4", "--resolution", "64", "--surface", "labels",
                                "--smoothing", "laplacian", "--smooth-iterations", f"{share}k", "--smooth-weight", str(weight),
                                "--smooth-boundary-iterations", f"{share}k", "--smooth-boundary-weight", str(weight / 4),
                                "--write", "mesh", "--quiet"], check=True)
                subprocess.run([sherd, "render", pieces, "-o", image, "--size", f"{SIDE}x{SIDE}"], check=True)
                sheet.paste(Image.open(image), (x * SIDE, y * (SIDE + 20)))
                draw.text((x * SIDE + 6, y * (SIDE + 20) + SIDE + 3), f"{name} {value}", "black")
    sheet.save(out)


if __name__ == "__main__":
    main()
