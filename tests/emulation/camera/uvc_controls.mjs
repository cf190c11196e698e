// The exposure and gain controls of a USB Video Class camera.

import {cameraTerminal, processingUnit} from './uvc_descriptors.mjs';

/** Request codes of the video class. */
export const request = {set: 0x01, current: 0x81, min: 0x82, max: 0x83, resolution: 0x84, length: 0x85, info: 0x86, default: 0x87};

/** Controls by entity and selector: bytes, minimum, maximum, resolution, default. */
const controls = new Map([
  [`${cameraTerminal} 2`, {bytes: 1, min: 1, max: 8, resolution: 0b1001, default: 8}],  // exposure mode: 1 manual, 8 aperture priority
  [`${cameraTerminal} 4`, {bytes: 4, min: 1, max: 5000, resolution: 1, default: 333}],  // exposure time, units of 100 us
  [`${processingUnit} 4`, {bytes: 2, min: 0, max: 255, resolution: 1, default: 64}],  // gain
]);

/** @param {Map<string, number>} values  set by the host, by entity and selector @returns {Buffer | null} null: there is no such control */
export function answerControl(values, key, code, data) {
  const control = controls.get(key);
  if (!control) {
    return null;
  }
  if (code === request.set) {
    values.set(key, data.readUIntLE(0, control.bytes));
    return data;
  }
  const told = {
    [request.current]: values.get(key) ?? control.default, [request.min]: control.min, [request.max]: control.max,
    [request.resolution]: control.resolution, [request.default]: control.default,
  };
  const answer = Buffer.alloc(control.bytes);
  answer.writeUIntLE(told[code] ?? 0, 0, control.bytes);
  return code === request.info ? Buffer.from([3]) : code === request.length ? Buffer.from([control.bytes, 0]) : answer;
}
