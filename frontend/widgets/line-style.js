// How observers' curves are told apart: seven colours, then the first ones again, dash-dotted. A curve that coincides
// with an earlier one is dash-dotted, too.

/** --o0 … --o6 */
export const COLOURS = 7;

/** Dash, gap, dot, gap in px. Plain dashes belong to the truth. */
export const DASH_DOT = [9, 3, 2, 3];

/** The colour of an observer by its place. @param {number} place */
export const colourOf = (place) => `var(--o${place % COLOURS})`;

/** Whether a place has a colour for the second time. @param {number} place */
export const repeats = (place) => place >= COLOURS;
