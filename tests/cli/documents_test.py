#!/usr/bin/python3
"""What is written of Sherd is true: commands run, options are as documented, links lead somewhere, names exist.

SHERD_BIN names the program, SHERD_DATA the folder with amphora.ply.  SHERD_DOCUMENTS names a checkout whose documents are
read, by default this one: stale statements can be put back in a copy to see this test fail (docs/testing.md).
"""
import functools
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import unittest

import skipping
from cli_test import SHERD, CommandLine, sphere, write_obj
from manifests import load_schema

HERE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(HERE / "tests"))
import recipes  # noqa: E402
ROOT = pathlib.Path(os.environ.get("SHERD_DOCUMENTS", HERE))
COMMANDS = ("fracture", "dataset", "assemblage", "merge", "inspect", "convert", "evaluate", "render", "view", "options", "devices", "doctor")

# Not of this project: names of other libraries, and files of examples.
FOREIGN = set("""math/Mat3.h Mat3.h Coord.h version.h InteriorTest UNSIGNED_DISTANCE_FIELD meshToVolume Surface_mesh_simplification
meshopt_simplify KHR_texture_transform file_compression file_mem_bytes interior_polygons seam_points seam_polygons
cl::Device::getDefault() MADV_POPULATE_WRITE closestPointOnTriangleToPoint
bowl_001.vdb bowl_002.vdb a_1024p.binp a_3f_128r_0it.rle a_3f_128r_0it_2.binm a_3f_128r_0it_2_1024p.binp a_grid_128r.rle boundary_001_002
bunny_closed_high_res.stl fractures_3_of_8.hdf5 data_val_dir matching_data_path UnitScaleFactor""".split())

# The headers that the rows of "Who may include what" are about (docs/architecture.md).
HEADERS = {
    "OpenVDB, whole": r"openvdb/(openvdb\.h|tools/.*|io/.*)", "OpenVDB, `Mat3.h`": r"openvdb/math/Mat3\.h",
    "OpenVDB, `Coord.h` and `version.h`": r"openvdb/(math/Coord|version)\.h", "GLM": None, "OpenCL": r"CL/.*",
    "OpenCL, through that": r"cl/open_cl\.h", "Draco": r"draco/.*", "Assimp": r"assimp/.*",
    "Embree": r"embree\d?/.*", "Qhull": r"libqhull_r/.*", "OpenEXR": r"(Imf|OpenEXR).*", "HDF5": r"hdf5\.h", "CGAL": r"CGAL/.*", "libpng": r"png\.h",
    "zlib": r"zlib\.h", "zstd": r"zstd\.h", "OpenSSL": r"openssl/.*", "nlohmann/json": r"nlohmann/.*", "CLI11": r"CLI/.*",
    "TBB": r"tbb/.*", "Boost.Multiprecision": r"boost/multiprecision/.*"}

# Words that make a statement about a moment: it is false a month later, and nobody looks at it again.
MOMENTS = r"\bat present\b|\bcurrently\b|\bfor now\b|\bhas it yet\b|\bwhen it comes\b"


# Words that docs/glossary.md has better ones for, and spelling that is not American.
WORDS = (r"\b(tells?|told|telling)\b|colour|neighbour|\bcentr(e|es|ed)\b|\bgrey\b|labelled|(normal|general|initial|organ|optim)is(e|ation|ing)"
         r"|behaviour|\b(milli|nano)?metres?\b|\blicence")


@functools.cache
def text_of(name):
    return (ROOT / name).read_text()


@functools.cache
def pages():
    """Every document, by its path from the root."""
    found = [p.relative_to(ROOT).as_posix() for p in ROOT.glob("docs/**/*.md")]
    return sorted(["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "data/README.md", *found])


@functools.cache
def tracked():
    """Every file of the project, by its path from the root: what is built or hidden left out."""
    names = []
    for at, folders, files in os.walk(ROOT):
        below = pathlib.Path(at).relative_to(ROOT)
        folders[:] = [f for f in folders if f not in ("build", "__pycache__", "demo-pieces") and (f == ".ci" or not f.startswith("."))]
        names += [(below / f).as_posix() for f in files]
    return sorted(names)


@functools.cache
def sources():
    """The text of everything that is not a document."""
    suffixes = (".cpp", ".h", ".cl", ".c", ".py", ".sh", ".cmake", ".txt", ".in", ".json", ".sbatch", ".supp")
    names = [n for n in tracked() if n.endswith(suffixes) or n == ".ci/run"]
    return "\n".join((ROOT / n).read_text(errors="replace") for n in names if not n.endswith("documents_test.py"))


def without_code(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)


def sections(text):
    """Headings of the second level with what is below them."""
    parts = re.split(r"^## (.*)$", text, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))


def rows(text):
    """The rows of each table: dicts from the head's cells to the row's."""
    for table in re.findall(r"(?:^\|.*\n)+", text, flags=re.M):
        lines = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in table.splitlines()]
        for line in lines[2:]:
            yield dict(zip(lines[0], line))


# --- Options ------------------------------------------------------------------------------------------------------------------

class Option:
    """One option as --help or cli.md has it."""

    def __init__(self, names, values, default, text):
        self.names, self.text = names, text
        self.default = default.strip("`") or None
        self.choices = set(re.findall(r"`([^`]+)`", values)) if "`" in values else set()
        self.range = None
        found = re.search(r"([-+\d.e^]+)(?: to |\.\.)([-+\d.e^]+)", values)
        if found:
            self.range = tuple(float(2**64 - 1) if v == "2^64-1" else float(v) for v in found.groups())
        elif "> 0" in values:
            self.range = (0.0, None)
        elif values.endswith("and up"):
            self.range = (float(values.split()[0]), float(2**64 - 1))


@functools.cache
def helped(command):
    """name: Option, as `sherd <command> --help` has them."""
    text = subprocess.run([SHERD, command, "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
    options, column = {}, 30  # where meanings begin: on the option's line, or where it is longer on the next
    for line, further in re.findall(rf"^  (-.*)\n((?: {{{column}}}.*\n)*)", text, flags=re.M):
        start, meaning = (line, further.strip()) if further else (line[:column - 2], line[column - 2:])
        names, _, spec = start.strip().partition(" ")
        names = [n for n in names.split(",") if n.startswith("--")]
        spec = re.sub(r" (Excludes|Needs):.*| REQUIRED| \.\.\.", "", spec)
        values, default = re.fullmatch(r"(.*?)(?:=([^=]*))?", spec).groups()
        kind, _, allowed = values.partition(":")
        listed = re.fullmatch(r"\{(.*)\}", allowed)
        listed = listed.group(1) if listed else kind if default and re.fullmatch(r"[a-z-]+(,[a-z-]+)+", kind) else ""
        limits = re.sub(r"FLOAT in \[(.*) - (.*)\]", r"\1..\2", allowed)
        option = Option(names, limits, default or "", meaning)
        option.choices = set(re.split(r", ?", listed)) if listed else {"auto"} if limits.startswith("auto|") else set()
        options.update({name: option for name in names})
    options.pop("--help")
    return options


@functools.cache
def documented(command):
    """name: Option, as the tables of cli.md have them."""
    options = {}
    for row in rows(sections(text_of("docs/cli.md")).get("sherd " + command, "")):
        values = row.get("value", row.get("values"))
        if values is None or not row.get("option", "").startswith("`-"):
            continue
        names = [n for n in re.findall(r"`([^`]+)`", row["option"]) if n.startswith("--")]
        option = Option(names, values.replace(", separated by commas", ""), row.get("default", ""), "")
        if re.fullmatch(r"\d+(, \d+)+", values):
            option.choices = set(values.split(", "))
        options.update({name: option for name in names})
    return options


class Options(unittest.TestCase):
    maxDiff = None

    def test_every_command_is_in_the_synopsis(self):
        found = subprocess.run([SHERD, "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
        commands = re.findall(r"^  ([a-z]+)  ", found.split("Subcommands:")[1], flags=re.M)
        self.assertEqual(tuple(commands), COMMANDS)
        synopsis = re.findall(r"^sherd ([a-z]+)", text_of("docs/cli.md").split("```")[1], flags=re.M)
        self.assertEqual(sorted(synopsis), sorted(commands))
        for command in commands:
            self.assertIn("sherd " + command, sections(text_of("docs/cli.md")))

    def expected(self, command):
        if command not in ("dataset", "assemblage"):
            return documented(command)
        text = sections(text_of("docs/cli.md"))["sherd dataset"]
        less = re.search(r"All options of `sherd fracture` but (.*?) are\s+there", text, flags=re.S).group(1)
        less = set(re.findall(r"`(--[a-z-]+)`", less))
        own = documented("dataset")
        shared = {n: o for n, o in documented("fracture").items() if n not in less and n not in own}
        if command == "assemblage":
            others = re.search(r"all other options are the same, but (.*?), and", sections(text_of("docs/cli.md"))["sherd assemblage"], flags=re.S).group(1)
            own = {name: option for name, option in own.items() if name not in re.findall(r"`(--[a-z-]+)`", others)}
        return {**shared, **own}

    def test_options_are_documented_and_no_others(self):
        for command in COMMANDS:
            with self.subTest(command=command):
                known = self.expected(command)
                if known:
                    self.assertEqual(sorted(helped(command)), sorted(known))
                    continue
                text = text_of("docs/cli.md").split("```")[1] + sections(text_of("docs/cli.md"))["sherd " + command]
                shown = set(re.findall(r"\[(--[a-z]+)", "\n".join(l for l in text.splitlines() if l.startswith("sherd " + command))))
                self.assertEqual(sorted(helped(command)), sorted(shown))

    def test_tables_and_schema_are_as_written_from_the_options(self):
        check = [sys.executable, str(ROOT / "tools" / "option_docs.py"), "--check", SHERD]
        result = subprocess.run(check, stderr=subprocess.PIPE, text=True)
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_ranges_and_defaults_are_as_documented(self):
        for command in COMMANDS:
            for name, documented_option in self.expected(command).items():
                real = helped(command).get(name)
                if real is None:
                    continue  # test_options_are_documented_and_no_others
                with self.subTest(command=command, option=name):
                    if real.range or documented_option.range:
                        self.assertEqual(documented_option.range, real.range)
                    if real.choices:
                        self.assertEqual(documented_option.choices, real.choices)
                    default = documented_option.default
                    if (command, name) == ("assemblage", "--objects"):
                        default = "2..5"
                    if command in ("dataset", "assemblage") and name == "--write":
                        default = re.search(r"`--write` is `([^`]+)`", sections(text_of("docs/cli.md"))["sherd dataset"]).group(1)
                    if real.default is not None:
                        self.assertEqual((default or "").split(" (")[0].strip("`"), real.default)
                    elif default and default != "needed":
                        self.assertRegex(real.text, "default", f"cli.md has the default {default}, --help has none")

    def test_errors_name_options_and_no_flags(self):
        """Errors of the library list options by name, and the program adds their flags: no other string of src/ has one."""
        tables = ("src/cli/", "src/options/", "src/dataset/options.cpp", "src/assimp_program/")
        names, flags = set(), []
        for name in tracked():
            if not re.match(r"(src|include)/.*\.(cpp|h)$", name) or name.startswith(tables):
                continue
            for listed in re.findall(r"\bOptionNames(?: \w+)?\{([^}]*)\}", text_of(name)):
                names |= set(re.findall(r'"([^"]*)"', listed))
            for literal in re.findall(r"""//.*|'(?:\\.|[^\\'\n])'|"(?:\\.|[^\\"\n])*\"""", text_of(name)):
                if re.match(r'".*--[a-z]', literal):
                    flags.append(f"{name}: {literal}")
        self.assertEqual(flags, [])
        self.assertIn("resolution", names)
        known = set(helped("fracture")) | set(helped("dataset"))
        self.assertEqual(sorted(n for n in names if "--" + n not in known), [])


# --- Names and links ----------------------------------------------------------------------------------------------------------

class Names(unittest.TestCase):
    maxDiff = None

    def test_links_lead_somewhere_and_to_every_page(self):
        reached, left = set(), ["README.md"]
        while left:
            page = left.pop()
            if page in reached:
                continue
            reached.add(page)
            folder = pathlib.PurePosixPath(page).parent
            for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", without_code(text_of(page))):
                if re.match(r"[a-z]+:", target):
                    continue
                path = os.path.normpath(folder / target)
                self.assertTrue((ROOT / path).exists(), f"{page} links to {target}")
                if os.path.isdir(ROOT / path):
                    left += [p for p in pages() if os.path.dirname(p) == path]
                elif path.endswith(".md"):
                    left.append(path)
        self.assertEqual(sorted(set(pages()) - reached), [], "no page links to these")

    def test_files_in_backticks_exist(self):
        missing = []
        for page in pages():
            if page == "CHANGELOG.md":  # it also speaks of what is gone
                continue
            for token in re.findall(r"`([^`\s]+)`", without_code(text_of(page))):
                if not re.search(r"\.(cpp|h|cl|py|sh|cmake|supp|md|\*)$|^(src|tests|tools|include|kernels|cmake|docs|data)/", token):
                    continue
                if token in FOREIGN or token.startswith(("*.", ".")) or "<" in token:
                    continue
                pattern = re.compile("(^|/)" + re.escape(token.rstrip("/")).replace(r"\*", "[^/]*").replace(r"\.\.\.", "[^/]*") + "(/|$)")
                if not any(pattern.search(name) for name in tracked()):
                    missing.append(f"{page}: {token}")
        self.assertEqual(missing, [])

    def test_functions_in_backticks_exist(self):
        missing = []
        words = set(re.findall(r"\w+", sources()))
        for page in pages():
            if page == "CHANGELOG.md":
                continue
            for token in re.findall(r"`([^`\s]+)`", without_code(text_of(page))):
                name = re.sub(r"\(.*\)$", "", token)
                if not re.fullmatch(r"[A-Za-z_][\w:.]*", name) or token in FOREIGN or name.startswith("SHERD_REQUIRE_"):
                    continue
                for word in re.split(r"::|\.", name):
                    camel = re.search(r"[a-z][A-Z]|_", word)
                    if camel and word not in words and token not in sources():
                        missing.append(f"{page}: {token}")
        self.assertEqual(sorted(set(missing)), [])


# --- Statements ---------------------------------------------------------------------------------------------------------------

class Statements(unittest.TestCase):
    maxDiff = None

    def section(self, page, heading):
        found = re.split(r"^#+ ", text_of(page), flags=re.M)
        return next(part for part in found if part.startswith(heading + "\n"))

    def test_no_statement_is_about_a_moment(self):
        """What is not there yet has a section of its own in docs/guarantees.md; measurements say when they were made."""
        found = []
        for name in [*pages(), *(n for n in tracked() if re.match(r"(src|include|kernels)/", n))]:
            if name == "CHANGELOG.md":
                continue
            for number, line in enumerate(text_of(name).splitlines(), 1):
                if re.search(MOMENTS, line, flags=re.I):
                    found.append(f"{name}:{number}: {line.strip()}")
        self.assertEqual(found, [])

    def test_words(self):
        found = []
        for name in tracked():
            if not re.match(r"(src|include|kernels|tools|docs)/(?!images)|[A-Z]+\.md$", name) or name == "CHANGELOG.md":
                continue
            for number, line in enumerate(text_of(name).splitlines(), 1):
                if re.search(WORDS, line, flags=re.I):
                    found.append(f"{name}:{number}: {line.strip()}")
        self.assertEqual(found, [])

    def test_variables_of_the_environment(self):
        """Each that is read is in cli.md, and each that is there is read by Sherd, its tests, or a driver."""
        section = self.section("docs/cli.md", "Environment")
        code = "\n".join(text_of(n) for n in tracked() if re.match(r"src/(?!cli/).*\.cpp$", n) and "getenv(" in text_of(n))
        read = set(re.findall(r'"([A-Z][A-Z_]{3,})"', code))
        self.assertIn("SHERD_ASSIMP", read)
        self.assertEqual(sorted(n for n in read if f"`{n}`" not in section), [])
        named = set(re.findall(r"`([A-Z][A-Z_]{3,})(?:=\w+)?`", section))
        self.assertEqual(sorted(n for n in named if n not in sources()), [])
        needs = set(re.findall(r'skip(?:_unless)?\((?:[^"()]|\([^()]*\)|"/[^"]*")*"([A-Z]+)"', sources()))
        self.assertIn("BLENDER", needs)
        tests = {"SHERD_REQUIRE_" + n for n in needs} | set(re.findall(r"\bSHERD_(?:TEST_D|REQUIRE_)[A-Z]+\b", sources()))
        self.assertEqual(tests, set(re.findall(r"SHERD_(?:TEST_D|REQUIRE_)[A-Z]+", text_of("docs/testing.md"))))

    def test_who_includes_what(self):
        includes = {}
        for name in tracked():
            if re.match(r"(src|include)/.*\.(cpp|h)$", name) and name != "src/base/text/library_versions.cpp":
                includes[name] = re.findall(r'^#include [<"]([^>"]+)[>"]', text_of(name), flags=re.M)
        table = {row["library"]: row["included by"] for row in rows(self.section("docs/architecture.md", "Who may include what"))}
        self.assertEqual(sorted(table), sorted(HEADERS))
        for library, cell in table.items():
            if HEADERS[library] is None:
                continue
            real = {n for n, headers in includes.items() if any(re.fullmatch(HEADERS[library], h) for h in headers)}
            listed = [t for t in re.findall(r"`([^`]+)`", cell) if "/" in t]

            def holds(entry, name):
                return name.startswith(entry) if entry.endswith("/") else name == entry

            with self.subTest(library=library):
                self.assertEqual(sorted(n for n in real if not any(holds(e, n) for e in listed)), [], "not in the table")
                self.assertEqual([e for e in listed if not any(holds(e, n) for n in real)], [], "do not include it")

    def test_stages_of_fracture(self):
        """The comment on fracture() names every function that the table of stages has between reading and writing."""
        table = list(rows(self.section("docs/architecture.md", "The stages")))
        stages = [r for r in table if r["stage"] in ("voxelize", "components", "seed", "grow", "erode", "extract")]
        self.assertEqual(len(stages), 6)
        header = text_of("include/sherd/fracture.h")
        comment = re.search(r"((?:^///.*\n)+)\[\[nodiscard\]\] FractureResult fracture\(const TriangleMesh", header, flags=re.M).group(1)
        for row in stages:
            for name in re.findall(r"`(\w+)`", row["function"].split(", which calls")[0]):
                if name in header + text_of("include/sherd/seeds.h") + text_of("include/sherd/solid.h") + text_of("include/sherd/labels.h"):
                    self.assertIn(name, comment, row["stage"])

    def test_constants(self):
        """Numbers of the code that the documents repeat: each has to be there, as the code has it."""
        def code(name, what):
            return re.search(re.escape(what) + r" = (\d+)", text_of(name)).group(1)

        bits = code("src/voxelize/fill/winding.cpp", "kBits")
        small, highest = code("include/sherd/solid.h", "kSmallComponentVoxels"), code("include/sherd/seeds.h", "kMaxFragments")
        least, most = code("include/sherd/solid.h", "kLeastAutoResolution"), code("include/sherd/solid.h", "kMostAutoResolution")
        for page, statement in (
                ("docs/architecture.md", f"at most 2^{bits} steps"),
                ("docs/architecture.md", f"a 2^{int(bits) - 8}nd at 128 voxels"),
                ("docs/architecture.md", f"Components under {small} voxels"),
                ("docs/formats.md", f"| k + 1 | fragment k, 1 <= k <= {highest} |"),
                ("docs/cli.md", f"the least multiple of eight from {least} to {most}"),
                ("docs/architecture.md", f"labels extended by {code('include/sherd/labels.h', 'int outerSteps')} steps")):
            self.assertTrue(statement in text_of(page), f"{page} does not say: {statement}")

    def test_what_label_1_and_withheld_mean(self):
        """options_test.py sees that 1 in labels.rle is what was eroded or withheld, and that the manifest counts it so."""
        labels = {row["label"]: row["meaning"] for row in rows(self.section("docs/formats.md", "labels.rle")) if "label" in row}
        fields = {row["field"]: row[""] for row in rows(self.section("docs/formats.md", "manifest.json")) if "field" in row}
        for text in labels["1"], fields["`grid.eroded_voxels`"]:
            self.assertRegex(text, "eroded.*withheld")
        self.assertIn("without files", fields["`withheld`"])

    def test_fields_of_the_manifest(self):
        section = self.section("docs/formats.md", "manifest.json")
        words = set(re.findall(r"\w+", section))

        def keys(schema):
            for key, below in schema.get("properties", {}).items():
                yield key
                yield from keys(below)
            for below in (*schema.get("oneOf", ()), *schema.get("$defs", {}).values()):
                yield from keys(below)
            if isinstance(schema.get("items"), dict):
                yield from keys(schema["items"])

        report = set(load_schema()["properties"]["report"]["properties"]) | {
            key for part in ("walls", "resolution", "closed_holes") for key in load_schema()["properties"]["report"]["properties"][part]["properties"]}
        missing = {key for key in keys(load_schema()) if key not in words and key not in report}
        self.assertEqual(sorted(missing), [])
        # These are described with --json.
        self.assertEqual(sorted(key for key in report if key not in text_of("docs/cli.md")), [])

    def test_a_growth_rule_compiles_few_sources(self):
        """How many sources include the table of growth rules, directly or by a header, is what CONTRIBUTING.md says."""
        files = [f for top in ("src", "include") for f in (ROOT / top).rglob("*") if f.suffix in (".h", ".cpp")]
        texts = {f: f.read_text() for f in files}
        names = {"<sherd/growth.h>"}
        while True:
            found = {f'"{f.relative_to(ROOT / "src")}"' for f, text in texts.items()
                     if f.suffix == ".h" and f.is_relative_to(ROOT / "src") and any(f"#include {name}" in text for name in names)}
            if found <= names:
                break
            names |= found
        count = sum(f.suffix == ".cpp" and any(f"#include {name}" in text for name in names) for f, text in texts.items())
        self.assertLessEqual(count, 20)
        self.assertIn(f"compiles the groups of {count} sources again", text_of("CONTRIBUTING.md"))

    def test_licenses(self):
        """What the documents say of the program's license is what the build does, and what the program prints."""
        switches = dict(re.findall(r'option\((SHERD_GPL) ".*?" (ON|OFF)\)', text_of("CMakeLists.txt")))
        self.assertEqual(switches, {"SHERD_GPL": "OFF"})
        readme, decision = self.section("README.md", "License"), text_of("docs/decisions/0005-licenses.md")
        for text in readme, decision:
            self.assertIn("SHERD_GPL", text)
            self.assertRegex(text, "GPL-3.0-or-later|GPL, version 3 or later")
        self.assertNotRegex(readme, r"links no")
        self.assertIn("`SHERD_GPL` is OFF", decision)
        printed = subprocess.run([SHERD, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout
        linked = subprocess.run(["grep", "-c", "Polygon_mesh_processing", SHERD], stdout=subprocess.PIPE, text=True).stdout.strip() != "0"
        self.assertIn("GPL-3.0-or-later" if linked else "Apache-2.0", printed)


# --- Examples -----------------------------------------------------------------------------------------------------------------

class Recipes(unittest.TestCase):
    """CONTRIBUTING.md's examples, as far as no build is needed: tests/CMakeLists.txt builds their new files, tests/long/contributing.py all."""

    def test_every_block_has_its_place(self):
        changed = {}
        for block in recipes.blocks(text_of("CONTRIBUTING.md")):
            with self.subTest(file=block.file, where=block.where):
                if block.how == "new":
                    self.assertFalse((ROOT / block.file).exists())
                    continue
                changed[block.file] = recipes.edited(changed.get(block.file, text_of(block.file)), block)
        self.assertGreater(len(changed), 8)

    def test_a_block_without_a_place_is_found(self):
        document = "## Add a thing\n\n*src/a.cpp*, a new file:\n\n```cpp\nint a;\n```\n\n`src/b.cpp`, before `x`:\n\n```cpp\ny\n```\n"
        self.assertEqual([(b.file, b.how, b.where, b.text) for b in recipes.blocks(document)],
                         [("src/a.cpp", "new", "", "int a;\n"), ("src/b.cpp", "before", "x", "y\n")])
        self.assertEqual(recipes.edited("1\n 2x\n3\n", recipes.blocks(document)[1]), "1\ny\n 2x\n3\n")
        for text, block in (("xx", recipes.blocks(document)[1]), ("", recipes.blocks(document)[1])):
            self.assertRaises(SystemExit, recipes.edited, text, block)
        self.assertRaises(SystemExit, recipes.blocks, document.replace("before", "near"))


# --- Commands -----------------------------------------------------------------------------------------------------------------

@functools.cache
def written_commands():
    """[(page, words)] of every command in a block of code, but for synopses."""
    found = []
    for page in pages():
        for block in re.findall(r"^```\w*\n(.*?)^```", text_of(page), flags=re.S | re.M):
            for line in re.findall(r"^sherd (?!.*(?:\[|DIR|PATH| \| )).*", block, flags=re.M):
                found.append((page, shlex.split(line, comments=True)[1:]))
    return found


class Commands(CommandLine):
    def test_options_of_commands_exist(self):
        self.assertGreater(len(written_commands()), 60)
        for page, words in written_commands():
            with self.subTest(page=page, command=" ".join(words)):
                self.assertIn(words[0], COMMANDS)
                self.assertEqual([w for w in words if w.startswith("--") and w.split("=")[0] not in helped(words[0])], [])

    def test_commands_of_the_pages_run(self):
        """On small files of the names that they have; the gallery's are run for its images, the tour's below."""
        folder = pathlib.Path(self.tmp)
        shutil.copytree(HERE / "data", folder / "data")
        for name in "bowl.obj", "vessels/bowl.obj", "library/bowl.obj", *(f"pots/{i}.obj" for i in range(6)):
            (folder / name).parent.mkdir(exist_ok=True)
            write_obj(folder / name, sphere(8, 16))
        shutil.copy(folder / "data" / "amphora.ply", folder / "vase.ply")
        write_obj(folder / "ring.obj", ([(-1, 0.2, -1), (1, 0.2, -1), (1, 0.2, 1), (-1, 0.2, 1)], [(0, 1, 2), (0, 2, 3)]))
        ran = set()
        for page, words in written_commands():
            if page in ("docs/tour.md", "docs/gallery.md", "docs/paper.md") or "/scratch/fragments" in words:
                continue
            small = ["--max-fragments", "4"] if words[0] == "dataset" and "--repeats" not in words else []
            if "--resolution" not in words:
                small += ["--resolution", "32"]
            words = ["2" if w == "10" else "2..2" if w == "10..10" else "1/1" if w == "3/8" else w for w in words]
            words[words.index("-o") + 1] += "-" + pathlib.Path(page).stem
            with self.subTest(page=page, command=" ".join(words)):
                result = self.run_sherd(*words, *small, cwd=folder, timeout=300)
                self.assertEqual(result.returncode, 0, result.stderr)
                ran.add(page)
        self.assertEqual(ran, {f"docs/{page}.md" for page in ("blender", "cli", "growth", "houdini", "materials", "training")})

class Readme(CommandLine):
    def prepare(self, folder):
        """What a fresh checkout has of the files that commands name."""
        shutil.copytree(HERE / "data", folder / "data")

    def commands(self):
        tour = sections(text_of("docs/tour.md"))["Commands"].split("```")[1]
        return [re.sub(r"\s+#.*", "", line) for line in tour.splitlines() if line.startswith("sherd ")]

    def test_every_command_of_the_tour_runs(self):
        folder = pathlib.Path(self.tmp)
        self.prepare(folder)
        commands = self.commands()
        self.assertGreater(len(commands), 15)
        self.assertEqual({c.split()[1] for c in commands}, set(COMMANDS) - {"merge", "assemblage"})
        for command in commands:
            with self.subTest(command=command):
                arguments = command.split()[1:]
                if arguments[0] == "dataset":  # 177 fractures as written; here the first ten
                    arguments += ["--max-fragments", "20", "--resolution", "32"]
                if arguments[:2] == ["fracture", "data/amphora.ply"]:
                    arguments += ["--resolution", "64"]
                result = self.run_sherd(*arguments, cwd=folder, timeout=300)
                self.assertEqual(result.returncode, 0, result.stderr)

    def test_the_scripts_are_there(self):
        for script in re.findall(r"\./(tools/\S+)", text_of("README.md")):
            self.assertTrue(os.access(ROOT / script, os.X_OK), script)

    def test_the_cpp_example_is_compiled(self):
        """examples/break_a_mesh.cpp, which the tests build against the installed package, has every statement of docs/tour.md's example."""
        example = text_of("docs/tour.md").split("```cpp")[1].split("```")[0]

        def plain(text):
            text = re.sub(r'"[^"]*"|\bargv\[\d\]|\b\d+\b', "_", re.sub(r"//.*", "", text))
            return re.sub(r"\s", "", text)

        compiled = plain(text_of("examples/break_a_mesh.cpp"))
        for line in example.strip().splitlines():
            self.assertIn(plain(line), compiled, line)

    def test_folders_of_the_output_are_as_listed(self):
        folder = pathlib.Path(self.tmp)
        self.prepare(folder)
        result = self.run_sherd("fracture", "data/amphora.ply", "-o", "pieces", "--pieces", "8", "--seed", "1", "--resolution", "48", cwd=folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        for name in re.findall(r"^(pieces/\S+)", text_of("docs/tour.md"), flags=re.M):
            self.assertTrue((folder / name).exists(), name)


if __name__ == "__main__":
    skipping.main()
