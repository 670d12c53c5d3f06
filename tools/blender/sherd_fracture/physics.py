# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The world of rigid bodies, and pieces as bodies in it."""
import bpy

SUBSTEPS, ITERATIONS = 10, 30  # of a world that is made here: with 10 iterations glue of many pieces sags


def world_of(context):
    """The world of rigid bodies, with its two collections; made if the scene has none.  None if the scene allows none."""
    scene = context.scene
    if scene.rigidbody_world is None:
        try:
            bpy.ops.rigidbody.world_add()
        except RuntimeError:
            return None
        scene.rigidbody_world.substeps_per_frame = SUBSTEPS
        scene.rigidbody_world.solver_iterations = ITERATIONS
    world = scene.rigidbody_world
    world.collection = world.collection or bpy.data.collections.new("RigidBodyWorld")
    world.constraints = world.constraints or bpy.data.collections.new("RigidBodyConstraints")
    return world


def remove_world(context):
    """Removes the world with its collections."""
    world = context.scene.rigidbody_world
    if world:
        collections = [each for each in (world.collection, world.constraints) if each]
        bpy.ops.rigidbody.world_remove()
        for each in collections:
            bpy.data.collections.remove(each)


def make_body(world, piece, choices):
    """Makes a piece an active rigid body."""
    world.collection.objects.link(piece)
    body = piece.rigid_body
    body.type = "ACTIVE"
    body.collision_shape = choices.shape
    body.use_margin, body.collision_margin = True, 0.0
    body.mass = choices.density * piece["sherd_volume"]
    body.use_deactivation = body.use_start_deactivated = choices.asleep


def leave_world(context, thing):
    """Removes an object from the world: it would still push its pieces."""
    world = context.scene.rigidbody_world
    if thing.rigid_body and world and world.collection and thing in world.collection.objects[:]:
        world.collection.objects.unlink(thing)
