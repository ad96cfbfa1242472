// The screen of one clip or run: set up, measure, results.
import { startJob, type Entry } from './api';
import { MeasuringView, jobOf } from './measuring';
import { ResultsView } from './results/results';
import { SetupView } from './setup/setup';
import { runOf } from './setup/state';
import { entryAt, jobs, refreshEntries, setJob } from './store';
import { stateWords } from './entries';
import { el } from '../element';

export type Step = 'setup' | 'measure' | 'results';

const kSteps: [Step, string][] = [['setup', 'Set up'], ['measure', 'Measure'], ['results', 'Results']];

interface View {
  element: HTMLElement;
  leave(): void;
  remake?(): void;
}

export class ClipScreen {
  readonly element: HTMLElement;
  private readonly tabs: HTMLButtonElement[];
  private readonly body = el('div', { class: 'step', role: 'tabpanel', id: 'step', tabindex: '-1' });
  private readonly badge = el('span', { class: 'badge' });
  private view?: View;
  private step: Step = 'setup';

  constructor(private entry: Entry, step: Step | undefined, private readonly onStep: (step: Step) => void) {
    this.tabs = kSteps.map(([name, text], k) => {
      const tab = el('button', { type: 'button', role: 'tab', id: `tab-${name}`, 'aria-controls': 'step' }, el('span', { class: 'step-number', 'aria-hidden': 'true' }, String(k + 1)), text);
      tab.addEventListener('click', () => this.open(name));
      tab.addEventListener('keydown', (event) => this.arrow(event, k));
      return tab;
    });
    const isRun = entry.kind === 'run';
    this.tabs.slice(0, 2).forEach((tab) => (tab.hidden = isRun));
    this.element = el('article', { class: 'clip' }, el('header', { class: 'clip-head' }, el('h2', {}, entry.name), this.badge,
      el('div', { class: 'tabs', role: 'tablist', 'aria-label': 'Steps' }, ...this.tabs)), this.body);
    this.open(step ?? this.firstStep());
  }

  get path(): string {
    return this.entry.path;
  }

  leave(): void {
    this.view?.leave();
  }

  remake(): void {
    this.view?.remake?.();
  }

  // The folder has changed.
  refresh(): void {
    const now = entryAt(this.entry.path);
    if (!now) return;
    this.entry = Object.assign(this.entry, now);
    if (!now.run) delete this.entry.run;
    this.drawHead();
  }

  private get run(): string | undefined {
    return this.entry.kind === 'run' ? this.entry.path : this.entry.run;
  }

  private firstStep(): Step {
    if (this.entry.kind === 'run') return 'results';
    const job = jobOf(this.entry, runOf(this.entry.path)); // the entry's state follows it some moments later
    if (job?.state === 'running' || job?.state === 'queued') return 'measure';
    if (this.entry.state === 'done') return 'results';
    if (this.entry.state === 'measuring' || this.entry.state === 'queued' || this.entry.state === 'interrupted') return 'measure';
    return 'setup';
  }

  private arrow(event: KeyboardEvent, k: number): void {
    const by = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    const next = this.tabs[k + by];
    if (by === 0 || !next || next.hidden || next.disabled) return;
    next.focus();
    next.click();
  }

  private drawHead(): void {
    this.badge.className = `badge ${this.entry.state}`;
    this.badge.textContent = stateWords[this.entry.state];
    kSteps.forEach(([name], k) => {
      const tab = this.tabs[k]!;
      tab.setAttribute('aria-selected', String(name === this.step));
      tab.tabIndex = name === this.step ? 0 : -1;
    });
    this.tabs[2]!.disabled = this.run === undefined;
  }

  open(step: Step): void {
    this.view?.leave();
    this.step = step === 'results' && this.run === undefined ? 'setup' : step;
    this.view = this.viewOf(this.step);
    this.body.replaceChildren(this.view.element);
    this.body.setAttribute('aria-labelledby', `tab-${this.step}`);
    document.documentElement.dataset.step = this.step;
    this.drawHead();
    this.onStep(this.step);
  }

  private viewOf(step: Step): View {
    if (step === 'results') return new ResultsView(this.entry, this.run!);
    if (step === 'measure')
      return new MeasuringView(this.entry, jobOf(this.entry, runOf(this.entry.path))?.id, () => void this.showResults(), () => this.open('setup'));
    return new SetupView(this.entry, (args) => this.measure(args));
  }

  private async measure(args: string[]): Promise<void> {
    const run = runOf(this.entry.path);
    const { id, command } = await startJob('measure', args);
    if (!jobs.has(id)) setJob({ id, action: 'measure', command, state: 'queued', exit_code: null, run, frames_done: 0, frames: 0, seconds: 0, lines: [] });
    jobs.get(id)!.run ??= run;
    if (this.step === 'setup') this.open('measure');
  }

  private async showResults(): Promise<void> {
    await refreshEntries().catch(() => undefined);
    this.refresh();
    if (this.run === undefined) this.entry.run = runOf(this.entry.path);
    if (this.step === 'measure') this.open('results');
  }
}
