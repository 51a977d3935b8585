// Data, report and specification of the run, and the command that repeats it.

import {spell} from './address.js';
import {h, number} from '../../common/dom.js';
import {text} from '../../i18n/pages.js';

export function downloads({run, chosen, foreign, ranWith}) {
  const link = (title, href, more = {}) => h('a', {class: 'quiet', href, ...more}, title);
  const data = (format) => `${run.links.data}?format=${format}`;
  const spec = URL.createObjectURL(new Blob([JSON.stringify(run.spec, null, 1)], {type: 'application/json'}));
  const seconds = Object.values(run.summary?.seconds ?? {}).reduce((sum, one) => sum + one, 0);
  return [
    h(
      'p',
      {class: 'links'},
      link(text.csv, data('csv'), {download: ''}),
      link(text.mat, data('mat'), {download: ''}),
      link(text.json, data('json'), {download: ''}),
      link(text.report, run.links.report, {title: text.reportHint, target: '_blank', rel: 'noopener'}),
      run.summary?.comparison &&
        link(text.comparisonCsv, `${run.links.comparison}?format=csv`, {download: '', title: text.comparisonHint}),
      link(text.spec, spec, {download: `${run.spec.id}.json`, title: text.specHint}),
    ),
    !foreign && command(chosen, JSON.parse(ranWith)),
    h(
      'p',
      {class: 'soft small'},
      `${text.runId} `,
      h('code', {}, run.id.slice(0, 12)),
      seconds ? `, ${text.took(number(seconds, 2))}` : '',
    ),
  ];
}

const quoted = (word) => (/^[\w.,:=+-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`);

function command(chosen, changes) {
  const words = [
    'thetascope run',
    quoted(chosen),
    ...Object.entries(changes).map(([path, to]) => `--set ${quoted(`${path}=${spell(to)}`)}`),
    '--out run.csv',
  ];
  const line = h('code', {}, words.join(' '));
  const copy = h(
    'button',
    {
      type: 'button',
      class: 'quiet',
      onclick: async () => {
        await navigator.clipboard.writeText(line.textContent);
        copy.textContent = text.copied;
        setTimeout(() => {
          copy.textContent = text.copy;
        }, 1500);
      },
    },
    text.copy,
  );
  return [h('p', {class: 'soft small'}, text.again), h('div', {class: 'command'}, line, copy)];
}
