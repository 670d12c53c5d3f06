"""Options of a stream of fractures, some of which are drawn for each fracture, as ``sherd dataset`` draws them."""

from __future__ import annotations

import functools
from typing import Any, Mapping, Sequence

from . import _core, _options
from ._errors import UsageError, warn
from ._options import Row, Texts
from ._values import is_number, shown

_NOT_OF_STREAMS = {"seed", "seeds", "only", "split_objects", "share_points"}
ACCEPTED = {k: r for k, r in _options.ROWS.items() if k not in _NOT_OF_STREAMS and (k not in _options.SAVE or k in _options.POINTS)}


class Drawn:
    """Options with their values, or with what these are drawn from: ``"0..0.4"`` or ``"a|b"``.

    Parameters
    ----------
    options : mapping
        By keywords.  `pieces` may also be a range of Python.

    Raises
    ------
    UsageError
        A keyword that there is not, or a value that the table refuses.
    """

    def __init__(self, options: Mapping[str, Any]) -> None:
        self._fixed: Texts = []
        self._ranges: Texts = []
        for keyword, value in options.items():
            if keyword not in ACCEPTED:
                raise UsageError(_options.unknown(keyword, ACCEPTED, "FractureDataset"))
            if value is not None:
                is_automatic = keyword == "surface" and isinstance(value, str) and value == "auto"
                self._add(ACCEPTED[keyword], "smooth" if is_automatic else value)
        self._check()

    def _add(self, row: Row, value: Any) -> None:
        if row.keyword == "pieces" and isinstance(value, range):
            if len(value) == 0 or value.step != 1:
                raise UsageError(f"pieces: {shown(value)} has no numbers that follow one another; give one such as range(2, 11)")
            value = f"{value[0]}..{value[-1]}"
        texts = [(row.name, text) for text in row.texts(value)]
        if isinstance(value, (tuple, list)) and row.keyword not in _options.VOXELIZE:
            _check_list(texts, value)
        if len(texts) != 1 or _option(*texts[0]) is None:
            self._fixed += texts
        elif row.keyword in _options.VOXELIZE:
            raise UsageError(f"{row.keyword}: a value is needed, since a mesh is voxelized once for all its fractures")
        else:
            self._ranges += texts

    def _check(self) -> None:
        _core.check_options(self._fixed)
        first = []
        for name, text in self._ranges:
            ends = _option(name, text).ends
            first.append((name, ends[0]))
            for end in ends:
                _core.check_options([*self._fixed, (name, end)])
        texts = self._fixed + first
        names = [name for name, _ in texts]
        warn(_core.idle_options([*texts, ("points", "1")], names, "", {name for name, _ in self._ranges}))

    def texts(self, seed: int) -> Texts:
        """Returns the options of a fracture."""
        return self._fixed + [(name, _option(name, text).value(seed)) for name, text in self._ranges]

    @property
    def of_solids(self) -> Texts:
        """The options that voxelizing takes."""
        names = {row.name for row in _options.VOXELIZE.values()}
        own = [option for option in self._fixed if option[0] in names]
        return own if {"surface", "preset"} & {name for name, _ in own} else [*own, ("surface", "smooth")]

    @property
    def of_points(self) -> Texts:
        """The options of points."""
        names = {row.name for row in _options.POINTS.values()}
        return [option for option in self._fixed if option[0] in names]

    @property
    def side(self) -> int:
        """The voxels along the longest side, 0 where each mesh has its own."""
        text = dict(self._fixed).get("resolution", "")
        return int(text) if text.isdigit() else 0

    @property
    def pieces(self) -> tuple[int, int]:
        """The fewest pieces and the most."""
        for name, text in self._ranges:
            if name == "pieces":
                low, high = _option(name, text).ends
                return int(low), int(high)
        only = int(dict(self._fixed).get("pieces", _options.ROWS["pieces"].default))
        return only, only

    def __repr__(self) -> str:
        return repr(self._fixed + self._ranges)


def _check_list(texts: Texts, value: Sequence[Any]) -> None:
    """Refuses a tuple that is no value, with what it was meant to be: a range or a choice."""
    try:
        _core.check_options(texts)
    except UsageError as e:
        hint = ""
        if len(value) == 2 and all(map(is_number, value)):
            hint = f"; a range is '{min(value)}..{max(value)}'"
        elif value and all(isinstance(part, str) for part in value):
            hint = f"; a choice is {'|'.join(value)!r}"
        raise UsageError(f"{e}{hint}", e.options) from None


@functools.lru_cache(maxsize=256)
def _option(name: str, text: str) -> Any:
    return _core.drawn_option(name, text)
