// Opens a dialog by its name; dialogs.js registers how.

/** @type {(name: string) => void} */
let show = () => {};

/**
 * Open a dialog by name: equations, help, share, export.
 * @param {string} name
 */
export const open = (name) => show(name);

/**
 * Say how dialogs are opened.
 * @param {(name: string) => void} how
 */
export function opens(how) {
  show = how;
}
