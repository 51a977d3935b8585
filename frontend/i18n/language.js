// Which language the pages speak: the one that was chosen here before, else the browser's.

const KEY = 'language';

/** 'en' or 'zh'. */
export function language() {
  let chosen = null;
  try {
    chosen = localStorage.getItem(KEY);
  } catch {
    /* private windows keep nothing */
  }
  return chosen ?? (navigator.language.startsWith('zh') ? 'zh' : 'en');
}

/** Speak another language from the next page on. */
export function speak(other) {
  try {
    localStorage.setItem(KEY, other);
  } catch {
    /* private windows keep nothing */
  }
}
