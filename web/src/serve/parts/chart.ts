// Curves that grow while something is measured: dx and dy of all targets with their band, redrawn five times a second.
import type uPlot from 'uplot';
import { SmallPlot, type SmallPlan } from './small_plot';
import { el } from '../../element';
import { expanded } from '../../format';
import { kFirstLine, kLines, theme } from '../../theme';

export type Axis = 'dx' | 'dy';

const kRedraw_ms = 180; // between two drawings. More of them slow the measurement on a computer with two processors
const kMaxPoints = 6000; // in one curve; beyond, every second one is dropped
const kBandsFor = 3; // targets with bands; more hide each other
const kHeight = 190;
const kNotOk = 1; // from this status on, a value is not ok

interface Curve {
  name: string;
  ok: (number | null)[];
  notOk: (number | null)[];
  low: (number | null)[];
  high: (number | null)[];
}

export class GrowingChart {
  readonly element: HTMLElement;
  private readonly keys = el('ul', { class: 'keys' });
  private readonly plot: SmallPlot;
  private x: number[] = [];
  private curves: Curve[] = [];
  private timer?: ReturnType<typeof setTimeout>;
  private drawn_ms = -Infinity;
  private stride = 1; // every stride-th sample is kept
  private seen = 0;

  // `span_s`: only the last part of the record is shown.
  constructor(private readonly axis: Axis, title: string, private readonly hasTime: boolean, private readonly span_s?: number) {
    this.plot = new SmallPlot(title, kHeight, this.keys);
    this.element = this.plot.element;
    this.element.classList.add('growing');
  }

  get samples(): number {
    return this.x.length;
  }

  remove(): void {
    clearTimeout(this.timer);
    this.plot.remove();
  }

  // Draws again in the colours of the theme.
  remake(): void {
    this.plot.clear();
    this.later();
  }

  // One frame: value, u and status index of every target.
  add(x: number, rows: { name: string; value: number | null; u: number | null; status: number }[]): void {
    if (this.seen++ % this.stride !== 0) return;
    for (const { name } of rows) {
      if (this.curves.some((curve) => curve.name === name)) continue;
      const gaps = (): null[] => new Array<null>(this.x.length).fill(null);
      this.curves.push({ name, ok: gaps(), notOk: gaps(), low: gaps(), high: gaps() });
      this.remake();
    }
    this.x.push(x);
    for (const curve of this.curves) {
      const row = rows.find(({ name }) => name === curve.name);
      const value = row?.value ?? null;
      const isOk = value !== null && row!.status < kNotOk;
      const u = row?.u ?? null;
      curve.ok.push(isOk ? value : null);
      curve.notOk.push(value !== null && !isOk ? value : null);
      curve.low.push(value !== null && u !== null ? value - expanded(u) : null);
      curve.high.push(value !== null && u !== null ? value + expanded(u) : null);
    }
    this.trim();
    this.later();
  }

  private trim(): void {
    const drop = (keep: (k: number) => boolean): void => {
      const filter = <Type>(list: Type[]): Type[] => list.filter((_value, k) => keep(k));
      this.x = filter(this.x);
      for (const curve of this.curves) {
        curve.ok = filter(curve.ok);
        curve.notOk = filter(curve.notOk);
        curve.low = filter(curve.low);
        curve.high = filter(curve.high);
      }
    };
    if (this.span_s !== undefined) {
      const from = this.x[this.x.length - 1]! - this.span_s;
      if (this.x[0]! < from - 0.1 * this.span_s) drop((k) => this.x[k]! >= from);
    }
    if (this.x.length <= kMaxPoints) return;
    if (this.span_s !== undefined) {
      drop((k) => k >= this.x.length - kMaxPoints);
    } else {
      drop((k) => k % 2 === 0);
      this.stride *= 2;
    }
  }

  private later(): void {
    if (this.timer !== undefined) return;
    this.timer = setTimeout(() => {
      this.timer = undefined;
      this.drawn_ms = performance.now();
      this.draw();
    }, Math.max(0, this.drawn_ms + kRedraw_ms - performance.now()));
  }

  private data(): uPlot.AlignedData {
    const columns: (number | null)[][] = [];
    const hasBands = this.curves.length <= kBandsFor;
    for (const { ok, notOk, low, high } of this.curves) columns.push(ok, ...(hasBands ? [low, high] : []), notOk);
    return [this.x, ...columns] as uPlot.AlignedData;
  }

  private draw(): void {
    if (this.curves.length > 0 && this.plot.draw(this.data(), () => this.plan())) this.element.dataset.samples = String(this.x.length);
  }

  // One target has the colour of its axis, several have the colours of lines that differ by name.
  private colour(k: number): number {
    return this.curves.length === 1 ? (this.axis === 'dx' ? 0 : 1) : kFirstLine + (k % kLines);
  }

  private plan(): SmallPlan {
    const { series: colours, band, paper } = theme();
    const series: uPlot.Series[] = [];
    const bands: uPlot.Band[] = [];
    const hasBands = this.curves.length <= kBandsFor;
    this.curves.forEach(({ name }, k) => {
      const colour = this.colour(k);
      series.push({ label: name, stroke: colours[colour]!, width: 1.5, spanGaps: false, points: { show: false } });
      if (hasBands) {
        const edge: uPlot.Series = { stroke: 'transparent', width: 0, points: { show: false } };
        series.push(edge, { ...edge });
        bands.push({ series: [series.length, series.length - 1], fill: band[colour]! });
      }
      series.push({ label: `${name}, not ok`, width: 0, paths: () => null, points: { show: true, size: 5, width: 1.25, stroke: colours[5]!, fill: paper } });
    });
    this.keys.replaceChildren(...this.curves.map(({ name }, k) => el('li', { style: `--colour: var(--series-${this.colour(k) + 1})` }, name)),
      ...(hasBands ? [el('li', { class: 'band', style: `--colour: var(--series-${this.curves.length === 1 ? this.colour(0) + 1 : 6})` }, 'U (k = 2)')] : []),
      el('li', { class: 'hollow', style: '--colour: var(--series-6)' }, 'not ok'));
    return { abscissa: this.hasTime ? 'Time (s)' : 'Frame', ordinate: 'mm', series, bands };
  }
}
