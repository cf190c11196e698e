import assert from 'node:assert/strict';
import {test} from 'node:test';

import {isRightClock, needsClock} from '../../web/scanner/clock.js';
import {aboutPrinter, aboutWebhook} from '../../web/scanner/outgoing.js';
import {linesOf} from '../../web/scanner/power.js';
import {aboutUpload, scanIn} from '../../web/scan/send.js';
import {kindOf, textOf} from '../../web/scanner/warning_lines.js';

test('a printer, and how a model gets there, are told in words', () => {
  const printer = {id: '1', name: 'Voron', kind: 'moonraker', address: 'http://voron.local:7125', has_key: true, fingerprint: ''};
  assert.equal(aboutPrinter(printer), 'Moonraker · http://voron.local:7125');
  assert.equal(aboutPrinter({...printer, fingerprint: 'sha256//A='}), 'Moonraker · http://voron.local:7125 · Trusted certificate: sha256//A=');
  const upload = {printer: 'Voron', state: 'sending', progress: 0.499, detail: '', hint: '', fingerprint: ''};
  assert.equal(aboutUpload(upload), 'Sending to Voron, 49 %');
  assert.match(aboutUpload({...upload, state: 'sent'}), /^Voron has the model/);
  assert.equal(aboutUpload({...upload, state: 'failed', detail: 'it is off', hint: 'Turn it on.'}), 'It is off. Turn it on.');
});

test('a webhook says what became of its last message', () => {
  const webhook = {id: '1', address: 'http://hub', events: [], last: null};
  assert.equal(aboutWebhook(webhook), 'Nothing was sent yet.');
  const last = {outcome: 'waiting', event: 'test', time: null, trouble: ''};
  assert.equal(aboutWebhook({...webhook, last}), 'A message is on its way.');
  assert.equal(aboutWebhook({...webhook, last: {...last, trouble: 'it answered 500'}}), 'Not arrived yet: it answered 500. It is tried again.');
  assert.equal(aboutWebhook({...webhook, last: {...last, outcome: 'failed', trouble: 'it answered 410'}}), 'The last message did not arrive: it answered 410.');
});

test('the scan of a download is found in its address', () => {
  assert.equal(scanIn('/api/v1/scans/20261121-081500-3f2a/Scan.stl'), '20261121-081500-3f2a');
  assert.equal(scanIn('/api/v1/scans/7/builds/2/Scan.stl'), '7');
  assert.equal(scanIn(''), '');
});

test('a clock is lent to an appliance that warns of its own', () => {
  const clock = {check: 'clock', name: 'Clock', state: 'warning', measured: '1970-01-01', advice: '', action: ''};
  assert.equal(needsClock({appliance: true, warnings: [clock]}), true);
  assert.equal(needsClock({appliance: false, warnings: [clock]}), false);
  assert.equal(needsClock({appliance: true, warnings: []}), false);
});

test('a clock that tells the browser\'s time is right, whoever set it', () => {
  const clock = {check: 'clock', name: 'Clock', state: 'warning', measured: '2026-11-25 06:22 UTC, not from a time server', advice: '', action: ''};
  assert.equal(isRightClock(clock, new Date('2026-11-25T06:23:50Z')), true);
  assert.equal(isRightClock(clock, new Date('2026-11-25T06:29:00Z')), false);
  assert.equal(isRightClock(clock, new Date('2027-11-25T06:22:00Z')), false);
  assert.equal(isRightClock({...clock, check: 'supply'}, new Date('2026-11-25T06:22:00Z')), false);
  assert.equal(isRightClock({...clock, measured: 'unknown'}, new Date('2026-11-25T06:22:00Z')), false);
});

test('a dismissed warning stays dismissed whatever its numbers, until it becomes another one', () => {
  const disk = {check: 'disk', name: 'Disk', state: 'warning', measured: '1.2 GB free', advice: '', action: ''};
  assert.equal(kindOf(disk), kindOf({...disk, measured: '980 GB free'}));
  assert.notEqual(kindOf(disk), kindOf({...disk, state: 'fault'}));
  assert.notEqual(kindOf(disk), kindOf({...disk, measured: 'not known'}));
});

test('warnings and messages are for people', () => {
  assert.deepEqual(textOf({name: 'Supply', measured: 'below 4.63 V', advice: 'use the right one'}), {title: 'Supply: below 4.63 V.', text: 'Use the right one.'});
  assert.equal(linesOf({log: ['2026-11-21T08:15:00Z <6>scanner: started'], errors: ['wifi: gone']}), 'wifi: gone\n2026-11-21T08:15:00Z scanner: started');
});
