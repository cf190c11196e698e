# shellcheck shell=sh
# Sourced by the steps that install Debian packages.

suite=trixie

# listed FILE: prints a list's names, separated by commas.
listed() { sed '/^#/d; /^$/d' "$1" | paste -sd, -; }

# debian OPTION...: runs mmdebstrap for the suite, without documentation except licences, in a mount namespace of its own.
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
