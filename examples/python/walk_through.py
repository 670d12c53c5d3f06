"""A tour of pysherd: a vessel is broken, measured, sampled, rendered and saved.

usage: walk_through.py MESH FOLDER
"""

import pathlib
import sys

import numpy as np

import pysherd


def main(mesh: str, folder: str) -> None:
    out = pathlib.Path(folder)
    out.mkdir(parents=True, exist_ok=True)

    # Voxels, prepared once for any number of fractures.
    solid = pysherd.voxelize(mesh, resolution=96)
    print(f"{solid.name}: {solid.voxels} voxels of {solid.voxel_size:.4g}, box {solid.shape}")

    # Keywords are the options of the program; help(pysherd.fracture) lists them.
    f = pysherd.fracture(solid, pieces=8, seed=1, roughness=1.0)
    for fragment in f:
        print(f"fragment {fragment.id}: {len(fragment.faces)} faces, volume {fragment.volume:.4g}, {fragment.fracture_area / fragment.area:.0%} cracks")

    # Which fragments touch, and the largest contact.
    largest = int(np.argmax(f.contacts.area))
    a, b = f.contacts.fragments[largest]
    print(f"{len(f.contacts.area)} contacts; the largest, {f.contacts.area[largest]:.3g}, is between {a} and {b}")

    # Points for a network: no meshes are made for them.
    points = f.points(1024)
    on_cracks = np.mean(points.neighbor > 0)
    print(f"{len(points.positions)} points, {on_cracks:.0%} on cracks")

    # Labels of voxels: the share of each fragment.
    shares = np.bincount(f.labels[f.labels > 0], minlength=len(f) + 1)[1:] / solid.voxels
    print("shares of the voxels:", np.round(shares, 3))

    # An image, and the folder that the program writes.
    f.render(out / "exploded.png", explode=0.3, size=(640, 480))
    f.save(out / "pieces")
    assert np.array_equal(pysherd.load(out / "pieces").labels, f.labels)

    # Many fractures of one object grow together.
    count = sum(len(g) for g in solid.fractures(pieces=range(2, 6), seeds=range(5), extra_seeds="2n"))
    print(f"{count} fragments of 20 fractures")


if __name__ == "__main__":
    main(*sys.argv[1:])
