// The common abscissa of all plots over time: time where there is one and it goes forward, else the frame's number.
import type { Report } from './data';
import type { CsvColumn } from './download';
import { el } from './element';
import { brief, plain } from './format';
import { Zoom } from './zoom';

export interface Abscissa {
  x: Float64Array;
  label: string;
  zoom: Zoom;
  at: (index: number) => string;
  csv: CsvColumn[]; // the first columns of every file
}

export function abscissaOf(of: Report, columns: Float64Array[]): Abscissa | undefined {
  if (of.frame === null) return undefined;
  return abscissaFrom(columns[of.frame]!, of.time === null ? undefined : columns[of.time]!);
}

// `zoom`: that of the page, for rows other than the run's frames.
export function abscissaFrom(frame: Float64Array | undefined, time: Float64Array | undefined, shared?: Zoom): Abscissa | undefined {
  const x = time ?? frame;
  if (!x || x.length === 0) return undefined;
  const first = x[0]!;
  const last = x[x.length - 1]!;
  const step = x.length > 1 ? (last - first) / (x.length - 1) : 1;
  const zoom = shared ?? (x.length > 1 ? new Zoom(first, last, 4 * step) : new Zoom(first - 0.5, last + 0.5, 1));
  const digits = Math.max(2, Math.min(4, Math.ceil(-Math.log10(step || 1)) + 1));
  const at = (k: number): string => (!time ? `frame ${frame![k]}` : `${plain(time[k]!, digits)} s${frame ? ` (frame ${frame[k]})` : ''}`);
  const csv: CsvColumn[] = [];
  if (frame) csv.push({ name: 'frame', values: frame });
  if (time) csv.push({ name: 'time_s', values: time });
  return { x, zoom, label: time ? 'Time (s)' : 'Frame', at, csv };
}

export function toolbar(abscissa: Abscissa): HTMLElement {
  const { zoom, label } = abscissa;
  const shown = el('output', { class: 'shown', 'aria-live': 'polite' });
  const say = (): void => {
    shown.textContent = zoom.isWhole ? 'the whole record is shown' : `${brief(zoom.min)} to ${brief(zoom.max)} ${label.startsWith('Time') ? 's' : ''}`;
  };
  zoom.watch(say);
  say();
  const button = (text: string, name: string, act: () => void): HTMLElement => {
    const b = el('button', { type: 'button', 'aria-label': name, title: name }, text);
    b.addEventListener('click', act);
    return b;
  };
  return el('div', { class: 'toolbar', role: 'toolbar', 'aria-label': 'Range of the plots' },
    button('\u2190', 'Earlier', () => zoom.pan(-0.5)), button('\u2192', 'Later', () => zoom.pan(0.5)),
    button('+', 'Zoom in', () => zoom.by(0.5)), button('\u2212', 'Zoom out', () => zoom.by(2)),
    button('All', 'Show all', () => zoom.all()), shown,
    el('span', { class: 'hint' }, 'Drag to zoom, Shift + drag to move, double-click to show all. After a click: wheel, keys + \u2212 \u2190 \u2192 0'));
}
