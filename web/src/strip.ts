// Every frame's status as a strip of colours; the words are next to it.
import { el } from './element';
import { isPrinting, statusColour, theme } from './theme';
import type { Zoom } from './zoom';
import { firstAtLeast } from './decimate';

// Returns the first index of every run of one status. A run also ends at each step above 1.5 of the shortest.
function runsOf(x: Float64Array, status: Float64Array): Float64Array {
  let least = Infinity;
  for (let i = 1; i < x.length; ++i) {
    const step = x[i]! - x[i - 1]!;
    if (step > 0 && step < least) least = step;
  }
  const runs: number[] = [];
  for (let i = 0; i < x.length; ++i) {
    if (i === 0 || status[i] !== status[i - 1] || !(x[i]! - x[i - 1]! < 1.5 * least)) runs.push(i);
  }
  return Float64Array.from(runs);
}

export class Strip {
  readonly element: HTMLElement;
  private readonly canvas = el('canvas', { height: '22' });
  private runs?: Float64Array;
  private readonly readout = el('output', { class: 'readout' });

  constructor(name: string, private readonly x: Float64Array, private readonly status: Float64Array,
    private readonly zoom: Zoom, words: string[], abscissa: (index: number) => string, counts: string) {
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', `${name}: ${counts}`);
    this.element = el('figure', { class: 'strip' },
      el('figcaption', {}, el('span', { class: 'title' }, name), el('span', {}, counts), this.readout), this.canvas);
    zoom.watch(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.element);
    this.canvas.addEventListener('mousemove', (event) => {
      const at = zoom.min + ((zoom.max - zoom.min) * event.offsetX) / this.canvas.clientWidth;
      const index = Math.min(x.length - 1, firstAtLeast(x, at));
      this.readout.textContent = `${abscissa(index)}: ${words[status[index]!] ?? ''}`;
    });
    this.canvas.addEventListener('mouseleave', () => (this.readout.textContent = ''));
  }

  draw(): void {
    const ratio = isPrinting() ? 3 : devicePixelRatio;
    const width = Math.round((isPrinting() ? 586 : this.canvas.clientWidth) * ratio);
    if (width === 0) return;
    const { x, zoom, canvas } = this;
    canvas.width = width;
    canvas.height = Math.round(22 * ratio);
    const pen = canvas.getContext('2d')!;
    pen.fillStyle = theme().grid;
    pen.fillRect(0, 0, width, canvas.height);
    const colours = Array.from({ length: 11 }, (_, k) => statusColour(k));
    const perX = width / (zoom.max - zoom.min || 1);
    const from = Math.max(0, firstAtLeast(x, zoom.min) - 1);
    const to = Math.min(x.length, firstAtLeast(x, zoom.max) + 1);
    const step = to > from + 1 ? (x[to - 1]! - x[from]!) / (to - 1 - from) : 1;
    // ok first, so that one bad frame among thousands still shows.
    for (const bad of [false, true]) {
      const bars = this.bars(from, to, step, bad);
      // Bars that share a pixel are one: a million samples need no more bars than pixels.
      let left = 0;
      let right = -1;
      let code = 0;
      const fill = (): void => {
        if (right < left) return;
        pen.fillStyle = colours[code]!;
        // A bad frame has a height of its own: it shows without its colour.
        pen.fillRect(left, bad ? 0 : 0.3 * canvas.height, right - left, bad ? canvas.height : 0.4 * canvas.height);
      };
      for (const bar of bars) {
        const begin = (bar.first - 0.5 * step - zoom.min) * perX;
        const end = Math.max(begin + ratio, (bar.last + 0.5 * step - zoom.min) * perX);
        if (bar.code === code && begin < right + 0.5) {
          right = Math.max(right, end);
          continue;
        }
        fill();
        [left, right, code] = [begin, end, bar.code];
      }
      fill();
    }
  }

  // Returns the runs of one status in [from, to) without a gap of more than half a step.
  private *bars(from: number, to: number, step: number, bad: boolean): Generator<{ first: number; last: number; code: number }> {
    const { x, status } = this;
    this.runs ??= runsOf(x, status);
    const { runs } = this;
    let r = Math.max(0, firstAtLeast(runs, from + 1) - 1);
    while (r < runs.length && runs[r]! < to) {
      const begin = Math.max(from, runs[r]!);
      const code = status[begin]!;
      let end = runs[r + 1] ?? x.length;
      while (++r < runs.length && end < to && status[end] === code && x[end]! - x[end - 1]! < 1.5 * step) end = runs[r + 1] ?? x.length;
      if (code > 0 === bad) yield { first: x[begin]!, last: x[Math.min(end, to) - 1]!, code };
    }
  }
}
