// The spectra of one target, and the table of their peaks.
import type uPlot from 'uplot';
import type { Peak, Spectrum, Target } from './data';
import { Curve } from './decimate';
import { el, table, type Cell } from './element';
import { brief, digitsFor, duration, expanded, expandedFrequency, plain } from './format';
import { Plot } from './plot';
import { kColour, theme } from './theme';
import type { Zoom } from './zoom';

const kKinds = { steady: 'steady', decay: 'free decay', random: 'random' };
const kSuperscripts = '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079';

const power = (decade: number): string =>
  Number.isInteger(decade) ? '10' + String(decade).replace('-', '\u207b').replace(/\d/g, (digit) => kSuperscripts[Number(digit)]!) : '';

const axes = [
  { key: 'x', name: 'dx, right' },
  { key: 'y', name: 'dy, up' },
] as const;

// "dx" of "dx, right".
const short = (name: string): string => name.slice(0, 2);
const colourOf = (name: string): number => (name.startsWith('dx') ? kColour.x : kColour.y);

function peakRow(axis: string, peak: Peak): (string | Cell)[] {
  const u = expandedFrequency(peak.u_frequency_hz, peak.frequency_hz);
  const f = `${plain(peak.frequency_hz, digitsFor(u))} \u00b1 ${plain(u, digitsFor(u))}`;
  let damping = 'none';
  if (peak.damping !== null && peak.u_damping !== null) {
    const spread = 100 * expanded(peak.u_damping);
    damping = `${plain(100 * peak.damping, digitsFor(spread))} \u00b1 ${plain(spread, digitsFor(spread))}`;
  }
  const source = `${brief(peak.from_s)} to ${brief(peak.to_s)} s`;
  return [axis, { text: f, isNumber: true }, { text: damping, isNumber: true }, { text: brief(peak.amplitude_mm), isNumber: true },
    kKinds[peak.kind], `${source}${peak.no_damping ? `; no damping value, because ${peak.no_damping}` : ''}`];
}

const terms = (spectrum: Spectrum): string =>
  `Welch's method with ${spectrum.segments === 1 ? 'one segment' : `${spectrum.segments} half-overlapping segments`} of ${duration(spectrum.segment_s)}, without mean and slope. ` +
  `Hann window, resolution bandwidth ${brief(spectrum.resolution_hz)} Hz. ` +
  (spectrum.gaps > 0 ? `The record has ${spectrum.gaps} gap${spectrum.gaps > 1 ? 's' : ''}, and its longest stretch without a gap is ${duration(spectrum.longest_s)}.`
    : 'The record has no gaps.');

export function spectraOf(target: Target, columns: Float64Array[], zoom: Zoom | undefined): { element: HTMLElement; plots: Plot[] } {
  const whole = axes.map(({ key, name }) => ({ name, spectrum: target.spectrum[key] }));
  const there = whole.filter(({ spectrum }) => !spectrum.refusal);
  const element = el('div', { class: 'target' }, el('h3', {}, target.name));
  const refused = whole.filter(({ spectrum }) => spectrum.refusal);
  const reasons = new Set(refused.map(({ spectrum }) => spectrum.refusal!));
  for (const reason of reasons) {
    const which = refused.filter(({ spectrum }) => spectrum.refusal === reason).map(({ name }) => short(name)).join(' and ');
    element.append(el('p', { class: 'note' }, `There is no spectrum of ${which}, because ${reason}.`));
  }
  if (there.length === 0 || !zoom) return { element, plots: [] };
  // Both axes have the same frames; where gaps differ their frequencies do, and each has a plot of its own.
  const groups = there.length === 2 && there[0]!.spectrum.step_hz === there[1]!.spectrum.step_hz
    && columns[there[0]!.spectrum.log10_psd]!.length === columns[there[1]!.spectrum.log10_psd]!.length ? [there] : there.map((one) => [one]);
  const groupName = (group: typeof there): string => (groups.length > 1 ? `-${short(group[0]!.name)}` : '');
  const plots = groups.map((group) => {
    const first = group[0]!.spectrum;
    const count = columns[first.log10_psd]!.length;
    const x = Float64Array.from({ length: count }, (_, k) => k * first.step_hz);
    const marks = (u: uPlot, scale: number): void => {
      const pen = u.ctx;
      const { series } = theme();
      pen.save();
      pen.font = `${11 * scale * devicePixelRatio}px system-ui, "DejaVu Sans", sans-serif`;
      pen.lineWidth = scale * devicePixelRatio;
      group.forEach(({ name, spectrum }) => {
        spectrum.peaks.forEach((peak) => {
          const at = u.valToPos(peak.frequency_hz, 'x', true);
          if (at < u.bbox.left || at > u.bbox.left + u.bbox.width) return;
          pen.strokeStyle = pen.fillStyle = series[colourOf(name)]!;
          pen.setLineDash([3 * scale, 3 * scale]);
          pen.beginPath();
          pen.moveTo(at, u.bbox.top);
          pen.lineTo(at, u.bbox.top + u.bbox.height);
          pen.stroke();
          const text = `${plain(peak.frequency_hz, Math.min(3, digitsFor(expanded(peak.u_frequency_hz))))} Hz`;
          const isRight = at + pen.measureText(text).width + 8 < u.bbox.left + u.bbox.width;
          pen.textAlign = isRight ? 'left' : 'right';
          pen.fillText(text, at + (isRight ? 4 : -4) * scale, u.bbox.top + (colourOf(name) === kColour.x ? 26 : 12) * scale * devicePixelRatio);
        });
      });
      pen.restore();
    };
    return new Plot({
      title: `Power spectral density, one-sided, ${group.map(({ name }) => short(name)).join(' and ')}`,
      fullTitle: `${target.name}: power spectral density, one-sided`, name: `${target.name}-spectrum${groupName(group)}`,
      csvBefore: [{ name: 'frequency_hz', values: x }],
      hasNoPoints: true, abscissa: 'Frequency (Hz)', ordinate: 'mm\u00b2/Hz', x, zoom, onTop: marks, tick: power,
      lines: group.map(({ name, spectrum }) => ({
        label: name, colour: colourOf(name), curve: new Curve(columns[spectrum.log10_psd]!),
        csv: [{ name: `psd_${short(name)}_mm2_per_hz`, values: columns[spectrum.log10_psd]!.map((decade) => Number((10 ** decade).toPrecision(4))) }],
      })),
      readout: (k) => `${brief(x[k]!)} Hz: ${group.map(({ name, spectrum }) => `${short(name)} ${brief(10 ** columns[spectrum.log10_psd]![k]!)} mm\u00b2/Hz`).join(', ')}`,
      description: `Spectrum from 0 to ${brief(x[count - 1]!)} Hz. Its peaks are in the table below.`,
    });
  });
  plots.forEach((plot) => element.append(plot.element));
  const said = new Set(there.map(({ spectrum }) => terms(spectrum)));
  said.forEach((text) => element.append(el('p', { class: 'small' }, text)));
  const rows = there.flatMap(({ name, spectrum }) => spectrum.peaks.map((peak) => peakRow(short(name), peak)));
  element.append(rows.length > 0
    ? table(`Peaks of ${target.name}; \u00b1 is U (k = 2)`, ['Axis', 'Frequency (Hz)', 'Damping ratio (%)', 'Amplitude (mm)', 'Kind', 'Based on'], rows)
    : el('p', {}, 'No frequency is stated, because the record is too short or no peak exceeds the noise by more than chance. ' +
      `Vibration below ${brief(1.5 * there[0]!.spectrum.resolution_hz)} Hz needs a longer record.`));
  return { element, plots };
}
