// Which language the pages speak: the one that was chosen here before, else the browser's.

const KEY = 'language';

/** @typedef {'en' | 'zh'} Language */

/** The language to begin with. @returns {Language} */
export function chosenLanguage() {
  let chosen = null;
  try {
    chosen = localStorage.getItem(KEY);
  } catch {
    /* private windows keep nothing */
  }
  return (chosen ?? navigator.language).startsWith('zh') ? 'zh' : 'en';
}

/** Remember a choice for the next page. @param {Language} language */
export function rememberLanguage(language) {
  try {
    localStorage.setItem(KEY, language);
  } catch {
    /* private windows keep nothing */
  }
}
