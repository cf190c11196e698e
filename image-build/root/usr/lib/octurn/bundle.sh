# shellcheck shell=sh
# Read by what looks into an update, octurn.update, before it is written.

# bundle_version FILE ERRORS: prints the version of an update, which is in its first block, for which the signature vouches as
# for each; nothing if that is not signed by the key that this scanner trusts.
bundle_version() {
  signify-openbsd -Vz -p /usr/lib/octurn/update.pub -x "$1" -m - 2>"$2" |
    gzip -dc 2>/dev/null |
    tar -x --occurrence=1 --to-stdout version 2>/dev/null |
    head -c 100 || true
}

running_version() { octurn --version | sed 's/.* //'; }

# is_older VERSION OTHER: 0.9.1 is older than 0.10.0.
is_older() { [ "$1" != "$2" ] && [ "$(printf '%s\n' "$1" "$2" | sort -V | head -n 1)" = "$1" ]; }
