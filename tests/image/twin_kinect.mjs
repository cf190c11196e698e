// The Kinect of the appliance's twin, plugged into the guest's USB by a program that the guest has on a second disk.

import {require} from './checks.mjs';
import {TwinKinect} from '../emulation/twin/kinect.mjs';

const patience = 3600;  // seconds: the guest's own clock is what it waits by

// Of 30 frames a second. The guest renders them itself, and has more time for all else with few.
const speed = 0.2;

export class GuestKinect extends TwinKinect {
  options = [];
  disk;

  /** @param {string} made  what tests/emulation/twin/make has made @param {() => Promise<number>} angle  of the platform */
  static async make(made, angle) {
    const kinect = await GuestKinect.listen(angle);
    kinect.disk = `${made}/disk.img`;
    return kinect;
  }

  change() {}

  /** Plugs it in. Of the drivers on the disk, those that run already fail. */
  async bring(guest) {
    await guest.run('while ! [ -b /dev/sda ]; do sleep 1; done', patience);
    const there = await guest.run('mkdir -p /run/twin && tar -x -f /dev/sda -C /run/twin && cd /run/twin && ' +
      'while read -r driver; do insmod "$driver" 2>/dev/null; done <order; [ -d /sys/devices/platform/vhci_hcd.0 ] && ' +
      `systemd-run --quiet --unit=twin /run/twin/kinect 10.0.2.2 ${this.port} && echo there`, patience);
    require(there.endsWith('there'), `the Kinect's program does not start: ${there}`);
    await this.connected();
    await this.tell(`speed ${speed}`);
    await this.tell('plug');
  }
}
