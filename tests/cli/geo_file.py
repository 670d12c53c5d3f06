"""Reads Houdini's geometry, `.geo` in JSON, by the layout of files that Houdini 21 saves and of SideFX's hgeo.py, not by Sherd."""
import json

import numpy as np

STORAGE = {"fpreal32": np.float32, "fpreal64": np.float64, "int32": np.int32, "int64": np.int64}
OWNERS = {"vertexattributes": "vertexcount", "pointattributes": "pointcount", "primitiveattributes": "primitivecount"}


def pairs(items):
    """The members of a list of keys and values, in turn."""
    assert len(items) % 2 == 0 and len(set(items[::2])) == len(items) // 2, items[:8]
    return dict(zip(items[::2], items[1::2], strict=True))


def refuse(text):
    raise ValueError(text)


def numbers(block, count):
    """[count] or [count, size] values of an attribute."""
    values = pairs(block)
    size = values["size"]
    if size == 1:
        assert set(values) == {"size", "storage", "arrays"} and len(values["arrays"]) == 1, list(values)
        read = values["arrays"][0]
    else:
        assert set(values) == {"size", "storage", "tuples"}, list(values)
        read = values["tuples"]
    found = np.array(read, STORAGE[values["storage"]])
    expected = (count,) if size == 1 else (count, size)
    assert found.shape == expected or (count == 0 and found.size == 0), (found.shape, expected)
    return found.reshape(expected)


class Geometry:
    """A detail: `points` of each primitive's vertices, `closed` primitives, attributes and groups by their names."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.file = pairs(json.load(file, parse_constant=refuse))
        assert list(self.file)[0] == "fileversion" and self.file["hasindex"] is False
        counts = {key: self.file[key] for key in ("pointcount", "vertexcount", "primitivecount")}
        self.point_count, self.vertex_count, self.primitive_count = counts.values()
        of_vertex = np.array(pairs(pairs(self.file["topology"])["pointref"])["indices"], np.int64)
        assert len(of_vertex) == self.vertex_count
        assert self.vertex_count == 0 or 0 <= of_vertex.min() <= of_vertex.max() < self.point_count
        self.attributes, self.meanings = {}, {}
        for owner, entries in pairs(self.file["attributes"]).items():
            for definition, data in entries:
                definition = pairs(definition)
                assert definition["scope"] == "public"
                name = (owner[:-len("attributes")], definition["name"])
                assert name not in self.attributes
                self.attributes[name] = self._attribute(definition["type"], pairs(data), counts[OWNERS[owner]])
                self.meanings[name] = definition["options"].get("type", {}).get("value")
        self._primitives(of_vertex)
        self.groups = {}
        for definition, selection in self.file.get("primitivegroups", []):
            members = pairs(pairs(pairs(selection)["selection"])["unordered"])["i8"]
            assert len(members) == self.primitive_count and set(members) <= {0, 1}
            self.groups[pairs(definition)["name"]] = np.array(members, bool)

    def _attribute(self, kind, data, count):
        if kind == "numeric":
            values = pairs(data["values"])
            assert (data["size"], data["storage"]) == (values["size"], values["storage"])
            assert len(pairs(data["defaults"])["values"]) == 1
            return numbers(data["values"], count)
        assert kind == "string" and (data["size"], data["storage"]) == (1, "int32")
        indices = numbers(data["indices"], count)
        assert len(set(data["strings"])) == len(data["strings"])
        return np.array(data["strings"], object)[indices] if count else np.array([], object)

    def _primitives(self, of_vertex):
        runs, self.closed, found = self.file["primitives"], None, 0
        self.points = np.zeros((0, 2), np.int64)
        for definition, data in runs:
            kind, data = pairs(definition)["type"], pairs(data)
            assert data["startvertex"] == 0 and len(runs) == 1
            size, found = data["nvertices_rle"]
            assert found == data["nprimitives"]
            self.closed = {"Polygon_run": True, "PolygonCurve_run": False}[kind]
            self.points = of_vertex.reshape(found, size)
        assert found == self.primitive_count and self.points.size == self.vertex_count

    def point(self, name):
        return self.attributes["point", name]

    def vertex(self, name):
        """[primitives, vertices, ...]"""
        values = self.attributes["vertex", name]
        return values.reshape(*self.points.shape, *values.shape[1:])

    def primitive(self, name):
        return self.attributes["primitive", name]
