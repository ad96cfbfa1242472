// Requests to the server of `moiregauge serve`. Every request carries the token; a failure is an Error with the server's own sentence.

export interface Entry {
  path: string;
  kind: 'clip' | 'images' | 'run' | 'folder' | 'table' | 'camera';
  name: string;
  bytes: number;
  modified_s: number;
  state: 'new' | 'queued' | 'measuring' | 'done' | 'refused' | 'interrupted';
  run?: string;
  headline?: string;
  exit_code?: number;
  site?: string;
}

export interface Job {
  id: string;
  action: string;
  command: string;
  state: 'queued' | 'running' | 'done' | 'failed' | 'cancelled';
  exit_code: number | null;
  run?: string;
  output?: string;
  frames_done: number;
  frames: number;
  seconds: number;
  lines: string[];
}

export type Point = [number, number];
export type Box = [number, number, number, number]; // x, y, width, height in px
export type Role = 'reference' | 'target' | 'ignored' | 'none';

export interface FoundMarker {
  name: string;
  role: Role;
  circle?: { x?: number; y?: number; diameter_px?: number; outline?: Point[] };
  grating?: { outline: Point[] };
  outline?: Point[];
  pitch_px?: number | null;
  u_dx_mm?: number | null;
  u_dy_mm?: number | null;
}

export interface Inspection {
  frame: number;
  width: number;
  height: number;
  markers: FoundMarker[];
  mm_per_px?: number | null;
  distances: { from: string; to: string; mm: number }[];
  site: string;
  measurable?: boolean;
  missing?: string | null;
  warnings: string[];
  command: string;
}

export interface Session {
  version: string;
  folder: string;
  limits: { upload_bytes: number };
}

export interface Picture {
  blob: Blob;
  frame: number;
  frames: number;
  width: number;
  height: number;
  time_s: number;
}

// run.json, of which the page shows parts (docs/file-formats.md).
export interface RunSummary {
  command?: string;
  input: { path: string; frames: number; width: number; height: number; fps: number | null; codec: string | null };
  method: string;
  reference_frame: number | null;
  markers: { name: string; role: string }[];
  scale: { mm_per_px: number | null; from: string; to: string | null; distance_mm: number | null } | null;
  targets: {
    name: string; frames: number; ok: number; status_counts: Record<string, number>; u_dx_mm: number | null; u_dy_mm: number | null;
    peaks?: Record<'x' | 'y', { kind: string; frequency_hz: number; amplitude_mm: number; u: Record<string, number> }[]>;
  }[];
  references_verified: boolean;
  warnings: string[];
  exit_code: number;
}

export interface BatchRow {
  run: string;
  name: string;
  state: string;
  exit_code: number;
  targets: {
    name: string; frames: number; ok: number;
    peak_to_peak_mm: { x: number | null; y: number | null }; u_mm: { x: number | null; y: number | null }; f1_hz: { x: number | null; y: number | null } | null;
  }[];
}

const kTokenKey = 'moiregauge-token';

// On loopback the page holds the token. Otherwise the address does (#token=...), which is removed from the address at once.
function readToken(): string {
  const given = new URLSearchParams(location.hash.slice(1)).get('token');
  if (given) {
    sessionStorage.setItem(kTokenKey, given);
    history.replaceState(null, '', location.pathname);
  }
  const own = document.querySelector<HTMLMetaElement>('meta[name="moiregauge-token"]')?.content ?? '';
  return own || (sessionStorage.getItem(kTokenKey) ?? '');
}

const token = readToken();

export const query = (path: string, parameters: Record<string, string | number | undefined>): string => {
  const given = Object.entries(parameters).filter(([, value]) => value !== undefined).map(([key, value]): [string, string] => [key, String(value)]);
  return `${path}?${new URLSearchParams(given)}`;
};

export class Refusal extends Error {
  constructor(message: string, readonly status: number, readonly places: { line: number; column: number; text: string }[]) {
    super(message);
  }
}

async function refusal(answer: Response): Promise<Refusal> {
  try {
    const body = (await answer.json()) as { error?: string; errors?: { line: number; column: number; text: string }[] };
    return new Refusal(body.error ?? `The server refuses the request (${answer.status}).`, answer.status, body.errors ?? []);
  } catch {
    return new Refusal(`The server refuses the request (${answer.status}).`, answer.status, []);
  }
}

export async function request(path: string, options: RequestInit = {}): Promise<Response> {
  let answer: Response;
  try {
    answer = await fetch(path, { ...options, headers: { ...options.headers, 'X-Moiregauge-Token': token } });
  } catch (problem) {
    if (options.signal?.aborted) throw problem;
    throw new Error('The server does not answer. Measurements that it started can be resumed: start `moiregauge serve` again.');
  }
  if (!answer.ok) throw await refusal(answer);
  return answer;
}

export const get = async <Type>(path: string, options?: RequestInit): Promise<Type> => (await (await request(path, options)).json()) as Type;

export async function post<Type>(path: string, body: unknown = {}, signal?: AbortSignal): Promise<Type> {
  const answer = await request(path, { method: 'POST', body: JSON.stringify(body), headers: { 'Content-Type': 'application/json' }, signal });
  const text = await answer.text();
  return (text ? JSON.parse(text) : {}) as Type;
}

export async function picture(path: string, signal?: AbortSignal): Promise<Picture> {
  const answer = await request(path, { signal });
  const number = (name: string): number => Number(answer.headers.get(name) ?? NaN);
  return {
    blob: await answer.blob(), frame: number('X-Frame'), frames: number('X-Frames'),
    width: number('X-Width'), height: number('X-Height'), time_s: number('X-Time'),
  };
}

// The columns of one target: column-major Float64, little-endian.
export async function series(run: string, marker: string): Promise<Record<string, Float64Array>> {
  const answer = await request(query('/api/series', { run, marker }));
  const names = (answer.headers.get('X-Columns') ?? '').split(',');
  const bytes = await answer.arrayBuffer();
  const rows = Number(answer.headers.get('X-Rows') ?? bytes.byteLength / 8 / names.length);
  return Object.fromEntries(names.map((name, k) => [name.trim(), new Float64Array(bytes, 8 * k * rows, rows)]));
}

export const startJob = (action: string, args: string[]): Promise<{ id: string; command: string }> => post('/api/jobs', { action, arguments: args });

// Words for a POSIX shell.
export const shellWord = (word: string): string => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'\\''`)}'`);

export const commandText = (action: string, args: string[]): string => ['moiregauge', action, ...args.map(shellWord)].join(' ');

type OnEvent = (kind: string, data: unknown) => void;

// Reads the event stream until it ends.
async function readEvents(onEvent: OnEvent, onOpen: () => void): Promise<void> {
  const answer = await request('/api/events');
  onOpen();
  const reader = answer.body!.pipeThrough(new TextDecoderStream()).getReader();
  let rest = '';
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    const blocks = (rest + value).replaceAll('\r\n', '\n').split('\n\n');
    rest = blocks.pop()!;
    for (const block of blocks) {
      let kind = 'message';
      const data: string[] = [];
      for (const line of block.split('\n')) {
        if (line.startsWith('event:')) kind = line.slice(6).trim();
        else if (line.startsWith('data:')) data.push(line.slice(5).trim());
      }
      if (data.length > 0) onEvent(kind, JSON.parse(data.join('\n')));
    }
  }
}

const kRetry_ms = 1500;

// Reads events for as long as the page lives. `onState` reports whether the stream is open.
export async function watchEvents(onEvent: OnEvent, onState: (isOpen: boolean) => void): Promise<never> {
  for (;;) {
    try {
      await readEvents(onEvent, () => onState(true));
    } catch {
      // The next attempt follows. The state line reports the loss.
    }
    onState(false);
    await new Promise((done) => setTimeout(done, kRetry_ms));
  }
}
