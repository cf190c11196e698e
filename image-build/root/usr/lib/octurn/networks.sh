# shellcheck shell=sh
# Sourced by `radio`, after wifi.sh: functions about the networks in reach.

wpa() { wpa_cli -i wlan0 "$@" 2>/dev/null; }

# look_around: scans, sets $found to the networks in reach, and answers the daemon with them.
look_around() {
  wpa scan >/dev/null || true
  for _ in 1 2 3 4 5; do
    pass 2
    found=$(wpa scan_results) || found=
    [ "$(printf '%s\n' "$found" | wc -l)" -lt 2 ] || break
  done
  printf '%s\n' "$found" | answer networks
}

# why PASSWORD: prints why the scanner cannot join the network, as far as can be seen from outside. PASSWORD: yes or no.
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

# has_cable: whether Ethernet is connected.
has_cable() {
  for link in /sys/class/net/*; do
    { [ ! -e "$link/phy80211" ] && read -r type <"$link/type" && [ "$type" = 1 ] &&
      read -r carrier <"$link/carrier" && [ "$carrier" = 1 ]; } 2>/dev/null && return
  done
  return 1
}

# is_on: whether the radio has joined a WiFi, or is the hotspot.
is_on() {
  read -r operstate </sys/class/net/wlan0/operstate && [ "$operstate" = up ]
}
