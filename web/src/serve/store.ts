// Entries and jobs of the server, and the views that follow their changes.
import { get, query, request, watchEvents, type Entry, type Job, type Session } from './api';

export type Row = [number, number | null, number | null, number | null, number | null, number | null, number]; // frame, time_s, dx, dy, u_dx, u_dy, status

export interface SamplesEvent {
  id: string;
  marker: Record<string, Row[]>;
}

// The newest measured frame of a job, and the homography from its image points (px) to those of the reference frame.
export interface ViewEvent {
  id: string;
  frame: number;
  reference_from_frame: number[] | null; // rows; null: the references are not seen
}

export interface LiveEvent {
  id: string;
  state: string;
  line: LiveLine;
  lines?: string[];
}

// One line of `moiregauge live --json`. `type` is frame, alarm or end.
export interface LiveLine {
  type: string;
  rule?: string;
  state?: string; // alarm: raised or cleared
  exit_code?: number;
  folder?: string;
  frame: number;
  time_s: number | null;
  rows: { marker: string; dx_mm: number | null; dy_mm: number | null; u_dx_mm: number | null; u_dy_mm: number | null; status: string }[];
  frames: number;
  lost: Record<string, number>;
  queued: number;
  scenes: number;
  frames_per_s: number | null;
  latency_ms: { p50: number | null; p99: number | null };
  clipped: number | null;
  modulation: number | null;
  problem: string;
  hints: string[];
}

interface Changes {
  entries: void;
  job: Job;
  samples: SamplesEvent;
  view: ViewEvent;
  live: LiveEvent;
  connection: boolean;
}

export let session: Session = { version: '', folder: '', limits: { upload_bytes: 0 } };
export let entries: Entry[] = [];
export const jobs = new Map<string, Job>();
const listeners: { [Kind in keyof Changes]: Set<(change: Changes[Kind]) => void> } = {
  entries: new Set(), job: new Set(), samples: new Set(), view: new Set(), live: new Set(), connection: new Set(),
};

// Calls `listener` on every change of this kind until the returned function is called.
export function on<Kind extends keyof Changes>(kind: Kind, listener: (change: Changes[Kind]) => void): () => void {
  listeners[kind].add(listener);
  return () => listeners[kind].delete(listener);
}

function announce<Kind extends keyof Changes>(kind: Kind, change: Changes[Kind]): void {
  [...listeners[kind]].forEach((listener) => listener(change));
}

let lastEntries = '';

export async function refreshEntries(): Promise<void> {
  const answer = await (await request('/api/entries')).text();
  if (answer === lastEntries) return;
  lastEntries = answer;
  entries = (JSON.parse(answer) as { entries: Entry[] }).entries;
  announce('entries', undefined);
}

const kLook_ms = 3000;

// Other programs change the folder without an event.
function watchFolder(): void {
  const look = (): void => {
    if (!document.hidden) void refreshEntries().catch(() => undefined);
  };
  setInterval(look, kLook_ms);
  document.addEventListener('visibilitychange', look);
}

async function refreshJobs(): Promise<void> {
  for (const job of (await get<{ jobs: Job[] }>('/api/jobs')).jobs) setJob(job);
}

export function setJob(job: Job): void {
  jobs.set(job.id, job);
  announce('job', job);
}

let refreshing: ReturnType<typeof setTimeout> | undefined;
const kCalm_ms = 200; // a burst of changes is one refresh

function onEvent(kind: string, data: unknown): void {
  if (kind === 'job') setJob(data as Job);
  else if (kind === 'samples') announce('samples', data as SamplesEvent);
  else if (kind === 'view') announce('view', data as ViewEvent);
  else if (kind === 'live') announce('live', data as LiveEvent);
  else if (kind === 'entries') {
    clearTimeout(refreshing);
    refreshing = setTimeout(() => void refreshEntries().catch(() => undefined), kCalm_ms);
  }
}

export async function connect(): Promise<void> {
  session = await get<Session>('/api/session');
  await refreshEntries();
  await refreshJobs().catch(() => undefined); // the first event brings them again
  watchFolder();
  let wasOpen = true;
  void watchEvents(onEvent, (isOpen) => {
    announce('connection', isOpen);
    if (isOpen && !wasOpen) void Promise.all([refreshEntries(), refreshJobs()]).catch(() => undefined);
    wasOpen = isOpen;
  });
}

export const entryAt = (path: string): Entry | undefined => entries.find((entry) => entry.path === path);

// Waits until the job has ended.
export function finished(id: string): Promise<Job> {
  const hasEnded = (job: Job | undefined): job is Job => job !== undefined && ['done', 'failed', 'cancelled'].includes(job.state);
  const known = jobs.get(id);
  if (hasEnded(known)) return Promise.resolve(known);
  return new Promise((done) => {
    const stop = on('job', (job) => {
      if (job.id !== id || !hasEnded(job)) return;
      stop();
      done(job);
    });
  });
}

export const fileOfRun = async (run: string, name: string): Promise<Blob> => (await request(query('/api/file', { run, name }))).blob();
export const fileAt = async (path: string): Promise<Blob> => (await request(query('/api/file', { path }))).blob();
