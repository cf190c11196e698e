# shellcheck shell=sh
# Sourced by ./run and ./test at the top of the repository: prepares the machine for a build.

say() { printf '%s\n' "octurn: $*"; }

fail() {
  printf '%s\n' "octurn: $*" >&2
  exit 1
}

as_root() {
  if [ "$(id -u)" = 0 ]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    fail "packages are missing; become root or install sudo, or run: apt-get install $missing"
  fi
}

# missing_packages SECTION...: prints the packages of these sections of .ci/packages that are not installed.
missing_packages() {
  for section in "$@"; do
    sed -n "/^\[$section\]/,/^\[/s/^[a-z0-9]/&/p" .ci/packages
  done | while read -r package command; do
    command=${command#(}
    command=${command%)}
    if [ -n "$command" ] && command -v "$command" >/dev/null; then
      continue
    fi
    state=$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null) || state=
    [ "$state" = "ii " ] || printf '%s ' "$package"
  done
}

# apt_get ARGUMENT...: runs apt-get, with its output in build/packages.log, and tells how far it is.
apt_get() {
  rm -f build/packages.failed
  {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -y -o DPkg::Lock::Timeout=300 -o APT::Status-Fd=1 "$@" \
      2>&1 </dev/null || : >build/packages.failed
  } | {
    told=
    # Example of a line of progress: "pmstatus:cmake:34.5:Unpacking cmake (amd64)".
    while IFS= read -r line; do
      case $line in
        dlstatus:*) doing="downloading packages" ;;
        pmstatus:*) doing="installing packages" ;;
        *)
          printf '%s\n' "$line" >>build/packages.log
          continue
          ;;
      esac
      percent=${line#*:*:}
      tens="$doing, ${percent%%.*}"
      tens="${tens%[0-9]}0 %"
      [ "$tens" = "$told" ] || say "$tens"
      told=$tens
    done
  }
  [ ! -e build/packages.failed ]
}

# install_packages SECTION...: installs missing packages; needs no network if there are none.
install_packages() {
  command -v dpkg-query >/dev/null || fail "this needs Debian or one of its relatives"
  for section in "$@"; do
    grep -qxF "[$section]" .ci/packages || fail ".ci/packages has no section [$section]"
  done
  missing=$(missing_packages "$@")
  [ -n "$missing" ] || return 0
  say "installing Debian packages (log in build/packages.log): $missing"
  mkdir -p build
  : >build/packages.log
  # shellcheck disable=SC2086 # a list of names
  apt_get install --no-install-recommends $missing || {
    say "updating the package lists first"
    apt_get update && apt_get install --no-install-recommends $missing
  } || {
    tail -n 20 build/packages.log >&2
    fail "apt-get could not install: $missing"
  }
}

# compilers: prints how many compilers may run at a time: one a core, as far as there is memory for 0.7 GB each.
compilers() {
  available=$(awk '/^MemAvailable:/ { print int($2 / 700000) }' /proc/meminfo)
  cores=$(nproc)
  [ "${available:-1}" -ge 1 ] || available=1
  echo $((available < cores ? available : cores))
}

# build PRESET [BUILD_PRESET]: configures build/PRESET and builds it, or only the targets of BUILD_PRESET; with ccache,
# if installed.
build() {
  if [ -e "build/$1/build.ninja" ]; then
    say "building build/$1: what has changed"
  else
    say "building build/$1: the first time takes minutes"
  fi
  mkdir -p build
  if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER="${CMAKE_CXX_COMPILER_LAUNCHER-ccache}"
  fi
  if ! cmake --preset "$1" >"build/$1.log" 2>&1; then
    cat "build/$1.log" >&2
    return 1
  fi
  NINJA_STATUS='[%p, step %f of %t, %es] ' cmake --build --preset "${2-$1}" -j "$(compilers)"
}
