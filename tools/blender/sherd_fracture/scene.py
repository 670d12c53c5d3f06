# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Collections, names and rigid bodies."""
import bpy


def home(context, thing):
    """The collection of the view layer that holds an object."""
    def shown(layer):
        if not layer.exclude:
            yield layer.collection
        for child in layer.children:
            yield from shown(child)
    return next((c for c in shown(context.view_layer.layer_collection) if thing in c.objects[:]),
                context.scene.collection)


def make_rigid(context, fragments, density, asleep):
    """Makes the fragments, which are the selection, active rigid bodies.  Returns False if the scene does not allow any."""
    scene = context.scene
    try:
        if scene.rigidbody_world is None:
            bpy.ops.rigidbody.world_add()
        bpy.ops.rigidbody.objects_add(type="ACTIVE")
    except RuntimeError:
        return False
    for thing in fragments:
        body = thing.rigid_body
        if body is None:
            return False
        body.collision_shape = "CONVEX_HULL"
        body.use_margin, body.collision_margin = True, 0.0
        body.mass = density * thing["sherd_volume"]
        body.use_deactivation = body.use_start_deactivated = asleep
    return True


def limited(name, room):
    """A name truncated so that `room` more bytes fit into Blender's 63."""
    return name.encode()[:63 - room].decode(errors="ignore")
