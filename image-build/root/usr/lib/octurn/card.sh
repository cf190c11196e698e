# shellcheck shell=sh
# Sourced by programs that use the card's partitions. The FAT is mounted only while it is used, so that it is clean if
# power fails or the card is removed.

card=/boot/firmware

# mount_card OPTIONS, unmount_card: with a lock, for one program at a time.
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

# has_data: whether the data partition is mounted. In a sandbox, each folder that may be written to is a mount point.
has_data() { [ "$(stat -c %d /data)" != "$(stat -c %d /)" ]; }

# read_card NAME TO: copies a file of the card, if it is there.
read_card() {
  mount_card ro || return
  [ ! -f "$card/$1" ] || cp "$card/$1" "$2"
  unmount_card
}

# write_card NAME FROM: replaces a file of the card by a copy of FROM, once the copy is complete on the card. Then the old file's
# bytes, which may contain secrets, are overwritten.
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
