// The view of further poses of a scan's object. Pure: state in, texts and choices out.

import * as format from '../base/format.js';
import {text} from '../base/texts.js';

/** @typedef {import('../api/api.js').Scan} Scan */
/** @typedef {import('../api/api_poses.js').Pose} Pose */
/** @typedef {import('../state.js').State} State */

/** Whether a scan is a further pose, which is shown with the first scan and not by itself. @param {Scan} scan */
export const isPartOfAnother = ({pose_of, state}) => Boolean(pose_of) && state === 'finished';

/** @param {Pose} pose */
function textOf({state, registration}) {
  if (registration?.accepted) {
    const fit = text('side.shares', {
      share: format.percent(registration.overlap ?? 0), distance: format.millimetres(registration.residual_mm ?? 0, 2)});
    return registration.symmetric ? `${fit} ${text('side.symmetric')}` : fit;
  }
  if (registration) {
    return `${format.sentence(registration.reason)} ${text('side.kept')}`;
  }
  return text(`side.${state === 'running' || state === 'paused' || state === 'interrupted' ? state : 'ended'}`);
}

/** @param {Pose} pose @param {number} last  the last merged pose */
const rowOf = (pose, last) => ({
  number: pose.pose,
  tone: pose.registration?.accepted ? 'good' : 'warn',
  title: text(pose.registration?.accepted ? 'side.in' : pose.registration ? 'side.misfit' : 'side.out', {side: pose.pose + 1}),
  text: textOf(pose),
  open: pose.state === 'paused' || pose.state === 'interrupted' ? `#${pose.scan}` : '',
  canLook: pose.state === 'finished' && Boolean(pose.registration) && (!pose.registration?.accepted || pose.pose === last),
  canRemove: pose.state !== 'running' && (!pose.registration?.accepted || pose.pose === last),
});

/** @param {State} state @param {Scan} scan  in view */
export function posesOf(state, scan) {
  const poses = scan.poses ?? [];
  const merged = poses.filter(({registration}) => registration?.accepted);
  return {
    canAdd: scan.state === 'finished' && scan.model !== null && !scan.pose_of,
    isBusy: Boolean(state.status?.scan),
    add: text(merged.length > 0 ? 'sides.more' : 'sides.first'),
    rows: poses.map((pose) => rowOf(pose, merged.at(-1)?.pose ?? 0)),
  };
}
