// The printed parts are closed and can be sliced, and fit what they meet; the drawing shows the boards, and the list of
// parts adds up. Sizes of bought parts are repeated here from their standards, so that a wrong parameter does not agree
// with itself.

import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, readdirSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {basename, join} from 'node:path';
import {after, test} from 'node:test';

import {curaSettings} from './cura_settings.js';
import {clearRadius, extent, section, triangles} from './mesh.js';

const docs = process.env.OCTURN_DOCS;
const {cuts, drawing, sheet, size, values} = await import(join(docs, 'hardware/drawing.mjs'));
const made = mkdtempSync(join(tmpdir(), 'octurn-hardware-'));
after(() => rmSync(made, {recursive: true}));
execFileSync(join(docs, 'hardware/build'), ['--no-pictures', made], {stdio: 'inherit'});

const part = (name) => triangles(join(made, `${name}.stl`));
const near = (actual, expected, tolerance, what) =>
  assert.ok(Math.abs(actual - expected) <= tolerance, `${what}: ${actual}, expected ${expected} within ${tolerance}`);
const corners = ([width, depth], [x, y] = [0, 0]) =>
  [[-1, -1], [-1, 1], [1, -1], [1, 1]].map(([right, up]) => [x + right * width / 2, y + up * depth / 2]);
const boardHoles = (boards, name) => boards.find((board) => board[0] === name)[3];

// What the maker buys. ISO 15 (608), NEMA ICS 16 (17), ISO 4762 and 4032 (screws and nuts), Raspberry Pi's drawing.
const bearing = {bore: 8, outer: 22, width: 7, innerRing: 12.1, outerRing: 19};
const nema17 = {side: 42.3, screws: 31, boss: 22, shaft: 24, length: 40};
const m3 = {diameter: 3, head: 5.5, headHeight: 3};
const raspberryPi = {screws: [58, 49], hole: 2.7};
const foam = 2; // of the tape in the list of parts
const printer = [200, 200, 180]; // what nearly every printer's bed takes

test('the same parts make the same bytes: the facets are in order', () => {
  for (const file of readdirSync(made).filter((name) => name.endsWith('.stl'))) {
    const facets = readFileSync(join(made, file), 'utf8').match(/facet normal[^]*?endfacet/g) ?? [];
    assert.ok(facets.length > 0, file);
    assert.deepEqual(facets, [...facets].sort(), file);
  }
});

for (const file of readdirSync(made).filter((name) => name.endsWith('.stl'))) {
  test(`${file} is closed, fits the bed, and slices`, () => {
    const stl = join(made, file);
    const gcode = `${stl}.gcode`;
    const moves = () => readFileSync(gcode, 'utf8').match(/^G1 .*X.*Y.*E/gm)?.length ?? 0;
    const admesh = execFileSync('admesh', [stl], {encoding: 'utf8'});
    assert.match(admesh, /Total disconnected facets\s*:\s*0\s+0/);
    assert.match(admesh, /Number of parts\s*:\s*1 /);
    for (const repair of ['Degenerate facets', 'Edges fixed', 'Facets removed', 'Facets added', 'Backwards edges']) {
      assert.match(admesh, new RegExp(`${repair}\\s*:\\s*0\\b`), repair);
    }
    const all = part(basename(file, '.stl')).flat();
    for (const axis of [0, 1, 2]) {
      const along = all.map((corner) => corner[axis]);
      const size = Math.max(...along) - Math.min(...along);
      assert.ok(size <= printer[axis], `${size} mm along axis ${axis}`);
    }
    near(Math.min(...all.map((corner) => corner[2])), 0, 1e-4, 'its lowest point is on the bed');

    const prusa = execFileSync('prusa-slicer', ['--export-gcode', '--layer-height', '0.3', '--perimeters', '1',
      '--fill-density', '0', '--center', '100,100', '-o', gcode, stl], {encoding: 'utf8', stdio: 'pipe'});
    assert.doesNotMatch(prusa, /repair|open edge|\berror\b/i);
    assert.ok(moves() > 100, `${moves()} moves by PrusaSlicer`);
    // CuraEngine writes all that it says to the standard error stream.
    const cura = execFileSync('sh', ['-c', 'exec CuraEngine slice "$@" 2>&1', 'sh', ...curaSettings(), '-o', gcode, '-l', stl],
        {encoding: 'utf8', maxBuffer: 1 << 28});
    assert.doesNotMatch(cura, /\[ERROR\]|Mesh has disconnected faces/);
    assert.ok(moves() > 100, `${moves()} moves by CuraEngine`);
  });
}

test('hub and pulley hold the bearings, and meet each other', () => {
  const hub = part('platform_hub'); // both as printed: upside down
  const pulley = part('pulley');
  const {hub_height: hubHeight, nut_room_height: nutRoom, pulley_height: pulleyHeight, joint_radius: joint} =
      values('hub_height', 'nut_room_height', 'pulley_height', 'joint_radius');
  const upper = section(hub, nutRoom + bearing.width / 2);
  const lower = section(pulley, pulleyHeight - bearing.width / 2);
  for (const seat of [upper, lower]) {
    const clearance = clearRadius(seat, [0, 0]) - bearing.outer / 2;
    assert.ok(clearance > 0.03 && clearance < 0.15, `a bearing has ${clearance} mm round it`);
  }
  for (const shoulder of [section(hub, hubHeight - 2), section(pulley, 1)]) {
    const radius = clearRadius(shoulder, [0, 0]);
    assert.ok(radius < bearing.outerRing / 2 && radius > bearing.innerRing / 2 + 1, `shoulder of ${radius} mm`);
  }
  const socket = clearRadius(section(hub, nutRoom / 2), [0, 0]);
  assert.ok(socket > 9.5, `a socket of 13 mm, 19 mm wide, turns the lock nut in ${socket} mm`);

  for (let turn = 0; turn < 4; ++turn) {
    const at = [joint * Math.cos((turn + 0.5) * Math.PI / 2), joint * Math.sin((turn + 0.5) * Math.PI / 2)];
    const through = clearRadius(section(pulley, 1), at);
    assert.ok(through > m3.diameter / 2 + 0.1 && through < m3.diameter / 2 + 0.3, `an M3 has a hole of ${through} mm`);
    const thread = clearRadius(section(hub, hubHeight - 5), at);
    assert.ok(thread > 1.15 && thread < 1.3, `an M3 cuts its thread in ${thread} mm`);
    const head = clearRadius(section(pulley, pulleyHeight - m3.headHeight / 2), at);
    assert.ok(head > m3.head / 2 + 0.1, `its head has ${head} mm`);
    assert.ok(joint - head - bearing.outer / 2 > 0.4, 'there is a wall between head and bearing');
  }
});

test('the pulley has sixty teeth of GT2, and room for a belt of 6 mm', () => {
  const {pulley_height: height, pulley_flange: flange, belt_room: room} =
      values('pulley_height', 'pulley_flange', 'belt_room');
  const teeth = section(part('pulley'), height / 2).filter((segment) => Math.hypot(...segment[0]) > 17);
  const [left, , right] = extent(teeth);
  near((right - left) / 2, 60 * 2 / Math.PI / 2 - 0.254, 0.02, 'radius of the tips');
  const at = (radius) => teeth.filter(([a, b]) => (Math.hypot(...a) < radius) !== (Math.hypot(...b) < radius)).length;
  assert.equal(at(18.5), 2 * 60); // each gap has two sides
  near(Math.min(...teeth.flat().map((point) => Math.hypot(...point))), 60 * 2 / Math.PI / 2 - 0.254 - 0.75, 0.02, 'radius of the gaps');
  near(height, 2 * flange + room, 1e-6, 'height');
  assert.ok(room >= 6 + 1 && room <= 6 + 2);
});

test('the motor fits its plate, and the belt is tight within its travel', () => {
  const {axes, boards, motor_travel: travel, belt_middle: belt, motor_plate: thickness, rail_height: rail, board,
    platform_bottom: platform, hub_flange: flange} =
      values('axes', 'boards', 'motor_travel', 'belt_middle', 'motor_plate', 'rail_height', 'board', 'platform_bottom', 'hub_flange');
  const plate = section(part('motor_plate'), 2.5);
  const boss = clearRadius(plate, [0, 0]) - nema17.boss / 2;
  assert.ok(boss > 0.2 && boss < 1, `the motor's boss has ${boss} mm`);
  for (const screw of corners([nema17.screws, nema17.screws])) {
    const radius = clearRadius(plate, screw);
    assert.ok(radius > 1.6 && radius < 1.9, `the motor's screw has ${radius} mm`);
  }
  const axis = boardHoles(boards, 'Base')[0];
  for (const [x, y] of boardHoles(boards, 'Base').slice(1, 5)) {
    for (const moved of [-travel, 0, travel]) {
      const at = [x - axis[0] + axes + moved, y - axis[1]];
      assert.ok(clearRadius(plate, at) > 2.1, `an M4 at ${at} passes through plate and base`);
    }
  }
  // The belt's length from its straights and arcs, where OpenSCAD solves the usual approximation.
  const [large, small] = [60 * 2 / Math.PI / 2, 20 * 2 / Math.PI / 2];
  const length = (distance) => {
    const lean = Math.asin((large - small) / distance);
    return 2 * distance * Math.cos(lean) + Math.PI * (large + small) + 2 * lean * (large - small);
  };
  near(length(axes), 280, 0.05, 'length of the belt');
  assert.ok(length(axes - travel) < 280 - 8 && length(axes + travel) > 280 + 8, 'the plate slides enough to put it on');

  const pulleyTop = belt - 4.5 + 16;
  assert.ok(belt - 4.5 > thickness + 1, 'the motor pulley stays off the plate');
  assert.ok(pulleyTop - 4 < nema17.shaft - 1, 'its set screws, 4 mm below its top, meet the shaft');
  assert.ok(pulleyTop < platform - 5 && platform - flange > pulleyTop, 'it stays below hub and platform');
  assert.ok(rail + board > nema17.length + 5, 'the motor hangs above the table');
  const window = boards[0][4][0];
  assert.ok(Math.min(window[2] - 2 * travel, window[3]) > nema17.side + 1, 'the motor passes through the base');
});

test('an M8 x 55 reaches through both bearings and the lock nut, and ends below the platform', () => {
  const {hub_bottom: hub, hub_height: height, nut_room_height: room, board, platform_bottom: platform} =
      values('hub_bottom', 'hub_height', 'nut_room_height', 'board', 'platform_bottom');
  const tip = 55 - 1.6 - board;
  const nutTop = hub + height - room + 8;
  assert.ok(tip >= nutTop + 0.5, `tip at ${tip}, nut to ${nutTop}`);
  assert.ok(tip <= platform - 0.5, `tip at ${tip}, platform from ${platform}`);
});

for (const model of ['1414', '1473', '1517']) {
  test(`a Kinect ${model} drops into its bracket, and rests on the braces`, () => {
    const bracket = part(`kinect_bracket_${model}`);
    const {boards, kinect_models: models, kinect_feet: feet, kinect_plate: plate, head_above_foot: above, kinect_head: head,
      sensor_pitch: pitch} =
        values('boards', 'kinect_models', 'kinect_feet', 'kinect_plate', 'head_above_foot', 'kinect_head', 'sensor_pitch');
    const foot = feet[models.indexOf(model)];
    const fence = section(bracket, plate + 4).flat();
    const inner = (axis) => Math.min(...fence.filter((point) => Math.abs(point[1 - axis]) < foot[1 - axis] / 2 - 1)
        .map((point) => Math.abs(point[axis])));
    near(2 * inner(0) - foot[0], 1, 0.01, 'play along');
    near(2 * inner(1) - foot[1], 1, 0.01, 'play across');

    // The head's underside, as a plane n . p = d in the bracket's frame.
    const [sin, cos] = [Math.sin(pitch * Math.PI / 180), Math.cos(pitch * Math.PI / 180)];
    const below = (point) => -(point[0] * -sin + (point[2] - plate - above) * cos) - head[2] / 2;
    const gaps = bracket.flat().map(below);
    near(Math.min(...gaps), foam, 0.01, 'foam between head and braces');
    const touching = bracket.filter((corners) => corners.every((corner) => below(corner) < foam + 0.01)).flat();
    assert.ok(Math.max(...touching.map((corner) => corner[1])) > 80 && Math.min(...touching.map((corner) => corner[1])) < -80);

    const middle = [130 / 2, 299 / 2];
    for (const [x, y] of boardHoles(boards, 'Shelf')) {
      const radius = clearRadius(section(bracket, 2), [x - middle[0], y - middle[1]]);
      assert.ok(radius > 3.1 && radius < 3.5, `an M6 through bracket and shelf has ${radius} mm`);
    }
  });
}

test('the electronics plate takes a Raspberry Pi', () => {
  const {electronics, standoff} = values('electronics', 'standoff');
  const posts = section(part('electronics_plate'), electronics[2] + standoff / 2);
  for (const screw of corners(raspberryPi.screws, [-38, 0])) {
    const core = clearRadius(posts, screw);
    assert.ok(core > 0.95 && core < 1.1, `an M2.5 cuts its thread in ${core} mm`);
    const wall = posts.flat().map(([x, y]) => Math.hypot(x - screw[0], y - screw[1])).filter((radius) => radius < 5);
    assert.ok(Math.max(...wall) > 2.9, 'with a wall round it');
  }
});

for (const [name, side] of [['left', 1], ['right', -1]]) {
  test(`the ${name} laser's bore is on the line to the platform's axis`, () => {
    const {laser_board_y: y, laser_board_z: z, laser_board_distance: x, laser_from_board: clamp, laser_aim: aim,
      platform_top: platform} =
        values('laser_board_y', 'laser_board_z', 'laser_board_distance', 'laser_from_board', 'laser_aim', 'platform_top');
    // In the rig's frame, from the clamp's middle to the axis; then as the holder lies: x up, y, z to the platform.
    const to = [-(x - clamp), -side * y, platform + aim - z];
    const direction = [to[2], to[1], -to[0]].map((value) => value / Math.hypot(...to));
    const off = (corner) => {
      const d = [corner[0], corner[1], corner[2] - clamp];
      const along = d[0] * direction[0] + d[1] * direction[1] + d[2] * direction[2];
      return Math.hypot(...d.map((value, axis) => value - along * direction[axis]));
    };
    const bore = part(`laser_holder_${name}`).filter((corners) => corners.every((corner) => Math.abs(off(corner) - 6.1) < 0.02));
    assert.ok(bore.length > 40, `${bore.length} triangles are on a bore of 12.2 mm there`);
    near(Math.atan2(side * y, x - clamp) * 180 / Math.PI, side * 30, 0.01, 'degrees beside the camera');
  });
}

test('the camera looks down on the platform, with screws at 28 and at 34 mm', () => {
  const {camera_from_board: out, camera_pitch: pitch} = values('camera_from_board', 'camera_pitch');
  const mesh = part('camera_holder');
  const [sin, cos] = [Math.sin(pitch * Math.PI / 180), Math.cos(pitch * Math.PI / 180)];
  // Into the face's frame: its height above the middle, and its place up the face.
  const turned = mesh.map((corners) => corners.map(([x, y, z]) => [cos * x + sin * (z - out), y, -sin * x + cos * (z - out)]));
  near(Math.max(...turned.flat().map((corner) => corner[2])), 2, 0.01, 'nothing stands before the face');
  const face = section(turned, 1);
  for (const square of [28, 34]) {
    for (const screw of corners([square, square])) {
      const core = clearRadius(face, screw);
      assert.ok(core > 0.8 && core < 0.95, `an M2 cuts its thread in ${core} mm`);
    }
  }
});

test('the sensors stand where the program expects them', () => {
  const settings = readFileSync(join(docs, 'settings.md'), 'utf8');
  const {sensor_distance: distance, sensor_height: height, sensor_pitch: pitch, camera_distance: camera, camera_height: up,
    camera_pitch: down, laser_radius: radius, laser_height: high, laser_azimuth: beside, gear_ratio: gear} =
      values('sensor_distance', 'sensor_height', 'sensor_pitch', 'camera_distance', 'camera_height', 'camera_pitch',
          'laser_radius', 'laser_height', 'laser_azimuth', 'gear_ratio');
  const metres = (mm) => String(mm / 1000);
  for (const said of [
    `${metres(distance)} m before the axis, ${metres(height)} m up, ${pitch} degrees down`,
    `${metres(camera)} m before the axis, ${metres(up)} m up, ${down} degrees down`,
    `holds the platform's axis, ${beside} degrees beside the camera`,
    `${metres(radius)} m from the axis, ${metres(high)} m up`]) {
    assert.ok(settings.includes(said), said);
  }
  assert.ok(readFileSync(join(docs, 'hardware/README.md'), 'utf8').includes(`\`turntable.gear_ratio = ${gear}\``));
});

test('the uprights stay out of the Kinect\'s view', () => {
  const {tower_inside: inside, tower_middle: middle, upright_depth: depth, sensor_distance: sensor} =
      values('tower_inside', 'tower_middle', 'upright_depth', 'sensor_distance');
  // The depth camera and the projector are at most 80 mm beside the middle, and see 29 degrees to each side.
  const ahead = sensor - (middle - depth / 2);
  assert.ok(80 + ahead * Math.tan(30 * Math.PI / 180) < inside / 2 - 10);
});

test('the shelf\'s bolts meet the uprights\' holes, and each tower\'s those of the base', () => {
  const {boards, shelf_top: shelf, board, cheek_height: cheek, base_axis: axis, tower_middle: middle, laser_foot_x: laser} =
      values('boards', 'shelf_top', 'board', 'cheek_height', 'base_axis', 'tower_middle', 'laser_foot_x');
  for (const [, y] of boardHoles(boards, 'Cheek')) {
    const height = shelf - board - cheek + y - board; // above the upright's lower end
    assert.ok(boardHoles(boards, 'Upright').some((hole) => Math.abs(hole[1] - height) < 0.01), `a hole at ${height}`);
    assert.ok(y > 10 && y < cheek - 10);
  }
  const holes = boardHoles(boards, 'Base').map(([x, y]) => [x - axis[0], y - axis[1]]);
  for (const [name, from] of [['Tower foot', middle - 140 / 2], ['Laser foot', laser]]) {
    for (const [x, y] of boardHoles(boards, name)) {
      const at = [from + x, y - axis[1]];
      assert.ok(holes.some((hole) => Math.hypot(hole[0] - at[0], hole[1] - at[1]) < 0.01), `${name}: a hole at ${at}`);
    }
  }
});

test('the drawing in the repository is that of the boards, and every hole is on its board', () => {
  assert.equal(readFileSync(join(docs, 'hardware/drawing.svg'), 'utf8'), drawing());
  const {boards} = values('boards');
  for (const [name, , outline, holes] of boards.filter((board) => board[2].length > 1)) {
    const [width, height] = [0, 1].map((axis) => Math.max(...outline.map((corner) => corner[axis])));
    for (const [x, y, diameter] of holes) {
      const edge = Math.min(x, y, width - x, height - y) - diameter / 2;
      assert.ok(edge > 8, `${name}: ${edge} mm of wood beside the hole at ${x}, ${y}`);
    }
  }
});

test('each build is cut from one sheet, with 3 mm for the saw', () => {
  const {boards} = values('boards');
  for (const {pieces} of Object.values(cuts)) {
    const boxes = pieces.map(([name, x, y, turned]) => {
      const [width, height] = size(boards.find((board) => board[0] === name));
      return turned ? [x, y, x + height, y + width] : [x, y, x + width, y + height];
    });
    boxes.forEach(([left, bottom, right, top], i) => {
      assert.ok(left >= 0 && bottom >= 0 && right <= sheet[0] && top <= sheet[1], `${pieces[i][0]} is on the sheet`);
      for (const other of boxes.slice(i + 1)) {
        const apart = Math.max(left - other[2], other[0] - right, bottom - other[3], other[1] - top);
        assert.ok(apart >= 3, `${pieces[i][0]} is ${apart} mm from another piece`);
      }
    });
    for (const name of new Set(pieces.map((piece) => piece[0]))) {
      assert.equal(pieces.filter((piece) => piece[0] === name).length, boards.find((board) => board[0] === name)[1], name);
    }
  }
  const cut = new Set(Object.values(cuts).flatMap(({pieces}) => pieces.map((piece) => piece[0])));
  assert.deepEqual([...cut].sort(), boards.map((board) => board[0]).sort());
});

test('the list of parts has a bolt for each hole that is used, and its nut and washers', () => {
  const list = readFileSync(join(docs, 'hardware/parts.md'), 'utf8');
  const pieces = (article) => list.match(new RegExp(`^\\| ${article}[^|]*\\| (\\d*) ?\\| (\\d*) ?\\|`, 'm'))
      .slice(1).map(Number);
  const added = (...counts) => counts[0].map((_, build) => counts.reduce((sum, count) => sum + count[build], 0));
  const {boards} = values('boards');
  const holes = (name, diameter) => boardHoles(boards, name).filter((hole) => hole[2] === diameter).length *
      boards.find((board) => board[0] === name)[1];

  const [long, short] = [pieces('Hexagon bolt M6 x 40'), pieces('Hexagon bolt M6 x 30')];
  assert.deepEqual(long, [holes('Cheek', 6.6) + holes('Tower foot', 6.6), holes('Laser foot', 6.6)]);
  assert.deepEqual(short, [holes('Shelf', 6.6), holes('Laser board', 6.6) / 3]); // at one of three heights
  assert.deepEqual(added(pieces('Wing nut M6'), pieces('Nut M6')), added(long, short));
  assert.deepEqual(pieces('Washer M6'), added(long, long, short, short));

  const [sunk, plain] = [pieces('Countersunk screw M4 x 25'), pieces('Socket head screw M4 x 25')];
  assert.deepEqual([sunk, plain], [Array(2).fill(holes('Platform', 4.4)), Array(2).fill(holes('Base', 4.4))]);
  assert.deepEqual(pieces('Nut M4'), added(sunk, plain));
  assert.deepEqual(pieces('Washer M4'), added(sunk, plain, plain)); // none below a sunk head
});

test('the list of parts names every printed part, and its prices add up', () => {
  const list = readFileSync(join(docs, 'hardware/parts.md'), 'utf8');
  for (const file of readdirSync(made).filter((name) => name.endsWith('.stl'))) {
    assert.ok(list.includes(`\`${file}\``), file);
  }
  const sums = [[0, 0], [0, 0]];
  const lots = [...list.matchAll(/^\| ([^|*]+) \| (\d[\d–]*|) ?\| (\d[\d–]*|) ?\|$/gm)];
  for (const [, lot, ...prices] of lots) {
    assert.ok(list.includes(`\n| ${lot} | Kinect | laser |`), `a table of ${lot}`);
    prices.forEach((price, build) => {
      if (!price) {
        return;
      }
      const [from, to = from] = price.split('–').map(Number);
      sums[build][0] += from;
      sums[build][1] += to;
    });
  }
  assert.ok(lots.length >= 5, `${lots.length} lots`);
  const [, ...stated] = list.match(/^\| \*\*Sum\*\* \| \*\*([\d–]+)\*\* \| \*\*([\d–]+)\*\* \|$/m);
  assert.deepEqual(stated, sums.map(([from, to]) => from === to ? `${from}` : `${from}–${to}`));
});
