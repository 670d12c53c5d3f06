#!/usr/bin/env bash
# Tests that take too long or too many resources for every change: all real meshes, every failing call, long fuzzing, the Debian package, and a fresh
# Debian 12 in a chroot.  Needs root for the chroot.  About two hours on two cores.
#
# usage: test_long.sh [CHECKER.py]    (with SHERD_TEST_DATA: the independent checker of finished fractures)
set -euo pipefail
cd "$(dirname "$0")/.."
tools/install_packages.sh ci
command -v debootstrap > /dev/null || DEBIAN_FRONTEND=noninteractive apt-get install -y -qq debootstrap > /dev/null
tools/build.sh release -- -DSHERD_TESTS=ON

if [ -n "${SHERD_TEST_DATA:-}" ] && [ -n "${1:-}" ]; then
  echo "== all real meshes, at 128 voxels in 8 pieces and at 200 in 40"
  tools/release/verify_meshes.sh build/release/sherd "$SHERD_TEST_DATA" "$1"
  echo "== 300 fractures by random options"
  tools/release/verify_options.sh build/release/sherd "$SHERD_TEST_DATA" "$1" random
fi

echo "== every call that may fail"
tools/build.sh release sherd_cli sherd_faults
SHERD_FAULTS_EACH=all SHERD_BIN=$PWD/build/release/sherd SHERD_FAULTS=$PWD/build/release/tests/faults/sherd_faults.so \
  OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 -B tests/cli/faults_test.py

echo "== every command under many limits of memory and threads"
SHERD_LIMITS=all SHERD_BIN=$PWD/build/release/sherd /usr/bin/python3 -B tests/cli/limits_test.py
echo "== 60 random option sets with points, correspondences and samples under --max-memory"
SHERD_BIN=$PWD/build/release/sherd /usr/bin/python3 -B tests/long/sample_memory.py 60

echo "== 200 signals at random moments"
SHERD_SIGNALS=200 SHERD_BIN=$PWD/build/release/sherd OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 -B tests/cli/signals_test.py

echo "== objects of all sizes, and a hundred changed files of each layout"
SHERD_SCALES=all SHERD_BIN=$PWD/build/release/sherd OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 -B tests/cli/scales_test.py
SHERD_SWEEP=100 SHERD_BIN=$PWD/build/release/sherd OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 -B tests/cli/dataset_safety_test.py Changes

echo "== a kill at every call that changes a fracture's folder"
SHERD_KILLS=all SHERD_BIN=$PWD/build/release/sherd SHERD_FAULTS=$PWD/build/release/tests/faults/sherd_faults.so \
  OCL_ICD_VENDORS=pocl.icd /usr/bin/python3 -B tests/cli/kills_test.py

echo "== valgrind: a small fracture with every file but the preview"
folder=$(mktemp -d)
OCL_ICD_VENDORS=pocl.icd POCL_MAX_PTHREAD_COUNT=1 valgrind --quiet --error-exitcode=9 --leak-check=no \
  --suppressions=tools/release/valgrind.supp build/release/sherd fracture data/amphora.ply -o "$folder/out" --pieces 2 --resolution 48 \
  --threads 1 --mesh-format ply,obj,glb,stl --points 10 --sdf-samples 10 --correspondences 5 \
  --write labels,vdb,mesh,seeds,boundaries,cost,fog,solid,scene,usd,graph,houdini,viewer,proxy --voxel-format rle,npy,npz,vox,qstack,bing
rm -r "$folder"

echo "== each file compiled alone, which finds a header that is not included"
tools/build.sh alone
rm -r build/alone

echo "== all unit and kernel tests with sanitizers, and the program's"
tools/build.sh asan sherd_tests sherd_kernel_tests sherd_cli
tools/release/check_sanitized.sh
ASAN_OPTIONS=detect_leaks=0:use_sigaltstack=0 ctest --test-dir build/asan --output-on-failure --no-tests=error -j 2 -R '^(cli|dataset|surface|points)$'

echo "== fuzzing the readers, each for five minutes or SHERD_FUZZ_SECONDS"
tools/build.sh asan sherd_fuzz
tests/fuzz/run.sh build/asan/tests/fuzz/sherd_fuzz "${SHERD_FUZZ_SECONDS:-300}"

echo "== 2000 fractures with exact surfaces"
tools/build.sh release sherd_exact_sweep
meshes=()
if [ -n "${SHERD_TEST_DATA:-}" ]; then
  for name in armadillo.obj bunny.off dragon.obj lucy.ply drivaer_frontWheels.obj.gz vase_goblet.stl vented_rear_case.ply \
    1002_tray_bottom.STL ADIS16480.STL flange.stl.gz mengerSponge3.glb boot.obj 99865_car.stl screw-big.obj nut-big.obj springer.obj \
    sword-quad-dominant.obj bunny_closed_high_res.stl self_intersectA.obj footbones.ply 3DBenchy.ply; do
    meshes+=("$SHERD_TEST_DATA/$name")
  done
fi
build/release/tests/sherd_exact_sweep 2000 1 "${meshes[@]}"

echo "== the same bytes on every device, and the kernels with the least instructions"
tests/long/devices.py build/release/sherd
tools/build.sh release sherd_kernel_tests
SHERD_TEST_DEVICE=x86-64-v2 SHERD_PROPERTY_CASES=60 build/release/tests/sherd_kernel_tests --gtest_brief=1
ctest --test-dir build/release -C Long --output-on-failure --no-tests=error -R '^kernels_on_rusticl_whole$'

echo "== points against Debian's Point Cloud Library"
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends libpcl-dev > /dev/null
tools/release/check_pcl.sh build/release/sherd

echo "== a thousand million voxels"
tests/long/large.py build/release/sherd

echo "== the option, the growth rule and the mesh format of CONTRIBUTING.md"
tests/long/contributing.py

echo "== a dataset run on Slurm"
tests/long/slurm.sh build/release/sherd

echo "== a dataset's report in a browser"
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium python3-pil > /dev/null
tests/long/report.py build/release/sherd

echo "== scenes in USD, by OpenUSD, its validators, NVIDIA's and tinyusdz"
venv=build/usd/venv
if [ ! -e "$venv/done" ]; then
  rm -rf "$venv"
  python3.11 -m venv "$venv"
  "$venv/bin/pip" install -q --disable-pip-version-check ${SHERD_USD_WHEELS:+--find-links "$SHERD_USD_WHEELS"} \
    usd-core==26.11 omniverse-asset-validator==1.18.0 tinyusdz==0.9.4 numpy==2.4.6
  touch "$venv/done"
fi
OCL_ICD_VENDORS=pocl.icd "$venv/bin/python" -B tests/long/usd.py build/release/sherd

echo "== Houdini's geometry, by HouIO"
if [ -n "${SHERD_HOUIO:-}" ]; then
  tests/long/geo.py build/release/sherd "$SHERD_HOUIO"
else
  echo "not run: SHERD_HOUIO names no build of HouIO, see tests/long/geo.py"
fi

echo "== scenes in glTF, by the schemas of SHERD_GLTF_SCHEMAS and in Godot"
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends godot3-server python3-jsonschema > /dev/null
tests/long/gltf.py build/release/sherd

echo "== later Blenders, and the extension where there is neither Sherd nor OpenCL"
tests/long/blender_versions.sh build/release/sherd

echo "== the Blender add-on in a window"
tools/install_packages.sh window
tests/long/blender_window.py build/release/sherd
folder=$(mktemp -d)
blender -b --factory-startup --python-exit-code 1 --python tests/long/blender_tutorial.py -- build/release/sherd "$folder" 4 > "$folder/log" ||
  { tail "$folder/log"; exit 1; }
rm -r "$folder"

echo "== pages of the viewer in a browser"
tests/long/viewer.py build/release/sherd

echo "== what measures: Sherd beside other programs, instructions, and devices from an archive"
tools/bench/bench_peers.sh
tools/bench/bench_counts.sh --repeats 2 build/release/sherd
folder=$(mktemp -d)
tools/bench/bench_gpu.sh --pack "$folder/bench_gpu.tar.gz"
tar -C "$folder" -xzf "$folder/bench_gpu.tar.gz"
OCL_ICD_VENDORS=pocl.icd "$folder/bench_gpu/bench_gpu.sh" --seconds 120
rm -r "$folder"

echo "== the Debian package, with both licenses"
for gpl in ON OFF; do
  tools/build.sh release -- -DSHERD_GPL=$gpl
  ctest --test-dir build/release --output-on-failure --no-tests=error -R '^(documents|install)$' | grep -vE "^ +Start |Passed +[0-9.]+ sec$"
  (cd build/release && cpack -G DEB > /dev/null && dpkg-deb -I sherd_*.deb | grep -E 'Package|Version|Depends')
  license=Apache-2.0
  [ $gpl = OFF ] || license=GPL-3.0-or-later
  copyright=$(dpkg-deb --fsys-tarfile build/release/sherd_*.deb | tar -xO ./usr/share/doc/sherd/copyright)
  grep -qx "License: $license" <<< "$copyright" && echo "its copyright file has $license"
done

echo "== builds without OpenCL, without the built-in device, and both without HDF5"
lacking() {  # device, CMake argument: a build that has only that
  cmake --preset release -B build/lacking -DSHERD_TESTS=OFF -DSHERD_BENCH=OFF -DSHERD_HDF5=OFF "$2" > /dev/null
  cmake --build build/lacking --target sherd_cli > /dev/null
  OCL_ICD_VENDORS=pocl.icd build/lacking/sherd fracture data/amphora.ply -o build/lacking/pieces --pieces 3 --resolution 64 --quiet
  OCL_ICD_VENDORS=pocl.icd build/lacking/sherd devices | tee build/lacking/devices
  [ -z "$(grep -vE "^\* is|$1" build/lacking/devices)" ]
  ! build/lacking/sherd dataset data -o build/lacking/h5 --layout hdf5 2> build/lacking/refused
  grep -q "built without HDF5" build/lacking/refused
  rm -r build/lacking
}
lacking builtin -DSHERD_OPENCL=OFF
lacking Portable -DSHERD_CLANG=

echo "== the package where there is no OpenCL"
tools/release/no_driver.sh build/release/sherd_*.deb

echo "== the Python module: 10,000 fractures and objects, Python and pip alone, and its meshes in trimesh and manifold3d"
SHERD_PYTHON_FRACTURES=10000 tools/test_python.sh -k memory
tools/release/bare_python.sh build/python/wheel/*.whl
echo "== 2000 damages of pickles, and of .vdb files"
build/python/venv/bin/python -B tests/long/pickles.py 2000
echo "== exact pieces of bodies that overlap, beside the unions that manifold3d makes"
SHERD_BIN=$PWD/build/release/sherd build/python/venv/bin/python -B tests/long/manifold_union.py 600
tests/long/vdb_damage.py build/release/sherd 2000 build/python/venv/bin/python
meshes=(data/amphora.ply)
[ -z "${SHERD_TEST_DATA:-}" ] || for name in bunny.off armadillo.obj dragon.obj vase_goblet.stl 3DBenchy.ply boot.obj 99865_car.stl footbones.ply \
  ADIS16480.STL; do meshes+=("$SHERD_TEST_DATA/$name"); done
build/python/venv/bin/python -B tests/long/python_meshes.py "${meshes[@]}"

echo "== fractures broken again five times over, in files of each format, by five processes and by one"
build/python/venv-torch/bin/pip install -q --disable-pip-version-check pillow==13.0.0
SHERD_BIN=$PWD/build/release/sherd SHERD_DATA=$PWD/data OCL_ICD_VENDORS=pocl.icd build/python/venv-torch/bin/python -B tests/long/again_formats.py

echo "== a network that is trained on fractures made meanwhile, with three seeds"
build/python/venv-torch/bin/python -B tests/long/training.py

echo "== the examples for PyTorch Geometric and Lightning, with these packages"
/usr/bin/python3 -m venv build/python/venv-networks
build/python/venv-networks/bin/pip install -q --disable-pip-version-check build/python/wheel/*.whl lightning==2.2.5 torch_geometric==2.8.1 torch==2.15.0
OCL_ICD_VENDORS=pocl.icd build/python/venv-networks/bin/python -B tests/long/network_modules.py

echo "== the example of Dask, on this machine"
build/python/venv/bin/pip install -q --disable-pip-version-check "dask[bag]==2026.8.0"
build/python/venv/bin/python -B examples/python/with_dask.py build/python/dask data/amphora.ply

echo "== a fresh Debian 12"
tools/release/fresh_machine.sh
