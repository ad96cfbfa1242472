// Saves what a plot shows as a file: CSV of its numbers, PNG of its image. Nothing leaves the page.

export interface CsvColumn {
  name: string;
  values: Float64Array | ((row: number) => string);
}

const csvField = (text: string): string => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

// At most ten digits: the page's own numbers are rounded.
const numberText = (value: number): string => String(Number(value.toPrecision(10)));

// Rows [from, to) of the columns, header on line 1, as in displacement.csv. A gap is NaN.
export function csvText(columns: CsvColumn[], from: number, to: number): string {
  const lines = [columns.map(({ name }) => csvField(name)).join(',')];
  for (let k = from; k < to; ++k)
    lines.push(columns.map(({ values }) => (typeof values === 'function' ? csvField(values(k)) : numberText(values[k]!))).join(','));
  return lines.join('\n') + '\n';
}

let prefix = 'moiregauge';

// "clip.mp4" gives names that begin with "clip-".
export function nameFilesAfter(input: string): void {
  prefix = input.replace(/\.[^.]+$/, '') || 'moiregauge';
}

export const fileName = (name: string, ending: string): string =>
  `${prefix}-${name}`.replace(/[^\p{L}\p{N}._-]+/gu, '-').replace(/^[-.]+/, '') + ending;

export function save(name: string, content: Blob): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000); // a slow disk may still read it
}
