#!/usr/bin/env bash
# Break every closed mesh of a folder by many options, and let an independent checker judge each result.
#
# usage: verify_options.sh SHERD MESH_FOLDER CHECKER.py [quick|surfaces|random [OPTION...]]
#   quick: three meshes only
#   random: 300 runs of meshes, pieces, resolutions and options drawn from a seed, open and thin meshes too (random_options.py, with its options)
#   surfaces: every mesh in 10 pieces, or one per connected component, with default meshes, meshed independently, eroded, rough, smoothed and
#   decimated to 2000 triangles: all closed, manifold and outwards.  A build with SHERD_GPL=ON checks with CGAL too (sherd evaluate --cgal)
#
# At 128 voxels, for N in 2, 5, 10, 50, 200 with components <= N <= voxels / 100: exactly N fragments, every voxel of the solid
# in one of them, each 6-connected, and no fault found by the checker.  Default options for every N; the other sets of options
# for one N each, another for every mesh.  A mesh is left out if Sherd refuses it and MESH_FOLDER/stats.csv, if it
# exists, does not list it as watertight; and if it is thinner than its voxels, so that the intact solid's mesh has less
# than four fifths of its voxels' volume: the checker compares the two.  The surface error is checked once
# per mesh, because these options do not move the surface.  Prints a line per run with faults, with its command.
set -euo pipefail
sherd=$1 meshes=$2 checker=$3 mode=${4:-}
export OCL_ICD_VENDORS=pocl.icd
python=/usr/bin/python3  # Debian's: numpy, scipy and pyopenvdb are there
[ "$mode" != random ] || exec "$python" -B "$(dirname "$0")/random_options.py" "$sherd" "$meshes" "$checker" "${@:5}"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
shopt -s nullglob nocaseglob

all=("$meshes"/*.{obj,ply,stl,off,gltf,glb}{,.gz})
[ "$mode" != quick ] || all=("$meshes"/{vase_goblet.stl,footbones.ply,99865_car.stl})
sets=("--extra-seeds 2n" "--impacts 2" "--roughness 2" "--grain 1,2,0.5,3" "--growth flood" "--growth flood --neighborhood 26"
  "--growth nearest" "--growth chain")
surfaces=("" "--interface independent" "--interface independent --growth chain --erode-iterations 2 --erode-on fracture --erode-probability 0.5"
  "--interface independent --roughness 2 --erode-iterations 2 --erode-on all --erode-probability 0.5" "--erode-iterations 2 --erode-probability 0.5" "--roughness 2"
  "--smooth-iterations 0.048k --smooth-boundary-iterations 0.048k" "--triangles 2000")

cgal=()
"$sherd" --version | grep -q GPL && cgal=(--cgal)
[ "$mode" != surfaces ] || [ ${#cgal[@]} -gt 0 ] || echo "CGAL checks are skipped: this program was built without SHERD_GPL=ON"

field() { "$python" -c 'import json, sys; print(json.load(open(sys.argv[1]))[sys.argv[2]])' "$out/report.json" "$1"; }
isThin() { "$python" -c 'import json, sys; r = json.load(open(sys.argv[1])); sys.exit(
  r["volume_out"] > 0.8 * r["voxels"] * r["voxel_size"] ** 3)' "$out/report.json"; }
isWatertight() {  # by the folder's table
  [ -f "$meshes/stats.csv" ] && "$python" - "$meshes/stats.csv" "$(basename "$1")" << 'END'
import csv, sys
sys.exit(not any(r["file"] == sys.argv[2] and r["watertight"] == "True" for r in csv.DictReader(open(sys.argv[1]))))
END
}

runs=0 failed=0 swept=0 open=0 thin=0
fault() {  # mesh what command...
  failed=$((failed + 1))
  echo "FAULT $(basename "$1"): $2 | ${*:3}"
}
verify() {  # mesh pieces option...
  local mesh=$1 pieces=$2
  shift 2
  local command="fracture $mesh --pieces $pieces --resolution 128 $* --write labels,vdb,mesh"
  runs=$((runs + 1))
  rm -rf "$out/pieces"
  # shellcheck disable=SC2086
  if ! "$sherd" $command -o "$out/pieces" --json > "$out/report.json" 2> "$out/log"; then
    fault "$mesh" "$(tail -n 1 "$out/log")" "$command"
    return
  fi
  local surface=()
  [ -n "$compared" ] || surface=(--mesh "$mesh")
  compared=yes
  judge "$pieces" ${surface[@]+"${surface[@]}"}
  [ ! -s "$out/faults" ] || fault "$mesh" "$(tr '\n' ' ' < "$out/faults")" "$command"
  [[ $* == *--triangles* ]] || return 0
  useDecimated
  judge "$pieces"
  [ ! -s "$out/faults" ] || fault "$mesh" "decimated: $(tr '\n' ' ' < "$out/faults")" "$command"
}
# Writes the faults of $out/pieces as one line to $out/faults.
judge() {  # pieces checker's option...
  local pieces=$1
  shift
  "$python" "$checker" "$out/pieces" "$@" --json > "$out/checked.json" 2> "$out/log" || true
  echo '{"fragments": []}' > "$out/evaluated.json"
  [ "$mode" != surfaces ] ||
    "$sherd" evaluate "$out/pieces" ${cgal[@]+"${cgal[@]}"} --samples 1 --json > "$out/evaluated.json" 2> "$out/log" || true
  "$python" - "$out" "$pieces" > "$out/faults" 2>&1 << 'END' || true
import json, os, sys
out, pieces = sys.argv[1], int(sys.argv[2])
text = open(os.path.join(out, "checked.json")).read()
if not text:
    log = open(os.path.join(out, "log")).read().split("\n")
    sys.exit("the checker stopped: " + " ".join(log[-2:]))
checked, report = json.loads(text), json.load(open(os.path.join(out, "report.json")))
faults, figures = checked["faults"], checked["figures"]
if figures["fragments"] != pieces:
    faults.append(f"{figures['fragments']} fragments, expected {pieces}")
if figures["voxels"] + report["eroded_voxels"] != report["voxels"]:
    faults.append(f"{figures['voxels']} voxels in fragments, the solid has {report['voxels']}")
for fragment in json.load(open(os.path.join(out, "evaluated.json")))["fragments"]:
    quality, cgal = fragment["quality"], fragment.get("cgal")
    if not (quality["closed"] and quality["manifold"] and quality["outward"] and quality["degenerate_triangles"] == 0):
        faults.append(f"fragment {fragment['id']}: mesh is not sound")
    if cgal and not (cgal["polygon_mesh"] and cgal["valid"] and cgal["closed"]):
        faults.append(f"fragment {fragment['id']}: not a closed, valid mesh according to CGAL")
print("; ".join(faults[:3]) + (f"; and {len(faults) - 3} more" if len(faults) > 3 else ""), end="")
END
}
useDecimated() {  # replaces the meshes by the decimated ones
  "$python" - "$out/pieces" << 'END'
import json, os, shutil, sys
folder = sys.argv[1]
for fragment in json.load(open(os.path.join(folder, "manifest.json")))["fragments"]:
    shutil.copyfile(os.path.join(folder, fragment["decimated"][0]["file"]), os.path.join(folder, fragment["files"]["mesh"]))
END
}
nth() { local at=$1; shift; local of=("$@"); echo "${of[at % $#]}"; }

for mesh in "${all[@]}"; do
  rm -rf "$out/pieces"
  if [[ $mesh == *.obj ]] && grep -q '^vt ' "$mesh"; then  # the checker reads no texture coordinates
    plain=$out/$(basename "$mesh")
    sed -E '/^(vt|usemtl|mtllib)/d; /^f /s#/[-0-9]*(/[-0-9]*)?##g' "$mesh" > "$plain"
    mesh=$plain
  fi
  if ! "$sherd" fracture "$mesh" -o "$out/pieces" --pieces 1 --resolution 128 --write labels --json > "$out/report.json" 2> "$out/log"; then
    open=$((open + 1))
    ! isWatertight "$mesh" || fault "$mesh" "watertight, but refused: $(tail -n 1 "$out/log")" "fracture $mesh --pieces 1"
    continue
  fi
  if isThin; then
    thin=$((thin + 1))
    continue
  fi
  compared= components=$(field components) most=$(($(field voxels) / 100))
  if [ "$mode" = surfaces ]; then
    for options in "${surfaces[@]}"; do
      # shellcheck disable=SC2086
      verify "$mesh" $((components > 10 ? components : 10)) $options
    done
    swept=$((swept + 1))
    continue
  fi
  fitting=() struck=()  # N, and N that allows two impacts
  for pieces in 2 5 10 50 200; do
    [ "$pieces" -ge "$components" ] && [ "$pieces" -le "$most" ] || continue
    fitting+=("$pieces")
    [ "$pieces" -lt $((components + 2)) ] || struck+=("$pieces")
    verify "$mesh" "$pieces"
  done
  [ "${#fitting[@]}" -gt 0 ] || continue
  for i in "${!sets[@]}"; do
    chosen=("${fitting[@]}")
    [[ ${sets[i]} != --impacts* ]] || chosen=(${struck[@]+"${struck[@]}"})
    # shellcheck disable=SC2086
    [ "${#chosen[@]}" -eq 0 ] || verify "$mesh" "$(nth $((swept + i)) "${chosen[@]}")" ${sets[i]}
  done
  swept=$((swept + 1))
done
echo "$runs runs on $swept meshes, left out: $open open, $thin too thin; $failed faults"
[ "$failed" -eq 0 ] && [ "$runs" -gt 0 ]
