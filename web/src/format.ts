// Numbers as words: no more digits than their uncertainty deserves.

// U = k u, with the coverage factor of every U that is shown (report_text.h).
const kCoverageFactor = 2;
export const expanded = (u: number): number => kCoverageFactor * u;

// Relative uncertainty of a camera's clock, and so of every frequency.
const kClock = 1e-5;
export const expandedFrequency = (u: number, frequency: number): number => Math.max(expanded(u), kClock * frequency);

export const digitsFor = (u: number): number =>
  u > 0 && Number.isFinite(u) ? Math.min(7, Math.max(0, 1 - Math.floor(Math.log10(u)))) : 3;

const minus = (text: string): string => text.replace('-', '\u2212');

export function signed(value: number, digits: number): string {
  const text = Math.abs(value).toFixed(digits);
  if (Number(text) === 0) return text;
  return (value < 0 ? '\u2212' : '+') + text;
}

export const plain = (value: number, digits: number): string => minus(value.toFixed(digits));

// Four significant digits, for what has no uncertainty of its own.
export function brief(value: number): string {
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return minus(value.toExponential(2));
  return minus(String(Number(value.toPrecision(4))));
}

export const micrometres = (mm: number): string => {
  const um = 1000 * mm;
  if (um === 0) return '0';
  return um >= 100 ? um.toFixed(0) : um >= 10 ? um.toFixed(1) : um >= 0.01 ? um.toFixed(2) : '< 0.01';
};

export const duration = (seconds: number): string => {
  if (seconds < 120) return `${brief(seconds)} s`;
  if (seconds < 7200) return `${(seconds / 60).toFixed(1)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
};

// A warning or note of the program as a sentence.
export function sentence(text: string): string {
  const bare = text.replace(/^note: /, '');
  return bare.charAt(0).toUpperCase() + bare.slice(1) + (bare.endsWith('.') ? '' : '.');
}
