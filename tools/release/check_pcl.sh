#!/usr/bin/env bash
# Check that the Point Cloud Library reads the .binp files of Sherd, and Sherd those of PCL, with the same points.
#
# usage: check_pcl.sh SHERD    (needs Debian's libpcl-dev; PCL_FLAGS: additional compiler flags)
set -euo pipefail
sherd=$(realpath "$1")
cd "$(dirname "$0")/../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
# shellcheck disable=SC2086
c++ -std=c++17 -O1 -w -I/usr/include/pcl-1.13 -I/usr/include/eigen3 ${PCL_FLAGS:-} tests/long/pcl_points.cpp -o "$out/pcl_points" \
  -l:libpcl_io.so.1.13 -l:libpcl_octree.so.1.13 -l:libpcl_common.so.1.13

same() {  # two clouds, as text in any order, within 1e-6 of their size
  /usr/bin/python3 - "$1" "$2" << 'END'
import sys
import numpy as np
a, b = (np.loadtxt(path, ndmin=2) for path in sys.argv[1:])
assert a.shape == b.shape and len(a) > 0, (a.shape, b.shape)
assert np.abs(a - b).max() <= 1e-6 * np.abs(a).max(), np.abs(a - b).max()
END
}

for scale in 0.002 0.03 1 150 4000; do
  /usr/bin/python3 -c 'import sys, numpy as np
np.savetxt(sys.argv[2], np.random.default_rng(1).random((3000, 3)) * [1, 0.6, 0.3] * float(sys.argv[1]) - 0.2, "%.9g")' $scale "$out/in.xyz"
  "$sherd" convert "$out/in.xyz" "$out/ours.binp" > /dev/null 2>&1
  "$sherd" convert "$out/ours.binp" "$out/ours.xyz" > /dev/null
  "$out/pcl_points" decode "$out/ours.binp" > "$out/theirs.xyz"
  same "$out/ours.xyz" "$out/theirs.xyz"

  "$out/pcl_points" encode "$out/pcl.binp" < "$out/in.xyz"
  "$out/pcl_points" decode "$out/pcl.binp" > "$out/theirs.xyz"
  "$sherd" convert "$out/pcl.binp" "$out/ours.xyz" > /dev/null
  same "$out/ours.xyz" "$out/theirs.xyz"
  echo "scale $scale: $(wc -l < "$out/ours.xyz") points, equal in both"
done
