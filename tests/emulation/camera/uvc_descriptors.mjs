// The descriptors of a camera of USB Video Class 1.1 with the formats YUY2 and MJPEG, and a bulk endpoint; fixed exposure
// and gain can be set, as of most cameras.

/** Little-endian integers, each as [value, bytes]. */
const integers = (...fields) => Buffer.concat(fields.map(([value, bytes]) => {
  const field = Buffer.alloc(bytes);
  field.writeUIntLE(value, 0, bytes);
  return field;
}));

/** A descriptor: its own length, and fields. */
function descriptor(...fields) {
  const rest = integers(...fields);
  return Buffer.concat([integers([rest.length + 1, 1]), rest]);
}

const video = 0x0e;
const control = 1;
const streaming = 2;
const classSpecific = 0x24;

/** The endpoint that pictures come from. */
export const pictureEndpoint = 0x81;

/** Entities of the video function, and their controls that can be set. */
export const cameraTerminal = 1;
export const processingUnit = 2;
const outputTerminal = 3;

/** Of a bus: its number in usbredir's protocol, and the bytes of a packet of the picture endpoint at most (USB 2.0, 5.8.3). */
export const speeds = {full: {number: 1, packetBytes: 64}, high: {number: 2, packetBytes: 512}};

/** That of a camera: of a full-speed bus if its lens says so. */
export const speedOf = (lens) => speeds[lens.speed ?? 'high'];

/** 100 ns from picture to picture. */
const interval = ({picturesPerSecond}) => Math.round(1e7 / picturesPerSecond);

/** Bytes of a picture at most, and of one that is not compressed. */
export const pictureBytes = ({width, height}) => 2 * width * height;

/**
 * The formats of a camera, with their sizes. One that tells its size alone has that in YUY2.
 * @typedef {{width: number, height: number, picturesPerSecond: number}} Size
 * @param {Size | {formats: {kind: 'yuy2' | 'mjpeg', sizes: Size[]}[]}} lens
 */
export const formats = (lens) => lens.formats ?? [{kind: 'yuy2', sizes: [lens]}];

export const device = () => descriptor([1, 1], [0x0200, 2], [0xef, 1], [2, 1], [1, 1], [64, 1], [0x1d6b, 2], [0x0102, 2], [0x0100, 2],
    [1, 1], [2, 1], [3, 1], [1, 1]);

function controlInterface() {
  const rest = Buffer.concat([
    descriptor([classSpecific, 1], [2, 1], [cameraTerminal, 1], [0x0201, 2], [0, 1], [0, 1], [0, 2], [0, 2], [0, 2], [3, 1],
        [0b1010, 3]),  // its mode of exposure, and its exposure
    descriptor([classSpecific, 1], [5, 1], [processingUnit, 1], [cameraTerminal, 1], [0, 2], [2, 1], [1 << 9, 2], [0, 1], [0, 1]),  // gain
    descriptor([classSpecific, 1], [3, 1], [outputTerminal, 1], [0x0101, 2], [0, 1], [processingUnit, 1], [0, 1]),
  ]);
  return Buffer.concat([
    descriptor([4, 1], [0, 1], [0, 1], [0, 1], [video, 1], [control, 1], [0, 1], [0, 1]),
    descriptor([classSpecific, 1], [1, 1], [0x0110, 2], [13 + rest.length, 2], [48_000_000, 4], [1, 1], [1, 1]),
    rest,
  ]);
}

const yuy2 = [[0x32595559, 4], [0x00100000, 4], [0xaa000080, 4], [0x719b3800, 4]];

/** @param {number} index  from 1 */
function formatDescriptors({kind, sizes}, index) {
  const isCompressed = kind === 'mjpeg';
  const head = isCompressed ? [[6, 1], [index, 1], [sizes.length, 1], [0, 1]] : [[4, 1], [index, 1], [sizes.length, 1], ...yuy2, [16, 1]];
  const frames = sizes.map((size, i) => {
    const bitsPerSecond = 8 * pictureBytes(size) * size.picturesPerSecond;
    return descriptor([classSpecific, 1], [isCompressed ? 7 : 5, 1], [i + 1, 1], [0, 1], [size.width, 2], [size.height, 2], [bitsPerSecond, 4],
        [bitsPerSecond, 4], [pictureBytes(size), 4], [interval(size), 4], [1, 1], [interval(size), 4]);
  });
  return Buffer.concat([
    descriptor([classSpecific, 1], ...head, [1, 1], [0, 1], [0, 1], [0, 1], [0, 1]),
    ...frames,
    descriptor([classSpecific, 1], [13, 1], [1, 1], [1, 1], [4, 1]),
  ]);
}

function streamingInterface(lens) {
  const all = formats(lens);
  const rest = Buffer.concat(all.map((format, i) => formatDescriptors(format, i + 1)));
  return Buffer.concat([
    descriptor([4, 1], [1, 1], [0, 1], [1, 1], [video, 1], [streaming, 1], [0, 1], [0, 1]),
    descriptor([classSpecific, 1], [1, 1], [all.length, 1], [13 + all.length + rest.length, 2], [pictureEndpoint, 1], [0, 1],
        [outputTerminal, 1], [0, 1], [0, 1], [0, 1], [1, 1], ...all.map(() => [0, 1])),
    rest,
    descriptor([5, 1], [pictureEndpoint, 1], [2, 1], [speedOf(lens).packetBytes, 2], [0, 1]),
  ]);
}

export function configuration(lens) {
  const rest = Buffer.concat([
    descriptor([11, 1], [0, 1], [2, 1], [video, 1], [3, 1], [0, 1], [0, 1]),
    controlInterface(),
    streamingInterface(lens),
  ]);
  return Buffer.concat([descriptor([2, 1], [9 + rest.length, 2], [2, 1], [1, 1], [0, 1], [0x80, 1], [250, 1]), rest]);
}

const names = ['Octurn', 'Camera of a test', '1'];

export function string(index) {
  const text = index === 0 ? integers([0x0409, 2]) : Buffer.from(names[index - 1] ?? '', 'utf16le');
  return Buffer.concat([integers([text.length + 2, 1], [3, 1]), text]);
}

/** What a host chooses of the formats, by their indices. */
export class Mode {
  constructor(lens, formatIndex = 1, sizeIndex = 1) {
    const format = formats(lens)[formatIndex - 1] ?? formats(lens)[0];
    const size = format.sizes[sizeIndex - 1] ?? format.sizes[0];
    Object.assign(this, size, {kind: format.kind});
    this.indices = [1 + formats(lens).indexOf(format), 1 + format.sizes.indexOf(size)];
  }

  /** As host and camera tell each other. @param {number} payload  bytes of a transfer at most */
  control(payload) {
    return integers([1, 2], ...this.indices.map((index) => [index, 1]), [interval(this), 4], [0, 2], [0, 2], [0, 2], [0, 2], [0, 2],
        [pictureBytes(this), 4], [payload, 4], [48_000_000, 4], [0, 1], [0, 1], [0, 1], [0, 1]);
  }
}
