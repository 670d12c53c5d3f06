#!/usr/bin/env python3
"""Reads scenes in USD with Pixar's OpenUSD, its validators, NVIDIA's validator and tinyusdz.

usage: usd.py PROGRAM    (with a Python that has usd-core, omniverse-asset-validator, tinyusdz and numpy)

Fails unless every validator of OpenUSD is content with the .usda, with the .usdc that pysherd makes of it and with the .usdz, NVIDIA's
default rules with the .usdc, tinyusdz opens all three, and the stage has what the manifest and the meshes have.
"""
import json
import logging
import pathlib
import subprocess
import struct
import sys
import tempfile
import types
import zlib

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
logging.disable(logging.WARNING)

import omni.asset_validator as nvidia
import tinyusdz
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade, UsdValidation

# pysherd without its compiled part, which this module of it does not need.
sys.modules["pysherd"] = types.ModuleType("pysherd")
sys.modules["pysherd"].__path__ = [str(ROOT / "python" / "pysherd")]
from pysherd import usd


def drum(segments=40, rings=10):
    """A drum about y with two materials, texture coordinates on its side, and colors, as OBJ."""
    angle = 2 * np.pi * np.arange(segments) / segments
    lines = ["mtllib drum.mtl"]
    at = [(np.cos(a), y, np.sin(a)) for y in np.linspace(-1, 1, rings + 1) for a in angle] + [(0, -1, 0), (0, 1, 0)]
    lines += ["v " + " ".join(f"{x:.9g}" for x in (*p, *(0.5 + 0.3 * np.array(p)))) for p in at]
    lines += [f"vt {i / segments:.9g} {j / rings:.9g}" for j in range(rings + 1) for i in range(segments + 1)]
    lines.append("usemtl side")
    for j in range(rings):
        for i in range(segments):
            corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
            lines.append("f " + " ".join(f"{b * segments + a % segments + 1}/{b * (segments + 1) + a + 1}" for a, b in corners))
    lines.append("usemtl cap")
    for i in range(segments):
        a, b = i + 1, (i + 1) % segments + 1
        lines += [f"f {len(at) - 1} {a} {b}", f"f {len(at)} {b + rings * segments} {a + rings * segments}"]
    return "\n".join(lines) + "\n"


def fracture(program, mesh, out, *options):
    subprocess.run([program, "fracture", mesh, "-o", out, "--quiet", "--write", "usd,mesh,vdb", "--usd-format", "usda,usdz", "--usd-volumes",
                    "--resolution", "48", "--density", "2.5", "--joint-strength", "3", *options], check=True)
    return json.loads((out / "manifest.json").read_text())


def validate(path):
    """Every validator of OpenUSD, then those of NVIDIA on .usdc, and tinyusdz."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 25, len(validators)
    errors = [f"{e.GetValidator().GetMetadata().name}: {e.GetMessage()}" for e in UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(str(path)))]
    assert not errors, (path, errors[:5])
    if path.suffix == ".usdc":
        issues = list(nvidia.ValidationEngine().validate(str(path)).issues())
        assert not issues, (path, [(str(i.severity), i.rule and i.rule.__name__, i.message, str(i.at)) for i in issues[:5]])
    assert tinyusdz.load(str(path)) is not None
    return len(validators)


def pieces_of(stage):
    return {p.GetName(): p for p in stage.Traverse() if p.HasAPI(UsdPhysics.RigidBodyAPI)}


def world(prim):
    return np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))


def ply_of(path):
    """Vertices and triangles of a .ply as Sherd writes it."""
    head, body = path.read_bytes().split(b"end_header\n", 1)
    kind = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}
    elements = []
    for words in map(str.split, head.decode().splitlines()):
        if words[0] == "element":
            elements.append((int(words[2]), []))
        elif words[0] == "property" and words[1] == "list":
            elements[-1][1].extend([("n" + words[4], kind[words[2]]), (words[4], kind[words[3]], 3 if words[4] == "vertex_indices" else 6)])
        elif words[0] == "property":
            elements[-1][1].append((words[2], kind[words[1]]))
    vertex = np.frombuffer(body, elements[0][1], elements[0][0])
    face = np.frombuffer(body, elements[1][1], elements[1][0], vertex.nbytes)
    return np.stack([vertex[k] for k in "xyz"], -1).astype(float), face["vertex_indices"], face["neighbor"]


def check(folder, path, manifest):
    stage = Usd.Stage.Open(str(path))
    root = stage.GetDefaultPrim()
    assert root and UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1
    pieces = pieces_of(stage)
    assert len(pieces) == len(manifest["fragments"])
    for fragment in manifest["fragments"]:
        prim = next(p for name, p in pieces.items() if int(name.rsplit("_", 1)[1]) == fragment["id"])
        mass = UsdPhysics.MassAPI(prim)
        assert np.isclose(mass.GetMassAttr().Get(), 2.5 * fragment["volume"], rtol=1e-6)
        turn = np.array(Gf.Matrix3d(Gf.Quatd(mass.GetPrincipalAxesAttr().Get()))).T  # OpenUSD multiplies rows
        xx, yy, zz, xy, xz, yz = fragment["inertia"]
        inertia = 2.5 * np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        assert np.allclose(turn @ np.diag(mass.GetDiagonalInertiaAttr().Get()) @ turn.T, inertia, atol=2e-6 * np.trace(inertia))
        own = prim.GetChild(prim.GetName())
        mesh = UsdGeom.Mesh(own)
        vertices, triangles, neighbor = ply_of(folder / fragment["files"]["mesh"])
        at = np.c_[np.array(mesh.GetPointsAttr().Get(), float), np.ones(len(vertices))] @ world(own)
        assert np.allclose(at[:, :3], vertices, rtol=0, atol=2 * np.spacing(np.float32(abs(vertices).max())))
        assert (np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3) == triangles).all()
        primvars = UsdGeom.PrimvarsAPI(own)
        assert (np.array(primvars.GetPrimvar("neighbor").Get()) == neighbor).all()
        for primvar in primvars.GetPrimvarsWithValues():
            expected = len(triangles) if primvar.GetInterpolation() == "uniform" else 3 * len(triangles)
            assert len(primvar.ComputeFlattened()) == expected, primvar.GetName()
        subsets = UsdShade.MaterialBindingAPI(own).GetMaterialBindSubsets()
        assert sorted(i for s in subsets for i in s.GetIndicesAttr().Get()) == list(range(len(triangles)))
        for subset in subsets:
            material = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()[0]
            surface = material.ComputeSurfaceSource()[0]
            assert surface and surface.GetIdAttr().Get() == "UsdPreviewSurface"
            if subset.GetPrim().GetName() == "inside":
                assert set(subset.GetIndicesAttr().Get()) == set(np.flatnonzero(neighbor))
        levels, split = [], fragment.get("split", 0)
        while split:
            levels.insert(0, f"split{split}")
            split = manifest["splits"][split - 1]["parent"]
        assert str(prim.GetPath()).split("/")[3:-1] == levels, prim.GetPath()
    joints = [UsdPhysics.Joint(p) for p in stage.Traverse() if p.IsA(UsdPhysics.FixedJoint)]
    areas = {(f["id"], c["id"]): c["area"] for f in manifest["fragments"] for c in f["contacts"]}
    kept = {f["id"] for f in manifest["fragments"]}
    assert 2 * len(joints) == sum(b in kept for _, b in areas)
    for joint in joints:
        bodies = [stage.GetPrimAtPath(r.GetTargets()[0]) for r in (joint.GetBody0Rel(), joint.GetBody1Rel())]
        ends = [np.append(p.Get(), 1.0) @ world(b) for p, b in zip((joint.GetLocalPos0Attr(), joint.GetLocalPos1Attr()), bodies)]
        assert np.allclose(*ends, atol=1e-5), ends
        pair = tuple(int(b.GetName().rsplit("_", 1)[1]) for b in bodies)
        assert np.isclose(joint.GetBreakForceAttr().Get(), 3 * areas[pair], rtol=1e-6)
    whole = {name: world(p)[3, :3] for name, p in pieces.items()}
    root.GetVariantSet("preview").SetVariantSelection("exploded")
    apart = {name: world(p)[3, :3] for name, p in pieces_of(stage).items()}
    assert set(apart) == set(whole)
    middle = np.average([f["centroid"] for f in manifest["fragments"]], axis=0, weights=[f["volume"] for f in manifest["fragments"]])
    assert all(np.allclose(apart[n] - middle, 1.5 * (whole[n] - middle)) for n in whole)
    assert not any(p.IsA(UsdPhysics.FixedJoint) for p in stage.Traverse())


def main(program, folder):
    drum_file = folder / "drum.obj"
    drum_file.write_text(drum())
    (folder / "drum.mtl").write_text("newmtl side\nKd 0.5 1 1\nmap_Kd wood@1.png\nnewmtl cap\nKd 0.25 0.5 1\n")
    (folder / "wood@1.png").write_bytes(png(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)))
    amphora = ROOT / "data" / "amphora.ply"
    two = folder / "two.obj"
    two.write_text("".join(f"v {x + 3 * k} {y} {z}\n" for k in (0, 1) for x in (0, 1) for y in (0, 1) for z in (0, 1)) +
                   "".join(f"f {' '.join(str(8 * k + i + 1) for i in q)}\n" for k in (0, 1)
                           for q in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))))
    cases = {"levels": (amphora, "--growth", "sequential", "--pieces", "12"), "drum": (drum_file, "--pieces", "5"),
             "withheld": (amphora, "--pieces", "10", "--missing", "0.3"), "two": (two, "--growth", "sequential", "--pieces", "5"),
             "one": (amphora, "--pieces", "1")}
    for name, (mesh, *options) in cases.items():
        out = folder / name
        manifest = fracture(program, mesh, out, *options)
        text = out / "scene.usda"
        crate = out / "scene.usdc"
        assert usd.write_usdc(text) == crate
        for path in (text, crate, out / "scene.usdz"):
            count = validate(path)
            check(out, path, manifest)
        print(f"{name}: {len(manifest['fragments'])} pieces, {count} validators, "
              + ", ".join(f"{p.suffix} {p.stat().st_size} bytes" for p in (text, crate, out / "scene.usdz")))


def png(pixels):
    """A PNG of bytes [h, w, 3]."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    h, w, _ = pixels.shape
    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", w, h, 8, 2, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="sherd-usd-") as made:
        main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(made))
