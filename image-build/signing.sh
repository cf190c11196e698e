# shellcheck shell=sh
# Sourced by programs that sign updates. A scanner trusts the key with which its image was built.

signing_keys=${XDG_CONFIG_HOME:-$HOME/.config}/octurn

make_signing_keys() {
  [ ! -e "$signing_keys/update.sec" ] || return 0
  say "making a key for updates, $signing_keys/update.sec: keep it, and keep it secret; scanners take updates of no other"
  (
    umask 077
    mkdir -p "$signing_keys"
    signify-openbsd -G -n -c Octurn -p "$signing_keys/update.pub" -s "$signing_keys/update.sec"
  )
}

# sign FILE TO: signs each block, so that a reader can verify the file as a stream. The signature contains the key's path.
sign() {
  (cd "$signing_keys" && signify-openbsd -Sz -n -s update.sec -m "$1" -x "$2.new")
  mv "$2.new" "$2"
}
