# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the program `sherd` is, how it is started, and the preferences of the add-on."""
import importlib.util
import os
import pathlib
import shutil
import stat

import bpy
from bpy.props import IntProperty, StringProperty

from .failure import Failure

# The extension brings the program as a wheel that has no module, only files in this folder.
BUNDLE = "sherd_program"
WHERE = "Edit > Preferences > Add-ons > Sherd Fracture"


def preference(context, name, default):
    addon = context.preferences.addons.get(__package__)
    return getattr(addon.preferences, name) if addon and addon.preferences else default


def bundled():
    """The program of the extension's wheel, or None.  Blender unpacks wheels without permissions to execute files."""
    found = importlib.util.find_spec(BUNDLE)
    for folder in found.submodule_search_locations or () if found else ():
        path = pathlib.Path(folder, "bin", "sherd")
        if not path.is_file():
            continue
        if not os.access(path, os.X_OK):
            try:
                mode = path.stat().st_mode
                path.chmod(mode | (mode & (stat.S_IRUSR | stat.S_IRGRP | stat.S_IROTH)) >> 2)
            except OSError as error:
                raise Failure(f"{path} cannot be made executable ({error.strerror}); do so, or set another program in "
                              f"{WHERE}") from None
        return str(path)
    return None


def program(context):
    """The program that the preferences name, else the extension's, else that in PATH."""
    asked = bpy.path.abspath(preference(context, "binary", ""))
    found = shutil.which(asked) if asked else bundled() or shutil.which("sherd")
    if found is None:
        raise Failure(f"program '{asked or 'sherd'}' not found; set the path of sherd in {WHERE}")
    return found


def is_bundled(binary):
    return pathlib.Path(binary).parts[-3:-1] == (BUNDLE, "bin")


def arguments_of(binary):
    """The extension's program needs no OpenCL, and looks for none."""
    return ["--device", "builtin"] if is_bundled(binary) else []


def environment(binary):
    """Blender's own, without what is meant for Blender's libraries and Python."""
    dropped = {"PYTHONHOME", "PYTHONPATH"}
    if is_bundled(binary):
        dropped |= {"LD_LIBRARY_PATH", "LD_PRELOAD"}
    return {name: value for name, value in os.environ.items() if name not in dropped}


class SherdPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    binary: StringProperty(name="Program", description="Path of sherd; empty: the extension's own, else as found in PATH",
                           subtype="FILE_PATH")
    timeout: IntProperty(name="Time Limit", description="Seconds after which a run is stopped", default=600, min=1)

    def draw(self, _context):
        self.layout.prop(self, "binary")
        self.layout.prop(self, "timeout")
