# shellcheck shell=sh
# The card's layout, sourced by the steps that make it. MBR, as a Pi 3 supports no other table; sizes in MiB.
#
#   1  FAT    the Pi's firmware, octurn.txt, and in a/ and b/ the kernels of the two roots
#   2  root a squashfs
#   3  root b squashfs, for updates
#   4  data   ext4, made at the first start, when it has grown to the end of the card
#
# The sector after the MBR holds the mark of the last update: see initrd/init.

# shellcheck disable=SC2034
{
  signature=4f637475 # serial number of the FAT: how the initrd knows a card; and of the partition table until the first start
  boot_size=192
  root_size=256
  data_size=8
}
