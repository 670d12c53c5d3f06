# Functions for tests in an empty Debian 12, to be sourced.  Need root and debootstrap.

# make_chroot ROOT: installs one, without any recommended package.
make_chroot() {
  local root=$1 mirror
  mirror=$(grep -rhoE 'https?://[^ ]+/debian/?( |$)' /etc/apt/sources.list /etc/apt/sources.list.d 2>/dev/null | head -n 1 || true)
  debootstrap --variant=minbase --include=ca-certificates bookworm "$root" "${mirror:-http://deb.debian.org/debian}" > "$root.log" 2>&1 ||
    { tail "$root.log" >&2; return 1; }
  cp -r /etc/apt/apt.conf.d "$root/etc/apt/" # the proxy of this machine, if any
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  rm -rf "$root/etc/apt/apt.conf.d/docker-"*
  mount -t proc proc "$root/proc"
  mount --bind /dev "$root/dev"
  mount -t sysfs sysfs "$root/sys"  # PoCL reads the number of cores and the memory there
}

# leave_chroot ROOT
leave_chroot() {
  umount "$1/proc" "$1/dev" "$1/sys" 2>/dev/null || true
}

# new_chroot: makes one in a folder of its own, which is removed at exit; sets root.
new_chroot() {
  work=$(mktemp -d)
  root=$work/root
  mkdir -p "$root"
  chmod 755 "$work" "$root"
  trap 'leave_chroot "$root"; rm -rf --one-file-system "$work"' EXIT
  make_chroot "$root"
}

# in_chroot ROOT COMMAND...: runs it with a plain environment.
in_chroot() {
  local root=$1
  shift
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 "$@"
}
