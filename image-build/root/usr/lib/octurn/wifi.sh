# shellcheck shell=sh
# Read by what applies the WiFi of octurn.txt, after octurn_txt.sh and answer.sh.

# shellcheck disable=SC2154
# Lines with a WiFi's name in hexadecimal, its key, and its password in hexadecimal while that may be needed; the newest first.
kept=$root/data/wifi
configuration=$root/etc/wpa_supplicant/wpa_supplicant-wlan0.conf

# hotspot: the scanner's own WiFi's name.
hotspot() { echo "Octurn-$(head -c 4 /etc/machine-id | tr '[:lower:]' '[:upper:]')"; }

hexadecimal() { printf '%s' "$1" | od -An -v -tx1 | tr -d ' \n'; }

# key NAME PASSWORD: the 256 bits that WPA2 makes of both, in hexadecimal. Some routers print these as the password.
key() {
  if printf '%s' "$2" | grep -qxE '[0-9a-fA-F]{64}'; then
    printf '%s\n' "$2"
  else
    printf '%s\n' "$2" | wpa_passphrase "$1" | sed -n 's/^[[:space:]]*psk=//p'
  fi
}

# find_key REPORT: sets $key, empty for an open WiFi, and $password, in hexadecimal, empty if it is not known; fails if the
# password is none.
# shellcheck disable=SC2154
find_key() {
  key='' password=''
  case $wifi_password in
    '') return 0 ;;
    "$stars")
      key=$(sed -n "s/^$network //p" "$kept" 2>/dev/null | head -n 1) || true
      password=${key#"${key%% *}"}
      password=${password# }
      key=${key%% *}
      [ -n "$key" ] || "$1" "wifi_password = $stars: the password of this WiFi is not known here: write it again"
      ;;
    *)
      key=$(key "$wifi_name" "$wifi_password" 2>/dev/null) || true
      [ -n "$key" ] ||
        "$1" "wifi_password has ${#wifi_password} letters: 8 to 63 without accents, or none for an open WiFi"
      # A router that prints a key is joined with that, and so by WPA2.
      [ "$key" = "$wifi_password" ] || password=$(hexadecimal "$wifi_password")
      ;;
  esac
  [ -n "$key" ]
}

# known: the line of the WiFi that was found.
known() { echo "$network $key${password:+ $password}"; }

# forget_password: WPA2 needs the key alone. Of WPA3 nothing can be kept in the password's place.
forget_password() { sed 's/^\([^ ]* [^ ]*\) .*/\1/' "$kept" | keep; }

# find_wifi REPORT: of the settings that were read, sets $network, the name in hexadecimal, $country, $key and $password;
# fails if it cannot be joined with these, and calls REPORT for what is wrong.
find_wifi() {
  if [ "$(printf %s "$wifi_name" | wc -c)" -gt 32 ]; then
    "$1" "wifi_name = $wifi_name: at most 32 bytes"
    return 1
  fi
  country=$(echo "$wifi_country" | tr '[:lower:]' '[:upper:]')
  case $country in
    [A-Z][A-Z]) ;;
    *)
      "$1" "wifi_country = $wifi_country: two letters, such as DE; the WiFi may not be found without"
      country=
      ;;
  esac
  network=$(hexadecimal "$wifi_name")
  find_key "$1"
}

# keep: makes what comes in the known keys; fails if there is no data partition.
keep() {
  { [ -n "$root" ] || mountpoint -q /data; } &&
    cat >"$kept.new" && sync "$kept.new" && mv "$kept.new" "$kept" && sync "${kept%/*}"
}

# answer_wifi STATE [ERROR [HOTSPOT]]: for the daemon, and so for the page.
answer_wifi() {
  {
    printf 'state = %s\nname = %s\ncountry = %s\n' "$1" "$wifi_name" "$wifi_country"
    [ -z "${2-}" ] || printf 'error = %s\n' "$2"
    [ -z "${3-}" ] || printf 'hotspot = %s\n' "$3"
  } | answer wifi
}
