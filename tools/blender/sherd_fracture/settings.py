# Copyright (C) 2026 The Sherd authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of a fracture."""
import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty


class Choices:
    """The options: stored with the scene for the panel, and with each run for the operator."""

    pieces: IntProperty(name="Pieces", description="Number of fragments", default=8, min=1, max=65534, soft_max=200)
    resolution: IntProperty(name="Resolution", description="Voxels along the longest side of the object's box",
                            default=96, min=8, max=4096, soft_max=256)
    seed: IntProperty(name="Seed", description="Seed of every random choice: the same seed, the same fragments",
                      default=0, min=0)
    material: EnumProperty(name="Material", description="Break as a material does; what is changed below overrides it",
                           default="NONE", items=[
        ("NONE", "None", "Cracks are planes"), ("CERAMIC", "Ceramic", "Fine grain"), ("STONE", "Stone", "Craggy"),
        ("GLASS", "Glass", "Long, pointed shards"), ("TEMPERED", "Tempered Glass", "Breaks everywhere at once"),
        ("PLASTER", "Plaster", "Crumbled edges"), ("WOOD", "Wood", "Splinters along Y"),
        ("CONCRETE", "Concrete", "Small bumps, crumbled"), ("ICE", "Ice", "Smooth waves")])
    growth: EnumProperty(name="Growth", description="Growth of fragments from their seeds", default="AUTO", items=[
        ("AUTO", "By Material", "That of the material; without one Euclid"),
        ("EUCLID", "Euclid", "Nearest seed; disconnected voxels are regrown"),
        ("NEAREST", "Nearest", "Nearest seed, ignoring gaps"),
        ("CHAIN", "Chain", "Over voxel faces in the order of the distance to the seed"),
        ("FLOOD", "Flood", "Layer by layer"),
        ("SEQUENTIAL", "Sequential", "Split after split, in order: a crack ends at an older one")])
    surface: EnumProperty(name="Surface", description="The outside of fragments", default="AUTO", items=[
        ("AUTO", "Automatic", "The object's own faces, cut by the cracks; the smooth surface where that fails"),
        ("SMOOTH", "Smooth", "A new surface, from voxels")])
    levels: IntProperty(name="Levels", description="Splits of sequential growth that are shown as nested collections",
                        default=0, min=0, max=16)
    roughness: FloatProperty(name="Roughness", description="Rms height of cracks in voxels; 0: that of the material, or planar",
                             default=0.0, min=0.0, max=100.0, soft_max=3.0)
    wear: IntProperty(name="Wear", default=0, min=0, max=1000, soft_max=10, description="Iterations of erosion of the "
                      "outermost layer of cracks; 0: those of the material, or none")
    weight_group: StringProperty(name="Weight", description="Vertex group, painted where pieces are to be small; empty: none")
    impact: EnumProperty(name="Impact", description="Position of an impact, with small fragments around it", default="NONE",
                         items=[("NONE", "None", "No impact"), ("CURSOR", "3D Cursor", "At the 3D cursor"),
                                ("MOUSE", "Under the Mouse", "Where you click on the object")])
    impact_pieces: IntProperty(name="Impact Pieces", description="Number of fragments around the impact",
                               default=4, min=1, max=65534, soft_max=100)
    impact_spread: FloatProperty(name="Impact Spread", unit="LENGTH", default=0.0, min=0.0,
                                 description="Standard deviation of its seeds from the impact; 0: Sherd's default")
    inside_material: StringProperty(name="Inside", description="Material of cracks; empty: 'Sherd inside'")
    rigid_body: BoolProperty(name="Rigid Bodies", description="Make the fragments active rigid bodies", default=True)
    shape: EnumProperty(name="Shape", description="Collision shape of the rigid bodies", default="CONVEX_HULL", items=[
        ("CONVEX_HULL", "Convex Hull", "Fast and stable; hulls of hollow pieces overlap"),
        ("MESH", "Mesh", "The piece itself; slower")])
    density: FloatProperty(name="Density", description="Mass over volume, for the rigid bodies", default=1000.0,
                           min=0.000001, soft_max=10000.0)
    asleep: BoolProperty(name="Rest Until Hit", default=False,
                         description="Rigid bodies rest until another body touches them")
    glue: BoolProperty(name="Glue", default=True,
                       description="Join pieces that touch by constraints, which break under load")
    strength: FloatProperty(name="Strength", default=10000.0, min=0.0, soft_max=1000000.0, description=
                            "Impulse that glue holds over the area of contact, N s per square meter, in a step of the solver")
    original: EnumProperty(name="Original", description="The source object after the fracture", default="HIDE", items=[
        ("HIDE", "Hide", "Hide it, and remove it from the rigid body world"), ("KEEP", "Keep", "Leave it unchanged")])
    folder: StringProperty(name="Keep Files", description="Folder for Sherd's files; empty: files are not kept",
                           subtype="DIR_PATH")


NAMES = list(Choices.__annotations__)


class SherdSettings(bpy.types.PropertyGroup, Choices):
    """The options of the panel."""
