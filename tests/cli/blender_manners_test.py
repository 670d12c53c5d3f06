#!/usr/bin/python3
"""How the Blender add-on behaves: several objects, events, Esc, undo, previews, and what it reports.

There is no window here, so the operator gets events and a context of the test's own; tests/long/blender_window.py has a window.

Environment: as blender_test.py.
"""
import json
import os
import unittest

import numpy as np

import blender_test
import skipping

# An operator whose events and reports the test sees.
PRELUDE = blender_test.ADDON + '''
import inspect, pathlib, time, types
import sherd_fracture
from sherd_fracture import operator, settings

class Context:
    """Blender's, but for what needs a window."""
    def __init__(self):
        self.texts, self.timers, self.progress, self.cursors = [], [], [], []
        self.window = types.SimpleNamespace(cursor_modal_set=self.cursors.append,
                                            cursor_modal_restore=self.cursors.clear)
        self.workspace = types.SimpleNamespace(status_text_set=self.texts.append)
        self.window_manager = types.SimpleNamespace(
            event_timer_add=lambda *_, **__: self.timers.append(1) or 1, event_timer_remove=self.timers.remove,
            progress_begin=lambda *_: None, progress_update=self.progress.append, progress_end=lambda: None,
            modal_handler_add=lambda _: None)

    def __getattr__(self, name):
        return getattr(bpy.context, name)

class Operator(operator.Breaking):
    def __init__(self, **options):
        defaults = {name: each.keywords.get("default") for name, each in settings.Choices.__annotations__.items()}
        vars(self).update(defaults, preview=False, reports=[], seen=Context())
        vars(self).update(options)
        self.properties = types.SimpleNamespace(is_property_set=lambda name: name in options)

    def report(self, kind, text):
        self.reports.append([min(kind), text])

    def event(self, kind, value="PRESS"):
        return sorted(self.modal(self.seen, types.SimpleNamespace(type=kind, value=value, mouse_x=0, mouse_y=0)))

    def until(self, reached=lambda batch: False):
        """Timer events until something is reached or the end.  Returns the last answer."""
        last, started = ["RUNNING_MODAL"], time.monotonic()
        while last == ["RUNNING_MODAL"] and not reached(self.batch):
            assert time.monotonic() < started + 60
            last = self.event("TIMER")
            time.sleep(0.002)
        return last

def run(**options):
    made = Operator(**{"pieces": 3, "resolution": 24, **options})
    return sorted(made.execute(bpy.context)), made.reports

def state():
    return {**{kind: sorted(getattr(bpy.data, kind).keys()) for kind in ("objects", "meshes", "collections")},
            "world": bpy.context.scene.rigidbody_world is not None,
            "hidden": sorted(o.name for o in bpy.context.scene.objects if o.hide_get() or o.hide_render),
            "selected": sorted(o.name for o in bpy.context.selected_objects)}

def several(*things):
    bpy.ops.object.select_all(action="DESELECT")
    for thing in things:
        thing.select_set(True)
    bpy.context.view_layer.objects.active = things[0]
'''


@skipping.skip_unless(blender_test.BLENDER, "BLENDER", "no Blender here (BLENDER_BIN)")
class Manners(blender_test.Blender):
    def run_addon(self, script, *more):
        return self.blender(PRELUDE + script, *more)

    def test_events_break_two_objects_and_report_those_that_fail(self):
        sherd = os.path.abspath(blender_test.SHERD)
        slow = self.fake("slow", f"""echo '{{"stage": "grow", "fraction": 0.5, "overall": 0.4}}' >&2; sleep 0.5; exec {sherd} "$@" """)
        reported = self.run_addon('''
preferences.binary = sys.argv[-1]
bpy.ops.mesh.primitive_uv_sphere_add(location=(5, 0, 0))
ball = bpy.context.active_object
void = bpy.data.objects.new("Void", bpy.data.meshes.new("Void"))
bpy.context.collection.objects.link(void)
several(ball, void, cube, bpy.data.objects["Light"])
made = Operator(pieces=40, resolution=24)
begun = made.open(made.seen)
passed = {kind: made.event(kind) for kind in ("MOUSEMOVE", "MIDDLEMOUSE", "WHEELUPMOUSE", "Z", "X", "LEFTMOUSE")}
slowest, end = 0, ["RUNNING_MODAL"]
while end == ["RUNNING_MODAL"]:
    started = time.monotonic()
    end = made.event("TIMER")
    slowest = max(slowest, time.monotonic() - started)
    time.sleep(0.01)
names = {o.name: [c.name for c in o.users_collection if not c.name.startswith("Rigid")] for o in bpy.context.selected_objects}
answer(begun=list(begun), passed=passed, end=end, slowest=slowest, reports=made.reports, texts=made.seen.texts,
       timers=made.seen.timers, progress=made.seen.progress, cursors=made.seen.cursors, names=names)
''', slow)
        self.assertEqual((reported["begun"], reported["end"]), (["RUNNING_MODAL"], ["FINISHED"]))
        self.assertEqual({kind: reported["passed"][kind] == ["PASS_THROUGH"] for kind in reported["passed"]},
                         {"MOUSEMOVE": True, "MIDDLEMOUSE": True, "WHEELUPMOUSE": True, "Z": False, "X": False, "LEFTMOUSE": False})
        self.assertEqual(reported["names"], {f"{name}_{i:03d}": [name] for name in ("Cube", "Sphere") for i in range(1, 41)})
        warnings = " ".join(text for kind, text in reported["reports"] if kind == "WARNING")
        self.assertIn("Light is of type light", warnings)
        self.assertIn("Void has no faces", warnings)
        self.assertEqual(reported["reports"][-1], ["INFO", "80 fragments of 2 objects; 1 of 3 objects failed"])
        texts = reported["texts"]
        self.assertIsNone(texts[-1])
        self.assertTrue(any("Cube (" in t and "grow" in t and "of 3" in t for t in texts[:-1]), texts)
        self.assertTrue(any("of 40 fragments in Blender" in t for t in texts[:-1]), texts)
        self.assertEqual(reported["progress"], sorted(reported["progress"]))
        self.assertGreater(len(set(reported["progress"])), 5)
        self.assertEqual((reported["timers"], reported["cursors"]), ([], []))
        self.assertLess(reported["slowest"], 2)  # 80 fragments take longer; a busy machine is slow

    def test_the_status_bar_has_the_stages_of_sherd(self):
        reported = self.run_addon('''
made = Operator(pieces=3, resolution=160, roughness=1.0)
made.open(made.seen)
made.until()
answer(texts=made.seen.texts, progress=made.seen.progress)
''')
        stages = {text.split(": ")[1].split(",")[0] for text in reported["texts"][:-1] if "fragments" not in text}
        self.assertGreaterEqual(len(stages & {"read", "voxelize", "grow", "cut", "extract", "write"}), 2, stages)
        self.assertEqual(reported["progress"], sorted(reported["progress"]))
        self.assertGreater(len({share for share in reported["progress"] if share < 80}), 2)

    def test_a_click_strikes_the_object_under_the_mouse(self):
        """A view from above, 200 by 100 pixels for 8 by 4 units about 0, of two cubes side by side."""
        reported = self.run_addon('''
import mathutils
lens = mathutils.Matrix(((1 / 4, 0, 0, 0), (0, 1 / 2, 0, 0), (0, 0, -1 / 50, 0), (0, 0, 0, 1)))
view = mathutils.Matrix.Translation((0, 0, -10))
seen = types.SimpleNamespace(is_perspective=False, view_matrix=view, window_matrix=lens, view_perspective="ORTHO",
                             perspective_matrix=lens @ view)
region = types.SimpleNamespace(type="WINDOW", x=0, y=0, width=200, height=100, data=seen)
cube.location.x = -2
bpy.ops.mesh.primitive_cube_add(location=(2, 0, 0))
other = bpy.context.active_object
several(cube, other)
bpy.context.view_layer.update()
made = Operator(pieces=12, resolution=32, impact="MOUSE", impact_pieces=8, impact_spread=0.1, original="KEEP", rigid_body=False)
made.seen.area = types.SimpleNamespace(type="VIEW_3D", regions=[region])
made.open(made.seen)
def click(x, y):
    event = types.SimpleNamespace(type="LEFTMOUSE", value="PRESS", mouse_x=x, mouse_y=y)
    return sorted(made.modal(made.seen, event))
turned = made.event("MIDDLEMOUSE")
missed = click(100, 50), made.reports[-1]
hit = click(172, 70)  # 2.88, 0.8
end = made.until()
answer(turned=turned, missed=missed, hit=hit, end=end, other=[p.location for p in bpy.context.selected_objects if p.location.x > 0],
       cube=[p.location for p in bpy.context.selected_objects if p.location.x < 0])
''')
        self.assertEqual((reported["turned"], reported["hit"], reported["end"]), (["PASS_THROUGH"], ["RUNNING_MODAL"], ["FINISHED"]))
        self.assertEqual(reported["missed"], [["RUNNING_MODAL"], ["WARNING", "the click missed the object"]])
        near = [sum(np.linalg.norm(np.subtract(reported[name], corner), axis=1) < 0.8)
                for name, corner in (("other", (2.88, 0.8, 1)), ("cube", (-1.12, 0.8, 1)))]
        self.assertEqual([len(reported[name]) for name in ("other", "cube")], [12, 12])
        self.assertGreaterEqual(near[0], near[1] + 3, near)

    def test_esc_at_any_time_leaves_nothing(self):
        slow = self.fake("slow", f"echo $$ > {self.tmp}/pid; exec sleep 60")
        reported = self.run_addon('''
operator.EVERY = 0  # one step for each event
before, found = state(), {}
def stopped(case, reached, **options):
    made = Operator(**{"pieces": 3, "resolution": 24, **options})
    made.seen.area = types.SimpleNamespace(type="VIEW_3D", regions=[])
    made.open(made.seen)
    made.until(reached)
    found[case] = {"answer": made.event("ESC"), "same": state() == before, "timers": made.seen.timers, "text": made.seen.texts[-1],
                   "reports": made.reports}
stopped("before the click", lambda batch: True, impact="MOUSE")
stopped("at once", lambda batch: True)
preferences.binary = sys.argv[-1]
pid = pathlib.Path(sys.argv[-1]).with_name("pid")
stopped("sherd runs", lambda batch: batch.job and pid.exists() and pid.read_text().strip())
preferences.binary = SHERD
found["sherd runs"]["ended"] = not pathlib.Path("/proc", pid.read_text().strip()).exists()
stopped("fragments", lambda batch: batch.job and len(batch.job.fragments) == 2)
stopped("bodies", lambda batch: bpy.context.scene.rigidbody_world)
stopped("glue", lambda batch: any("sherd_area" in o for o in bpy.data.objects))
stopped("preview", lambda batch: batch.job and len(batch.job.fragments) == 2, preview=True)
answer(**found)
''', slow)
        for case, found in reported.items():
            with self.subTest(case):
                self.assertEqual((found["answer"], found["same"], found["timers"], found["text"]), (["CANCELLED"], True, [], None))
                self.assertEqual(found["reports"], [["INFO", "no fracture"]])
        self.assertTrue(reported["sherd runs"]["ended"])

    def test_esc_keeps_what_is_done_and_undo_takes_it_back(self):
        reported = self.run_addon('''
bpy.ops.mesh.primitive_uv_sphere_add(location=(5, 0, 0))
ball = bpy.context.active_object
several(cube, ball)
made = Operator(pieces=3, resolution=24)
made.open(made.seen)
made.until(lambda batch: len(batch.done) == 1)
kept = made.event("ESC"), sorted(o.name for o in bpy.context.selected_objects), made.reports[-1]
bpy.ops.wm.read_factory_settings()
bpy.ops.preferences.addon_enable(module="sherd_fracture")
bpy.context.preferences.addons["sherd_fracture"].preferences.binary = SHERD
bpy.ops.mesh.primitive_uv_sphere_add(location=(5, 0, 0))
several(bpy.data.objects["Cube"], bpy.context.active_object)
bpy.ops.ed.undo_push(message="before")
before = state()
bpy.ops.object.sherd_fracture("EXEC_DEFAULT", True, pieces=4, resolution=24, growth="SEQUENTIAL", levels=2)
broken = state()
bpy.ops.ed.undo()
undone = state()
bpy.ops.ed.redo()
redone = state()
only(bpy.data.objects["Cube_001"])
bpy.ops.ed.undo_push(message="chosen")
chosen = state()
bpy.ops.object.sherd_fracture("EXEC_DEFAULT", True, pieces=2, resolution=24)
bpy.ops.ed.undo()
again = state()
answer(kept=kept, before=before, broken=broken, undone=undone, redone=redone, chosen=chosen, again=again)
''')
        answer, selected, last = reported["kept"]
        self.assertEqual((answer, len(selected)), (["FINISHED"], 3))
        self.assertEqual(len({name.split("_")[0] for name in selected}), 1)
        self.assertIn("3 fragments of", last[1])
        self.assertIn("Sphere_004", reported["broken"]["objects"])
        self.assertEqual(reported["undone"], reported["before"])
        self.assertEqual(reported["redone"], reported["broken"])
        self.assertEqual(reported["again"], reported["chosen"])

    def test_a_scene_that_changes_meanwhile(self):
        """Scripts may undo and remove while the operator runs: a sentence, and no crash."""
        reported = self.run_addon('''
operator.EVERY = 0
found = {}
bpy.ops.ed.undo_push(message="one")
bpy.context.view_layer.objects.active.location.x = 1
bpy.ops.ed.undo_push(message="two")
made = Operator(pieces=3, resolution=24)
made.open(made.seen)
made.until(lambda batch: batch.job and len(batch.job.fragments) == 2)
bpy.ops.ed.undo()
found["undo"] = made.until(), made.reports
cube = bpy.data.objects["Cube"]
only(cube)
made = Operator(pieces=3, resolution=24)
made.open(made.seen)
made.until(lambda batch: batch.job and batch.job.process)
bpy.data.objects.remove(cube)
found["remove"] = made.until(), made.reports
answer(left=sorted(o.name for o in bpy.data.objects), **found)
''')
        end, reports = reported["undo"]
        self.assertIn(end, (["CANCELLED"], ["FINISHED"]))
        if end == ["CANCELLED"]:
            self.assertRegex(reports[-1][1], "undo|gone")
        end, reports = reported["remove"]
        self.assertEqual(end, ["CANCELLED"])
        self.assertRegex(reports[-1][1], "Cube is gone")

    def test_the_final_matches_its_preview(self):
        """Volumes of the pieces of planar cracks agree within 1 % of the object's."""
        reported = self.run_addon('''
def volumes():
    return {p["sherd_fragment"]: p["sherd_volume"] for p in bpy.context.selected_objects}
found = {}
for growth in ("AUTO", "SEQUENTIAL"):
    cube = bpy.data.objects["Cube"]
    cube.hide_set(False)
    only(cube)
    run(pieces=8, resolution=96, seed=3, growth=growth, preview=True)
    previewed = [o.name for o in bpy.context.selected_objects]
    preview = volumes(), cube.hide_get(), bpy.context.scene.rigidbody_world is not None
    run(pieces=8, resolution=96, seed=4, growth=growth, preview=True)  # its pieces are selected, and so it is replaced
    count = len([o for o in bpy.data.objects if "sherd_fragment" in o])
    several(bpy.context.selected_objects[0])
    run(pieces=8, resolution=96, seed=3, growth=growth, rigid_body=False)
    final = volumes()
    names = sorted(o.name for o in bpy.data.objects if "sherd_fragment" in o)
    found[growth] = dict(preview=preview, count=count, final=final, names=names, previewed=previewed)
    sherd_fracture.scene.discard(bpy.context.selected_objects[0].users_collection[0])
answer(**found)
''')
        for growth, found in reported.items():
            with self.subTest(growth):
                preview, hidden, world = found["preview"]
                self.assertEqual((hidden, world, found["count"]), (True, False, 8))
                self.assertEqual(found["names"], [f"Cube_00{i}" for i in range(1, 9)])
                self.assertEqual(found["previewed"], [f"Cube_00{i} preview" for i in range(1, 9)])
                self.assertEqual(set(preview), set(found["final"]))
                for number, volume in found["final"].items():
                    self.assertLess(abs(volume - preview[number]), 0.01 * 8)
                    self.assertGreater(volume, 0.02 * 8)

    def test_painted_weight_makes_small_pieces(self):
        """Of a cube's right half, 1 on most of its surface and 0.05 on the left: some nine in ten seeds."""
        kept = self.tmp / "kept"
        reported = self.run_addon('''
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.subdivide(number_cuts=5)
bpy.ops.object.mode_set(mode="OBJECT")
group = cube.vertex_groups.new(name="small here")
cube.vertex_groups.new(name="empty")
group.add([v.index for v in cube.data.vertices if v.co.x > 0], 1.0, "REPLACE")
def centers(**options):
    only(cube)
    result = run(pieces=30, original="KEEP", rigid_body=False, **options)
    return [p.location.x for p in bpy.context.selected_objects], result
answer(plain=centers(), painted=centers(weight_group="small here", folder=sys.argv[-1]), split=centers(weight_group="small here", growth="SEQUENTIAL"),
       empty=centers(weight_group="empty"), absent=centers(weight_group="nothing"))
''', kept)
        right = {case: sum(x > 0 for x in reported[case][0]) for case in ("plain", "painted", "split")}
        self.assertGreater(min(right["painted"], right["split"]), right["plain"] + 5, right)
        seeds = [f["seeds"][0][0] for f in json.loads((kept / "manifest.json").read_text())["fragments"]]
        self.assertGreater(sum(x > 0 for x in seeds), 22)
        self.assertRegex(reported["empty"][1][1][-1][1], "vertex group 'empty' of Cube has no weight")
        self.assertRegex(reported["absent"][1][1][-1][1], "Cube has no vertex group 'nothing'")

    def test_a_material_decides_what_the_artist_left(self):
        kept = self.tmp / "kept"
        reported = self.run_addon('''
from sherd_fracture.job import options
def words(**changed):
    return options(Operator(**changed), None, False)
run(material="STONE", resolution=32, folder=sys.argv[-1], wear=1)
answer(plain=words(), ceramic=words(material="CERAMIC"), both=words(material="CERAMIC", growth="EUCLID", roughness=2.0),
       preview=words(preview=True, resolution=200, roughness=2.0))
''', kept)
        self.assertFalse({"--material", "--growth", "--roughness", "--erode-iterations"} & set(reported["plain"]))
        self.assertIn("ceramic", reported["ceramic"])
        self.assertNotIn("--growth", reported["ceramic"])
        self.assertEqual(reported["both"][-6:], ["--material", "ceramic", "--growth", "euclid", "--roughness", "2"])
        self.assertEqual(reported["preview"][-2:], ["--roughness", "1%"])
        manifest = json.loads((kept / "manifest.json").read_text())["options"]
        self.assertEqual((manifest["material"], manifest["grow"]["growth"], manifest["erode"]["iterations"]),
                         ("stone", "sequential", 1))

    def test_the_report_has_a_sentence_for_each_repair(self):
        reported = self.run_addon('''
found = {}
def broken(case, thing, **options):
    only(thing)
    found[case] = run(**options)[1]
bpy.ops.mesh.primitive_monkey_add()
broken("open", bpy.context.active_object)
bpy.ops.mesh.primitive_grid_add()
broken("sheet", bpy.context.active_object)
bpy.ops.mesh.primitive_cube_add(location=(0, 0, 0))
first = bpy.context.active_object
bpy.ops.mesh.primitive_cube_add(location=(5, 0, 0))
several(first, bpy.context.active_object)
bpy.ops.object.join()
broken("two", first, pieces=1)
broken("sound", cube)
answer(**found)
''')
        says = {case: " ".join(text for kind, text in found if kind == "WARNING") for case, found in reported.items()}
        self.assertIn("Suzanne has 42 open edges; its holes were filled", says["open"])
        self.assertRegex(says["sheet"], "Grid encloses nothing and became a shell 0.2.* thick")
        self.assertRegex(says["two"], "has 2 separate parts, and so more pieces than the 1 asked for")
        self.assertEqual(says["sound"], "")

    def test_linked_and_instanced_objects(self):
        reported = self.run_addon('''
twin = bpy.data.objects.new("Twin", cube.data)
twin.location, twin.scale = (6, 0, 0), (0.5, 1, 2)
bpy.context.collection.objects.link(twin)
path = sys.argv[-1]
bpy.data.libraries.write(path, {cube})
several(cube, twin)
run()
places = {p.name: measures(p) for p in bpy.context.selected_objects}
for o in list(bpy.data.objects):
    bpy.data.objects.remove(o)
with bpy.data.libraries.load(path, link=True) as (there, here):
    here.objects = ["Cube"]
bpy.context.scene.collection.objects.link(here.objects[0])
bpy.context.view_layer.update()
only(here.objects[0])
linked = run(), [(p.name, p.library is None) for p in bpy.context.selected_objects], here.objects[0].hide_get()
empty = bpy.data.objects.new("Copy", None)
empty.instance_type, empty.instance_collection = "COLLECTION", bpy.data.collections.new("some")
bpy.context.scene.collection.objects.link(empty)
only(empty)
answer(places=places, linked=linked, instance=run())
''', self.tmp / "library.blend")
        for name, low, high in (("Cube", (-1, -1, -1), (1, 1, 1)), ("Twin", (5.5, -1, -2), (6.5, 1, 2))):
            pieces = [p for key, p in reported["places"].items() if key.startswith(name)]
            self.assertEqual(len(pieces), 3)
            np.testing.assert_allclose(np.min([p["low"] for p in pieces], axis=0), low, atol=1e-5)
            np.testing.assert_allclose(np.max([p["high"] for p in pieces], axis=0), high, atol=1e-5)
        (answer, reports), names, hidden = reported["linked"]
        self.assertEqual((answer, names, hidden), (["FINISHED"], [[f"Cube_00{i}", True] for i in (1, 2, 3)], True), reports)
        self.assertRegex(reported["instance"][1][0][1], "Copy is an instance of a collection; make it real first")


if __name__ == "__main__":
    skipping.main()
