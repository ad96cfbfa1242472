// The table of all runs of the folder, and measuring all new clips at once.
import { get, startJob, type BatchRow, type Entry } from './api';
import { attempt, button, field, say } from './parts/parts';
import { stateWords } from './entries';
import { entries, on } from './store';
import { runOf } from './setup/state';
import { saveText } from './parts/save_text';
import { el } from '../element';
import { brief, digitsFor, expanded, plain } from '../format';

interface Line {
  row: BatchRow;
  target: BatchRow['targets'][0] | undefined;
}

interface Column {
  title: string;
  text: (line: Line) => string;
  value: (line: Line) => number | string;
  isNumber?: boolean;
}

const sized = (value: number | null | undefined, u: number | null | undefined): string =>
  value == null ? '\u2013' : u == null ? brief(value) : plain(value, digitsFor(expanded(u)));
const bigger = (a: number | null | undefined, b: number | null | undefined): number => Math.max(a ?? -1, b ?? -1);

const kColumns: Column[] = [
  { title: 'Run', text: ({ row }) => row.name, value: ({ row }) => row.name },
  { title: 'State', text: ({ row }) => stateWords[row.state as Entry['state']] ?? row.state, value: ({ row }) => row.state },
  { title: 'Target', text: ({ target }) => target?.name ?? '\u2013', value: ({ target }) => target?.name ?? '' },
  { title: 'dx: peak to peak (mm)', isNumber: true, text: ({ target }) => sized(target?.peak_to_peak_mm.x, target?.u_mm.x), value: ({ target }) => target?.peak_to_peak_mm.x ?? -1 },
  { title: 'U (mm, k = 2)', isNumber: true, text: ({ target }) => (target?.u_mm.x == null ? '\u2013' : sized(expanded(target.u_mm.x), target.u_mm.x)), value: ({ target }) => target?.u_mm.x ?? -1 },
  { title: 'dy: peak to peak (mm)', isNumber: true, text: ({ target }) => sized(target?.peak_to_peak_mm.y, target?.u_mm.y), value: ({ target }) => target?.peak_to_peak_mm.y ?? -1 },
  { title: 'U (mm, k = 2)', isNumber: true, text: ({ target }) => (target?.u_mm.y == null ? '\u2013' : sized(expanded(target.u_mm.y), target.u_mm.y)), value: ({ target }) => target?.u_mm.y ?? -1 },
  { title: 'f1 (Hz)', isNumber: true, text: ({ target }) => (bigger(target?.f1_hz?.x, target?.f1_hz?.y) > 0 ? brief(target?.f1_hz?.y ?? target?.f1_hz?.x ?? 0) : '\u2013'), value: ({ target }) => bigger(target?.f1_hz?.x, target?.f1_hz?.y) },
  { title: 'Rows ok', isNumber: true, text: ({ target }) => (target ? `${target.ok} of ${target.frames}` : '\u2013'), value: ({ target }) => (target ? target.ok / target.frames : -1) },
];

const kPage = 500; // lines shown at once

export class BatchView {
  readonly element = el('article', { class: 'batch' });
  private readonly place = el('div', { class: 'card wide-table' });
  private readonly pitch = el('input', { type: 'text', inputmode: 'decimal', 'aria-label': 'Pitch of the new clips in mm', value: localStorage.getItem('moiregauge-pitch-mm') ?? '10' });
  private readonly measure: HTMLButtonElement;
  private lines: Line[] = [];
  private sortBy = 0;
  private isDown = false;
  private shown = kPage;
  private readonly stop: () => void;

  constructor(private readonly onRun: (path: string) => void) {
    this.measure = button('', () => void this.measureNew(), { class: 'primary' });
    this.element.append(el('header', { class: 'clip-head' }, el('h2', {}, 'All runs of the folder')),
      el('section', { class: 'card', 'aria-label': 'New clips' }, el('div', { class: 'row' }, field('Pitch of the gratings', this.pitch, 'mm'), this.measure,
        button('Save the table as CSV', () => this.saveTable()))), this.place);
    this.stop = on('entries', () => void this.load());
    void this.load();
  }

  leave(): void {
    this.stop();
  }

  private get newClips(): Entry[] {
    return entries.filter(({ kind, state }) => (kind === 'clip' || kind === 'images') && state === 'new');
  }

  private async load(): Promise<void> {
    await attempt(async () => {
      const { rows } = await get<{ rows: BatchRow[] }>('/api/batch');
      this.lines = rows.flatMap((row) => (row.targets.length > 0 ? row.targets.map((target): Line => ({ row, target })) : [{ row, target: undefined }]));
      this.draw();
    });
  }

  private draw(): void {
    const count = this.newClips.length;
    this.measure.textContent = count === 1 ? 'Measure 1 new clip' : `Measure ${count} new clips`;
    this.measure.disabled = count === 0;
    const { value } = kColumns[this.sortBy]!;
    const order = [...this.lines].sort((a, b) => {
      const [x, y] = [value(a), value(b)];
      const sign = typeof x === 'number' && typeof y === 'number' ? x - y : String(x).localeCompare(String(y), undefined, { numeric: true });
      return this.isDown ? -sign : sign;
    });
    const head = el('tr', {}, ...kColumns.map(({ title, isNumber }, k) => {
      const cell = el('th', { scope: 'col', 'aria-sort': k !== this.sortBy ? 'none' : this.isDown ? 'descending' : 'ascending', ...(isNumber && { class: 'number' }) });
      cell.append(button(title, () => {
        this.isDown = k === this.sortBy ? !this.isDown : isNumber === true;
        this.sortBy = k;
        this.draw();
      }, { class: 'sort' }));
      return cell;
    }));
    const body = order.slice(0, this.shown).map((line) => el('tr', {}, ...kColumns.map(({ text, isNumber }, k) => {
      if (k > 0) return el('td', isNumber ? { class: 'number' } : {}, text(line));
      return el('th', { scope: 'row' }, button(text(line), () => this.onRun(line.row.run), { class: 'link' }));
    })));
    this.place.replaceChildren(this.lines.length > 0
      ? el('div', { class: 'wide', tabindex: '0', role: 'region', 'aria-label': 'Table of all runs' }, el('table', {}, el('thead', {}, head), el('tbody', {}, ...body)))
      : el('p', { class: 'empty-note' }, 'No run yet. Measure a clip first.'));
    if (order.length > this.shown)
      this.place.append(button(`Show more (${order.length - this.shown})`, () => {
        this.shown += kPage;
        this.draw();
      }));
  }

  private saveTable(): void {
    const cell = (text: string): string => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const lines = [kColumns.map(({ title }) => cell(title)).join(','), ...this.lines.map((line) => kColumns.map(({ text }) => cell(text(line))).join(','))];
    saveText('runs.csv', `${lines.join('\n')}\n`);
  }

  private async measureNew(): Promise<void> {
    const pitch = Number(this.pitch.value.replace(',', '.'));
    if (!(pitch > 0)) {
      say('The pitch is a length in mm, such as 10.', 'bad');
      return;
    }
    const clips = this.newClips;
    await attempt(async () => {
      for (const { path, site } of clips) {
        const how = site ? ['--site', site] : ['--pitch', `${pitch}mm`];
        await startJob('measure', [path, ...how, ...(path.includes('/') ? ['-o', runOf(path)] : [])]);
      }
      say(`${clips.length} clips are queued. Closing this page does not stop them.`);
    });
  }
}
