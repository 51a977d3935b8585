// CSV text in the browser: its columns for the picture, and a copy with only the columns that the server needs. Pure.

/**
 * The separator of the cells, as backend/thetascope/assembly/analyses/csv_columns.py finds it; with semicolons,
 * numbers may have a decimal comma.
 * @param {string} csv
 */
const separator = (csv) => [',', ';', '\t'].find((one) => csv.split(/\r?\n/u, 1)[0].includes(one)) ?? ',';

/**
 * The columns of CSV text, for the picture only: the server reads the text itself.
 * @param {string} csv
 * @returns {{[name: string]: number[]}}
 */
export function columnsOf(csv) {
  const between = separator(csv);
  const [head, ...lines] = csv.trim().split(/\r?\n/u);
  const rows = lines.map((line) =>
    line.split(between).map((cell) => Number(between === ';' ? cell.replace(',', '.') : cell)),
  );
  return Object.fromEntries(
    head.split(between).map((name, place) => [name.trim().normalize('NFKC'), rows.map((row) => row[place])]),
  );
}

/**
 * The same text with no more columns than a plant's diagnosis reads
 * (backend/thetascope/assembly/analyses/record_diagnosis.py), since a whole run may be larger than the server accepts.
 * Text that does not fit is returned unchanged, so that a refusal names lines of the file.
 * @param {string} csv
 * @param {{outputs: {name: string}[], inputs: {name: string}[], signals: {name: string}[]}} plant
 * @returns {string}
 */
export function needed(csv, plant) {
  const [head, ...lines] = csv.split(/\r?\n/u);
  const between = separator(csv);
  const names = head.split(between).map((name) => name.trim().normalize('NFKC'));
  /** @param {...string} spellings  the first that there is, is meant */
  const column = (...spellings) => {
    const known = spellings.find((name) => names.includes(name));
    return known === undefined ? -1 : names.indexOf(known);
  };
  /** @param {string} prefix @param {{name: string}[]} group */
  const places = (prefix, group) => group.map(({name}) => column(`${prefix}.${name}`, name));
  const must = [column('t', 'time'), ...places('y', plant.outputs)];
  if (must.includes(-1) || new Set(names).size < names.length || csv.includes('"')) return csv;
  const kept = [...new Set([...must, ...places('u', plant.inputs), ...places('signal', plant.signals)])].filter(
    (place) => place >= 0,
  );
  const rows = [names, ...lines.map((line) => line.split(between))];
  if (rows.some((row) => row.length !== names.length && !(row.length === 1 && row[0] === ''))) return csv;
  return rows.map((row) => (row.length === 1 ? row[0] : kept.map((place) => row[place]).join(between))).join('\n');
}
