"""Datasets as Parquet, one row a fracture, which the package `datasets`, pandas and others read.

>>> import pysherd.parquet
>>> pysherd.parquet.write_parquet("pieces", "pieces_parquet")  # of sherd dataset vessels -o pieces --points 1000 --point-format npz

``python -m pysherd.parquet DATASET FOLDER`` does the same.  pyarrow is not among the requirements of pysherd: install it beside.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import pathlib
import sys
import zipfile
from typing import Any, Iterator

import numpy as np

from ._errors import Error, FileError, OutputError
from ._values import path_text

__all__ = ["write_parquet"]

_SPLITS = ("train", "val", "test")
_ROWS = 64  # of a row group, at most
_POINTS = 1 << 20  # as many end a row group, which is held in memory
_OF_POINTS = ("positions", "normals", "neighbor", "fragment")
_POSE = {"rotation": 4, "center": 3, "truth_rotation": 4, "truth_translation": 3}
_DAMAGES = (KeyError, TypeError, ValueError, OverflowError, AttributeError)


def write_parquet(dataset: str | os.PathLike[str], folder: str | os.PathLike[str]) -> list[pathlib.Path]:
    """Writes ``train.parquet``, ``val.parquet`` and ``test.parquet``, those that have fractures, and returns their paths.

    A row has ``object``, ``fracture``, ``split``, ``pieces``, ``repeat``, ``seed``, and ``options``, the drawn ones as JSON; ``source``, ``sha256`` and
    ``license`` of the mesh, null where they are not known.  Of its fragments ``id``, ``share``, ``volume``, of an assemblage ``mesh``, and with ``--poses``
    ``rotation``, ``center``, ``truth_rotation``, ``truth_translation`` as the index has them; ``contacts`` are two ids and an area each.  Of all their points
    ``positions`` and ``normals``, three float32 each, ``neighbor``, and ``fragment``, the id of the fragment.  The options of the dataset are JSON in the
    schema's metadata under ``sherd``.

    Parameters
    ----------
    dataset : path
        The folder of a finished ``sherd dataset`` or ``sherd assemblage`` with points: ``--points N --point-format npz``, in the layout ``sherd`` or ``bb``.
    folder : path
        For the files; it is made.  Once all are complete, they replace files of these names, and one of a split without fractures is removed.

    Raises
    ------
    ImportError
        pyarrow is not installed.
    FileError
        The folder is no such dataset, or a file of it differs from its checksum.
    OutputError
        A file cannot be written.
    """
    try:
        import pyarrow
        import pyarrow.parquet  # noqa: F401: whether it is there
    except ModuleNotFoundError as missing:
        if missing.name is None or missing.name.split(".")[0] != "pyarrow":
            raise
        raise ImportError("pysherd.parquet.write_parquet needs pyarrow, which is not installed: pip install pyarrow") from None
    source, target = (pathlib.Path(path_text(name, value, FileError)) for name, value in (("dataset", dataset), ("folder", folder)))
    plan, meshes = _plan(source), _meshes(source)
    schema = _schema(pyarrow).with_metadata({"sherd": json.dumps(plan)})
    rows = _rows(source, meshes)
    try:
        target.mkdir(parents=True, exist_ok=True)
        written = _write(rows, schema, target, source)
    except Error:  # some are OSErrors
        raise
    except OSError as failed:
        raise OutputError(f"{target}: cannot be written: {failed.strerror or failed}") from None
    if not written:
        raise FileError(f"{source}: has no fractures")
    return [target / f"{split}.parquet" for split in _SPLITS if split in written]


def _write(rows: Iterator[dict[str, Any]], schema: Any, target: pathlib.Path, source: pathlib.Path) -> set[str]:
    """Writes rows to files by split, which take the places of earlier ones when all are complete, and returns the splits."""
    import pyarrow
    import pyarrow.parquet

    writers: dict[str, Any] = {}
    pending: dict[str, list[dict[str, Any]]] = {}
    points: dict[str, int] = {}

    def flush(split: str) -> None:
        if split not in writers:
            writers[split] = pyarrow.parquet.ParquetWriter(target / f".{split}.parquet.partial", schema, compression="zstd")
        try:
            points.pop(split)
            table = _table(pyarrow, pending.pop(split), schema)
        except (pyarrow.ArrowException, *_DAMAGES) as damage:
            raise FileError(f"{source / 'index.jsonl'}: has values of other kinds: {damage}") from None
        writers[split].write_table(table)

    try:
        for row in rows:
            split = row["split"]
            pending.setdefault(split, []).append(row)
            points[split] = points.get(split, 0) + sum(len(part) for part in row["fragment"])
            if len(pending[split]) == _ROWS or points[split] >= _POINTS:
                flush(split)
        for split in list(pending):
            flush(split)
        for writer in writers.values():
            writer.close()
        for split in writers:
            os.replace(target / f".{split}.parquet.partial", target / f"{split}.parquet")
        if writers:
            for split in set(_SPLITS) - set(writers):  # of an earlier run
                (target / f"{split}.parquet").unlink(missing_ok=True)
    finally:
        for split, writer in writers.items():
            writer.close()
            (target / f".{split}.parquet.partial").unlink(missing_ok=True)
    return set(writers)


def _table(pa: Any, rows: list[dict[str, Any]], schema: Any) -> Any:
    """The rows as a table.  Columns of points are lists of arrays, joined without an object for each point."""
    rest = pa.Table.from_pylist(rows, pa.schema([field for field in schema if field.name not in _OF_POINTS]))
    columns = []
    for field in schema:
        if field.name not in _OF_POINTS:
            columns.append(rest.column(field.name))
            continue
        offsets = np.cumsum([0, *(sum(len(part) for part in row[field.name]) for row in rows)], dtype=np.int64)
        kind = np.dtype(np.float32 if field.name in _OF_POINTS[:2] else np.int32)
        flat = np.concatenate([np.empty(0, kind), *(part.reshape(-1) for row in rows for part in row[field.name])], dtype=kind)
        values = pa.array(flat) if kind == np.int32 else pa.FixedSizeListArray.from_arrays(pa.array(flat), 3)
        columns.append(pa.ListArray.from_arrays(pa.array(offsets, pa.int32()), values))
    return pa.Table.from_arrays(columns, schema=schema)


def _schema(pa: Any) -> Any:
    def vectors(kind: Any, size: int) -> Any:
        return pa.list_(pa.list_(kind, size))

    texts, counts = (("object", "fracture", "split"), pa.string()), (("pieces", "repeat"), pa.int32())
    known = [(name, kind) for names, kind in (texts, counts) for name in names]
    return pa.schema([
        *known, ("seed", pa.uint64()), ("options", pa.string()), ("source", pa.string()), ("sha256", pa.string()), ("license", pa.string()),
        ("id", pa.list_(pa.int32())), ("share", pa.list_(pa.float64())), ("volume", pa.list_(pa.float64())), ("mesh", pa.list_(pa.string())),
        *((name, vectors(pa.float64(), size)) for name, size in _POSE.items()),
        ("contacts", pa.list_(pa.struct([("a", pa.int32()), ("b", pa.int32()), ("area", pa.float64())]))),
        ("positions", vectors(pa.float32(), 3)), ("normals", vectors(pa.float32(), 3)), ("neighbor", pa.list_(pa.int32())), ("fragment", pa.list_(pa.int32())),
    ])  # fmt: skip


# --- what a dataset's folder holds


def _read(path: pathlib.Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as failed:
        raise FileError(f"{path}: cannot be read: {failed.strerror}") from None


def _plan(dataset: pathlib.Path) -> dict[str, Any]:
    file = dataset / "dataset.json"
    try:
        plan = json.loads(_read(file))
        found: dict[str, Any] = {name: plan[name] for name in ("layout", "seed", "options")}
    except (*_DAMAGES, RecursionError):
        raise FileError(f"{file}: is damaged") from None
    if found["layout"] not in ("sherd", "bb"):
        raise FileError(f"{dataset}: has the layout {found['layout']}; points are read of sherd and bb")
    return found


def _meshes(dataset: pathlib.Path) -> dict[str, dict[str, str]]:
    """The meshes of the recipe by name; none of an assemblage, which has no recipe."""
    file = dataset / "recipe.json"
    if not file.exists():
        return {}
    try:
        meshes: dict[str, dict[str, str]] = {}
        for mesh in json.loads(_read(file))["meshes"]:
            meshes[mesh["object"]] = {name: mesh[name] for name in ("object", "sha256", "license") if name in mesh}
            for text in meshes[mesh["object"]].values():
                str.encode(text)
        return meshes
    except (*_DAMAGES, RecursionError):
        raise FileError(f"{file}: is damaged") from None


def _rows(dataset: pathlib.Path, meshes: dict[str, dict[str, str]]) -> Iterator[dict[str, Any]]:
    for (key, fracture), group in itertools.groupby(_lines(dataset / "index.jsonl"), key=lambda line: (line[1]["object"], line[1]["fracture"])):
        lines = list(group)
        where = f"{dataset / 'index.jsonl'}:{lines[0][0]}"
        if fracture == "whole":
            continue
        try:
            yield _row(dataset, [fragment for _, fragment in lines if not fragment["withheld"]], lines[0][1], meshes.get(key, {}))
        except _DAMAGES:
            raise FileError(f"{where}: is damaged") from None


def _lines(index: pathlib.Path) -> Iterator[tuple[int, dict[str, Any]]]:
    try:
        file = open(index, "rb")
    except OSError as failed:
        raise FileError(f"{index}: cannot be read: {failed.strerror}; is the dataset finished?") from None
    with file:
        for number, text in enumerate(file, 1):
            try:
                line = json.loads(text)
                line["object"], line["fracture"]
            except (*_DAMAGES, RecursionError):
                raise FileError(f"{index}:{number}: is damaged") from None
            yield number, line


def _row(dataset: pathlib.Path, fragments: list[dict[str, Any]], first: dict[str, Any], mesh: dict[str, str]) -> dict[str, Any]:
    if first["split"] not in _SPLITS:
        raise ValueError(first["split"])
    points = [_points(dataset, fragment) for fragment in fragments]
    ids = [fragment["id"] for fragment in fragments]
    pairs = [{"a": fragment["id"], "b": other, "area": area} for fragment in fragments for other, area in fragment["contacts"] if other > fragment["id"]]
    row = {name: first[name] for name in ("object", "fracture", "split", "pieces", "repeat", "seed")}
    row |= {"options": json.dumps(first["options"]), "source": first["object"] if mesh else None, "sha256": mesh.get("sha256"), "license": mesh.get("license")}
    row |= {"id": ids, "contacts": pairs, **{name: [fragment[name] for fragment in fragments] for name in ("share", "volume")}}
    row |= {name: [fragment[name] for fragment in fragments] for name in ("mesh", *_POSE) if name in first}
    row |= {name: [part[k] for part in points] for k, name in enumerate(("positions", "normals", "neighbor"))}
    return row | {"fragment": [np.full(len(part[0]), own, np.int32) for own, part in zip(ids, points)]}


def _points(dataset: pathlib.Path, fragment: dict[str, Any]) -> tuple[Any, Any, Any]:
    """Positions, normals and neighbors of the points of a fragment."""
    found = [(name, sha256) for name, sha256 in zip(fragment["files"], fragment["sha256"]) if "points" in name.split("/") and name.endswith(".npz")]
    packed = [name for name in fragment["files"] if "points" in name.split("/") and ".npz." in name.split("/")[-1]]
    if packed and not found:
        raise FileError(f"{dataset}: {packed[0]} is compressed; make the dataset without --compress")
    if not found:
        raise FileError(f"{dataset}: {fragment['object']}, {fragment['fracture']} has no points in .npz; give sherd dataset --points N --point-format npz")
    name, sha256 = found[0]
    path = dataset / name
    if not path.resolve().is_relative_to(dataset.resolve()):
        raise FileError(f"{dataset}: {name} leads out of the folder")
    if hashlib.sha256(_read(path)).hexdigest() != sha256:
        raise FileError(f"{path}: differs from its checksum in the index")
    try:
        with np.load(path, allow_pickle=False) as arrays:
            positions, normals = (arrays[name].astype(np.float32, casting="same_kind", copy=False) for name in ("positions", "normals"))
            neighbor = arrays["neighbor"].astype(np.int32, casting="same_kind", copy=False)
    except (OSError, zipfile.BadZipFile, *_DAMAGES):
        raise FileError(f"{path}: is damaged") from None
    if positions.ndim != 2 or positions.shape[1] != 3 or normals.shape != positions.shape or neighbor.shape != positions.shape[:1]:
        raise FileError(f"{path}: has arrays of other shapes")
    return positions, normals, neighbor


def main() -> int:
    """``python -m pysherd.parquet``."""
    if len(sys.argv) != 3:
        print("usage: python -m pysherd.parquet DATASET FOLDER", file=sys.stderr)
        return 2
    try:
        for path in write_parquet(*sys.argv[1:]):
            print(path)
    except ImportError as missing:
        print(f"pysherd: {missing}", file=sys.stderr)
        return 1
    except Error as failed:
        print(f"pysherd: {failed}", file=sys.stderr)
        return failed.code
    return 0


if __name__ == "__main__":
    sys.exit(main())
