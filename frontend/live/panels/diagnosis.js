// The diagnosis: a sentence first, then one line a fault: how big, how sure, since when, found how fast.

import {fill, h} from '../../dom.js';
import {findings, sentence} from './findings.js';
import {badge, heading, link, seconds, steady, took} from './parts.js';
import {badges, plain, split} from './symbols.js';

export function mount(element, app) {
  const verdict = h('p', {class: 'verdict', role: 'status'});
  const list = h('div', {class: 'scroll'});
  const sure = h('p', {class: 'soft small sure', hidden: true});
  let lines = [];
  const build = () => {
    const how = link(app.text.howSure, () => {
      sure.hidden = !sure.hidden;
      how.setAttribute('aria-expanded', String(!sure.hidden));
    }, {'aria-expanded': String(!sure.hidden)});
    sure.textContent = app.text.howSureText;
    fill(element, heading(app.text.diagnosis, how), verdict, sure, list);
    update();
  };
  const update = () => {
    const {state, text} = app;
    if (!state.plant) return;
    const found = findings(state);
    const estimating = state.columns.some((column) => /^[^.]+\.theta\./.test(column) && !column.startsWith('theta.'));
    const said = sentence(found, {...state, estimating});
    const words = text.sentences[said.key]({...said, name: said.subject && nameOf(said.subject), took: said.took !== undefined && took(said.took), otherName: said.other && nameOf(said.other)});
    if (verdict.textContent !== words) verdict.textContent = words;
    lines = found.map((finding) => line(finding, app));
    fill(list, lines.length ? lines.map((one) => one.element) : state.plant.channels.length > 0 && h('p', {class: 'soft'}, state.plant.inputs.length ? text.invite : text.inviteOutputs));
    tick();
  };
  const nameOf = (subject) => (split(subject)[0].length === 1 ? plain(subject) : titleOf(app, subject));
  const tick = () => { for (const one of lines) one.tick(); };
  app.subscribe((state) => [state.language, state.plant], build);
  app.subscribe((state) => [state.alarms, state.faults, state.observers], update);
  app.onTick(tick);
}

const titleOf = (app, subject) => app.text.named(app.state.plant.channels.find((one) => one.name === subject)?.title) || plain(subject);

/** One finding: the newest estimate with two standard deviations, and the story in a line. */
function line(finding, app) {
  const {state, text} = app;
  const channel = state.plant.channels.find((one) => one.name === finding.subject);
  const value = h('span', {class: 'value', style: finding.observer && `color:${finding.observer.colour}`});
  const letters = badges(state.plant.channels).get(finding.subject) ?? split(finding.subject);
  const since = finding.began ?? finding.found;
  const story = [text.named(channel?.title) || text.measurementOf(plain(finding.subject)), text.since(seconds(since, state.spec.horizon))];
  const end = {named: () => [text.foundIn, ' ', h('b', {}, took(Math.max(0, finding.found - finding.began)))], unseen: () => text.notFound,
    false: () => h('span', {class: 'alarm'}, text.noFaultActs), over: () => text.isOver}[finding.verdict]();
  const element = h('div', {class: `finding${finding.verdict === 'unseen' || finding.verdict === 'named' ? ' on' : ''}`},
    badge(letters, {square: !channel}), h('div', {}, h('div', {class: 'line'}, h('span', {}, value, ' ', h('small', {}, finding.observer && channel?.unit)), h('span', {class: 'sub'}, end)), h('div', {class: 'sub'}, story.join(' · '))));
  return {element, tick: () => {
    const words = finding.observer ? estimate(app, finding, channel) : text.unknownSize;
    if (value.textContent !== words) value.textContent = words;
  }};
}

function estimate(app, {observer, subject}, channel) {
  const theta = app.latest(`${observer.label}.theta.${subject}`);
  const sigma = 2 * app.latest(`${observer.label}.sigma.${subject}`);
  const scale = Math.max(Math.abs(theta) || 0, channel.typical / 2);
  const size = `${theta > 0 ? '+' : ''}${steady(theta, scale, 3)}`;
  return Number.isFinite(sigma) ? `${size} ± ${steady(sigma, scale, 3)}` : size;
}
