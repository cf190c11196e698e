// What a person has set on the page, and what the sensor was measured to be: a setting, a pose with a scale, a sensor's map.
// Each of them must be there after a restart, a cut of power and an update.

import {createHash} from 'node:crypto';

import {require} from './checks.mjs';

const snapshots = 23;  // of a scan, and not the default
const scale = 1.01;
// A sensor 0.65 m before the axis and 0.4 m above the platform that looks 30 degrees down: not where the drawing has it.
const pose = [[1, 0, 0, 0.004], [0, -0.5, Math.sqrt(0.75), -0.65], [0, -Math.sqrt(0.75), -0.5, 0.4], [0, 0, 0, 1]];

// Of a sensor that is not there, so that nobody asks whether it is a map. Its bytes are those of `seq`, about as many as a
// map's.
const folder = '/var/lib/octurn/sensor-maps';
const map = `${folder}/boot-test.png`;
const numbers = 20000;
const mapSum = createHash('sha256').update(Array.from({length: numbers}, (_, i) => `${i + 1}\n`).join('')).digest('hex');

const near = (a, b) => Math.abs(a - b) < 1e-9;

/** Sets them. The map is written as the daemon's user does it. */
export async function setWhatIsKept(guest) {
  await guest.ask('settings', 'PATCH', {scan: {snapshots}});
  await guest.ask('calibration', 'PATCH', {platform_from_sensor: pose, scale});
  await guest.run('setpriv --reuid=octurn --regid=octurn --clear-groups ' +
    `sh -ec 'umask 077; mkdir -p ${folder}; seq ${numbers} >${map}; sync ${map} ${folder}'`);
  await requireKept(guest);
}

/** @throws {Error}  unless all are as they were set */
export async function requireKept(guest) {
  const {settings, trouble} = await guest.ask('settings');
  require(settings.scan.snapshots === snapshots && trouble === '',
    `of the settings is kept: ${settings.scan.snapshots} snapshots; ${trouble}`);
  const calibration = await guest.ask('calibration');
  const isPose = pose.flat().every((value, i) => near(value, calibration.platform_from_sensor.flat()[i]));
  require(isPose && near(calibration.scale, scale) && calibration.source === 'page',
    `of the pose is kept: ${JSON.stringify(calibration)}`);
  const found = await guest.run(`sha256sum ${map}`);
  require(found === `${mapSum}  ${map}`, `of the sensor's map is kept: ${found}`);
}
