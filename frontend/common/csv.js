// Cells of comma-separated values. Pure.

/**
 * A value as a cell. Text that a spreadsheet would take for a formula follows an apostrophe, and control characters are
 * blanks, as in files of the service (backend/thetascope/export/csv_format.py).
 * @param {string | number | boolean | null} value
 */
export function csvCell(value) {
  if (typeof value !== 'string') return value === null ? '' : String(value);
  const line = value.replaceAll(/[\u0000-\u001f\u007f-\u009f\u2028\u2029]/gu, ' ');
  const text = /^\s*[=+\-@＝＋－＠]/u.test(line) ? `'${line}` : line;
  return /[",']/u.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
