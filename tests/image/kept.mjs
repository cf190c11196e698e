// Stored user data that must survive a restart, a power cut and an update: a setting, a calibrated pose with a scale, and a sensor
// map.

import {createHash} from 'node:crypto';

import {require} from './checks.mjs';

const snapshots = 23;  // not the default
const scale = 1.01;
// A sensor 0.65 m in front of the axis and 0.4 m above the platform, pitched down by 30 degrees; not the nominal pose.
const pose = [[1, 0, 0, 0.004], [0, -0.5, Math.sqrt(0.75), -0.65], [0, -Math.sqrt(0.75), -0.5, 0.4], [0, 0, 0, 1]];

// The map of a sensor that is not connected, so its content is never parsed. It holds the output of `seq`, about as many bytes as a
// map.
const folder = '/var/lib/octurn/sensor-maps';
const map = `${folder}/boot-test.png`;
const numbers = 20000;
const mapSum = createHash('sha256').update(Array.from({length: numbers}, (_, i) => `${i + 1}\n`).join('')).digest('hex');

const near = (a, b) => Math.abs(a - b) < 1e-9;

/** Stores the data. The map is written as the daemon's user. */
export async function setWhatIsKept(guest) {
  await guest.ask('settings', 'PATCH', {scan: {snapshots}});
  await guest.ask('calibration', 'PATCH', {platform_from_sensor: pose, scale});
  await guest.run('setpriv --reuid=octurn --regid=octurn --clear-groups ' +
    `sh -ec 'umask 077; mkdir -p ${folder}; seq ${numbers} >${map}; sync ${map} ${folder}'`);
  await requireKept(guest);
}

/** @throws {Error}  unless all data are as stored */
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
