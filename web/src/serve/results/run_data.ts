// A run as the page's plots read it: run.json and the columns of all targets.
import { get, query, series, type RunSummary } from '../api';
import { statuses } from './statuses';
import { abscissaFrom, type Abscissa } from '../../abscissa';
import type { Report } from '../../data';
import { Curve } from '../../decimate';
import { valuesOf } from '../../displacement';

export interface TargetData {
  name: string;
  u_dx_mm: number | null;
  u_dy_mm: number | null;
  frames: number;
  ok: number;
  columns: Record<string, Float64Array>;
}

export interface RunData {
  path: string;
  summary: RunSummary;
  targets: TargetData[];
  columns: Float64Array[]; // those of `report`
  report: Report; // the parts that plots use
  abscissa?: Abscissa;
  hasTime: boolean;
}

const kColumns = ['dx', 'dy', 'u_dx', 'u_dy', 'status'] as const;

export async function loadRun(path: string): Promise<RunData> {
  const summary = await get<RunSummary>(query('/api/run', { run: path }));
  const targets: TargetData[] = [];
  for (const { name, u_dx_mm, u_dy_mm, frames, ok } of summary.targets)
    targets.push({ name, u_dx_mm, u_dy_mm, frames, ok, columns: await series(path, name) });
  const first = targets[0]?.columns;
  const time = first?.time_s;
  const hasTime = time !== undefined && time.length > 0 && !time.some(Number.isNaN);
  const columns: Float64Array[] = [];
  const reported = targets.map((target) => {
    const at = columns.length;
    kColumns.forEach((key) => columns.push(target.columns[key]!));
    return { name: target.name, rows: { dx: at, dy: at + 1, ux: at + 2, uy: at + 3, status: at + 4 } };
  });
  const report = { targets: reported, statuses, exit_code: summary.exit_code } as unknown as Report;
  const abscissa = first ? abscissaFrom(first.frame, hasTime ? time : undefined) : undefined;
  return { path, summary, targets, columns, report, abscissa, hasTime };
}

// Range of the ok rows; undefined if there is none.
export function rangeOf(target: TargetData, axis: 'dx' | 'dy'): [number, number] | undefined {
  const values = valuesOf(target.columns[axis]!, target.columns.status!, true);
  const [low, high] = new Curve(values).extremes(0, values.length);
  return low > high ? undefined : [low, high];
}

// The part of the record that the plots show, as an option of the command line.
export function shownRange({ abscissa, hasTime }: RunData): string {
  const { min, max } = abscissa!.zoom;
  if (!hasTime) return `${Math.max(0, Math.ceil(min))}:${Math.floor(max) + 1}`;
  const text = (value: number): string => String(Number(value.toFixed(4)));
  return `${text(Math.max(0, min))}s:${text(max)}s`;
}

// Cells of a CSV file of the program: a header on line 1, no quotes around numbers.
export async function readCsv(file: Blob): Promise<Map<string, Float64Array | string[]>> {
  const [head, ...lines] = (await file.text()).trimEnd().split('\n');
  const cells = lines.map((line) => line.split(','));
  return new Map((head ?? '').split(',').map((name, k): [string, Float64Array | string[]] => {
    if (name.endsWith('status') || name === 'marker') return [name, cells.map((row) => row[k] ?? '')];
    return [name, Float64Array.from(cells, (row) => Number(row[k]))];
  }));
}
