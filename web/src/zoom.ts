// The common abscissa range of a group of plots.

export type OnChange = () => void;

export class Zoom {
  private listeners = new Set<OnChange>();
  min: number;
  max: number;
  constructor(readonly lowest: number, readonly highest: number, private readonly least: number) {
    this.min = lowest;
    this.max = highest;
  }

  watch(listener: OnChange): void {
    this.listeners.add(listener);
  }

  unwatch(listener: OnChange): void {
    this.listeners.delete(listener);
  }

  get isWhole(): boolean {
    return this.min <= this.lowest && this.max >= this.highest;
  }

  show(min: number, max: number): void {
    const whole = this.highest - this.lowest;
    const width = Math.min(whole, Math.max(this.least, max - min));
    const middle = 0.5 * (min + max);
    const from = Math.min(this.highest - width, Math.max(this.lowest, middle - 0.5 * width));
    if (from === this.min && from + width === this.max) return;
    this.min = from;
    this.max = from + width;
    this.listeners.forEach((listener) => listener());
  }

  // factor < 1 shows less; the value `about` stays where it is.
  by(factor: number, about = 0.5 * (this.min + this.max)): void {
    this.show(about - (about - this.min) * factor, about + (this.max - about) * factor);
  }

  // By a part of what is shown.
  pan(share: number): void {
    const step = share * (this.max - this.min);
    const room = step > 0 ? this.highest - this.max : this.lowest - this.min;
    const go = Math.abs(step) < Math.abs(room) ? step : room;
    this.show(this.min + go, this.max + go);
  }

  all(): void {
    this.show(this.lowest, this.highest);
  }

  // + - arrows 0; true when the key was one of them.
  key(key: string): boolean {
    if (key === '+' || key === '=') this.by(0.5);
    else if (key === '-' || key === '_') this.by(2);
    else if (key === 'ArrowLeft') this.pan(-0.25);
    else if (key === 'ArrowRight') this.pan(0.25);
    else if (key === '0' || key === 'Home' || key === 'Escape') this.all();
    else return false;
    return true;
  }
}
