// Links that open a model in a slicer on this computer, and the address of a scan as text and as a QR code.

import {json} from '../api/api.js';
import {element, list, part, setText, show} from '../base/dom.js';
import {awaitFragment} from '../base/fragment.js';
import {text} from '../base/texts.js';

/**
 * The slicers that fetch a model from any address, and the links that have them do so. The schemes of OrcaSlicer and Bambu
 * Studio, which has another one on macOS, are from a third party's notes on their sources, that of Cura is from the request
 * that added it. None was tried. PrusaSlicer takes models of some websites only, by https. Pure.
 * @param {string} model  its address @param {boolean} isMac
 */
export function slicerLinks(model, isMac) {
  const file = encodeURIComponent(model);
  return [
    {name: 'OrcaSlicer', href: `orcaslicer://open?file=${file}`},
    {name: 'Bambu Studio', href: isMac ? `bambustudioopen://${file}` : `bambustudio://open?file=${file}`},
    {name: 'Cura', href: `cura://open?file=${file}`},
  ];
}

/** Whether an address means this computer only. Pure. @param {string} host */
export const isLocal = (host) => /^(localhost|127\..*|\[::1\])$/.test(host);

const isMac = () => /Mac/.test(navigator.platform);

const isOpen = () => part(element('share'), 'details')?.open;

async function fill() {
  const stl = new URL(element('download').href);
  const model = String(new URL(stl.pathname.replace(/stl$/, '3mf'), stl));
  const {password} = await json('settings').catch(() => ({password: 'everybody'}));
  const isFree = password === 'everybody';
  list(element('slicers'), isFree ? slicerLinks(model, isMac()) : [], ({name}) => name, 'slicer', (item, {name, href}) => {
    setText(part(item, 'a'), text('share.slicer', {slicer: name}));
    part(item, 'a').href = href;
  });
  setText(element('slicers-about'), text(isFree ? 'share.untried' : 'share.password'));
  const address = location.href;
  element('share-address').value = address;
  show(element('share-local'), isLocal(location.hostname));
  const {codePath} = await import('../scanner/wifi_code.js');
  const {size, path} = codePath(address);
  const picture = part(element('share'), 'svg');
  picture.setAttribute('viewBox', `0 0 ${size} ${size}`);
  part(picture, 'path').setAttribute('d', path);
}

function follow() {
  show(element('share'), !element('download').hidden);
  isOpen() && fill();
}

/** Fetches the fragment, and attaches its handlers. */
export async function prepareShare() {
  await awaitFragment(element('share'), 'share.html');
  part(element('share'), 'details').addEventListener('toggle', follow);
  element('share-address').addEventListener('focus', () => element('share-address').select());
  new MutationObserver(follow).observe(element('download'), {attributes: true, attributeFilter: ['href', 'hidden']});
  follow();
}
