import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {test} from 'node:test';

import {formOf, leafChoices, settingsOf, stepText} from '../../web/scan/settings.js';
import {settings} from './examples.js';

test('what the form shows and does not change is sent as it came', () => {
  for (const threshold_m2 of [0.0001, 0.00025, 1e-8, 0.3]) {
    const preset = {...settings, threshold_m2};
    const sent = settingsOf(formOf(preset));
    assert.ok(Math.abs(sent.threshold_m2 / threshold_m2 - 1) < 1e-5, `${sent.threshold_m2} for ${threshold_m2}`);
    assert.deepEqual({...sent, threshold_m2}, preset);
  }
});

test('the threshold, a squared length, is a length in the form', () => {
  assert.equal(formOf(settings).gap_mm, 10);
  assert.equal(settingsOf({...formOf(settings), gap_mm: 20}).threshold_m2, 0.0004);
});

test('a preset leaf size is among the choices, also one without a name, coarse to fine', () => {
  assert.deepEqual(leafChoices(1).map(({mm}) => mm), [4, 2, 1, 0.5]);
  assert.deepEqual(leafChoices(2).map(({mm}) => mm), [8, 4, 2, 1, 0.5].filter((mm) => mm <= 4));  // a quick scan can be built fine
  assert.deepEqual(leafChoices(1.5).map(({mm}) => mm), [4, 2, 1.5, 1, 0.5]);
  assert.deepEqual(leafChoices(0.5).map(({mm}) => mm), [2, 1, 0.5, 0.25]);  // the default with lasers
});

test('the angle between stops has one decimal at most', () => {
  assert.deepEqual([36, 7, 200].map(stepText), ['one every 10°', 'one every 51.4°', 'one every 1.8°']);
});

test('the slider of the snapshots goes as far as the field beside it', async () => {
  const form = await readFile(new URL('../../web/form.html', import.meta.url), 'utf8');
  const [slider, field] = ['snapshots-slider', 'snapshots'].map((id) => {
    const [input] = new RegExp(`<input [^>]*id="${id}"[^>]*>`).exec(form);
    return ['min', 'max', 'step'].map((name) => new RegExp(` ${name}="([^"]+)"`).exec(input)[1]);
  });
  assert.deepEqual(slider, field);
  assert.deepEqual(field, ['1', '400', '1']);
});
