# Sherd Fracture: breaks mesh objects of Blender with the program `sherd`.
#
# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
#
# This program is free software: you can redistribute it and/or modify it under the terms of the GNU General Public
# License as published by the Free Software Foundation, either version 3 of the License, or (at your option) any later
# version.  This program is distributed in the hope that it will be useful, but WITHOUT ANY WARRANTY; without even the
# implied warranty of MERCHANTABILITY or FITNESS FOR A PARTICULAR PURPOSE.  See the GNU General Public License for more
# details: <https://www.gnu.org/licenses/>.
#
# The files of this folder run inside Blender and are under Blender's license.  They start `sherd` as a separate
# program; the rest of Sherd is under the Apache License 2.0.
"""Sherd Fracture: see docs/blender.md."""
import bpy

from .operator import OBJECT_OT_sherd_fracture, OBJECT_OT_sherd_glue
from .panel import VIEW3D_PT_sherd, menu
from .program import SherdPreferences
from .settings import SherdSettings

bl_info = {
    "name": "Sherd Fracture",
    "author": "The Sherd authors",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Sherd",
    "description": "Break meshes into closed fragments with the program sherd",
    "category": "Object",
}

CLASSES = (SherdSettings, SherdPreferences, OBJECT_OT_sherd_fracture, OBJECT_OT_sherd_glue, VIEW3D_PT_sherd)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.sherd = bpy.props.PointerProperty(type=SherdSettings)
    bpy.types.VIEW3D_MT_object.append(menu)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(menu)
    del bpy.types.Scene.sherd
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
