// The camera with line lasers of the appliance's twin: on the guest's USB, before a platform that turns elsewhere, and lasers that
// the guest's GPIO lines light. Pictures are rendered by Octurn's own laser simulator: see laser_camera.cpp.

import {spawn} from 'node:child_process';
import {once} from 'node:events';

import {UvcCamera} from '../camera/uvc_camera.mjs';
import {LaserLines} from './laser_lines.mjs';

const patience = 3600;  // seconds: the guest's own clock is what it waits by

/** The program that renders. */
class Renderer {
  #program;
  #picture = Buffer.alloc(0);
  #bytes;
  #come;

  /** @param {string} file @param {{width: number, height: number, fx: number, fy: number, cx: number, cy: number}} lens */
  constructor(file, {width, height, fx, fy, cx, cy}) {
    this.#bytes = width * height;
    this.#program = spawn(file, [width, height, fx, fy, cx, cy], {stdio: ['pipe', 'pipe', 'inherit']});
    this.#program.stdin.on('error', () => {});  // it has ended: no picture comes any more
    this.#program.stdout.on('data', (data) => {
      this.#picture = Buffer.concat([this.#picture, data]);
      if (this.#picture.length >= this.#bytes) {
        const picture = this.#picture;
        this.#picture = Buffer.alloc(0);
        this.#come(picture);
      }
    });
  }

  /** One picture at a time. @param {number} angle  of the platform @param {string} lit @returns {Promise<Buffer>} luminance */
  render(angle, lit) {
    return new Promise((come) => {
      this.#come = come;
      this.#program.stdin.write(`${angle} ${lit}\n`);
    });
  }

  async close() {
    this.#program.stdin.end();
    if (this.#program.exitCode === null && this.#program.signalCode === null) {
      await once(this.#program, 'exit');
    }
  }
}

export class TwinLaserCamera {
  #angle;
  #renderer;
  #camera;

  lasers = new LaserLines();

  /** How many pictures showed which laser. */
  pictures = {none: 0, left: 0, right: 0};

  /**
   * @param {string} program  laser_camera @param {object} lens  of the camera
   * @param {() => Promise<number>} angle  of the platform, once earlier changes of lines have been told
   */
  static async listen(program, lens, angle) {
    const twin = new TwinLaserCamera();
    twin.#angle = angle;
    twin.#renderer = new Renderer(program, lens);
    twin.#camera = await UvcCamera.listen({...lens, speed: 'full'}, () => twin.#look());
    return twin;
  }

  /** What QEMU is to be started with. */
  get options() {
    return this.#camera.options;
  }

  /** A line of the chip changes. */
  change(line, level) {
    this.lasers.change(line, level);
  }

  /** It is plugged in from the start. */
  async bring(guest) {
    await guest.run('while ! [ -e /dev/video0 ]; do sleep 1; done', patience);
  }

  /** @returns {Promise<void>} when its plug is out */
  unplug() {
    return this.#camera.unplugSlowly();
  }

  plug() {
    this.#camera.plug();
  }

  async close() {
    await this.#camera.close();
    await this.#renderer.close();
  }

  /** The picture as it is now. If a laser is switched while it is rendered, it is rendered again: the guest counts a picture's age
   * from when it comes. */
  async #look() {
    for (;;) {
      const angle = await this.#angle();
      const {lit} = this.lasers;
      const picture = await this.#renderer.render(angle, lit);
      await this.#angle();
      if (lit === this.lasers.lit) {
        ++this.pictures[lit];
        return picture;
      }
    }
  }
}
