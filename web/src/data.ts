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
  spectrum: { x: Spectrum; y: Spectrum };
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
  columns: { quantum: number; count: number }[];
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
export async function columns(of: Report): Promise<Float64Array[]> {
  const packed = bytesOf(textOf('samples'));
  if (packed.length === 0) return of.columns.map(() => new Float64Array(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let at = 0;
  return of.columns.map(({ quantum, count }) => {
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
