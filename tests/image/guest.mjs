// A machine in QEMU that boots from a card like the Raspberry Pi's firmware would.

import {execFile, spawn} from 'node:child_process';
import {once} from 'node:events';
import {createWriteStream} from 'node:fs';
import {readFile} from 'node:fs/promises';
import {createServer} from 'node:net';
import {setTimeout as sleep} from 'node:timers/promises';
import {promisify} from 'node:util';

import {wakeUp} from '../emulation/wake_up.mjs';

/** The differences between QEMU's machines: options, the name of the console on QEMU's standard output, and the timeout of its page's
 * answers where it is more than 3 seconds. */
const machines = {
  virt: {
    console: 'ttyAMA0',
    options: ({card, forward}) => [
      '-M', 'virt', '-cpu', 'max,pauth-impdef=on', '-smp', '2', '-m', '1024',
      '-serial', 'stdio',
      '-drive', `if=none,id=card,format=raw,file=${card}/card.img`, '-device', 'virtio-blk-pci,drive=card',
      '-netdev', `user,id=net,${forward}`, '-device', 'virtio-net-pci,netdev=net,romfile=',
      '-device', 'virtio-rng-pci',
    ],
    usb: ['-device', 'qemu-xhci'],
    kernel: ['norandmaps'],  // otherwise QEMU 7.2 translates a library again for each process
  },
  raspi3b: {
    console: 'ttyS1',
    options: ({card, forward}) => [
      '-M', 'raspi3b', '-dtb', `${card}/bcm2837-rpi-3-b.dtb`,
      '-serial', 'null', '-serial', 'stdio',
      '-drive', `if=sd,format=raw,file=${card}/card.img`,
      '-netdev', `user,id=net,${forward}`, '-device', 'usb-net,netdev=net',
    ],
    usb: [],
    kernel: ['systemd.watchdog_sec=0'],  // the emulated watchdog fires as soon as it is set
  },
};

/** @returns {Promise<number>} a free port of this machine's loopback */
async function freePort() {
  const server = createServer().listen(0, '127.0.0.1');
  await once(server, 'listening');
  const {port} = server.address();
  server.close();
  await once(server, 'close');
  return port;
}

/** Reads a file of the FAT partition. @param {string} card  the folder with card.img */
export async function readCard(card, name) {
  return (await promisify(execFile)('mtype', ['-i', `${card}/card.img@@1M`, `::${name}`])).stdout;
}

/** Extracts the files that the Pi's firmware loads, those of the system that config.txt selects, into the card's folder. */
async function readSystem(card) {
  const system = (await readCard(card, 'config.txt')).match(/^os_prefix=(.*)$/m)[1];
  const files = ['vmlinuz', 'initrd.img', 'cmdline.txt', 'bcm2837-rpi-3-b.dtb'].map((file) => `::${system}${file}`);
  await promisify(execFile)('mcopy', ['-n', '-i', `${card}/card.img@@1M`, ...files, card]);
}

/** Seconds since `start`, of performance.now(). */
export const secondsSince = (start) => (performance.now() - start) / 1000;

// The daemon's watchdog, for a guest whose clock goes on while this machine does other work.
const patientWatchdog = 'systemd.set_credential_binary=systemd.unit-dropin.octurn.service:' +
  Buffer.from('[Service]\nWatchdogSec=600\n').toString('base64');

// The guest's clock counts instructions, half a billion a second, however busy this machine is.
machines.twin = {...machines.raspi3b, pace: ['-icount', 'shift=1'], answers: 40};

export class Guest {
  #qemu;
  #said = '';
  #commands = 0;
  #answers;  // timeout of the page's answers, seconds

  /** Switches on. @param {'virt' | 'raspi3b' | 'twin'} name @param {string} card  the folder with card.img
   * @param {string} [stick]  the image of a USB stick that is plugged in
   * @param {string[]} [more]  options of QEMU */
  static async start(name, card, stick, more = []) {
    await readSystem(card);
    const port = await freePort();
    const machine = machines[name];
    const line = (await readFile(`${card}/cmdline.txt`, 'utf8')).trim().replace(/console=\S+ */g, '');
    // The test runs commands in a debug shell on the console, which the image itself does not have.
    const kernel = [line, `console=${machine.console}`, `systemd.debug_shell=${machine.console}`,
      `systemd.mask=serial-getty@${machine.console}.service`, 'systemd.show_status=0',
      // An emulated machine is slow on a busy host, but systemd's timeouts run in real time.
      'systemd.default_device_timeout_sec=600', 'systemd.default_timeout_start_sec=600',
      ...(machine.pace ? [] : [patientWatchdog]), ...machine.kernel];
    const guest = new Guest();
    guest.start = performance.now();
    guest.url = `http://127.0.0.1:${port}/`;
    guest.#answers = machine.answers ?? 3;
    guest.#qemu = spawn('qemu-system-aarch64', [
      '-display', 'none', '-monitor', 'none', '-no-reboot', ...(machine.pace ?? ['-accel', 'tcg,thread=multi']),
      '-kernel', `${card}/vmlinuz`, '-initrd', `${card}/initrd.img`, '-append', kernel.join(' '),
      ...machine.options({card, forward: `hostfwd=tcp:127.0.0.1:${port}-:80`}),
      ...(stick ? [...machine.usb, '-drive', `if=none,id=stick,format=raw,readonly=on,file=${stick}`,
        '-device', 'usb-storage,drive=stick'] : []),
      ...more,
    ], {stdio: 'pipe'});
    wakeUp(guest.#qemu);
    const end = () => guest.#qemu.kill('SIGKILL');
    process.once('exit', end);
    guest.#qemu.once('exit', () => process.off('exit', end));
    const log = createWriteStream(`${card}/console.log`);
    guest.#qemu.stderr.pipe(log, {end: false});
    guest.#qemu.stdout.setEncoding('utf8').on('data', (text) => {
      guest.#said += text;
      log.write(text);
    });
    return guest;
  }

  /** Polls until `ready` resolves to something other than undefined. */
  async #until(what, seconds, ready) {
    const begin = performance.now();
    while (secondsSince(begin) < seconds) {
      const answer = await ready();
      if (answer !== undefined) {
        return answer;
      }
      if (this.#qemu.exitCode !== null) {
        throw new Error(`QEMU ended with ${this.#qemu.exitCode} before ${what}`);
      }
      await sleep(100);
    }
    throw new Error(`no ${what} within ${seconds} s; the console ends:\n${this.#said.slice(-2000)}`);
  }

  /** @returns {Promise<number>} seconds from power-on to the page */
  async page(seconds) {
    let found;
    const ask = async () => {
      try {
        const response = await fetch(this.url, {signal: AbortSignal.timeout(1000 * this.#answers)});
        if ((await response.text()).includes('<title>')) {
          found ??= secondsSince(this.start);
        }
      } catch {
        // QEMU accepts connections before the guest listens, and these are lost; so new ones are made meanwhile.
      }
    };
    return this.#until('page', seconds, async () => {
      ask();
      await sleep(130 * this.#answers);
      return found;
    });
  }

  /** @returns {Promise<number>} CPU seconds of QEMU so far, which do not depend on other load */
  async processorSeconds() {
    const fields = (await readFile(`/proc/${this.#qemu.pid}/stat`, 'utf8')).replace(/^.*\) /, '').split(' ');
    return (Number(fields[11]) + Number(fields[12])) / 100;  // user and system, in clock ticks of 1/100 s
  }

  /** Calls the API. @returns {Promise<any>} */
  async ask(path, method = 'GET', body = undefined) {
    const response = await fetch(`${this.url}api/v1/${path}`, {
      method, headers: {'Content-Type': 'application/json'}, body: body && JSON.stringify(body),
      signal: AbortSignal.timeout(600_000)}).catch((error) => {
      throw new Error(`${method} ${path}: ${error.cause ?? error}`);
    });
    if (!response.ok) {
      throw new Error(`${method} ${path}: ${response.status} ${await response.text()}`);
    }
    return response.json();
  }

  /** Starts a scan as soon as the sensor has sent its first frame, which takes long on an emulated processor. */
  async startScan(settings, seconds) {
    return this.#until('scan', seconds, async () => {
      try {
        return await this.ask('scans', 'POST', settings);
      } catch (error) {
        if (!error.message.includes('sensor-silent')) {
          throw error;
        }
      }
      return undefined;
    });
  }

  /** Runs a command in the guest, as root. @returns {Promise<string>} what it prints */
  async run(command, seconds = 600) {
    const name = `command-${++this.#commands}`;
    const begin = this.#said.length;
    // The console echoes the command line, so the line must not contain the marks in their printed form.
    this.#qemu.stdin.write(`\nprintf '<%s\\n' ${name}; ${command}; printf '%s>\\n' ${name}\n`);
    const output = new RegExp(`<${name}\\r?\\n([^]*?)${name}>`);
    return this.#until(`answer to "${command}"`, seconds, () => {
      const text = this.#said.slice(begin).replace(/\x1b\[[0-9;?]*[a-zA-Z]|\x1b\][^\x07\x1b]*(\x07|\x1b\\)/g, '');
      return output.exec(text)?.[1].replaceAll('\r', '').trim();
    });
  }

  /** Waits until the machine reboots, which ends QEMU. */
  async restarts(seconds) {
    if (!this.#ended()) {
      await once(this.#qemu, 'exit', {signal: AbortSignal.timeout(seconds * 1000)});
    }
  }

  #ended() {
    return this.#qemu.exitCode !== null || this.#qemu.signalCode !== null;
  }

  /** Cuts the power. */
  async cutPower() {
    if (!this.#ended()) {
      this.#qemu.kill('SIGKILL');
      await once(this.#qemu, 'exit');
    }
  }
}
