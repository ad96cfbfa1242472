// One plot of curves over the abscissa of its group: drawn when it comes into view, redrawn when zoom, theme or width change.
import uPlot from 'uplot';
import { Curve, drawn, firstAtLeast } from './decimate';
import { el } from './element';
import { isPrinting, kColour, theme } from './theme';
import type { Zoom } from './zoom';

export interface Line {
  label: string;
  curve: Curve;
  colour: number; // number in the theme
  dash?: number[];
  band?: { low: Curve; high: Curve };
  notOk?: Curve; // values of rows that are not ok: hollow grey points
}

export interface PlotPlan {
  title: string;
  abscissa: string; // label of x
  ordinate: string;
  x: Float64Array;
  lines: Line[];
  zoom: Zoom;
  height?: number;
  // Describes the sample under the pointer in words.
  readout: (index: number) => string;
  // Draws marks on top of the curves, in canvas pixels.
  onTop?: (plot: uPlot, scale: number) => void;
  // Formats ordinate values: a spectrum's are powers of ten.
  tick?: (value: number) => string;
  hasNoPoints?: boolean;
  description: string; // for screen readers
}

const kPrintWidth = 680; // CSS pixels on paper
const kPrintScale = 3; // and how much finer paper is than a screen
const kWhole = [0, 1, 2, 3, 4, 5, 6, 7, 8].flatMap((decade) => [1, 2, 5].map((n) => n * 10 ** decade));
let plots = 0;

// The dashes of a line as a background, for its key.
function dashes(dash: number[]): string {
  let at = 0;
  const stops = dash.map((length, k) => `${k % 2 ? 'transparent' : 'var(--colour)'} ${at}px ${(at += length)}px`);
  return stops.length > 0 ? `repeating-linear-gradient(90deg, ${stops.join(', ')})` : 'none';
}

// A tenth more to each side; a flat line lies in the middle.
function room(low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) return [-1, 1];
  const more = high > low ? 0.1 * (high - low) : Math.max(1e-3, 0.1 * Math.abs(high));
  return [low - more, high + more];
}

// Samples between two gaps have no line: they get a point.
function lonely(u: uPlot, series: number, show: boolean): number[] | null {
  if (show) return null; // few samples: every one is a point
  const values = u.data[series]!;
  const [from, to] = u.series[0]!.idxs ?? [0, values.length - 1];
  const alone: number[] = [];
  for (let i = from; i <= to; ++i) {
    if (values[i] != null && values[i - 1] == null && values[i + 1] == null) alone.push(i);
  }
  return alone;
}

export class Plot {
  readonly element: HTMLElement;
  private readonly box = el('div', { class: 'canvas' });
  private readonly readout = el('output', { class: 'readout' });
  private chart?: uPlot;
  private isVisible = false;
  private isStale = true;

  constructor(private readonly plan: PlotPlan) {
    const id = `plot-${++plots}`;
    const keys = el('ul', { class: 'keys' });
    for (const { label, colour, dash } of plan.lines) {
      if (plan.lines.length > 1 || plan.lines[0]!.band)
        keys.append(el('li', { class: dash ? 'dashed' : '', style: `--colour: var(--series-${colour + 1}); --line: ${dashes(dash ?? [])}` }, label));
    }
    if (plan.lines.some((line) => line.band)) keys.append(el('li', { class: 'band', style: `--colour: var(--series-${plan.lines[0]!.colour + 1})` }, 'U (k = 2)'));
    if (plan.lines.some(({ notOk }) => notOk && notOk.values.some((v) => !Number.isNaN(v))))
      keys.append(el('li', { class: 'hollow', style: `--colour: var(--series-${kColour.other + 1})` }, 'not ok'));
    const caption = el('figcaption', {}, el('span', { class: 'title', id }, plan.title), keys, this.readout);
    this.box.tabIndex = 0;
    this.box.setAttribute('role', 'img');
    this.box.setAttribute('aria-labelledby', id);
    this.box.setAttribute('aria-description', plan.description);
    this.box.addEventListener('keydown', (event) => {
      if (!event.ctrlKey && !event.altKey && !event.metaKey && plan.zoom.key(event.key)) event.preventDefault();
    });
    this.element = el('figure', { class: 'plot' }, caption, this.box);
    this.box.style.minHeight = `${this.height()}px`;
    plan.zoom.watch(() => this.change());
    this.watchSize();
  }

  private height(): number {
    return isPrinting() ? 0.85 * (this.plan.height ?? 200) : (this.plan.height ?? 200); // on paper three to a page
  }

  private watchSize(): void {
    new IntersectionObserver((entries) => {
      this.isVisible = entries.some((entry) => entry.isIntersecting);
      if (this.isVisible && this.isStale) this.update();
    }, { rootMargin: '200px' }).observe(this.element);
    let width = 0;
    new ResizeObserver(() => {
      if (isPrinting() || !this.chart || this.box.clientWidth === width) return;
      width = this.box.clientWidth;
      this.chart.setSize({ width, height: this.height() });
      this.change();
    }).observe(this.box);
  }

  private change(): void {
    this.isStale = true;
    if (this.isVisible) this.update();
  }

  private data(pixels: number): uPlot.AlignedData {
    const { x, lines, zoom } = this.plan;
    const curves = lines.flatMap(({ curve, band, notOk }) => [curve, ...(band ? [band.low, band.high] : []), ...(notOk ? [notOk] : [])]);
    return drawn(x, curves, zoom.min, zoom.max, Math.max(100, Math.floor(pixels))) as uPlot.AlignedData;
  }

  // Brings it up to date; makes it when there is none yet.
  update(): void {
    const { zoom } = this.plan;
    this.isStale = false;
    if (!this.chart) {
      this.make(this.box.clientWidth || kPrintWidth, 1);
      return;
    }
    const data = this.data(this.chart.bbox.width / uPlot.pxRatio);
    this.chart.batch(() => {
      this.chart!.setData(data, false);
      this.chart!.setScale('x', { min: zoom.min, max: zoom.max });
    });
  }

  // Redraws in the colours of the current theme.
  remake(): void {
    if (!this.chart && !isPrinting()) return;
    this.chart?.destroy();
    this.chart = undefined;
    this.box.replaceChildren();
    if (isPrinting()) {
      this.isStale = true;
      this.make(kPrintScale * kPrintWidth, kPrintScale);
    } else {
      this.update();
    }
  }

  private make(width: number, scale: number): void {
    const { abscissa, ordinate, lines, zoom, onTop, tick, hasNoPoints } = this.plan;
    const { ink, grid, paper, series: colours, band: fills } = theme();
    const font = `${12 * scale}px system-ui, "DejaVu Sans", sans-serif`;
    const axis = {
      stroke: ink, font, labelFont: font, labelSize: 20 * scale, labelGap: 0, gap: 4 * scale,
      grid: { stroke: grid, width: scale }, ticks: { stroke: grid, width: scale, size: 5 * scale },
    };
    const series: uPlot.Series[] = [{}];
    const bands: uPlot.Band[] = [];
    for (const { label, colour, band, dash, notOk } of lines) {
      series.push({
        label, stroke: colours[colour]!, width: 1.25 * scale, spanGaps: false,
        dash: dash?.map((length) => length * scale),
        points: hasNoPoints ? { show: false } : { size: 4 * scale, fill: colours[colour]!, filter: lonely },
      });
      if (band) {
        const edge: uPlot.Series = { stroke: 'transparent', width: 0, points: { show: false }, spanGaps: false };
        series.push(edge, { ...edge });
        bands.push({ series: [series.length - 1, series.length - 2], fill: fills[colour]! });
      }
      if (notOk)
        series.push({
          label: 'not ok', stroke: colours[kColour.other]!, width: 0, paths: () => null, spanGaps: false,
          points: { show: true, size: 5 * scale, width: 1.25 * scale, stroke: colours[kColour.other]!, fill: paper },
        });
    }
    this.chart = new uPlot({
      width, height: this.height() * scale, legend: { show: false }, series, bands,
      padding: [8 * scale, 12 * scale, 0, 0],
      scales: {
        x: { time: false, range: () => [zoom.min, zoom.max] },
        y: { range: (_u, low, high) => room(low, high) },
      },
      axes: [
        { ...axis, label: abscissa, size: 28 * scale, space: 70 * scale, ...(abscissa === 'Frame' && { incrs: kWhole }) },
        { ...axis, label: ordinate, size: 62 * scale, space: 24 * scale,
          values: tick ? (_u, splits) => splits.map((v) => tick(v)) : (_u, splits) => splits.map((v) => String(Number(v.toPrecision(9))).replace('-', '\u2212')) },
      ],
      cursor: {
        drag: { x: true, y: false, setScale: false },
        sync: { key: abscissa, setSeries: false, scales: ['x', null] },
        points: { size: 7 },
        bind: {
          dblclick: () => () => (zoom.all(), null),
          mousedown: (u, _target, handler) => (event) => {
            if (event.shiftKey) this.startPan(u, event);
            else handler(event);
            return null;
          },
        },
      },
      hooks: {
        setSelect: [(u) => {
          if (u.select.width < 4) return;
          const min = u.posToVal(u.select.left, 'x');
          const max = u.posToVal(u.select.left + u.select.width, 'x');
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          zoom.show(min, max);
        }],
        setCursor: [(u) => this.showReadout(u)],
        draw: onTop ? [(u) => onTop(u, scale)] : [],
        ready: [(u) => {
          u.over.addEventListener('wheel', (event) => this.wheel(u, event), { passive: false });
          u.over.addEventListener('mousedown', () => this.box.focus({ preventScroll: true }));
        }],
      },
    }, this.data(width / scale), this.box);
    this.box.style.setProperty('--height', `${this.height()}px`);
    this.box.classList.toggle('fine', scale > 1);
  }

  // With Ctrl, or in a plot that was clicked: elsewhere the page scrolls.
  private wheel(u: uPlot, event: WheelEvent): void {
    if (!event.ctrlKey && document.activeElement !== this.box) return;
    event.preventDefault();
    const at = u.posToVal(event.offsetX, 'x');
    this.plan.zoom.by(event.deltaY > 0 ? 1.25 : 0.8, at);
  }

  private startPan(u: uPlot, start: MouseEvent): void {
    const { zoom } = this.plan;
    const { min, max } = zoom;
    const perPixel = (max - min) / u.over.clientWidth;
    const move = (event: MouseEvent): void => {
      const by = (start.clientX - event.clientX) * perPixel;
      zoom.pan((min + by - zoom.min) / (zoom.max - zoom.min));
    };
    const end = (): void => {
      removeEventListener('mousemove', move);
      removeEventListener('mouseup', end);
    };
    addEventListener('mousemove', move);
    addEventListener('mouseup', end);
  }

  private showReadout(u: uPlot): void {
    const { left } = u.cursor;
    if (left === undefined || left < 0) {
      this.readout.textContent = '';
      return;
    }
    const { x } = this.plan;
    const at = u.posToVal(left, 'x');
    let index = Math.min(x.length - 1, firstAtLeast(x, at));
    if (index > 0 && at - x[index - 1]! < x[index]! - at) --index;
    this.readout.textContent = this.plan.readout(index);
  }
}
