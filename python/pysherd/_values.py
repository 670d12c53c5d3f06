"""Values of arguments, which may be anything: each is checked here, by its name."""

from __future__ import annotations

import itertools
import numbers
import operator
import os
import re
from typing import Any, Iterable, Mapping

from ._errors import Error, UsageError

_MOST_SHOWN = 80  # characters
MOST_VALUES = 2**16  # of an argument that is several; more come from an iterator without an end


def shown(value: Any) -> str:
    """Returns a value for a sentence: one line, not too long."""
    try:
        text = " ".join(repr(value).split())
    except Exception:  # whatever the object's own raises; a whole number of too many digits
        return f"a value of type {type(value).__name__}"
    return text if len(text) <= _MOST_SHOWN else text[: _MOST_SHOWN - 3] + "..."


def whole(name: str, value: Any, least: int, most: int | None = None) -> int:
    """Returns a whole number, or raises `UsageError`."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if number < least or isinstance(value, bool) or (most is not None and number > most):
        expected = f"from {least} on" if most is None else f"in {least}..{most}"
        raise UsageError(f"{name}: {shown(value)} is not a whole number {expected}")
    return number


def number_in(name: str, value: Any, low: float, high: float) -> float:
    """Returns a number of a closed range, or raises `UsageError`."""
    try:
        number = float(value) if is_number(value) else low - 1
    except (TypeError, ValueError, ArithmeticError):
        number = low - 1
    if not low <= number <= high:
        raise UsageError(f"{name}: {shown(value)} is not a number in {low:g}..{high:g}")
    return number


def flag(name: str, value: Any) -> bool:
    """Returns True or False, or raises `UsageError`."""
    value = plain(value)
    if not isinstance(value, int) or value not in (0, 1):
        raise UsageError(f"{name}: {shown(value)} is not True or False")
    return bool(value)


def whole_range(name: str, value: Any, low: int, high: int) -> tuple[int, int]:
    """Returns the ends of a range such as ``"2..5"``, or a whole number twice, or raises `UsageError`."""
    if isinstance(value, str):
        found = re.fullmatch(r"(\d{1,9})\.\.(\d{1,9})", value, re.ASCII)
        if found and low <= int(found[1]) <= int(found[2]) <= high:
            return int(found[1]), int(found[2])
        raise UsageError(f"{name}: {shown(value)} is not a range such as '2..5' in {low}..{high}")
    number = whole(name, value, low, high)
    return number, number


def word(name: str, value: Any, words: Iterable[str]) -> str:
    """Returns one of some words, or raises `UsageError`."""
    if not isinstance(value, str) or value not in words:
        raise UsageError(f"{name}: {shown(value)} is not one of {', '.join(words)}")
    return value


def path_text(name: str, path: Any, error: type[Error] = UsageError) -> str:
    """Returns a path of any bytes as text, in which surrogates stand for what is not UTF-8, or raises an error."""
    try:
        data = os.fsencode(path)
    except TypeError:
        raise error(f"{name}: a {type(path).__name__} is no path") from None
    except UnicodeError:
        raise error(f"{name}: {shown(path)} has a character that no path can have") from None
    if not data or b"\0" in data:
        raise error(f"{name}: the path {'has a null character' if data else 'is empty'}")
    return data.decode("utf-8", "surrogateescape")


def text_of(name: str, text: str) -> str:
    """Returns a text that the library can take, or raises `UsageError`."""
    try:
        text.encode("utf-8", "surrogateescape")
    except UnicodeError:
        raise UsageError(f"{name}: {shown(text)} has a character that no value can have") from None
    if "\0" in text:
        raise UsageError(f"{name}: {shown(text)} has a null character")
    return text


def plain(value: Any) -> Any:
    """Returns the number in an array without axes, and other values as they are."""
    if not (hasattr(value, "dtype") and getattr(value, "ndim", None) == 0 and hasattr(value, "item")):
        return value
    try:
        return value.item()
    except Exception:  # of an array that is on a device, or holds nothing
        return value


def is_number(value: Any) -> bool:
    value = plain(value)
    return isinstance(value, numbers.Number) and not isinstance(value, (bool, complex))


def is_sequence(value: Any) -> bool:
    if isinstance(value, (str, bytes, bytearray, os.PathLike, Mapping)) or getattr(value, "ndim", None) == 0:
        return False
    return isinstance(value, Iterable)


def items_of(name: str, values: Iterable[Any]) -> list[Any]:
    """Returns all of several values, or raises `UsageError`: an iterator may have no end."""
    items = list(itertools.islice(values, MOST_VALUES + 1))
    if len(items) > MOST_VALUES:
        raise UsageError(f"{name}: more than {MOST_VALUES} values are given")
    return items
