#!/usr/bin/env bash
# Run the demo on a fresh Debian 12: an empty debootstrap chroot, a fresh clone, as root.
#
# usage: fresh_machine.sh [FOLDER]    (default: a temporary one, removed afterwards; needs root and debootstrap)
set -euo pipefail
cd "$(dirname "$0")/../.."
source tools/release/chroot.sh
root=${1:-$(mktemp -d)}
cleanup() {
  leave_chroot "$root"
  [ -n "${1:-}" ] || rm -rf --one-file-system "$root"
}
trap 'cleanup "${1:-}"' EXIT
make_chroot "$root"
git clone -q . "$root/sherd"

started=$SECONDS
in_chroot "$root" /sherd/tools/demo.sh
echo "first run: $((SECONDS - started)) s"
started=$SECONDS
in_chroot "$root" /sherd/tools/demo.sh
echo "second run: $((SECONDS - started)) s"
pieces=$(ls "$root"/sherd/demo-pieces/fragments/*.vdb | wc -l)
[ "$pieces" -eq 8 ] && [ -s "$root/sherd/demo-pieces/preview.png" ] && [ -s "$root/sherd/demo-pieces/labels.rle" ]
echo "fresh machine: $pieces pieces"
