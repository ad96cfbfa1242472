// The frame of a small plot of the page: caption, box, axes. It follows the size of the page, and is made again for another theme.
import uPlot from 'uplot';
import { el } from '../../element';
import { theme } from '../../theme';

export interface SmallPlan {
  abscissa: string;
  ordinate: string;
  series: uPlot.Series[]; // without that of x
  bands?: uPlot.Band[];
}

const kFont = '12px system-ui, sans-serif';
const minus = (_u: uPlot, splits: number[]): string[] => splits.map((value) => String(Number(value.toPrecision(9))).replace('-', '\u2212'));

export class SmallPlot {
  readonly element: HTMLElement;
  private readonly box = el('div', { class: 'canvas' });
  private readonly resized: ResizeObserver;
  private chart?: uPlot;

  // `height` in CSS pixels. `parts` follow the title.
  constructor(title: string, private readonly height: number, ...parts: HTMLElement[]) {
    this.box.setAttribute('role', 'img');
    this.describe(title);
    this.box.style.minHeight = `${height}px`;
    this.element = el('figure', { class: 'plot' }, el('figcaption', {}, el('span', { class: 'title' }, title), ...parts), this.box);
    this.resized = new ResizeObserver(() => this.chart?.setSize({ width: this.box.clientWidth, height }));
    this.resized.observe(this.box);
  }

  describe(text: string): void {
    this.box.setAttribute('aria-label', text);
  }

  // Removes the curves. The next drawing makes them again, in the colours of the theme.
  clear(): void {
    this.chart?.destroy();
    this.chart = undefined;
  }

  remove(): void {
    this.resized.disconnect();
    this.clear();
    this.element.remove();
  }

  // Returns false if the plot is not shown. `plan` is used if there are no curves yet.
  draw(data: uPlot.AlignedData, plan: () => SmallPlan): boolean {
    if (this.box.clientWidth === 0) return false;
    if (this.chart) this.chart.setData(data);
    else this.chart = this.made(data, plan());
    return true;
  }

  private made(data: uPlot.AlignedData, { abscissa, ordinate, series, bands = [] }: SmallPlan): uPlot {
    const { ink, grid } = theme();
    const axis: uPlot.Axis = {
      stroke: ink, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1, size: 4 }, font: kFont, labelFont: kFont, labelSize: 18, labelGap: 0, values: minus,
    };
    return new uPlot({
      width: this.box.clientWidth, height: this.height, legend: { show: false }, series: [{}, ...series], bands, padding: [8, 12, 0, 0],
      scales: { x: { time: false } }, cursor: { show: false },
      axes: [{ ...axis, label: abscissa, size: 40 }, { ...axis, label: ordinate, size: 60 }],
    }, data, this.box);
  }
}
