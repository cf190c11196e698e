// The appliance's digital twin: the image on QEMU's Raspberry Pi 3, a Kinect that its kernel has on USB, and a turntable on its
// chip's GPIO lines, whose pulses turn what the Kinect sees. Guest, Kinect and turntable go on beside each other, so that power
// can be cut while the platform stays where it is.

import {execFile} from 'node:child_process';
import {writeFile} from 'node:fs/promises';
import {promisify} from 'node:util';

import {measure} from '../web/mesh_file.js';
import {require, until} from './checks.mjs';
import {Guest, secondsSince} from './guest.mjs';
import {TwinKinect} from '../emulation/twin/kinect.mjs';
import {GpioWitness, Turntable} from '../emulation/twin/turntable.mjs';

const patience = 3600;  // seconds: the guest's own clock is what it waits by

// Of 30 frames a second. The guest renders them itself, and has more time for all else with few.
const speed = 0.2;

// A scan stays below by half.
const limits = {mean_mm: 1, p95_mm: 3, missing: 0.1};

export class Twin {
  #card;
  #made;
  #gpio;

  turntable = new Turntable();
  kinect;
  guest;

  /** @param {string} card  the folder of the card @param {string} made  what tests/emulation/twin/make has made */
  static async make(card, made) {
    const twin = new Twin();
    twin.#card = card;
    twin.#made = made;
    twin.kinect = await TwinKinect.listen(() => twin.turntable.angle);
    twin.#gpio = await GpioWitness.listen((line, level) => twin.turntable.change(line, level));
    return twin;
  }

  /** Starts the image, and plugs a Kinect in. @returns {Promise<string>} when the page was there */
  async start() {
    this.guest = await Guest.start('twin', this.#card, `${this.#made}/disk.img`, this.#gpio.options);
    const seconds = await this.guest.page(patience);
    const processor = await this.guest.processorSeconds();
    await this.#bringKinect();
    return `the page after ${seconds.toFixed(1)} s, ${processor.toFixed(1)} s of processor time`;
  }

  /** Plugs a Kinect into the guest's USB, by what is on its second disk. Of the drivers, those that run already fail. */
  async #bringKinect() {
    await this.guest.run('while ! [ -b /dev/sda ]; do sleep 1; done', patience);
    const there = await this.guest.run('mkdir -p /run/twin && tar -x -f /dev/sda -C /run/twin && cd /run/twin && ' +
      'while read -r driver; do insmod "$driver" 2>/dev/null; done <order; [ -d /sys/devices/platform/vhci_hcd.0 ] && ' +
      `systemd-run --quiet --unit=twin /run/twin/kinect 10.0.2.2 ${this.kinect.port} && echo there`, patience);
    require(there.endsWith('there'), `the Kinect's program does not start: ${there}`);
    await this.kinect.connected();
    await this.kinect.tell(`speed ${speed}`);
    await this.kinect.tell('plug');
  }

  /** Pulls the Pi's plug, at once, and the turntable's with it. */
  async cutPower() {
    await this.guest.cutPower();
    this.turntable.losePower();
  }

  /** Asks for something that needs the Kinect, as the page's Start does, once the daemon has found it. */
  #askWithKinect(path, settings) {
    return until('a Kinect', () => this.guest.ask(path, 'POST', settings).catch((error) => {
      require(error.message.includes('sensor-'), error.message);
      return undefined;
    }), patience);
  }

  /** @returns {Promise<string>} the path of the scan that starts */
  async startScan(settings) {
    const {id} = await this.#askWithKinect('scans', settings);
    return `scans/${id}`;
  }

  resume(scan) {
    return this.#askWithKinect(`${scan}/resume`);
  }

  /** Waits until a scan is as told. @param {(now: object) => boolean} isSo @returns {Promise<object>} the scan */
  reaches(scan, what, isSo) {
    return until(`${scan}: ${what}`, async () => {
      const now = await this.guest.ask(scan);
      return isSo(now) ? now : require(['running', 'paused'].includes(now.state), `${scan}: ${now.state} before ${what}`);
    }, patience);
  }

  /** Waits for the end of a scan that goes on by itself. @returns {Promise<object>} the scan */
  finishes(scan) {
    return this.reaches(scan, 'its end', (now) => {
      require(['running', 'finished'].includes(now.state), `${scan}: ${now.state} ${JSON.stringify(now.error)}`);
      return now.state === 'finished';
    });
  }

  /** @returns {Promise<Buffer>} the model of a scan */
  async download(scan) {
    const response = await fetch(`${this.guest.url}api/v1/${scan}/Scan.stl`, {signal: AbortSignal.timeout(1000 * patience)});
    require(response.ok, `${scan} has no model: ${response.status}`);
    return Buffer.from(await response.arrayBuffer());
  }

  /** @returns {Promise<object>} the model's triangles, and how far it is from the object that was on the platform */
  async measureModel(scan) {
    const bytes = await this.download(scan);
    await writeFile(`${this.#card}/Scan.stl`, bytes);
    const {triangles, openEdges, volume} = measure(bytes);
    require(openEdges === 0 && volume > 0, `the model has ${openEdges} open edges, and a volume of ${volume} mm3`);
    const {stdout} = await promisify(execFile)(`${this.#made}/model_error`, [`${this.#card}/Scan.stl`]);
    return {triangles, ...JSON.parse(stdout)};
  }

  /** @throws {Error}  unless a scan's model is the object that was on the platform @returns {Promise<string>} how good it is */
  async checkModel(scan) {
    const {triangles, mean_mm: mean, p95_mm: p95, max_mm: max, missing} = await this.measureModel(scan);
    const text = `${triangles} triangles, closed; off by ${mean.toFixed(2)} mm on average, 95 of 100 corners by at most ` +
      `${p95.toFixed(2)} mm, all by ${max.toFixed(2)} mm; ${(100 * missing).toFixed(1)} % of the object missing`;
    require(mean <= limits.mean_mm && p95 <= limits.p95_mm && missing <= limits.missing, `the model is not that object: ${text}`);
    return text;
  }

  async close() {
    await this.kinect.close();
    await this.#gpio.close();
  }
}

/** @returns {(text: string) => void} what prints a line with the seconds since this was called */
export function teller(name) {
  const begin = performance.now();
  return (text) => console.log(`${name}: ${secondsSince(begin).toFixed(0)} s: ${text}`);
}
