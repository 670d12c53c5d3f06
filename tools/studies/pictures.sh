#!/usr/bin/env bash
# Make all images of README.md and docs/gallery.md, and the page of the gallery.  Some ten minutes on two cores.
#
# usage: pictures.sh
set -euo pipefail
cd "$(dirname "$0")/../.."

tools/install_packages.sh pictures
tools/build.sh release sherd_cli -- -DSHERD_TESTS=OFF -DSHERD_BENCH=OFF
sherd=build/release/sherd
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$sherd" fracture data/amphora.ply -o "$work/pieces" --pieces 8 --seed 1 --write mesh --quiet
"$sherd" render "$work/pieces" -o docs/images/amphora.png
/usr/bin/python3 tools/studies/gallery.py "$sherd" docs
/usr/bin/python3 tools/studies/impact_pictures.py "$sherd" docs
