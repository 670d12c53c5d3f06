"""Keywords, made from the option table of the library: names, ranges, defaults and help are its rows."""

from __future__ import annotations

import inspect
import operator
import os
import pickle
import re
from typing import Any, Callable, Iterable, Iterator, List, Mapping, Tuple

from . import _core, _state
from ._errors import UsageError, warn
from ._values import is_number, is_sequence, items_of, path_text, plain, shown, text_of


class Row:
    """A row of the option table."""

    def __init__(self, row: dict[str, Any]) -> None:
        self.name: str = row["name"]
        self.keyword: str = row["keyword"]
        self.group: str = row["group"]
        self.type: str = row["type"]
        self.range: str = row["range"]
        self.choices: list[str] = row["choices"]
        self.default: str = row["default"]
        self.unit: str = row["unit"]
        self.help: str = _in_keywords(row["help"])
        self.repeats: bool = row["repeats"]

    def texts(self, value: Any) -> list[str]:
        """Returns a value as on the command line; several texts where the option repeats."""
        if not self.repeats or isinstance(value, str):
            return [self._text(value)]
        if not is_sequence(value):
            if isinstance(value, (bytes, os.PathLike)):
                return [self._text(value)]
            raise UsageError(f"{self.keyword}: a list is needed, each item one {self.range}")
        items = items_of(self.keyword, value)
        if items and all(map(is_number, items)):
            items = [items]
        return [self._text(item) for item in items]

    def _text(self, value: Any) -> str:
        if is_sequence(value):
            return ",".join(map(self._part, items_of(self.keyword, value)))
        return self._part(value)

    def _part(self, value: Any) -> str:
        """Returns a value that is not several as on the command line."""
        value = plain(value)
        if isinstance(value, str):
            return text_of(self.keyword, value)
        if isinstance(value, os.PathLike) or isinstance(value, bytes) and self.type == "text":
            return path_text(self.keyword, value)
        if isinstance(value, bool):
            if self.type not in ("flag", "text"):
                raise UsageError(f"{self.keyword}: {value!r} is no value for it; {self.expected()}")
            return "true" if value else "false"
        if self.type == "flag":
            raise UsageError(f"{self.keyword}: {shown(value)} is not True or False")
        if is_number(value):
            return self._number(value)
        raise UsageError(f"{self.keyword}: a {type(value).__name__} is no value for it; {self.expected()}")

    def _number(self, value: Any) -> str:
        try:
            return _number_text(value)
        except (TypeError, ValueError, ArithmeticError):  # no text has so many digits, and no double so large a number
            raise UsageError(f"{self.keyword}: {shown(value)} is no number that it can have; {self.expected()}") from None

    def expected(self) -> str:
        """Describes the values: ``"0..1, voxels"``."""
        values = " | ".join(self.choices) if self.choices else self.range
        if self.choices and self.range:
            values += f" | {self.range}"
        return (values or "True or False") + (f", {self.unit}" if self.unit else "")

    def default_value(self) -> Any:
        """Returns the default as a Python value, None where the option has none."""
        if self.type == "flag":
            return self.default == "true"
        if self.type in ("choices", "wholes", "numbers") or not self.default:
            return tuple(self.default.split(",")) if self.default else None
        for kind in (int, float):
            try:
                return kind(self.default)
            except ValueError:
                continue
        return self.default


def _in_keywords(sentence: str) -> str:
    """Returns a sentence with keywords in place of the program's options: ``erode_on`` for ``--erode-on``."""
    return re.sub(r"--([a-z][a-z-]*)", lambda option: option[1].replace("-", "_"), sentence)


def _number_text(value: Any) -> str:
    try:
        return str(operator.index(value))
    except TypeError:
        number = float(value)
    return repr(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)


ROWS: dict[str, Row] = {row["keyword"]: Row(row) for row in _core.option_table()}
_FILES = frozenset(("write", "voxel_format", "mesh_format", "plain_meshes", "precision", "source_faces", "up", "unit"))


def _makes_solid(row: Row) -> bool:
    return row.keyword in ("resolution", "voxel_size") or row.group == "Solid"


SOLID = {k: r for k, r in ROWS.items() if _makes_solid(r)}
VOXELIZE = {k: r for k, r in ROWS.items() if k in SOLID or k in ("preset", "surface", "up", "unit")}
SAVE = {k: r for k, r in ROWS.items() if k in _FILES or r.group in ("Points", "Files for hosts")}
_OF_WHOLE = frozenset(_core.options_of_whole())
BROKEN = {k: r for k, r in ROWS.items() if r.name not in _OF_WHOLE}
POINTS = {k: r for k, r in ROWS.items() if k in ("share_points", "point_sampler", "point_rule")}


def given(options: Mapping[str, Any], accepted: Mapping[str, Row] = ROWS, function: str = "fracture") -> list[tuple[str, str]]:
    """Returns options as names and texts; those that are None are left out.

    Raises
    ------
    UsageError
        A keyword that `accepted` lacks, or a value that the table refuses, naming the keyword.
    """
    texts = []
    for keyword, value in options.items():
        if keyword not in accepted:
            raise UsageError(unknown(keyword, accepted, function))
        if value is not None:
            texts += [(accepted[keyword].name, text) for text in accepted[keyword].texts(value)]
    _core.check_options(texts)
    return texts


Texts = List[Tuple[str, str]]


def check_together(texts: Texts, own: Texts, file: str = "", before: Texts | None = None) -> None:
    """Checks options against each other, and warns of those of `own` that do nothing.

    Parameters
    ----------
    file : str
        The file that is broken, if it is one.
    before : list, optional
        Options of which was warned before.

    Raises
    ------
    UsageError
        Two of them contradict each other.
    """
    names = [name for name, _ in own]
    known = set(_core.idle_options(before, names, file)) if before is not None else ()
    warn(sentence for sentence in _core.idle_options(texts, names, file) if sentence not in known)


def unknown(keyword: str, accepted: Mapping[str, Row], function: str) -> str:
    import difflib

    if keyword in ROWS:
        return f"{keyword}: {function}() does not take it"
    nearest = difflib.get_close_matches(keyword, accepted, 1)
    return f"{keyword}: {function}() has no such keyword" + (f"; the nearest is {nearest[0]}" if nearest else "")


class Options(Mapping[str, Any]):
    """Options of a fracture, checked once: ``pysherd.fracture(solid, **options)``.

    A read-only mapping from keywords to values, as they were given; it can be pickled and compared.

    Parameters
    ----------
    **options
        Keywords of `fracture`.

    Raises
    ------
    UsageError
        An unknown keyword, or a value out of its range.
    """

    def __init__(self, **options: Any) -> None:
        # An iterator is gone through once, and the options may be used any number of times.
        kept = {k: tuple(items_of(k, v)) if isinstance(v, Iterator) else v for k, v in options.items() if v is not None}
        given(kept)
        self._options: dict[str, Any] = kept

    def __getitem__(self, keyword: str) -> Any:
        return self._options[keyword]

    def __iter__(self) -> Iterator[str]:
        return iter(self._options)

    def __len__(self) -> int:
        return len(self._options)

    def __reduce__(self) -> tuple[Any, ...]:
        return _options_again, (_state.sealed("options", pickle.dumps(self._options)),)

    def __repr__(self) -> str:
        return "Options(" + ", ".join(f"{k}={v!r}" for k, v in self._options.items()) + ")"

    @classmethod
    def _of_texts(cls, texts: Iterable[tuple[str, str]]) -> Options:
        """Returns options as they are recorded: numbers where the text is one."""
        values: dict[str, Any] = {}
        by_name = {row.name: row for row in ROWS.values()}
        for name, text in texts:
            row = by_name[name]
            if row.repeats:
                values.setdefault(row.keyword, []).append(text)
            elif row.type == "flag":
                values[row.keyword] = text == "true"
            else:
                values[row.keyword] = _value_of(row, text)
        options = cls()
        options._options = values  # checked before; the file of seeds may be gone
        return options


def _options_again(*state: Any) -> Options:
    (sealed,) = _state.only("options", state, bytes)
    content = _core.content_of("options", sealed)
    with _state.restoring("options"):
        return Options(**pickle.loads(content))


def _value_of(row: Row, text: str) -> Any:
    for kind in (int, float) if row.type in ("whole", "number", "length") else ():
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _keyword_help(row: Row) -> str:
    default = f", default {row.default}" if row.default and row.type != "flag" else ""
    return f"{row.keyword} : {row.expected()}{default}\n    {row.help}."


def documented(accepted: Mapping[str, Row]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorates a function that takes options as ``**options``: its signature and its docstring list them."""

    def with_table(function: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        keywords = [inspect.Parameter(k, inspect.Parameter.KEYWORD_ONLY, default=r.default_value()) for k, r in accepted.items()]
        function.__signature__ = signature.replace(parameters=own + keywords)  # type: ignore[attr-defined]
        function.__doc__ = documented_text(function.__doc__, accepted)
        return function

    return with_table


def documented_text(text: str | None, accepted: Mapping[str, Row]) -> str | None:
    """Returns a docstring in which ``{options}`` are listed."""
    return text and inspect.cleandoc(text).replace("{options}", "\n".join(_keyword_help(row) for row in accepted.values()))
