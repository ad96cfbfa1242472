// The live page: a camera, a network stream or a replayed clip is measured while it comes.
import { commandText, get, picture, post, query } from './api';
import { attempt, button, card, checkbox, commandBox, field, sayProblem, select, showBlob } from './parts/parts';
import { GrowingChart } from './parts/chart';
import { SpectrumChart } from './parts/spectrum';
import { entries, on, type LiveEvent, type LiveLine, type SamplesEvent } from './store';
import { statuses, statusIndex } from './results/statuses';
import { el } from '../element';
import { digitsFor, expanded, plain, signed } from '../format';

const kSpan_s = 60;
const kPicture_ms = 150; // pause between two pictures, so at most about six a second
const kLowModulation = 0.6; // relative to the reference frame: focus, blur or light
const kHighClipped = 0.01; // share of clipped pixels: exposure

interface Meter {
  element: HTMLElement;
  set: (share: number | null, text: string, isGood: boolean) => void;
}

function meter(title: string, meaning: string): Meter {
  const bar = el('span', { class: 'meter-bar' });
  const text = el('output', {});
  const track = el('div', { class: 'meter-track', role: 'meter', 'aria-label': title, 'aria-valuemin': '0', 'aria-valuemax': '100', 'aria-valuenow': '0' }, bar);
  const element = el('div', { class: 'meter', title: meaning }, el('span', { class: 'meter-title' }, title), track, text);
  return { element, set: (share, words, isGood) => {
    const percent = share === null ? 0 : Math.min(100, Math.max(0, 100 * share));
    bar.style.width = `${percent}%`;
    bar.classList.toggle('bad', !isGood);
    track.setAttribute('aria-valuenow', percent.toFixed(0));
    track.setAttribute('aria-valuetext', words);
    text.textContent = words;
  } };
}

export class LiveView {
  readonly element = el('article', { class: 'live' });
  private id?: string;
  private charts: GrowingChart[] = [];
  private spectrum?: SpectrumChart;
  private readonly stops: (() => void)[] = [];
  private readonly image = el('img', { class: 'live-picture', alt: 'Picture of the source' });
  private readonly lamp = el('div', { class: 'lamp', role: 'status', 'aria-live': 'assertive' }, 'No alarm rule');
  private readonly focus = meter('Focus and light', 'Modulation of the worst grating, relative to the reference frame');
  private readonly exposure = meter('Clipped pixels', 'Share of pixels at the ends of the range, in the worst marker');
  private readonly numbers = el('ul', { class: 'values' });
  private readonly health = el('dl', { class: 'health' });
  private readonly hints = el('ul', { class: 'remarks' });
  private readonly state = el('h3', { role: 'status', 'aria-live': 'polite' }, 'Not started');
  private readonly command = commandBox();
  private readonly start: HTMLButtonElement;
  private readonly stop: HTMLButtonElement;
  private readonly source = el('select', { 'aria-label': 'Source' });
  private readonly address = el('input', { type: 'text', placeholder: 'rtsp://camera/stream', 'aria-label': 'Address of a network camera', spellcheck: 'false' });
  private readonly pitch = el('input', { type: 'text', inputmode: 'decimal', value: localStorage.getItem('moiregauge-pitch-mm') ?? '10', 'aria-label': 'Pitch of the gratings in mm' });
  private readonly alarm = checkbox('Alarm', false, () => this.update());
  private readonly alarmTarget = el('input', { type: 'text', value: 'T1', 'aria-label': 'Target of the alarm', spellcheck: 'false' });
  private readonly alarmAxis = select([['dy', '|dy|'], ['dx', '|dx|']], 'dy', () => this.update(), 'Axis of the alarm');
  private readonly alarmLimit = el('input', { type: 'text', inputmode: 'decimal', value: '1', 'aria-label': 'Limit of the alarm in mm' });
  private readonly record = checkbox('Keep 10 s of video around each alarm', false, () => this.update());
  private readonly exposureTime = el('input', { type: 'text', inputmode: 'decimal', 'aria-label': 'Exposure in ms', placeholder: 'as it is' });
  private readonly gain = el('input', { type: 'text', inputmode: 'decimal', 'aria-label': 'Gain', placeholder: 'as it is' });
  private readonly cameraSettings = el('div', { class: 'row' }, field('Exposure', this.exposureTime, 'ms'), field('Gain', this.gain));
  private readonly raised = new Set<string>();
  private hasSamples = false; // every row comes as an event of its own
  private wantsPictures = false;

  constructor() {
    this.start = button('Start', () => void this.begin(), { class: 'primary' });
    this.stop = button('Stop', () => void this.end());
    this.stop.hidden = true;
    for (const input of [this.address, this.pitch, this.exposureTime, this.gain, this.alarmTarget, this.alarmLimit]) input.addEventListener('input', () => this.update());
    this.source.addEventListener('change', () => this.update());
    this.stops.push(on('live', (event) => this.take(event)));
    this.stops.push(on('samples', (event) => {
      if (event.id === this.id) this.grow(event);
    }));
    this.build();
    void this.fillSources();
    void this.findRunning();
  }

  leave(): void {
    this.wantsPictures = false;
    this.stops.forEach((stop) => stop());
    this.charts.forEach((chart) => chart.remove());
    this.spectrum?.remove();
  }

  remake(): void {
    this.charts.forEach((chart) => chart.remake());
    this.spectrum?.remake();
  }

  private build(): void {
    const settings = card('Settings', field('Source', this.source), field('Address', this.address), field('Grating pitch', this.pitch, 'mm'),
      this.cameraSettings,
      el('div', { class: 'row' }, this.alarm.element, this.alarmTarget, this.alarmAxis, el('span', {}, '>'), this.alarmLimit, el('span', { class: 'unit' }, 'mm')),
      this.record.element, el('div', { class: 'go' }, this.start, this.stop), this.command.element);
    const watch = el('section', { class: 'card live-state', 'aria-label': 'State' }, el('div', { class: 'progress-head' }, this.state, this.lamp), this.numbers, this.focus.element, this.exposure.element, this.health, this.hints);
    this.element.append(el('header', { class: 'clip-head' }, el('h2', {}, 'Live')), el('div', { class: 'live-grid' },
      el('div', { class: 'work' }, el('figure', { class: 'card side-picture' }, this.image), el('div', { class: 'curves card' })), el('div', { class: 'panel' }, watch, settings)));
  }

  private async fillSources(): Promise<void> {
    const clips = entries.filter(({ kind }) => kind === 'clip' || kind === 'images').map(({ path }): [string, string] => [path, `replay of ${path}`]);
    const fill = (cameras: [string, string][]): void => {
      const before = this.source.value;
      this.source.replaceChildren(...[...cameras, ...clips, ['address', 'network camera (address below)'] as [string, string]].map(([value, text]) => el('option', { value }, text)));
      if (before) this.source.value = before;
      this.update();
    };
    fill([]);
    try {
      const { cameras } = await get<{ cameras: { id: string; name?: string; model?: string }[] }>('/api/cameras');
      fill(cameras.map(({ id, name, model }) => [`camera:${id}`, `camera ${name ?? model ?? id}`]));
    } catch (problem) {
      sayProblem(problem);
    }
  }

  private get name(): string {
    return this.source.value === 'address' ? this.address.value.trim() : this.source.value;
  }

  private get isCamera(): boolean {
    return this.name.startsWith('camera:');
  }

  private options(): string[] {
    const isReplay = entries.some(({ path }) => path === this.name);
    const list = ['--pitch', `${Number(this.pitch.value.replace(',', '.'))}mm`];
    if (isReplay) list.unshift('--pace', '1');
    if (this.isCamera && this.exposureTime.value.trim()) list.push('--exposure', `${Number(this.exposureTime.value.replace(',', '.'))}ms`);
    if (this.isCamera && this.gain.value.trim()) list.push('--gain', this.gain.value.trim());
    if (this.alarm.box.checked) list.push('--alarm', `|${this.alarmTarget.value}.${this.alarmAxis.value}| > ${Number(this.alarmLimit.value.replace(',', '.'))} mm`);
    if (this.alarm.box.checked && this.record.box.checked) list.push('--record', '10s');
    return list;
  }

  private update(): void {
    this.address.closest('label')!.hidden = this.source.value !== 'address';
    this.cameraSettings.hidden = !this.isCamera;
    this.command.set(this.name ? commandText('live', [this.name, ...this.options()]) : '');
    if (this.raised.size === 0) this.setLamp(this.alarm.box.checked ? 'quiet' : 'off', this.alarm.box.checked ? 'No alarm' : 'No alarm rule');
  }

  private setLamp(kind: 'off' | 'quiet' | 'raised', text: string): void {
    this.lamp.className = `lamp ${kind}`;
    this.lamp.textContent = text;
  }

  private async begin(): Promise<void> {
    await attempt(async () => {
      this.start.disabled = true;
      try {
        const { id, command } = await post<{ id: string; command?: string }>('/api/live', { source: this.name, arguments: this.options() });
        this.follow(id, command);
      } finally {
        this.start.disabled = false;
      }
    });
  }

  // Shows a live run from now on.
  private follow(id: string, command: string | undefined): void {
    this.id = id;
    if (command) this.command.set(command);
    this.start.hidden = true;
    this.stop.hidden = false;
    this.state.textContent = 'Waits for the reference frame';
    this.raised.clear();
    this.hasSamples = false;
    this.charts.forEach((chart) => chart.remove());
    this.spectrum?.remove();
    this.charts = [new GrowingChart('dx', 'dx, right is positive', true, kSpan_s), new GrowingChart('dy', 'dy, up is positive', true, kSpan_s)];
    this.spectrum = new SpectrumChart('Spectrum of dy, last minute');
    this.element.querySelector('.curves')!.replaceChildren(...this.charts.map(({ element }) => element), this.spectrum.element);
    this.wantsPictures = true;
    void this.showPictures();
  }

  // A live run continues while no page is open. The page that opens next follows it.
  private async findRunning(): Promise<void> {
    await attempt(async () => {
      const { live } = await get<{ live: { id: string; command?: string }[] }>('/api/live');
      const running = live[live.length - 1];
      if (running && this.id === undefined) this.follow(running.id, running.command);
    });
  }

  private async end(): Promise<void> {
    await attempt(async () => {
      this.stop.disabled = true;
      await post(`/api/live/${encodeURIComponent(this.id!)}/stop`).finally(() => (this.stop.disabled = false));
      this.state.textContent = 'Stops and solves the whole run';
    });
  }

  private async showPictures(): Promise<void> {
    while (this.wantsPictures && this.id !== undefined) {
      try {
        const shown = await picture(query('/api/live-frame', { id: this.id, max_width: 960 }));
        if (shown.blob.size > 0) await showBlob(this.image, shown.blob);
        this.image.dataset.shown = String(Number(this.image.dataset.shown ?? 0) + 1);
      } catch {
        // There is no picture before the first frame.
      }
      await new Promise((done) => setTimeout(done, kPicture_ms));
    }
  }

  private take({ id, state, line, lines }: LiveEvent): void {
    if (id !== this.id) return;
    if (line?.type === 'alarm') {
      if (line.state === 'raised') this.raised.add(line.rule ?? 'raised');
      else this.raised.delete(line.rule ?? 'raised');
      this.setLamp(this.raised.size > 0 ? 'raised' : 'quiet', this.raised.size > 0 ? `Alarm: ${[...this.raised].join('; ')}` : 'Alarm has cleared');
    }
    if (line?.type === 'frame') this.show(line);
    if (state === 'ended' || line?.type === 'end') {
      this.wantsPictures = false;
      this.start.hidden = false;
      this.stop.hidden = true;
      const code = line?.exit_code;
      this.state.textContent = code === 0 || code === undefined ? 'Ended, and stored as a run' : `Ended with exit code ${code}`;
      if (lines && code !== 0) this.hints.replaceChildren(...lines.map((text) => el('li', {}, text)));
    }
  }

  private grow({ marker }: SamplesEvent): void {
    this.hasSamples = true;
    const names = Object.keys(marker);
    const first = marker[names[0] ?? ''] ?? [];
    first.forEach((_row, k) => {
      const rows = names.flatMap((name) => {
        const row = marker[name]![k];
        return row ? [{ name, row }] : [];
      });
      const x = rows[0]!.row[1] ?? rows[0]!.row[0];
      this.charts.forEach((chart, axis) => chart.add(x, rows.map(({ name, row }) => ({ name, value: row[2 + axis] as number | null, u: row[4 + axis] as number | null, status: row[6] }))));
      this.spectrum?.add(x, rows[0]!.row[3], rows[0]!.name);
    });
  }

  private show(line: LiveLine): void {
    this.state.textContent = line.problem !== '' ? line.problem : line.rows.length === 0 ? 'Waits for the reference frame' : line.scenes > 0 ? 'Measuring' : 'Measuring, not trusted before the first scene is solved';
    const x = line.time_s ?? line.frame;
    if (line.rows.length > 0) {
      if (!this.hasSamples) {
        (['dx', 'dy'] as const).forEach((axis, k) => this.charts[k]?.add(x, line.rows.map((row) => ({ name: row.marker, value: row[`${axis}_mm`], u: row[`u_${axis}_mm`], status: statusIndex(row.status) }))));
        this.spectrum?.add(x, line.rows[0]!.dy_mm, line.rows[0]!.marker);
      }
      this.numbers.replaceChildren(...line.rows.map((row) => {
        const value = (d: number | null, u: number | null): string => (d === null ? '\u2013' : `${signed(d, digitsFor(expanded(u ?? NaN)))} \u00b1 ${u === null ? '\u2013' : plain(expanded(u), digitsFor(expanded(u)))} mm`);
        const status = statuses[statusIndex(row.status)]!;
        return el('li', {}, el('strong', {}, row.marker), ` dx ${value(row.dx_mm, row.u_dx_mm)}, dy ${value(row.dy_mm, row.u_dy_mm)}${status.word === 'ok' ? '' : `: ${status.word} (${status.meaning})`}`);
      }));
    }
    const { modulation, clipped } = line;
    this.focus.set(modulation, modulation === null ? 'no grating is read' : `${(100 * modulation).toFixed(0)} % of the reference frame`, modulation !== null && modulation > kLowModulation);
    this.exposure.set(clipped === null ? null : clipped, clipped === null ? 'no grating is read' : `${(100 * clipped).toFixed(1)} %`, clipped === null || clipped < kHighClipped);
    const lost = Object.entries(line.lost).filter(([, count]) => count > 0).map(([cause, count]) => `${count} ${cause.replaceAll('_', ' ')}`).join(', ') || 'none';
    const facts: [string, string][] = [['Frames', String(line.frames)], ['Rate', line.frames_per_s === null ? '\u2013' : `${plain(line.frames_per_s, 1)} frames/s`],
      ['Latency', line.latency_ms.p50 === null ? '\u2013' : `${plain(line.latency_ms.p50, 0)} ms, 99 % below ${plain(line.latency_ms.p99 ?? NaN, 0)} ms`], ['Lost frames', lost]];
    this.health.replaceChildren(...facts.flatMap(([name, text]) => [el('dt', {}, name), el('dd', {}, text)]));
    this.hints.replaceChildren(...line.hints.map((text) => el('li', {}, text)));
    this.element.dataset.frames = String(line.frames);
  }
}
