// The folder at the left: clips and runs with picture, state and headline.
import { query, type Entry } from './api';
import { thumbnail, sizeText } from './parts/parts';
import { entries, jobs, on } from './store';
import { el, setText } from '../element';

export const stateWords: Record<Entry['state'], string> = {
  new: 'not measured yet', queued: 'waits for its turn', measuring: 'is measured now', done: 'measured', refused: 'no reliable result', interrupted: 'stopped, can be resumed',
};

const kFilterFrom = 9; // entries that justify a search field

// Runs that belong to a clip of the list are shown with it.
function listed(): Entry[] {
  const owned = new Set(entries.filter(({ kind }) => kind === 'clip' || kind === 'images').map(({ run }) => run));
  return entries.filter(({ kind, path }) => (kind === 'clip' || kind === 'images' || kind === 'run') && !(kind === 'run' && owned.has(path)));
}

function headline(entry: Entry): string {
  const job = [...jobs.values()].reverse().find((one) => one.state === 'running' && one.action === 'measure' && one.run === entry.run && one.frames > 0);
  if (entry.state === 'measuring' && job) return `${Math.round((100 * job.frames_done) / job.frames)} % of ${job.frames} frames`;
  if (entry.headline && (entry.state === 'done' || entry.state === 'refused')) return entry.headline;
  return entry.state === 'new' ? `${stateWords.new}, ${sizeText(entry.bytes)}` : stateWords[entry.state];
}

export class EntryList {
  readonly element: HTMLElement;
  private readonly list = el('ul', { class: 'entries', 'aria-label': 'Clips and runs' });
  private readonly filter = el('input', { type: 'search', placeholder: 'Search', 'aria-label': 'Search clips and runs' });
  private readonly count = el('p', { class: 'quiet' });
  private current = '';

  constructor(private readonly onChoose: (path: string) => void) {
    this.filter.addEventListener('input', () => this.draw());
    this.element = el('nav', { 'aria-label': 'Folder' }, this.filter, this.list, this.count);
    on('entries', () => this.draw());
    on('job', () => this.drawStates());
    this.draw();
  }

  choose(path: string): void {
    this.current = path;
    for (const row of this.list.querySelectorAll<HTMLElement>('button')) {
      if (row.dataset.path === path) row.setAttribute('aria-current', 'true');
      else row.removeAttribute('aria-current');
    }
  }

  private row(entry: Entry): HTMLElement {
    const key = `${entry.path}|${entry.modified_s}`;
    const folder = entry.path.includes('/') ? entry.path.slice(0, entry.path.lastIndexOf('/') + 1) : '';
    const box = el('button', { type: 'button', 'data-path': entry.path },
      thumbnail(query('/api/thumbnail', { path: entry.path }), key),
      el('span', { class: 'entry-text' },
        el('span', { class: 'name' }, folder !== '' && el('span', { class: 'quiet' }, folder), entry.name),
        el('span', { class: `state ${entry.state}` }, headline(entry))));
    if (entry.path === this.current) box.setAttribute('aria-current', 'true');
    box.addEventListener('click', () => this.onChoose(entry.path));
    return el('li', {}, box);
  }

  private draw(): void {
    const all = listed();
    const wanted = this.filter.value.trim().toLowerCase();
    const shown = wanted === '' ? all : all.filter(({ path }) => path.toLowerCase().includes(wanted));
    this.filter.hidden = all.length < kFilterFrom;
    const focused = (document.activeElement as HTMLElement | null)?.dataset.path;
    this.list.replaceChildren(...shown.map((entry) => this.row(entry)));
    if (focused !== undefined) [...this.list.querySelectorAll<HTMLElement>('button')].find(({ dataset }) => dataset.path === focused)?.focus();
    const ready = all.filter(({ state }) => state === 'done').length;
    this.count.textContent = all.length === 0 ? 'The folder holds no clip yet.' : `${all.length} ${all.length === 1 ? 'entry' : 'entries'}, ${ready} measured`;
  }

  // While a clip is measured only its line of text changes.
  private drawStates(): void {
    for (const entry of entries) {
      const row = [...this.list.querySelectorAll<HTMLElement>('button')].find(({ dataset }) => dataset.path === entry.path);
      const state = row?.querySelector('.state');
      if (state && entry.state === 'measuring') setText(state, headline(entry));
    }
  }
}
