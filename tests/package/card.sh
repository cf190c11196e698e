# shellcheck shell=sh
# Sourced by tests of the appliance's programs for octurn.txt. They run the programs on a folder that replaces /.

if ! command -v wpa_passphrase >/dev/null; then
  echo "needs wpa_passphrase, of the package wpasupplicant"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
programs=image-build/root/usr/lib/octurn
run=$work/root/run/octurn-settings
appliance=$work/root/run/octurn-appliance

# start: runs the programs that run at boot; their output is in $said.
start() {
  rm -rf "$work/root/etc" "$work/root/root"
  mkdir -p "$work/root/etc/octurn" "$work/root/data" "$run" "$appliance/requests" "$work/root/usr/share/zoneinfo/Europe"
  cp systemd/octurn.json "$work/root/etc/octurn/"
  printf 'TZif2' >"$work/root/usr/share/zoneinfo/Europe/Berlin"
  said=$(for program in settings page-password wifi; do
    "$programs/$program" "$work/root" || echo "$program failed"
  done | sed 's/^<4>//')
  [ "$said" = "$(cat "$run/errors/settings" "$run/errors/page-password" "$run/errors/wifi")" ]
}

# apply FORMAT: boots a new card whose octurn.txt is printf's output.
apply() {
  rm -rf "$work/root"
  mkdir -p "$run"
  # shellcheck disable=SC2059 # the format is the file
  printf "$1" >"$run/octurn.txt"
  start
}

# expect TEXT FILE: fails unless TEXT is a whole line of the file.
expect() {
  grep -qxF -- "$1" "$2" || {
    echo "no line '$1' in $2:"
    cat "$2"
    exit 1
  }
}

# answered WORDS: fails unless the output contains them.
answered() {
  case $said in
    *"$1"*) ;;
    *)
      echo "the answer should have '$1', and is '$said'"
      exit 1
      ;;
  esac
}

# refused FORMAT WORDS FILE [TEXT]: fails unless the output contains WORDS and FILE is not made, or does not contain TEXT.
refused() {
  apply "$1"
  answered "$2"
  if [ -e "$3" ] && grep -q -- "${4-}" "$3"; then
    echo "'$1' made $3"
    exit 1
  fi
}
