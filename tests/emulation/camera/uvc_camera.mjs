// A USB camera for a machine that QEMU emulates: QEMU's device usb-redir asks for what a real one would be asked on its bus
// (spice-space.org, usbredir protocol 0.7), so that the guest's kernel, uvcvideo and libcamera are above a camera as any other.

import {once} from 'node:events';
import {createServer} from 'node:net';

import {answerControl, request} from './uvc_controls.mjs';
import {Mode, configuration, device, pictureBytes, pictureEndpoint, string} from './uvc_descriptors.mjs';

const message = {
  hello: 0, connect: 1, disconnect: 2, reset: 3, interfaces: 4, endpoints: 5, setConfiguration: 6, getConfiguration: 7, configuration: 8,
  setAlternate: 9, getAlternate: 10, alternate: 11, cancel: 21, control: 100, bulk: 101,
};
const status = {success: 0, cancelled: 1, stall: 4};
const withoutEndpoint = 255;
const [controlType, bulkType] = [0, 2];

// Those that QEMU's xHCI wants: the device's version, an answer where it was unplugged, its endpoints' packet sizes, numbers of messages of
// 64 bits, and lengths of 32.
const capabilities = 1 << 1 | 1 << 3 | 1 << 4 | 1 << 5 | 1 << 6;

/** Bytes before a message: its type, its length, and its number, which is short in the first one. */
const [firstHead, laterHead] = [12, 16];

/** As many as a transfer of uvcvideo has, 32 packets: so each begins with a header. */
const payloadBytes = 32 * 512;

/** Of the emulated machine after a picture, in ms. */
const longestRest = 1500;

export class UvcCamera {
  #server;
  #socket;
  #received = Buffer.alloc(0);
  #head = firstHead;  // of the next message
  #waiting = [];  // transfers of the picture endpoint: {id, length}
  #picture = null;  // what of the picture is not sent yet
  #number = 0;  // of pictures
  #begun = 0;  // when the picture was exposed, ms
  #due = 0;  // the next picture, ms
  #timer = null;
  #asked;  // mode that the host has tried last
  #mode;  // that of pictures

  /** Whether it sends no more pictures. */
  #isSilent = false;

  /** Whether it says of each picture that it is damaged. */
  isDamaged = false;

  /** What the host has set, by entity and number. @type {Map<string, number>} */
  values = new Map();

  /**
   * Waits for QEMU at a port of this machine's loopback.
   * @param {object} lens  its formats
   * @param {(number: number, mode: Mode) => Uint8Array} look  the luminance of the next picture, row by row, or that as a JPEG
   */
  static async listen(lens, look) {
    const camera = new UvcCamera();
    camera.lens = lens;
    camera.look = look;
    camera.#asked = camera.#mode = new Mode(lens);
    camera.#server = createServer((socket) => camera.#welcome(socket)).listen(0, '127.0.0.1');
    await once(camera.#server, 'listening');
    return camera;
  }

  /** What QEMU is to be started with. The first port is the controller's own: QEMU's hub, which it puts at the last free one, is
   * too slow for the camera. */
  get options() {
    const {port} = this.#server.address();
    return ['-chardev', `socket,id=camera,host=127.0.0.1,port=${port}`, '-device', 'usb-redir,chardev=camera,id=usb-camera,port=1'];
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
    this.#send(message.disconnect, 0n);
    this.#stop();
  }

  /** Puts it in. */
  plug() {
    const every = (count, values, otherwise) => Buffer.from(Array.from({length: count}, (_, i) => values[i] ?? otherwise));
    const interfaces = Buffer.alloc(4 + 4 * 32);
    interfaces.writeUInt32LE(2);
    for (const [field, values] of [[0, 1], [14, 14], [1, 2], [0, 0]].entries()) {
      interfaces.set(values, 4 + 32 * field);
    }
    this.#send(message.interfaces, 0n, interfaces);
    const pictures = 16 + (pictureEndpoint & 0x0f);  // those towards the host are the second half
    const types = every(32, {0: controlType, 16: controlType, [pictures]: bulkType}, withoutEndpoint);
    const sizes = Buffer.alloc(64);
    for (const [endpoint, bytes] of [[0, 64], [16, 64], [pictures, 512]]) {
      sizes.writeUInt16LE(bytes, 2 * endpoint);
    }
    this.#send(message.endpoints, 0n, Buffer.concat([types, Buffer.alloc(32), every(32, {[pictures]: 1}, 0), sizes]));
    const highSpeed = 2;
    this.#send(message.connect, 0n, Buffer.from([highSpeed, 0xef, 2, 1, 0x6b, 0x1d, 0x02, 0x01, 0x00, 0x01]));
  }

  async close() {
    this.#stop();
    this.#socket?.destroy();
    this.#server.close();
    await once(this.#server, 'close');
  }

  #stop() {
    clearTimeout(this.#timer);
    this.#waiting = [];
    this.#picture = null;
  }

  #welcome(socket) {
    this.#socket = socket;
    socket.setNoDelay(true);
    socket.on('error', () => {});  // QEMU is killed, as power is cut
    socket.on('close', () => this.#stop());
    socket.on('data', (data) => this.#receive(data));
    const hello = Buffer.alloc(68);
    hello.write('octurn camera');
    hello.writeUInt32LE(capabilities, 64);
    this.#send(message.hello, 0n, hello);
  }

  #send(type, id, ...parts) {
    const head = Buffer.alloc(type === message.hello ? firstHead : laterHead);
    head.writeUInt32LE(type, 0);
    head.writeUInt32LE(parts.reduce((sum, part) => sum + part.length, 0), 4);
    if (type !== message.hello) {
      head.writeBigUInt64LE(id, 8);
    }
    this.#socket.write(Buffer.concat([head, ...parts]));
  }

  #receive(data) {
    this.#received = Buffer.concat([this.#received, data]);
    while (this.#received.length >= this.#head) {
      const end = this.#head + this.#received.readUInt32LE(4);
      if (this.#received.length < end) {
        return;
      }
      const [whole, head] = [this.#received.subarray(0, end), this.#head];
      this.#received = this.#received.subarray(end);
      this.#head = laterHead;
      this.#take(whole.readUInt32LE(0), head === laterHead ? whole.readBigUInt64LE(8) : 0n, whole.subarray(head));
    }
  }

  #take(type, id, body) {
    switch (type) {
      case message.hello:
        return this.plug();
      case message.setConfiguration:
      case message.getConfiguration:
        return this.#send(message.configuration, id, Buffer.from([status.success, 1]));
      case message.setAlternate:
      case message.getAlternate:
        return this.#send(message.alternate, id, Buffer.from([status.success, body[0], 0]));
      case message.cancel:
        return this.#cancel(id);
      case message.control:
        return this.#control(id, body);
      case message.bulk:
        this.#waiting.push({id, head: body.subarray(0, 10), length: body.readUInt16LE(2) + 65536 * body.readUInt16LE(8)});
        return this.#deliver();
    }
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
    this.#send(message.control, id, head, data);
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
    return code === request.length ? Buffer.from([34, 0]) : code === request.info ? Buffer.from([3]) : this.#asked.control(payloadBytes);
  }

  /** The host ends the stream, of which uvcvideo tells a camera with a bulk endpoint by clearing its halt. QEMU's dwc2 does not cancel
   * transfers, and would write a later picture where they pointed. */
  #end() {
    this.#waiting.splice(0).forEach((transfer) => this.#bulk(transfer, status.success, Buffer.alloc(0)));
    this.#picture = null;
    this.#due = 0;
  }

  /** Sends what of the picture the transfers that wait have room for; the next picture when it is due. */
  #deliver() {
    while (this.#waiting.length > 0 && !this.#isSilent) {
      if (!this.#picture) {
        const left = this.#due - performance.now();
        if (left > 0) {
          clearTimeout(this.#timer);
          this.#timer = setTimeout(() => this.#deliver(), left);
          return;
        }
        this.#expose();
      }
      const transfer = this.#waiting.shift();
      const part = this.#picture.subarray(0, Math.min(transfer.length, payloadBytes) - 2);
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

  #expose() {
    this.#begun = performance.now();
    this.#due = Math.max(this.#due, this.#begun) + 1000 / this.#mode.picturesPerSecond;
    const seen = this.look(++this.#number, this.#mode);
    if (this.#mode.kind === 'mjpeg') {
      this.#picture = Buffer.from(seen);
      return;
    }
    this.#picture = Buffer.alloc(pictureBytes(this.#mode), 128);  // no colour
    for (let i = 0; i < seen.length; ++i) {
      this.#picture[2 * i] = seen[i];
    }
  }

  #bulk({id, head: of}, state, data) {
    const head = Buffer.from(of);
    head[1] = state;
    head.writeUInt16LE(data.length & 0xffff, 2);
    head.writeUInt16LE(data.length >> 16, 8);
    this.#send(message.bulk, id, head, data);
  }
}
