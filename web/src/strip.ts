// Every frame's status as a strip of colours; the words are next to it.
import { el } from './element';
import { isPrinting, statusColour, theme } from './theme';
import type { Zoom } from './zoom';
import { firstAtLeast } from './decimate';

export class Strip {
  readonly element: HTMLElement;
  private readonly canvas = el('canvas', { height: '22' });
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
    const { x, status, zoom, canvas } = this;
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
      for (let i = from; i < to; ++i) {
        const code = status[i]!;
        if (code > 0 !== bad) continue;
        let end = i + 1;
        while (end < to && status[end] === code && x[end]! - x[end - 1]! < 1.5 * step) ++end;
        const left = (x[i]! - 0.5 * step - zoom.min) * perX;
        const right = (x[end - 1]! + 0.5 * step - zoom.min) * perX;
        pen.fillStyle = colours[code]!;
        // A bad frame has a height of its own: it shows without its colour.
        pen.fillRect(left, code > 0 ? 0 : 0.3 * canvas.height, Math.max(ratio, right - left), code > 0 ? canvas.height : 0.4 * canvas.height);
        i = end - 1;
      }
    }
  }
}
