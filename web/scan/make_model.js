// Makes what was done to a model in the view a model of its own, by a build.

import * as api from '../api/api.js';
import {buildShown} from './builds.js';
import {composed, restOf} from './edits.js';
import {planeInModel} from '../model/section.js';
import {build} from './model_actions.js';
import {state} from '../page.js';
import {readStl} from '../model/stl.js';
import {scanOf} from '../state.js';

/**
 * @param {string} url  of the model in view
 * @param {import('../model/section.js').Pose} pose
 * @param {{cut: import('../model/section.js').Plane | null, isLaid: boolean, erased: number[][]}} done  cut: in the view
 */
export async function makeModel(url, pose, {cut, isLaid, erased}) {
  const scan = scanOf(state, state.selected);
  if (!scan) {
    return;
  }
  const {clip_mm, ...settings} = {...buildShown(state, scan)?.settings};
  const isOwnClip = JSON.stringify(clip_mm) === JSON.stringify(scan.settings.clip_mm);
  const up = pose.axes[2];
  const down = up.map((value) => -value);
  const corners = async () => (await readStl(await api.model(url, new AbortController().signal))).positions;
  const lay = isLaid ? {down, point: restOf(await corners(), up)} : null;
  const edits = composed(settings, {cut: cut && planeInModel(cut, pose), erased, lay});
  await build({...settings, ...isOwnClip ? {} : {clip_mm}, ...edits, choose: true});
}
