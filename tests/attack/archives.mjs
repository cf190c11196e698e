// Archives of scans, written and damaged here, and sent to the daemon.

import {request} from 'node:http';

import {crc32, depthPng} from '../support/depth_png.mjs';

/** A zip archive of files that are stored as they are. @param {[string, Buffer|string][]} files */
export function zipOf(files) {
  const local = [];
  const central = [];
  let at = 0;
  for (const [name, content] of files) {
    const bytes = Buffer.from(content);
    const head = Buffer.alloc(26); // from the version that is needed to the length of the extra field
    head.writeUInt16LE(20, 0);
    head.writeUInt32LE(0x00210000, 6); // 1 January 1980
    head.writeUInt32LE(crc32(bytes), 10);
    head.writeUInt32LE(bytes.length, 14);
    head.writeUInt32LE(bytes.length, 18);
    head.writeUInt16LE(name.length, 22);
    const place = Buffer.alloc(14);
    place.writeUInt32LE(at, 10);
    const entry = [Buffer.from('PK\x03\x04'), head, Buffer.from(name), bytes];
    local.push(...entry);
    central.push(Buffer.from('PK\x01\x02\x14\x00'), head, place, Buffer.from(name));
    at += entry.reduce((sum, part) => sum + part.length, 0);
  }
  const list = Buffer.concat(central);
  const end = Buffer.alloc(22);
  end.write('PK\x05\x06');
  end.writeUInt16LE(files.length, 8);
  end.writeUInt16LE(files.length, 10);
  end.writeUInt32LE(list.length, 12);
  end.writeUInt32LE(at, 16);
  return Buffer.concat([...local, list, end]);
}

/** The scan.json of a scan of so many snapshots, in units of 0.1 mm. */
export function scanJson(snapshots, width, height) {
  return {
    format: 'octurn-scan', version: 1,
    sensor: {name: 'test', width, height, fx: width, fy: width, cx: width / 2, cy: height / 2, depth_unit_m: 0.0001},
    calibration: {platform_from_sensor: [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.7], [0, 0, 0, 1]]},
    clip_m: {min: [-0.14, -0.14, 0.005], max: [0.14, 0.14, 0.4]},
    snapshots: Array.from({length: snapshots}, (_, i) =>
      ({file: `snapshots/${String(i).padStart(3, '0')}.png`, angle_deg: (i * 360) / snapshots})),
  };
}

/** A scan of a box of 6 cm on the platform, seen from above, as files. */
export function smallScan(snapshots = 3, width = 48, height = 36) {
  const isBox = (u, v) => Math.abs(u - width / 2) < width / 10 && Math.abs(v - height / 2) < height / 8;
  const png = depthPng(width, height, (u, v) => isBox(u, v) ? 6400 : 7000);
  const scan = scanJson(snapshots, width, height);
  return [['scan.json', JSON.stringify(scan)], ...scan.snapshots.map(({file}) => [file, png])];
}

/** An archive whose check takes long: each of its images is decoded. */
export function manySnapshots(count, width, height) {
  const png = depthPng(width, height, (u, v) => 6000 + ((u * 31 + v * 17) % 900));
  const scan = scanJson(count, width, height);
  return zipOf([['scan.json', JSON.stringify(scan)], ...scan.snapshots.map(({file}) => [file, png])]);
}

/** An archive that once made the daemon take a gigabyte: its scan.json has millions of empty lists. */
export function hostileArchive() {
  const lists = `"snapshots":[${'[],'.repeat(5e6)}[]]`;
  const scan = JSON.stringify({...scanJson(1, 48, 36), snapshots: 0}).replace('"snapshots":0', lists);
  return zipOf([['scan.json', scan]]);
}

/** Sends an archive. @returns {Promise<{status: number, text: string}>} */
export function importOf(daemon, archive) {
  return new Promise((resolve, reject) => {
    const headers = {'Content-Type': 'application/octet-stream', 'Content-Length': archive.length};
    const to = {host: '127.0.0.1', port: daemon.port, method: 'POST', path: '/api/v1/scans/import', agent: false};
    const sent = request({...to, headers}, (response) => {
      let text = '';
      response.setEncoding('utf8').on('data', (part) => (text += part)).on('error', reject);
      response.on('end', () => resolve({status: response.statusCode, text}));
    });
    sent.on('error', reject);
    sent.end(archive);
  });
}
