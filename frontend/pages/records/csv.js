// What the page itself does with CSV text: the columns for its picture, and only those on their way to the server. Pure.

/** What parts the cells, as backend/thetascope/assembly/analyses/csv_columns.py has it; where semicolons do, numbers may have a decimal comma. */
const parting = (csv) => [',', ';', '\t'].find((one) => csv.split(/\r?\n/u, 1)[0].includes(one)) ?? ',';

/** The columns of CSV text: for the picture only; the server reads the text itself. */
export function columnsOf(csv) {
  const apart = parting(csv);
  const [head, ...lines] = csv.trim().split(/\r?\n/u);
  const rows = lines.map((line) =>
    line.split(apart).map((cell) => Number(apart === ';' ? cell.replace(',', '.') : cell)),
  );
  return Object.fromEntries(head.split(apart).map((name, place) => [name.trim(), rows.map((row) => row[place])]));
}

/**
 * The same text with no more columns than a plant's diagnosis reads (backend/thetascope/assembly/analyses/record_diagnosis.py), since a whole run may be larger than what
 * the server takes. Text that does not fit is left as it is, so that a refusal names what stands in the file.
 */
export function needed(csv, plant) {
  const [head, ...lines] = csv.split(/\r?\n/u);
  const apart = parting(csv);
  const names = head.split(apart).map((name) => name.trim());
  const column = (...spellings) => names.indexOf(spellings.find((name) => names.includes(name)));
  const places = (prefix, group) => group.map(({name}) => column(`${prefix}.${name}`, name));
  const must = [column('t', 'time'), ...places('y', plant.outputs)];
  if (must.includes(-1) || new Set(names).size < names.length || csv.includes('"')) return csv;
  const kept = [...new Set([...must, ...places('u', plant.inputs), ...places('signal', plant.signals)])].filter(
    (place) => place >= 0,
  );
  const rows = [names, ...lines.map((line) => line.split(apart))];
  if (rows.some((row) => row.length !== names.length && !(row.length === 1 && row[0] === ''))) return csv;
  return rows.map((row) => (row.length === 1 ? row[0] : kept.map((place) => row[place]).join(apart))).join('\n');
}
