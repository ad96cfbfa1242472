// The page: words first, then plots, then tables.
import 'uplot/dist/uPlot.min.css';
import './page.css';
import { abscissaOf, type Abscissa } from './abscissa';
import { comparisonSection } from './comparison';
import { columns as unpack, comparison as readComparison, derived as readDerived, overlay, report as readReport, run as readRun, unpacked, type Report, type Run, type Target } from './data';
import { Curve } from './decimate';
import { derivedSection } from './derived';
import { displacement } from './displacement';
import { nameFilesAfter } from './download';
import { el, section, table, type Cell } from './element';
import { firstPage, type FirstPage } from './first_page';
import { brief, digitsFor, duration, expanded, plain, sentence, signed } from './format';
import { Plot, type Line } from './plot';
import { plots, strips } from './registry';
import { budget, counts, origin, picture } from './sections';
import { spectraOf } from './spectra';
import { Strip } from './strip';
import { kColour, setPrinting } from './theme';
import { Zoom } from './zoom';

function badge(of: Report): HTMLElement {
  const kind = of.exit_code === 0 ? 'good' : of.exit_code === 4 ? 'bad' : 'fair';
  return el('span', { class: `badge ${kind}` }, of.outcome);
}

// A selection of frames (--frames) has fewer rows than the recording has frames.
function framesOf(run: Run): string {
  const measured = run.targets[0]?.frames ?? run.input.frames;
  return measured === run.input.frames ? `${measured} frames` : `${measured} of ${run.input.frames} frames`;
}

function header(of: Report, run: Run, abscissa: Abscissa | undefined): HTMLElement {
  const facts = [framesOf(run), `${run.input.width} \u00d7 ${run.input.height} px`, `method ${of.method.name}`];
  if (abscissa && of.time !== null) facts.splice(1, 0, duration(abscissa.x[abscissa.x.length - 1]! - abscissa.x[0]!));
  return el('header', {}, el('p', { class: 'brand' }, 'moiregauge report'), el('h1', {}, of.input),
    el('p', { class: 'facts' }, badge(of), ...facts.map((fact) => el('span', {}, fact))));
}

function words(of: Report, onFirst: number): HTMLElement {
  const isRefused = of.exit_code === 4;
  const items = of.summary.map((text) => el('li', {}, text.replaceAll('\u00b1 ', '\u00b1\u00a0')));
  const summary = section('summary', isRefused ? 'Why there is no result' : 'Result', el('ul', { class: 'summary' }, ...items), ...later(items, onFirst, 'sentence'));
  if (of.advice.length > 0) summary.append(el('h3', {}, 'What to do'), el('ul', { class: 'advice' }, ...of.advice.map((text) => el('li', {}, text))));
  return summary;
}

// Hides items that the first page has no room for on paper, and says so.
function later(items: HTMLElement[], onFirst: number, what: string): HTMLElement[] {
  const rest = items.slice(onFirst);
  rest.forEach((item) => item.classList.add('not-on-paper'));
  return rest.length > 0 ? [el('p', { class: 'only-on-paper small' }, `${rest.length} more ${what}${rest.length > 1 ? 's' : ''}: last page.`)] : [];
}

// A note is a property of the input. Only a warning affects numbers.
const isNote = (warning: string): boolean => warning.startsWith('note: ');

function remarks(id: string, title: string, texts: string[], onFirst = Infinity): HTMLElement | undefined {
  if (texts.length === 0) return undefined;
  const items = texts.map((text) => el('li', {}, sentence(text)));
  return el('section', { id, class: id, 'aria-labelledby': `${id}-title` },
    el('h2', { id: `${id}-title` }, texts.length === 1 ? title : `${title}s (${texts.length})`), el('ul', {}, ...items), ...later(items, onFirst, 'warning'));
}

// Peak to peak of the axis that moved more.
function movementOf({ lowest, highest }: Target): number {
  return Math.max(...(['dx', 'dy'] as const).map((axis) => (highest[axis] ?? 0) - (lowest[axis] ?? 0)));
}

// The extremes of the ok rows, and U: two rows per target.
function ranges(of: Report, run: Run, onFirst: number): HTMLElement {
  const rows = of.targets.flatMap((target) => {
    const summary = run.targets.find(({ name }) => name === target.name);
    const row = (axis: 'dx' | 'dy', u: number | null | undefined): (string | Cell)[] => {
      const { name } = target, low = target.lowest[axis], high = target.highest[axis];
      if (low == null || high == null || u == null) return [name, axis, 'not measured', '', '', ''];
      const digits = digitsFor(expanded(u));
      return [name, axis, { text: plain(high - low, digits), isNumber: true }, { text: signed(low, digits), isNumber: true },
        { text: signed(high, digits), isNumber: true }, { text: plain(expanded(u), digits), isNumber: true }];
    };
    return [row('dx', summary?.u_dx_mm), row('dy', summary?.u_dy_mm)];
  });
  const block = table('Movement in mm since the reference frame; dx to the right, dy up; U with k = 2', ['Target', 'Axis', 'Peak to peak', 'From', 'To', 'U'], rows);
  block.classList.add('ranges');
  const lines = [...block.querySelectorAll<HTMLElement>('tbody tr')];
  const rest = lines.slice(2 * onFirst);
  rest.forEach((line) => line.classList.add('not-on-paper'));
  return section('ranges', 'Range of each target', block,
    rest.length > 0 && el('p', { class: 'only-on-paper small' }, `${rest.length / 2} more target${rest.length > 2 ? 's' : ''}: last page.`));
}

// On the last page: what the first had no room for.
function leftover(of: Report, warnings: string[], share: FirstPage, shown: HTMLElement | undefined): HTMLElement | undefined {
  const texts = [...warnings.slice(share.warnings).map(sentence), ...of.summary.slice(share.sentences)];
  const rows = [...(shown?.querySelectorAll('tr.not-on-paper') ?? [])].map((row) => row.cloneNode(true) as HTMLElement);
  if (texts.length === 0 && rows.length === 0) return undefined;
  rows.forEach((row) => row.classList.remove('not-on-paper'));
  const head = shown?.querySelector('thead')?.cloneNode(true);
  return el('section', { class: 'only-on-paper', 'aria-hidden': 'true' }, el('h2', {}, 'From the first page'), el('ul', {}, ...texts.map((text) => el('li', {}, text))),
    rows.length > 0 && el('table', {}, head, el('tbody', {}, ...rows)));
}

function spectra(of: Report, columns: Float64Array[]): HTMLElement {
  const ends = of.targets.flatMap(({ spectrum }) => [spectrum.x, spectrum.y]).filter(({ refusal }) => !refusal)
    .map(({ step_hz, log10_psd }) => step_hz * (columns[log10_psd]!.length - 1));
  const steps = of.targets.flatMap(({ spectrum }) => [spectrum.x, spectrum.y]).filter(({ refusal }) => !refusal).map(({ step_hz }) => step_hz);
  const zoom = ends.length > 0 ? new Zoom(0, Math.max(...ends), 4 * Math.min(...steps)) : undefined;
  const parts = of.targets.map((target) => spectraOf(target, columns, zoom));
  parts.forEach((part) => plots.push(...part.plots));
  return section('spectra', 'Vibration', ...parts.map(({ element }) => element),
    el('p', { class: 'small' }, 'Vibration above half the frame rate appears at a lower frequency (aliasing). ' +
      'Frequencies use the time stamps of the recording, and their U is at least 10\u207b\u2075 of them, the limit of camera clocks. ' +
      'Free decay and steady vibration are fitted in time, random vibration by the shape of its peak.'));
}

function curves(title: string, ordinate: string, abscissa: Abscissa, lines: Line[], unit: string, digits: number): Plot {
  const plot = new Plot({
    title, name: title.split(/[,(]/)[0]!.toLowerCase().trim(), abscissa: abscissa.label, ordinate, x: abscissa.x, zoom: abscissa.zoom, lines, height: 180, csvBefore: abscissa.csv,
    readout: (k) => `${abscissa.at(k)}: ${lines.map(({ label, curve }) => `${label} ${Number.isNaN(curve.values[k]!) ? '\u2013' : plain(curve.values[k]!, digits) + unit}`).join(', ')}`,
    description: lines.map(({ label, curve }) => {
      const [low, high] = curve.extremes(0, curve.values.length);
      return low > high ? `${label}: nothing` : `${label}: ${brief(low)} to ${brief(high)}${unit}`;
    }).join('; '),
  });
  plots.push(plot);
  return plot;
}

function camera(of: Report, columns: Float64Array[], abscissa: Abscissa): HTMLElement {
  const c = of.camera!;
  const line = (label: string, name: string, column: number, dash?: number[]): Line =>
    ({ label, colour: kColour.camera, curve: new Curve(columns[column]!), dash, csv: [{ name, values: columns[column]! }] });
  const shift = curves('Image motion', 'px', abscissa, [line('right', 'right_px', c.right), line('down', 'down_px', c.down, [6, 3])], ' px', 2);
  const turn = c.pan === null || c.tilt === null || c.roll === null ? undefined
    : curves('Camera rotation', 'degrees', abscissa,
      [line('pan, to the right', 'pan_deg', c.pan), line('tilt, upwards', 'tilt_deg', c.tilt, [6, 3]), line('roll, clockwise', 'roll_deg', c.roll, [2, 2])], '\u00b0', 4);
  const isStill = of.method.name === 'conventional';
  if (isStill) return section('camera', 'Camera motion', el('p', {}, 'This method assumes a fixed camera.'));
  return section('camera', 'Camera motion',
    el('p', {}, 'Since the reference frame, as seen by the references. It is removed from every displacement above. For information only, without uncertainty.' +
      (turn ? '' : ' Rotation needs a known focal length.')),
    shift.element, turn?.element);
}

function quality(of: Report, run: Run, columns: Float64Array[], abscissa: Abscissa): HTMLElement {
  const statusWords = of.statuses.map(({ word }) => word);
  const used = new Set<number>();
  for (const target of of.targets) {
    const summary = run.targets.find(({ name }) => name === target.name);
    Object.keys(summary?.status_counts ?? {}).forEach((word) => used.add(statusWords.indexOf(word)));
    const strip = new Strip(target.name, abscissa.x, columns[target.rows.status]!, abscissa.zoom, statusWords, abscissa.at,
      Object.entries(summary?.status_counts ?? {}).map(([word, count]) => `${count} ${word}`).join(', '));
    strips.push(strip);
  }
  const key = el('ul', { class: 'keys' }, ...[...used].sort((a, b) => a - b).map((k) =>
    el('li', { class: 'patch', style: `--colour: var(--status-${k})` }, `${statusWords[k]} (${of.statuses[k]?.meaning})`)));
  const q = of.quality!;
  const parts: HTMLElement[] = [];
  for (const role of ['target', 'reference'] as const) {
    const lines = q.modulation.filter((m) => m.role === role).map((m, k): Line => ({
      label: m.name, colour: kColour[role], dash: [[], [6, 3], [2, 2], [8, 3, 2, 3], [12, 3], [12, 3, 2, 3, 2, 3]][k % 6]!.slice(), curve: new Curve(columns[m.relative]!),
    })).map((l) => (l.dash!.length > 0 ? l : { ...l, dash: undefined }));
    if (lines.length > 0) parts.push(curves(`Contrast of the gratings relative to the reference frame, ${role}s`, 'ratio', abscissa, lines, '', 3).element);
  }
  if (q.chi2 !== null) parts.push(curves('Fit of each frame to the scene, \u03c7\u00b2 per degree of freedom (1: noise only)', '\u03c7\u00b2', abscissa,
    [{ label: '\u03c7\u00b2', colour: kColour.other, curve: new Curve(columns[q.chi2]!), csv: [{ name: 'chi2_dof', values: columns[q.chi2]! }] }], '', 3).element);
  return section('quality', 'Data quality', ...strips.map(({ element }) => element), key, counts(run, of), ...parts);
}

function print(on: boolean): void {
  setPrinting(on);
  plots.forEach((plot) => plot.remake());
  strips.forEach((strip) => strip.draw());
}

async function show(): Promise<void> {
  const of = readReport();
  const run = readRun();
  const columns = await unpack(of);
  const channels = readDerived();
  const compared = readComparison();
  const ofChannels = channels && (await unpacked(channels.samples, channels.columns));
  const ofComparison = compared && (await unpacked(compared.samples, compared.columns));
  nameFilesAfter(of.input);
  const abscissa = abscissaOf(of, columns);
  const page = document.getElementById('page')!;
  const add = (...parts: (HTMLElement | undefined)[]): void => parts.forEach((part) => part && page.append(part));
  page.replaceChildren();
  of.targets.sort((a, b) => movementOf(b) - movementOf(a)); // the largest movement first, as in the words
  const warnings = of.warnings.filter((text) => !isNote(text));
  const isRefused = of.exit_code === 4;
  const share = isRefused ? { warnings: Infinity, sentences: Infinity, targets: Infinity } : firstPage(warnings, of.summary, of.targets.length);
  add(header(of, run, abscissa), remarks('warnings', 'Warning', warnings, share.warnings), words(of, share.sentences));
  let shownRanges: HTMLElement | undefined;
  const shown = picture(of, run, overlay());
  if (abscissa && of.targets.length > 0) {
    if (!isRefused) add((shownRanges = ranges(of, run, share.targets)));
    if (isRefused) add(shown);
    add(displacement(of, columns, abscissa));
    if (channels && ofChannels) add(derivedSection(channels, ofChannels, of, abscissa));
    if (compared && ofComparison) add(comparisonSection(compared, ofComparison, abscissa));
    if (!isRefused) add(spectra(of, columns));
    add(camera(of, columns, abscissa), quality(of, run, columns, abscissa));
    if (run.targets.some(({ u_dx_mm, u_dy_mm }) => u_dx_mm !== null || u_dy_mm !== null)) add(budget(run));
    if (!isRefused) add(shown);
  } else {
    add(shown);
  }
  add(remarks('notes', 'Note', of.warnings.filter(isNote)), origin(of, run));
  add(leftover(of, warnings, share, shownRanges));
  page.append(el('footer', {}, `Made by moiregauge ${of.version}. This page is one file, which needs no network and can be stored, sent and printed.`));
  plots[0]?.update();
  performance.mark('first-plot');
  document.documentElement.dataset.firstPlotMs = performance.now().toFixed(0);
  strips.forEach((strip) => strip.draw());
  const redraw = (): void => print(false);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  addEventListener('beforeprint', () => print(true));
  addEventListener('afterprint', () => print(false));
  document.documentElement.dataset.state = 'ready';
}

show().catch((problem: unknown) => {
  document.getElementById('page')!.replaceChildren(el('p', { class: 'note' },
    `This page could not be drawn (${problem instanceof Error ? problem.message : String(problem)}). Use a browser of 2023 or later. ` +
    'The numbers are in displacement.csv, the summary in run.json and the image in overlay.png, next to this file.'));
  document.documentElement.dataset.state = 'failed';
  console.error(problem);
});
