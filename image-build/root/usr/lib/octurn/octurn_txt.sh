# shellcheck shell=sh
# Read by what applies octurn.txt, which is somebody's text, and only ever read: what is wrong there is said and left out,
# and never keeps the scanner from starting. $root is empty, or the folder that stands for / in a test.

# shellcheck disable=SC2154
run=$root/run/octurn-settings
file=$run/octurn.txt
carriage_return=$(printf '\r')
byte_order_mark=$(printf '\357\273\277')

# complain TEXT: for the journal, and for octurn-status.txt.
complain() {
  printf 'octurn.txt: %s\n' "$*"
  printf 'octurn.txt: %s\n' "$*" >>"$run/errors"
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
  case $trimmed in
    name) name=$value ;;
    wifi_name) wifi_name=$value ;;
    wifi_password) wifi_password=$value ;;
    wifi_country) wifi_country=$value ;;
    rig) rig=$value ;;
    *) "$1" "line $number: there is no setting $trimmed" ;;
  esac
}

# read_settings REPORT: sets a variable for each setting, empty if there is none, and calls REPORT for other lines. Without
# any other program, of which each takes its time while a machine starts.
read_settings() {
  name='' wifi_name='' wifi_password='' wifi_country='' rig=''
  number=0
  while IFS= read -r line || [ -n "$line" ]; do
    number=$((number + 1))
    line=${line#"$byte_order_mark"}
    line=${line%"$carriage_return"}
    read_line "$1"
  done <"$file"
}
