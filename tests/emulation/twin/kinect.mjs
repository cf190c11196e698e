// The Kinect of the appliance's twin, as its test tells it what to do: see kinect.cpp, which runs in the guest.

import {once} from 'node:events';
import {createServer} from 'node:net';
import {createInterface} from 'node:readline';

export class TwinKinect {
  #server;
  #socket;
  #waiting = [];

  /** Waits for the guest's program at a port of this machine's loopback. @param {() => Promise<number>} angle  of the platform */
  static async listen(angle) {
    const kinect = new this();
    kinect.#server = createServer((socket) => kinect.#welcome(socket, angle)).listen(0, '127.0.0.1');
    await once(kinect.#server, 'listening');
    return kinect;
  }

  get port() {
    return this.#server.address().port;
  }

  /** Waits for the guest's program. */
  async connected() {
    if (!this.#socket) {
      await once(this.#server, 'connection');
    }
  }

  /** @param {string} order @returns {Promise<string>} the answer */
  ask(order) {
    this.#socket.write(`${order}\n`);
    return new Promise((come) => this.#waiting.push(come));
  }

  /** Has it carry out an order. @throws {Error}  unless it does */
  async tell(order) {
    const answer = await this.ask(order);
    if (answer !== 'ok') {
      throw new Error(`the Kinect, told "${order}": ${answer}`);
    }
  }

  /** @returns {Promise<{sent: number, damaged: number}>} of its frames so far */
  async frames() {
    const [sent, damaged] = (await this.ask('frames')).split(' ').map(Number);
    return {sent, damaged};
  }

  /** @returns {Promise<{count: number, half: number, most: number, longest: number}>} how many of its transfers were submitted again
   * since the last call, and how long half of them, 99 of 100 and the last took until then, milliseconds */
  async delays() {
    const [count, ...times] = (await this.ask('delays')).split(' ').map(Number);
    const [half, most, longest] = times.map((time) => time / 1000);
    return {count, half, most, longest};
  }

  async close() {
    this.#socket?.destroy();
    this.#server.close();
    await once(this.#server, 'close');
  }

  #welcome(socket, angle) {
    this.#socket = socket;
    socket.setNoDelay(true);
    socket.on('error', () => {});  // the guest loses power
    socket.once('close', () => {
      if (this.#socket === socket) {
        this.#socket = undefined;
        this.#waiting = [];
      }
    });
    createInterface({input: socket}).on('line', (line) => {
      if (line === 'look') {
        angle().then((radians) => socket.write(`angle ${radians}\n`));
      } else {
        this.#waiting.shift()(line);
      }
    });
  }
}
