"""Reads the viewer's page by docs/viewer.md, and not by its own program."""
import base64
import hashlib
import html.parser
import json

import numpy as np


class Elements(html.parser.HTMLParser):
    """The elements of a page: name, attributes, text directly in them; a script's or style's text is raw, as browsers have it."""

    def __init__(self, text):
        super().__init__()
        self.all, self.open = [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.all.append([tag, dict(attributes), ""])
        if tag not in ("meta", "input", "link", "br", "img", "circle", "path"):
            self.open.append(self.all[-1])

    def handle_startendtag(self, tag, attributes):
        self.all.append([tag, dict(attributes), ""])

    def handle_endtag(self, tag):
        while self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, data):
        if self.open:
            self.open[-1][2] += data

    def of(self, tag, **attributes):
        attributes = {k.rstrip("_"): v for k, v in attributes.items()}
        return [e for e in self.all if e[0] == tag and all(e[1].get(k) == v for k, v in attributes.items())]


def checksum(text):
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"


class Mesh:
    """A piece: world positions [n, 3], unit normals, triangles, their neighbors and materials, lines."""


class Page:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()
        self.text = self.bytes.decode()
        self.elements = Elements(self.text)
        self.scene = json.loads(self.elements.of("script", class_="scene")[0][2])
        self.textures = [base64.b64decode(e[2], validate=True) for e in self.elements.of("script", class_="texture")]
        chunks = [base64.b64decode(e[2], validate=True) for e in self.elements.of("script", class_="meshes")]
        data = b"".join(chunks)
        assert len(data) == self.scene["bytes"], (len(data), self.scene["bytes"])
        self.pieces, at = {}, 0
        for piece in self.scene["pieces"]:
            self.pieces[piece["id"]], at = self.mesh(piece, data, at)
        assert at == len(data), (at, len(data))

    def mesh(self, piece, data, at):
        scene, mesh = self.scene, Mesh()

        def take(kind, *shape):
            nonlocal at
            array = np.frombuffer(data, kind, int(np.prod(shape)), at).reshape(shape)
            at += array.nbytes
            return array

        n = piece["vertices"]
        mesh.grid = take("<u2", n, 3)
        mesh.positions = np.array(scene["origin"]) + scene["step"] * mesh.grid
        square = take("<i2", n, 2) / 32767.0
        normal = np.column_stack([square, 1 - np.abs(square).sum(1)])
        below = normal[:, 2] < 0
        normal[below, :2] = (1 - np.abs(square[below, ::-1])) * np.where(square[below] >= 0, 1, -1)
        mesh.normals = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        if "texcoords" in scene:
            mesh.texcoords = np.array(scene["texcoords"]["origin"]) + np.array(scene["texcoords"]["step"]) * take("<u2", n, 2)
        if scene["colors"]:
            mesh.colors = take("u1", n, 3)
        index = "<u4" if n > 65536 else "<u2"
        runs = np.array(piece["runs"], int).reshape(-1, 3)
        assert runs[:, 2].sum() == piece["faces"]
        mesh.triangles = take(index, piece["faces"], 3).astype(int)
        mesh.neighbor, mesh.material = np.repeat(runs[:, 0], runs[:, 2]), np.repeat(runs[:, 1], runs[:, 2])
        mesh.lines = take(index, piece["lines"], 2).astype(int)
        return mesh, at


def open_edges(mesh):
    """Edges that are not used equally often in both directions, once corners at one position of the grid are one vertex."""
    _, vertex = np.unique(mesh.grid, axis=0, return_inverse=True)
    t = vertex.reshape(-1)[mesh.triangles]
    assert (t[:, 0] != t[:, 1]).all() and (t[:, 1] != t[:, 2]).all() and (t[:, 2] != t[:, 0]).all()
    edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    sign = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    pairs, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    return int((np.bincount(which.reshape(-1), sign, len(pairs)) != 0).sum())
