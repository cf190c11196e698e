# shellcheck shell=sh
# Read by what uses the card's FAT partition. It is mounted for the moment only, so that a plug that is pulled finds it at
# rest, and a card that is taken out is as other computers expect it.

card=/boot/firmware

# mount_card OPTIONS, unmount_card: one program at a time.
mount_card() {
  exec 9>/run/card/lock
  flock 9
  mount -t vfat -o "$1,noatime,nodev,nosuid,noexec,umask=0077" /run/card/1 "$card" || {
    exec 9>&-
    return 1
  }
}

unmount_card() {
  umount "$card"
  exec 9>&-
}

# read_card NAME TO: copies a file of the card, if it is there.
read_card() {
  mount_card ro || return
  [ ! -f "$card/$1" ] || cp "$card/$1" "$2"
  unmount_card
}

# write_card NAME FROM: makes a file of the card the same as FROM. It takes the place of the old one when it is complete
# on the card; then the old one's bytes, that may have been secret, are overwritten.
write_card() {
  mount_card rw,sync || return
  cp "$2" "$card/$1.new"
  exec 3<>"$card/$1"
  mv -f "$card/$1.new" "$card/$1"
  head -c "$(stat -L -c %s /proc/self/fd/3)" /dev/zero |
    dd of=/proc/self/fd/3 bs=64k conv=notrunc,fsync status=none
  exec 3>&-
  unmount_card
}
