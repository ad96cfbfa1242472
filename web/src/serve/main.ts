// The page of `moiregauge serve`: folder at the left, the chosen clip at the right.
import 'uplot/dist/uPlot.min.css';
import './serve.css';
import { BatchView } from './batch';
import { ClipScreen, type Step } from './clip';
import { EntryList } from './entries';
import { LiveView } from './live';
import { keepSamples } from './measuring';
import { button, sayProblem } from './parts/parts';
import { connect, entries, entryAt, jobs, on, session } from './store';
import { Uploads } from './upload';
import { el, setText } from '../element';

interface Screen {
  element: HTMLElement;
  leave(): void;
  remake?(): void;
  refresh?(): void;
}

type Place = { view: 'clip'; path: string; step?: Step } | { view: 'live' } | { view: 'batch' } | { view: 'none' };

const kThemeKey = 'moiregauge-theme';
const kThemes = ['auto', 'light', 'dark'] as const;
const kThemeWords = { auto: 'Light or dark as the system', light: 'Light', dark: 'Dark' };
const dark = matchMedia('(prefers-color-scheme: dark)');
const stage = el('main', { id: 'main', tabindex: '-1' });
const queueState = el('span', { class: 'queue', role: 'status' });
const connection = el('span', { class: 'connection', role: 'status' });
let screen: Screen | undefined;
let place: Place = { view: 'none' };
let list: EntryList;

function chosenTheme(): (typeof kThemes)[number] {
  const stored = localStorage.getItem(kThemeKey);
  return kThemes.find((name) => name === stored) ?? 'auto';
}

function applyTheme(): void {
  const chosen = chosenTheme();
  document.documentElement.dataset.theme = chosen === 'auto' ? (dark.matches ? 'dark' : 'light') : chosen;
  screen?.remake?.();
}

function themeSwitch(): HTMLElement {
  const made = button('', () => {
    localStorage.setItem(kThemeKey, kThemes[(kThemes.indexOf(chosenTheme()) + 1) % kThemes.length]!);
    draw();
    applyTheme();
  }, { class: 'quiet', id: 'theme' });
  const draw = (): void => {
    made.textContent = { auto: '\u25d0', light: '\u2600', dark: '\u263e' }[chosenTheme()];
    made.setAttribute('aria-label', `Colours: ${kThemeWords[chosenTheme()]}. Change`);
    made.title = kThemeWords[chosenTheme()];
  };
  draw();
  return made;
}

function addressOf(to: Place): string {
  if (to.view === 'clip') return `#${new URLSearchParams({ entry: to.path, ...(to.step && { step: to.step }) })}`;
  return to.view === 'none' ? '#' : `#view=${to.view}`;
}

function placeOf(address: string): Place {
  const given = new URLSearchParams(address.replace(/^#/, ''));
  const path = given.get('entry');
  if (path !== null) return { view: 'clip', path, step: (given.get('step') ?? undefined) as Step | undefined };
  const view = given.get('view');
  return view === 'live' || view === 'batch' ? { view } : { view: 'none' };
}

function screenOf(to: Place): Screen {
  if (to.view === 'live') return new LiveView();
  if (to.view === 'batch') return new BatchView((path) => go({ view: 'clip', path: entries.find(({ run, kind }) => run === path && kind !== 'run')?.path ?? path, step: 'results' }));
  const entry = to.view === 'clip' ? entryAt(to.path) : undefined;
  if (to.view === 'clip' && entry) {
    return new ClipScreen({ ...entry }, to.step, (step) => {
      place = { ...to, step };
      history.replaceState(null, '', addressOf(place));
    });
  }
  return { element: welcome(), leave: () => undefined };
}

function welcome(): HTMLElement {
  const step = (title: string, text: string): HTMLElement => el('li', {}, el('strong', {}, title), el('span', {}, text));
  return el('article', { class: 'welcome' }, el('h2', {}, 'Displacement from video of printed gratings'),
    el('p', {}, 'Every value has its uncertainty. Everything stays on this computer.'),
    el('ol', {}, step('Drop a clip', 'anywhere on this page. It is stored in the folder.'), step('Check one distance', 'with a tape. It proves the pitch of the prints.'),
      step('Measure', 'and read the result, its plots and its report.')));
}

function go(to: Place, isBack = false): void {
  screen?.leave();
  place = to;
  document.documentElement.dataset.view = to.view;
  if (!isBack) history.pushState(null, '', addressOf(to));
  screen = screenOf(to);
  stage.replaceChildren(screen.element);
  stage.scrollTop = 0;
  list.choose(to.view === 'clip' ? to.path : '');
  document.querySelectorAll<HTMLElement>('[data-view-button]').forEach((one) => one.setAttribute('aria-pressed', String(one.dataset.viewButton === to.view)));
}

function drawQueue(): void {
  const all = [...jobs.values()];
  const running = all.filter(({ state }) => state === 'running').length;
  const waiting = all.filter(({ state }) => state === 'queued').length;
  setText(queueState, running + waiting === 0 ? '' : `${running} running${waiting > 0 ? `, ${waiting} waiting` : ''}`);
}

function build(): void {
  list = new EntryList((path) => go({ view: 'clip', path }));
  const uploads = new Uploads((names) => {
    const tops = names.map((name) => entries.find(({ path, kind }) => path === name && kind === 'clip') ?? entries.find(({ path, kind }) => kind === 'images' && name.startsWith(`${path}/`)));
    const first = tops.find((entry) => entry !== undefined);
    if (tops.filter((entry) => entry !== undefined).length > 1 && new Set(tops).size > 1) go({ view: 'batch' });
    else if (first) go({ view: 'clip', path: first.path });
  });
  const viewButton = (view: 'live' | 'batch', text: string): HTMLElement => button(text, () => go({ view }), { 'data-view-button': view, 'aria-pressed': 'false' });
  const header = el('header', { class: 'top' }, button('\u2039 Folder', () => go({ view: 'none' }), { class: 'quiet back' }),
    el('div', { class: 'brand' }, el('span', { class: 'mark', 'aria-hidden': 'true' }), el('h1', {}, 'moiregauge'), el('span', { class: 'folder', title: session.folder }, session.folder)),
    connection, queueState, themeSwitch());
  const side = el('aside', { class: 'side', 'aria-label': 'Clips and runs' }, uploads.element, list.element,
    el('div', { class: 'side-foot' }, viewButton('batch', 'Table of runs'), viewButton('live', 'Live')));
  document.body.replaceChildren(el('a', { class: 'skip', href: '#main' }, 'Skip to the chosen clip'), header, side, stage);
  document.querySelector<HTMLElement>('.skip')!.addEventListener('click', (event) => {
    event.preventDefault();
    stage.focus();
  });
}

async function begin(): Promise<void> {
  const asked = placeOf(location.hash);
  applyTheme();
  await connect();
  build();
  keepSamples();
  dark.addEventListener('change', applyTheme);
  on('job', drawQueue);
  on('entries', () => screen?.refresh?.());
  on('connection', (isOpen) => (connection.textContent = isOpen ? '' : 'The server does not answer'));
  addEventListener('popstate', () => go(placeOf(location.hash), true));
  document.addEventListener('show-entry', (event) => go({ view: 'clip', path: (event as CustomEvent<string>).detail }));
  document.title = `moiregauge: ${session.folder.split('/').pop()}`;
  drawQueue();
  go(asked, true);
  document.documentElement.dataset.state = 'ready';
}

begin().catch((problem: unknown) => {
  sayProblem(problem);
  document.documentElement.dataset.state = 'failed';
});
