#!/usr/bin/env bash
# Break real meshes and let an independent checker judge the results.  A refused mesh counts as a failure: the rest are broken
# too, and the status is 1 at the end.
#
# usage: verify_meshes.sh SHERD MESH_FOLDER CHECKER.py [quick]
#   quick: some meshes only, at 128 voxels
set -euo pipefail
sherd=$1 meshes=$2 checker=$3 quick=${4:-}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
export OCL_ICD_VENDORS=pocl.icd
data=$(dirname "$0")/../../data

all=("$data/amphora.ply" "$meshes"/{armadillo.obj,bunny.off,dragon.obj,lucy.ply,3DBenchy.ply,vase_goblet.stl,boot.obj}
  "$meshes"/{springer.obj,1002_tray_bottom.STL,ADIS16480.STL,mengerSponge3.glb,footbones.ply,99865_car.stl}
  "$meshes"/{gearbox_assembly.ply.gz,bun_zipper.ply,trimesh_bunny.ply,lionstatue.obj,simple_vase_open.obj,teapot.stl})
if [ -n "$quick" ]; then
  all=("$data/amphora.ply" "$meshes"/{dragon.obj,vase_goblet.stl,ADIS16480.STL,footbones.ply}
    "$meshes"/{bun_zipper.ply,simple_vase_open.obj,teapot.stl})
fi

passed=0 failed=0
verify() {  # mesh resolution pieces surface
  local limit=()
  case $(basename "$1") in amphora*|armadillo*|dragon*|lucy*) limit=(--max-error 0.1) ;; esac
  rm -rf "$out/pieces" "$out/report"
  if "$sherd" fracture "$1" -o "$out/pieces" --resolution "$2" --pieces "$3" --surface "$4" \
      --write labels,vdb,mesh --quiet > "$out/log" 2>&1 &&
     /usr/bin/python3 "$checker" "$out/pieces" --mesh "$1" ${limit[@]+"${limit[@]}"} > "$out/report" 2>&1; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    echo "FAILED $(basename "$1") at $2 in $3 pieces, --surface $4"
    head -qn 20 "$out/log" "$out/report" 2>/dev/null || true  # a refused mesh has no report
  fi
}
for mesh in "${all[@]}"; do
  verify "$mesh" 128 8 smooth
  # The checker asks the voxels what a face faces, and exact surfaces keep every face: it can judge these where the voxels resolve
  # them.  The holes of this one, with a third of its faces, are 1.1 voxels wide at 128.
  case $(basename "$mesh") in ADIS16480*) fine=192 ;; *) fine=128 ;; esac
  verify "$mesh" $fine 8 auto
  [ -n "$quick" ] || verify "$mesh" 200 40 auto
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
