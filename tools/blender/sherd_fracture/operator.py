# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator that breaks an object."""
import bpy
from bpy.props import FloatVectorProperty
from bpy_extras import view3d_utils

from .failure import Failure
from .job import Job
from .program import program
from .settings import Choices

CONVERTIBLE = ("CURVE", "SURFACE", "META", "FONT")


class OBJECT_OT_sherd_fracture(bpy.types.Operator, Choices):
    """Break the active mesh object into closed fragments with sherd"""

    bl_idname = "object.sherd_fracture"
    bl_label = "Sherd Fracture"
    bl_options = {"REGISTER", "UNDO"}

    impact_point: FloatVectorProperty(name="Impact Point", subtype="XYZ", options={"HIDDEN", "SKIP_SAVE"})

    job = timer = None

    def thing(self, context):
        thing = context.active_object
        if thing is None or not thing.select_get():
            raise Failure("nothing is selected; select the mesh object to break")
        if thing.type != "MESH":
            hint = "convert it first (Object > Convert)" if thing.type in CONVERTIBLE else "select a mesh object"
            raise Failure(f"{thing.name} is of type {thing.type.lower()}, not a mesh; {hint}")
        if thing.mode != "OBJECT":
            raise Failure(f"{thing.name} is in {thing.mode.lower()} mode; leave it first (Tab)")
        return thing

    def begin(self, context):
        self.impact_position = None
        if self.impact == "CURSOR":
            self.impact_position = tuple(context.scene.cursor.location)
        elif self.impact == "MOUSE":
            if not self.properties.is_property_set("impact_point"):
                raise Failure("an impact under the mouse needs a click in a 3D view; use the 3D cursor without one")
            self.impact_position = tuple(self.impact_point)
        return Job(context, self.thing(context), self)

    def end(self, context, job):
        fragments, warnings = job.fetch(context)
        for warning in warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, f"{len(fragments)} fragments of {job.thing.name}")
        return {"FINISHED"}

    def fail(self, context, failure):
        self.leave(context)
        self.report({"ERROR"}, str(failure))
        return {"CANCELLED"}

    def execute(self, context):
        """Blocking run: scripts, and the panel of the last operation."""
        try:
            with self.begin(context) as job:
                job.wait()
                return self.end(context, job)
        except Failure as failure:
            return self.fail(context, failure)

    def invoke(self, context, _event):
        """From the panel: first a click if needed, then a run that Esc stops."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        try:
            self.thing(context)
            program(context)
            if self.impact == "MOUSE" and not self.properties.is_property_set("impact_point"):
                if context.area is None or context.area.type != "VIEW_3D":
                    raise Failure("an impact under the mouse needs a click in a 3D view; start it from the sidebar there")
                context.workspace.status_text_set("Click the impact point; right click or Esc: no fracture")
                context.window.cursor_modal_set("CROSSHAIR")
            else:
                self.start(context)
        except Failure as failure:
            return self.fail(context, failure)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def start(self, context):
        self.job = self.begin(context)
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.workspace.status_text_set(f"Sherd is breaking {self.job.thing.name}; Esc stops it")
        context.window.cursor_modal_set("WAIT")

    def pick(self, context, event):
        """The point of the object under the mouse; None beside the object."""
        for region in context.area.regions:
            x, y = event.mouse_x - region.x, event.mouse_y - region.y
            if region.type == "WINDOW" and 0 <= x < region.width and 0 <= y < region.height:
                return point_under(context, region, region.data, (x, y), self.thing(context))
        return None

    def modal(self, context, event):
        try:
            if event.type == "ESC" or (event.type == "RIGHTMOUSE" and self.job is None):
                self.leave(context)
                self.report({"INFO"}, "no fracture")
                return {"CANCELLED"}
            if self.job is None:
                if event.type != "LEFTMOUSE" or event.value != "PRESS":
                    return {"PASS_THROUGH"}  # the view may be rotated
                position = self.pick(context, event)
                if position is None:
                    self.report({"WARNING"}, "the click missed the object")
                    return {"RUNNING_MODAL"}
                self.impact_point = position
                self.start(context)
            elif event.type == "TIMER" and not self.job.running():
                job, self.job = self.job, None
                self.leave(context)
                with job:
                    return self.end(context, job)
        except Failure as failure:
            return self.fail(context, failure)
        return {"RUNNING_MODAL"}

    def leave(self, context):
        if self.job:
            self.job.close()
            self.job = None
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)
            self.timer = None
        if not bpy.app.background and context.window:
            context.window.cursor_modal_restore()
            context.workspace.status_text_set(None)

    def cancel(self, context):
        self.leave(context)


def point_under(context, region, view, at, thing):
    """First intersection of the ray through a pixel with an object, in world space, or None."""
    start = view3d_utils.region_2d_to_origin_3d(region, view, at)
    along = view3d_utils.region_2d_to_vector_3d(region, view, at)
    evaluated = thing.evaluated_get(context.evaluated_depsgraph_get())
    local = evaluated.matrix_world.inverted_safe()
    hit, position, _, _ = evaluated.ray_cast(local @ start, local.to_3x3() @ along)
    return evaluated.matrix_world @ position if hit else None
