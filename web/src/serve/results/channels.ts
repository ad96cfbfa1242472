// Derived channels and layers, and the comparison with another sensor: both are jobs of the program, shown when they end.
import { commandText, startJob } from '../api';
import { button, card, checkbox, commandBox, field, say, sayProblem, select } from '../parts/parts';
import { fileOfRun, finished } from '../store';
import { sendFile } from '../upload';
import { readCsv, shownRange, type RunData } from './run_data';
import { statusIndex } from './statuses';
import { comparisonSection } from '../../comparison';
import type { Comparison, Derived } from '../../data';
import { derivedSection } from '../../derived';
import { el } from '../../element';

// A name with other characters than letters, digits and _ needs quotes in an expression.
const quoted = (name: string): string => (/^[A-Za-z_]\w*$/.test(name) ? name : `"${name}"`);

// Runs a job to its end. A failure is an Error with the program's last line.
export async function runJob(action: string, args: string[]): Promise<void> {
  const { id } = await startJob(action, args);
  const job = await finished(id);
  if (job.state === 'done') return;
  const line = [...job.lines].reverse().find((text) => text.startsWith('error: ')) ?? job.lines[job.lines.length - 1];
  throw new Error(line?.replace(/^error: /, '') ?? `The command ended with exit code ${job.exit_code}.`);
}

async function loadDerived(run: RunData): Promise<HTMLElement> {
  const facts = JSON.parse(await (await fileOfRun(run.path, 'derived.json')).text()) as {
    layers: string[]; u_is_bound: boolean;
    channels: ({ name: string; expression: string; column: string } & Omit<Derived['states'][0]['channels'][0], 'value' | 'u' | 'status'>)[];
  };
  const csv = await readCsv(await fileOfRun(run.path, 'derived.csv'));
  const columns: Float64Array[] = [];
  const add = (values: Float64Array): number => columns.push(values) - 1;
  const numbers = (name: string): Float64Array => csv.get(name) as Float64Array;
  const frame = add(numbers('frame'));
  const time = run.hasTime ? add(numbers('time_s')) : null;
  const channels = facts.channels.map((channel) => ({
    ...channel, value: add(numbers(channel.column)), u: add(numbers(`u_${channel.column}`)),
    status: add(Float64Array.from((csv.get(`${channel.name}_status`) ?? []) as string[], statusIndex)),
  }));
  const isEven = columns[frame]!.every((value) => !Number.isNaN(value));
  const of: Derived = { layers: [], channels: facts.channels, states: [{ on: [], u_is_bound: facts.u_is_bound, frame: isEven ? frame : null, time, channels }], columns: [], samples: '' };
  const section = derivedSection(of, columns, run.report, run.abscissa!);
  if (facts.layers.length > 0) section.querySelector('h2')?.append(el('span', { class: 'quiet' }, ` after ${facts.layers.join(', ')}`));
  return section;
}

async function loadComparison(run: RunData): Promise<HTMLElement> {
  const facts = JSON.parse(await (await fileOfRun(run.path, 'comparison/comparison.json')).text()) as Comparison;
  const csv = await readCsv(await fileOfRun(run.path, 'comparison/comparison.csv'));
  const columns = ['time_s', 'moiregauge', 'reference', 'u'].map((name) => csv.get(name) as Float64Array);
  return comparisonSection({ ...facts, rows: { time: 0, moiregauge: 1, reference: 2, u: 3 } }, columns, run.abscissa!);
}

export type Show = (id: 'derived' | 'comparison', section: HTMLElement) => void;

const kSuggestions = 6;

function suggestions(names: string[]): [string, string][] {
  const list: [string, string][] = [];
  const [a, b, c] = names.map(quoted);
  if (a && b) list.push(['difference', `difference = ${b}.dy - ${a}.dy`], ['tilt', `tilt = rotation(${a}, ${b})`], ['strain', `strain = strain(${a}, ${b})`]);
  if (a && b && c) list.push(['sag', `sag = sag(${a}, ${b}, ${c})`], ['mean', `mean = mean(${[a, b, c].map((name) => `${name}.dy`).join(', ')})`]);
  names.slice(0, 3).forEach((name) => list.push([`${name} rotation`, `${name.replace(/\W/g, '_')}_rotation = ${quoted(name)}.rotation`]));
  return list.slice(0, kSuggestions);
}

// Channels with layers. Without an expression every target's dx and dy are the channels.
export function layersCard(run: RunData, show: Show): HTMLElement {
  const names = run.targets.map(({ name }) => name);
  const text = el('textarea', { rows: '2', 'aria-label': 'Channels, one expression per line', placeholder: 'dx and dy of every target', spellcheck: 'false' });
  const addButtons = suggestions(names).map(([label, expression]) => button(label, () => {
    text.value = `${text.value.trimEnd()}${text.value.trim() ? '\n' : ''}${expression}`;
    update();
  }, { class: 'small', title: expression }));
  const range = { zero: '' };
  const zeroText = el('output', {}, 'none');
  const detrend = checkbox('Remove the straight line', false, () => update());
  const frequency = el('input', { type: 'text', inputmode: 'decimal', value: '5', 'aria-label': 'Frequency of the filter in Hz' });
  const filter = select([['', 'no filter'], ['lowpass', 'low pass'], ['highpass', 'high pass'], ['velocity', 'velocity']], '', () => update(), 'Filter');
  const command = commandBox();
  const args = (): string[] => {
    const lines = text.value.split('\n').map((line) => line.trim()).filter((line) => line !== '');
    const channels = lines.length > 0 ? lines : names.flatMap((name) => ['dx', 'dy'].map((axis) => `${name.replace(/\W/g, '_')}_${axis} = ${quoted(name)}.${axis}`));
    const list = [run.path, ...channels.flatMap((line) => ['--channel', line])];
    if (range.zero !== '') list.push('--zero', range.zero);
    if (detrend.box.checked) list.push('--detrend');
    if (filter.value === 'velocity') list.push('--velocity', `${frequency.value}Hz`);
    else if (filter.value !== '') list.push('--filter', `${filter.value}:${frequency.value}Hz`);
    return list;
  };
  const update = (): void => command.set(commandText('derive', args()));
  const apply = button('Show channels', () => {
    apply.disabled = true;
    void runJob('derive', args()).then(() => loadDerived(run)).then((section) => show('derived', section)).catch(sayProblem).finally(() => (apply.disabled = false));
  }, { class: 'primary' });
  text.addEventListener('input', update);
  frequency.addEventListener('input', update);
  update();
  return card('Channels and layers', text, el('div', { class: 'row' }, ...addButtons),
    el('div', { class: 'row' }, el('span', {}, 'Zero'), button('shown range', () => {
      range.zero = shownRange(run);
      zeroText.textContent = range.zero;
      update();
    }, { class: 'small', 'aria-label': 'Zero is the mean over the shown range' }), button('none', () => {
      range.zero = '';
      zeroText.textContent = 'none';
      update();
    }, { class: 'small', 'aria-label': 'No zero' }), zeroText),
    detrend.element, el('div', { class: 'row' }, filter, frequency, el('span', { class: 'unit' }, 'Hz')), apply, command.element);
}

// The record of another sensor: dropped or chosen, aligned by `compare`.
export function sensorCard(run: RunData, tables: string[], show: Show): HTMLElement {
  const channels = run.targets.flatMap(({ name }) => [`${quoted(name)}.dy`, `${quoted(name)}.dx`]);
  let reference = tables[0] ?? '';
  const channel = select(channels.map((name) => [name, name]), channels[0] ?? '', () => update(), 'Channel to compare');
  const column = el('input', { type: 'text', value: '2', 'aria-label': 'Column of the values' });
  const unit = select(['mm', 'cm', 'm', 'um', 'in'].map((name) => [name, name]), 'mm', () => update(), 'Unit of the values');
  const sign = checkbox('opposite direction', false, () => update());
  const name = el('output', {}, reference || 'no file yet');
  const chooser = el('input', { type: 'file', accept: '.csv,.txt,text/csv', hidden: '', 'aria-label': 'Record of the sensor' });
  const command = commandBox();
  const args = (): string[] => {
    const list = [run.path, reference, '--channel', channel.value];
    if (column.value !== '2') list.push('--column', column.value);
    if (unit.value !== 'mm') list.push('--unit', unit.value);
    if (sign.box.checked) list.push('--sign', '-1');
    return list;
  };
  const update = (): void => {
    command.set(reference ? commandText('compare', args()) : '');
    align.disabled = reference === '';
  };
  const align = button('Align and compare', () => {
    align.disabled = true;
    void runJob('compare', args()).then(() => loadComparison(run)).then((section) => show('comparison', section)).catch(sayProblem).finally(() => (align.disabled = false));
  }, { class: 'primary' });
  const take = (file: File): void => {
    void sendFile(file).then((stored) => {
      reference = stored;
      name.textContent = stored;
      update();
      say(`${stored} is stored in the folder.`);
    }).catch(sayProblem);
  };
  chooser.addEventListener('change', () => {
    if (chooser.files?.[0]) take(chooser.files[0]);
  });
  const drop = el('div', { class: 'drop slim' }, el('span', {}, 'Drop the record of an LVDT or laser (CSV)'), button('Choose a file', () => chooser.click(), { class: 'small' }), chooser);
  drop.addEventListener('drop', (event) => {
    event.preventDefault();
    event.stopPropagation();
    document.documentElement.classList.remove('dropping');
    const file = event.dataTransfer?.files[0];
    if (file) take(file);
  });
  const body = card('Another sensor', drop, el('div', { class: 'row' }, name), field('Channel', channel),
    el('div', { class: 'row' }, field('Column', column), unit, sign.element), align, command.element);
  if (tables.length > 0) drop.after(field('or a file of the folder', select([...tables.map((path): [string, string] => [path, path])], reference, (value) => {
    reference = value;
    name.textContent = value;
    update();
  }, 'File of the folder')));
  column.addEventListener('input', update);
  update();
  return body;
}
