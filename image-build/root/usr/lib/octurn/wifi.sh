# shellcheck shell=sh
# Sourced by programs that apply the WiFi of octurn.txt, after octurn_txt.sh, answer.sh and card.sh.

# shellcheck disable=SC2154
# One line for each WiFi, newest first: name in hexadecimal, key, and the password in hexadecimal while it may be needed.
kept=$root/data/wifi
configuration=$root/etc/wpa_supplicant/wpa_supplicant-wlan0.conf

# hotspot: prints the name of the scanner's own WiFi.
hotspot() { echo "Octurn-$(head -c 4 /etc/machine-id | tr '[:lower:]' '[:upper:]')"; }

hexadecimal() { printf '%s' "$1" | od -An -v -tx1 | tr -d ' \n'; }

# key NAME PASSWORD: prints WPA2's 256-bit key (PSK) of both, in hexadecimal. Some routers have it printed as the password.
key() {
  if printf '%s' "$2" | grep -qxE '[0-9a-fA-F]{64}'; then
    printf '%s\n' "$2"
  else
    printf '%s\n' "$2" | wpa_passphrase "$1" | sed -n 's/^[[:space:]]*psk=//p'
  fi
}

# find_key REPORT: sets $key, empty for an open WiFi, and $password, in hexadecimal, empty if unknown; fails if the password is
# invalid.
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
      # A key in place of the password can be used by WPA2 only.
      [ "$key" = "$wifi_password" ] || password=$(hexadecimal "$wifi_password")
      ;;
  esac
  [ -n "$key" ]
}

# known: prints the line for $network.
known() { echo "$network $key${password:+ $password}"; }

# forget_password: deletes stored passwords, as WPA2 needs the key only. WPA3 needs the password itself.
forget_password() { sed 's/^\([^ ]* [^ ]*\) .*/\1/' "$kept" | keep; }

# find_wifi REPORT: sets $network (the name in hexadecimal), $country, $key and $password from the settings; if these are not valid,
# calls REPORT with the error and fails.
find_wifi() {
  bytes=$(printf %s "$wifi_name" | wc -c)
  if [ "$bytes" -gt 32 ]; then
    "$1" "wifi_name has $bytes bytes: at most 32"
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

# keep: replaces the stored lines by standard input; fails if there is no data partition.
keep() {
  { [ -n "$root" ] || has_data; } &&
    cat >"$kept.new" && sync "$kept.new" && mv "$kept.new" "$kept" && sync "${kept%/*}"
}

# answer_wifi STATE [ERROR [HOTSPOT]]: answers the daemon, and so the page.
answer_wifi() {
  {
    printf 'state = %s\nname = %s\ncountry = %s\n' "$1" "$wifi_name" "$wifi_country"
    [ -z "${2-}" ] || printf 'error = %s\n' "$2"
    [ -z "${3-}" ] || printf 'hotspot = %s\n' "$3"
  } | answer wifi
}
