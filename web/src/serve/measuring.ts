// A measurement while it runs: progress, growing curves, the frame just measured, messages, cancel and resume.
import { picture, post, query, type Entry, type Job } from './api';
import { attempt, button, commandBox, showBlob } from './parts/parts';
import { GrowingChart } from './parts/chart';
import { jobs, on, type Row, type ViewEvent } from './store';
import { duration } from '../format';
import { el, setText } from '../element';

const kStates: Record<Job['state'], string> = { queued: 'Waits for its turn', running: 'Measuring', done: 'Measured', failed: 'Not measured', cancelled: 'Stopped' };
const kPicture_ms = 700; // least time between two pictures
// The same, relative to the time that a picture takes. A frame is decoded from the key frame before it, which would slow the
// measurement if it were done all the time.
const kPause = 20;
const kTexts_ms = 500; // between two changes of the numbers. The curves grow faster, but numbers have to be read
const kOkStatus = 0;

// Rows of jobs, kept so that a view that opens later shows the whole curve.
interface Frame {
  x: number;
  hasTime: boolean;
  rows: { name: string; row: Row }[];
}

type Frames = Map<number, Frame>;
const rows = new Map<string, Frames>();
const kMaxKept = 20000; // frames of one job

export function keepSamples(): void {
  on('samples', ({ id, marker }) => {
    const kept = rows.get(id) ?? new Map();
    rows.set(id, kept);
    for (const [name, list] of Object.entries(marker)) {
      for (const row of list) {
        const [frame, time_s] = row;
        const known: Frame = kept.get(frame) ?? { x: time_s ?? frame, hasTime: time_s !== null, rows: [] };
        known.rows = [...known.rows.filter((one) => one.name !== name), { name, row }]; // a stream that opens again repeats rows
        kept.set(frame, known);
      }
    }
    while (kept.size > kMaxKept) kept.delete(kept.keys().next().value!);
  });
}

// Returns a homography of image points as a CSS transform of an image that is shown at `scale`.
function transformOf([a, b, c, d, e, f, g, h, i]: number[], scale: number): string {
  const columns = [a!, d!, 0, g! / scale, b!, e!, 0, h! / scale, 0, 0, 1, 0, c! * scale, f! * scale, 0, i!];
  return `matrix3d(${columns.map((value) => (value / i!).toFixed(12)).join(',')})`;
}

// The newest measurement of a clip.
export function jobOf(entry: Entry, run: string): Job | undefined {
  return [...jobs.values()].reverse().find((job) => job.action === 'measure' && (job.run === run || job.run === entry.run));
}

export class MeasuringView {
  readonly element: HTMLElement;
  private readonly state = el('h3', { role: 'status', 'aria-live': 'polite' });
  private readonly bar = el('progress', { max: '1', value: '0', 'aria-label': 'Progress of the measurement' });
  private readonly facts = el('p', { class: 'facts' });
  private readonly actions = el('div', { class: 'row' });
  private readonly image = el('img', { class: 'small-picture', alt: 'The frame that was measured last' });
  private readonly isStill = el('input', { type: 'checkbox', checked: '' });
  private readonly pictureNote = el('figcaption', { class: 'quiet' });
  private view: ViewEvent | undefined;
  private readonly log = el('pre', { class: 'log', tabindex: '0', 'aria-label': 'Messages' });
  private readonly command = commandBox();
  private charts: GrowingChart[] = [];
  private readonly stops: (() => void)[] = [];
  private lastDrawn = -1; // frame
  private notOk = 0;
  private nextPicture = 0;
  private nextTexts = 0;
  private isFetching = false;

  constructor(private readonly entry: Entry, private id: string | undefined, private readonly onDone: () => void, private readonly onAgain: () => void) {
    this.element = el('div', { class: 'measuring' });
    this.stops.push(on('job', (job) => {
      if (job.id !== this.id) return;
      const wasRunning = this.element.dataset.state === 'running' || this.element.dataset.state === 'queued';
      this.draw(job);
      if (wasRunning && job.state === 'done') this.onDone();
    }));
    this.stops.push(on('view', (event) => {
      if (event.id === this.id) this.view = event;
    }));
    this.isStill.addEventListener('change', () => {
      this.nextPicture = 0;
    });
    this.stops.push(on('samples', (event) => {
      if (event.id === this.id) this.grow();
    }));
    this.show();
  }

  leave(): void {
    this.stops.forEach((stop) => stop());
    this.charts.forEach((chart) => chart.remove());
  }

  remake(): void {
    this.charts.forEach((chart) => chart.remake());
  }

  private show(): void {
    const job = this.id === undefined ? undefined : jobs.get(this.id);
    if (!job) {
      this.element.replaceChildren(el('p', { class: 'empty-note' }, 'This clip is not being measured. Set it up, then choose Measure.'));
      return;
    }
    this.element.replaceChildren(el('div', { class: 'progress-card card' }, el('div', { class: 'progress-head' }, this.state, this.actions), this.bar, this.facts, this.command.element),
      el('div', { class: 'growing-row' }, el('div', { class: 'curves card' }), el('div', {},
        el('figure', { class: 'card side-picture' }, el('div', { class: 'picture-window' }, this.image), el('label', { class: 'check' }, this.isStill, 'Without the camera\u2019s motion'), this.pictureNote),
        el('p', { class: 'quiet' }, 'Values are provisional. The final ones follow when all frames are measured.'))),
      el('details', { class: 'card' }, el('summary', {}, 'Messages'), this.log));
    this.grow();
    this.draw(job);
  }

  private grow(): void {
    const kept = this.id === undefined ? undefined : rows.get(this.id);
    if (!kept || kept.size === 0) return;
    const all = [...kept].filter(([frame]) => frame > this.lastDrawn);
    if (all.length === 0) return;
    if (this.charts.length === 0) {
      const { hasTime } = all[0]![1];
      this.charts = [new GrowingChart('dx', 'dx, right is positive', hasTime), new GrowingChart('dy', 'dy, up is positive', hasTime)];
      this.element.querySelector('.curves')?.append(...this.charts.map(({ element }) => element));
    }
    for (const [frame, { x, rows: list }] of all) {
      this.lastDrawn = frame;
      this.charts.forEach((chart, k) => chart.add(x, list.map(({ name, row }) => ({ name, value: row[2 + k] as number | null, u: row[4 + k] as number | null, status: row[6] }))));
      if (list.some(({ row }) => row[6] !== kOkStatus)) ++this.notOk;
    }
  }

  private draw(job: Job): void {
    if (this.element.dataset.state !== job.state || performance.now() >= this.nextTexts) this.write(job);
    if (job.state === 'running') void this.showFrame(job.frames_done);
  }

  private write(job: Job): void {
    this.nextTexts = performance.now() + kTexts_ms;
    this.element.dataset.state = job.state;
    setText(this.state, kStates[job.state]);
    const share = job.frames > 0 ? job.frames_done / job.frames : 0;
    this.bar.value = job.state === 'done' ? 1 : share;
    const rate = job.seconds > 0 ? job.frames_done / job.seconds : 0;
    const left = job.state === 'running' && rate > 0 && job.frames > job.frames_done ? `about ${duration(Math.ceil((job.frames - job.frames_done) / rate))} left` : '';
    const parts = [job.frames > 0 ? `${job.frames_done} of ${job.frames} frames` : '', rate > 0 ? `${rate.toFixed(0)} frames/s` : '', left,
      this.notOk > 0 ? `${this.notOk} frames not ok` : '', job.state === 'failed' ? `exit code ${job.exit_code}` : ''];
    this.facts.replaceChildren(...parts.filter((text) => text !== '').map((text) => el('span', {}, text)));
    setText(this.log, job.lines.join('\n'));
    this.command.set(job.command);
    if (job.state === 'failed') this.element.querySelector('details')?.setAttribute('open', '');
    this.drawActions(job);
  }

  private drawActions(job: Job): void {
    const wanted = job.state === 'running' || job.state === 'queued' ? 'cancel' : job.state === 'cancelled' ? 'resume' : job.state;
    if (this.actions.dataset.kind === wanted) return;
    this.actions.dataset.kind = wanted;
    const act = (verb: string): (() => void) => () => void attempt(async () => {
      const { id } = await post<{ id?: string }>(`/api/jobs/${encodeURIComponent(job.id)}/${verb}`);
      if (id === undefined || id === this.id) return;
      this.id = id; // a resumed run is a job of its own
      const next = jobs.get(id);
      if (next) this.draw(next);
    });
    this.actions.replaceChildren(...(wanted === 'cancel' ? [button('Stop', act('cancel'), { title: 'The run can be resumed' })]
      : wanted === 'resume' ? [button('Resume', act('resume'), { class: 'primary' }), button('Change the set-up', this.onAgain)]
        : wanted === 'done' ? [button('Show the results', this.onDone, { class: 'primary' })] : [button('Change the set-up', this.onAgain, { class: 'primary' })]));
  }

  // A frame that was measured moments ago. Only one request at a time, and pauses between them.
  private async showFrame(frame: number): Promise<void> {
    if (this.isFetching || performance.now() < this.nextPicture || this.entry.kind === 'run') return;
    this.isFetching = true;
    const begin = performance.now();
    try {
      const view = this.view ?? { frame: Math.max(0, frame - 1), reference_from_frame: null };
      const shown = await picture(query('/api/frame', { path: this.entry.path, frame: view.frame, max_width: 480 }));
      await showBlob(this.image, shown.blob);
      const map = this.isStill.checked ? view.reference_from_frame : null;
      this.image.style.transform = map ? transformOf(map, this.image.clientWidth / shown.width) : '';
      this.pictureNote.textContent = `Frame ${view.frame}${map ? ', references in their places' : this.isStill.checked ? ', as filmed: the references are not seen' : ', as filmed'}`;
    } catch {
      // The next event tries again.
    }
    this.nextPicture = begin + Math.max(kPicture_ms, kPause * (performance.now() - begin));
    this.isFetching = false;
  }
}
