#!/usr/bin/python3
"""Writes what the documents repeat of the tables of options: the tables of docs/cli.md, and `options` in docs/manifest.schema.json.

usage: option_docs.py [--check] SHERD

SHERD is the program: `sherd options --json` lists the options.  With --check nothing is written, and the status is 1 where a
document is not as it would be written.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
MANUAL = ROOT / "docs" / "cli.md"
SCHEMA = ROOT / "docs" / "manifest.schema.json"
MOST = 2**31 - 1  # a number that has no limit


# --- docs/cli.md --------------------------------------------------------------------------------------------------------------

def values_of(row):
    """The column of values."""
    unit = f" {row['unit']}" if "unit" in row else ""
    if row["type"] == "length":
        voxels = ", ".join(row["choices"]) if "choices" in row else row["range"].split("|")[0].replace("..", " to ")
        return f"{voxels}{unit}, or `P%`"
    if row["type"] == "number" and "choices" in row:
        return ", ".join(f"`{c}`" for c in row["choices"]) + f", or {row['range']}{unit}"
    if "choices" in row:
        quote = "{}" if row["type"] == "whole" else "`{}`"
        return ", ".join(quote.format(c) for c in row["choices"]) + (", separated by commas" if row["type"] == "choices" else "")
    if row["type"] == "wholes":
        return re.sub(r".*:(.*)\.\.(.*)", r"\1 to \2, several separated by commas", row["range"])
    parts = row.get("range", "").split("|")
    if row["type"] in ("whole", "number"):
        parts = [re.sub(rf"\.\.{2**64 - 1}$", " and up", p) for p in parts]
        return ", or ".join(re.sub(r"\.\.", " to ", p) if re.search(r"\d|>| ", p) else f"`{p}`" for p in parts) + unit
    return ", or ".join(f"`{p}`" for p in parts) + unit if parts != [""] else ""


def default_of(row):
    default = row.get("default", "")
    if row["type"] == "flag" or not default:
        return ""
    return default if re.fullmatch(r"[\d.]+(\.\.\d+)?|[\d/]+", default) else f"`{default}`"


def table_of(rows):
    lines = ["| option | value | default | meaning |", "|---|---|---|---|"]
    for row in rows:
        names = ", ".join(f"`--{name}`" for name in (row.get("alias"), row["name"]) if name)
        text = row.get("details") or row["help"][0].lower() + row["help"][1:]
        cells = [names, values_of(row), default_of(row), text]
        lines.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
    return "\n".join(re.sub(r" +\|", " |", line) for line in lines)


def manual_with(tables, text):
    """The manual, with its tables between `<!-- options: TABLE GROUP -->` and `<!-- end -->` written anew."""
    def region(match):
        table, _, group = match.group(1).partition(" ")
        rows = [r for r in tables[table] if not r.get("hidden") and (table == "dataset" or r.get("group", "") == group)]
        return f"<!-- options: {match.group(1)} -->\n{table_of(rows)}\n<!-- end -->"

    return re.sub(r"<!-- options: (.*?) -->\n(?:.*\n)*?<!-- end -->", region, text)


# --- docs/manifest.schema.json ------------------------------------------------------------------------------------------------

def number_schema(row, kind):
    schema = {"type": kind}
    part = row.get("range", "").split("|")[-1].split(":")[-1]
    limits = re.fullmatch(r"(-?[\d.]+?(?:e\d+)?)\.\.(-?[\d.]+?(?:e\d+)?)", part)
    if limits:
        low, high = (json.loads(n) for n in limits.groups())
        schema["minimum"] = low
        if high != MOST:
            schema["maximum"] = high
    elif part == "> 0":
        schema["exclusiveMinimum"] = 0
    elif part in ("0 and up", "share"):
        schema["minimum"] = 0
    return schema


def schema_of(row):
    """The schema of an option's value in a manifest."""
    if row["key"] == "seeds.impacts":
        return {"type": "array", "items": {"$ref": "#/$defs/impact"}}
    if row["key"] == "guides":
        return {"type": "array", "items": {"$ref": "#/$defs/guide"}, "minItems": 1}
    if row["key"] in ("grow.grain.direction", "grow.propagation"):
        return {"$ref": "#/$defs/vector"}
    if row["type"] == "length":
        voxels = {"enum": [int(c) for c in row["choices"]]} if "choices" in row else number_schema({"range": row["range"].split("|")[0]}, "number")
        return {"oneOf": [voxels, {"type": "string", "pattern": "^[0-9.e+-]+%$"}]}
    if row["type"] == "whole" and "choices" in row: {"enum": [int(c) for c in row["choices"]]}
    if row["type"] == "choice":
        return {"enum": row["choices"]}
    if row["type"] == "choices":
        return {"type": "array", "items": {"enum": row["choices"]}, "minItems": 1}
    if row["type"] == "wholes":
        return {"type": "array", "items": number_schema(row, "integer")}
    if row["type"] in ("whole", "number"):
        schema = number_schema(row, "integer" if row["type"] == "whole" else "number")
        if row["type"] == "number" and "choices" in row:
            schema = {"oneOf": [{"enum": row["choices"]}, schema]}
        if row.get("range", "").startswith("auto|"):
            schema = {"oneOf": [{"const": "auto"}, schema]}
        return schema
    return {"type": "boolean" if row["type"] == "flag" else "string"}


def described(row):
    schema = schema_of(row)
    if "$ref" in schema:
        return schema
    text = row["help"] + (f", {row['unit']}" if "unit" in row else "")
    return {**schema, "description": re.sub(r"--(\w)", r"\1", text[0].lower() + text[1:])}


def object_of(rows, depth=0):
    """The schema of an object of the rows whose keys have these first parts in common."""
    properties, together, required = {}, {}, []
    for row in rows:
        name, *below = row["key"].split(".")[depth:]
        if below:
            inside = [r for r in rows if r["key"].split(".")[depth:depth + 1] == [name]]
            properties.setdefault(name, object_of(inside, depth + 1))
            conditions = {r.get("recorded") for r in inside}  # one of several always holds
            row = {**row, "recorded": conditions.pop() if len(conditions) == 1 else None}
        else:
            properties[name] = described(row)
        if not row.get("recorded"):
            required.append(name)
        else:
            together.setdefault(row["recorded"], []).append(name)
    schema = {"type": "object", "properties": properties}
    required = list(dict.fromkeys(required))
    if required:
        schema["required"] = required
    groups = [list(dict.fromkeys(names)) for names in together.values()]
    if depth and any(len(names) > 1 for names in groups):
        schema["dependentRequired"] = {n: [m for m in names if m != n] for names in groups for n in names if len(names) > 1}
    if not required:
        schema["minProperties"] = 1
    return {**schema, "additionalProperties": False}


def schema_with(tables, text):
    schema = json.loads(text)
    # How the inside was found is not recorded of a fracture that was broken again.
    rows = [{**r, "recorded": -1} if r.get("group") == "Solid" else r for r in tables["fracture"] if "key" in r]
    options = object_of(rows)
    options["description"] = schema["properties"]["options"]["description"]
    schema["properties"]["options"] = options
    return json.dumps(schema, indent=1) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("sherd", metavar="SHERD", help="the program")
    parser.add_argument("--check", action="store_true", help="write nothing")
    arguments = parser.parse_args()
    tables = json.loads(subprocess.run([arguments.sherd, "options", "--json"], stdout=subprocess.PIPE, check=True).stdout)
    stale = []
    for file, written in (MANUAL, manual_with), (SCHEMA, schema_with):
        text = file.read_text()
        new = written(tables, text)
        if new != text:
            stale.append(file)
            if not arguments.check:
                file.write_text(new)
    for file in stale if arguments.check else ():
        print(f"{file.relative_to(ROOT)} is not as tools/option_docs.py writes it", file=sys.stderr)
    return 1 if arguments.check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
