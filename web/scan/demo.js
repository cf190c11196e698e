// The demo for people without a rig: a scan of the simulated rig, part of the page. It is imported like any scan file, built
// on the scanner, and can be deleted. demo.zip has 16 stops of `octurn serve --simulate --simulate-perfect`. To keep it small, its
// depth images hold only readings within 10 cm of the axis.

import * as api from '../api/api.js';
import {act} from '../page.js';
import * as states from '../state.js';
import {text} from '../base/texts.js';

const file = 'demo.zip';

export const openDemo = () => act('failure.demo', async () => {
  const response = await fetch(file);
  if (!response.ok) {
    throw new api.Problem('http', text('problem.http', {status: String(response.status)}));
  }
  const {id} = await api.importScan(await response.blob());
  const scan = await api.label(id, {name: text('first.demo-name')});
  location.hash = scan.state === 'running' ? '' : id;
  return (now) => scan.state === 'running' ? states.withStarted(now, scan) : states.withSelected(states.withScan(now, scan), id);
});
