# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects are broken: the selected ones, and those whose preview is selected."""
import bpy
from bpy_extras import view3d_utils

from .failure import Failure
from .scene import key_of

CONVERTIBLE = ("CURVE", "SURFACE", "META", "FONT")


def flaw(thing):
    """Why an object is not broken, as a sentence, or None."""
    if thing.type == "EMPTY" and thing.instance_collection:
        return f"{thing.name} is an instance of a collection; make it real first (Object > Apply > Make Instances Real)"
    if thing.type != "MESH":
        hint = "convert it first (Object > Convert)" if thing.type in CONVERTIBLE else "select a mesh object"
        return f"{thing.name} is of type {thing.type.lower()}, not a mesh; {hint}"
    if thing.mode != "OBJECT":
        return f"{thing.name} is in {thing.mode.lower()} mode; leave it first (Tab)"
    return None


def previewed(thing):
    """The object that a piece of a preview is of, or None."""
    source = next((each["sherd_preview"] for each in bpy.data.collections
                   if each.get("sherd_preview") and thing in each.all_objects[:]), None)
    return bpy.data.objects.get(source) if source else None


def targets(context):
    """Keys of the objects to break, see scene.key_of(), and sentences about those that are left out."""
    keys, left = [], []
    for thing in context.selected_objects:
        thing = previewed(thing) or thing
        reason = flaw(thing)
        if reason:
            left.append(reason)
        elif key_of(thing) not in keys:
            keys.append(key_of(thing))
    if not keys:
        raise Failure(left[0] if left else "nothing is selected; select the mesh object to break")
    return keys, left


def point_under(context, region, view, at, thing):
    """First intersection of the ray through a pixel with an object, in world space, or None."""
    start = view3d_utils.region_2d_to_origin_3d(region, view, at)
    along = view3d_utils.region_2d_to_vector_3d(region, view, at)
    evaluated = thing.evaluated_get(context.evaluated_depsgraph_get())
    local = evaluated.matrix_world.inverted_safe()
    hit, position, _, _ = evaluated.ray_cast(local @ start, local.to_3x3() @ along)
    return evaluated.matrix_world @ position if hit else None


def first_under(context, event, keys):
    """Of these objects the one under the mouse that is nearest to the eye, and the point; None, None beside all."""
    for region in context.area.regions:
        at = event.mouse_x - region.x, event.mouse_y - region.y
        if region.type != "WINDOW" or not (0 <= at[0] < region.width and 0 <= at[1] < region.height):
            continue
        eye = view3d_utils.region_2d_to_origin_3d(region, region.data, at)
        hits = [(key, point_under(context, region, region.data, at, bpy.data.objects[key])) for key in keys]
        hits = [(key, position) for key, position in hits if position]
        return min(hits, key=lambda hit: (hit[1] - eye).length, default=(None, None))
    return None, None
