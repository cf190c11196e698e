# shellcheck shell=sh
# Sourced by root's services, which answer the unprivileged daemon by files that it reads and the page shows. $root is empty, or
# the folder that replaces / in a test.

# answer NAME: writes standard input to the answer NAME, atomically.
answer() (
  umask 022
  folder=${root-}/run/octurn-appliance
  new=$(mktemp "$folder/.answer.XXXXXX")
  cat >"$new"
  chmod 644 "$new"
  mv "$new" "$folder/$1"
)
