// Renders a screen (screen.js), except the large picture (stage.js) and the form's fields (form.js).

import {tickWidth, ticks} from './scan/dial.js';
import {element, list, part, setBadge, setText, setVerbatim, show} from './base/dom.js';
import {text} from './base/texts.js';

/** @typedef {ReturnType<import('./screen.js').screenOf>} Screen */

/** @param {Screen} screen */
function showDevices({devices, isSimulated}) {
  show(element('simulated'), isSimulated);
  element('devices').dataset.well = devices.every(({tone}) => tone === 'good') ? 'yes' : 'no';
  list(element('devices'), devices, ({role}) => role, 'device', (item, device) => {
    item.dataset.tone = device.tone;
    item.title = device.message;
    setText(part(item, '.device-name'), device.name);
    setText(part(item, '.device-state'), device.text);
  });
}

/** Shows one panel. If the focus was in the previous panel, it moves to the new panel's heading. @param {string} name */
function showPanel(name) {
  const panels = [...document.querySelectorAll('[data-panel]')];
  const shown = /** @type {HTMLElement} */ (panels.find((panel) => /** @type {HTMLElement} */ (panel).dataset.panel === name));
  if (!shown.hidden) {
    return;
  }
  const hadFocus = element('panel').contains(document.activeElement);
  for (const panel of panels) {
    show(/** @type {HTMLElement} */ (panel), panel === shown);
  }
  if (hadFocus) {
    part(shown, 'h1')?.focus({preventScroll: true});
  }
}

/** @param {NonNullable<Screen['progress']>} progress */
function showProgress(progress) {
  const {done, total} = progress;
  const dial = element('dial');
  dial.dataset.phase = progress.isStale ? '' : progress.phase;
  dial.setAttribute('aria-valuenow', String(progress.percent));
  dial.setAttribute('aria-valuetext', text('progress.spoken', {done, total, phase: progress.text}));
  for (const [id, from, to] of /** @type {[string, number, number][]} */ ([
    ['ticks', 0, total], ['ticks-done', 0, done], ['tick-now', done, Math.min(done + 1, total)]])) {
    const path = element(id);
    path.setAttribute('d', ticks(from, to, total));
    path.setAttribute('stroke-width', tickWidth(total).toFixed(2));
  }
  setText(element('dial-done'), String(done));
  setText(element('dial-total'), text('progress.total', {total}));
  setText(element('phase'), progress.text);
  setText(element('left'), progress.left);
  setText(element('time'), progress.time);
  show(element('trying'), progress.trouble !== '');
  setText(part(element('trying'), 'p'), progress.trouble);
  for (const {name, state} of progress.steps) {
    const step = part(element('steps'), `[data-step=${name}]`);
    step.dataset.state = state;
    step.toggleAttribute('aria-current', state === 'now');
  }
}

/** @param {HTMLAnchorElement} link @param {import('./scan/quality.js').Action | null} action */
function setAction(link, action) {
  show(link, action !== null);
  setText(link, action?.text ?? '');
  link.href = action?.href ?? '';
  link.dataset.field = action?.field ?? '';
}

/** @param {NonNullable<Screen['details']>['verdict']} verdict */
function showVerdict(verdict) {
  show(element('verdict'), verdict !== null);
  show(element('verdict-more'), verdict !== null);
  if (verdict) {
    element('verdict').dataset.tone = verdict.tone;
    element('verdict-more').dataset.tone = verdict.tone;
    part(element('verdict'), 'use').setAttribute('href', `icons/symbols.svg#${verdict.icon}`);
    setText(element('verdict-title'), verdict.title);
    setText(element('verdict-text'), verdict.text);
    list(element('reasons'), verdict.reasons, ({key}) => key, 'reason', (item, {detail, hint, action, places, isShown}) => {
      const toggle = part(item, '.reason-places');
      show(toggle, places.length > 0);
      setText(toggle, text(isShown ? 'where.hide' : 'where.show'));
      toggle.setAttribute('aria-pressed', String(isShown));
      setText(part(item, '.reason-detail'), detail);
      setText(part(item, '.reason-hint'), hint);
      setAction(part(item, 'a'), action);
    });
  }
}

const factsInView = 4;  // the others are folded

/** @param {string} id @param {NonNullable<Screen['details']>['facts']} facts */
const showFacts = (id, facts) => list(element(id), facts, ({label}) => label, 'fact', (item, {label, ...value}) => {
  setText(part(item, 'dt'), label);
  setBadge(part(item, 'dd'), value);
});

/** @param {NonNullable<Screen['details']>} details */
function showDetails({name, trouble, verdict, size, facts, canResume, canEnd, download, formats, unbuilt}) {
  setVerbatim(element('details-name'), name);
  show(element('trouble'), trouble !== null);
  if (trouble) {
    element('trouble').dataset.tone = trouble.tone;
    setText(element('trouble-title'), trouble.title);
    setText(element('trouble-detail'), trouble.detail);
    setText(element('trouble-hint'), trouble.hint);
    setAction(element('trouble-action'), trouble.action);
  }
  showVerdict(verdict);
  show(element('resumable'), canResume);
  show(element('end'), canEnd);
  show(element('size'), size !== '');
  setText(element('size'), size);
  showFacts('facts', facts.slice(0, factsInView));
  showFacts('further-facts', facts.slice(factsInView));
  show(element('more-facts'), facts.length > factsInView);
  show(element('build-first'), unbuilt !== null && !unbuilt.isGoing);
  setText(element('build-first-about'), unbuilt?.about ?? '');
  element('build-first').className = canResume ? 'secondary' : 'primary';
  element('build-first').setAttribute('aria-disabled', String(Boolean(unbuilt?.isBusy)));
  show(element('formats'), formats.length > 0);
  list(element('formats'), formats, ({name}) => name, 'format', (item, {name, title, url}) => {
    setText(part(item, 'a'), name);
    part(item, 'a').href = url;
    part(item, 'a').setAttribute('aria-label', title);
  });
  show(element('download'), download !== null);
  if (download) {
    element('download').href = download.url;
    setText(element('download-about'), download.about);
  }
}

/** @param {Screen} screen */
function showNotices({isAway, isScanElsewhere, problem, faults}) {
  show(element('away'), isAway);
  show(element('elsewhere'), isScanElsewhere);
  show(element('onward'), !isScanElsewhere);
  show(element('problem'), problem !== null);
  for (const line of /** @type {const} */ (['title', 'detail', 'hint'])) {
    setText(element(`problem-${line}`), problem?.[line] ?? '');
  }
  show(element('faults'), faults.length > 0);
  list(part(element('faults'), 'ul'), [...new Set(faults)], (fault) => fault, 'fault', setText);
}

/** @type {(screen: Screen) => void} */
let renderScanPage = () => {};

/** @type {(screen: Screen) => void} */
let renderLibrary = () => {};

/** Sets the renderer of the library (library_page.js), which is loaded when it is first opened. @param {(screen: Screen) => void} render */
export function showLibrary(render) {
  renderLibrary = render;
}

/** Sets the renderer of a scan's page (scan_page.js), which is loaded with the first scan in view. @param {(screen: Screen) => void} render */
export function showScanPage(render) {
  renderScanPage = render;
}

/** @param {Screen} screen */
export function render(screen) {
  document.title = screen.title;
  setText(element('announcement'), screen.announcement);
  showDevices(screen);
  showNotices(screen);
  if (screen.progress) {
    showProgress(screen.progress);
  }
  if (screen.details) {
    showDetails(screen.details);
  }
  show(element('unfinished'), screen.unfinished !== null);
  if (screen.unfinished) {
    setText(part(element('unfinished'), 'span'), screen.unfinished.text);
    part(element('unfinished'), 'a').href = `#${screen.unfinished.id}`;
  }
  renderScanPage(screen);
  showPanel(screen.panel);
  renderLibrary(screen);
  for (const id of ['start', 'pause', 'cancel', 'resume', 'end']) {
    element(id).disabled = screen.isAway;
    const isUnusable = screen.isBusy || Boolean(screen.progress?.isStopping) || (id === 'start' && !screen.canStart);
    element(id).setAttribute('aria-disabled', String(isUnusable));  // unlike disabled, it keeps the focus
  }
  if (screen.footer) {
    setText(element('version'), screen.footer.version);
    setText(element('disk'), screen.footer.disk);
  }
}

/**
 * @param {HTMLDialogElement} dialog
 * @returns {Promise<boolean>} whether the answer was yes
 */
function ask(dialog) {
  dialog.returnValue = '';
  part(dialog, 'button[type=button]').onclick = () => dialog.close();
  dialog.showModal();
  return new Promise((answer) => {
    dialog.addEventListener('close', () => answer(dialog.returnValue === 'yes'), {once: true});
  });
}

/** @param {string} name @returns {Promise<string | null>} the new name, or null to keep the old one */
export async function askName(name) {
  const field = element('rename-name');
  field.value = name;
  const answer = ask(element('rename-dialog'));
  field.select();
  return await answer && field.value.trim() !== name ? field.value.trim() : null;
}

/** @returns {Promise<boolean>} whether a model is to be deleted */
export const askDeleteBuild = () => ask(element('delete-build-dialog'));

/** @returns {Promise<boolean>} whether the bin is to be emptied */
export const askEmptyBin = () => ask(element('empty-bin-dialog'));
