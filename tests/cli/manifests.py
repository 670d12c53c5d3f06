"""Every manifest.json that a test makes Sherd write is checked against docs/manifest.schema.json, by Debian's python3-jsonschema."""
import json
import os
import pathlib

import jsonschema

SCHEMA_FILE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "manifest.schema.json"


def load_schema():
    with open(SCHEMA_FILE) as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    return schema


VALIDATOR = jsonschema.Draft202012Validator(load_schema())


def faults_of(manifest):
    """What the schema finds wrong with a manifest: a sentence each."""
    return [f"{'/'.join(map(str, error.path))}: {error.message}" for error in VALIDATOR.iter_errors(manifest)]


def check_below(folder):
    """Check every manifest in a folder and below.  Returns how many there are."""
    found = sorted(pathlib.Path(folder).rglob("manifest.json"))
    for file in found:
        with open(file) as text:
            faults = faults_of(json.load(text))
        if faults:
            raise AssertionError(f"{file} is not as {SCHEMA_FILE.name} has it: {faults[:3]}")
    return len(found)


def check_run(arguments, status, folder=None):
    """After a run of sherd in a folder: check what it wrote, if it was one that writes manifests and it says that it did."""
    arguments = [str(a) for a in arguments]
    if status != 0 or not arguments or arguments[0] not in ("fracture", "dataset", "assemblage"):
        return 0
    outputs = [b for a, b in zip(arguments, arguments[1:]) if a in ("-o", "--output")]
    return sum(check_below(os.path.join(folder or "", output)) for output in outputs)
