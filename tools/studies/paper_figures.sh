#!/usr/bin/env bash
# Reproduce the paper's figures and tables, as mapped by docs/paper.md.
#
#   docs/gallery.md      Figures 3 to 9, 11 and 15, with the images of docs/images
#   OUT/figure10.png     smoothing
#   OUT/dataset          a run over LIBRARY; its report.html has Table 3 and Figures 12, 13, 16 and 17
#   OUT/table1.txt       storage by format
#   OUT/figure14.csv     convexity by extra seeds, and its plot figure14.png
#
# usage: paper_figures.sh OUT [LIBRARY [REPEATS]]   (LIBRARY: a folder of closed meshes, by default the bundled amphora; REPEATS as in
#                                                    --repeats, by default the paper's 25..15)
#
# Figure 1 is an illustration; Figure 2 is in docs/robustness.md, by tools/studies/robustness.py; Table 2 needs a trained network.
set -euo pipefail
[ $# -ge 1 ] && [ $# -le 3 ] || { sed -n '/^# usage/,/^#  /s/^# //p' "$0" >&2; exit 2; }
mkdir -p "$1"
out=$(realpath "$1")
library=$(realpath "${2:-$(dirname "$0")/../../data}")
repeats=${3:-25..15}
cd "$(dirname "$0")/../.."

tools/studies/pictures.sh
sherd=build/release/sherd
mapfile -t meshes < <(find "$library" -type f \( -name '*.ply' -o -name '*.obj' -o -name '*.stl' \) | sort)

echo "== Figure 10"
/usr/bin/python3 tools/studies/smoothing_sheet.py "$sherd" "${meshes[0]}" "$out/figure10.png"
echo "== Table 3, Figures 12, 13, 16 and 17"
"$sherd" dataset "$library" -o "$out/dataset" --preset paper --repeats "$repeats" --points 1024
echo "== Table 1"
# Nine numbers of pieces, each at least once.
/usr/bin/python3 tools/studies/table1.py "$sherd" "$library" --per-vessel $(((8 + ${#meshes[@]}) / ${#meshes[@]})) | tee "$out/table1.txt"
echo "== Figure 14"
/usr/bin/python3 tools/studies/convexity_study.py "$sherd" "$out/figure14.csv" "${meshes[@]}" --seeds 5 --plot "$out/figure14.png"
echo "$out: done; see $out/dataset/report.html"
