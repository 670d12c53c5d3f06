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
    growth: EnumProperty(name="Growth", description="Growth of fragments from their seeds", default="EUCLID", items=[
        ("EUCLID", "Euclid", "Nearest seed; disconnected voxels are regrown"),
        ("NEAREST", "Nearest", "Nearest seed, ignoring gaps"),
        ("CHAIN", "Chain", "Over voxel faces in the order of the distance to the seed"),
        ("FLOOD", "Flood", "Layer by layer")])
    roughness: FloatProperty(name="Roughness", description="Rms height of cracks in voxels; 0 is planar",
                             default=0.0, min=0.0, max=100.0, soft_max=3.0)
    wear: IntProperty(name="Wear", description="Iterations of erosion of the outermost layer of cracks", default=0, min=0,
                      max=1000, soft_max=10)
    impact: EnumProperty(name="Impact", description="Position of an impact, with small fragments around it", default="NONE",
                         items=[("NONE", "None", "No impact"), ("CURSOR", "3D Cursor", "At the 3D cursor"),
                                ("MOUSE", "Under the Mouse", "Where you click on the object")])
    impact_pieces: IntProperty(name="Impact Pieces", description="Number of fragments around the impact",
                               default=4, min=1, max=65534, soft_max=100)
    impact_spread: FloatProperty(name="Impact Spread", unit="LENGTH", default=0.0, min=0.0,
                                 description="Standard deviation of its seeds from the impact; 0: Sherd's default")
    inside_material: StringProperty(name="Inside", description="Material of cracks; empty: 'Sherd inside'")
    rigid_body: BoolProperty(name="Rigid Bodies", description="Make the fragments active rigid bodies", default=True)
    asleep: BoolProperty(name="Rest Until Hit", default=False,
                         description="Rigid bodies rest until another body touches them")
    density: FloatProperty(name="Density", description="Mass over volume, for the rigid bodies", default=1000.0,
                           min=0.000001, soft_max=10000.0)
    original: EnumProperty(name="Original", description="The source object after the fracture", default="HIDE", items=[
        ("HIDE", "Hide", "Hide it, and remove it from the rigid body world"), ("KEEP", "Keep", "Leave it unchanged")])
    folder: StringProperty(name="Keep Files", description="Folder for Sherd's files; empty: files are not kept",
                           subtype="DIR_PATH")


NAMES = list(Choices.__annotations__)


class SherdSettings(bpy.types.PropertyGroup, Choices):
    """The options of the panel."""
