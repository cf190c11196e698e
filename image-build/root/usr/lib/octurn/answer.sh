# shellcheck shell=sh
# Read by what answers the daemon, which may not do what root may: files that it reads, and the page shows.

# answer NAME: makes the answer NAME of what comes in, whole.
answer() (
  umask 022
  new=$(mktemp /run/octurn-appliance/.answer.XXXXXX)
  cat >"$new"
  chmod 644 "$new"
  mv "$new" "/run/octurn-appliance/$1"
)
