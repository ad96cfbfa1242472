// A million samples on a thousand pixels: the lowest and the highest of every pixel's samples, found quickly.

const kFan = 16; // blocks of 16 values, of 256, and so on
const kGroup = 4; // pixels that share the points of a curve without a line: points are wider than a pixel

interface Extremes {
  lows: Float64Array;
  highs: Float64Array;
}

// Returns the extremes of every block of 16. Comparisons with NaN are false, so gaps are passed over.
function blocksOf({ lows, highs }: Extremes): Extremes {
  const blocks = Math.ceil(lows.length / kFan);
  const out = { lows: new Float64Array(blocks).fill(Infinity), highs: new Float64Array(blocks).fill(-Infinity) };
  for (let i = 0; i < lows.length; ++i) {
    const b = (i / kFan) | 0;
    if (lows[i]! < out.lows[b]!) out.lows[b] = lows[i]!;
    if (highs[i]! > out.highs[b]!) out.highs[b] = highs[i]!;
  }
  return out;
}

// Values with the extremes of their blocks, of blocks of blocks, and so on. They are made when they are first needed.
export class Curve {
  private readonly levels: Extremes[];
  constructor(readonly values: Float64Array) {
    this.levels = [{ lows: values, highs: values }];
  }

  private level(k: number): Extremes {
    this.levels[k] ??= blocksOf(this.level(k - 1));
    return this.levels[k]!;
  }

  // Returns true if all values are gaps.
  isEmpty(): boolean {
    const [low, high] = this.extremes(0, this.values.length);
    return low > high;
  }

  // Returns the lowest and highest value in [from, to); Infinity and -Infinity if all are gaps.
  extremes(from: number, to: number): [number, number] {
    let low = Infinity;
    let high = -Infinity;
    const scan = ({ lows, highs }: Extremes, begin: number, end: number): void => {
      for (let i = begin; i < end; ++i) {
        if (lows[i]! < low) low = lows[i]!;
        if (highs[i]! > high) high = highs[i]!;
      }
    };
    let k = 0;
    for (; to - from >= 2 * kFan; ++k) {
      const first = Math.ceil(from / kFan);
      const last = Math.floor(to / kFan);
      scan(this.level(k), from, first * kFan);
      scan(this.level(k), last * kFan, to);
      from = first;
      to = last;
    }
    scan(this.level(k), from, to);
    return [low, high];
  }
}

export type Drawn = (number | null)[];

// The first index whose x is not below `value`.
export function firstAtLeast(x: Float64Array, value: number): number {
  let low = 0;
  let high = x.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle]! < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

// A curve to draw; `isPoints`: without a line.
export interface DrawnCurve {
  curve: Curve;
  isPoints?: boolean;
}

// Returns the points of `curves` to draw between min and max, with one more sample on each side. Many samples are reduced to
// two points per pixel, or per group of pixels without a line. A pixel without samples is a gap.
export function drawn(x: Float64Array, curves: DrawnCurve[], min: number, max: number, pixels: number): [number[], ...Drawn[]] {
  const from = Math.max(0, firstAtLeast(x, min) - 1);
  const to = Math.min(x.length, firstAtLeast(x, max) + 2);
  const count = to - from;
  if (count <= 3 * pixels) {
    const all = curves.map(({ curve }) => Array.from(curve.values.subarray(from, to), (v) => (Number.isNaN(v) ? null : v)));
    return [Array.from(x.subarray(from, to)), ...all];
  }
  const xs: number[] = [];
  const ys: Drawn[] = curves.map(() => []);
  const startOf = (p: number): number => from + Math.floor((count * Math.min(p, pixels)) / pixels);
  for (let p = 0; p < pixels; ++p) {
    const start = startOf(p);
    xs.push(x[start]!, x[(start + startOf(p + 1)) >> 1]!);
    curves.forEach(({ curve, isPoints = false }, c) => {
      const [low, high] = !isPoints ? curve.extremes(start, startOf(p + 1)) : p % kGroup === 0 ? curve.extremes(start, startOf(p + kGroup)) : [1, 0];
      ys[c]!.push(low <= high ? low : null, low <= high ? high : null);
    });
  }
  return [xs, ...ys];
}
