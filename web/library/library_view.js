// Renders the library of stored scans.

import {element, list, part, setBadge, setText, setVerbatim, show} from '../base/dom.js';
import {text} from '../base/texts.js';

/** @typedef {ReturnType<import('../screen.js').screenOf>} Screen */

/** @param {HTMLElement} frame @param {string} url  empty: no picture */
function showPicture(frame, url) {
  const image = part(frame, 'img');
  const isThere = url !== '' && image.dataset.failed !== url;
  show(image, isThere);
  show(part(frame, 'svg'), !isThere);
  if (isThere && image.getAttribute('src') !== url) {
    image.onerror = () => {
      image.dataset.failed = url;
      showPicture(frame, url);
    };
    image.src = url;
  }
}

/** @param {Screen} screen */
function showChosen({isChoosing, chosen, tags, formats}) {
  element('choose').setAttribute('aria-pressed', String(isChoosing));
  show(element('chosen'), isChoosing);
  list(element('library-tags'), tags, (tag) => tag, 'tag-option', (option, tag) => {
    option.value = tag;
  });
  list(element('chosen-format'), formats, (format) => format, 'format-option', (option, format) => {
    option.value = format;
    setText(option, format.toUpperCase());
  });
  for (const [id, file] of [['chosen-zip', `scans.zip?format=${element('chosen-format').value}&ids=`], ['chosen-csv', 'scans.csv?ids=']]) {
    element(id).href = `api/v1/${file}${chosen.join()}`;
  }
  setText(part(element('chosen-zip'), 'span'), text('library.zip', {count: chosen.length}));
  setText(element('delete-chosen'), text('library.delete-chosen', {count: chosen.length}));
  for (const control of element('chosen').querySelectorAll('[data-needs]')) {
    control.setAttribute('aria-disabled', String(chosen.length === 0));
  }
}

/** @param {Screen} screen */
export function renderLibrary(screen) {
  const {rows, isListed, count, summary, more, isChoosing} = screen;
  show(element('no-scans'), isListed && count === 0);
  show(element('library-tools'), count > 1 || isChoosing);
  setText(element('library-count'), summary);
  show(element('no-match'), count > 0 && rows.length === 0);
  show(element('show-more'), more > 0);
  setText(element('show-more'), text('library.more', {count: more}));
  showChosen(screen);
  list(element('rows'), rows, ({id}) => id, 'row', (item, row) => {
    item.classList.toggle('current', row.isCurrent);
    showPicture(part(item, '.scan-picture'), row.picture);
    const choice = part(item, '.scan-choice');
    show(choice, isChoosing && !row.isRunning);
    part(choice, 'input').checked = row.isChosen;
    part(choice, 'input').setAttribute('aria-label', text('library.choose', {name: row.name}));
    const name = part(item, '.scan-name');
    setVerbatim(name, row.name);
    name.href = `#${row.id}`;
    name.toggleAttribute('aria-current', row.isCurrent);
    setBadge(part(item, '.badge'), row.badge);
    setText(part(item, '.scan-when'), row.when);
    setText(part(item, '.scan-about'), row.about);
    list(part(item, '.scan-tags'), row.tags, (tag) => tag, 'tag', (button, tag) => {
      setVerbatim(button, tag);
      button.title = text('library.tagged', {tag});
    });
    for (const action of item.querySelectorAll('[data-do]')) {
      action.setAttribute('aria-label', text('library.action', {action: action.title, name: row.name}));
    }
    const download = part(item, '[data-do=download]');
    show(download, row.download !== null);
    download.href = row.download ?? '';
    show(part(item, '[data-do=delete]'), !row.isRunning);
  });
}
