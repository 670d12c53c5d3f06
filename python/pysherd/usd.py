"""Scenes in USD as `.usdc`, the binary format that Pixar's library writes.

>>> import pysherd, pysherd.usd
>>> pysherd.fracture("bowl.obj", pieces=8).save("pieces", write="usd")
>>> pysherd.usd.write_usdc("pieces/scene.usda")

usd-core is not among the requirements of pysherd: install it beside.
"""

from __future__ import annotations

import os
import pathlib

from ._errors import FileError, OutputError
from ._values import path_text

__all__ = ["write_usdc"]


def write_usdc(file: str | os.PathLike[str]) -> pathlib.Path:
    """Writes a ``.usda`` as ``.usdc`` beside it, where textures and volumes are found, and returns the path of that.

    Parameters
    ----------
    file : path
        A scene of ``write="usd"``.

    Raises
    ------
    ImportError
        usd-core is not installed.
    FileError
        The file is no layer of USD.
    OutputError
        The ``.usdc`` cannot be written.
    """
    try:
        from pxr import Sdf, Tf
    except ModuleNotFoundError as missing:
        if missing.name != "pxr":
            raise
        raise ImportError("pysherd.usd.write_usdc needs OpenUSD, which is not installed: pip install usd-core") from None
    source = pathlib.Path(path_text("file", file, FileError))
    try:
        layer = Sdf.Layer.OpenAsAnonymous(str(source))
    except (Tf.ErrorException, UnicodeError):  # OpenUSD takes paths in UTF-8
        layer = None
    if layer is None:
        raise FileError(f"{source}: cannot be read as a layer of USD")
    target, partial = source.with_suffix(".usdc"), source.with_suffix(".partial.usdc")
    try:
        done = layer.Export(str(partial))
    except Tf.ErrorException:
        done = False
    if not done:
        partial.unlink(missing_ok=True)
        raise OutputError(f"{target}: cannot be written")
    partial.replace(target)
    return target
