# shellcheck shell=sh
# Read by `radio`, after wifi.sh: what the radio sees.

wpa() { wpa_cli -i wlan0 "$@" 2>/dev/null; }

# look_around: sets $found to the networks that are there, and answers them.
look_around() {
  wpa scan >/dev/null || true
  for _ in 1 2 3 4 5; do
    pass 2
    found=$(wpa scan_results) || found=
    [ "$(printf '%s\n' "$found" | wc -l)" -lt 2 ] || break
  done
  printf '%s\n' "$found" | answer networks
}

# why PASSWORD: what keeps the scanner from joining with or without one, yes or no, as far as can be seen from outside.
# shellcheck disable=SC2154
why() {
  ssid=$(wpa list_networks | sed -n 2p | cut -f2)
  flags=$(printf '%s\n' "$found" | SSID=$ssid awk -F'\t' '$5 "" == ENVIRON["SSID"] "" { printf "%s", $4 }')
  case $1$flags in
    yes | no) echo "$wifi_name was not found. Is the name right, and the router on and near enough?" ;;
    *EAP*) echo "$wifi_name asks for a user's name, which the scanner cannot give." ;;
    yes*PSK*) echo "$wifi_name was found, but does not let the scanner in. Is the password right?" ;;
    yes*SAE*) echo "$wifi_name takes WPA3 alone, and does not let the scanner in. Write its password again; or let the router offer WPA2, too." ;;
    yes*) echo "$wifi_name has no password: leave it out." ;;
    no*WPA* | no*RSN* | no*WEP*) echo "$wifi_name needs a password." ;;
    *) echo "$wifi_name was found, but does not let the scanner in." ;;
  esac
}

has_guests() { wpa all_sta | grep -q '^..:..:..:..:..:..$'; }

# has_cable: whether there is Ethernet.
has_cable() {
  for link in /sys/class/net/*; do
    { [ ! -e "$link/phy80211" ] && read -r type <"$link/type" && [ "$type" = 1 ] &&
      read -r carrier <"$link/carrier" && [ "$carrier" = 1 ]; } 2>/dev/null && return
  done
  return 1
}

# is_on: whether the radio is in a WiFi, or is one.
is_on() {
  read -r operstate </sys/class/net/wlan0/operstate && [ "$operstate" = up ]
}
