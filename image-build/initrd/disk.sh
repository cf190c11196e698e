# shellcheck shell=dash
# Sourced by init: finds the card, and writes its partition table. Each change is within one sector, so that the table is valid even
# if power fails.

# number_at OFFSET DISK: the four bytes there, as eight hexadecimal digits.
number_at() {
  dd if="$2" bs=1 skip="$1" count=4 2>/dev/null | hexdump -e '1/4 "%08x"'
}

# octurn_disk NAMED TRIES: prints the disk that is an Octurn card, by the serial number of its FAT, and has the disk signature NAMED.
# After 20 tries, or if nothing was named yet, any Octurn card.
octurn_disk() {
  any=
  for disk in /sys/block/mmcblk* /sys/block/sd* /sys/block/vd*; do
    [ -e "$disk" ] || continue
    disk=/dev/${disk##*/}
    [ "$(number_at $((0x100043)) "$disk")" = @signature@ ] || continue
    if [ "$(number_at 440 "$disk")" = "$1" ]; then
      echo "$disk"
      return
    fi
    any=${any:-$disk}
  done
  if [ "$1" = 00000000 ] || [ "$2" -ge 20 ]; then
    echo "$any"
  fi
}

# little_endian NUMBER: its four bytes.
little_endian() {
  for shift in 0 8 16 24; do
    # shellcheck disable=SC2059 # the format is the byte
    printf "\\$(printf %03o $(($1 >> shift & 255)))"
  done
}

# grow DISK PARTITION: extends the fourth and last partition to the disk's end.
grow() {
  fourth=/sys/class/block/${2#/dev/}4
  sectors=$(($(cat "/sys/block/${1#/dev/}/size") - $(cat "$fourth/start")))
  if [ "$sectors" -gt "$(($(cat "$fourth/size") + 2048))" ]; then
    say "growing ${2}4 to $((sectors / 2048)) MiB"
    little_endian "$sectors" | dd of="$1" bs=1 seek=506 conv=notrunc,fsync 2>/dev/null
    blockdev --rereadpt "$1"
    : >/run/card/grown
  fi
}

# signature_of DISK MARK: prints its signature. A new card gets one of its own, since Windows takes the second of two
# alike offline. A card that was updated does not: an older system that comes back would look for the image's.
signature_of() {
  signature=$(number_at 440 "$1")
  if [ "$signature" = @signature@ ] && [ -z "$2" ]; then
    signature=$(cat "/sys/block/${1#/dev/}/device/cid" /proc/sys/kernel/random/uuid 2>/dev/null | md5sum | head -c 8)
    little_endian "0x$signature" | dd of="$1" bs=1 seek=440 conv=notrunc,fsync 2>/dev/null
  fi
  echo "$signature"
}
