#!/usr/bin/python3
"""The Blender add-on's rigid bodies, glue, re-broken pieces and levels, in Blender's own simulation.

Environment: as blender_test.py.
"""
import itertools
import json
import unittest

import numpy as np

import blender_test
import skipping

# Scenes of a cube of side 2 and its pieces, simulated.
PRELUDE = blender_test.ADDON + '''
import itertools

def fresh(height=0.0, floor=False):
    """A new scene with a cube that is selected."""
    bpy.ops.scene.new(type="EMPTY")
    if floor:
        bpy.ops.rigidbody.world_add()
        bpy.ops.mesh.primitive_plane_add(size=40)
        bpy.ops.rigidbody.object_add(type="PASSIVE")
    bpy.ops.mesh.primitive_cube_add(location=(0, 0, height))
    bpy.context.scene.use_gravity = floor
    return bpy.context.active_object

def broken(**options):
    bpy.ops.object.sherd_fracture(**{"pieces": 8, "resolution": 32, "seed": 3, **options})
    return bpy.context.selected_objects

def distances(pieces):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    at = np.array([p.evaluated_get(depsgraph).matrix_world.translation for p in pieces])
    return np.linalg.norm(at[:, None] - at[None], axis=2)

def change(pieces, frames):
    """The greatest change of a mutual distance within some frames, in sides of the cube."""
    bpy.context.scene.frame_set(1)
    first, most = distances(pieces), 0.0
    for frame in range(2, frames + 1):
        bpy.context.scene.frame_set(frame)
        most = max(most, np.abs(distances(pieces) - first).max() / 2)
    return most

def joints():
    """Names of the ends, area, threshold and place of each constraint of the scene."""
    world = bpy.context.scene.rigidbody_world
    found = []
    for empty in world.constraints.objects:
        c = empty.rigid_body_constraint
        found.append({"ends": [c.object1 and c.object1.name, c.object2 and c.object2.name], "type": c.type,
                      "area": empty["sherd_area"], "threshold": c.breaking_threshold, "breaks": c.use_breaking,
                      "collide": not c.disable_collisions, "place": empty.location,
                      "collections": sorted(k.name for k in empty.users_collection)})
    return found
'''


@skipping.skip_unless(blender_test.BLENDER, "BLENDER", "no Blender here (BLENDER_BIN)")
class Physics(blender_test.Blender):
    def run_addon(self, script, *more):
        return self.blender(PRELUDE + script, *more)

    def test_glue_holds_without_gravity_and_breaks_in_a_fall(self):
        reported = self.run_addon('''
fresh(); glued = change(broken(), 60)
fresh(); meshes = change(broken(shape="MESH"), 60)
fresh(); loose = change(broken(glue=False), 60)
fresh(3.0, True); strong = change(broken(strength=1e5), 40)
fresh(3.0, True); weak = change(broken(strength=1e3), 40)
answer(glued=glued, meshes=meshes, loose=loose, strong=strong, weak=weak)
''')
        for held in ("glued", "meshes", "strong"):
            self.assertLess(reported[held], 0.01, reported)
        for parted in ("loose", "weak"):
            self.assertGreater(reported[parted], 0.1, reported)

    def test_hulls_that_overlap_do_not_push(self):
        """A monkey's pieces reach around one another.  Without the constraints between those that do not touch it bursts."""
        reported = self.run_addon('''
def monkey():
    fresh()
    bpy.ops.object.delete()
    bpy.ops.mesh.primitive_monkey_add()
    return broken(pieces=40, resolution=48, seed=5, material="STONE", strength=300)
held = change(monkey(), 12)
pieces = monkey()
apart = [o for o in bpy.context.scene.objects if "sherd_apart" in o]
ends = [[o.rigid_body_constraint.object1.name, o.rigid_body_constraint.object2.name] for o in apart]
names = {p["sherd_fragment"]: p.name for p in pieces}
touch = [[p.name, names[n]] for p in pieces for n in {f.value for f in p.data.attributes["neighbor"].data} if n]
for o in apart:
    bpy.data.objects.remove(o)
answer(held=held, burst=change(pieces, 12), ends=ends, touch=touch)
''')
        self.assertLess(reported["held"], 0.01)
        self.assertGreater(reported["burst"], 0.03)
        self.assertFalse({frozenset(pair) for pair in reported["ends"]} & {frozenset(pair) for pair in reported["touch"]})

    def test_glue_is_as_strong_as_contacts_are_large(self):
        reported = self.run_addon('''
fresh()
pieces = broken(strength=500.0, shape="MESH", density=300.0)
first = joints()
only(pieces[0])
bpy.ops.object.sherd_glue(strength=7.0)
answer(pieces=[look(p) for p in pieces], joints=first, again=joints(), chosen=pieces[0].name)
''')
        area, moment = {}, {}
        for f in reported["pieces"]:
            kind, shape, mass = f["body"]
            self.assertEqual((kind, shape), ("ACTIVE", "MESH"))
            self.assertAlmostEqual(mass / (300 * f["volume"]), 1, delta=1e-4)
            faces, middles, neighbor = (np.array(f[key]) for key in ("area", "middles", "neighbor"))
            for other in np.unique(neighbor[neighbor > 0]):
                pair = f["properties"]["sherd_fragment"], int(other)
                part = neighbor == other
                area[pair] = faces[part].sum()
                moment[pair] = faces[part] @ middles[part] / area[pair]
        names = {f["properties"]["sherd_fragment"]: f["name"] for f in reported["pieces"]}
        joints = {tuple(sorted(j["ends"])): j for j in reported["joints"]}
        self.assertEqual(len(joints), len(reported["joints"]))
        self.assertEqual(set(joints), {tuple(sorted((names[a], names[b]))) for a, b in area})
        for (one, other), shared in area.items():
            joint = joints[tuple(sorted((names[one], names[other])))]
            self.assertEqual((joint["type"], joint["breaks"], joint["collide"]), ("FIXED", True, False))
            self.assertAlmostEqual(joint["threshold"] / (500 * shared), 1, delta=1e-3)
            np.testing.assert_allclose(joint["place"], moment[one, other], atol=1e-3)
        for joint in reported["again"]:  # set anew for one piece
            strength = joint["threshold"] / joint["area"]
            self.assertAlmostEqual(strength, 7 if reported["chosen"] in joint["ends"] else 500, places=3)
        for joint in joints.values():
            self.assertTrue(any(name.endswith(" glue") for name in joint["collections"]))

    def test_a_world_that_is_there_keeps_its_settings(self):
        reported = self.run_addon('''
fresh(3.0, True)
bpy.context.scene.rigidbody_world.substeps_per_frame = 3
bpy.context.scene.rigidbody_world.solver_iterations = 7
broken(pieces=2)
there = bpy.context.scene.rigidbody_world
old = [there.substeps_per_frame, there.solver_iterations]
fresh()
broken(pieces=2)
new = bpy.context.scene.rigidbody_world
answer(old=old, new=[new.substeps_per_frame, new.solver_iterations])
''')
        self.assertEqual(reported["old"], [3, 7])
        self.assertGreaterEqual(reported["new"][1], 10)

    def test_a_piece_that_breaks_again_keeps_its_glue(self):
        """Its neighbors are glued to those of its pieces that touch them, over the same area; nothing dangles."""
        reported = self.run_addon('''
cube = fresh()
pieces = broken()
before = joints()
names = {j for pair in before for j in pair["ends"]}
chosen = max(names, key=lambda name: bpy.data.objects[name]["sherd_volume"])
only(bpy.data.objects[chosen])
parts = broken(pieces=4)
after = joints()
bodies = [o for o in bpy.context.scene.objects if o.rigid_body and o.visible_get()]
held = change(bodies, 30)
bpy.context.scene.frame_set(1)
gone = next(n for n in sorted(names) if n != chosen)
bpy.data.objects.remove(bpy.data.objects[gone])
other = next(n for n in sorted(names) if n not in (chosen, gone))
only(bpy.data.objects[other])
broken(pieces=2, rigid_body=False)
plain = joints()
answer(before=before, after=after, chosen=chosen, parts=[p.name for p in parts], held=held, gone=gone, other=other, plain=plain,
       bodies=len(bodies), homes=[[c.name for c in p.users_collection] for p in parts],
       level=[p["sherd_level"] for p in parts],
       below=[c.name for k in bpy.data.collections for c in k.children if c.name == chosen])
''')
        chosen, parts = reported["chosen"], set(reported["parts"])
        old = {next(e for e in j["ends"] if e != chosen): j["area"] for j in reported["before"] if chosen in j["ends"]}
        ends = {end for j in reported["after"] for end in j["ends"]}
        self.assertNotIn(chosen, ends)
        self.assertNotIn(None, ends)
        self.assertGreater(len(old), 2)
        for other, area in old.items():
            new = [j for j in reported["after"] if other in j["ends"] and parts & set(j["ends"])]
            self.assertAlmostEqual(sum(j["area"] for j in new) / area, 1, delta=0.03)
            for j in new:
                self.assertAlmostEqual(j["threshold"] / j["area"], 10000, delta=1)
        self.assertTrue(any(len([j for j in reported["after"] if other in j["ends"] and parts & set(j["ends"])]) > 1
                            for other in old), "some neighbor touches two of the new pieces")
        self.assertEqual(reported["bodies"], 7 + 4)
        self.assertLess(reported["held"], 0.01)
        self.assertEqual(reported["level"], [2] * 4)
        self.assertEqual(reported["below"], [chosen])
        ends = {end for j in reported["plain"] for end in j["ends"]}
        self.assertFalse(ends & {None, reported["gone"], reported["other"]})

    def test_the_simulation_goes_on_after_a_piece_is_broken_again(self):
        """Between frames, with bodies and constraints that Bullet has: nothing that it holds may be freed."""
        reported = self.run_addon('''
fresh()
pieces = broken()
change(pieces, 8)
names = sorted(p.name for p in pieces)
only(bpy.data.objects[names[1]])
parts = broken(pieces=3)
again = [p.name for p in parts]
for frame in range(9, 20):
    bpy.context.scene.frame_set(frame)
bodies = [o for o in bpy.context.scene.objects if o.rigid_body and o.visible_get()]
held = change(bodies, 8)
answer(again=again, held=held, ends=[e for j in joints() for e in j["ends"]], chosen=names[1],
       shown=[o.name for o in bpy.context.scene.objects if "sherd_area" in o])
''')
        self.assertEqual(len(reported["again"]), 3)
        self.assertLess(reported["held"], 0.01)
        self.assertFalse({None, reported["chosen"]} & set(reported["ends"]))
        self.assertEqual(len(reported["shown"]), len(reported["ends"]) // 2)

    def test_levels_of_sequential_growth(self):
        kept = self.tmp / "kept"
        reported = self.run_addon('''
fresh()
pieces = broken(growth="SEQUENTIAL", levels=2, folder=sys.argv[-1])
def tree(collection):
    return {"objects": sorted(o["sherd_fragment"] for o in collection.objects if "sherd_fragment" in o),
            "children": {c.name: tree(c) for c in collection.children if not c.get("sherd_glue")}}
answer(pieces=[{"id": p["sherd_fragment"], "depth": p["sherd_level"], "parent": p["sherd_parent"],
                **{name: [f.value for f in p.data.attributes[name].data] for name in ("piece", "neighbor", "level", "inside")},
                "name": p.name} for p in pieces],
       tree=tree(next(c for c in bpy.context.scene.collection.children if not c.name.startswith("Rigid"))))
''', kept)
        manifest = json.loads((kept / "manifest.json").read_text())
        splits = {s["id"]: s for s in manifest["splits"]}
        split = {f["id"]: f["split"] for f in manifest["fragments"]}

        def halves(s):
            """The fragments of a split's piece."""
            return sorted(f for f in split if s in ancestors(f))

        def ancestors(fragment):
            at, found = split[fragment], []
            while at:
                found.append(at)
                at = splits[at]["parent"]
            return found
        for p in reported["pieces"]:
            self.assertEqual((p["depth"], p["parent"]), (splits[split[p["id"]]]["level"], split[p["id"]]))
            self.assertEqual(set(p["piece"]), {p["id"]})
            self.assertEqual(p["inside"], [n > 0 for n in p["neighbor"]])
            for neighbor, level in zip(p["neighbor"], p["level"]):
                common = set(ancestors(p["id"])) & set(ancestors(neighbor)) if neighbor else ()
                self.assertEqual(level, max((splits[s]["level"] for s in common), default=0))

        def below(tree):
            return sorted(tree["objects"] + list(itertools.chain(*map(below, tree["children"].values()))))

        def check(tree, level):
            found = sorted(below(child) for child in tree["children"].values())
            here = below(tree)
            self.assertEqual(found, sorted(halves(s) for s in splits if splits[s]["level"] == level + 1
                                           and level < 3 and halves(s)[0] in here))
            for child in tree["children"].values():
                check(child, level + 1)
        self.assertEqual(below(reported["tree"]), sorted(split))
        check(reported["tree"], 1)


if __name__ == "__main__":
    skipping.main()
