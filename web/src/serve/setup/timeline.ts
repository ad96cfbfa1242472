// The clip's time line: scrub through the frames, and choose the frames of zero and of rest.
import type { Range } from './state';
import { button } from '../parts/parts';
import { brief } from '../../format';
import { el } from '../../element';

interface LanePlan {
  name: string;
  meaning: string;
  range?: Range;
  onChange: (range: Range | undefined) => void;
}

export class Timeline {
  readonly element: HTMLElement;
  onFrame?: (frame: number) => void;
  private readonly slider = el('input', { type: 'range', min: '0', max: '0', value: '0', step: '1', 'aria-label': 'Frame' });
  private readonly where = el('output', { class: 'where' });
  private readonly lanes: Lane[];
  private frames = 0;
  private interval_s = NaN;

  constructor(plans: LanePlan[]) {
    this.slider.addEventListener('input', () => {
      this.onFrame?.(this.frame);
      this.draw();
    });
    this.lanes = plans.map((plan) => new Lane(plan, this));
    const step = (by: number): void => {
      this.slider.value = String(this.frame + by);
      this.onFrame?.(this.frame);
      this.draw();
    };
    this.element = el('div', { class: 'timeline', role: 'group', 'aria-label': 'Time line' },
      el('div', { class: 'scrub' }, button('\u2039', () => step(-1), { class: 'small', 'aria-label': 'Previous frame' }), this.slider,
        button('\u203a', () => step(1), { class: 'small', 'aria-label': 'Next frame' }), this.where),
      ...this.lanes.map(({ element }) => element));
  }

  get frame(): number {
    return Number(this.slider.value);
  }

  get count(): number {
    return this.frames;
  }

  // Called with every frame that arrives.
  set(frame: number, frames: number, time_s: number): void {
    if (Number.isFinite(frames) && frames > 0) this.frames = frames;
    if (frame > 0 && Number.isFinite(time_s)) this.interval_s = time_s / frame;
    this.slider.max = String(Math.max(0, this.frames - 1));
    this.slider.value = String(frame);
    this.draw();
  }

  timeText(frame: number): string {
    return Number.isFinite(this.interval_s) ? `${(frame * this.interval_s).toFixed(2)} s` : `frame ${frame}`;
  }

  private draw(): void {
    const time = Number.isFinite(this.interval_s) ? `${(this.frame * this.interval_s).toFixed(2)} s, ` : '';
    this.where.textContent = `${time}frame ${this.frame} of ${Math.max(this.frames, 1)}`;
    this.lanes.forEach((lane) => lane.draw());
  }
}

// One chosen range of frames. Drag it with the mouse, or set its ends at the current frame.
class Lane {
  readonly element: HTMLElement;
  private readonly bar = el('span', { class: 'lane-bar' });
  private readonly track: HTMLElement;
  private readonly text = el('output', { class: 'lane-text' });
  private readonly clear: HTMLButtonElement;
  private range?: Range;

  constructor(private readonly plan: LanePlan, private readonly line: Timeline) {
    this.range = plan.range;
    this.track = el('div', { class: 'lane-track', title: 'Drag over the frames' }, this.bar);
    this.clear = button('\u00d7', () => this.set(undefined), { class: 'quiet', 'aria-label': `Remove ${plan.name}` });
    const from = button('from here', () => this.set({ from: line.frame, to: Math.max(line.frame + 1, this.range?.to ?? line.count) }), { class: 'small', 'aria-label': `${plan.name}: from this frame` });
    const to = button('to here', () => this.set({ from: Math.min(line.frame, this.range?.from ?? 0), to: line.frame + 1 }), { class: 'small', 'aria-label': `${plan.name}: to this frame` });
    this.element = el('div', { class: `lane ${plan.name.toLowerCase()}`, role: 'group', 'aria-label': `${plan.name}: ${plan.meaning}` },
      el('span', { class: 'lane-name', title: plan.meaning }, plan.name), this.track, from, to, this.text, this.clear);
    this.track.addEventListener('pointerdown', (event) => this.drag(event));
  }

  private set(range: Range | undefined): void {
    this.range = range;
    this.plan.onChange(range);
    this.draw();
  }

  private frameAt(event: PointerEvent): number {
    const area = this.track.getBoundingClientRect();
    const share = Math.min(1, Math.max(0, (event.clientX - area.left) / area.width));
    return Math.round(share * this.line.count);
  }

  private drag(start: PointerEvent): void {
    if (start.button !== 0 || this.line.count < 2) return;
    start.preventDefault(); // otherwise selected text would be dragged
    const from = this.frameAt(start);
    this.track.setPointerCapture(start.pointerId);
    const move = (event: PointerEvent): void => {
      const to = this.frameAt(event);
      if (to === from) return;
      this.range = { from: Math.min(from, to), to: Math.max(from, to) };
      this.draw();
    };
    const end = (): void => {
      this.track.removeEventListener('pointermove', move);
      this.plan.onChange(this.range);
    };
    this.track.addEventListener('pointermove', move);
    this.track.addEventListener('pointerup', end, { once: true });
    this.track.addEventListener('pointercancel', end, { once: true });
  }

  draw(): void {
    const { range, line } = this;
    const count = Math.max(1, line.count);
    this.bar.hidden = range === undefined;
    this.clear.hidden = range === undefined;
    if (!range) {
      this.text.textContent = this.plan.meaning;
      return;
    }
    this.bar.style.left = `${(100 * range.from) / count}%`;
    this.bar.style.width = `${(100 * (range.to - range.from)) / count}%`;
    this.text.textContent = `${line.timeText(range.from)} to ${line.timeText(range.to)} (${brief(range.to - range.from)} frames)`;
  }
}
