# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the sidebar, and the entry in the menu Object."""
import bpy

from .settings import NAMES


class VIEW3D_PT_sherd(bpy.types.Panel):
    bl_label = "Sherd Fracture"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Sherd"

    def draw(self, context):
        layout, chosen = self.layout, context.scene.sherd
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        for name in ("pieces", "resolution", "seed", "growth", "roughness", "wear"):
            column.prop(chosen, name)
        column = layout.column()
        column.prop(chosen, "impact")
        if chosen.impact != "NONE":
            column.prop(chosen, "impact_pieces")
            column.prop(chosen, "impact_spread")
        column = layout.column()
        column.prop_search(chosen, "inside_material", bpy.data, "materials")
        column.prop(chosen, "rigid_body")
        if chosen.rigid_body:
            column.prop(chosen, "density")
            column.prop(chosen, "asleep")
        column.prop(chosen, "original")
        column.prop(chosen, "folder")
        run = layout.operator("object.sherd_fracture", text="Break", icon="MOD_EXPLODE")
        for name in NAMES:
            setattr(run, name, getattr(chosen, name))


def menu(self, _context):
    self.layout.operator_context = "INVOKE_DEFAULT"
    self.layout.operator("object.sherd_fracture")
