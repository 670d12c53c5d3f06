#!/usr/bin/python3
"""A dataset's report in headless Chromium: everything is drawn, nothing is fetched, nothing sticks out.

usage: report.py SHERD [PICTURE.png]     (needs Debian's chromium; the picture is of the whole page)
"""
import html
import json
import os
import re
import subprocess
import sys
import tempfile

# What the browser makes of the page, reported in its title.
PROBE = """<script>
addEventListener('load', () => {
  const box = e => e.getBoundingClientRect();
  const texts = [...document.querySelectorAll('svg text')];
  document.title = JSON.stringify({
    pictures: [...document.images].map(i => i.complete ? i.naturalWidth : 0),
    charts: [...document.querySelectorAll('svg')].map(s => s.querySelectorAll('rect, line').length),
    outside: texts.filter(t => { const a = box(t), b = box(t.closest('svg'));
      return a.left < b.left - 1 || a.right > b.right + 1 || a.bottom > b.bottom + 1; }).map(t => t.textContent),
    width: [document.documentElement.scrollWidth, innerWidth],
    headings: [...document.querySelectorAll('h2')].map(h => h.textContent),
    fetched: performance.getEntriesByType('resource').map(r => r.name).filter(n => !n.startsWith('data:')),
  });
});
</script>"""


def chromium(folder, *arguments):
    run = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/profile",
                          "--host-resolver-rules=MAP * ~NOTFOUND", "--window-size=1280,3000", *arguments],
                         capture_output=True, text=True, timeout=120)
    assert run.returncode == 0, run.stderr
    return run.stdout


def main():
    sherd = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        out = f"{folder}/out"
        subprocess.run([sherd, "dataset", "data", "-o", out, "--match", "*.ply", "--resolution", "48", "--pieces", "2..6",
                        "--repeats", "3..2", "--points", "64"], check=True, capture_output=True)
        report = f"{out}/report.html"
        with open(report, encoding="utf-8") as file:
            text = file.read()
        probed = f"{folder}/probed.html"
        with open(probed, "w", encoding="utf-8") as file:
            file.write(text.replace("</body>", PROBE + "</body>"))
        dom = chromium(folder, "--virtual-time-budget=5000", "--dump-dom", f"file://{probed}")
        seen = json.loads(html.unescape(re.search("<title>(.*?)</title>", dom, re.S).group(1)))
        assert seen["pictures"] and set(seen["pictures"]) == {200}, seen["pictures"]
        assert len(seen["charts"]) == 3 + 4 + 1 and min(seen["charts"]) > 3, seen["charts"]
        assert not seen["outside"], seen["outside"]
        assert seen["width"][0] <= seen["width"][1], seen["width"]
        assert not seen["fetched"], seen["fetched"]
        assert seen["headings"] == ["Objects and fractures", "Details", "Fragments", "Time and resources", "Storage",
                                    "Failures"], seen["headings"]
        picture = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else f"{folder}/report.png"
        chromium(folder, f"--screenshot={picture}", f"file://{report}")
        assert os.path.getsize(picture) > 50_000
        print(f"report: {len(seen['pictures'])} pictures and {len(seen['charts'])} charts are drawn, nothing is fetched")


if __name__ == "__main__":
    main()
