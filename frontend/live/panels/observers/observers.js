// The running observers: colour, assumptions, gains that can be changed while they run. Observers can be added and
// removed.

import {post} from '../../../common/api.js';
import {childrenOf, fill, h} from '../../../common/dom.js';
import {createAdder} from './add-observer.js';
import {createCard} from './observer-card.js';
import {wholeLines} from '../../../widgets/whole-lines.js';
import {heading, link} from '../../../widgets/controls.js';
import {t} from '../../../i18n/words.js';

/** @import {App} from '../../types.js' */
/** @import {Card} from './observer-card.js' */
/** @import * as service from '../../../types/service.js' */

const FOLDED = 3; // with this many observers each is one line until it is opened

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const list = h('div', {class: 'watching'});
  const adder = h('div', {class: 'adder', hidden: true});
  // the form scrolls with the cards: however low the card is, its buttons can be reached
  const body = h('div', {class: 'scroll'}, adder, list);
  const more = wholeLines(body, () => childrenOf(list), app);
  const note = h('p', {class: 'soft bands-note', hidden: true});
  /** @type {Map<string, Card>} */
  let cards = new Map();
  /** @type {service.ObserverKind[]} */
  let kinds = [];
  let serial = 0;

  const build = () => {
    const add = link(t('page.observers.add-link'), () => toggle(), {
      'aria-expanded': 'false',
      class: 'link control-only',
    });
    /** @param {boolean} [on] */
    const toggle = (on = adder.matches('[hidden]')) => {
      adder.hidden = !on;
      add.setAttribute('aria-expanded', String(on));
      if (on)
        createAdder(adder, app, kinds, () => {
          toggle(false);
          add.focus();
        });
    };
    toggle(false);
    for (const card of cards.values()) card.end();
    cards = new Map();
    note.textContent = t('page.observers.bands-note');
    fill(element, heading(t('page.observers.title'), add), body, note, more);
    update();
  };
  const update = () => {
    const {observers} = app.state;
    /** @type {Map<string, Card>} */
    const kept = new Map();
    for (const observer of observers) {
      const key = `${observer.label}/${observer.kind}/${observer.since}`;
      const kind = kinds.find((one) => one.id === observer.kind);
      if (kind) kept.set(key, cards.get(key) ?? createCard(app, observer, kind));
    }
    for (const [key, card] of cards) if (!kept.has(key)) card.end();
    cards = kept;
    for (const card of cards.values()) card.unfold(cards.size < FOLDED);
    const wanted = [...cards.values()].map((card) => card.element);
    if (wanted.some((one, place) => list.children[place] !== one) || list.children.length !== wanted.length)
      fill(list, wanted.length ? wanted : h('p', {class: 'soft'}, t('page.observers.none')));
    for (const [key, card] of cards)
      card.update(observers.find((one) => key.startsWith(`${one.label}/${one.kind}/${one.since}`)));
    return filled();
  };
  /**
   * Every gain's present value, with defaults that depend on plant and noise, from the server; `anew`: the noise has
   * changed.
   * @param {boolean} [anew]
   */
  const filled = async (anew = false) => {
    const {spec, noise, observers} = app.state;
    const mine = (serial += 1);
    if (!spec || ![...cards.values()].some((card) => card.lacks(anew))) return;
    const plain = observers.map(({label, kind, gains, options}) => ({label, kind, gains, options}));
    try {
      /** @type {service.PresentGains} */
      const {gains, labels} = await post('/api/gains', {
        ...spec,
        noise,
        commands: [],
        faults: [],
        figures: [],
        observers: plain,
      });
      if (mine === serial) for (const card of cards.values()) card.defaults(gains[card.label], labels[card.label]);
    } catch {
      /* the gains that were set are shown without them */
    }
  };
  const load = async () => {
    const {language} = app.state;
    const {observers} = await app.catalogue;
    if (language !== app.state.language) return;
    kinds = observers;
    build();
  };
  app.subscribe(
    (state) => [state.language, state.session],
    () => load().catch(app.act.refused),
  );
  app.subscribe((state) => state.observers, update);
  app.subscribe(
    (state) => state.converging,
    (labels) => {
      note.hidden = labels.length === 0;
      update();
    },
  );
  app.subscribe(
    (state) => state.noise,
    () => filled(true),
  );
  app.subscribe(
    (state) => [state.checks, state.role],
    () => {
      for (const card of cards.values()) card.checks();
    },
  );
}
