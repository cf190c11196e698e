// A USB camera for a machine that QEMU emulates: the guest's kernel, uvcvideo and libcamera are above a camera as any other.

import {setTimeout as sleep} from 'node:timers/promises';

import {UsbRedirection, message, status} from './usb_redirection.mjs';
import {answerControl, request} from './uvc_controls.mjs';
import {Mode, configuration, device, pictureEndpoint, speedOf, speeds, string} from './uvc_descriptors.mjs';
import {yuy2} from './yuy2.mjs';

const withoutEndpoint = 255;
const [controlType, bulkType] = [0, 2];

/** As many bytes as a transfer of uvcvideo has, 32 packets: so each begins with a header. */
const payloadOf = (lens) => 32 * speedOf(lens).packetBytes;

/** Of the emulated machine after a picture, in ms. */
const longestRest = 1500;

/** In which a host has seen that its transfers fail, and asks for no more of them, in ms. */
const failingTime = 1000;

export class UvcCamera {
  /** @type {UsbRedirection} */
  #bus;
  #waiting = [];  // transfers of the picture endpoint: {id, length}
  #picture = null;  // what of the picture is not sent yet
  #isExposing = false;
  #streams = 0;  // that have ended
  #number = 0;  // of pictures
  #begun = 0;  // when the picture began to be sent, ms
  #due = 0;  // the next picture, ms
  #timer = null;
  #asked;  // mode that the host has tried last
  #mode;  // that of pictures

  /** Whether it sends no more pictures. */
  #isSilent = false;

  /** Whether all transfers of the picture endpoint fail. */
  #isFailing = false;

  /** Whether it says of each picture that it is damaged. */
  isDamaged = false;

  /** What the host has set, by entity and number. @type {Map<string, number>} */
  values = new Map();

  /**
   * Waits for QEMU at a port of this machine's loopback.
   * @param {object} lens  its formats, and its speed
   * @param {(number: number, mode: Mode) => Uint8Array | Promise<Uint8Array>} look  the luminance of the next picture, row by row, or
   * that as a JPEG
   */
  static async listen(lens, look) {
    const camera = new UvcCamera();
    camera.lens = lens;
    camera.look = look;
    camera.#asked = camera.#mode = new Mode(lens);
    camera.#bus = await UsbRedirection.listen((type, id, body) => camera.#take(type, id, body), () => camera.#stop());
    return camera;
  }

  /** What QEMU is to be started with. The first port is the controller's own: QEMU's hub, which it puts at the last free one, has
   * full speed. */
  get options() {
    const place = speedOf(this.lens) === speeds.high ? ',port=1' : '';
    return ['-chardev', `socket,id=camera,host=127.0.0.1,port=${this.#bus.port}`, '-device', `usb-redir,chardev=camera,id=usb-camera${place}`];
  }

  get isSilent() {
    return this.#isSilent;
  }

  set isSilent(silent) {
    this.#isSilent = silent;
    this.#deliver();
  }

  /** Pulls the plug. */
  unplug() {
    this.#bus.send(message.disconnect, 0n);
    this.#stop();
  }

  /** Pulls the plug, after the transfers that wait have failed: QEMU's dwc2 would keep one of a device that is gone, and end at an
   * assertion when the guest uses its channel again. */
  async unplugSlowly() {
    this.#isFailing = true;
    this.#answerAll(status.stall);
    await sleep(failingTime);
    this.#isFailing = false;
    this.unplug();
  }

  /** Puts it in. */
  plug() {
    const every = (count, values, otherwise) => Buffer.from(Array.from({length: count}, (_, i) => values[i] ?? otherwise));
    const interfaces = Buffer.alloc(4 + 4 * 32);
    interfaces.writeUInt32LE(2);
    for (const [field, values] of [[0, 1], [14, 14], [1, 2], [0, 0]].entries()) {
      interfaces.set(values, 4 + 32 * field);
    }
    this.#bus.send(message.interfaces, 0n, interfaces);
    const pictures = 16 + (pictureEndpoint & 0x0f);  // those towards the host are the second half
    const types = every(32, {0: controlType, 16: controlType, [pictures]: bulkType}, withoutEndpoint);
    const sizes = Buffer.alloc(64);
    const {number: speed, packetBytes} = speedOf(this.lens);
    for (const [endpoint, bytes] of [[0, 64], [16, 64], [pictures, packetBytes]]) {
      sizes.writeUInt16LE(bytes, 2 * endpoint);
    }
    this.#bus.send(message.endpoints, 0n, Buffer.concat([types, Buffer.alloc(32), every(32, {[pictures]: 1}, 0), sizes]));
    this.#bus.send(message.connect, 0n, Buffer.from([speed, 0xef, 2, 1, 0x6b, 0x1d, 0x02, 0x01, 0x00, 0x01]));
  }

  async close() {
    this.#stop();
    await this.#bus.close();
  }

  #stop() {
    clearTimeout(this.#timer);
    this.#waiting = [];
    this.#picture = null;
    ++this.#streams;
  }

  #take(type, id, body) {
    switch (type) {
      case message.hello:
        return this.plug();
      case message.setConfiguration:
      case message.getConfiguration:
        return this.#bus.send(message.configuration, id, Buffer.from([status.success, 1]));
      case message.setAlternate:
      case message.getAlternate:
        return this.#bus.send(message.alternate, id, Buffer.from([status.success, body[0], 0]));
      case message.cancel:
        return this.#cancel(id);
      case message.control:
        return this.#control(id, body);
      case message.bulk:
        this.#waiting.push({id, head: body.subarray(0, 10), length: body.readUInt16LE(2) + 65536 * body.readUInt16LE(8)});
        return this.#isFailing ? this.#answerAll(status.stall) : this.#deliver();
    }
  }

  /** Ends the transfers that wait, without a picture. */
  #answerAll(state) {
    this.#waiting.splice(0).forEach((transfer) => this.#bulk(transfer, state, Buffer.alloc(0)));
  }

  #cancel(id) {
    const transfer = this.#waiting.find((other) => other.id === id);
    if (transfer) {
      this.#waiting = this.#waiting.filter((other) => other !== transfer);
      this.#bulk(transfer, status.cancelled, Buffer.alloc(0));
    }
  }

  #control(id, body) {
    const [endpoint, code, kind] = body;
    const [value, index, length] = [4, 6, 8].map((at) => body.readUInt16LE(at));
    const isIn = (endpoint & 0x80) !== 0;
    const answer = (kind & 0x60) === 0 ? this.#standard(code, value) : this.#class(code, value >> 8, index >> 8, index & 0xff, body.subarray(10));
    const head = Buffer.from(body.subarray(0, 10));
    head[3] = answer ? status.success : status.stall;
    const data = answer && isIn ? answer.subarray(0, length) : Buffer.alloc(0);
    head.writeUInt16LE(answer ? (isIn ? data.length : length) : 0, 8);
    this.#bus.send(message.control, id, head, data);
  }

  /** @returns {Buffer | null} null: the device has no such thing */
  #standard(code, value) {
    const [clearFeature, getDescriptor] = [1, 6];
    if (code === clearFeature) {
      this.#end();
    }
    if (code !== getDescriptor) {
      return Buffer.alloc(2);  // its status, or a feature that is cleared
    }
    const kinds = {1: device, 2: () => configuration(this.lens), 3: () => string(value & 0xff)};
    return kinds[value >> 8]?.() ?? null;
  }

  #class(code, selector, entity, number, data) {
    const streamingNumber = 1;
    if (number === streamingNumber) {
      return this.#negotiate(code, selector, data);
    }
    return answerControl(this.values, `${entity} ${selector}`, code, data);
  }

  /** The host asks for a mode, and commits to one. */
  #negotiate(code, selector, data) {
    const commit = 2;
    if (code === request.set) {
      this.#asked = new Mode(this.lens, data[2], data[3]);
      this.#mode = selector === commit ? this.#asked : this.#mode;
      return data;
    }
    return code === request.length ? Buffer.from([34, 0]) : code === request.info ? Buffer.from([3]) : this.#asked.control(payloadOf(this.lens));
  }

  /** The host ends the stream, of which uvcvideo tells a camera with a bulk endpoint by clearing its halt. QEMU's dwc2 does not cancel
   * transfers, and would write a later picture where they pointed. */
  #end() {
    this.#answerAll(status.success);
    this.#picture = null;
    ++this.#streams;
    this.#due = 0;
  }

  /** Sends what of the picture the transfers that wait have room for; the next picture when it is due. */
  #deliver() {
    while (this.#waiting.length > 0 && !this.#isSilent && !this.#isExposing) {
      if (!this.#picture) {
        const left = this.#due - performance.now();
        if (left > 0) {
          clearTimeout(this.#timer);
          this.#timer = setTimeout(() => this.#deliver(), left);
          return;
        }
        this.#expose();
        return;
      }
      const transfer = this.#waiting.shift();
      const part = this.#picture.subarray(0, Math.min(transfer.length, payloadOf(this.lens)) - 2);
      this.#picture = this.#picture.length > part.length ? this.#picture.subarray(part.length) : null;
      const isLast = this.#picture === null;
      if (isLast) {
        this.#rest();
      }
      const [endOfHeader, damaged, last] = [0x80, this.isDamaged ? 0x40 : 0, isLast ? 2 : 0];
      this.#bulk(transfer, status.success, Buffer.concat([Buffer.from([2, endOfHeader | damaged | last | this.#number & 1]), part]));
    }
  }

  /** The emulated machine has at least as long for a picture as it took to receive it: where it receives as fast as it can, it does
   * nothing else. But not as long as it takes for silence: where it waits, its clock is this machine's. */
  #rest() {
    const now = performance.now();
    this.#due = Math.max(this.#due, now + Math.min(now - this.#begun, longestRest));
  }

  /** Takes a picture, which is no more of use if the stream ends meanwhile. */
  async #expose() {
    this.#isExposing = true;
    const [mode, stream] = [this.#mode, this.#streams];
    this.#due = Math.max(this.#due, performance.now()) + 1000 / mode.picturesPerSecond;
    const seen = await this.look(++this.#number, mode);
    this.#isExposing = false;
    this.#begun = performance.now();
    if (stream === this.#streams) {
      this.#picture = mode.kind === 'mjpeg' ? Buffer.from(seen) : yuy2(mode, seen);
    }
    this.#deliver();
  }

  #bulk({id, head: of}, state, data) {
    const head = Buffer.from(of);
    head[1] = state;
    head.writeUInt16LE(data.length & 0xffff, 2);
    head.writeUInt16LE(data.length >> 16, 8);
    this.#bus.send(message.bulk, id, head, data);
  }
}
