import assert from 'node:assert/strict';
import {test} from 'node:test';

import {barsOf, consequenceOf, inPlace, nameComplaint, passwordComplaint, regionOf, sharedOf, summaryOf, troubleOf} from '../../web/scanner/wifi.js';

const wifi = {state: 'hotspot', name: '', country: '', hotspot: 'Octurn-1A2B', error: '', host: 'octurn', networks: []};
const network = (name, signal_dbm = -60) => ({name, signal_dbm, secured: true});

test('the summary tells where the scanner is', () => {
  const said = ['none', 'joining', 'joined', 'failed', 'hotspot'].map((state) => summaryOf({...wifi, state, name: 'Home'}));
  assert.equal(new Set(said).size, 5);
  assert.match(said[1], /^Joining “Home”/);
  assert.match(said[4], /“Octurn-1A2B”/);
});

test('a phone may join from the screen what is open, or what was told the scanner there', () => {
  const told = {name: 'Home', password: 'open sesame'};
  assert.deepEqual(sharedOf(wifi, null), {name: 'Octurn-1A2B', password: ''});
  assert.deepEqual(sharedOf(wifi, told), told);
  assert.equal(sharedOf({...wifi, state: 'joined', name: 'Home', hotspot: ''}, null), null, 'nobody tells its password again');
});

test('what is wrong is told with the name that could not be joined', () => {
  assert.equal(troubleOf(wifi), null);
  assert.deepEqual(troubleOf({...wifi, name: 'Home', error: 'the password is wrong'}),
      {title: '“Home” could not be joined', detail: 'The password is wrong.'});
});

test('who looks at the page is told where it will be', () => {
  const said = consequenceOf(wifi, 'Home', 'http://octurn.local');
  assert.match(said, /^The scanner leaves “Octurn-1A2B” and joins “Home”\. .*http:\/\/octurn\.local\./);
  assert.match(consequenceOf({...wifi, state: 'joined', name: 'Old'}, 'Home', ''), /leaves “Old” and joins “Home”/);
  assert.match(consequenceOf({...wifi, state: 'joined', name: 'Home'}, 'Home', ''), /^The scanner joins “Home”/);
  assert.match(consequenceOf({...wifi, state: 'none'}, '', ''), /^The scanner joins that WiFi/);
});

test('networks keep their places while they are chosen from', () => {
  const shown = [network('A', -50), network('B', -60), network('C', -70)];
  const found = [network('D', -40), network('C', -45), network('B', -61)];
  assert.deepEqual(inPlace(shown, found, null).map(({name, signal_dbm}) => name + signal_dbm), ['B-61', 'C-45', 'D-40']);
  assert.deepEqual(inPlace(shown, found, 'A').map(({name}) => name), ['A', 'B', 'C', 'D']);
  assert.deepEqual(inPlace([], found, null), found);
});

test('a stronger signal has more bars', () => {
  assert.deepEqual([-40, -60, -70, -90].map(barsOf), [4, 3, 2, 1]);
});

test('a password is one, or says why not', () => {
  for (const good of ['12345678', 'x'.repeat(63), 'aF'.repeat(32), 'with blanks in it']) {
    assert.equal(passwordComplaint(good, false), '', good);
  }
  for (const bad of ['1234567', 'x'.repeat(64), 'Käsebrot', ' 12345678', '12345678 ', '']) {
    assert.notEqual(passwordComplaint(bad, false), '', bad);
  }
  assert.equal(passwordComplaint('', true), '');
});

test('a name has at most 32 bytes', () => {
  assert.equal(nameComplaint('x'.repeat(32)), '');
  assert.notEqual(nameComplaint('ä'.repeat(17)), '');
  assert.notEqual(nameComplaint(''), '');
});

test('the country is that of the browser, if it tells one', () => {
  assert.equal(regionOf(['en', 'de-AT', 'en-US']), 'AT');
  assert.equal(regionOf(['zh-Hant-TW']), 'TW');
  assert.equal(regionOf(['en', 'es-419', 'xx-QQ']), '');
});
