"""Exceptions: `Error` and one class for each kind of it."""

from __future__ import annotations

import functools
import os
import sys
import warnings
from typing import ClassVar, Iterable, Sequence


class Error(Exception):
    """Every error that pysherd raises on its own: one sentence without a final full stop.

    Attributes
    ----------
    code : int
        The kind of error, the exit status of the program: 1 internal, 2 usage, 3 input, 4 device,
        5 output, 130 cancelled.
    options : tuple of str
        Keywords whose values decide here, such as ``"resolution"``; often none.
    """

    code: ClassVar[int] = 1
    options: tuple[str, ...]

    def __init__(self, sentence: str = "", options: Sequence[str] = ()) -> None:
        super().__init__(sentence)
        self.options = tuple(name.replace("-", "_") for name in options)


class UsageError(Error, ValueError):
    """An invalid keyword or value, or values that contradict each other (code 2)."""

    code = 2


class InputError(Error, ValueError):
    """An object that cannot be broken (code 3)."""

    code = 3


class FileError(Error, OSError):
    """A file that cannot be read, or whose content cannot be used (code 3)."""

    code = 3


class DeviceError(Error, RuntimeError):
    """No such device, a device that failed, or a process that has lost its threads (code 4)."""

    code = 4


class OutputError(Error, OSError):
    """A file or folder that cannot be written (code 5)."""

    code = 5


class Cancelled(Error):
    """Stopped by ``progress``, which returned False (code 130)."""

    code = 130


class SherdWarning(UserWarning):
    """Every warning of pysherd: an option without effect, or what may be lost of an object."""


_HERE = os.path.dirname(__file__) + os.sep


def warn(sentences: Iterable[str]) -> None:
    """Warns once for each sentence, at the line outside this package that called it."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith((_HERE, functools.__file__)):  # cached_property is there
        level, frame = level + 1, frame.f_back
    for sentence in sentences:
        warnings.warn(sentence, SherdWarning, stacklevel=level)


_BY_CODE: dict[int, type[Error]] = {c.code: c for c in (Error, UsageError, InputError, DeviceError, OutputError, Cancelled)}


def error(code: int, sentence: str, options: Sequence[str] = ()) -> Error:
    """Returns the exception for a code; the extension module calls this."""
    return _BY_CODE.get(code, Error)(sentence, options)
