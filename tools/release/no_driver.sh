#!/usr/bin/env bash
# Run the program where there is no OpenCL: its Debian package in an empty Debian 12, as the user nobody, without HOME,
# where no folder for temporary files can be written; then beside a driver's file that names no library.
#
# usage: no_driver.sh PACKAGE.deb    (needs root and debootstrap)
set -euo pipefail
cd "$(dirname "$0")/../.."
source tools/release/chroot.sh
new_chroot
cp "$1" "$root/sherd.deb"
cp data/amphora.ply "$root/amphora.ply"
in_chroot "$root" sh -c 'apt-get update -qq && apt-get install -y -qq --no-install-recommends /sherd.deb' > "$root.apt" 2>&1 ||
  { tail "$root.apt" >&2; exit 1; }
if in_chroot "$root" ldconfig -p | grep -i opencl; then
  echo "no_driver.sh: there is an OpenCL library" >&2
  exit 1
fi

as_nobody() { chroot --userspec=65534:65534 "$root" env -i PATH=/usr/bin:/bin "$@"; }
install -d -o 65534 -g 65534 "$root/out"
chmod 755 "$root/tmp" "$root/var/tmp"  # nobody may not write there
breaks() {
  rm -rf "$root/out/pieces"
  as_nobody /usr/bin/sherd fracture /amphora.ply -o /out/pieces --pieces 8 --resolution 64 "$@"
  [ "$(ls "$root/out/pieces/fragments"/*.vdb | wc -l)" -eq 8 ]
}
breaks
breaks --device builtin --quiet
as_nobody /usr/bin/sherd devices
as_nobody /usr/bin/sherd doctor > "$root.doctor" || { cat "$root.doctor" >&2; exit 1; }
if as_nobody /usr/bin/sherd fracture /amphora.ply -o /out/other --device gpu; then
  echo "no_driver.sh: a GPU was found" >&2
  exit 1
fi

mkdir -p "$root/etc/OpenCL/vendors"
echo libbroken.so.9 > "$root/etc/OpenCL/vendors/broken.icd"
breaks --quiet
echo "no driver: eight pieces, as nobody without a home"
