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
        self.cracks(layout, chosen, context.active_object)
        self.result(layout, chosen)
        row = layout.row(align=True)
        for text, icon, preview in (("Preview", "HIDE_OFF", True), ("Break", "MOD_EXPLODE", False)):
            run = row.operator("object.sherd_fracture", text=text, icon=icon)
            for name in NAMES:
                setattr(run, name, getattr(chosen, name))
            run.preview = preview

    def cracks(self, layout, chosen, active):
        column = layout.column()
        for name in ("pieces", "resolution", "seed", "material", "growth"):
            column.prop(chosen, name)
        if chosen.growth == "SEQUENTIAL" or chosen.material not in ("NONE", "TEMPERED"):
            column.prop(chosen, "levels")
        for name in ("surface", "roughness", "wear"):
            column.prop(chosen, name)
        column = layout.column()
        column.prop(chosen, "impact")
        if chosen.impact != "NONE":
            column.prop(chosen, "impact_pieces")
            column.prop(chosen, "impact_spread")
        if active and active.type == "MESH":
            column.prop_search(chosen, "weight_group", active, "vertex_groups")

    def result(self, layout, chosen):
        column = layout.column()
        column.prop_search(chosen, "inside_material", bpy.data, "materials")
        column.prop(chosen, "rigid_body")
        if chosen.rigid_body:
            for name in ("shape", "density", "asleep", "glue"):
                column.prop(chosen, name)
            if chosen.glue:
                row = column.row(align=True)
                row.prop(chosen, "strength")
                row.operator("object.sherd_glue", text="", icon="CHECKMARK").strength = chosen.strength
        column.prop(chosen, "original")
        column.prop(chosen, "folder")


def menu(self, _context):
    self.layout.operator_context = "INVOKE_DEFAULT"
    self.layout.operator("object.sherd_fracture")
