# shellcheck shell=sh
# Sourced by programs that set the host name and the time zone, from octurn.txt or for the page. $root is empty, or the folder that
# replaces / in a test.
# shellcheck disable=SC2154 # $name and $time_zone are read_settings'

# set_name: sets the host name to $name. Fails, with the reason in $wrong_name, if it is invalid.
set_name() {
  [ -n "$name" ] || return 0
  name=$(printf '%s\n' "$name" | tr '[:upper:]' '[:lower:]')
  case $name in
    *[!a-z0-9-]* | -* | *-) good= ;;
    *) good=yes ;;
  esac
  if [ -z "$good" ] || [ "${#name}" -gt 63 ]; then
    # shellcheck disable=SC2034
    wrong_name="name = $name: a name has letters, digits and hyphens between them, at most 63"
    return 1
  fi
  printf '%s\n' "$name" >"$root/etc/hostname"
  chmod 644 "$root/etc/hostname"
  [ -n "$root" ] || printf '%s\n' "$name" >/proc/sys/kernel/hostname
}

# set_time_zone: sets the time zone to $time_zone. Fails, with the reason in $wrong_zone, if there is no such zone.
set_time_zone() {
  [ -n "$time_zone" ] || return 0
  zone=$root/usr/share/zoneinfo/$time_zone
  case $time_zone in
    *[!A-Za-z0-9_+/-]*) zone=/dev/null ;;
  esac
  if [ "$(head -c 4 "$zone" 2>/dev/null)" = TZif ]; then
    ln -sf "$zone" "$root/etc/localtime"
    return 0
  fi
  # shellcheck disable=SC2034
  wrong_zone="time_zone = $time_zone: there is no such time zone; they are continents and cities, such as Europe/Berlin"
  return 1
}

# answer_machine [ERROR]: answers the daemon with the host name and the time zone.
answer_machine() {
  zone=$(readlink "$root/etc/localtime" 2>/dev/null) || zone=
  printf 'name = %s\ntime_zone = %s\nerror = %s\n' "$(cat "$root/etc/hostname" 2>/dev/null || true)" \
    "${zone##*/zoneinfo/}" "${1-}" | answer machine
}
