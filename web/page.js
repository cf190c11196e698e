// The page's state and its changes. Requests to the scanner are made one at a time.

import * as api from './api/api.js';
import {here, titleAt} from './places.js';
import {screenOf} from './screen.js';
import {marked, tellEnd} from './scan/finish.js';
import {renderStage} from './scan/stage.js';
import * as states from './state.js';
import {text} from './base/texts.js';
import {render} from './view.js';

export let state = states.initial;
export let asked = 0;  // requests to the scanner so far; a status from before the latest is outdated

/** @param {states.State} next */
export function change(next) {
  const wasSelected = state.selected;
  const before = states.running(state);
  state = next;
  if (here() === 'scan' && wasSelected !== state.selected && location.hash.slice(1) !== (state.selected ?? '')) {
    location.hash = state.selected ?? '';
  }
  if (before !== null && states.running(state)?.id !== before.id) {
    tellEnd(states.scanOf(state, before.id)?.state ?? before.state);
  }
  const screen = screenOf(state);
  render({...screen, title: marked(titleAt(here(), screen.title))});
  renderStage(screen.stage);
}

/** @type {Set<string>} */
const pending = new Set();
let last = Promise.resolve();

/**
 * Runs a user's action after those before it, and shows the reason if it fails. The same action is not begun twice at a time, as
 * by a double click.
 * @param {string} failure  key of the failure's text
 * @param {() => Promise<(state: states.State) => states.State>} action  resolves to the change of state
 * @param {string} [subject]  what it is done to
 */
export async function act(failure, action, subject = '') {
  const name = `${failure} ${subject}`;
  if (pending.has(name)) {
    return;
  }
  pending.add(name);
  last = last.then(() => run(failure, action)).finally(() => pending.delete(name));
  await last;
}

/** @param {string} failure @param {() => Promise<(state: states.State) => states.State>} action */
async function run(failure, action) {
  change(states.withPending(state));
  try {
    const apply = await action();
    change(apply(states.withAnswer(state)));
  } catch (error) {
    const {title, detail, hint} = error instanceof api.Problem ? error : new api.Problem('page', String(error));
    change(states.withStaleList(states.withProblem(states.withAnswer(state), {title: text(failure), detail: detail || title, hint})));
  }
  ++asked;
}
