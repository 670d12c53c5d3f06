#!/usr/bin/python3
"""Make the extension's zip from the add-on and a wheel of the Python module.

usage: extension_zip.py WHEEL PATCHELF WORK OUT

WORK is an empty folder for the files of the wheel that the zip holds: `sherd_program/bin/sherd`, and in
`sherd_program/lib` the libraries that it needs, which find each other there.  Same input, same bytes.
"""
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile

ADDON = pathlib.Path(__file__).resolve().parent / "sherd_fracture"
NAME = "sherd_program"
EPOCH = (1980, 1, 1, 0, 0, 0)


def needed_by(path):
    shown = subprocess.run(["readelf", "-d", path], capture_output=True, text=True, check=True).stdout
    return re.findall(r"\(NEEDED\).*\[(.*)\]", shown)


def take_program(wheel, patchelf, folder):
    """Takes the program, the libraries that it needs, and their licenses out of a wheel.  Returns the wheel's version and
    platform."""
    raw = folder / "raw"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(raw)
    version, platform = re.fullmatch(r"pysherd-([^-]+)-[^-]+-[^-]+-(\w+)\.whl", wheel.name).groups()
    libraries = {path.name: path for path in [*raw.glob("pysherd.libs/*"), raw / "pysherd" / "libsherd.so"]}
    root = folder / NAME
    (root / "bin").mkdir(parents=True)
    (root / "lib").mkdir()
    program = root / "bin" / "sherd"
    shutil.move(raw / "pysherd" / "bin" / "sherd", program)
    program.chmod(0o755)
    waiting = needed_by(program)
    while waiting:
        name = waiting.pop()
        path = root / "lib" / name
        if name in libraries and not path.exists():
            shutil.move(libraries[name], path)
            waiting += needed_by(path)
    subprocess.run([patchelf, "--set-rpath", "$ORIGIN/../lib", program], check=True)
    for path in (root / "lib").iterdir():
        found = subprocess.run([patchelf, "--print-rpath", path], capture_output=True, text=True, check=True).stdout
        if found.strip() not in ("", "$ORIGIN"):  # those that auditwheel has edited are as they must be
            subprocess.run([patchelf, "--set-rpath", "$ORIGIN", path], check=True)
    shutil.move(raw / "pysherd" / "licenses", root / "licenses")
    for unused in ("libassimp5", "libminizip1"):  # of the reader of formats that the add-on does not use
        (root / "licenses" / (unused + ".txt")).unlink(missing_ok=True)
    for text in raw.glob("pysherd-*.dist-info/licenses/*"):
        shutil.move(text, root / "licenses" / text.name)
    shutil.rmtree(raw)
    return version, platform


def add(archive, name, data, executable=False):
    entry = zipfile.ZipInfo(name, EPOCH)
    entry.external_attr = (0o100755 if executable else 0o100644) << 16
    archive.writestr(entry, data, zipfile.ZIP_DEFLATED, 9)


def write_wheel(folder, version, platform):
    """Writes a wheel of the files in NAME that every Python 3 of the platform accepts; returns its path."""
    tag, info = f"py3-none-{platform}", f"{NAME}-{version}.dist-info"
    path = folder / f"{NAME}-{version}-{tag}.whl"
    record = []
    with zipfile.ZipFile(path, "w") as archive:
        def put(name, data, executable=False):
            add(archive, name, data, executable)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(data)}\n")

        for file in sorted(p for p in (folder / NAME).rglob("*") if p.is_file()):
            put(file.relative_to(folder).as_posix(), file.read_bytes(), os.access(file, os.X_OK))
        put(f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {NAME}\nVersion: {version}\nSummary: The program sherd and its "
            "libraries, for its add-on of Blender\nRequires-Python: >=3\n".encode())
        put(f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: sherd\nRoot-Is-Purelib: true\nTag: {tag}\n".encode())
        add(archive, f"{info}/RECORD", "".join([*record, f"{info}/RECORD,,\n"]).encode())
    return path


def write_extension(wheel, out):
    text = (ADDON / "blender_manifest.toml").read_text()
    head, table, rest = text.partition("[permissions]")
    text = f'{head}wheels = ["./wheels/{wheel.name}"]\n\n{table}{rest}'
    manifest = tomllib.loads(text)
    path = out / f"{manifest['id']}-{manifest['version']}.zip"
    with zipfile.ZipFile(path, "w") as archive:
        add(archive, "blender_manifest.toml", text.encode())
        for file in sorted(ADDON.glob("*.py")):
            add(archive, file.name, file.read_bytes())
        add(archive, f"wheels/{wheel.name}", wheel.read_bytes())
    return path


def main():
    wheel, patchelf, work, out = sys.argv[1:]
    work = pathlib.Path(work)
    work.mkdir()
    made = write_wheel(work, *take_program(pathlib.Path(wheel), patchelf, work))
    path = write_extension(made, pathlib.Path(out))
    print(f"{path}: {path.stat().st_size / 1e6:.1f} MB")


main()
