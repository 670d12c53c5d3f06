#!/usr/bin/env bash
# Install the wheel where there are Python and pip alone, in an empty Debian 12, and break a mesh as the user nobody, without HOME.
#
# usage: bare_python.sh WHEEL    (needs root, debootstrap and the network)
set -euo pipefail
cd "$(dirname "$0")/../.."
source tools/release/chroot.sh
new_chroot
cp "$1" data/amphora.ply "$root/"
in_chroot "$root" sh -c 'apt-get update -qq && apt-get install -y -qq --no-install-recommends python3 python3-pip' > "$root.apt" 2>&1 ||
  { tail "$root.apt" >&2; exit 1; }
[ ! -f /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/"
for file in /etc/ssl/certs/ca-certificates.crt ${PIP_CERT:-} ${SSL_CERT_FILE:-}; do cp --parents "$file" "$root/"; done
chroot "$root" env -i PATH=/usr/bin:/bin $(env | grep -E '^(PIP_|https?_proxy|HTTPS?_PROXY|SSL_CERT)' || true) \
  python3 -m pip install -q --break-system-packages --root-user-action=ignore "/$(basename "$1")"
install -d -o 65534 -g 65534 "$root/out"
as_nobody() { chroot --userspec=65534:65534 "$root" env -i PATH=/usr/local/bin:/usr/bin:/bin "$@"; }
as_nobody python3 -B -W ignore -c '
import pysherd
f = pysherd.fracture("/amphora.ply", pieces=8, resolution=64)
f.save("/out/pieces")
print(len(f), "fragments,", len(f[0].faces), "faces of the first")'
as_nobody sherd fracture /amphora.ply -o /out/again --pieces 8 --resolution 64 --quiet
diff -r "$root/out/pieces" "$root/out/again"
echo "python and pip alone: eight pieces, as nobody without a home, and the program's are the same"
