"""A reader of binary glTF of our own, which checks the rules of the specification that concern what Sherd writes."""
import json
import struct

import numpy as np

PHYSICS, MANIFOLD = "KHR_physics_rigid_bodies", "EXT_mesh_manifold"
KINDS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    def __init__(self, test, path):
        with open(path, "rb") as file:
            data = file.read()
        magic, version, length, json_length, json_type = struct.unpack("<4s4I", data[:20])
        test.assertEqual((magic, version, length, json_type), (b"glTF", 2, len(data), 0x4E4F534A))
        test.assertEqual(json_length % 4, 0)
        self.json = json.loads(data[20:20 + json_length])
        at = 20 + json_length
        bin_length, bin_type = struct.unpack("<2I", data[at:at + 8])
        test.assertEqual((bin_type, bin_length % 4, at + 8 + bin_length), (0x004E4942, 0, len(data)))
        self.buffer = data[at + 8:]
        self.check(test)

    def view(self, i):
        view = self.json["bufferViews"][i]
        return self.buffer[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]

    def dense(self, view, offset, kind, count, width):
        """[count, width] of a view, whose elements may lie apart."""
        stride = self.json["bufferViews"][view].get("byteStride", np.dtype(kind).itemsize * width)
        data = self.view(view)[offset:]
        return np.ndarray((count, width), kind, data, strides=(stride, np.dtype(kind).itemsize)).copy()

    def array(self, i):
        a = self.json["accessors"][i]
        kind, width = KINDS[a["componentType"]], WIDTHS[a["type"]]
        values = self.dense(a["bufferView"], a.get("byteOffset", 0), kind, a["count"], width)
        if "sparse" in a:
            s = a["sparse"]
            places = self.dense(s["indices"]["bufferView"], 0, KINDS[s["indices"]["componentType"]], s["count"], 1)[:, 0]
            values[places] = self.dense(s["values"]["bufferView"], 0, kind, s["count"], width)
        return values

    def primitives(self, mesh=0):
        """Material, triangles, and attributes of the vertices that a primitive uses."""
        for p in self.json["meshes"][mesh]["primitives"]:
            used, triangles = np.unique(self.array(p["indices"])[:, 0], return_inverse=True)
            yield (self.json["materials"][p["material"]], triangles.reshape(-1, 3),
                   {name: self.array(i)[used] for name, i in p["attributes"].items()})

    def whole(self, mesh=0):
        """Positions and all triangles of a mesh, as they are and, if it is declared manifold, with vertices merged."""
        of = self.json["meshes"][mesh]
        positions = self.array(of["primitives"][0]["attributes"]["POSITION"])
        triangles = np.concatenate([self.array(p["indices"])[:, 0] for p in of["primitives"]]).reshape(-1, 3)
        extension = of.get("extensions", {}).get(MANIFOLD)
        merged = extension and self.array(extension["manifoldPrimitive"]["indices"])[:, 0].reshape(-1, 3)
        return positions, triangles, merged

    def check(self, test):
        doc = self.json
        test.assertEqual(doc["asset"]["version"], "2.0")
        test.assertEqual([b["byteLength"] for b in doc["buffers"]], [len(self.buffer)])
        end = 0
        for view in doc["bufferViews"]:
            test.assertEqual((view["buffer"], view["byteOffset"] % 4, view.get("byteStride", 4)), (0, 0, 4))
            test.assertGreater(view["byteLength"], 0)
            test.assertGreaterEqual(view["byteOffset"], end, "views overlap")
            end = view["byteOffset"] + view["byteLength"]
            test.assertLessEqual(end, len(self.buffer))
        for i, a in enumerate(doc["accessors"]):
            test.assertLessEqual(set(a), {"bufferView", "byteOffset", "componentType", "count", "type", "min", "max", "normalized", "sparse"})
            size = np.dtype(KINDS[a["componentType"]]).itemsize
            test.assertEqual(a.get("byteOffset", 0) % size, 0)
            test.assertGreater(a["count"], 0)
            test.assertEqual(len(self.array(i)), a["count"])
        for mesh in range(len(doc["meshes"])):
            self.check_mesh(test, mesh)
        for texture in doc.get("textures", []):
            test.assertEqual(doc["bufferViews"][doc["images"][texture["source"]]["bufferView"]].get("target"), None)
            test.assertLess(texture.get("sampler", -1), len(doc.get("samplers", [])))
        self.check_nodes(test)
        used = set()
        self.collect_extensions(doc, used)
        test.assertEqual(doc.get("extensionsUsed", []), sorted(used))

    def collect_extensions(self, value, used):
        if isinstance(value, dict):
            used |= set(value.get("extensions", {}))
            for key, of in value.items():
                if key != "extras":
                    self.collect_extensions(of, used)
        elif isinstance(value, list):
            for of in value:
                self.collect_extensions(of, used)

    def check_mesh(self, test, mesh):
        doc = self.json
        primitives = doc["meshes"][mesh]["primitives"]
        attributes = primitives[0]["attributes"]
        views = {doc["accessors"][p["indices"]]["bufferView"] for p in primitives}
        test.assertEqual(len(views), 1, "one list of indices")
        test.assertEqual(doc["bufferViews"][views.pop()]["target"], 34963)
        for p in primitives:
            test.assertEqual((p.get("mode", 4), p["attributes"]), (4, attributes), "one set of vertices")
        counts = {doc["accessors"][i]["count"] for i in attributes.values()}
        test.assertEqual(len(counts), 1)
        for name, i in attributes.items():
            a = doc["accessors"][i]
            view = doc["bufferViews"][a["bufferView"]]
            test.assertEqual(view["target"], 34962)
            wide = np.dtype(KINDS[a["componentType"]]).itemsize * WIDTHS[a["type"]]
            test.assertEqual(view.get("byteStride", wide) % 4, 0, name)
            test.assertTrue(name.startswith("_") or name in ("POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0"), name)
            test.assertNotEqual(a["componentType"], 5125, "32-bit integers are for indices only")
        positions, triangles, merged = self.whole(mesh)
        test.assertEqual(len(positions), counts.pop())
        test.assertEqual(set(triangles.ravel()), set(range(len(positions))), "every vertex is used")
        place = doc["accessors"][attributes["POSITION"]]
        test.assertEqual((place["componentType"], place["type"]), (5126, "VEC3"))
        test.assertEqual((place["min"], place["max"]), (positions.min(axis=0).tolist(), positions.max(axis=0).tolist()))
        if "NORMAL" in attributes:
            normals = self.array(attributes["NORMAL"]).astype(float)
            test.assertLess(abs(np.linalg.norm(normals, axis=1) - 1).max(), 1e-6)
        if "COLOR_0" in attributes:
            color = doc["accessors"][attributes["COLOR_0"]]
            test.assertEqual((color["componentType"], color["normalized"], color["type"]), (5123, True, "VEC4"))
        if merged is not None:
            self.check_manifold(test, mesh, positions, triangles, merged)

    def check_manifold(self, test, mesh, positions, triangles, merged):
        """The rules of EXT_mesh_manifold."""
        extension = self.json["meshes"][mesh]["extensions"][MANIFOLD]
        primitive = extension["manifoldPrimitive"]
        own = self.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"]
        test.assertEqual((primitive["attributes"], "material" in primitive), ({"POSITION": own}, False))
        np.testing.assert_array_equal(positions[merged], positions[triangles], "merging moves no corner")
        edges = np.concatenate([merged[:, [0, 1]], merged[:, [1, 2]], merged[:, [2, 0]]]).astype(np.int64)
        forward = edges[:, 0] << 32 | edges[:, 1]
        test.assertEqual(len(set(forward)), len(forward), "no half-edge twice")
        test.assertEqual(set(forward), set(edges[:, 1] << 32 | edges[:, 0]), "every half-edge has its opposite")
        changed = np.flatnonzero(merged.ravel() != triangles.ravel())
        if "mergeIndices" in extension:
            np.testing.assert_array_equal(self.array(extension["mergeIndices"])[:, 0], changed)
            np.testing.assert_array_equal(self.array(extension["mergeValues"])[:, 0], merged.ravel()[changed])
        else:
            test.assertEqual(len(changed), 0)

    def check_nodes(self, test):
        nodes = self.json["nodes"]
        parents = self.parents()
        coarse = {i for n in nodes for i in n.get("extensions", {}).get("MSFT_lod", {}).get("ids", [])}
        test.assertFalse(coarse & set(parents), "a level of detail is shown beside another")
        roots = [i for i in range(len(nodes)) if i not in parents and i not in coarse]
        test.assertEqual(sorted(self.json["scenes"][self.json["scene"]]["nodes"]), roots)
        test.assertEqual(sum(len(n.get("children", [])) for n in nodes), len(parents), "one parent at most")
        for node in nodes:
            test.assertNotEqual(node.get("children"), [])
        for i in range(len(nodes)):
            self.world(i)  # ends, so there is no cycle

    def parents(self):
        return {child: i for i, node in enumerate(self.json["nodes"]) for child in node.get("children", [])}

    def path(self, i):
        """A node and those above it."""
        parents, path = self.parents(), [i]
        while path[-1] in parents:
            path.append(parents[path[-1]])
            assert len(path) <= len(self.json["nodes"])
        return path

    def world(self, i):
        """The position of a node: Sherd writes translations only."""
        return sum((np.array(self.json["nodes"][k].get("translation", [0, 0, 0])) for k in self.path(i)), np.zeros(3))

    def physics(self, i):
        return self.json["nodes"][i].get("extensions", {}).get(PHYSICS, {})


def volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]].astype(float) for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def write_glb(path, document, buffer=b""):
    buffer += b"\0" * (-len(buffer) % 4)
    document["buffers"] = [{"byteLength": len(buffer)}]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4s2I", b"glTF", 2, 28 + len(text) + len(buffer)) + struct.pack("<I4s", len(text), b"JSON") + text +
                   struct.pack("<I4s", len(buffer), b"BIN\0") + buffer)
    return path
