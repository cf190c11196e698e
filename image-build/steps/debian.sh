# shellcheck shell=sh
# Read by the steps that install Debian packages.

suite=trixie

# listed FILE: the names in a list, with commas between them.
listed() { sed '/^#/d; /^$/d' "$1" | paste -sd, -; }

# debian OPTION...: mmdebstrap of the suite, without documentation other than licences. What it mounts ends with it.
debian() {
  image-build/mirror "$suite" main non-free-firmware |
    unshare --mount env PATH=/usr/sbin:/usr/bin:/sbin:/bin mmdebstrap --quiet --mode=root \
      --dpkgopt=force-unsafe-io \
      --dpkgopt='path-exclude=/usr/share/man/*' \
      --dpkgopt='path-exclude=/usr/share/locale/*' \
      --dpkgopt='path-exclude=/usr/share/info/*' \
      --dpkgopt='path-exclude=/usr/share/doc/*' \
      --dpkgopt='path-include=/usr/share/doc/*/copyright' \
      "$@" -
}
