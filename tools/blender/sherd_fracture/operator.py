# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator that breaks the selected objects."""
import bpy
from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty

from .batch import Batch
from .failure import Failure
from .glue import set_strength
from .program import program
from .settings import Choices
from .targets import first_under, targets

EVERY = 0.05  # seconds between two steps; each works as long, so that half of the time is Blender's
VIEW = {"MIDDLEMOUSE", "MOUSEMOVE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM", "MOUSEROTATE", "NDOF_MOTION",
        "WINDOW_DEACTIVATE", "INBETWEEN_MOUSEMOVE", "TIMER_REPORT", "TIMER_REGION"}


class Breaking:
    """The operator's events.  `self` has the options."""

    batch = timer = said = None
    opened = False
    keys, left = (), ()

    def prepare(self, context, position=None, struck=None):
        """The work on the selected objects.  An impact under the mouse strikes one of them only."""
        self.keys, self.left = targets(context)
        positions = {}
        if self.impact == "CURSOR":
            positions = dict.fromkeys(self.keys, tuple(context.scene.cursor.location))
        elif self.impact == "MOUSE":
            positions = dict.fromkeys([struck] if struck else self.keys, tuple(position))
        return Batch(self.keys, self, positions)

    def clicked(self):
        """The point of an impact under the mouse that a script gave, or None."""
        return tuple(self.impact_point) if self.properties.is_property_set("impact_point") else None

    def execute(self, context):
        """Blocking run, for scripts."""
        try:
            if self.impact == "MOUSE" and self.clicked() is None:
                raise Failure("an impact under the mouse needs a click in a 3D view; use the 3D cursor without one")
            self.batch = self.prepare(context, self.clicked())
            program(context)
        except Failure as failure:
            return self.fail(context, failure)
        self.batch.wait(context)
        return self.finish(context)

    def invoke(self, context, _event):
        """From the panel: first a click if needed, then a run that Esc stops."""
        if bpy.app.background or context.window is None:
            return self.execute(context)
        return self.open(context)

    def open(self, context):
        self.opened = True
        try:
            self.keys, self.left = targets(context)
            program(context)
            if self.impact == "MOUSE" and self.clicked() is None:
                if context.area is None or context.area.type != "VIEW_3D":
                    raise Failure("an impact under the mouse needs a click in a 3D view; start it from the sidebar there")
                context.workspace.status_text_set("Click the impact point; right click or Esc: no fracture")
                context.window.cursor_modal_set("CROSSHAIR")
            else:
                self.start(context, self.prepare(context, self.clicked()))
        except Failure as failure:
            return self.fail(context, failure)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def start(self, context, batch):
        self.batch = batch
        self.timer = context.window_manager.event_timer_add(EVERY, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window.cursor_modal_set("DEFAULT")
        self.show(context)

    def show(self, context):
        """Stage and percentage, in the status bar and at the mouse."""
        text = self.batch.text()
        if text != self.said:
            self.said = text
            context.workspace.status_text_set(text)
            context.window_manager.progress_update(int(100 * self.batch.share()))

    def modal(self, context, event):
        if self.batch is None:
            return self.pick(context, event)
        if event.type == "ESC" and event.value == "PRESS":
            self.batch.stop(context)
            self.leave(context)
            if self.batch.done:  # what is done stays, as one step to undo
                return self.finish(context)
            self.report({"INFO"}, "no fracture")
            return {"CANCELLED"}
        if event.type == "TIMER":
            try:
                works = self.batch.step(context, EVERY)
            except BaseException:  # a fault: Blender shows it, and the status bar is free again
                self.leave(context)
                raise
            if not works:
                self.leave(context)
                return self.finish(context)
            self.show(context)
        return {"PASS_THROUGH"} if event.type in VIEW else {"RUNNING_MODAL"}  # no other change meanwhile, nor undo

    def pick(self, context, event):
        """An event before the impact is chosen."""
        if event.type in ("ESC", "RIGHTMOUSE"):
            self.leave(context)
            self.report({"INFO"}, "no fracture")
            return {"CANCELLED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}  # the view may be rotated
        struck, position = first_under(context, event, self.keys)
        if position is None:
            self.report({"WARNING"}, "the click missed the object")
            return {"RUNNING_MODAL"}
        try:
            self.start(context, self.prepare(context, position, struck))
        except Failure as failure:
            return self.fail(context, failure)
        return {"RUNNING_MODAL"}

    def finish(self, context):
        """The report: one line for each thing that the user should know, the summary last."""
        batch = self.batch
        if not batch.done:
            return self.fail(context, "; ".join(batch.failures))
        for sentence in [*self.left, *batch.failures, *batch.notes]:
            self.report({"WARNING"}, sentence)
        self.report({"INFO"}, batch.summary())
        return {"FINISHED"}

    def fail(self, context, failure):
        self.leave(context)
        self.report({"ERROR"}, str(failure))
        return {"CANCELLED"}

    def leave(self, context):
        """Ends the display of progress, and the work if it is not at its end."""
        if self.batch:
            self.batch.stop(context)
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)
            context.window_manager.progress_end()
            self.timer = None
        if self.opened:
            context.window.cursor_modal_restore()
            context.workspace.status_text_set(None)

    def cancel(self, context):
        self.leave(context)


class OBJECT_OT_sherd_fracture(Breaking, bpy.types.Operator, Choices):
    """Break the selected mesh objects into closed fragments with sherd"""

    bl_idname = "object.sherd_fracture"
    bl_label = "Sherd Fracture"
    bl_options = {"UNDO"}  # not REGISTER: the panel of the last operation would run it again while Blender waits

    preview: BoolProperty(name="Preview", default=False, options={"SKIP_SAVE"},
                          description="Break at a low resolution, without rigid bodies; the next run replaces it")
    impact_point: FloatVectorProperty(name="Impact Point", subtype="XYZ", options={"HIDDEN", "SKIP_SAVE"})


class OBJECT_OT_sherd_glue(bpy.types.Operator):
    """Set the strength of the glue of the selected pieces"""

    bl_idname = "object.sherd_glue"
    bl_label = "Set Glue Strength"
    bl_options = {"REGISTER", "UNDO"}

    strength: FloatProperty(name="Strength", default=10000.0, min=0.0, soft_max=1000000.0,
                            description="Impulse over the area of contact, N s per square meter, in a step of the solver")

    def execute(self, context):
        changed = set_strength(context, self.strength)
        if not changed:
            self.report({"ERROR"}, "no glued piece is selected")
            return {"CANCELLED"}
        self.report({"INFO"}, f"strength of {changed} constraints is set")
        return {"FINISHED"}
