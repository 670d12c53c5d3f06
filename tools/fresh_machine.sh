#!/usr/bin/env bash
# Run the demo on a fresh Debian 12: an empty debootstrap chroot, a fresh clone, as root.
#
# usage: fresh_machine.sh [FOLDER]    (default: a temporary one, removed afterwards; needs root and debootstrap)
set -euo pipefail
cd "$(dirname "$0")/.."
root=${1:-$(mktemp -d)}
cleanup() {
  umount "$root/proc" "$root/dev" "$root/sys" 2>/dev/null || true
  [ -n "${1:-}" ] || rm -rf "$root"
}
trap 'cleanup "${1:-}"' EXIT

mirror=$(grep -rhoE 'https?://[^ ]+/debian/?( |$)' /etc/apt/sources.list /etc/apt/sources.list.d 2>/dev/null | head -n 1 || true)
debootstrap --variant=minbase --include=ca-certificates bookworm "$root" "${mirror:-http://deb.debian.org/debian}" > "$root.log" 2>&1 ||
  { tail "$root.log" >&2; exit 1; }
cp -r /etc/apt/apt.conf.d "$root/etc/apt/" # the proxy of this machine, if any
cp /etc/resolv.conf "$root/etc/resolv.conf"
rm -rf "$root/etc/apt/apt.conf.d/docker-"*
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
mount -t sysfs sysfs "$root/sys"  # PoCL reads the number of cores and the memory there
git clone -q . "$root/sherd"

in_chroot() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 "$@"; }
started=$SECONDS
in_chroot /sherd/tools/demo.sh
echo "first run: $((SECONDS - started)) s"
started=$SECONDS
in_chroot /sherd/tools/demo.sh
echo "second run: $((SECONDS - started)) s"
pieces=$(ls "$root"/sherd/demo-pieces/fragments/*.vdb | wc -l)
[ "$pieces" -eq 8 ] && [ -s "$root/sherd/demo-pieces/preview.png" ] && [ -s "$root/sherd/demo-pieces/labels.rle" ]
echo "fresh machine: $pieces pieces"
