// The log of the session, and its notes; a click shows that moment in the scope.

import {childrenOf, fill, h} from '../../common/dom.js';
import {wholeLines} from '../../widgets/whole-lines.js';
import {heading, link} from '../../widgets/controls.js';
import {icon} from '../../widgets/svg.js';
import {lines} from '../ui/event-words.js';
import {noteLine} from '../notes/note-line.js';
import {notesOf} from '../notes/note-words.js';
import {t} from '../../i18n/words.js';

/** @import {App} from '../types.js' */
/** @import {Line} from '../ui/event-words.js' */

/** @param {HTMLElement} element @param {App} app */
export function mount(element, app) {
  const list = h('ol', {class: 'log scroll', tabindex: 0});
  let signs = {}; // gains as their cards write them
  const more = wholeLines(list, () => childrenOf(list), app);
  let lineOf = new WeakMap(); // event → its line, so that an event does not rebuild a long log
  const build = () => {
    lineOf = new WeakMap();
    list.setAttribute('aria-label', t('page.log.title'));
    const add = link(t('page.notes.add'), () => app.act.notes.begin(), {
      class: 'link control-only',
      title: t('page.transport.note'),
    });
    fill(element, heading(t('page.log.title'), add), list, more);
    update();
  };
  const update = () => {
    const entries = [
      ...notesOf(app.state).map((note) => ({t: note.t, line: () => noteLine(note, app)})),
      ...lines(app.state.log, app.state.plant, signs).map((one) => ({t: one.t, line: () => kept(one)})),
    ].sort((a, b) => b.t - a.t); // the order of lines of one time stays
    fill(list, entries.length ? entries.map((entry) => entry.line()) : h('li', {class: 'soft'}, t('page.log.empty')));
  };
  /** @param {Line} one */
  const kept = (one) => {
    if (!lineOf.has(one.event)) lineOf.set(one.event, line(one));
    return lineOf.get(one.event);
  };
  /** @param {Line} entry */
  const line = ({t: at, words, alarm, own}) =>
    h(
      'li',
      {class: alarm ? 'alarm' : own ? 'own' : null},
      h(
        'button',
        {type: 'button', class: 'moment', title: t('page.log.show'), onclick: () => look(at)},
        h('span', {class: 'time'}, at.toFixed((app.state.spec?.horizon ?? 0) >= 1000 ? 0 : 1)),
        h('span', {}, words),
      ),
      h(
        'button',
        {
          type: 'button',
          class: 'plain back control-only',
          title: t('page.log.back'),
          'aria-label': t('page.log.back-to', {t: at.toFixed(1)}),
          onclick: () => app.act.seek(at),
        },
        icon('back', 13),
      ),
    );
  /** @param {number} at */
  const look = (at) => {
    const span = app.state.window ?? 30;
    app.act.select(Math.max(0, at - span / 5), Math.max(0, at - span / 5) + span);
  };
  app.catalogue.then(
    ({observers}) => {
      signs = Object.fromEntries(
        observers.flatMap(({gains}) => gains.map(({name, symbol}) => [name, symbol]).filter(([, symbol]) => symbol)),
      );
      build();
    },
    () => {},
  );
  app.subscribe((state) => [state.language, state.session], build);
  app.subscribe((state) => [state.log, state.spec?.notes], update);
}
