# shellcheck shell=sh
# Read by what has to do with the two systems on the card, of which one runs. The sector after the partition table tells how
# the last update went, as MARK=SLOT VERSION:
#
#   try    the update is complete, and config.txt about to name it
#   tried  it has been started, once; the initrd undoes it if it is started again like this
#   kept   it has proven good

read -r command_line </proc/cmdline
# shellcheck disable=SC2034 # for whoever reads this file
case " $command_line " in
  *" octurn.slot=b "*) slot=b other=a other_root=/run/card/2 ;;
  *) slot=a other=b other_root=/run/card/3 ;;
esac

read_mark() { dd if=/run/card/disk bs=512 skip=1 count=1 status=none | tr -d '\0'; }

write_mark() { echo "$*" | dd of=/run/card/disk bs=512 seek=1 conv=notrunc,sync,fsync status=none; }

# answer_update STATE VERSION [ERROR]: for the daemon, and so for the page.
answer_update() {
  printf 'slot = %s\nstate = %s\nversion = %s\nerror = %s\n' "$slot" "$1" "$2" "${3-}" | answer update
}
