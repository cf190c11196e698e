# shellcheck shell=sh
# Sourced by programs that deal with the card's two systems, of which one runs. The sector after the partition table holds the state
# of the last update as MARK=SLOT VERSION:
#
#   try    the update is complete, and config.txt is about to select it
#   tried  it has been booted once; if it is booted again in this state, the initrd rolls it back
#   kept   it has proven good

read -r command_line </proc/cmdline
# shellcheck disable=SC2034 # used by scripts that source this file
case " $command_line " in
  *" octurn.slot=b "*) slot=b other=a other_root=/run/card/2 ;;
  *) slot=a other=b other_root=/run/card/3 ;;
esac

read_mark() { dd if=/run/card/disk bs=512 skip=1 count=1 status=none | tr -d '\0'; }

write_mark() { echo "$*" | dd of=/run/card/disk bs=512 seek=1 conv=notrunc,sync,fsync status=none; }

# answer_update STATE VERSION [ERROR]: answers the daemon, and so the page.
answer_update() {
  printf 'slot = %s\nstate = %s\nversion = %s\nerror = %s\n' "$slot" "$1" "$2" "${3-}" | answer update
}
