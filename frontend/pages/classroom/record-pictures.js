// The record of a hidden fault: a strip for each output, what is measured minus what is predicted.

import {fill, h} from '../../common/dom.js';
import {t} from '../../i18n/words.js';
import {CurvePicture} from './curve-picture.js';

/** @import * as service from '../../types/service.js' */

export class RecordPictures {
  constructor() {
    this.caption = h('p', {class: 'soft small'});
    this.strips = h('div', {class: 'records'});
    this.root = h('div', {}, this.caption, this.strips);
    /** @type {CurvePicture[]} */
    this.pictures = [];
    /** @type {service.CurvesHead | null} */
    this.head = null;
  }

  /** @param {service.CurvesHead} head */
  begin(head) {
    this.head = head;
    const {panels} = head;
    this.pictures = panels.map((panel, place) => {
      const picture = new CurvePicture({compact: true, times: place === panels.length - 1});
      const {symbol, title, unit, line} = panel;
      picture.begin({...head, strip: {symbol, residual: true, title, unit, lines: [line]}});
      return picture;
    });
    fill(this.caption, t('page.class.residuals'));
    this.strips.dataset.count = String(panels.length);
    fill(
      this.strips,
      this.pictures.map(({root}) => root),
    );
  }

  /** @param {{epoch: number, first: number, count: number, data: Float32Array}} frame */
  add({epoch, first, count, data}) {
    this.pictures.forEach((picture, place) =>
      picture.add({epoch, first, count, data: data.subarray(place * count, (place + 1) * count)}),
    );
  }

  /** Rows that are known already. @param {service.Replay} replay @param {number} horizon */
  replay({record, panels, values}, horizon) {
    this.begin({type: 'curves', strip: null, panels, record, epoch: 0, row: 0, horizon});
    this.pictures.forEach((picture, place) =>
      picture.add({
        epoch: 0,
        first: 0,
        count: values[place].length,
        data: Float32Array.from(values[place], (v) => v ?? NaN),
      }),
    );
  }

  /** Whether no row is there. */
  get empty() {
    return (this.pictures[0]?.lines[0]?.length ?? 0) === 0;
  }

  get now() {
    return this.pictures[0]?.now ?? 0;
  }

  /** @param {Parameters<CurvePicture['show']>[0]} view */
  show(view) {
    this.pictures.forEach((picture, place) =>
      picture.show({...view, marks: view.marks?.map((mark) => (place ? {...mark, text: ''} : mark))}),
    );
  }

  label() {
    fill(this.caption, t('page.class.residuals'));
    for (const picture of this.pictures) {
      picture.label();
      picture.soon();
    }
  }
}

/**
 * The marks of an outcome: the fault, from when on it could be told, the detector, the student.
 * @param {service.Outcome | null} outcome
 * @param {service.ChallengeAnswer | null} answer
 * @param {number} end
 * @param {{fault: string, detector: string, student: string}} words
 * @returns {Parameters<CurvePicture['show']>[0]}
 */
export function outcomeView(outcome, answer, end, words) {
  /** @type {{t: number, kind: 'ink' | 'fault' | 'alarm', text: string}[]} */
  const marks = [];
  const fault = outcome?.fault;
  if (fault) marks.push({t: fault.onset, kind: 'fault', text: words.fault});
  const detector = outcome?.detector;
  if (detector && detector.verdict !== 'none') marks.push({t: detector.at, kind: 'alarm', text: words.detector});
  if (answer) marks.push({t: answer.at, kind: 'ink', text: words.student});
  return {
    marks,
    fault: fault ? [fault.onset, end] : null,
    untold: fault ? [fault.onset, outcome?.told ?? end] : null,
  };
}
