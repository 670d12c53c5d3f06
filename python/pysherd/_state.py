"""What pickles hold: bytes with a checksum, so that damage is found before anything is made of them.

A pickle of an object here is a function of this package and its arguments: one state, and for what belongs to another object, that.
Functions take any arguments, since a damaged pickle may call them with any.
"""

from __future__ import annotations

import contextlib
import pickle
from typing import Any, Iterator

from . import _core
from ._errors import InputError, UsageError


def sealed(kind: str, content: bytes) -> bytes:
    """Returns a state.

    Parameters
    ----------
    kind : str
        What it is the state of, at most 8 letters.
    """
    return _core.sealed(kind, content)  # type: ignore[no-any-return]


def only(kind: str, arguments: tuple[Any, ...], *types: type) -> tuple[Any, ...]:
    """Returns the arguments if they are of these types.

    Raises
    ------
    InputError
        They are not.
    """
    if len(arguments) != len(types) or not all(map(isinstance, arguments, types)):
        found = ", ".join(type(argument).__name__ for argument in arguments) or "nothing"
        raise InputError(f"this pickle of {_named(kind)} is damaged, or of another version of pysherd: it holds {found}")
    return arguments


# Also by the pickle of the options' values, which may name what does not exist.
_RAISED = (UsageError, ValueError, TypeError, OverflowError, LookupError, RecursionError, EOFError, AttributeError, ImportError, MemoryError,
           pickle.PickleError)  # fmt: skip


@contextlib.contextmanager
def restoring(kind: str) -> Iterator[None]:
    """Makes input errors of what is refused of a state whose checksum is right, and was made by other means or another version."""
    try:
        yield
    except InputError:
        raise
    except _RAISED as e:
        raise InputError(f"this pickle of {_named(kind)} cannot be used: {e}", getattr(e, "options", ())) from None


def _named(kind: str) -> str:
    return kind if kind == "options" else f"a {kind}"
