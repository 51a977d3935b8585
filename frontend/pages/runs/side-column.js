// Beside the figures: how the observers compare, whether their assumptions hold, the source's errata, what to take along.

import {fill, h, number, symbol} from '../../common/dom.js';
import {text} from '../../i18n/pages.js';
import {downloads} from './downloads.js';

const chip = (place) => h('span', {class: 'chip', style: `--c:var(--o${place % 6})`});
const card = (title, ...body) => h('section', {class: 'card'}, h('h2', {}, title), ...body);

export function mountSide(root, store) {
  store.subscribe((state, before) => {
    if (state.spec === before.spec && state.run === before.run) return;
    const {spec, run, plant} = state;
    if (!spec) return fill(root);
    const observers = run?.summary?.observers ?? [];
    return fill(
      root,
      run && troubles(run.summary),
      observers.length > 0 && card(text.comparison, comparison(observers, plant)),
      observers.some((one) => one.checks.length) && card(text.assumptions, observers.map(assumptions)),
      spec.errata.length > 0 &&
        card(
          text.errata,
          h(
            'ul',
            {class: 'errata'},
            spec.errata.map((item) => h('li', {}, item)),
          ),
        ),
      run && card(text.downloads, downloads(state)),
    );
  });
}

/** Notes of the run, and the divergence of the plant itself. */
function troubles({diverged, notes}) {
  const lines = [
    ...(diverged
      ? [h('p', {class: 'alarm'}, text.plantDiverged(number(diverged.time), text.said(diverged.cause)))]
      : []),
    ...notes.map((note) => h('p', {}, note)),
  ];
  return lines.length ? card(text.notes, lines) : null;
}

/** One column an observer, one row a measure: RMSE of each state, θ̂ at the end, settling after each step of a fault. */
function comparison(observers, plant) {
  const many = observers.length > 2;
  const head = h(
    'tr',
    {},
    h('td'),
    observers.map((one, place) =>
      h(
        'th',
        {scope: 'col'},
        chip(place),
        one.label,
        one.diverged &&
          h('small', {class: 'alarm', title: text.said(one.diverged.cause)}, text.diverged(number(one.diverged.time))),
      ),
    ),
  );
  const units = new Map([...(plant?.states ?? []), ...(plant?.channels ?? [])].map((item) => [item.name, item.unit]));
  const row = (name, title, note, cells) =>
    h(
      'tr',
      {},
      h(
        'th',
        {scope: 'row', title: [title, units.get(name)].filter(Boolean).join(', ')},
        symbol(name),
        note && h('small', {}, note),
      ),
      cells.map((cell) => h('td', {}, cell)),
    );
  const named = (pick) => [...new Set(observers.flatMap((one) => Object.keys(pick(one) ?? {})))];
  const group = (title, hint, rows) =>
    rows.length
      ? h(
          'tbody',
          {},
          h('tr', {class: 'group'}, h('th', {colspan: observers.length + 1, scope: 'rowgroup', title: hint}, title)),
          rows,
        )
      : null;
  const rmse = named((one) => one.rmse).map((state) =>
    row(
      state,
      text.rmseHint,
      null,
      observers.map((one) => number(one.rmse[state], 3)),
    ),
  );
  const final = named((one) => one.theta).map((channel) => {
    const truth = number(observers.find((one) => one.theta?.[channel])?.theta[channel].truth);
    return row(
      channel,
      text.atEndHint(truth),
      many ? truth : `${text.truth} ${truth}`,
      observers.map((one) => number(one.theta?.[channel]?.estimate, many ? 3 : 4)),
    );
  });
  const steps = (observers.find((one) => one.settling?.length)?.settling ?? []).map(({channel, at}) =>
    row(
      channel,
      text.settledHint,
      `${at} s`,
      observers.map((one) => settled(one.settling?.find((entry) => entry.channel === channel && entry.at === at))),
    ),
  );
  return h(
    'div',
    {class: 'wide', tabindex: 0},
    h(
      'table',
      {class: many ? 'many' : null},
      h('thead', {}, head),
      group(text.rmse, text.rmseHint, rmse),
      group([h('span', {class: 'math'}, h('i', {class: 'hat'}, 'θ')), ` ${text.atEnd}`], null, final),
      group(text.settled, text.settledHint, steps),
    ),
  );
}

function settled(entry) {
  if (!entry) return '–';
  if (entry.time !== null) return number(entry.time, 3);
  return entry.reached === null ? text.never : `(${number(entry.reached, 3)})`;
}

/** The lights of an observer, each opening to what was checked. */
function assumptions(one, place) {
  const lights = one.checks.map((check) => h('span', {class: `light ${verdict(check)}`}));
  const rows = one.checks.map((check) =>
    h(
      'li',
      {},
      h('span', {class: `light ${verdict(check)}`}),
      h('b', {}, text.said(check.name)),
      ` ${text.verdicts[check.verdict]}`,
      h(
        'span',
        {class: 'soft'},
        text.said(check.text),
        check.value === null
          ? ''
          : ` (${text.found(number(check.value), check.threshold === null ? null : number(check.threshold))})`,
        check.source ? `. ${check.source}` : '',
      ),
    ),
  );
  const count = (kind) => one.checks.filter((check) => check.verdict === kind).length;
  const spoken = Object.keys(text.verdicts)
    .filter(count)
    .map((kind) => `${count(kind)} ${text.verdicts[kind]}`)
    .join(', ');
  return h(
    'details',
    {class: 'checks'},
    h(
      'summary',
      {},
      chip(place),
      h('b', {}, one.label),
      h('span', {class: 'lights', role: 'img', 'aria-label': spoken, title: spoken}, lights),
    ),
    one.title && h('p', {class: 'soft'}, text.named(one.title)),
    h('ul', {}, rows),
  );
}

const verdict = (check) => ({holds: 'ok', fails: 'bad'})[check.verdict] ?? 'open';
