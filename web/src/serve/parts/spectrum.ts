// Amplitude spectrum of the last minute of one curve, under a Hann window. For orientation: the report's spectra have uncertainties.
import type uPlot from 'uplot';
import { SmallPlot } from './small_plot';
import { el } from '../../element';
import { theme } from '../../theme';

const kSpan_s = 60;
const kLines = 240; // frequencies, from 1 / span to half the rate
const kLeast = 32; // samples
const kRedraw_ms = 1000;
const kHeight = 150;

// Amplitudes (peak) at `frequencies` Hz of samples at any times, by direct sums. A Hann window halves the mean, hence the factor 2.
export function amplitudes(t: number[], y: number[], frequencies: number[]): number[] {
  const first = t[0]!;
  const span = t[t.length - 1]! - first || 1;
  const mean = y.reduce((sum, value) => sum + value, 0) / y.length;
  const window = t.map((time) => 0.5 - 0.5 * Math.cos((2 * Math.PI * (time - first)) / span));
  const weight = window.reduce((sum, value) => sum + value, 0) || 1;
  return frequencies.map((frequency) => {
    let re = 0;
    let im = 0;
    for (let k = 0; k < t.length; ++k) {
      const angle = 2 * Math.PI * frequency * (t[k]! - first);
      const value = window[k]! * (y[k]! - mean);
      re += value * Math.cos(angle);
      im += value * Math.sin(angle);
    }
    return (2 * Math.hypot(re, im)) / weight;
  });
}

export class SpectrumChart {
  readonly element: HTMLElement;
  private readonly peak = el('output', { class: 'readout' });
  private readonly plot: SmallPlot;
  private t: number[] = [];
  private y: number[] = [];
  private readonly timer: ReturnType<typeof setInterval>;

  constructor(private readonly title: string) {
    this.plot = new SmallPlot(title, kHeight, this.peak);
    this.element = this.plot.element;
    this.timer = setInterval(() => this.draw(), kRedraw_ms);
  }

  remove(): void {
    clearInterval(this.timer);
    this.plot.remove();
  }

  remake(): void {
    this.plot.clear();
    this.draw();
  }

  add(time: number, value: number | null, name: string): void {
    this.plot.describe(`${this.title} of ${name}`);
    if (value === null) return;
    this.t.push(time);
    this.y.push(value);
    const from = this.t.findIndex((one) => one >= time - kSpan_s);
    if (from > 0) {
      this.t = this.t.slice(from);
      this.y = this.y.slice(from);
    }
  }

  private draw(): void {
    if (this.t.length < kLeast) return;
    const span = this.t[this.t.length - 1]! - this.t[0]!;
    if (!(span > 0)) return;
    const top = (this.t.length - 1) / span / 2;
    const frequencies = Array.from({ length: kLines }, (_, k) => ((k + 1) * top) / kLines);
    const amplitude = amplitudes(this.t, this.y, frequencies);
    const highest = amplitude.indexOf(Math.max(...amplitude));
    this.peak.textContent = `highest at ${frequencies[highest]!.toFixed(2)} Hz, resolution ${(2 / span).toFixed(2)} Hz`;
    this.plot.draw([frequencies, amplitude] as uPlot.AlignedData, () => ({
      abscissa: 'Frequency (Hz)', ordinate: 'mm',
      series: [{ label: 'amplitude', stroke: theme().series[1]!, width: 1.5, points: { show: false } }],
    }));
  }
}
