// Sections below the plots: budget, image, origin.
import type { Report, Run } from './data';
import { el, section, table, type Cell } from './element';
import { brief, duration, expanded, micrometres } from './format';

const kParts: Record<string, string> = {
  noise: 'noise in the target\u2019s grating, one frame',
  references: 'noise in the references, one frame',
  reference_frame: 'both, in the reference frame',
  model: 'lens, depth or a bent board, as far as four points cannot correct them',
  lens: 'camera and lens, solved or given',
  geometry: 'positions, rotations and heights of the markers',
  axis: 'direction of the board axes',
  print_scale: 'print scale',
  codec: 'compression (codec)',
  shutter: 'rolling shutter',
};

export function budget(run: Run): HTMLElement {
  const tables = run.targets.map((target) => {
    const rows: (string | Cell)[][] = [];
    const u = { x: target.u_dx_mm, y: target.u_dy_mm };
    for (const [part, value] of Object.entries(target.budget)) {
      if (!value.x_mm && !value.y_mm) continue;
      const cell = (axis: 'x' | 'y'): Cell => {
        const part_u = axis === 'x' ? value.x_mm : value.y_mm;
        const all = u[axis];
        if (part_u === null || !all) return { text: '\u2013', isNumber: true };
        return { text: micrometres(part_u), isNumber: true, bar: Math.min(1, (part_u / all) ** 2) };
      };
      rows.push([kParts[part] ?? part, cell('x'), cell('y')]);
    }
    const total = (axis: 'x' | 'y', k: number): Cell => ({ text: u[axis] === null ? '\u2013' : micrometres(k * u[axis]!), isNumber: true });
    rows.push(['standard uncertainty u (k = 1)', total('x', 1), total('y', 1)]);
    rows.push(['expanded uncertainty U (k = 2)', total('x', expanded(1)), total('y', expanded(1))]);
    const block = table(`${target.name}, rms over all measured rows (bars: shares of the variance)`, ['Cause', 'dx (\u00b5m)', 'dy (\u00b5m)'], rows);
    block.querySelectorAll('tbody tr:nth-last-child(-n+2)').forEach((row) => row.classList.add('total'));
    return block;
  });
  return section('budget', 'Uncertainty budget', ...tables);
}

export function picture(of: Report, run: Run, source: string): HTMLElement | undefined {
  if (!source) return undefined;
  const what = run.reference_frame === null ? 'Everything that was found in the first frame'
    : `Reference frame ${run.reference_frame}. Blue: references, which must not move. Orange: targets, which may move. Inner frames: areas in which the gratings are read`;
  return section('picture', run.reference_frame === null ? 'What was found' : 'Markers',
    el('figure', { class: 'picture' }, el('img', { src: source, alt: `${what}; of ${of.input}` }), el('figcaption', {}, `${what}.`)));
}

type Settings = Record<string, unknown>;

// "0 to 59, every 2nd frame" and the like: --frames and --rest.
function framesText(range: unknown, none: string): string {
  if (range === null || typeof range !== 'object') return none;
  const { first, end, step } = range as { first: number; end: number | null; step: number };
  const from = first === 0 && end === null ? 'all' : `${first} to ${end === null ? 'the last' : end - 1}`;
  return step > 1 ? `${from}, one in ${step}` : from;
}

// Returns the user's settings from run.json's config. Settings for experts are in run.json only.
function settings(config: Settings, tone: unknown): [string, string][] {
  const pairs: [string, string][] = [['Frames measured', framesText(config.frames, 'all')], ['Frames at rest', framesText(config.rest, 'none stated')]];
  const readout = config.readout_s;
  pairs.push(['Readout time', typeof readout !== 'number' ? 'solved if the footage shows a rolling shutter' : readout === 0 ? 'none (--readout)' : `${brief(1000 * readout)} ms (--readout)`]);
  if (typeof config.pitch_mm === 'number') {
    pairs.push(['Pitch', `${brief(config.pitch_mm)} mm (--pitch)`]);
    pairs.push(['Direction of x', config.axes === 'image' ? 'the image' : 'the gratings of the references']);
  } else {
    pairs.push(['Pitch', 'as in the site file']);
  }
  const scale = config.print_scale as { factor?: number; u?: number | null } | undefined;
  if (scale) pairs.push(['Print scale', scale.factor === 1 && !scale.u ? 'nominal, rulers not measured' : `${scale.factor}${scale.u ? ` (u ${scale.u})` : ''}`]);
  pairs.push(['Tone curve', config.tone === 'auto' ? `${String(tone)} (automatic)` : `${String(config.tone)} (--tone)`]);
  pairs.push(['Harmonics', config.template === 'auto' ? 'used where they reduce the residuals' : config.template === 'on' ? 'used (--template)' : 'not used (--template)']);
  const known = config.known_to as Record<string, number> | undefined;
  if (known)
    pairs.push(['Site known to', `positions ${known.position_mm} mm, rotations ${known.rotation_deg}\u00b0, heights ${known.height_mm} mm, print scale ${brief(100 * known.print_scale!)} % (all u)`]);
  return pairs;
}

function list(pairs: [string, string][]): HTMLElement {
  return el('dl', {}, ...pairs.flatMap(([name, value]) => [el('dt', {}, name), el('dd', {}, value)]));
}

export function origin(of: Report, run: Run): HTMLElement {
  const { input, camera, scene } = run;
  const pairs: [string, string][] = [
    ['Input', String(input.path)],
    ['SHA-256', String(input.sha256 || 'not computed')],
    ['Frames', `${input.frames} of ${input.width} \u00d7 ${input.height} px, ${input.bits} bits, ${input.codec}` +
      (input.rotation_deg ? `, rotated by ${input.rotation_deg}\u00b0` : '')],
    ['Times', input.time_source === 'none' ? 'none (give --fps)' : `${brief(Number(input.fps))} frames/s, from ${input.time_source === 'stream' ? 'the stream\u2019s time stamps' : '--fps'}`],
    ['Program', `moiregauge ${of.version}, method ${of.method.name} (${of.method.summary})`],
    ['Reference frame', run.reference_frame === null ? 'none' : `${run.reference_frame}, where every displacement is zero`],
    ...settings(run.config, input.tone),
    ['Scene model', `${scene.model}${scene.chi2_dof === null ? '' : `, \u03c7\u00b2 per degree of freedom ${scene.chi2_dof.toFixed(2)} over ${scene.key_frames.length} key frames`}`],
  ];
  if (scene.readout_s) pairs.push(['Rolling shutter', `readout time ${(1000 * scene.readout_s).toFixed(2)} ms (u ${(1000 * (scene.u_readout_s ?? 0)).toFixed(2)} ms), corrected`]);
  const lens = ['fx', 'fy', 'cx', 'cy', 'k1', 'k2', 'p1', 'p2', 'k3'].filter((key) => typeof camera[key] === 'number')
    .map((key) => `${key} ${brief(camera[key] as number)}${camera.u[key] ? ` (u ${brief(camera.u[key]!)})` : ''}`);
  pairs.push(['Camera', lens.length > 0 ? lens.join(', ') : 'unknown']);
  return section('origin', 'Settings', list(pairs),
    el('p', { class: 'small' }, 'Every number is in displacement.csv and displacement.h5 next to this page, and every setting in run.json. ' +
      'u is a standard uncertainty (k = 1). Bands and \u00b1 are U = 2 u (k = 2), about 95 %. ' +
      'Displacements are relative to the references, since the reference frame. Right and up are positive.'));
}

export function counts(run: Run, of: Report): HTMLElement {
  const rows = run.targets.map((target): (string | Cell)[] => [target.name, { text: String(target.frames), isNumber: true },
    { text: String(target.ok), isNumber: true },
    Object.entries(target.status_counts).filter(([word]) => word !== 'ok')
      .map(([word, count]) => `${count} ${word} (${of.statuses.find((s) => s.word === word)?.meaning ?? ''})`).join('; ') || 'none']);
  return table('Rows by status', ['Target', 'Rows', 'ok', 'Others'], rows);
}

export { duration };
