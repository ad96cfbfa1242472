// The comparison with another sensor (`compare`).
import { abscissaFrom, type Abscissa } from './abscissa';
import type { Comparison } from './data';
import { Curve } from './decimate';
import { bandOf, valueText } from './displacement';
import { el, section, table, type Cell } from './element';
import { brief, digitsFor, expanded, plain, sentence, signed } from './format';
import { Plot, type Line } from './plot';
import { plots } from './registry';
import { kColour, kFirstLine } from './theme';
import { Zoom } from './zoom';

function figures(of: Comparison, unit: string): HTMLElement {
  const estimate = (name: string, value: number | null, u: number | null, factor: number, of_unit: string, meaning: string): (string | Cell)[] => {
    if (value === null) return [name, '\u2013', meaning];
    const spread = expanded(factor * (u ?? NaN));
    const digits = Number.isFinite(spread) ? digitsFor(spread) : 3;
    return [name, { text: `${signed(factor * value, digits)}${Number.isFinite(spread) ? ` \u00b1 ${plain(spread, digits)}` : ''} ${of_unit}`, isNumber: true }, meaning];
  };
  const figure = (name: string, text: string, meaning: string): (string | Cell)[] => [name, { text, isNumber: true }, meaning];
  const percent = (share: number): string => `${(100 * share).toFixed(1)} %`;
  const [low, high] = of.limits_of_agreement;
  return table('Figures of the comparison; \u00b1 is U (k = 2)', ['Figure', 'Value', 'Meaning'], [
    estimate('time offset', of.offset_s.value, of.offset_s.u, 1000, 'ms', 'clock of the reference minus that of the recording'),
    of.is_clock_fitted ? estimate('clock rate', of.clock_ppm.value, of.clock_ppm.u, 1, 'ppm', 'positive: the clock of the reference is faster')
      : figure('clock rate', '0', 'fixed, because the record does not determine it'),
    estimate('slope', of.slope.value, of.slope.u, 1, '', 'movement by moiregauge, divided by that of the reference'),
    estimate('bias', of.bias.value, of.bias.u, 1, unit, 'moiregauge minus reference. It is removed from the difference'),
    figure('correlation', of.correlation.toFixed(5), 'of the aligned records'),
    figure('difference', `${brief(of.rms_difference)} ${unit}`, 'root mean square about the bias'),
    figure('limits of agreement', `${brief(low)} to ${brief(high)} ${unit}`, '95 % of the rows'),
    figure('u of moiregauge', `${brief(of.rms_u)} ${unit}`, 'root mean square, k = 1'),
    figure('coverage of U', percent(of.coverage_of_U), 'rows whose difference is within U. About 95 % if u is the whole difference'),
    figure('u explains', of.share_explained_by_u >= 1 ? 'all' : percent(of.share_explained_by_u),
      of.share_explained_by_u >= 1 ? 'of the variance of the difference' : `of the variance of the difference. ${brief(of.rms_unexplained)} ${unit} rms remain`),
  ]);
}

// The difference against the mean of both, with bias and limits of agreement (Bland and Altman 1986).
function blandAltman(of: Comparison, unit: string, measured: Float64Array, reference: Float64Array): Plot {
  const mean = measured.map((v, k) => 0.5 * (v + reference[k]!));
  const order = Array.from(mean.keys()).sort((a, b) => mean[a]! - mean[b]!);
  const x = Float64Array.from(order, (k) => mean[k]!);
  const difference = Float64Array.from(order, (k) => measured[k]! - reference[k]!);
  const room = 0.04 * (x[x.length - 1]! - x[0]!) || 1;
  const zoom = new Zoom(x[0]! - room, x[x.length - 1]! + room, 2 * room);
  const middle = of.bias.value ?? 0;
  const level = (label: string, name: string, value: number, dash?: number[]): Line => {
    const values = x.map(() => value - middle);
    return { label, colour: kColour.other, dash, curve: new Curve(values), csv: name ? [{ name: `${name}_${of.unit}`, values }] : [] };
  };
  const [low, high] = of.limits_of_agreement;
  return new Plot({
    title: 'Bland-Altman: difference against mean', name: 'bland-altman', abscissa: `Mean of both (${unit})`, ordinate: unit, x, zoom, height: 260,
    hasAllPoints: true, hasNoPoints: true, csvBefore: [{ name: `mean_${of.unit}`, values: x }],
    lines: [{ label: 'difference', colour: kFirstLine, curve: new Curve(difference), points: 'only', csv: [{ name: `difference_${of.unit}`, values: difference }] },
      level('bias, removed', '', middle), level('limits of agreement, lower', 'lower_limit', low, [6, 3]), level('upper', 'upper_limit', high, [2, 2])],
    readout: (k) => `mean ${brief(x[k]!)}, difference ${brief(difference[k]!)} ${unit}`,
    description: `${x.length} differences. Limits of agreement from ${brief(low - middle)} to ${brief(high - middle)} ${unit} about the bias.`,
  });
}

export function comparisonSection(of: Comparison, columns: Float64Array[], run: Abscissa): HTMLElement {
  const unit = of.unit.replace('um', '\u00b5m');
  const time = columns[of.rows.time]!;
  const measured = columns[of.rows.moiregauge]!;
  const reference = columns[of.rows.reference]!;
  const u = columns[of.rows.u]!;
  const difference = measured.map((v, k) => v - reference[k]!);
  const zero = difference.map(() => 0);
  const abscissa = abscissaFrom(undefined, time, run.zoom)!;
  const shared = { abscissa: abscissa.label, ordinate: unit, x: abscissa.x, zoom: run.zoom, csvBefore: abscissa.csv };
  const mine = [
    new Plot({
      ...shared, title: 'Both records on one clock and one zero', name: 'comparison',
      lines: [{ label: `moiregauge: ${of.channel}`, colour: kFirstLine, curve: new Curve(measured), csv: [{ name: 'moiregauge', values: measured }, { name: 'u', values: u }] },
        { label: `reference: ${of.reference}`, colour: kFirstLine + 1, dash: [6, 3], curve: new Curve(reference), csv: [{ name: 'reference', values: reference }] }],
      readout: (k) => `${abscissa.at(k)}: ${valueText(measured[k]!, u[k]!, unit)}, reference ${brief(reference[k]!)} ${unit}`,
      description: `${time.length} compared moments. Every number is in comparison.csv.`,
    }),
    new Plot({
      ...shared, title: 'Difference: moiregauge minus reference, without the bias', name: 'comparison-difference',
      lines: [{ label: 'difference', colour: kFirstLine, curve: new Curve(difference), csv: [{ name: 'difference', values: difference }] },
        { label: 'zero', colour: kColour.other, points: 'none', curve: new Curve(zero), band: bandOf(zero, u), csv: [{ name: 'u', values: u }] }],
      readout: (k) => `${abscissa.at(k)}: ${valueText(difference[k]!, u[k]!, unit)}`,
      description: `Root mean square ${brief(of.rms_difference)} ${unit}. The band is U of moiregauge (k = 2).`,
    }),
    blandAltman(of, unit, measured, reference),
  ];
  plots.push(...mine);
  const warnings = of.warnings.length > 0 && el('ul', { class: 'notes' }, ...of.warnings.map((text) => el('li', {}, sentence(text))));
  return section('comparison', 'Comparison', el('p', {}, `${of.channel} of this run against ${of.reference}, at the ${of.compared_at === 'reference' ? 'rows of the reference' : 'frames'}.`),
    warnings, ...mine.slice(0, 2).map(({ element }) => element), mine[2]!.element, figures(of, unit));
}
