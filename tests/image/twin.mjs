// The appliance's digital twin: the image on QEMU's Raspberry Pi 3, a sensor that its kernel has on USB, and a turntable on its
// chip's GPIO lines, whose pulses turn what the sensor sees. Guest, sensor and turntable go on beside each other, so that power
// can be cut while the platform stays where it is.

import {execFile} from 'node:child_process';
import {writeFile} from 'node:fs/promises';
import {promisify} from 'node:util';

import {measure} from '../web/mesh_file.js';
import {require, until} from './checks.mjs';
import {Guest, secondsSince} from './guest.mjs';
import {GpioObserver, Turntable} from '../emulation/twin/turntable.mjs';

const patience = 3600;  // seconds: the guest's own clock is what it waits by

// Of a scan with a Kinect, which stays below by half.
const depthLimits = {mean_mm: 1, median_mm: 1, p95_mm: 3, missing: 0.1};

/**
 * What a twin looks with.
 * @typedef {object} Sensor
 * @property {string} [disk]  the image of a USB stick that the guest has for it
 * @property {string[]} options  of QEMU, for it
 * @property {(line: number, level: 0 | 1) => void} change  told of the chip's lines
 * @property {(guest: Guest) => Promise<void>} bring  to a guest that has started
 * @property {() => Promise<void>} close
 */

export class Twin {
  #card;
  #made;
  #gpio;

  turntable = new Turntable();
  /** @type {Sensor} */
  sensor;
  guest;

  /** @param {string} card  the folder of the card @param {string} made  with the programs of tests/emulation/twin
   * @param {(angle: () => Promise<number>) => Promise<Sensor>} makeSensor  given what tells the platform's angle */
  static async make(card, made, makeSensor) {
    const twin = new Twin();
    twin.#card = card;
    twin.#made = made;
    twin.sensor = await makeSensor(async () => {
      await twin.#gpio.refresh();
      return twin.turntable.angle;
    });
    twin.#gpio = await GpioObserver.listen((line, level) => {
      twin.turntable.change(line, level);
      twin.sensor.change(line, level);
    }, (seconds) => twin.turntable.pass(seconds));
    return twin;
  }

  /** Starts the image, and plugs the sensor in. @returns {Promise<string>} when the page was there */
  async start() {
    this.guest = await Guest.start('twin', this.#card, this.sensor.disk, [...this.#gpio.options, ...this.sensor.options]);
    const seconds = await this.guest.page(patience);
    const processor = await this.guest.processorSeconds();
    await this.sensor.bring(this.guest);
    return `the page after ${seconds.toFixed(1)} s, ${processor.toFixed(1)} s of processor time`;
  }

  /** Pulls the Pi's plug, at once, and the turntable's with it. */
  async cutPower() {
    await this.guest.cutPower();
    this.turntable.losePower();
  }

  /** Asks for something that needs the sensor, as the page's Start does, once the daemon has found it. */
  #askWithSensor(path, settings) {
    return until('a sensor', () => this.guest.ask(path, 'POST', settings).catch((error) => {
      require(error.message.includes('sensor-'), error.message);
      return undefined;
    }), patience);
  }

  /** @returns {Promise<string>} the path of the scan that starts */
  async startScan(settings) {
    const {id} = await this.#askWithSensor('scans', settings);
    return `scans/${id}`;
  }

  resume(scan) {
    return this.#askWithSensor(`${scan}/resume`);
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

  /** @throws {Error}  unless a scan's model is the object that was on the platform @returns {Promise<string>} how good it is
   * @param {{mean_mm: number, median_mm: number, p95_mm: number, missing: number}} limits */
  async checkModel(scan, limits = depthLimits) {
    const {triangles, ...error} = await this.measureModel(scan);
    const mm = (key) => `${error[`${key}_mm`].toFixed(2)} mm`;
    const text = `${triangles} triangles, closed; off by ${mm('mean')} on average, half of the corners by at most ${mm('median')}, ` +
      `95 of 100 by ${mm('p95')}, all by ${mm('max')}; ${(100 * error.missing).toFixed(1)} % of the object missing`;
    require(Object.keys(limits).every((key) => error[key] <= limits[key]), `the model is not that object: ${text}`);
    return text;
  }

  async close() {
    await this.sensor.close();
    await this.#gpio.close();
  }
}

/** @returns {(text: string) => void} what prints a line with the seconds since this was called */
export function teller(name) {
  const begin = performance.now();
  return (text) => console.log(`${name}: ${secondsSince(begin).toFixed(0)} s: ${text}`);
}
