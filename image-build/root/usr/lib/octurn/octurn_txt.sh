# shellcheck shell=sh
# Read by what applies octurn.txt, which is somebody's text, and only ever read: what is wrong there is said and left out,
# and never keeps the scanner from starting. $root is empty, or the folder that stands for / in a test.

# shellcheck disable=SC2154
run=$root/run/octurn-settings
file=$run/octurn.txt
stars='********' # in place of a password that is known
carriage_return=$(printf '\r')
byte_order_mark=$(printf '\357\273\277')

# forget_complaints: what this program has found wrong before.
forget_complaints() {
  [ -d "$run/errors" ] || mkdir "$run/errors"
  : >"$run/errors/${0##*/}"
}

# complain TEXT: a warning in the journal, and for octurn-status.txt.
complain() {
  printf '<4>octurn.txt: %s\n' "$*"
  printf 'octurn.txt: %s\n' "$*" >>"$run/errors/${0##*/}"
}

# trim TEXT: sets $trimmed to it, without the blanks around it.
trim() {
  trimmed=${1#"${1%%[![:space:]]*}"}
  trimmed=${trimmed%"${trimmed##*[![:space:]]}"}
}

# read_line REPORT: sets the setting that is in $line. What is none may be a misspelt secret: its name alone is reported.
# shellcheck disable=SC2034 # the variables are for whoever reads this file
read_line() {
  trim "$line"
  case $trimmed in
    '' | '#'*) return ;;
    *=*) ;;
    *)
      "$1" "line $number is no setting, NAME = VALUE"
      return
      ;;
  esac
  trim "${trimmed#*=}"
  value=$trimmed
  trim "${line%%=*}"
  case $trimmed=$value in
    wifi_password=* | page_password=* | ssh_key=*) ;;
    *=*_password* | name=*=* | wifi_country=*=* | time_zone=*=* | rig=*=* | turntable.*=*=* | scan.*=*=* | laser.*=*=*)
      # as of two lines that damage made one; what would be repeated may be a secret
      "$1" "line $number has two settings: each needs a line of its own"
      return
      ;;
  esac
  case $trimmed in
    *[!A-Za-z0-9_.-]*) "$1" "line $number is no setting, NAME = VALUE" ;;
    name) name=$value ;;
    page_password) page_password=$value ;;
    wifi_name) wifi_name=$value ;;
    wifi_password) wifi_password=$value ;;
    wifi_country) wifi_country=$value ;;
    time_zone) time_zone=$value ;;
    ssh_key) ssh_keys="$ssh_keys${value:+$value
}" ;;
    rig) rig=$value ;;
    turntable.* | scan.* | laser.* | sensor | memory_limit_mb | threads)
      settings="$settings$trimmed=$value
"
      ;;
    *[0-9.]*) "$1" "line $number is no setting, NAME = VALUE" ;;
    *) "$1" "line $number: there is no setting $trimmed" ;;
  esac
}

# read_settings REPORT [FILE]: sets a variable for each setting, empty if there is none, and calls REPORT for other lines.
# Without any other program, of which each takes its time while a machine starts.
# shellcheck disable=SC2034
read_settings() {
  name='' page_password='' wifi_name='' wifi_password='' wifi_country='' time_zone='' ssh_keys='' rig='' settings=''
  number=0
  while IFS= read -r line || [ -n "$line" ]; do
    number=$((number + 1))
    line=${line#"$byte_order_mark"}
    line=${line%"$carriage_return"}
    read_line "$1"
  done <"${2:-$file}"
}

# change_file COMMAND...: makes octurn.txt, on the card, too, what the command prints when it gets the file. Needs card.sh.
change_file() (
  exec 8>"$run/lock"
  flock 8
  "$@" <"$file" >"$file.new"
  [ -n "$root" ] || write_card octurn.txt "$file.new"
  mv "$file.new" "$file"
)

# hide SETTING: puts stars in the place of what it says.
hide() {
  change_file \
    sed "s/^\($byte_order_mark\|\)\([[:space:]]*$1[[:space:]]*=[[:space:]]*\)[^[:space:]\r][^\r]*/\1\2$stars/"
}
