#!/usr/bin/python3
"""Pages of the viewer in headless Chromium, drawn by the processor.

usage: viewer.py SHERD [FOLDER]     (needs Debian's chromium and python3-pil; FOLDER keeps the pictures)
"""
import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
from PIL import Image

from browser import Browser

READY = "document.documentElement.dataset.state === 'ready'"
# Where a piece's center of mass is seen, in CSS pixels.
SEEN = """(() => { const {camera, drawing, radius, rise} = viewer, {clientWidth: w, clientHeight: h} = drawing.canvas;
  const at = transformed(multiply(camera.projection(w / h, radius, rise), camera.view()), add(viewer.centers[%d], viewer.offsets[%d]));
  return [(at[0] / at[3] + 1) * w / 2, (1 - at[1] / at[3]) * h / 2]; })()"""
# A point where a piece is seen, found by looking: the middle of the points of a lattice that show it.
SHOWN = """(() => { const {clientWidth: w, clientHeight: h} = viewer.drawing.canvas, found = {};
  for (let y = 60; y < h - 130; y += 36) for (let x = 20; x < w - 20; x += 36) {
    const i = viewer.drawing.pick(viewer.look(), x, y);
    if (i >= 0 && document.elementFromPoint(x, y).id === 'view') (found[i] ??= []).push([x, y]);
  }
  return Object.entries(found).map(([i, points]) => [Number(i), points[points.length >> 1], points.length]); })()"""
SPEED = """(async () => { const d = viewer.drawing, gl = d.gl, times = [], one = new Uint8Array(4); viewer.isMoving = false;
  for (let i = 0; i < %d; ++i) { viewer.camera.rotate(0.1, 0); const begin = performance.now(); d.draw(viewer.look(), false);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, one); times.push(performance.now() - begin); }
  times.sort((a, b) => a - b); return times[times.length >> 1]; })()"""


def sherd(*arguments):
    done = subprocess.run([SHERD, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def textured_ball(folder, rows=48, columns=96):
    """A ball with a texture and coordinates."""
    y, x = np.mgrid[:512, :512]
    Image.fromarray(np.stack([128 + 100 * np.sin(x / 9), 128 + 100 * np.sin(y / 17), 90 + 0 * x], 2).astype(np.uint8)).save(f"{folder}/stripes.png")
    with open(f"{folder}/ball.mtl", "w") as file:
        file.write("newmtl stripes\nmap_Kd stripes.png\n")
    with open(f"{folder}/ball.obj", "w") as file:
        print("mtllib ball.mtl\nusemtl stripes", file=file)
        for i in range(rows + 1):
            for j in range(columns):
                a, b = np.pi * i / rows, 2 * np.pi * j / columns
                print(f"v {np.sin(a) * np.cos(b)} {np.cos(a)} {np.sin(a) * np.sin(b)}\nvt {j / columns} {i / rows}", file=file)
        for i in range(rows):
            for j in range(columns):
                quad = [i * columns + j + 1, i * columns + (j + 1) % columns + 1, (i + 1) * columns + (j + 1) % columns + 1, (i + 1) * columns + j + 1]
                for triangle in (quad[:3], [quad[0], quad[2], quad[3]]):
                    print("f", *(f"{v}/{v}" for v in triangle), file=file)
    return f"{folder}/ball.obj"


def pixels(browser, name):
    browser.picture(f"{KEPT}/{name}.png")
    return np.asarray(Image.open(f"{KEPT}/{name}.png").convert("RGB")).astype(int)


def quiet(browser, page):
    """Nothing was reported, and nothing asked for but the page."""
    assert browser.problems == [], browser.problems
    assert [r for r in browser.requests if not r.startswith("blob:")] == ["file://" + os.path.abspath(page)], browser.requests


def open_page(browser, page):
    begin = time.monotonic()
    browser.open(page)
    browser.wait(READY, 300)
    return time.monotonic() - begin


def use(browser, page):
    """The slider, clicks, keys and the wheel do what the page says of them."""
    open_page(browser, page)
    whole = pixels(browser, "whole")
    before = browser.evaluate(SEEN % (0, 0))
    box = browser.evaluate("(() => { const b = document.getElementById('explode').getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
    browser.click(box[0] + 0.8 * box[2], box[1] + box[3] / 2)
    assert abs(browser.evaluate("viewer.explode") - 1.6) < 0.1, browser.evaluate("viewer.explode")
    apart = pixels(browser, "apart")
    moved = np.hypot(*np.subtract(browser.evaluate(SEEN % (0, 0)), before))
    assert moved > 10 and (np.abs(apart.astype(int) - whole).max(axis=2) > 20).mean() > 0.05, moved
    browser.evaluate("viewer.setExplode(0.4)")
    shown = browser.evaluate(SHOWN)
    assert len(shown) > 5, shown
    for index, (x, y), _ in shown[:4]:
        browser.click(x, y)
        assert browser.evaluate("viewer.selected") == index
        time.sleep(0.4)  # two clicks within less are a double click
        figures = browser.evaluate("[...document.querySelectorAll('#details > .figures dt')].map(dt => [dt.textContent, dt.nextSibling.textContent])")
        assert {name for name, _ in figures} >= {"Volume", "Share", "Area", "Fracture area", "Faces"}, figures
        volume = float(dict(figures)["Volume"].split()[0].replace("−", "-"))
        assert abs(volume / browser.evaluate(f"viewer.scene.pieces[{index}].volume") - 1) < 1e-3
    browser.evaluate("viewer.select(viewer.scene.indexOfId.get(5)); viewer.setExplode(0.3); document.activeElement.blur()")
    pixels(browser, "viewer")  # docs/images/viewer.png
    # A neighbor in the list selects it.
    other = browser.evaluate("viewer.scene.indexOfId.get(viewer.scene.pieces[viewer.selected].contacts[0][0])")
    browser.evaluate("document.querySelector('.neighbors button').click()")
    assert browser.evaluate("viewer.selected") == other
    pixels(browser, "selected")
    keys(browser)
    x, y = 640, 350
    target = browser.evaluate("viewer.camera.target")
    angle = browser.evaluate("viewer.camera.azimuth")
    browser.drag(x, y, 120, 30)
    assert browser.evaluate("viewer.camera.azimuth") != angle and browser.evaluate("viewer.camera.target") == target
    browser.drag(x, y, 60, 30, button="right")
    assert browser.evaluate("viewer.camera.target") != target
    distance = browser.evaluate("viewer.camera.distance")
    browser.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-120)
    browser.wait(f"viewer.camera.distance < {distance}")
    quiet(browser, page)


def keys(browser):
    browser.key("Escape")
    assert browser.evaluate("viewer.selected") == -1
    for key, expression, value in (("n", "viewer.selected", 0), ("n", "viewer.selected", 1), ("p", "viewer.selected", 0), ("i", "viewer.isIsolated", True),
                                   ("i", "viewer.isIsolated", False), ("e", "viewer.shown.lines", False), ("e", "viewer.shown.lines", True),
                                   ("2", "viewer.mode", "neighbor"), ("3", "viewer.mode", "side"), ("1", "viewer.mode", "piece"),
                                   ("?", "document.getElementById('keys').open", True)):
        browser.key(key)
        assert browser.evaluate(expression) == value, (key, browser.evaluate(expression))
    pixels(browser, "keys")
    browser.evaluate("document.getElementById('keys').close()")
    angle, explode = browser.evaluate("[viewer.camera.azimuth, viewer.explode]")
    browser.key("ArrowLeft")
    browser.key("]")
    after = browser.evaluate("[viewer.camera.azimuth, viewer.explode]")
    assert after[0] < angle and after[1] > explode, (angle, explode, after)
    browser.key("Escape")
    browser.key("0")


def themes(browser, page):
    """Light and dark by preference and by the switch; each mode shows other colors."""
    means = {}
    for scheme in ("light", "dark"):
        browser.prefer(scheme)
        open_page(browser, page)
        means[scheme] = pixels(browser, scheme)[:40, 300:600].mean()
    assert means["light"] > 180 and means["dark"] < 80, means
    browser.key("t")
    assert pixels(browser, "switched")[:40, 300:600].mean() > 180
    seen = set()
    for mode in browser.evaluate("[...document.querySelectorAll('#modes input')].filter(i => !i.parentElement.hidden).map(i => i.value)"):
        browser.evaluate(f"viewer.setMode('{mode}')")
        seen.add(pixels(browser, f"mode-{mode}")[150:600, 300:900].tobytes())
    assert len(seen) == browser.evaluate("[...document.querySelectorAll('#modes input')].filter(i => !i.parentElement.hidden).length") >= 3
    browser.prefer("light")
    quiet(browser, page)


def phone(browser, page):
    browser.size(390, 844, scale=2, phone=True)
    open_page(browser, page)
    index, (x, y), _ = max(browser.evaluate(SHOWN), key=lambda s: s[2])
    browser.touch([(x, y)])
    browser.wait(f"viewer.selected === {index}", 10)
    pixels(browser, "phone")
    # The panel covers nothing of the view that is fitted, and nothing sticks out.
    assert browser.evaluate("document.documentElement.scrollWidth <= innerWidth && document.documentElement.scrollHeight <= innerHeight")
    distance = browser.evaluate("viewer.camera.distance")
    browser.touch([(150, 250), (240, 250)], [(140, 250), (250, 250)], [(110, 250), (280, 250)])
    assert browser.evaluate("viewer.camera.distance") < 0.8 * distance
    assert browser.evaluate("viewer.selected") == index  # a pinch is no tap
    angle = browser.evaluate("viewer.camera.azimuth")
    browser.touch([(150, 250)], [(180, 250)], [(220, 260)])
    assert browser.evaluate("viewer.camera.azimuth") != angle
    quiet(browser, page)
    browser.size(1280, 800)


def printed(browser, page, count):
    open_page(browser, page)
    browser.evaluate("viewer.select(0)")
    browser.pdf(f"{KEPT}/page.pdf")
    with open(f"{KEPT}/page.pdf", "rb") as file:
        assert file.read(5) == b"%PDF-"
    assert os.path.getsize(f"{KEPT}/page.pdf") > 20_000
    assert browser.evaluate("document.querySelectorAll('#table tbody tr').length") == count
    # The picture for paper is no empty one.
    assert browser.evaluate("(() => { const c = document.getElementById('paper'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
                            "let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] === 255; return n / (d.length / 4); })()") > 0.03
    quiet(browser, page)


def without_webgl(page, count):
    with tempfile.TemporaryDirectory() as profile, Browser(profile, gl=False) as browser:
        browser.open(page)
        browser.wait("!document.getElementById('failure').hidden")
        assert "WebGL 2" in browser.evaluate("document.getElementById('failure').innerText")
        assert browser.evaluate("document.querySelectorAll('#table tbody tr').length") == count
        assert browser.evaluate("getComputedStyle(document.getElementById('table')).display") == "block"
        browser.picture(f"{KEPT}/no-webgl.png")
        assert not [p for p in browser.problems if "Error" in p and "WebGL" not in p], browser.problems


def levels(browser, folder):
    sherd("fracture", AMPHORA, "-o", f"{folder}/levels", "--resolution", 96, "--pieces", 12, "--growth", "sequential", "--write", "viewer")
    open_page(browser, f"{folder}/levels/viewer.html")
    browser.key("4")
    counts = []
    for level in range(browser.evaluate("viewer.levels") + 1):
        browser.evaluate(f"viewer.setLevel({level})")
        counts.append(browser.evaluate("viewer.groupCount"))
    assert counts[0] == 1 and counts[-1] == 12 and counts == sorted(counts) and counts[1] == 2, counts
    browser.evaluate("viewer.setLevel(2)")
    pixels(browser, "levels")


def hostile(browser, folder):
    name = "<img src=x onerror=document.title='harm'><script>'.ply"
    with open(AMPHORA, "rb") as file, open(f"{folder}/{name}", "wb") as copy:
        copy.write(file.read())
    sherd("fracture", f"{folder}/{name}", "-o", f"{folder}/hostile", "--resolution", 48, "--pieces", 3, "--write", "mesh")
    with open(f"{folder}/hostile/manifest.json") as file:
        manifest = json.load(file)
    manifest["source"]["file"] += "</script></title><script>document.title='harm'</script>"
    with open(f"{folder}/hostile/manifest.json", "w") as file:
        json.dump(manifest, file)
    sherd("view", f"{folder}/hostile")
    open_page(browser, f"{folder}/hostile.html")
    assert browser.evaluate("document.title") == browser.evaluate("document.querySelector('h1').textContent") == manifest["source"]["file"]
    quiet(browser, f"{folder}/hostile.html")


def large(browser, folder):
    """Seconds to open, milliseconds of a frame: 50 textured pieces of 20,000 faces, and 500 pieces."""
    sherd("fracture", textured_ball(folder), "-o", f"{folder}/fifty", "--resolution", 156, "--pieces", 50, "--write", "viewer")
    sherd("fracture", AMPHORA, "-o", f"{folder}/many", "--resolution", 192, "--pieces", 500, "--write", "viewer")
    for name in ("fifty", "many"):
        page = f"{folder}/{name}/viewer.html"
        seconds = open_page(browser, page)
        faces, textures = browser.evaluate("[viewer.scene.pieces.reduce((n, p) => n + p.faces, 0), viewer.drawing.textures.length]")
        pieces = browser.evaluate("viewer.scene.pieces.length")
        milliseconds = browser.evaluate(SPEED % 9)
        print(f"{pieces} pieces, {faces / pieces:.0f} faces each, {textures} textures: {os.path.getsize(page) / 1e6:.1f} MB, open in {seconds:.1f} s, "
              f"{1000 / milliseconds:.1f} frames per second of 1280 x 800 drawn by the processor")
        index, (x, y), _ = browser.evaluate(SHOWN)[0] if name == "many" else [0, browser.evaluate(SEEN % (0, 0)), 0]
        browser.click(x, y)
        assert browser.evaluate("viewer.selected") >= 0
        if name == "many":
            assert browser.evaluate("viewer.selected") == index and pieces == 500
        else:
            assert textures == 1 and faces / pieces > 19_000
        pixels(browser, name)
        quiet(browser, page)


def main():
    global SHERD, KEPT, AMPHORA
    SHERD, AMPHORA = os.path.abspath(sys.argv[1]), os.path.abspath("data/amphora.ply")
    with tempfile.TemporaryDirectory() as folder:
        KEPT = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else folder
        os.makedirs(KEPT, exist_ok=True)
        sherd("fracture", AMPHORA, "-o", f"{folder}/amphora", "--resolution", 96, "--pieces", 14, "--missing", 2, "--write", "mesh,viewer")
        page = f"{folder}/amphora/viewer.html"
        with tempfile.TemporaryDirectory() as profile, Browser(profile) as browser:
            browser.prefer("light")
            use(browser, page)
            themes(browser, page)
            phone(browser, page)
            printed(browser, page, 14)
            levels(browser, folder)
            hostile(browser, folder)
            large(browser, folder)
        without_webgl(page, 14)
    print("viewer: pages open offline, pieces move and are selected by click, tap and keys, light and dark, on paper, and without WebGL")


if __name__ == "__main__":
    main()
