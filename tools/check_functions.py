#!/usr/bin/env python3
"""Functions of more than 60 lines: prints them and fails.

Universal Ctags finds the functions of src, include, kernels, python, tests and tools, in a second.  (clang-tidy's readability-function-size needs minutes, since it compiles
every file, and cannot read kernels.)
"""
import json
import pathlib
import subprocess
import sys

MOST = 60
ROOT = pathlib.Path(__file__).parents[1]
tags = subprocess.run(
    ["ctags", "-R", "--output-format=json", "--languages=C++,Python", "--langmap=C++:+.cl", "--kinds-C++=f", "--kinds-Python=fm", "--fields=+ne", "-f", "-",
     "src", "include", "kernels", "python", "tests", "tools"],
    cwd=ROOT, stdout=subprocess.PIPE, check=True, text=True).stdout
functions = [json.loads(line) for line in tags.splitlines()]
functions = [f for f in functions if "end" in f]
if len(functions) < 1000:
    sys.exit(f"ctags finds {len(functions)} functions only")
long = [f for f in functions if f["end"] - f["line"] >= MOST]
for f in sorted(long, key=lambda f: f["line"] - f["end"]):
    print(f"{f['path']}:{f['line']}: {f['name']} has {f['end'] - f['line'] + 1} lines, at most {MOST} are allowed", file=sys.stderr)
sys.exit(bool(long))
