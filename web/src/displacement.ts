// The displacement of all targets: together, to compare them, and one by one.
import type { Abscissa } from './abscissa';
import { toolbar } from './abscissa';
import { choices } from './choices';
import type { Report, Target } from './data';
import { Curve } from './decimate';
import type { CsvColumn } from './download';
import { el, section } from './element';
import { brief, digitsFor, expanded, plain, signed } from './format';
import { Plot, type Line } from './plot';
import { plots } from './registry';
import { kColour, kDashes, kFirstLine, kLines } from './theme';

const kAxes = [
  { key: 'dx', d: 'dx', u: 'ux', title: 'dx, right is positive', colour: kColour.x },
  { key: 'dy', d: 'dy', u: 'uy', title: 'dy, up is positive', colour: kColour.y },
] as const;
type Axis = (typeof kAxes)[number];

const kShownAtFirst = 8; // targets
const kBandsAtFirst = 3; // targets with bands of U; more hide each other

// The values of rows that are ok, or of the others; the rest are gaps.
export function valuesOf(values: Float64Array, status: Float64Array, ok: boolean): Float64Array {
  return values.map((value, k) => ((status[k] === 0) === ok ? value : NaN));
}

export function bandOf(values: Float64Array, u: Float64Array): { low: Curve; high: Curve } {
  return { low: new Curve(values.map((v, k) => v - expanded(u[k]!))), high: new Curve(values.map((v, k) => v + expanded(u[k]!))) };
}

// "+0.123 ± 0.004 mm".
export function valueText(value: number, u: number, unit: string): string {
  if (Number.isNaN(value)) return 'not measured';
  const digits = digitsFor(expanded(u));
  return `${signed(value, digits)}${Number.isNaN(u) ? '' : ` \u00b1 ${plain(expanded(u), digits)}`} ${unit}`;
}

function statusText(of: Report, code: number): string {
  const found = of.statuses[code];
  return !found ? '' : code === 0 ? found.word : `${found.word} (${found.meaning})`;
}

const statusColumn = (of: Report, name: string, status: Float64Array): CsvColumn =>
  ({ name, values: (k) => of.statuses[status[k]!]?.word ?? '' });

function extremesText(values: Float64Array): string {
  const [low, high] = new Curve(values).extremes(0, values.length);
  return low > high ? 'No row was measured.' : `From ${brief(low)} to ${brief(high)} mm over ${values.length} frames. Every number is in displacement.csv.`;
}

// Lines show no movement along themselves. Then only the reference frame, which is zero by definition, has a value.
const isMeasured = (values: Float64Array): boolean => values.length <= 1 || values.filter((v) => !Number.isNaN(v)).length > 1;

type Curves = Pick<Line, 'curve' | 'band' | 'notOk'>;

function curvesOf(target: Target, axis: Axis, columns: Float64Array[]): Curves {
  const value = columns[target.rows[axis.d]]!;
  const status = columns[target.rows.status]!;
  const ok = valuesOf(value, status, true);
  return { curve: new Curve(ok), band: bandOf(ok, columns[target.rows[axis.u]]!), notOk: new Curve(valuesOf(value, status, false)) };
}

function alone(of: Report, target: Target, curves: Curves[], columns: Float64Array[], abscissa: Abscissa): HTMLElement {
  const status = columns[target.rows.status]!;
  const parts = kAxes.map((axis, a) => {
    const value = columns[target.rows[axis.d]]!;
    const u = columns[target.rows[axis.u]]!;
    if (!isMeasured(value)) return el('p', { class: 'note' }, `${axis.key} was not measured.`);
    return new Plot({
      title: axis.title, fullTitle: `${target.name}: ${axis.title}`, name: `${target.name}-${axis.key}`,
      abscissa: abscissa.label, ordinate: 'mm', x: abscissa.x, zoom: abscissa.zoom,
      lines: [{ ...curves[a]!, label: 'displacement', colour: axis.colour, csv: [{ name: `${axis.key}_mm`, values: value }, { name: `u_${axis.key}_mm`, values: u }] }],
      csvBefore: abscissa.csv, csvAfter: [statusColumn(of, 'status', status)],
      readout: (k) => `${abscissa.at(k)}: ${valueText(value[k]!, u[k]!, 'mm')}, ${statusText(of, status[k]!)}`,
      description: extremesText(value),
    });
  });
  plots.push(...parts.filter((part) => part instanceof Plot));
  return el('div', { class: 'target' }, el('h3', {}, target.name), ...parts.map((part) => (part instanceof Plot ? part.element : part)));
}

// All targets in one plot per axis, with boxes to choose them.
function together(of: Report, curves: Curves[][], columns: Float64Array[], abscissa: Abscissa): HTMLElement {
  let hasBands = of.targets.length <= kBandsAtFirst;
  const colour = (k: number): number => kFirstLine + (k % kLines);
  const two: Plot[] = [];
  const update = (): void => two.forEach((plot) => plot.remake());
  const targets = choices('Targets', of.targets.map(({ name }, k) => ({ label: name, isOn: k < kShownAtFirst, colour: colour(k) })), update, true);
  const bands = choices('Uncertainty', [{ label: 'U (k = 2)', isOn: hasBands }], () => {
    hasBands = bands.isOn(0);
    update();
  });
  kAxes.forEach((axis, a) => {
    const lines = of.targets.map(({ name, rows }, k): Line => ({
      ...curves[k]![a]!, label: name, colour: colour(k), dash: kDashes[Math.floor(k / kLines) % kDashes.length],
      isShown: () => targets.isOn(k), hasBand: () => hasBands,
      csv: [{ name: `${name}_${axis.key}_mm`, values: columns[rows[axis.d]]! }, { name: `u_${name}_${axis.key}_mm`, values: columns[rows[axis.u]]! },
        statusColumn(of, `${name}_status`, columns[rows.status]!)],
    }));
    two.push(new Plot({
      title: axis.title, fullTitle: `All targets: ${axis.title}`, name: `targets-${axis.key}`, height: 230, printHeight: 145, // both are on the first page (first_page.ts)
     
      abscissa: abscissa.label, ordinate: 'mm', x: abscissa.x, zoom: abscissa.zoom, lines, csvBefore: abscissa.csv,
      readout: (k) => `${abscissa.at(k)}: ${of.targets.filter((_t, n) => targets.isOn(n)).slice(0, kShownAtFirst)
        .map((target) => `${target.name} ${valueText(columns[target.rows[axis.d]]![k]!, columns[target.rows[axis.u]]![k]!, 'mm')}`).join(', ')}`,
      description: of.targets.map(({ name, rows }) => `${name}: ${extremesText(columns[rows[axis.d]]!)}`).join(' '),
    }));
  });
  plots.push(...two);
  return el('div', { class: 'together' }, el('h3', {}, 'All targets'), el('div', { class: 'controls' }, targets.element, bands.element), ...two.map(({ element }) => element));
}

export function displacement(of: Report, columns: Float64Array[], abscissa: Abscissa): HTMLElement {
  const refused = of.exit_code === 4 && el('p', { class: 'note' }, 'For information only, because no row of this run is reliable.');
  const curves = of.targets.map((target) => kAxes.map((axis) => curvesOf(target, axis, columns)));
  const all = of.targets.length > 1 && together(of, curves, columns, abscissa);
  return section('displacement', 'Displacement', refused, toolbar(abscissa), all,
    ...of.targets.map((target, k) => alone(of, target, curves[k]!, columns, abscissa)));
}
