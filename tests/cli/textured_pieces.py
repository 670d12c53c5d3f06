"""The original surface of fragments in files of any format, with texture coordinates and materials, by parsers of the tests' own."""
import os
import pathlib

import numpy as np

from geo_file import Geometry
from glb_file import Glb
from ply_file import columns, read_ply
from usd_file import read_usda

NONE = (np.zeros((0, 3, 3)), np.zeros((0, 3, 2)), np.zeros(0, object))


def joined(parts):
    return tuple(map(np.concatenate, zip(NONE, *parts)))


def of_ply(test, path):
    comments, vertex, face = read_ply(path)
    names = np.array([words[2] for words in comments if words[0] == "material"])
    corners, outer = columns(vertex, *"xyz")[face["vertex_indices"]], face["neighbor"] == 0
    return corners[outer], face["texcoord"][outer].reshape(-1, 3, 2), names[face["material"][outer]]


def of_obj(test, path):
    v, vt, corners, uv, names, material = [], [], [], [], [], None
    for words in map(str.split, pathlib.Path(path).read_text().splitlines()):
        if words[:1] == ["v"]:
            v.append([float(x) for x in words[1:4]])
        elif words[:1] == ["vt"]:
            vt.append([float(x) for x in words[1:3]])
        elif words[:1] == ["usemtl"]:
            material = words[1]
        elif words[:1] == ["f"] and material != "inside":
            polygon = [[int(k) - 1 for k in corner.split("/")[:2]] for corner in words[1:]]
            for k in range(1, len(polygon) - 1):
                triangle = [polygon[0], polygon[k], polygon[k + 1]]
                corners.append([v[a] for a, _ in triangle])
                uv.append([vt[b] for _, b in triangle])
                names.append(material)
    return np.array(corners).reshape(-1, 3, 3), np.array(uv).reshape(-1, 3, 2), np.array(names, object)


def of_glb(test, path):
    found = []
    for material, triangles, attributes in Glb(test, path).primitives():
        if material["name"] != "inside":
            uv = attributes["TEXCOORD_0"][triangles] * [1, -1] + [0, 1]  # downwards in glTF
            found.append((attributes["POSITION"][triangles], uv, np.full(len(triangles), material["name"])))
    return joined(found)


def of_usd(test, path):
    found = []
    _, root = read_usda(pathlib.Path(path).read_text(encoding="utf-8"))
    for _, prim in root.walk():
        for mesh in (c for c in prim.children if c.kind == "Mesh"):
            corners = np.array(mesh.values["points"])[mesh.values["faceVertexIndices"]] + prim.values["xformOp:translate"]
            if "primvars:st" not in mesh.values:
                return NONE
            uv = np.array(mesh.values["primvars:st"])[mesh.values["primvars:st:indices"]]
            names = np.full(len(mesh.values["faceVertexCounts"]), "", object)
            for subset in mesh.children:
                names[subset.values["indices"]] = subset.name
            found.append((corners.reshape(-1, 3, 3)[names != "inside"], uv.reshape(-1, 3, 2)[names != "inside"], names[names != "inside"]))
    return joined(found)


def of_geo(test, path):
    geo = Geometry(path)
    if ("vertex", "uv") not in geo.attributes:
        return NONE
    outer = geo.groups["outside"]
    names = np.array([os.path.basename(m) for m in geo.primitive("shop_materialpath")])
    return geo.point("P")[geo.points][outer], geo.vertex("uv")[outer][:, :, :2], names[outer]


READERS = {".ply": of_ply, ".obj": of_obj, ".glb": of_glb, ".usda": of_usd, ".geo": of_geo}


def mesh_files(fragment):
    files = fragment["files"]["mesh"]
    return [files] if isinstance(files, str) else files


def formats_of(manifest):
    return {os.path.splitext(name)[1] for fragment in manifest["fragments"] for name in mesh_files(fragment)}


def surfaces(test, folder, manifest):
    """For each kind of file with texture coordinates that a fracture has: corners [m, 3, 3], coordinates [m, 3, 2], names of materials [m]."""
    paths = [name for fragment in manifest["fragments"] for name in mesh_files(fragment)]
    paths += [name for name in ("scene.usda", "pieces.geo") if name in manifest["files"]]
    found = {}
    for name in paths:
        end = os.path.splitext(name)[1]
        if end in READERS:
            found.setdefault(end, []).append(READERS[end](test, os.path.join(folder, name)))
    found = {end: joined(parts) for end, parts in found.items()}
    return {end: parts for end, parts in found.items() if len(parts[2]) > 0}
