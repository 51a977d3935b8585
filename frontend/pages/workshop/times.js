// When something was saved, in words: a time today, else the day.

import {language, t} from '../../i18n/words.js';

/** @param {number} seconds  since 1970 */
export function ago(seconds) {
  const then = new Date(seconds * 1000);
  const now = new Date();
  const tag = language() === 'zh' ? 'zh-CN' : 'en-GB';
  if (then.toDateString() === now.toDateString())
    return t('page.workshop.today', {time: then.toLocaleTimeString(tag, {hour: '2-digit', minute: '2-digit'})});
  return then.toLocaleDateString(tag, {day: 'numeric', month: 'short'});
}
