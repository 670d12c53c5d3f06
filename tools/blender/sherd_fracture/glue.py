# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Breakable constraints between pieces that touch: an empty each, which holds an impulse of strength times area."""
import bpy
import numpy as np
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

from .hulls import corners_of, overlap, overlapping
from .physics import world_of
from .scene import limited


def contacts_of(manifest):
    """Pairs of ids, the lower first, with the area and the center of their contact."""
    for entry in manifest["fragments"]:
        for contact in entry.get("contacts", []) + entry.get("thin_contacts", []):
            if contact["id"] > entry["id"]:
                yield entry["id"], contact["id"], contact["area"], contact["centroid"]


def join(world, collection, one, other, area, place, strength):
    """A breakable constraint between two pieces."""
    empty = bpy.data.objects.new(limited(f"{one.name} - {other.name}", 0), None)
    empty.empty_display_type, empty.empty_display_size = "PLAIN_AXES", max(area, 1e-12) ** 0.5 / 4
    empty.location = place
    empty["sherd_area"] = area
    collection.objects.link(empty)
    world.constraints.objects.link(empty)
    constraint = empty.rigid_body_constraint
    constraint.type = "FIXED"
    constraint.object1, constraint.object2 = one, other
    constraint.disable_collisions = True
    constraint.use_breaking, constraint.breaking_threshold = True, strength * area
    return empty


def glue(context, above, pieces, manifest, strength, moved):
    """Joins all pieces that touch, in a collection of their own; a generator with a stop after each.  Pieces whose hulls
    overlap would push each other although they do not touch: they are joined as weakly as the weaker of them is anywhere.
    moved: the matrix from the manifest's space to the world.
    """
    collection = bpy.data.collections.new(limited(above.name, 5) + " glue")
    collection["sherd_glue"] = True
    above.children.link(collection)
    of = {piece["sherd_fragment"]: piece for piece in pieces}
    joined, least = set(), {}
    for one, other, area, place in contacts_of(manifest):
        if one in of and other in of:
            join(world_of(context), collection, of[one], of[other], area, moved @ Vector(place), strength)
            joined.add((one, other))
            for each in (one, other):
                least[each] = min(area, least.get(each, area))
            yield
    if pieces[0].rigid_body.collision_shape != "CONVEX_HULL":
        return
    at = {number: corners_of(piece, piece.matrix_basis) for number, piece in of.items() if number in least}
    for one, other in overlapping(at, joined):
        if other:
            place = (of[one].location + of[other].location) / 2
            hold_apart(world_of(context), collection, of[one], of[other], min(least[one], least[other]), place, strength)
        yield


def hold_apart(world, collection, one, other, area, place, strength):
    """Joins pieces that do not touch, whose hulls overlap."""
    join(world, collection, one, other, area, place, strength)["sherd_apart"] = True


def set_strength(context, strength):
    """Sets the strength of the glue of the selected pieces.  Returns the number of constraints."""
    chosen, changed = set(context.selected_objects), 0
    for empty in joints(context.scene.rigidbody_world):
        constraint = empty.rigid_body_constraint
        if chosen & {empty, constraint.object1, constraint.object2}:
            constraint.breaking_threshold = strength * empty["sherd_area"]
            changed += 1
    return changed


def joints(world):
    """The constraints that Sherd made."""
    found = world.constraints.objects[:] if world and world.constraints else []
    return [empty for empty in found if empty.rigid_body_constraint and "sherd_area" in empty]


def prune(context):
    """Removes constraints whose pieces were deleted, and collections that are empty after it."""
    there = set(context.scene.objects)
    for empty in joints(context.scene.rigidbody_world):
        if not {empty.rigid_body_constraint.object1, empty.rigid_body_constraint.object2} <= there:
            remove(context, empty)


def remove(context, empty):
    """Removes a constraint from its scene.  The object itself stays, without a user, until the file is closed: Bullet's
    constraint, which exists since the simulation ran, would be read again when the simulation goes on, and its end reads
    bodies, those of deleted pieces too (Blender 4.5 ends with a segmentation fault in both cases).
    """
    empty.rigid_body_constraint.enabled = False
    world = context.scene.rigidbody_world
    if world and world.constraints and empty in world.constraints.objects[:]:
        world.constraints.objects.unlink(empty)
    for each in empty.users_collection:
        each.objects.unlink(empty)
        if each.get("sherd_glue") and not each.objects[:]:
            bpy.data.collections.remove(each)


def placed(thing, depsgraph):
    """Vertices in world space and triangles of a mesh object, as modifiers and the simulation leave it."""
    evaluated = thing.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        mesh.calc_loop_triangles()
        at = np.empty((len(mesh.vertices), 3), np.float32)
        triangles = np.empty((len(mesh.loop_triangles), 3), np.int32)
        mesh.vertices.foreach_get("co", at.ravel())
        mesh.loop_triangles.foreach_get("vertices", triangles.ravel())
        matrix = np.array(evaluated.matrix_world, float)
    finally:
        evaluated.to_mesh_clear()
    return at @ matrix[:3, :3].T + matrix[:3, 3], triangles


def touching(piece, other, reach, depsgraph):
    """Area and center of what a piece shares with another object: its triangles that lie within `reach` of the other's,
    which face the other way."""
    at, triangles = placed(piece, depsgraph)
    other_at, other_triangles = placed(other, depsgraph)
    if not len(triangles) or not len(other_triangles):
        return 0.0, None
    corners = at[triangles]
    middles = corners.mean(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    near = ((corners.max(axis=1) >= other_at.min(axis=0) - reach) &
            (corners.min(axis=1) <= other_at.max(axis=0) + reach)).all(axis=1)
    tree = BVHTree.FromPolygons(other_at.tolist(), other_triangles.tolist(), all_triangles=True)
    total, moment = 0.0, np.zeros(3)
    for i in np.flatnonzero(near):
        place, normal, _, _ = tree.find_nearest(Vector(middles[i]), reach)
        area = -normal.dot(Vector(normals[i])) if place is not None else 0  # across the other's surface, which may be smoother
        if area > np.linalg.norm(normals[i]) / 2:
            total, moment = total + area, moment + area * middles[i]
    return total, moment / total if total else None


def move(context, old, pieces, reach):
    """Moves the constraints of a piece that was broken again to those of its pieces that touch the other side.  Returns
    how many contacts were replaced, and how many were removed, because no piece touches."""
    moved = lost = 0
    found = [empty for empty in joints(context.scene.rigidbody_world)
             if old in (empty.rigid_body_constraint.object1, empty.rigid_body_constraint.object2)]
    if found:
        context.view_layer.update()  # places the pieces
    for empty in found:
        constraint = empty.rigid_body_constraint
        other = constraint.object2 if constraint.object1 == old else constraint.object1
        touch = replace(context, empty, other, pieces, reach) if other else 0
        if "sherd_apart" not in empty:
            moved, lost = moved + bool(touch), lost + (not touch)
        remove(context, empty)
    return moved, lost


def replace(context, empty, other, pieces, reach):
    """Joins pieces to the other side of a constraint.  Returns how many of them touch it."""
    world, depsgraph = context.scene.rigidbody_world, context.evaluated_depsgraph_get()
    area = empty["sherd_area"]
    strength = empty.rigid_body_constraint.breaking_threshold / max(area, 1e-30)
    collection = next((c for c in empty.users_collection if c.get("sherd_glue")), context.scene.collection)
    touch = {}
    for piece in pieces:
        shared, place = touching(piece, other, reach, depsgraph)
        if shared > 1e-3 * area:
            touch[piece] = join(world, collection, piece, other, shared, place, strength)
    least = min([joint["sherd_area"] for joint in touch.values()], default=area)
    for piece in pieces:
        if (piece not in touch and piece.rigid_body.collision_shape == "CONVEX_HULL" and
                overlap(corners_of(piece, piece.matrix_world), corners_of(other, other.matrix_world))):
            place = (piece.matrix_world.translation + other.matrix_world.translation) / 2
            hold_apart(world, collection, piece, other, least, place, strength)
    return len(touch)
