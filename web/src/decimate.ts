// A million samples on a thousand pixels: the lowest and the highest of every pixel's samples, found quickly.

const kBlock = 128;

// Values with the extremes of every block of 128, made when they are first needed.
export class Curve {
  private lows?: Float64Array;
  private highs?: Float64Array;
  constructor(readonly values: Float64Array) {}

  private makeBlocks(): void {
    const blocks = Math.ceil(this.values.length / kBlock);
    this.lows = new Float64Array(blocks);
    this.highs = new Float64Array(blocks);
    for (let b = 0; b < blocks; ++b) {
      const [low, high] = this.scan(b * kBlock, Math.min(this.values.length, (b + 1) * kBlock));
      this.lows[b] = low;
      this.highs[b] = high;
    }
  }

  private scan(from: number, to: number): [number, number] {
    let low = Infinity;
    let high = -Infinity;
    const { values } = this;
    for (let i = from; i < to; ++i) {
      const v = values[i]!; // comparisons with NaN are false: gaps are passed over
      if (v < low) low = v;
      if (v > high) high = v;
    }
    return [low, high];
  }

  // Returns true if all values are gaps.
  isEmpty(): boolean {
    const [low, high] = this.extremes(0, this.values.length);
    return low > high;
  }

  // Returns the lowest and highest value in [from, to); Infinity and -Infinity if all are gaps.
  extremes(from: number, to: number): [number, number] {
    if (to - from < 4 * kBlock) return this.scan(from, to);
    if (!this.lows) this.makeBlocks();
    const first = Math.ceil(from / kBlock);
    const last = Math.floor(to / kBlock);
    let [low, high] = this.scan(from, first * kBlock);
    const [lowEnd, highEnd] = this.scan(last * kBlock, to);
    low = Math.min(low, lowEnd);
    high = Math.max(high, highEnd);
    for (let b = first; b < last; ++b) {
      if (this.lows![b]! < low) low = this.lows![b]!;
      if (this.highs![b]! > high) high = this.highs![b]!;
    }
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

// Returns the points of `curves` to draw between min and max, with one more sample on each side. Many samples are reduced to
// two points per pixel. A pixel without samples is a gap.
export function drawn(x: Float64Array, curves: Curve[], min: number, max: number, pixels: number): [number[], ...Drawn[]] {
  const from = Math.max(0, firstAtLeast(x, min) - 1);
  const to = Math.min(x.length, firstAtLeast(x, max) + 2);
  const count = to - from;
  if (count <= 3 * pixels) {
    const all = curves.map(({ values }) => Array.from(values.subarray(from, to), (v) => (Number.isNaN(v) ? null : v)));
    return [Array.from(x.subarray(from, to)), ...all];
  }
  const xs: number[] = [];
  const ys: Drawn[] = curves.map(() => []);
  for (let p = 0; p < pixels; ++p) {
    const start = from + Math.floor((count * p) / pixels);
    const end = from + Math.floor((count * (p + 1)) / pixels);
    xs.push(x[start]!, x[(start + end) >> 1]!);
    curves.forEach((curve, c) => {
      const [low, high] = curve.extremes(start, end);
      ys[c]!.push(low <= high ? low : null, low <= high ? high : null);
    });
  }
  return [xs, ...ys];
}
