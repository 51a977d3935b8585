// Regions that scroll must be reachable by keyboard: how much fits depends on the font and the window.

const watcher = new ResizeObserver((entries) => {
  const boxes = new Set(entries.map(({target}) => (boxed.has(target) ? target : target.parentElement)));
  for (const box of boxes) if (box instanceof HTMLElement && boxed.has(box)) update(box);
});
const boxed = new WeakSet();

/** @param {HTMLElement} box */
function update(box) {
  const scrolls = box.scrollWidth > box.clientWidth || box.scrollHeight > box.clientHeight;
  if (scrolls) box.setAttribute('tabindex', '0');
  else box.removeAttribute('tabindex');
}

/**
 * Let Tab reach an element whenever it scrolls, and only then: an element with text alone has nothing else to focus.
 * @template {HTMLElement} T
 * @param {T} box  with its children in place
 * @returns {T}
 */
export function focusWhenScrolling(box) {
  boxed.add(box);
  watcher.observe(box);
  for (const child of box.children) watcher.observe(child);
  return box;
}
