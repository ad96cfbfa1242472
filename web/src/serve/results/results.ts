// Results of a run: table of targets, plots, the frame of a clicked sample, channels, comparison, files, solving again.
import { get, picture, query, type Entry, type Inspection } from '../api';
import { attempt, button, card, commandBox } from '../parts/parts';
import { entries } from '../store';
import { FramePicture, type ShownMarker } from '../setup/picture';
import { layersCard, sensorCard } from './channels';
import { filesCard, solveCard } from './files';
import { loadRun, rangeOf, type RunData, type TargetData } from './run_data';
import { statuses } from './statuses';
import { displacement, valueText } from '../../displacement';
import { nameFilesAfter } from '../../download';
import { el, stacked, table, type Cell } from '../../element';
import { brief, digitsFor, expanded, plain, sentence } from '../../format';
import { forget, plots, strips } from '../../registry';
import { Strip } from '../../strip';

const kWords: Record<number, string> = { 0: 'Measured', 4: 'No reliable result', 5: 'Measured, with gaps or damage' };

export class ResultsView {
  readonly element = el('div', { class: 'results' });
  private readonly frame = new FramePicture('Frame of the sample');
  private readonly sample = el('div', { class: 'sample', 'aria-live': 'polite' });
  private readonly extra = { derived: el('div', {}), comparison: el('div', {}) };
  private abort = new AbortController();
  private hasLeft = false;

  constructor(private readonly entry: Entry, private readonly run: string) {
    void this.load();
  }

  leave(): void {
    this.hasLeft = true;
    this.abort.abort();
    forget([...plots]);
    strips.length = 0;
  }

  remake(): void {
    plots.forEach((plot) => plot.remake());
    strips.forEach((strip) => strip.draw());
  }

  private async load(): Promise<void> {
    this.element.replaceChildren(el('p', { class: 'empty-note', role: 'status' }, 'The results are read.'));
    await attempt(async () => {
      const data = await loadRun(this.run);
      if (this.hasLeft) return;
      this.show(data);
    });
  }

  private show(data: RunData): void {
    forget([...plots]);
    strips.length = 0;
    nameFilesAfter(this.run.split('/').pop()!);
    const { summary, abscissa } = data;
    const command = commandBox(summary.command ?? '');
    const left = el('div', { class: 'work' }, this.headline(data), this.warnings(summary.warnings));
    if (abscissa && data.targets.length > 0) {
      left.append(displacement(data.report, data.columns, abscissa), this.strips(data), this.extra.derived, this.extra.comparison);
      left.addEventListener('pick', (event) => void this.pick(data, (event as CustomEvent<number>).detail));
    }
    const refused = summary.exit_code === 4;
    const tables = entries.filter(({ kind }) => kind === 'table').map(({ path }) => path);
    const show = (id: 'derived' | 'comparison', section: HTMLElement): void => {
      this.extra[id].replaceChildren(section);
      section.scrollIntoView({ behavior: 'smooth', block: 'start' });
    };
    const solve = solveCard(data, this.entry, (path) => {
      if (path === this.run) void this.load();
      else document.dispatchEvent(new CustomEvent('show-entry', { detail: path }));
    });
    this.element.replaceChildren(left, el('aside', { class: 'panel', 'aria-label': 'Work with the results' }, filesCard(data),
      !refused && card('Frame', this.sample, this.frame.element), !refused && layersCard(data, show), !refused && sensorCard(data, tables, show), solve, command.element));
    this.sample.replaceChildren(el('p', { class: 'quiet' }, 'Click a sample in a plot to see its frame.'));
    this.frame.element.hidden = true;
    plots[0]?.update();
    document.documentElement.dataset.plotMs = performance.now().toFixed(0);
    document.documentElement.dataset.results = this.run;
    strips.forEach((strip) => strip.draw());
  }

  private headline(data: RunData): HTMLElement {
    const { summary } = data;
    const cell = (text: string): Cell => ({ text, isNumber: true });
    const moved = (target: TargetData): number => Math.max(...(['dx', 'dy'] as const).map((axis) => {
      const range = rangeOf(target, axis);
      return range ? range[1] - range[0] : 0;
    }));
    const rows = [...data.targets].sort((a, b) => moved(b) - moved(a)).map((target): (string | Cell)[] => {
      const part = (axis: 'dx' | 'dy', u: number | null): Cell[] => {
        const range = rangeOf(target, axis);
        if (!range || u === null) return [cell('\u2013'), cell('\u2013')];
        const digits = digitsFor(expanded(u));
        return [cell(plain(range[1] - range[0], digits)), cell(plain(expanded(u), digits))];
      };
      const peaks = summary.targets.find(({ name }) => name === target.name)?.peaks;
      const peak = [...(peaks?.x ?? []), ...(peaks?.y ?? [])].sort((a, b) => b.amplitude_mm - a.amplitude_mm)[0];
      return [target.name, ...part('dx', target.u_dx_mm), ...part('dy', target.u_dy_mm), cell(peak ? `${brief(peak.frequency_hz)}` : '\u2013'), cell(`${target.ok} of ${target.frames}`)];
    });
    const { scale } = summary;
    const length = scale?.to != null && scale.distance_mm !== null ? `${scale.from} to ${scale.to}: ${plain(scale.distance_mm, 1)} mm.` : '';
    const references = summary.references_verified ? 'No reference moved.' : 'References were not checked against each other: this needs six.';
    return el('section', { class: 'card headline' }, el('h3', {}, kWords[summary.exit_code] ?? 'Stopped'),
      rows.length > 0 && stacked(table('Movement in mm since the reference frame; dx to the right, dy up; U with k = 2',
        ['Target', 'dx, peak to peak', 'U', 'dy, peak to peak', 'U', 'Vibration (Hz)', 'Rows ok'], rows)),
      el('p', { class: 'quiet' }, [length, references, `Method ${summary.method}.`].filter((text) => text !== '').join(' ')));
  }

  private warnings(all: string[]): HTMLElement | undefined {
    const warnings = all.filter((text) => !text.startsWith('note: '));
    const notes = all.filter((text) => text.startsWith('note: '));
    if (all.length === 0) return undefined;
    const list = (texts: string[]): HTMLElement => el('ul', {}, ...texts.map((text) => el('li', {}, sentence(text))));
    const box = el('div', {});
    if (warnings.length > 0) box.append(el('section', { class: 'card warnings', 'aria-label': 'Warnings' }, el('h3', {}, warnings.length === 1 ? 'Warning' : 'Warnings'), list(warnings)));
    if (notes.length > 0) box.append(el('details', { class: 'card' }, el('summary', {}, notes.length === 1 ? '1 note' : `${notes.length} notes`), list(notes)));
    return box;
  }

  private strips(data: RunData): HTMLElement {
    const words = statuses.map(({ word }) => word);
    const used = new Set<number>();
    const made = data.targets.map((target) => {
      const counts = data.summary.targets.find(({ name }) => name === target.name)?.status_counts ?? {};
      Object.keys(counts).forEach((word) => used.add(words.indexOf(word)));
      return new Strip(target.name, data.abscissa!.x, target.columns.status!, data.abscissa!.zoom, words, data.abscissa!.at,
        Object.entries(counts).map(([word, count]) => `${count} ${word}`).join(', '));
    });
    strips.push(...made);
    const key = el('ul', { class: 'keys' }, ...[...used].filter((k) => k >= 0).sort((a, b) => a - b).map((k) =>
      el('li', { class: 'patch', style: `--colour: var(--status-${k})` }, `${words[k]} (${statuses[k]!.meaning})`)));
    return el('section', { 'aria-label': 'Status of every frame' }, el('h2', {}, 'Status of every frame'), ...made.map(({ element }) => element), key);
  }

  // The frame of a sample with its markers, and the values of all targets in it.
  private async pick(data: RunData, index: number): Promise<void> {
    this.abort.abort();
    this.abort = new AbortController();
    const { signal } = this.abort;
    const frame = data.targets[0]!.columns.frame![index]!;
    const values = data.targets.map(({ name, columns }) => {
      const text = (axis: 'dx' | 'dy'): string => valueText(columns[axis]![index]!, columns[`u_${axis}`]![index]!, 'mm');
      const status = statuses[columns.status![index]!];
      return el('li', {}, el('strong', {}, name), ` dx ${text('dx')}, dy ${text('dy')}: ${status?.word ?? ''}${status && status.word !== 'ok' ? ` (${status.meaning})` : ''}`);
    });
    const step = (by: number, label: string): HTMLElement => button(label, () => void this.pick(data, index + by), { class: 'small', 'aria-label': by < 0 ? 'Previous sample' : 'Next sample' });
    const last = data.targets[0]!.columns.frame!.length - 1;
    this.sample.replaceChildren(el('div', { class: 'row' }, el('strong', {}, data.abscissa!.at(index)), index > 0 && step(-1, '\u2039'), index < last && step(1, '\u203a')), el('ul', { class: 'values' }, ...values));
    this.frame.element.hidden = false;
    await attempt(async () => {
      const shown = await picture(query('/api/run-frame', { run: this.run, frame, max_width: this.frame.wantedWidth }), signal);
      await this.frame.show(shown.blob, shown.width, shown.height);
      this.frame.mark([], []);
      document.documentElement.dataset.sampleFrame = String(frame);
      const found = await get<Pick<Inspection, 'markers'>>(query('/api/run-markers', { run: this.run, frame }), { signal }).catch(() => undefined);
      if (found) this.frame.mark(found.markers.map((marker): ShownMarker => ({ marker, name: marker.name, role: marker.role })), [], data.summary.scale?.mm_per_px ?? undefined);
      document.documentElement.dataset.sampleMarkers = String(found?.markers.length ?? 0);
    });
  }
}
