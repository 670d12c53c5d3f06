#!/usr/bin/python3
"""The manifests that the C++ tests of this ctest run wrote are as docs/manifest.schema.json has them.

usage: unit_manifests_test.py prepare|check FOLDER

tests/temp_folder.h copies them into FOLDER, which SHERD_TEST_MANIFESTS names to the tests.
"""
import json
import pathlib
import shutil
import sys

import manifests


def main():
    step, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    if step == "prepare":
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        return 0
    checked = status = 0
    for file in sorted(folder.glob("*.json")):
        manifest = json.loads(file.read_text())
        if "source" not in manifest:  # written by a test itself, of only what that test needs
            continue
        checked += 1
        faults = manifests.faults_of(manifest)
        if faults:
            print(f"{file}: {faults[:3]}", file=sys.stderr)
            status = 1
    print(f"{checked} manifests")
    return status


if __name__ == "__main__":
    sys.exit(main())
