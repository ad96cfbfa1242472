// Reads the data that the program put into the page (src/moiregauge/report/report_page.cc).

export interface Peak {
  kind: 'steady' | 'decay' | 'random';
  frequency_hz: number;
  u_frequency_hz: number;
  amplitude_mm: number;
  damping: number | null;
  u_damping: number | null;
  no_damping: string;
  from_s: number;
  to_s: number;
}

export interface Spectrum {
  refusal?: string;
  step_hz: number;
  log10_psd: number; // column
  resolution_hz: number;
  segments: number;
  segment_s: number;
  samples: number;
  gaps: number;
  longest_s: number;
  interval_s: number;
  peaks: Peak[];
}

export interface Target {
  name: string;
  rows: { dx: number; dy: number; ux: number; uy: number; status: number }; // columns
  lowest: AxisValues; // mm, of the rows ok, as computed: columns are rounded
  highest: AxisValues;
  spectrum: { x: Spectrum; y: Spectrum };
}

export interface AxisValues {
  dx: number | null;
  dy: number | null;
}

export interface ValueWithU {
  value: number | null;
  u: number | null;
}

// One channel with some of the layers (derived.json).
export interface ChannelState {
  unit: string;
  value: number; // column, as u and status
  u: number;
  status: number;
  rows: number;
  ok: number;
  mean: ValueWithU;
  rms: ValueWithU;
  peak_to_peak: ValueWithU;
  smallest: ValueWithU & { time_s: number | null };
  largest: ValueWithU & { time_s: number | null };
}

// Channels of `derive`, for every choice of its layers that the program computed.
export interface Derived {
  layers: string[];
  channels: { name: string; expression: string }[];
  states: { on: boolean[]; u_is_bound: boolean; frame: number | null; time: number | null; channels: ChannelState[] }[];
  columns: PackedColumn[];
  samples: string;
}

interface EstimateWithU {
  value: number | null;
  u: number | null;
}

// The last comparison of `compare` (comparison.json).
export interface Comparison {
  channel: string;
  unit: string;
  reference: string;
  compared_at: string;
  offset_s: EstimateWithU;
  offset_at_time_s: number;
  clock_ppm: EstimateWithU;
  is_clock_fitted: boolean;
  slope: EstimateWithU;
  bias: EstimateWithU;
  correlation: number;
  rms_difference: number;
  limits_of_agreement: [number, number];
  rms_u: number;
  coverage_of_U: number;
  share_explained_by_u: number;
  rms_unexplained: number;
  warnings: string[];
  rows: { time: number; moiregauge: number; reference: number; u: number }; // columns
  columns: PackedColumn[];
  samples: string;
}

export interface PackedColumn {
  quantum: number;
  count: number;
}

export interface Report {
  version: string;
  input: string;
  outcome: string;
  exit_code: number;
  method: { name: string; summary: string };
  summary: string[];
  advice: string[];
  warnings: string[];
  statuses: { word: string; meaning: string }[];
  targets: Target[];
  frame: number | null; // column, as all that follow
  time: number | null;
  camera?: { right: number; down: number; pan: number | null; tilt: number | null; roll: number | null };
  quality?: { modulation: { name: string; role: string; then: number; relative: number }[]; chi2: number | null };
  columns: PackedColumn[];
}

// run.json, of which the page shows parts (docs/file-formats.md).
export interface Run {
  input: Record<string, string | number | null>;
  config: Record<string, unknown>;
  reference_frame: number | null;
  camera: Record<string, unknown> & { u: Record<string, number> };
  scene: { model: string; chi2_dof: number | null; key_frames: number[]; readout_s: number | null; u_readout_s: number | null };
  targets: {
    name: string;
    frames: number;
    ok: number;
    status_counts: Record<string, number>;
    u_dx_mm: number | null;
    u_dy_mm: number | null;
    bound_mm: { x: number | null; y: number | null } | null;
    budget: Record<string, { x_mm: number | null; y_mm: number | null }>;
  }[];
  complete: boolean;
}

const textOf = (id: string): string => document.getElementById(id)?.textContent?.trim() ?? '';

export const report = (): Report => JSON.parse(textOf('report')) as Report;
export const run = (): Run => JSON.parse(textOf('run')) as Run;

// Empty until `derive` or `compare` has added it.
const added = <Type>(id: string): Type | undefined => {
  const text = textOf(id);
  return text ? (JSON.parse(text) as Type) : undefined;
};
export const derived = (): Derived | undefined => added<Derived>('derived');
export const comparison = (): Comparison | undefined => added<Comparison>('comparison');

// The picture as a data URL, JPEG (ff d8 ff) or PNG; empty where there is none.
export function overlay(): string {
  const base64 = textOf('overlay');
  return base64 ? `data:image/${base64.startsWith('/9j/') ? 'jpeg' : 'png'};base64,${base64}` : '';
}

function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
  const binary = atob(base64);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

// packed_columns.h says how they are written. NaN is a gap.
export const columns = (of: Report): Promise<Float64Array[]> => unpacked(textOf('samples'), of.columns);

export async function unpacked(samples: string, columns: PackedColumn[]): Promise<Float64Array[]> {
  const packed = bytesOf(samples);
  if (packed.length === 0) return columns.map(() => new Float64Array(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let at = 0;
  return columns.map(({ quantum, count }) => {
    const values = new Float64Array(count);
    // Decades are divided by a whole number, so that 0.1 is 0.1 and not 0.1000...01.
    const perUnit = quantum < 1 ? Math.round(1 / quantum) : 0;
    let last = 0;
    for (let i = 0; i < count; ++i) {
      let byte = bytes[at++]!;
      if (byte === 0) {
        values[i] = NaN;
        continue;
      }
      let digits = byte & 127;
      let weight = 128;
      while (byte & 128) {
        byte = bytes[at++]!;
        digits += (byte & 127) * weight;
        weight *= 128;
      }
      digits -= 1;
      last += digits % 2 ? -(digits + 1) / 2 : digits / 2;
      values[i] = perUnit ? last / perUnit : last * quantum;
    }
    return values;
  });
}
