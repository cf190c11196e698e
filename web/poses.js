// What the page shows of the other poses of a scan's object. Pure: state in, texts and choices out.

import * as format from './format.js';

/** @typedef {import('./api.js').Scan} Scan */
/** @typedef {import('./api_poses.js').Pose} Pose */
/** @typedef {import('./state.js').State} State */

/** Whether a scan is shown with the one that it is another pose of, and not by itself. @param {Scan} scan */
export const isPartOfAnother = ({pose_of, state}) => Boolean(pose_of) && state === 'finished';

/** @param {Pose} pose */
function textOf({state, registration}) {
  if (registration?.accepted) {
    const share = Math.round(100 * (registration.overlap ?? 0));
    const fit = `It shares ${share} % of its surface with what was seen before, and fits to ${(registration.residual_mm ?? 0).toFixed(2)} mm.`;
    return registration.symmetric ? `${fit} The object is symmetric: other ways to lay it give the same shape.` : fit;
  }
  if (registration) {
    return `${format.sentence(registration.reason)} The model stayed as it was.`;
  }
  const words = {running: 'It is being scanned.', paused: 'Its scan has paused.', interrupted: 'Its scan was interrupted.'};
  return /** @type {Record<string, string>} */ (words)[state] ?? 'Its scan was ended. The model stayed as it was.';
}

/** @param {Pose} pose @param {number} last  that was merged */
const rowOf = (pose, last) => ({
  number: pose.pose,
  tone: pose.registration?.accepted ? 'good' : 'warn',
  title: pose.registration?.accepted ? `Side ${pose.pose + 1} is in the model` :
    pose.registration ? `Side ${pose.pose + 1} does not fit` : `Side ${pose.pose + 1} is not in the model`,
  text: textOf(pose),
  open: pose.state === 'paused' || pose.state === 'interrupted' ? `#${pose.scan}` : '',
  canLook: pose.state === 'finished' && Boolean(pose.registration) && (!pose.registration?.accepted || pose.pose === last),
  canRemove: pose.state !== 'running' && (!pose.registration?.accepted || pose.pose === last),
});

/** @param {State} state @param {Scan} scan  that is looked at */
export function posesOf(state, scan) {
  const poses = scan.poses ?? [];
  const merged = poses.filter(({registration}) => registration?.accepted);
  return {
    canAdd: scan.state === 'finished' && scan.model !== null && !scan.pose_of,
    isBusy: Boolean(state.status?.scan),
    add: merged.length > 0 ? 'Scan one more side' : 'Turn it over and scan the underside',
    rows: poses.map((pose) => rowOf(pose, merged.at(-1)?.pose ?? 0)),
  };
}
