# shellcheck shell=sh
# Read by what answers the daemon, which may not do what root may: files that it reads, and the page shows. $root is empty,
# or the folder that stands for / in a test.

# answer NAME: makes the answer NAME of what comes in, whole.
answer() (
  umask 022
  folder=${root-}/run/octurn-appliance
  new=$(mktemp "$folder/.answer.XXXXXX")
  cat >"$new"
  chmod 644 "$new"
  mv "$new" "$folder/$1"
)
