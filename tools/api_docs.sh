#!/usr/bin/env bash
# Makes the pages of the public headers in build/api/html by Doxygen; what it warns of is an error.  Aligned lines of a comment
# ("///   throws  Error(input) ...") become paragraphs of that name.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p build/api
cat > build/api/Doxyfile <<SETTINGS
PROJECT_NAME = Sherd
PROJECT_BRIEF = "Breaks 3D models into fragments"
INPUT = include/sherd
OUTPUT_DIRECTORY = build/api
STRIP_FROM_INC_PATH = include
EXTRACT_ALL = YES
GENERATE_LATEX = NO
QUIET = YES
WARN_AS_ERROR = FAIL_ON_WARNINGS
WARN_LOGFILE = build/api/warnings
SORT_MEMBER_DOCS = NO
AUTOLINK_SUPPORT = NO
INPUT_FILTER = "sed -E 's#^( *///)   ([a-z][A-Za-z, ]*[A-Za-z])  +(.*)#\1 @par \2\n\1 \3#'"
HAVE_DOT = NO
ENABLE_PREPROCESSING = YES
MACRO_EXPANSION = NO
SETTINGS
doxygen build/api/Doxyfile || { cat build/api/warnings >&2; exit 1; }
echo "build/api/html/index.html"
