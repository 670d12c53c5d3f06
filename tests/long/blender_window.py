#!/usr/bin/python3
"""The Blender add-on in Blender's window, on a virtual screen: the panel is drawn, Break is pressed, Esc, undo.

usage: blender_window.py SHERD [FOLDER]    (a minute; FOLDER gets the screenshots.  Debian's blender, xvfb, xdotool, imagemagick)

The positions are those of Blender 3.4.1 with its factory settings in a window of 1280 x 800 pixels.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ADDON = pathlib.Path(__file__).resolve().parents[2] / "tools" / "blender" / "sherd_fracture"
TAB, VIEW = (1044, 244), (400, 600)
# In Blender: opens the sidebar, and writes what the scene has to a file five times a second.
SCRIPT = '''
import bpy, json, os, sys
sherd, state = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.preferences.addon_enable(module="sherd_fracture")
bpy.context.preferences.addons["sherd_fracture"].preferences.binary = sherd
bpy.context.preferences.view.show_splash = False
bpy.context.scene.sherd.resolution = 32

def tick():
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "VIEW_3D":
            area.spaces[0].show_region_ui = True
    scene = bpy.context.scene
    facts = {"pieces": sorted(o.name for o in scene.objects if "sherd_fragment" in o), "hidden": [o.name for o in scene.objects if o.hide_get()],
             "glue": len([o for o in scene.objects if "sherd_area" in o])}
    with open(state + ".new", "w") as file:
        json.dump(facts, file)
    os.replace(state + ".new", state)
    return 0.2

bpy.app.timers.register(tick, persistent=True)
'''


class Screen:
    """A virtual screen with Blender in it."""

    def __init__(self, scratch, sherd, pictures):
        self.scratch, self.pictures = scratch, pictures
        self.state_file = scratch / "state.json"
        shutil.copytree(ADDON, scratch / "scripts" / "addons" / "sherd_fracture", ignore=shutil.ignore_patterns("__pycache__"))
        (scratch / "start.py").write_text(SCRIPT)
        reader, writer = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(writer), "-screen", "0", "1280x800x24"], pass_fds=[writer],
                                       stderr=subprocess.DEVNULL)
        os.close(writer)
        number = os.fdopen(reader).readline().strip()
        (scratch / "tmp").mkdir()
        self.environment = {**os.environ, "DISPLAY": f":{number}", "LIBGL_ALWAYS_SOFTWARE": "1", "TMPDIR": str(scratch / "tmp"),
                            "BLENDER_USER_SCRIPTS": str(scratch / "scripts")}
        self.log = open(scratch / "log", "w")
        self.blender = subprocess.Popen(["blender", "--factory-startup", "--window-geometry", "0", "0", "1280", "800", "--python",
                                         scratch / "start.py", "--", sherd, self.state_file], env=self.environment,
                                        stdout=self.log, stderr=subprocess.STDOUT)

    def close(self):
        for each in (self.blender, self.server):
            each.kill()
            each.wait()
        self.log.close()

    def send(self, *words):
        subprocess.run(["xdotool", *map(str, words)], env=self.environment, check=True)
        time.sleep(0.3)

    def click(self, place):
        self.send("mousemove", *place)
        self.send("click", 1)

    def picture(self, name):
        """A screenshot's path."""
        path = self.pictures / f"{name}.png"
        subprocess.run(["import", "-window", "root", path], env=self.environment, check=True)
        return path

    def state(self):
        return json.loads(self.state_file.read_text()) if self.state_file.exists() else None

    def until(self, reached, what, seconds=120):
        end = time.monotonic() + seconds
        while not reached():
            if time.monotonic() > end or self.blender.poll() is not None:
                sys.exit(f"blender_window.py: {what}: {self.state()}\n" + (self.scratch / "log").read_text())
            time.sleep(0.3)


def colors(path, box):
    """How many colors a part of a screenshot has."""
    done = subprocess.run(["identify", "-format", "%k", f"{path}[{box}]"], capture_output=True, text=True, check=True)
    return int(done.stdout)


def slow(scratch, sherd):
    """A program that reports progress, and is sherd once a file is gone."""
    hold, pid, path = scratch / "hold", scratch / "pid", scratch / "slow"
    hold.touch()
    path.write_text(f"""#!/bin/sh
echo $$ > {pid}
echo '{{"stage": "grow", "fraction": 0.5, "overall": 0.4}}' >&2
while [ -e {hold} ]; do sleep 0.1; done
exec {sherd} "$@"
""")
    path.chmod(0o755)
    return path, hold, pid


def main():
    sherd = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="sherd-window-") as folder:
        scratch = pathlib.Path(folder)
        pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else scratch
        program, hold, pid = slow(scratch, sherd)
        screen = Screen(scratch, program, pictures)
        try:
            use(screen, hold, pid)
        finally:
            screen.close()


def use(screen, hold, pid):
    screen.until(lambda: screen.state() and colors(screen.picture("start"), "1280x800+0+0") > 1000, "nothing is drawn")
    time.sleep(2)
    screen.click(TAB)
    time.sleep(2)
    panel = screen.picture("panel")
    assert colors(panel, "190x20+840+567") > 20, "no buttons where they were"
    button = 976, 577
    before = screen.state()
    assert before == {"pieces": [], "hidden": [], "glue": 0}, before

    screen.click(button)
    screen.until(pid.exists, "Break starts no program")
    time.sleep(5)
    running = screen.picture("running")
    assert colors(running, "600x20+0+780") > colors(panel, "600x20+0+780"), "the status bar says nothing"
    screen.send("mousemove", *VIEW)
    screen.send("key", "ctrl+z")  # is not for now
    screen.send("key", "Escape")
    screen.until(lambda: not pathlib.Path("/proc", pid.read_text().strip()).exists(), "Esc does not end the program", 20)
    time.sleep(1)
    assert screen.state() == before, screen.state()
    assert not [p for p in (screen.scratch / "tmp").iterdir() if p.name.startswith("sherd")], "files are left"

    hold.unlink()
    screen.click(button)
    screen.until(lambda: len(screen.state()["pieces"]) == 8 and screen.state()["hidden"].count("Cube"), "no pieces")
    time.sleep(8)  # drawing by the processor is slow
    screen.picture("broken")
    assert screen.state()["glue"] > 7, screen.state()
    screen.send("mousemove", *VIEW)
    screen.send("key", "ctrl+z")
    screen.until(lambda: screen.state() == before, "one undo does not take it back", 20)
    screen.send("key", "ctrl+shift+z")
    screen.until(lambda: len(screen.state()["pieces"]) == 8, "redo", 20)
    print("panel, Break, progress, Esc, undo and redo in a window: as they should be")


if __name__ == "__main__":
    main()
