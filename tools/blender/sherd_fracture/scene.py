# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Collections and names."""
import bpy


def key_of(thing):
    """What finds an object in bpy.data.objects: its name, and the file of its library or None."""
    return thing.name, thing.library.filepath if thing.library else None


def homes(context, thing):
    """The collections of the view layer that hold an object."""
    def shown(layer):
        if not layer.exclude and not layer.collection.library:
            yield layer.collection
        for child in layer.children:
            yield from shown(child)
    found = dict.fromkeys(c for c in shown(context.view_layer.layer_collection) if thing in c.objects[:])
    return list(found) or [context.scene.collection]


def discard(collection):
    """Removes a fracture: its pieces with their meshes, its glue, and the collections that hold them."""
    if collection is None:
        return
    for thing in sorted(collection.all_objects[:], key=lambda thing: "sherd_area" not in thing):  # glue first: it has pieces
        if "sherd_fragment" not in thing and "sherd_area" not in thing:  # the user's
            if thing.name not in bpy.context.scene.collection.objects:
                bpy.context.scene.collection.objects.link(thing)
            continue
        mesh = thing.data
        bpy.data.objects.remove(thing)
        if mesh and not mesh.users:
            bpy.data.meshes.remove(mesh)
    for each in [*collection.children_recursive, collection]:
        bpy.data.collections.remove(each)


def discard_previews(name):
    """Removes the previews of an object."""
    for collection in [each for each in bpy.data.collections if each.get("sherd_preview") == name]:
        discard(collection)


def select(context, names):
    """Selects objects and nothing else; the first one is active."""
    for thing in context.selected_objects:  # not view_layer.objects: Blender may rebuild what is iterated there, and crashes
        thing.select_set(False)
    there = {thing.name: thing for thing in context.view_layer.objects[:] if thing}
    found = [there[name] for name in names if name in there]
    for thing in found:
        thing.select_set(True)
    if found:
        context.view_layer.objects.active = found[0]


def limited(name, room):
    """A name truncated so that `room` more bytes fit into Blender's 63."""
    return name.encode()[:63 - room].decode(errors="ignore")


def file_name(name):
    """A name for a file or folder of an object: letters, digits and -_. of its name, of at most 63 bytes."""
    return limited("".join(c if c.isalnum() or c in "-_." else "_" for c in name), 0)
