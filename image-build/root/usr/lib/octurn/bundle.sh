# shellcheck shell=sh
# Sourced by programs that inspect an update, octurn.update, before it is written.

# bundle_version FILE ERRORS: prints the version of an update from its first block, each of which is signed; nothing if that is not
# signed by the key that this scanner trusts.
bundle_version() {
  signify-openbsd -Vz -p /usr/lib/octurn/update.pub -x "$1" -m - 2>"$2" |
    gzip -dc 2>/dev/null |
    tar -x --occurrence=1 --to-stdout version 2>/dev/null |
    head -c 100 || true
}

running_version() { octurn --version | sed 's/.* //'; }

# is_older VERSION OTHER: compares versions; 0.9.1 is older than 0.10.0.
is_older() { [ "$1" != "$2" ] && [ "$(printf '%s\n' "$1" "$2" | sort -V | head -n 1)" = "$1" ]; }
