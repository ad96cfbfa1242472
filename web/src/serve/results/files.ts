// Report and exports of a run, and solving it again with another lens, rest or references.
import { commandText, post, type Entry } from '../api';
import { attempt, button, card, checkbox, commandBox, field, say, sayProblem, select } from '../parts/parts';
import { entries, fileAt, fileOfRun, refreshEntries } from '../store';
import { runJob } from './channels';
import { shownRange, type RunData } from './run_data';
import { save } from '../../download';
import { el } from '../../element';

const kFormats: [string, string, string][] = [['xlsx', 'xlsx', 'Excel'], ['wide', 'csv', 'CSV, one row per frame'], ['mat', 'mat', 'MATLAB'], ['uff58', 'uff', 'UFF'], ['hdf5', 'h5', 'HDF5']];

// Opens the report in its own tab. A server that has no address for it lets the page save it instead.
async function openReport(run: string): Promise<void> {
  try {
    const { url } = await post<{ url: string }>('/api/ticket', { run, name: 'report.html' });
    const link = el('a', { href: url, target: '_blank', rel: 'noopener' });
    link.click();
    document.documentElement.dataset.report = url;
  } catch {
    save(`${run.split('/').pop()}-report.html`, await fileOfRun(run, 'report.html'));
    document.documentElement.dataset.report = 'saved';
  }
}

export function filesCard(run: RunData): HTMLElement {
  const base = run.path.split('/').pop()!;
  const file = (name: string, text: string): HTMLElement => button(text, () => void attempt(async () => save(`${base}-${name}`, await fileOfRun(run.path, name))));
  const command = commandBox();
  const exports = kFormats.map(([format, ending, text]) => {
    const made = button(text, () => void attempt(async () => {
      const output = `${run.path}.${ending}`;
      const args = [run.path, '--format', format, '-o', output, '--replace'];
      command.set(commandText('export', args));
      made.disabled = true;
      await runJob('export', args).finally(() => (made.disabled = false));
      save(output.split('/').pop()!, await fileAt(output));
    }), { class: 'small' });
    return made;
  });
  return card('Report and files', el('div', { class: 'row' }, button('Report', () => void attempt(() => openReport(run.path)), { class: 'primary' }),
    button('Save the report', () => void attempt(async () => save(`${base}-report.html`, await fileOfRun(run.path, 'report.html'))))),
  el('div', { class: 'row' }, file('displacement.csv', 'displacement.csv'), file('overlay.png', 'Picture of the markers')),
  el('p', { class: 'quiet' }, 'For other programs'), el('div', { class: 'row' }, ...exports), command.element);
}

interface RangeChoice {
  element: HTMLElement;
  value: () => string;
}

function rangeChoice(title: string, run: RunData, onChange: () => void): RangeChoice {
  let value = '';
  const text = el('output', {}, 'as before');
  const set = (to: string, words: string): void => {
    value = to;
    text.textContent = words;
    onChange();
  };
  const element = el('div', { class: 'row' }, el('span', { class: 'row-name' }, title),
    button('shown range', () => {
      const range = shownRange(run);
      set(range, range);
    }, { class: 'small', 'aria-label': `${title}: the shown range` }),
    button('none', () => set('none', 'none'), { class: 'small', 'aria-label': `${title}: none` }), text);
  return { element, value: () => value };
}

// `onSolved` gets the folder of the new results.
export function solveCard(run: RunData, entry: Entry, onSolved: (path: string) => void): HTMLElement {
  const command = commandBox();
  const markers = run.summary.markers.filter(({ role }) => role === 'reference' || role === 'target');
  const boxes = markers.map(({ name, role }) => checkbox(name, role === 'reference', () => update()));
  const cameras = entries.flatMap(({ kind, path, run: owner }) => (kind === 'camera' ? [path] : kind === 'run' && path !== run.path ? [`${owner ?? path}/camera.toml`] : []));
  const lens = select([['', 'as before'], ...cameras.map((path): [string, string] => [path, path])], '', () => update(), 'Lens');
  const rest = rangeChoice('Rest', run, () => update());
  const zero = rangeChoice('Zero', run, () => update());
  const keep = checkbox('Keep the present results, write to a new folder', false, () => update());
  const target = (): string => (keep.box.checked ? `${run.path}-2` : run.path);
  const args = (): string[] => {
    const list = [run.path];
    if (lens.value !== '') list.push('--camera', lens.value);
    if (rest.value() !== '') list.push('--rest', rest.value());
    if (zero.value() !== '') list.push('--zero', zero.value());
    const chosen = markers.filter((_marker, k) => boxes[k]!.box.checked).map(({ name }) => name);
    const before = markers.filter(({ role }) => role === 'reference').map(({ name }) => name);
    if (chosen.join() !== before.join()) list.push('--references', chosen.join(','));
    if (keep.box.checked) list.push('-o', target());
    return list;
  };
  const update = (): void => command.set(commandText('solve', args()));
  const act = button('Solve again', () => {
    act.disabled = true;
    void runJob('solve', args()).then(async () => {
      say('Solved again. The video was not needed.');
      await refreshEntries();
      onSolved(target());
    }).catch(sayProblem).finally(() => (act.disabled = false));
  }, { class: 'primary' });
  update();
  return card('Solve again', el('p', { class: 'quiet' }, `In seconds, from the observations of ${entry.name}.`), rest.element, zero.element, field('Lens', lens),
    el('fieldset', { class: 'choices' }, el('legend', {}, 'References'), ...boxes.map(({ element }) => element)), keep.element, act, command.element);
}
