// The set-up of one clip, and the options of the command line that state it.
import { post, type Box, type Entry, type FoundMarker, type Inspection, type Role } from '../api';

export interface Range {
  from: number; // frames, half open
  to: number;
}

export interface Setup {
  path: string;
  pitch_mm: number;
  isChecked: boolean; // the user has confirmed the distance
  siteFile?: string; // used instead of the pitch
  siteText?: string;
  frame: number;
  roles: Map<string, Exclude<Role, 'none'>>; // by the found name, where the user has changed it
  names: Map<string, string>; // new names by found names
  regions: Box[];
  excluded: Box[];
  zero?: Range;
  rest?: Range;
  lens?: string; // camera file
  found?: Inspection; // without the user's choice of markers
  chosen?: Inspection; // with it
}

const kPitchKey = 'moiregauge-pitch-mm';
const kFirstPitch_mm = 10; // default of `moiregauge sheet`
export const kPitches_mm = [1, 2, 2.5, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 60, 80, 100, 120, 150, 200];

const setups = new Map<string, Setup>();

// Returns the clip's set-up. A new one starts with the pitch used last in this browser.
export function setupOf(entry: Entry): Setup {
  const known = setups.get(entry.path);
  if (known) return known;
  const last = Number(localStorage.getItem(kPitchKey));
  const made: Setup = {
    path: entry.path, pitch_mm: last > 0 ? last : kFirstPitch_mm, isChecked: false, siteFile: entry.site, frame: 0,
    roles: new Map(), names: new Map(), regions: [], excluded: [],
  };
  setups.set(entry.path, made);
  return made;
}

export const rememberPitch = (pitch_mm: number): void => localStorage.setItem(kPitchKey, String(pitch_mm));

export const pitchText = (setup: Setup): string => `${Number(setup.pitch_mm.toPrecision(6))}mm`;

export const roleOf = (setup: Setup, marker: FoundMarker): Role => setup.roles.get(marker.name) ?? marker.role;

export const nameOf = (setup: Setup, found: string): string => setup.names.get(found) ?? found;

export const hasChoice = (setup: Setup): boolean => setup.roles.size > 0 || setup.names.size > 0;

interface Choice {
  references: string[];
  targets: string[];
  ignore: string[];
}

// A list of --references is complete, so it names all of them as soon as one joins; the same holds for --targets.
export function choiceOf(setup: Setup): Choice {
  const markers = setup.found?.markers ?? [];
  const withRole = (role: Role): FoundMarker[] => markers.filter((marker) => roleOf(setup, marker) === role);
  const list = (role: Role): string[] => {
    const now = withRole(role);
    return now.some((marker) => marker.role !== role) ? now.map(({ name }) => name) : [];
  };
  const ignore = withRole('ignored').filter(({ role }) => role !== 'ignored').map(({ name }) => name);
  return { references: list('reference'), targets: list('target'), ignore };
}

const boxText = (box: Box): string => box.map((value) => Math.round(value)).join(',');
const rangeText = ({ from, to }: Range): string => `${from}:${to}`;

// Options that choose markers, for measure, inspect and live.
export function markerOptions(setup: Setup): string[] {
  const options = setup.siteFile ? ['--site', setup.siteFile] : ['--pitch', pitchText(setup)];
  const { references, targets, ignore } = choiceOf(setup);
  if (references.length > 0) options.push('--references', references.join(','));
  if (targets.length > 0) options.push('--targets', targets.join(','));
  if (ignore.length > 0) options.push('--ignore', ignore.join(','));
  setup.names.forEach((name, found) => options.push('--name', `${found}=${name}`));
  setup.regions.forEach((box) => options.push('--region', boxText(box)));
  setup.excluded.forEach((box) => options.push('--exclude-region', boxText(box)));
  return options;
}

// The run directory of a clip: next to it, as the command names it.
export const runOf = (path: string): string => `${path.replace(/\.[^./]+$/, '')}-moiregauge`;

export function measureArguments(setup: Setup): string[] {
  const args = [setup.path, ...markerOptions(setup)];
  if (setup.lens) args.push('--camera', setup.lens);
  if (setup.frame > 0) args.push('--reference-frame', String(setup.frame));
  if (setup.zero) args.push('--zero', rangeText(setup.zero));
  if (setup.rest) args.push('--rest', rangeText(setup.rest));
  if (setup.path.includes('/')) args.push('-o', runOf(setup.path));
  return args;
}

// The body of POST /api/inspect.
export function inspectBody(setup: Setup, withChoice: boolean): Record<string, unknown> {
  const body: Record<string, unknown> = { path: setup.path, frame: setup.frame };
  if (setup.siteFile && setup.siteText !== undefined) body.site = setup.siteText;
  else body.pitch = pitchText(setup);
  if (setup.regions.length > 0) body.region = setup.regions.length === 1 ? setup.regions[0] : setup.regions;
  if (setup.excluded.length > 0) body.exclude = setup.excluded;
  if (!withChoice) return body;
  const { references, targets, ignore } = choiceOf(setup);
  if (references.length > 0) body.references = references;
  if (targets.length > 0) body.targets = targets;
  if (ignore.length > 0) body.ignore = ignore;
  return body;
}

const kKept = 24; // inspections
const inspections = new Map<string, Inspection>();

// Inspects a frame, or returns the stored result of the same request. Names do not change what is found.
export async function inspection(setup: Setup, withChoice: boolean, signal?: AbortSignal): Promise<Inspection> {
  const body = inspectBody(setup, withChoice);
  const key = JSON.stringify(body);
  const known = inspections.get(key);
  if (known) return known;
  const found = await post<Inspection>('/api/inspect', body, signal);
  inspections.set(key, found);
  if (inspections.size > kKept) inspections.delete(inspections.keys().next().value!);
  return found;
}

// Returns the text of the site file, with new names.
export async function siteText(setup: Setup): Promise<string> {
  if (setup.names.size === 0) return (await inspection(setup, true)).site;
  return (await post<Inspection>('/api/inspect', { ...inspectBody(setup, true), names: Object.fromEntries(setup.names) })).site;
}
