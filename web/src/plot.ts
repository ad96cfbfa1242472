// One plot of curves over the abscissa of its group: drawn when it comes into view, redrawn when zoom, theme or width change.
import uPlot from 'uplot';
import { Curve, drawn, firstAtLeast, type DrawnCurve } from './decimate';
import { csvText, fileName, save, type CsvColumn } from './download';
import { el } from './element';
import { isPrinting, kColour, kFirstLine, onPaper, theme } from './theme';
import type { Zoom } from './zoom';

export interface Line {
  label: string;
  curve: Curve;
  colour: number; // number in the theme
  dash?: number[];
  band?: { low: Curve; high: Curve };
  notOk?: Curve; // values of rows that are not ok: hollow grey points
  csv?: CsvColumn[]; // default: the label and the values of the curve
  isShown?: () => boolean;
  hasBand?: () => boolean; // with `band`: whether to draw it
  points?: 'only' | 'none'; // default: a line, with points where samples are few
}

export interface PlotPlan {
  title: string;
  fullTitle?: string; // with the target, for an image that leaves the page
  name: string; // file name without ending
  abscissa: string; // label of x
  ordinate: string;
  x: Float64Array;
  lines: Line[];
  zoom: Zoom;
  height?: number;
  printHeight?: number;
  // Describes the sample under the pointer in words.
  readout: (index: number) => string;
  // Draws marks on top of the curves, in canvas pixels.
  onTop?: (plot: uPlot, scale: number) => void;
  // Formats ordinate values: a spectrum's are powers of ten.
  tick?: (value: number) => string;
  hasNoPoints?: boolean;
  hasAllPoints?: boolean; // draws every point, not the extremes of each pixel
  csvBefore: CsvColumn[]; // columns before and after those of the lines
  csvAfter?: CsvColumn[];
  description: string; // for screen readers
}

const kPrintWidth = 680; // CSS pixels on paper
const kPrintHeight = 170; // most on paper: five to a page
const kPrintScale = 3; // and how much finer paper is than a screen
const kImageWidth = 900; // CSS pixels of a saved image
const kImageHeight = 320;
const kImageScale = 2;
const kFaint = '22'; // opacity of overlapping bands
const kClick_px = 3; // a press that moves further is a drag
const kAllPoints = 30000; // most points of a plot that draws all
const kWhole = [0, 1, 2, 3, 4, 5, 6, 7, 8].flatMap((decade) => [1, 2, 5].map((n) => n * 10 ** decade));
let plots = 0;
let images = Promise.resolve(); // one after the other: each changes the theme for a moment

// The dashes of a line as a background, for its key.
function dashes(dash: number[]): string {
  let at = 0;
  const stops = dash.map((length, k) => `${k % 2 ? 'transparent' : 'var(--colour)'} ${at}px ${(at += length)}px`);
  return stops.length > 0 ? `repeating-linear-gradient(90deg, ${stops.join(', ')})` : 'none';
}

const tickText = (value: number): string => String(Number(value.toPrecision(9))).replace('-', '\u2212');

const hasBand = (line: Line): boolean => line.band !== undefined && (line.hasBand?.() ?? true);

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
  private readonly keys = el('ul', { class: 'keys' });
  private readonly onZoom = (): void => this.change();
  private readonly watchers: { disconnect(): void }[] = [];
  private chart?: uPlot;
  private isVisible = false;
  private isStale = true;
  private pressedAt = 0; // client x of the last button press

  constructor(private readonly plan: PlotPlan) {
    const id = `plot-${++plots}`;
    this.fillKeys();
    const caption = el('figcaption', {}, el('span', { class: 'title', id }, plan.title), this.keys, this.readout, this.buttons());
    this.box.tabIndex = 0;
    this.box.setAttribute('role', 'img');
    this.box.setAttribute('aria-labelledby', id);
    this.box.setAttribute('aria-description', plan.description);
    this.box.addEventListener('keydown', (event) => {
      if (!event.ctrlKey && !event.altKey && !event.metaKey && plan.zoom.key(event.key)) event.preventDefault();
    });
    this.element = el('figure', { class: 'plot' }, caption, this.box);
    this.box.style.minHeight = `${this.height()}px`;
    plan.zoom.watch(this.onZoom);
    this.watchSize();
  }

  private shown(): Line[] {
    return this.plan.lines.filter((line) => line.isShown?.() ?? true);
  }

  // The key of the lines that are shown. A single line without a band needs none.
  private keyList(): { label: string; colour: number; kind: '' | 'dashed' | 'band' | 'hollow' | 'point'; dash?: number[] }[] {
    const lines = this.shown();
    const list: ReturnType<Plot['keyList']> = [];
    const banded = lines.filter((line) => hasBand(line));
    if (this.plan.lines.length > 1 || banded.length > 0)
      for (const { label, colour, dash, points } of lines) list.push({ label, colour, dash, kind: points === 'only' ? 'point' : dash ? 'dashed' : '' });
    if (banded.length > 0) list.push({ label: 'U (k = 2)', colour: banded.length > 1 && this.plan.lines[0]!.colour >= kFirstLine ? kColour.other : banded[0]!.colour, kind: 'band' });
    if (lines.some(({ notOk }) => notOk && !notOk.isEmpty())) list.push({ label: 'not ok', colour: kColour.other, kind: 'hollow' });
    return list;
  }

  private fillKeys(): void {
    this.keys.replaceChildren(...this.keyList().map(({ label, colour, kind, dash }) =>
      el('li', { class: kind, style: `--colour: var(--series-${colour + 1}); --line: ${dashes(dash ?? [])}` }, label)));
  }

  private buttons(): HTMLElement {
    const what = this.plan.fullTitle ?? this.plan.title;
    const button = (text: string, meaning: string, act: () => void): HTMLElement => {
      const b = el('button', { type: 'button', 'aria-label': `Save ${what} as ${text}`, title: meaning }, text);
      b.addEventListener('click', act);
      return b;
    };
    return el('span', { class: 'actions' },
      button('CSV', 'Save the numbers of the range and lines shown as CSV', () => this.saveCsv()),
      button('PNG', 'Save this plot as a PNG image', () => {
        images = images.then(() => this.savePng());
      }));
  }

  private saveCsv(): void {
    const { x, zoom, name, csvBefore, csvAfter } = this.plan;
    const columns = this.shown().flatMap((line) => line.csv ?? [{ name: line.label, values: line.curve.values }]);
    const to = firstAtLeast(x, zoom.max);
    const text = csvText([...csvBefore, ...columns, ...(csvAfter ?? [])], firstAtLeast(x, zoom.min), x[to] === zoom.max ? to + 1 : to);
    save(fileName(name, '.csv'), new Blob([text], { type: 'text/csv' }));
  }

  // The plot in the colours of paper, with its title and key above.
  private async savePng(): Promise<void> {
    const holder = el('div', { style: 'position: absolute; left: -99999px; top: 0' });
    document.body.append(holder);
    const image = el('canvas');
    const leave = onPaper();
    try {
      const chart = this.chartIn(holder, kImageWidth * kImageScale, kImageScale, kImageHeight);
      await Promise.resolve(); // uPlot draws in a microtask
      const ratio = kImageScale * uPlot.pxRatio;
      const from = chart.ctx.canvas;
      const head = 46 * ratio;
      image.width = from.width;
      image.height = from.height + head;
      const pen = image.getContext('2d')!;
      const { paper } = theme();
      pen.fillStyle = paper;
      pen.fillRect(0, 0, image.width, image.height);
      this.drawHead(pen, ratio);
      pen.drawImage(from, 0, head);
      chart.destroy();
    } finally {
      leave();
      holder.remove();
    }
    const blob = await new Promise<Blob | null>((done) => image.toBlob(done, 'image/png'));
    if (blob) save(fileName(this.plan.name, '.png'), blob);
  }

  private drawHead(pen: CanvasRenderingContext2D, ratio: number): void {
    const { ink, series, strong } = theme();
    const face = 'system-ui, "DejaVu Sans", sans-serif';
    pen.textBaseline = 'middle';
    pen.fillStyle = strong;
    pen.font = `600 ${13 * ratio}px ${face}`;
    pen.fillText(this.plan.fullTitle ?? this.plan.title, 12 * ratio, 15 * ratio, kImageWidth * ratio - 24 * ratio);
    pen.font = `${11.5 * ratio}px ${face}`;
    let at = 12 * ratio;
    const y = 34 * ratio;
    for (const { label, colour, kind, dash } of this.keyList()) {
      const width = 26 * ratio;
      const text = pen.measureText(label).width;
      if (at + width + text > (kImageWidth - 12) * ratio) break;
      pen.strokeStyle = series[colour]!;
      pen.lineWidth = 2 * ratio;
      pen.setLineDash((dash ?? []).map((length) => length * ratio));
      pen.beginPath();
      if (kind === 'band') {
        pen.fillStyle = series[colour]! + '38';
        pen.fillRect(at, y - 5 * ratio, 20 * ratio, 10 * ratio);
      } else if (kind === 'hollow' || kind === 'point') {
        pen.arc(at + 10 * ratio, y, 3.5 * ratio, 0, 7);
        pen.fillStyle = series[colour]!;
        if (kind === 'point') pen.fill();
        else pen.stroke();
      } else {
        pen.moveTo(at, y);
        pen.lineTo(at + 20 * ratio, y);
        pen.stroke();
      }
      pen.fillStyle = ink;
      pen.fillText(label, at + width, y);
      at += width + text + 16 * ratio;
    }
    pen.setLineDash([]);
  }

  // Takes the plot off the page: another one replaces it.
  remove(): void {
    this.plan.zoom.unwatch(this.onZoom);
    this.watchers.forEach((watcher) => watcher.disconnect());
    this.chart?.destroy();
    this.element.remove();
  }

  private height(): number {
    const { height = 200, printHeight = Math.min(kPrintHeight, 0.85 * height) } = this.plan;
    return isPrinting() ? printHeight : height;
  }

  private watchSize(): void {
    const inView = new IntersectionObserver((entries) => {
      this.isVisible = entries.some((entry) => entry.isIntersecting);
      if (this.isVisible && this.isStale) this.update();
    }, { rootMargin: '200px' });
    inView.observe(this.element);
    let width = 0;
    const resized = new ResizeObserver(() => {
      if (isPrinting() || !this.chart || this.box.clientWidth === width) return;
      width = this.box.clientWidth;
      this.chart.setSize({ width, height: this.height() });
      this.change();
    });
    resized.observe(this.box);
    this.watchers.push(inView, resized);
  }

  private change(): void {
    this.isStale = true;
    if (this.isVisible) this.update();
  }

  private data(pixels: number): uPlot.AlignedData {
    const { x, zoom, hasAllPoints } = this.plan;
    const curves = this.shown().flatMap((line): DrawnCurve[] => [{ curve: line.curve },
      ...(hasBand(line) ? [{ curve: line.band!.low }, { curve: line.band!.high }] : []), ...(line.notOk ? [{ curve: line.notOk, isPoints: true }] : [])]);
    return drawn(x, curves, zoom.min, zoom.max, hasAllPoints ? kAllPoints : Math.max(100, Math.floor(pixels))) as uPlot.AlignedData;
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

  // Draws again: the lines that are shown or the theme have changed.
  remake(): void {
    this.fillKeys();
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
    this.chart = this.chartIn(this.box, width, scale);
    this.box.style.setProperty('--height', `${this.height()}px`);
    this.box.classList.toggle('fine', scale > 1);
  }

  private chartIn(box: HTMLElement, width: number, scale: number, height = this.height()): uPlot {
    const { abscissa, ordinate, zoom, onTop, tick, hasNoPoints } = this.plan;
    const { ink, grid, paper, series: colours, band: fills } = theme();
    const font = `${12 * scale}px system-ui, "DejaVu Sans", sans-serif`;
    const axis = {
      stroke: ink, font, labelFont: font, labelSize: 20 * scale, labelGap: 0, gap: 4 * scale,
      grid: { stroke: grid, width: scale }, ticks: { stroke: grid, width: scale, size: 5 * scale },
    };
    const series: uPlot.Series[] = [{}];
    const bands: uPlot.Band[] = [];
    const isMany = this.shown().filter(hasBand).length > 1; // bands over each other
    for (const line of this.shown()) {
      const { label, colour, dash, notOk, points } = line;
      series.push({
        label, stroke: colours[colour]!, width: 1.25 * scale, spanGaps: false,
        dash: dash?.map((length) => length * scale),
        ...(points === 'only' && { paths: () => null }),
        points: points === 'only' ? { show: true, size: 4 * scale, width: 0, fill: colours[colour]! } : points === 'none' || hasNoPoints ? { show: false } : { size: 4 * scale, fill: colours[colour]!, filter: lonely },
      });
      if (hasBand(line)) {
        const edge: uPlot.Series = { stroke: 'transparent', width: 0, points: { show: false }, spanGaps: false };
        series.push(edge, { ...edge });
        bands.push({ series: [series.length - 1, series.length - 2], fill: isMany ? fills[colour]!.replace(/..$/, kFaint) : fills[colour]! });
      }
      if (notOk)
        series.push({
          label: 'not ok', stroke: colours[kColour.other]!, width: 0, paths: () => null, spanGaps: false,
          points: { show: true, size: 5 * scale, width: 1.25 * scale, stroke: colours[kColour.other]!, fill: paper },
        });
    }
    return new uPlot({
      width, height: height * scale, legend: { show: false }, series, bands,
      padding: [8 * scale, 12 * scale, 0, 0],
      scales: {
        x: { time: false, range: () => [zoom.min, zoom.max] },
        y: { range: (_u, low, high) => room(low, high) },
      },
      axes: [
        { ...axis, label: abscissa, size: 28 * scale, space: 70 * scale, values: (_u, splits) => splits.map(tickText), ...(abscissa === 'Frame' && { incrs: kWhole }) },
        { ...axis, label: ordinate, size: 62 * scale, space: 24 * scale,
          values: (_u, splits) => splits.map(tick ?? tickText) },
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
          u.over.addEventListener('mousedown', (event) => {
            this.box.focus({ preventScroll: true });
            this.pressedAt = event.clientX;
          });
          u.over.addEventListener('click', (event) => this.pick(u, event));
        }],
      },
    }, this.data(width / scale), box);
  }

  // Announces a click on a sample as the event `pick`, with its index. A drag is not a click.
  private pick(u: uPlot, event: MouseEvent): void {
    const index = this.indexUnder(u);
    if (index === undefined || Math.abs(event.clientX - this.pressedAt) > kClick_px) return;
    this.element.dispatchEvent(new CustomEvent('pick', { detail: index, bubbles: true }));
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

  // Returns the sample nearest to the pointer.
  private indexUnder(u: uPlot): number | undefined {
    const { left } = u.cursor;
    if (left === undefined || left < 0) return undefined;
    const { x } = this.plan;
    const at = u.posToVal(left, 'x');
    let index = Math.min(x.length - 1, firstAtLeast(x, at));
    if (index > 0 && at - x[index - 1]! < x[index]! - at) --index;
    return index;
  }

  private showReadout(u: uPlot): void {
    const index = this.indexUnder(u);
    this.readout.textContent = index === undefined ? '' : this.plan.readout(index);
  }
}
