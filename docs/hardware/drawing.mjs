// Draws the wooden boards with their dimensions: node drawing.mjs drawing.svg. Boards and sizes are those of boards.scad.

import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

const folder = import.meta.dirname ?? new URL('.', import.meta.url).pathname;

/** Values of OpenSCAD's variables, by name. */
export function values(...names) {
  const scratch = mkdtempSync(join(tmpdir(), 'octurn-'));
  try {
    const asks = join(scratch, 'asks.scad');
    const echoes = join(scratch, 'values.echo');
    const asked = names.map((name) => `${name} = ${name}`).join(', ');
    writeFileSync(asks, `include <${join(folder, 'boards.scad')}>\necho(${asked});\n`);
    execFileSync('openscad', ['-o', echoes, asks], {stdio: 'pipe'});
    // ECHO: name = value, name = value
    const said = readFileSync(echoes, 'utf8').trim().replace(/^ECHO: /, '');
    return Object.fromEntries(names.map((name, i) => {
      const begin = said.indexOf(`${name} = `) + name.length + 3;
      const end = i + 1 < names.length ? said.indexOf(`, ${names[i + 1]} = `, begin) : said.length;
      return [name, JSON.parse(said.slice(begin, end))];
    }));
  } finally {
    rmSync(scratch, {recursive: true});
  }
}

const scale = 1 / 5;
const paper = {width: 420, height: 297}; // A3
const between = 3.4; // the least distance of two numbers on a side

/** What the boards are for, and a corner of its heading. */
const groups = {'For both rigs': [28, 270], 'Tower of the Kinect': [28, 146], 'Board of camera and lasers': [262, 180]};

/** Where the lower left corner of each board is on the paper, from the left and from the bottom. */
const places = {
  'Base': [28, 190],
  'Rail': [28, 159],
  'Platform': [240, 200],
  'Upright': [28, 34],
  'Tower foot': [66, 64],
  'Shelf': [112, 74],
  'Cheek': [112, 34],
  'Tower back': [156, 34],
  'Laser board': [262, 92],
  'Laser foot': [374, 92],
  'Gusset': [262, 34],
};

/** A sheet of plywood, and the lower left corner on it of each piece; `turned` ones lie on their side. */
export const sheet = [1200, 800];
const both = [['Base', 0, 0], ['Platform', 908, 0], ['Rail', 0, 351], ['Rail', 0, 394]];
export const cuts = {
  'Sheet for the Kinect': {place: [156, 78], pieces: [...both, ['Cheek', 908, 283], ['Cheek', 1041, 283],
    ['Upright', 0, 437, 'turned'], ['Upright', 0, 540, 'turned'], ['Tower foot', 503, 437, 'turned'],
    ['Shelf', 854, 437, 'turned'], ['Tower back', 503, 580]]},
  'Sheet for the lasers': {place: [330, 20], pieces: [...both, ['Laser board', 0, 437], ['Laser foot', 443, 437, 'turned'],
    ['Gusset', 443, 560], ['Gusset', 544, 560]]},
};

/** @returns {number[]} width and height of a board */
export function size([, , outline]) {
  return outline.length === 1 ? [outline[0], outline[0]] :
    [0, 1].map((axis) => Math.max(...outline.map((corner) => corner[axis])));
}

const mm = (value) => String(Math.round(value * 10) / 10);
const line = (x1, y1, x2, y2, kind) => `<path class="${kind}" d="M${mm(x1)} ${mm(y1)}L${mm(x2)} ${mm(y2)}"/>`;

/** Moves numbers on a side apart where they would touch. @returns places in the order of `wanted`, ascending */
function spread(wanted) {
  const spaced = [...wanted];
  for (let i = 1; i < spaced.length; ++i) {
    spaced[i] = Math.max(spaced[i], spaced[i - 1] + between);
  }
  const excess = (spaced.at(-1) - wanted.at(-1)) / 2;
  return spaced.map((place) => place - (excess > 0 ? excess : 0));
}

const distinct = (numbers) => [...new Set(numbers.map((number) => Math.round(number * 10) / 10))].sort((a, b) => a - b);

/** One board, with the distances of its edges, holes and windows from its lower left corner. */
function drawn([name, pieces, outline, holes, windows]) {
  const disc = outline.length === 1;
  const radius = disc ? outline[0] / 2 : 0;
  const corners = disc ? [[-radius, -radius], [radius, radius]] : outline;
  const [left, bottom] = [0, 1].map((axis) => Math.min(...corners.map((corner) => corner[axis])));
  const [right, top] = [0, 1].map((axis) => Math.max(...corners.map((corner) => corner[axis])));
  const place = places[name];
  const x = (value) => place[0] + (value - left) * scale;
  const y = (value) => paper.height - place[1] - (value - bottom) * scale;
  const parts = [disc
    ? `<circle class="board" cx="${mm(x(0))}" cy="${mm(y(0))}" r="${mm(radius * scale)}"/>`
    : `<path class="board" d="M${outline.map(([px, py]) => `${mm(x(px))} ${mm(y(py))}`).join('L')}Z"/>`];
  for (const [px, py, diameter] of holes) {
    parts.push(`<circle class="hole" cx="${mm(x(px))}" cy="${mm(y(py))}" r="${mm(diameter / 2 * scale)}"/>`);
  }
  for (const [px, py, width, height] of windows) {
    parts.push(`<path class="hole" d="M${mm(x(px - width / 2))} ${mm(y(py - height / 2))}` +
      `h${mm(width * scale)}v${mm(-height * scale)}h${mm(-width * scale)}Z"/>`);
  }
  const sides = (axis) => windows.flatMap((window) => [-1, 1].map((end) => window[axis] + end * window[2 + axis] / 2));
  const measured = (axis, from) => distinct([...corners.map((c) => c[axis] - from), ...holes.map((h) => h[axis] - from),
    ...sides(axis).map((side) => side - from)]);
  const across = measured(0, left);
  const up = measured(1, bottom);
  spread(across.map((value) => value * scale)).forEach((at, i) => {
    const from = x(left + across[i]);
    const below = y(bottom);
    parts.push(`<path class="thin" d="M${mm(from)} ${mm(below + 1)}v1.5L${mm(place[0] + at)} ${mm(below + 4.5)}v1.5"/>`,
      `<text class="number" transform="translate(${mm(place[0] + at + 0.9)} ${mm(below + 6.6)})rotate(-90)" text-anchor="end">` +
      `${mm(across[i])}</text>`);
  });
  spread(up.map((value) => value * scale)).forEach((at, i) => {
    const from = y(bottom + up[i]);
    const to = y(bottom) - at;
    parts.push(`<path class="thin" d="M${mm(x(left) - 1)} ${mm(from)}h-1.5L${mm(x(left) - 4.5)} ${mm(to)}h-1.5"/>`,
      `<text class="number" x="${mm(x(left) - 6.6)}" y="${mm(to + 0.9)}" text-anchor="end">${mm(up[i])}</text>`);
  });
  const diameters = distinct(holes.map((hole) => hole[2]))
      .map((diameter) => `${holes.filter((hole) => Math.abs(hole[2] - diameter) < 0.05).length} × ⌀${mm(diameter)}`);
  const title = `${name}${pieces > 1 ? `, ${pieces} pieces` : ''}`;
  const facts = [disc ? `⌀${mm(2 * radius)}` : `${mm(right - left)} × ${mm(top - bottom)}`, ...diameters].join(', ');
  parts.push(`<text class="name" x="${mm(x(left))}" y="${mm(y(top) - 5.2)}">${title}</text>`,
    `<text class="facts" x="${mm(x(left))}" y="${mm(y(top) - 1.6)}">${facts}</text>`);
  return parts.join('\n');
}

/** A plan of a sheet's cuts, at 1:16. */
function cutPlan([name, {place, pieces}], boards) {
  const scale = 1 / 16;
  const box = (x, y, [width, height], kind) => `<rect class="${kind}" x="${mm(place[0] + x * scale)}" ` +
    `y="${mm(paper.height - place[1] - (y + height) * scale)}" width="${mm(width * scale)}" height="${mm(height * scale)}"/>`;
  const parts = [box(0, 0, sheet, 'rest'),
    `<text class="name" x="${place[0]}" y="${paper.height - place[1] - sheet[1] * scale - 4.8}">${name}</text>`,
    `<text class="facts" x="${place[0]}" y="${paper.height - place[1] - sheet[1] * scale - 1.4}">` +
    `${sheet.join(' × ')}, one way to cut it, 1:16</text>`];
  for (const [piece, x, y, turned] of pieces) {
    const [width, height] = size(boards.find((board) => board[0] === piece));
    const sides = turned ? [height, width] : [width, height];
    parts.push(box(x, y, sides, 'board'), `<text class="piece" x="${mm(place[0] + (x + sides[0] / 2) * scale)}" ` +
      `y="${mm(paper.height - place[1] - (y + sides[1] / 2) * scale + 0.7)}">${piece}</text>`);
  }
  return parts.join('\n');
}

/** @returns {string} the drawing as SVG */
export function drawing() {
  const {boards, board, axes} = values('boards', 'board', 'axes');
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${paper.width}mm" height="${paper.height}mm" ` +
    `viewBox="0 0 ${paper.width} ${paper.height}" role="img" aria-labelledby="title">
<title id="title">The boards of base, platform, tower and laser board, with their dimensions</title>
<style>
text{font:3px system-ui,"DejaVu Sans",sans-serif;fill:#0e1b22}.name{font-size:3.6px;font-weight:600}.facts,.note{font-size:2.7px;fill:#51626c}.number{font-size:2.5px}
.title{font-size:6px;font-weight:600}.sheet{fill:#fff}.frame{fill:none;stroke:#0e1b22;stroke-width:.4}.board{fill:#f4ead9;stroke:#0e1b22;stroke-width:.35}
.rest{fill:#fff;stroke:#83929c;stroke-width:.25;stroke-dasharray:1.5 1}.piece{font-size:1.9px;text-anchor:middle;fill:#51626c}
.hole{fill:#fff;stroke:#0e1b22;stroke-width:.25}.thin{fill:none;stroke:#51626c;stroke-width:.15}.group{font-size:4.4px;font-weight:600;fill:#2a7285}
</style>
<rect class="sheet" width="${paper.width}" height="${paper.height}"/>
<rect class="frame" x="6" y="6" width="${paper.width - 12}" height="${paper.height - 12}"/>
${line(6, 20, paper.width - 6, 20, 'frame')}
<text class="title" x="12" y="15.6">Octurn: boards</text>
<text class="note" x="72" y="12.4">Plywood of ${board} mm. Scale 1:5 on A3. Millimetres, from the lower left corner of each board; of the platform, from its left and lower edges.</text>
<text class="note" x="72" y="16.6">The base's window is for the motor: the distance of the axes is ${mm(axes)} mm. Both rigs need base, rails and platform.</text>
${Object.entries(groups).map(([name, [x, y]]) => `<text class="group" x="${x}" y="${paper.height - y}">${name}</text>`).join('\n')}
${boards.map(drawn).join('\n')}
${Object.entries(cuts).map((plan) => cutPlan(plan, boards)).join('\n')}
</svg>
`;
}

if (process.argv[2]) {
  writeFileSync(process.argv[2], drawing());
}
