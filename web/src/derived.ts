// Channels of `derive`: combinations of targets, with layers that can be switched on and off.
import { abscissaFrom, type Abscissa } from './abscissa';
import { choices } from './choices';
import type { ChannelState, Derived, Report, ValueWithU } from './data';
import { Curve } from './decimate';
import { bandOf, valuesOf, valueText } from './displacement';
import { el, section, table, type Cell } from './element';
import { brief, digitsFor, expanded, plain } from './format';
import { Plot, type Line } from './plot';
import { forget, plots } from './registry';
import { kDashes, kFirstLine, kLines } from './theme';

const kBandsAtFirst = 2; // channels of one unit with bands of U

// Returns the state that has layer `wanted` as it was set and is closest to the present choice.
function closestState(of: Derived, chosen: boolean[], wanted: number): number {
  let best = 0;
  let least = Infinity;
  of.states.forEach(({ on }, k) => {
    const away = on.reduce((sum, is, n) => sum + (is === chosen[n] ? 0 : n === wanted ? 100 : 1), 0);
    if (away < least) [best, least] = [k, away];
  });
  return best;
}

function withU({ value, u }: ValueWithU): Cell {
  if (value === null) return { text: '\u2013', isNumber: true };
  if (u === null) return { text: brief(value), isNumber: true };
  return { text: `${plain(value, digitsFor(expanded(u)))} \u00b1 ${plain(expanded(u), digitsFor(expanded(u)))}`, isNumber: true };
}

function statistics(of: Derived, states: { channel: number; state: ChannelState }[], isBound: boolean): HTMLElement {
  const rows = states.map(({ channel, state }): (string | Cell)[] => [of.channels[channel]!.name, state.unit.replace('um', '\u00b5m'), withU(state.peak_to_peak),
    withU(state.mean), withU(state.rms), withU(state.smallest), withU(state.largest), { text: `${state.ok} of ${state.rows}`, isNumber: true }]);
  return table(`Statistics of the ok rows; \u00b1 is U (k = 2)${isBound ? ', here an upper limit because of the median' : ''}`,
    ['Channel', 'Unit', 'Peak to peak', 'Mean', 'rms about it', 'Smallest', 'Largest', 'Rows'], rows);
}

export function derivedSection(of: Derived, columns: Float64Array[], report: Report, run: Abscissa): HTMLElement {
  const colour = (k: number): number => kFirstLine + (k % kLines);
  const place = el('div', { class: 'chosen', 'aria-live': 'polite' });
  let shown: Plot[] = [];
  let state = closestState(of, of.layers.map(() => true), -1);

  const lineOf = (channel: number, of_channel: ChannelState, hasBand: boolean): Line => {
    const value = columns[of_channel.value]!;
    const u = columns[of_channel.u]!;
    const status = columns[of_channel.status]!;
    const ok = valuesOf(value, status, true);
    const { name } = of.channels[channel]!;
    return {
      label: name, colour: colour(channel), dash: kDashes[Math.floor(channel / kLines) % kDashes.length], curve: new Curve(ok),
      band: bandOf(ok, u), hasBand: () => hasBand, notOk: new Curve(valuesOf(value, status, false)),
      csv: [{ name: `${name}_${of_channel.unit.replaceAll('/', '_per_')}`, values: value }, { name: `u_${name}_${of_channel.unit.replaceAll('/', '_per_')}`, values: u },
        { name: `${name}_status`, values: (k) => report.statuses[status[k]!]?.word ?? '' }],
    };
  };

  const draw = (): void => {
    const { on, frame, time, channels: inState, u_is_bound } = of.states[state]!;
    const abscissa = abscissaFrom(frame === null ? undefined : columns[frame]!, time === null ? undefined : columns[time]!, run.zoom)!;
    const used = inState.map((one, channel) => ({ channel, state: one })).filter(({ channel }) => boxes.isOn(channel));
    const units = [...new Set(used.map((one) => one.state.unit))];
    const done = of.layers.filter((_layer, k) => on[k]);
    forget(shown);
    shown = units.map((unit) => {
      const mine = used.filter((one) => one.state.unit === unit);
      const names = mine.map(({ channel }) => of.channels[channel]!.name).join(', ');
      const shownUnit = unit.replace('um', '\u00b5m');
      return new Plot({
        title: names, fullTitle: `${names}${done.length > 0 ? ` (${done.join(', ')})` : ''}`, name: ['channels', ...mine.map(({ channel }) => of.channels[channel]!.name)].join('-').slice(0, 80), height: 230,
        abscissa: abscissa.label, ordinate: shownUnit, x: abscissa.x, zoom: run.zoom, csvBefore: abscissa.csv,
        lines: mine.map(({ channel, state: one }) => lineOf(channel, one, mine.length <= kBandsAtFirst)),
        readout: (k) => `${abscissa.at(k)}: ${mine.map(({ channel, state: one }) =>
          `${of.channels[channel]!.name} ${valueText(columns[one.value]![k]!, columns[one.u]![k]!, shownUnit)}`).join(', ')}`,
        description: mine.map(({ channel, state: one }) => `${of.channels[channel]!.name}: peak to peak ${one.peak_to_peak.value === null ? 'unknown' : brief(one.peak_to_peak.value)} ${unit}`).join('; '),
      });
    });
    plots.push(...shown);
    place.replaceChildren(...(used.length > 0 ? [...shown.map(({ element }) => element), statistics(of, used, u_is_bound)] : [el('p', {}, 'No channel is chosen.')]));
  };

  const boxes = choices('Channels', of.channels.map(({ name, expression }, k) => ({ label: name, isOn: true, colour: colour(k), title: expression })), draw, of.channels.length > 2);
  const layers = choices('Layers, applied from left to right', of.layers.map((label) => ({ label, isOn: true })), (clicked) => {
    state = closestState(of, of.layers.map((_layer, k) => layers.isOn(k)), clicked);
    of.states[state]!.on.forEach((on, k) => layers.set(k, on));
    draw();
  });
  of.states[state]!.on.forEach((on, k) => layers.set(k, on));
  draw();
  return section('derived', 'Channels', el('p', { class: 'small' }, ...of.channels.flatMap(({ name, expression }, k) =>
    [k > 0 ? '; ' : '', el('b', {}, name), ` = ${expression}`]), '. Each value has its own U, from the joint covariance of all targets (derive).'),
    el('div', { class: 'controls' }, boxes.element, of.layers.length > 0 && layers.element), place);
}
