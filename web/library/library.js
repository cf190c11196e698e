// Search and order of the listed scans. Pure.

import * as format from '../base/format.js';
import {locale} from '../base/texts.js';

/** @typedef {import('../api/api.js').Scan} Scan */

/**
 * @typedef {Object} Library
 * @property {string} query  search text
 * @property {'newest' | 'oldest' | 'name' | 'largest'} order
 * @property {number} limit  maximum number of cards, as a thousand would take a phone seconds
 * @property {string[] | null} chosen  selected ids; null: no selection mode
 */

export const step = 60;  // cards added by each "Show more"

/** @type {Library} */
export const initial = {query: '', order: 'newest', limit: step, chosen: null};

/** @param {Scan} scan */
const volume = ({model}) => model ? model.size_mm.reduce((product, side) => product * side, 1) : 0;

/** @param {string} text */
const folded = (text) => text.normalize('NFKD').replace(/\p{Diacritic}/gu, '').toLowerCase();

/**
 * @param {Scan[]} scans  newest first
 * @param {Library} library
 * @param {(scan: Scan) => string} nameOf
 * @returns {Scan[]} the matching scans, sorted
 */
export function found(scans, {query, order}, nameOf) {
  const words = folded(query).split(/\s+/).filter(Boolean);
  const matches = words.length === 0 ? scans :
    scans.filter((scan) => {
      const text = folded([nameOf(scan), format.when(scan.created), scan.inventory_number, ...scan.tags].join(' '));
      return words.every((word) => text.includes(word));
    });
  switch (order) {
    case 'oldest': return [...matches].reverse();
    case 'name': return [...matches].sort((a, b) => nameOf(a).localeCompare(nameOf(b), locale, {numeric: true}));
    case 'largest': return [...matches].sort((a, b) => volume(b) - volume(a));
    default: return matches;
  }
}

/** Selects or deselects a scan. @param {Library} library @param {string} id @returns {Library} */
export const withToggled = (library, id) => {
  const chosen = library.chosen ?? [];
  return {...library, chosen: chosen.includes(id) ? chosen.filter((other) => other !== id) : [...chosen, id]};
};

/** Selects all these scans, or none if all are selected already. @param {Library} library @param {string[]} ids @returns {Library} */
export const withAll = (library, ids) =>
  ({...library, chosen: ids.every((id) => library.chosen?.includes(id)) ? [] : ids});

/** The tags of a text that commas separate, each once. @param {string} text @returns {string[]} */
export const tagsIn = (text) => [...new Set(text.split(',').map((tag) => tag.trim()).filter(Boolean))];

/** The tags of all scans, sorted. @param {Scan[]} scans @returns {string[]} */
export const knownTags = (scans) => [...new Set(scans.flatMap(({tags}) => tags))]
    .sort((a, b) => a.localeCompare(b, locale, {numeric: true}));

/** The URL of a model's thumbnail, different for each build. @param {Scan} scan */
export const pictureOf = ({id, model, build}) => model ? `api/v1/scans/${id}/thumbnail.png?build=${build ?? 0}` : '';
