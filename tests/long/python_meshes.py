#!/usr/bin/env python3
"""Holds every fragment of meshes against trimesh (is_watertight, volume) and manifold3d (status): programs that are not ours.

usage: python_meshes.py MESH...    (with the Python that pysherd, trimesh and manifold3d are installed for)
"""
import sys
import warnings

import manifold3d
import numpy as np

import pysherd

warnings.simplefilter("ignore")
faults, fragments = [], 0
for mesh in sys.argv[1:]:
    solid = pysherd.voxelize(mesh, resolution=128)
    for options in ({}, {"roughness": 1}, {"growth": "flood", "extra_seeds": "2n"}):
        f = pysherd.fracture(solid, pieces=max(10, solid.components), seed=1, **options)
        for fragment, other in zip(f, f.to_trimesh()):
            fragments += 1
            status = manifold3d.Manifold(manifold3d.Mesh64(fragment.vertices, fragment.faces.astype(np.uint64))).status()
            if not other.is_watertight or status != manifold3d.Error.NoError or abs(other.volume - fragment.volume) > 1e-6 * abs(fragment.volume):
                faults.append(f"{mesh} {options} fragment {fragment.id}: watertight {other.is_watertight}, {status}, {other.volume} {fragment.volume}")
print("\n".join(faults))
print(f"{fragments} fragments of {len(sys.argv) - 1} meshes, {len(faults)} faults")
sys.exit(bool(faults) or fragments == 0)
