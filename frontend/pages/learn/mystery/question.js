// The card of a mystery: what may have happened, since when, how large; accuse, or answer.

import {fill, h} from '../../../common/dom.js';
import {refusal, slider} from '../../../widgets/controls.js';
import {named, t} from '../../../i18n/words.js';
import {linear} from '../../../widgets/slider-scale.js';
import {roundOf} from './place.js';
import {digits} from './times.js';

/** @import {Child} from '../../../types/dom.js' */
/** @import * as service from '../../../types/service.js' */
/** @import {Game} from './game.js' */

export class Question {
  /** @param {HTMLElement} card @param {Game} game */
  constructor(card, game) {
    this.card = card;
    this.game = game;
    /** @type {HTMLInputElement | null} */
    this.onset = null;
  }

  /** The choices in their order: the suspects, nothing, cannot be told. */
  get options() {
    return [...this.game.mystery.choices.map(({channel}) => channel), 'none', 'alike'];
  }

  /** @param {number} place */
  choose(place) {
    const choice = this.options[place];
    if (choice === undefined || this.game.sending) return;
    const suspect = this.game.mystery.choices.find(({channel}) => channel === choice);
    const same = choice === this.game.place.choice;
    this.game.set({choice, ...(same ? {} : {size: suspect ? first(suspect) : null})});
  }

  draw() {
    const {game} = this;
    const {mystery, place} = game;
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.keep : undefined;
    fill(
      this.card,
      h('p', {class: 'eyebrow'}, t('page.mystery.round', {n: roundOf(game.name), title: named(mystery.title)})),
      this.setups(),
      h('h1', {id: 'mystery-title', tabindex: -1}, t('page.mystery.title')),
      h('p', {class: 'say'}, t('page.mystery.say')),
      this.choices(),
      place.choice === 'alike' ? this.alike() : this.sliders(),
      this.claims(),
      this.buttons(),
    );
    if (focused) /** @type {HTMLElement | null} */ (this.card.querySelector(`[data-keep="${focused}"]`))?.focus();
  }

  /** The plant, which one may choose. */
  setups() {
    const {game} = this;
    /** @type {HTMLSelectElement} */
    const select = h(
      'select',
      {
        id: 'mystery-setup',
        'data-keep': 'setup',
        disabled: game.sending,
        onchange: () => game.another(select.value),
      },
      h('option', {value: '', selected: game.setup === ''}, t('page.mystery.any-setup')),
      game.setups.map(({id, title, suspects}) =>
        h(
          'option',
          {value: id, selected: game.setup === id},
          t('page.mystery.setup-line', {title: named(title), n: suspects}),
        ),
      ),
    );
    return h('p', {class: 'mystery-setup'}, h('label', {for: 'mystery-setup'}, t('page.mystery.setup')), select);
  }

  choices() {
    const {mystery, place, sending} = this.game;
    /** @param {string} value @param {Child} words @param {number} at */
    const option = (value, words, at) =>
      h(
        'label',
        {class: 'option'},
        h('input', {
          type: 'radio',
          name: 'what',
          value,
          'data-keep': `what-${value}`,
          checked: place.choice === value,
          disabled: sending,
          onchange: () => this.choose(at),
        }),
        h('span', {}, words),
        at < 10 && h('kbd', {}, (at + 1) % 10),
      );
    const count = mystery.choices.length;
    return h(
      'fieldset',
      {class: 'mystery-choices'},
      h('legend', {}, t('page.mystery.which')),
      mystery.choices.map(({channel, title}, at) => option(channel, named(title), at)),
      option('none', t('page.mystery.none'), count),
      option('alike', t('page.mystery.cannot'), count + 1),
    );
  }

  /** The channels that look alike. */
  alike() {
    const {mystery, place} = this.game;
    return h(
      'fieldset',
      {class: 'mystery-alike'},
      h('legend', {}, t('page.mystery.which-alike')),
      mystery.choices.map(({channel, title}) =>
        h(
          'label',
          {class: 'option'},
          h('input', {
            type: 'checkbox',
            'data-keep': `alike-${channel}`,
            checked: place.alike.includes(channel),
            onchange: () =>
              this.game.set({
                alike: place.alike.includes(channel)
                  ? place.alike.filter((one) => one !== channel)
                  : [...place.alike, channel],
              }),
          }),
          h('span', {}, named(title)),
        ),
      ),
    );
  }

  /** Since when, and how much. */
  sliders() {
    const {mystery, place} = this.game;
    this.onset = null;
    const suspect = mystery.choices.find(({channel}) => channel === place.choice);
    if (!suspect) return null;
    const since = h('output', {class: 'soft'}, this.since());
    this.onset = h('input', {
      type: 'range',
      id: 'mystery-onset',
      'data-keep': 'onset',
      min: 0,
      max: Math.max(mystery.record, this.game.seenUntil()),
      step: mystery.record,
      value: place.onset ?? 0,
      onchange: () => this.game.set({onset: Number(this.onset?.value)}),
      oninput: () => {
        place.onset = Number(this.onset?.value);
        since.textContent = this.since();
        this.game.strips.draw();
      },
    });
    this.onset.value = String(place.onset ?? 0);
    const row = slider({
      name: t('page.mystery.how-much'),
      scale: linear(suspect.low, suspect.high),
      value: place.size ?? first(suspect),
      low: suspect.low,
      high: suspect.high,
      change: (size, done) => {
        place.size = size;
        if (done) this.game.set({size});
      },
    });
    row.range.dataset.keep = 'size';
    row.field.dataset.keep = 'size-field';
    return h(
      'div',
      {class: 'mystery-sliders'},
      h('label', {for: 'mystery-onset'}, t('page.mystery.since-when')),
      this.onset,
      since,
      h('span', {}, t('page.mystery.how-much')),
      row.range,
      h('span', {class: 'mystery-size'}, row.field, h('span', {class: 'soft'}, suspect.unit)),
    );
  }

  since() {
    const {place, mystery} = this.game;
    return place.onset === null ? t('page.mystery.point') : `${digits(place.onset, mystery.end)} s`;
  }

  /** Whom one has named so far. */
  claims() {
    const {place, mystery} = this.game;
    if (!place.claims.length) return null;
    /** @param {string} key */
    const name = (key) =>
      key.includes(',')
        ? t('page.mystery.cannot')
        : named(mystery.choices.find(({channel}) => channel === key)?.title ?? key);
    return h(
      'ul',
      {class: 'mystery-claims', 'aria-label': t('page.mystery.accused')},
      place.claims.map(({key, t: at}) =>
        h('li', {}, t('page.mystery.claim', {name: name(key), t: digits(at, mystery.end)})),
      ),
    );
  }

  buttons() {
    const {game} = this;
    const wrong = h('p', {class: 'alarm', role: 'alert'});
    refusal(wrong, game.problem);
    return h(
      'div',
      {class: 'mystery-act'},
      h(
        'button',
        {
          type: 'button',
          class: 'run',
          'data-keep': 'answer',
          'aria-disabled': String(!game.ready || game.sending),
          onclick: () => game.finish(),
        },
        game.sending ? t('page.mystery.sending') : t('page.mystery.answer'),
      ),
      h(
        'button',
        {
          type: 'button',
          class: 'quiet',
          'data-keep': 'accuse',
          'aria-disabled': String(!game.accusable),
          onclick: () => game.accuse(),
        },
        t('page.mystery.accuse'),
        h('kbd', {}, 'A'),
      ),
      h('p', {class: 'soft'}, game.ready ? t('page.mystery.accuse.hint') : t('page.mystery.choose-first')),
      game.problem ? wrong : null,
    );
  }

  /** Time has passed: since when may reach farther. */
  follow() {
    if (this.onset) this.onset.max = String(Math.max(this.game.mystery.record, this.game.seenUntil()));
  }
}

/** The size that the slider begins with. @param {service.MysteryChoice} suspect */
const first = ({low, high}) => Number((low < 0 ? 0 : (low + high) / 2).toPrecision(2));
