// The second bar: the plant's name, its state, and what can be done with it.

import {fill, h} from '../../common/dom.js';
import {icon} from '../../widgets/svg.js';
import {t} from '../../i18n/words.js';
import {errorsOf, idIn, isChanged, isReady} from './store.js';
import {ago} from './times.js';

/** @import {ShopActions, ShopState, ShopStore} from './types.js' */

/**
 * @param {HTMLElement} root
 * @param {ShopStore} store
 * @param {ShopActions} act
 */
export function mountBar(root, store, act) {
  root.setAttribute('aria-label', t('page.workshop.plant'));
  const name = h('h1');
  const sub = h('p', {class: 'sub'});
  const state = h('div', {class: 'state', role: 'status'});
  /** What needs a plant without errors: faded, pressing it shows the first one. @param {() => void} work */
  const needsPlant = (work) => () => (isReady(store.state) ? work() : act.toFirstError());
  const live = h('button', {type: 'button', class: 'run', id: 'open-live', onclick: needsPlant(act.openLive)});
  const run = h('button', {type: 'button', class: 'quiet', id: 'run-plant', onclick: needsPlant(act.run)});
  const record = h('button', {type: 'button', class: 'quiet', id: 'find-faults', onclick: needsPlant(act.findFaults)});
  const save = h('button', {type: 'button', class: 'quiet', id: 'save-plant', onclick: () => act.save()});
  const link = h('button', {type: 'button', class: 'quiet', id: 'link-plant', onclick: copy});
  const download = h('button', {type: 'button', class: 'quiet', id: 'download-plant', onclick: () => act.download()});
  fill(live, t('page.workshop.open-live'));
  fill(run, t('page.workshop.run'));
  fill(record, t('page.workshop.find-faults'));
  fill(save, t('page.workshop.save'));
  fill(link, icon('link'), h('span', {}, t('page.workshop.link')));
  fill(download, icon('export'), h('span', {}, t('page.workshop.download')));
  fill(
    root,
    h('div', {class: 'what'}, name, sub),
    state,
    h('div', {class: 'acts'}, live, run, record, h('span', {class: 'sep'}), save, link, download),
  );

  async function copy() {
    const address = await act.link();
    const words = /** @type {HTMLElement} */ (link.lastElementChild);
    try {
      await navigator.clipboard.writeText(address);
      words.textContent = t('page.workshop.link.copied');
    } catch {
      words.textContent = t('page.workshop.link.in-address');
    }
    setTimeout(() => {
      words.textContent = t('page.workshop.link');
    }, 2500);
  }

  store.subscribe(
    (now) => [now.source, now.good, now.check, now.text === now.source.text],
    (now) => {
      const title = now.check?.title || now.good?.title || idIn(now.text) || t('page.workshop.unnamed');
      name.textContent = title;
      document.title = `${title} · Thetascope`;
      sub.textContent = origin(now);
    },
  );
  store.subscribe(
    (now) => [now.check, now.checking, now.problem, now.notice],
    (now) => {
      const ready = isReady(now);
      for (const button of [live, run, record]) {
        button.classList.toggle('faded', !ready && !now.checking);
        button.setAttribute('aria-disabled', String(!ready));
      }
      fill(state, stateOf(now, act));
    },
  );
}

/** Where the text comes from, and whether it was changed. @param {ShopState} state */
function origin(state) {
  const {source} = state;
  const changed = isChanged(state);
  if (source.kind === 'library')
    return changed ? t('page.workshop.from-library.changed') : t('page.workshop.from-library');
  if (source.version === null) return t('page.workshop.not-saved');
  if (changed) return t('page.workshop.version.changed', {n: source.version});
  return t('page.workshop.version.saved', {n: source.version, when: ago(source.saved ?? 0)});
}

/** @param {ShopState} state @param {ShopActions} act */
function stateOf(state, act) {
  if (state.problem)
    return h('span', {class: 'alarm'}, state.problem.detail || state.problem.title || t('page.problem.unreadable'));
  if (state.notice)
    return [
      h('span', {}, state.notice.text),
      state.notice.undo &&
        h('button', {type: 'button', class: 'link', onclick: state.notice.undo}, t('page.workshop.undo')),
    ];
  const errors = errorsOf(state);
  if (errors.length === 0) return [];
  return h(
    'button',
    {type: 'button', class: 'link errors', onclick: act.toFirstError},
    h('span', {class: 'light bad'}),
    t('page.workshop.errors', {n: errors.length, line: errors[0].place.line}),
  );
}
