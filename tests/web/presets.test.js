import assert from 'node:assert/strict';
import {test} from 'node:test';

import {fromKept, presetOf, presets, toKept} from '../../web/scan/presets.js';
import {settings} from './examples.js';

test('each preset is known again, and what is none of them is none', () => {
  for (const {name, settings: chosen} of presets(settings)) {
    assert.equal(presetOf(chosen, settings).name, name);
  }
  assert.equal(presetOf({...settings, snapshots: 37}, settings), null);
});

test('a setting that is not used makes no difference', () => {
  const quick = presets(settings)[0].settings;
  assert.equal(presetOf({...quick, frames: 3, threshold_m2: 1}, settings).name, 'quick');
});

test('quick takes fewer stops than standard, and best more and finer ones', () => {
  const [quick, standard, best] = presets(settings).map((preset) => preset.settings);
  assert.ok(quick.snapshots < standard.snapshots && standard.snapshots < best.snapshots);
  assert.ok(quick.leaf_size_mm > standard.leaf_size_mm && standard.leaf_size_mm > best.leaf_size_mm);
});

test('with lasers no preset has lines farther apart than the object needs, nor more stops than a scan may have', () => {
  const lasers = {...settings, snapshots: 200, filter: 'basic', leaf_size_mm: 0.5};
  const chosen = presets(lasers).map((preset) => preset.settings);
  assert.deepEqual(chosen.map(({snapshots}) => snapshots), [67, 200, 400]);
  assert.deepEqual(chosen.map(({leaf_size_mm}) => leaf_size_mm), [1, 0.5, 0.25]);
});

test('a leaf size that is not offered any more, as of another sensor, is not chosen', () => {
  assert.deepEqual(fromKept(toKept({...settings, leaf_size_mm: 0.25}), settings), settings);
});

test('the last choice is kept, but not the space, which the scanner may have changed since', () => {
  const chosen = {...settings, snapshots: 50, leaf_size_mm: 2, clip_mm: [0, 0, 0, 1, 1, 1]};
  assert.deepEqual(fromKept(toKept(chosen), settings), {...settings, snapshots: 50, leaf_size_mm: 2});
});

test('nonsense in the browser\'s memory is not chosen', () => {
  for (const text of [null, '', '[]', 'null', '{"snapshots": "many", "leaf_size_mm": -1}', '7']) {
    assert.deepEqual(fromKept(text, settings), settings, String(text));
  }
});
