# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the program `sherd` is, and the preferences of the add-on."""
import shutil

import bpy
from bpy.props import IntProperty, StringProperty

from .failure import Failure


def preference(context, name, default):
    addon = context.preferences.addons.get(__package__)
    return getattr(addon.preferences, name) if addon and addon.preferences else default


def program(context):
    asked = bpy.path.abspath(preference(context, "binary", "") or "sherd")
    found = shutil.which(asked)
    if found is None:
        raise Failure(f"program '{asked}' not found; set the path of sherd in Edit > Preferences > Add-ons > "
                      "Sherd Fracture")
    return found


class SherdPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    binary: StringProperty(name="Program", description="Path of sherd; empty: as found in PATH", subtype="FILE_PATH")
    timeout: IntProperty(name="Time Limit", description="Seconds after which a run is stopped", default=600, min=1)

    def draw(self, _context):
        self.layout.prop(self, "binary")
        self.layout.prop(self, "timeout")
