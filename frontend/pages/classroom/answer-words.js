// Answers and outcomes about a hidden fault in words.

import {number} from '../../common/dom.js';
import {named, t} from '../../i18n/words.js';

/** @import * as service from '../../types/service.js' */

/** The name of a fault. @param {service.RoundView} round @param {string | null | undefined} channel */
export function channelName({choices}, channel) {
  const choice = choices.find((one) => one.channel === channel);
  return choice ? named(choice.title) : (channel ?? '');
}

/** What was answered, in a few words. @param {service.RoundView} round @param {service.ChallengeAnswer} answer */
export function answerWords(round, answer) {
  if (answer.verdict === 'none') return t('page.class.nothing');
  if (answer.verdict === 'cannot-be-told') return t('page.class.cannot');
  return channelName(round, answer.channel);
}

/** The names of faults that look alike. @param {service.RoundView} round @param {readonly string[]} channels */
export const alikeWords = (round, channels) =>
  channels.map((one) => channelName(round, one)).join(t('page.class.comma'));

/** What was hidden. @param {service.RoundView} round @param {service.Outcome} outcome */
export const truthWords = (round, {fault}) => (fault ? channelName(round, fault.channel) : t('page.class.nothing'));

/** From when on it could be told. @param {service.RoundView} round @param {service.Outcome} outcome */
export function toldWords(round, {fault, told, alike}) {
  if (!fault) return t('page.class.was-nothing');
  if (told === null) return t('page.class.never-told', {names: alikeWords(round, alike)});
  return t('page.class.told-from', {name: channelName(round, fault.channel), t: number(told, 4)});
}

/** Minutes and seconds. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.max(0, Math.ceil(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}
