// A device on the USB of a machine that QEMU emulates: QEMU's own device usb-redir asks for what a real one would be asked on its bus
// (spice-space.org, usbredir protocol 0.7).

import {once} from 'node:events';
import {createServer} from 'node:net';

/** Types of messages. */
export const message = {
  hello: 0, connect: 1, disconnect: 2, reset: 3, interfaces: 4, endpoints: 5, setConfiguration: 6, getConfiguration: 7, configuration: 8,
  setAlternate: 9, getAlternate: 10, alternate: 11, cancel: 21, control: 100, bulk: 101,
};

/** How a transfer ended. */
export const status = {success: 0, cancelled: 1, stall: 4};

// Those that QEMU's xHCI wants: the device's version, an answer where it was unplugged, its endpoints' packet sizes, numbers of messages of
// 64 bits, and lengths of 32.
const capabilities = 1 << 1 | 1 << 3 | 1 << 4 | 1 << 5 | 1 << 6;

/** Bytes before a message: its type, its length, and its number, which is short in the first one. */
const [firstHead, laterHead] = [12, 16];

export class UsbRedirection {
  #server;
  #socket;
  #take;
  #end;
  #received;
  #head;  // of the next message

  /**
   * Waits for QEMU at a port of this machine's loopback.
   * @param {(type: number, id: bigint, body: Buffer) => void} take  a message of QEMU @param {() => void} end  when QEMU has ended
   */
  static async listen(take, end) {
    const bus = new UsbRedirection();
    bus.#take = take;
    bus.#end = end;
    bus.#server = createServer((socket) => bus.#welcome(socket)).listen(0, '127.0.0.1');
    await once(bus.#server, 'listening');
    return bus;
  }

  get port() {
    return this.#server.address().port;
  }

  /** Sends a message. */
  send(type, id, ...parts) {
    const head = Buffer.alloc(type === message.hello ? firstHead : laterHead);
    head.writeUInt32LE(type, 0);
    head.writeUInt32LE(parts.reduce((sum, part) => sum + part.length, 0), 4);
    if (type !== message.hello) {
      head.writeBigUInt64LE(id, 8);
    }
    this.#socket.write(Buffer.concat([head, ...parts]));
  }

  async close() {
    this.#socket?.destroy();
    this.#server.close();
    await once(this.#server, 'close');
  }

  #welcome(socket) {
    this.#socket = socket;
    this.#received = Buffer.alloc(0);
    this.#head = firstHead;
    socket.setNoDelay(true);
    socket.on('error', () => {});  // QEMU is killed, as power is cut
    socket.on('close', () => this.#end());
    socket.on('data', (data) => this.#receive(data));
    const hello = Buffer.alloc(68);
    hello.write('octurn camera');
    hello.writeUInt32LE(capabilities, 64);
    this.send(message.hello, 0n, hello);
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
}
