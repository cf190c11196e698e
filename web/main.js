// Polls the scanner, and handles the page's controls.

import * as api from './api/api.js';
import {seeStatus, watchAppliance} from './scanner/appliance.js';
import * as bin from './scan/bin.js';
import {watchCamera} from './scan/camera.js';
import {seeScans, watchSteps} from './scanner/checklist.js';
import {element} from './base/dom.js';
import * as events from './base/events.js';
import {prepareFinish} from './scan/finish.js';
import {prepareForm} from './scan/form.js';
import {asked, change, state} from './page.js';
import {here, preparePlaces, showPlace} from './places.js';
import {cancel, end, pause, rename, resume, start} from './scan/scan_actions.js';
import {prepareStage} from './scan/stage.js';
import {screenOf} from './screen.js';
import * as states from './state.js';
import {fillTexts, language} from './base/texts.js';
import {seeWarnings} from './scanner/warnings.js';

/** Fetches the builds of the scan in view, if they are not known yet. @param {states.State} now */
async function missingBuilds(now) {
  if (!states.areBuildsStale(now)) {
    return null;
  }
  const [page, requests] = await Promise.all([import('./scan/scan_page.js'), import('./api/api_builds.js')]);
  page.prepare();
  const scan = /** @type {string} */ (now.selected);
  return {scan, list: await requests.builds(scan)};
}

async function askForStatus() {
  const status = await api.status();
  events.note(status);
  return status;
}

/** Polls the scanner once, and shows all changes at once, including the list of scans. */
async function look() {
  const before = asked;
  try {
    const status = events.news(asked) ?? await askForStatus();
    seeStatus(status);
    seeWarnings(status);
    bin.seeRevision(status.scans_revision);
    const scans = states.isListStale(states.withStatus(state, status)) ? await api.scans() : null;
    const {defaults, formats} = state.defaults ? {defaults: state.defaults, formats: state.formats} : await api.configured();
    const builds = await missingBuilds(states.withStatus(state, status)).catch(() => null);  // fails if the scan was deleted
    if (before !== asked || state.isPending) {
      return;
    }
    if (!state.defaults) {
      prepareForm(defaults);
    }
    const news = states.withDefaults(states.withStatus(state, status), defaults, formats);
    const listed = scans ? states.withScans(news, scans) : news;
    change(builds && builds.scan === listed.selected ? states.withBuilds(listed, builds.scan, builds.list) : listed);
    seeScans(state.scans);
  } catch (error) {
    if (error instanceof api.Problem) {
      change(states.withoutAnswer(state));
    } else {
      reportError(error);  // of the page, and no sign that the scanner is silent
    }
  }
}

let wake = () => {};

/** Polls as long as the page is open. */
async function watch() {
  for (;;) {
    await look();
    await new Promise((/** @type {(value?: undefined) => void} */ done) => {
      const timer = setTimeout(done, states.pause(state));
      wake = () => {
        clearTimeout(timer);
        done();
      };
    });
  }
}

/** Shows the part of the page or the scan in the address. */
function follow() {
  const isScan = here() === 'scan';
  change(isScan ? states.withSelected(state, location.hash.slice(1) || null) : state);
  if (isScan && location.hash && state.listed !== null && state.selected === null) {
    history.replaceState(null, '', location.pathname);  // of no scan, or of the one that runs
  }
  showPlace();
}

function listen() {
  const click = (/** @type {string} */ id, /** @type {() => void} */ action) => element(id).addEventListener('click', action);
  element('form').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    if (screenOf(state).canStart) {
      start();
    } else {
      element('faults').scrollIntoView({block: 'nearest'});
    }
  });
  click('pause', pause);
  click('cancel', cancel);
  click('resume', resume);
  click('end', end);
  click('retry', () => wake());
  click('dismiss', () => change(states.withProblem(state, null)));
  click('show-model', () => change(states.withStage(state, 'model')));
  click('show-camera', () => change(states.withStage(state, 'camera')));
  click('details-rename', () => rename(state.selected));
  element('reasons').addEventListener('click', (/** @type {any} */ event) => {
    const field = event.target.closest('[data-field]')?.dataset.field;
    const form = /** @type {HTMLDetailsElement | null} */ (document.getElementById('build-again'));  // it comes later than the page
    if (field) {
      event.preventDefault();
      form && (form.open = true);
      document.getElementById(field)?.focus();
    }
    const reason = event.target.closest('.reason-places')?.closest('li').dataset.key;
    if (reason) {
      change(states.withReason(state, reason));
    }
  });
  addEventListener('hashchange', follow);
  document.addEventListener('visibilitychange', () => document.hidden || wake());
}

document.documentElement.lang = language;
fillTexts(document);
follow();
listen();
preparePlaces();
prepareFinish();
prepareStage();
watch();
events.listenForNews(() => wake());
watchCamera();
watchAppliance();
watchSteps();
