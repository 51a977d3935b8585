// "Figure for a paper": a dialog that chooses size, type, curves and line styles of a figure of a run. The server draws
// it; the preview is its SVG, and a download is the file at the same options.

import {get, reason} from '../../common/api.js';
import {fill, h, number} from '../../common/dom.js';
import {language, t} from '../../i18n/words.js';
import {choice, field, lengthOrNull, segments, widths} from './paper-fields.js';
import {curvesAndPanels} from './paper-lists.js';

/** @import * as service from '../../types/service.js' */
/** @import {Settings} from './paper-fields.js' */

const FORMATS = ['pdf', 'svg', 'png', 'tex'];
const STYLE = 'thetascope.paper-style'; // in the browser's storage: the options that "Keep as my style" keeps
const KEPT = /** @type {const} */ (['width', 'font', 'size', 'colour', 'legend', 'lang']);
const MOST_INSIDE = 4; // curves for whose legend there is room beside them
const SMALLEST = 6; // pt, of type that journals take
const THINNEST = 0.35; // pt, of lines
const CSS_CM = 96 / 2.54; // px of a style sheet's centimetre

/** @returns {Settings} */
function kept() {
  const settings = {
    width: 8.5,
    height: null,
    font: 'times',
    size: 8,
    colour: 'grey',
    legend: 'inside',
    lang: language(),
  };
  try {
    return {...settings, ...JSON.parse(localStorage.getItem(STYLE) ?? '{}'), ...EMPTY()};
  } catch {
    return {...settings, ...EMPTY()};
  }
}
const EMPTY = () => ({height: null, start: null, end: null, curves: [], panels: [], styles: {}, format: 'pdf'});

/** Whether "Keep as my style" was pressed in this browser. */
function hasStyle() {
  try {
    return localStorage.getItem(STYLE) !== null;
  } catch {
    return false;
  }
}

/** @param {Settings} settings @param {string} format */
function queryOf(settings, format) {
  const query = new URLSearchParams({format});
  for (const name of /** @type {const} */ ([...KEPT, 'height', 'start', 'end']))
    if (settings[name] !== null && settings[name] !== undefined) query.set(name, String(settings[name]));
  for (const curve of settings.curves) query.append('curves', curve);
  for (const panel of settings.panels) query.append('panels', String(panel));
  for (const [curve, style] of Object.entries(settings.styles)) query.append('styles', `${curve}=${style}`);
  return query;
}

/**
 * Open the dialog for a figure of a run, or of several.
 * @param {string} address   of the figure, /api/runs/{id}/figures/{name}
 * @param {string} title
 * @param {number[]} [panels]   those that are drawn at first; empty: all
 * @param {URLSearchParams} [more]   further parts of the query, which choose the curves
 */
export function openPaper(address, title, panels = [], more = new URLSearchParams()) {
  const settings = {...kept(), panels};
  const image = h('img', {alt: t('page.paper.preview', {title})});
  const ruler = h('p', {class: 'ruler', 'aria-hidden': 'true'}, h('span'));
  const sheet = h('div', {class: 'sheet'}, image, ruler);
  const facts = h('p', {class: 'soft small', role: 'status'}, t('page.paper.drawing'));
  const lists = curvesAndPanels(set, settings);
  const caption = h('p', {class: 'caption'});
  const command = h('code');
  /** @type {AbortController | null} */
  let asking = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;

  let first = true;

  /** The address of the file in a format. @param {string} format */
  const printed = (format) => `${address}/print?${new URLSearchParams([...more, ...queryOf(settings, format)])}`;

  async function update() {
    asking?.abort();
    const mine = (asking = new AbortController());
    dialog.dataset.state = 'drawing';
    try {
      /** @type {service.PrintedFigure} */
      const described = await get(printed('json'), mine.signal);
      const wanted = printed('svg');
      if (first && described.curves.length > MOST_INSIDE && !hasStyle()) {
        first = false;
        legends.querySelectorAll('button')[1].click(); // above: inside it would cover curves
        return;
      }
      first = false;
      lists.show(described);
      height.placeholder = number(described.height);
      fill(caption, described.caption);
      fill(command, described.command.replace(/\.json$/, `.${settings.format}`));
      await new Promise((done, stop) => {
        image.onload = done;
        image.onerror = () => stop(new Error(t('page.runs.figure-failed')));
        image.src = wanted;
      });
      if (mine.signal.aborted) return;
      fit(described);
      fill(ruler, h('span'), t('page.paper.cm', {cm: number(described.width)}), h('span'));
      fill(facts, ...verdict(described));
      dialog.dataset.state = 'drawn';
    } catch (error) {
      if (mine.signal.aborted) return;
      const {message} = reason(error);
      fill(facts, h('span', {class: 'alarm'}, message));
      dialog.dataset.state = 'failed';
    }
  }

  /**
   * Show the figure as large as there is room, and its width below it.
   * @param {service.PrintedFigure} described
   */
  function fit({width, height}) {
    const {clientWidth, clientHeight} = sheet;
    const scale = Math.max(1, Math.min((clientWidth - 24) / width, (clientHeight - 56) / height)); // px per cm
    image.style.width = ruler.style.width = `${width * scale}px`;
    image.style.height = `${height * scale}px`;
  }

  /** @param {Partial<Settings>} changes */
  function set(changes) {
    Object.assign(settings, changes);
    clearTimeout(timer);
    timer = setTimeout(update, 300);
  }

  /** @param {service.PrintedFigure} described */
  function verdict({width, type_size, thinnest, apart}) {
    const scale = Math.round((100 * image.clientWidth) / (width * CSS_CM));
    const words = [t('page.paper.facts', {scale, size: number(type_size), line: number(thinnest)})];
    const bad = [
      type_size < SMALLEST && t('page.paper.small-type', {least: SMALLEST}),
      thinnest < THINNEST && t('page.paper.thin-line', {least: THINNEST}),
      !apart && t('page.paper.alike'),
    ].filter(Boolean);
    const end = bad.length
      ? h('span', {class: 'attend'}, bad.join(' '))
      : h('span', {class: 'ready'}, t('page.paper.ready'));
    return [...words, ' ', end];
  }

  const height = h('input', {
    type: 'number',
    step: 'any',
    'aria-label': t('page.paper.height'),
    oninput: ({currentTarget}) => set({height: currentTarget.value === '' ? null : currentTarget.valueAsNumber}),
  });
  const legends = segments(
    t('page.paper.legend'),
    ['inside', 'above', 'none'].map((name) => [name, t(`page.paper.legend.${name}`)]),
    settings.legend,
    (legend) => set({legend}),
  );
  const form = h(
    'form',
    {onsubmit: (/** @type {Event} */ event) => event.preventDefault()},
    field(
      t('page.paper.width'),
      ...widths(settings.width, (width) => set({width})),
      h('label', {class: 'length'}, '×', height, 'cm'),
    ),
    field(
      t('page.paper.type'),
      choice(
        t('page.paper.font'),
        [
          ['times', 'Times'],
          ['sans', 'Sans'],
          ['serif', 'Serif'],
        ],
        settings.font,
        (font) => set({font}),
      ),
      lengthOrNull(t('page.paper.size'), 'pt', (size) => set({size: size ?? 8}), settings.size),
    ),
    field(
      t('page.paper.colour'),
      segments(
        t('page.paper.colour'),
        ['colour', 'grey', 'black'].map((name) => [name, t(`page.paper.colour.${name}`)]),
        settings.colour,
        (colour) => set({colour}),
      ),
    ),
    field(t('page.paper.legend'), legends),
    field(
      t('page.paper.time'),
      lengthOrNull(t('page.paper.start'), 's', (start) => set({start})),
      '…',
      lengthOrNull(t('page.paper.end'), 's', (end) => set({end})),
    ),
    field(
      t('page.paper.words'),
      segments(
        t('page.paper.words'),
        [
          ['en', 'English'],
          ['zh', '中文'],
        ],
        settings.lang,
        (lang) => set({lang}),
      ),
    ),
    lists.root,
    h('h3', {}, t('page.paper.caption')),
    caption,
    h('p', {class: 'soft small'}, t('page.paper.command'), ' ', command),
  );
  const copy = button(t('page.paper.copy-caption'), async () => {
    await navigator.clipboard.writeText(`${caption.textContent} ${command.textContent}`);
    told(copy, t('page.action.copied'));
  });
  const keep = button(t('page.paper.keep'), () => {
    localStorage.setItem(STYLE, JSON.stringify(Object.fromEntries(KEPT.map((name) => [name, settings[name]]))));
    told(keep, t('page.paper.kept'));
  });
  const formats = segments(
    t('page.paper.format'),
    FORMATS.map((name) => [name, t(`page.paper.format.${name}`)]),
    settings.format,
    (format) => {
      settings.format = format;
      command.textContent = (command.textContent ?? '').replace(/\.\w+$/, `.${format}`);
    },
  );
  const download = h('button', {type: 'button', class: 'run', onclick: () => fetchTo()}, t('page.paper.download'));
  function fetchTo() {
    const link = h('a', {href: printed(settings.format), download: ''});
    document.body.append(link);
    link.click();
    link.remove();
  }
  /** @type {HTMLDialogElement} */
  const dialog = h(
    'dialog',
    {class: 'figure-dialog paper-dialog', 'aria-label': t('page.paper.title'), onclose: () => closed()},
    h(
      'header',
      {},
      h('h2', {}, t('page.paper.title')),
      h(
        'button',
        {type: 'button', class: 'quiet', 'aria-label': t('page.action.close'), onclick: () => dialog.close()},
        '×',
      ),
    ),
    h('div', {class: 'columns'}, form, h('div', {class: 'preview'}, sheet, facts)),
    h('footer', {}, formats, h('span', {class: 'grow'}), copy, keep, download),
  );
  function closed() {
    asking?.abort();
    clearTimeout(timer);
    dialog.remove();
  }
  document.body.append(dialog);
  dialog.showModal();
  update();
}

/** @param {string} words @param {() => unknown} act */
const button = (words, act) => h('button', {type: 'button', class: 'quiet', onclick: act}, words);

/** @param {HTMLElement} target @param {string} words */
function told(target, words) {
  const before = target.textContent;
  target.textContent = words;
  setTimeout(() => {
    target.textContent = before;
  }, 1500);
}
