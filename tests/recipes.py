#!/usr/bin/python3
"""The examples of CONTRIBUTING.md: blocks of code, each behind a sentence that says where it belongs.

    *kernels/columns.cl*, a new file:                      the block is the file
    `include/sherd/labels.h`, before `int balance = 0;`:   ... goes before the one line that has this text, or `after` it
    `src/grow/sized/shares.cpp`, in place of `std::ceil(`:       ... replaces the text, which is there once

usage: recipes.py DOCUMENT FOLDER    write the new files below a folder; those that are there as they are stay untouched
"""
import dataclasses
import pathlib
import re
import sys

BLOCK = re.compile(r"""(?:\*(?P<new>[\w./]+)\*,\sa\snew\sfile
                       |`(?P<file>[\w./]+)`,\s(?P<how>before|after|in\splace\sof)\s`(?P<where>[^`]+)`):\n
                       \n```\w+\n(?P<text>.*?)^```$""", re.S | re.M | re.X)


@dataclasses.dataclass
class Block:
    file: str
    how: str  # "new", "before", "after", "in place of"
    where: str
    text: str


def blocks(document):
    """Every block of the three examples; a block whose sentence is written otherwise is an error."""
    found = []
    for heading, text in re.findall(r"^## (Add .*?)\n(.*?)(?=^## |\Z)", document, flags=re.S | re.M):
        here = [Block(m["new"] or m["file"], "new" if m["new"] else re.sub(r"\s+", " ", m["how"]), m["where"] or "", m["text"]) for m in BLOCK.finditer(text)]
        if 2 * len(here) != len(re.findall(r"^```", text, flags=re.M)):
            raise SystemExit(f"CONTRIBUTING.md, '{heading}': a block has no sentence before it that says where it belongs (tests/recipes.py)")
        found += here
    return found


def edited(source, block):
    """The text of a file with a block in its place."""
    if source.count(block.where) != 1:
        raise SystemExit(f"{block.file}: '{block.where}' is there {source.count(block.where)} times, CONTRIBUTING.md needs it once")
    if block.how == "in place of":
        return source.replace(block.where, block.text.rstrip("\n"))
    at = source.index(block.where)
    line = source.rindex("\n", 0, at) + 1 if block.how == "before" else source.index("\n", at) + 1
    return source[:line] + block.text + source[line:]


def made(document, text_of):
    """The files that the examples make or change, with their texts: {name: text}.

    text_of    returns the text of a file of the sources
    """
    files = {}
    for block in blocks(document):
        files[block.file] = block.text if block.how == "new" else edited(files.get(block.file) or text_of(block.file), block)
    return files


def write(path, text):
    if path.exists() and path.read_text() == text:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def main(document, folder):
    for block in blocks(pathlib.Path(document).read_text()):
        if block.how == "new":
            write(pathlib.Path(folder, block.file), block.text)


if __name__ == "__main__":
    main(*sys.argv[1:])
