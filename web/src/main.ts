// The page: words first, then plots, then tables.
import 'uplot/dist/uPlot.min.css';
import './page.css';
import { columns as unpack, overlay, report as readReport, run as readRun, type Report, type Run, type Target } from './data';
import { Curve } from './decimate';
import { el, section } from './element';
import { brief, digitsFor, duration, expanded, plain, signed } from './format';
import { Plot, type Line } from './plot';
import { budget, counts, origin, picture } from './sections';
import { spectraOf } from './spectra';
import { Strip } from './strip';
import { kColour, setPrinting } from './theme';
import { Zoom } from './zoom';

interface Abscissa {
  x: Float64Array;
  label: string;
  zoom: Zoom;
  at: (index: number) => string;
}

const plots: Plot[] = [];
const strips: Strip[] = [];

function badge(of: Report): HTMLElement {
  const kind = of.exit_code === 0 ? 'good' : of.exit_code === 4 ? 'bad' : 'fair';
  return el('span', { class: `badge ${kind}` }, of.outcome);
}

function header(of: Report, run: Run, abscissa: Abscissa | undefined): HTMLElement {
  const facts = [`${run.input.frames} frames`, `${run.input.width} \u00d7 ${run.input.height} px`, `method ${of.method.name}`];
  if (abscissa && of.time !== null) facts.splice(1, 0, duration(abscissa.x[abscissa.x.length - 1]! - abscissa.x[0]!));
  return el('header', {}, el('p', { class: 'brand' }, 'moiregauge report'), el('h1', {}, of.input),
    el('p', { class: 'facts' }, badge(of), ...facts.map((fact) => el('span', {}, fact))));
}

function words(of: Report): HTMLElement {
  const isRefused = of.exit_code === 4;
  const summary = section('summary', isRefused ? 'Why there is no result' : 'Result', el('ul', { class: 'summary' }, ...of.summary.map((text) => el('li', {}, text.replaceAll('\u00b1 ', '\u00b1\u00a0')))));
  if (of.advice.length > 0) summary.append(el('h3', {}, 'What to do'), el('ul', { class: 'advice' }, ...of.advice.map((text) => el('li', {}, text))));
  return summary;
}

// A note is a property of the input. Only a warning affects numbers.
const isNote = (warning: string): boolean => warning.startsWith('note: ');

function remarks(id: string, title: string, texts: string[]): HTMLElement | undefined {
  if (texts.length === 0) return undefined;
  const sentence = (text: string): string => {
    const bare = text.replace(/^note: /, '');
    return bare.charAt(0).toUpperCase() + bare.slice(1) + (bare.endsWith('.') ? '' : '.');
  };
  return el('section', { id, class: id, 'aria-labelledby': `${id}-title` },
    el('h2', { id: `${id}-title` }, texts.length === 1 ? title : `${title}s (${texts.length})`),
    el('ul', {}, ...texts.map((text) => el('li', {}, sentence(text)))));
}

// The values of rows that are ok, or of the others; the rest are gaps.
function valuesOf(values: Float64Array, status: Float64Array, ok: boolean): Float64Array {
  return values.map((value, k) => ((status[k] === 0) === ok ? value : NaN));
}

function rangeOf(target: Target, columns: Float64Array[], d: number): [number, number] {
  const curve = new Curve(valuesOf(columns[d]!, columns[target.rows.status]!, true));
  return curve.extremes(0, curve.values.length);
}

// Peak to peak of the axis that moved more.
function movementOf(target: Target, columns: Float64Array[]): number {
  return Math.max(...[target.rows.dx, target.rows.dy].map((d) => {
    const [low, high] = rangeOf(target, columns, d);
    return low > high ? 0 : high - low;
  }));
}

// The extremes of the ok rows, and U.
function card(target: Target, columns: Float64Array[], run: Run): HTMLElement {
  const summary = run.targets.find(({ name }) => name === target.name);
  const line = (name: string, d: number, u: number | null | undefined): HTMLElement => {
    const [low, high] = rangeOf(target, columns, d);
    if (low > high || u == null) return el('p', {}, el('span', { class: 'axis' }, name), el('span', { class: 'size' }, 'not measured'));
    const digits = digitsFor(expanded(u));
    return el('p', {}, el('span', { class: 'axis' }, name),
      el('span', { class: 'size' }, `${plain(high - low, digits)} mm peak to peak`),
      el('span', { class: 'u' }, `U = ${plain(expanded(u), digits)} mm`),
      el('span', { class: 'range' }, `from ${signed(low, digits)} to ${signed(high, digits)} mm`));
  };
  return el('div', { class: 'card' }, el('h3', {}, target.name),
    line('dx, right', target.rows.dx, summary?.u_dx_mm), line('dy, up', target.rows.dy, summary?.u_dy_mm));
}

function toolbar(abscissa: Abscissa): HTMLElement {
  const { zoom, label } = abscissa;
  const shown = el('output', { class: 'shown', 'aria-live': 'polite' });
  const say = (): void => {
    shown.textContent = zoom.isWhole ? 'the whole record is shown' : `${brief(zoom.min)} to ${brief(zoom.max)} ${label.startsWith('Time') ? 's' : ''}`;
  };
  zoom.watch(say);
  say();
  const button = (text: string, name: string, act: () => void): HTMLElement => {
    const b = el('button', { type: 'button', 'aria-label': name, title: name }, text);
    b.addEventListener('click', act);
    return b;
  };
  return el('div', { class: 'toolbar', role: 'toolbar', 'aria-label': 'Range of the plots' },
    button('\u2190', 'Earlier', () => zoom.pan(-0.5)), button('\u2192', 'Later', () => zoom.pan(0.5)),
    button('+', 'Zoom in', () => zoom.by(0.5)), button('\u2212', 'Zoom out', () => zoom.by(2)),
    button('All', 'Show all', () => zoom.all()), shown,
    el('span', { class: 'hint' }, 'Drag to zoom, Shift + drag to move, double-click to show all. After a click: wheel, keys + \u2212 \u2190 \u2192 0'));
}

function displacement(of: Report, columns: Float64Array[], abscissa: Abscissa): HTMLElement {
  const parts = of.targets.map((target) => {
    const status = columns[target.rows.status]!;
    const axis = (name: string, d: number, u: number, colour: number): Plot => {
      const value = columns[d]!;
      const spread = columns[u]!;
      const ok = valuesOf(value, status, true);
      const low = new Float64Array(value.length);
      const high = new Float64Array(value.length);
      let lowest = Infinity;
      let highest = -Infinity;
      value.forEach((v, k) => {
        low[k] = ok[k]! - expanded(spread[k]!);
        high[k] = ok[k]! + expanded(spread[k]!);
        if (v < lowest) lowest = v;
        if (v > highest) highest = v;
      });
      return new Plot({
        title: name, abscissa: abscissa.label, ordinate: 'mm', x: abscissa.x, zoom: abscissa.zoom,
        lines: [{ label: 'displacement', colour, curve: new Curve(ok), band: { low: new Curve(low), high: new Curve(high) }, notOk: new Curve(valuesOf(value, status, false)) }],
        readout: (k) => {
          const found = of.statuses[status[k]!];
          const word = !found ? '' : status[k] === 0 ? found.word : `${found.word} (${found.meaning})`;
          if (Number.isNaN(value[k])) return `${abscissa.at(k)}: not measured, ${word}`;
          const digits = digitsFor(expanded(spread[k]!));
          return `${abscissa.at(k)}: ${signed(value[k]!, digits)} \u00b1 ${plain(expanded(spread[k]!), digits)} mm, ${word}`;
        },
        description: lowest > highest ? 'No row was measured.' : `From ${brief(lowest)} to ${brief(highest)} mm over ${value.length} frames. Every number is in displacement.csv.`,
      });
    };
    const two = [axis('dx, right is positive', target.rows.dx, target.rows.ux, kColour.x), axis('dy, up is positive', target.rows.dy, target.rows.uy, kColour.y)];
    plots.push(...two);
    return el('div', { class: 'target' }, el('h3', {}, target.name), ...two.map(({ element }) => element));
  });
  const refused = of.exit_code === 4 && el('p', { class: 'note' }, 'For information only, because no row of this run is reliable.');
  return section('displacement', 'Displacement', refused, toolbar(abscissa), ...parts);
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
    title, abscissa: abscissa.label, ordinate, x: abscissa.x, zoom: abscissa.zoom, lines, height: 180,
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
  const line = (label: string, column: number, dash?: number[]): Line => ({ label, colour: kColour.camera, curve: new Curve(columns[column]!), dash });
  const shift = curves('Image motion', 'px', abscissa, [line('right', c.right), line('down', c.down, [6, 3])], ' px', 2);
  const turn = c.pan === null || c.tilt === null || c.roll === null ? undefined
    : curves('Camera rotation', 'degrees', abscissa,
      [line('pan, to the right', c.pan), line('tilt, upwards', c.tilt, [6, 3]), line('roll, clockwise', c.roll, [2, 2])], '\u00b0', 4);
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
    [{ label: '\u03c7\u00b2', colour: kColour.other, curve: new Curve(columns[q.chi2]!) }], '', 3).element);
  return section('quality', 'Data quality', ...strips.map(({ element }) => element), key, counts(run, of), ...parts);
}

// Time where there is one and it goes forward, else the frame's number.
function abscissaOf(of: Report, columns: Float64Array[]): Abscissa | undefined {
  if (of.frame === null) return undefined;
  const frame = columns[of.frame]!;
  const time = of.time === null ? undefined : columns[of.time]!;
  const x = time ?? frame;
  if (x.length === 0) return undefined;
  const first = x[0]!;
  const last = x[x.length - 1]!;
  const step = x.length > 1 ? (last - first) / (x.length - 1) : 1;
  const zoom = x.length > 1 ? new Zoom(first, last, 4 * step) : new Zoom(first - 0.5, last + 0.5, 1);
  const digits = Math.max(2, Math.min(4, Math.ceil(-Math.log10(step || 1)) + 1));
  return { x, zoom, label: time ? 'Time (s)' : 'Frame', at: (k) => (time ? `${plain(time[k]!, digits)} s (frame ${frame[k]})` : `frame ${frame[k]}`) };
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
  const abscissa = abscissaOf(of, columns);
  const page = document.getElementById('page')!;
  const add = (...parts: (HTMLElement | undefined)[]): void => parts.forEach((part) => part && page.append(part));
  page.replaceChildren();
  of.targets.sort((a, b) => movementOf(b, columns) - movementOf(a, columns)); // the largest movement first, as in the words
  add(header(of, run, abscissa), remarks('warnings', 'Warning', of.warnings.filter((text) => !isNote(text))), words(of));
  const shown = picture(of, run, overlay());
  if (abscissa && of.targets.length > 0) {
    const isRefused = of.exit_code === 4;
    if (!isRefused) add(el('div', { class: 'cards' }, ...of.targets.map((target) => card(target, columns, run))));
    if (isRefused) add(shown);
    add(displacement(of, columns, abscissa));
    if (!isRefused) add(spectra(of, columns));
    add(camera(of, columns, abscissa), quality(of, run, columns, abscissa));
    if (run.targets.some(({ u_dx_mm, u_dy_mm }) => u_dx_mm !== null || u_dy_mm !== null)) add(budget(run));
    if (!isRefused) add(shown);
  } else {
    add(shown);
  }
  add(remarks('notes', 'Note', of.warnings.filter(isNote)), origin(of, run));
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
