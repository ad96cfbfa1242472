// What stands below the plots: budget, picture, origin.
import type { Report, Run } from './data';
import { el, section, table, type Cell } from './element';
import { brief, duration, expanded, micrometres } from './format';

const kParts: Record<string, string> = {
  noise: 'noise of the target\u2019s own print in one frame',
  references: 'noise of the references in one frame',
  reference_frame: 'both, in the reference frame',
  model: 'what four points cannot absorb: lens, depth, a bent board',
  lens: 'the camera, solved or given',
  geometry: 'places, turns and heights of the markers',
  axis: 'direction of the board\u2019s axes',
  print_scale: 'scale of the prints',
  codec: 'what a lossy codec left out',
  shutter: 'motion while the rows of a frame are read',
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
    rows.push(['standard uncertainty u of a displacement (k = 1)', total('x', 1), total('y', 1)]);
    rows.push(['95 % interval, \u00b1', total('x', expanded(1)), total('y', expanded(1))]);
    const block = table(`${target.name}: in micrometres, rms over all measured rows; bars are shares of the variance`, ['Cause', 'x (\u00b5m)', 'y (\u00b5m)'], rows);
    block.querySelectorAll('tbody tr:nth-last-child(-n+2)').forEach((row) => row.classList.add('total'));
    return block;
  });
  return section('budget', 'Where the uncertainty comes from', ...tables);
}

export function picture(of: Report, run: Run, source: string): HTMLElement | undefined {
  if (!source) return undefined;
  const what = run.reference_frame === null ? 'What was recognised in the first frame that was looked at'
    : `Reference frame ${run.reference_frame}. Blue: references, which must stand still. Orange: targets, which may move. Inner frames: where the print is read`;
  return section('picture', run.reference_frame === null ? 'What was seen' : 'Where it was measured',
    el('figure', { class: 'picture' }, el('img', { src: source, alt: `${what}; of ${of.input}` }), el('figcaption', {}, `${what}.`)));
}

// A value of run.json in words.
function said(value: unknown): string {
  if (value === null || value === undefined) return 'not given';
  if (typeof value === 'number') return brief(value);
  if (typeof value === 'boolean') return value ? 'yes' : 'no';
  if (typeof value === 'object')
    return Object.entries(value).map(([key, inner]) => `${key.replaceAll('_', ' ')} ${said(inner)}`).join(', ');
  return String(value);
}

function list(pairs: [string, string][]): HTMLElement {
  return el('dl', {}, ...pairs.flatMap(([name, value]) => [el('dt', {}, name), el('dd', {}, value)]));
}

export function origin(of: Report, run: Run): HTMLElement {
  const { input, camera, scene } = run;
  const pairs: [string, string][] = [
    ['Input', String(input.path)],
    ['SHA-256', String(input.sha256 || 'not taken')],
    ['Pictures', `${input.frames} of ${input.width} \u00d7 ${input.height} px, ${input.bits} bits, ${input.codec}` +
      (input.rotation_deg ? `, turned by ${input.rotation_deg}\u00b0` : '')],
    ['Time', input.time_source === 'none' ? 'the pictures carry none' : `${brief(Number(input.fps))} frames/s, from ${input.time_source === 'stream' ? 'the stream\u2019s time stamps' : '--fps'}`],
    ['Program', `moiregauge ${of.version}, method ${of.method.name}: ${of.method.summary}`],
    ['Reference frame', run.reference_frame === null ? 'none' : String(run.reference_frame)],
    ['Scene', `${scene.model}${scene.chi2_dof === null ? '' : `, chi\u00b2 per degree of freedom ${scene.chi2_dof.toFixed(2)} over ${scene.key_frames.length} key frames`}`],
  ];
  if (scene.readout_s) pairs.push(['Rolling shutter', `rows read over ${(1000 * scene.readout_s).toFixed(2)} ms (u ${(1000 * (scene.u_readout_s ?? 0)).toFixed(2)} ms)`]);
  const lens = ['fx', 'fy', 'cx', 'cy', 'k1', 'k2', 'p1', 'p2', 'k3'].filter((key) => typeof camera[key] === 'number')
    .map((key) => `${key} ${brief(camera[key] as number)}${camera.u[key] ? ` (u ${brief(camera.u[key]!)})` : ''}`);
  pairs.push(['Camera', lens.length > 0 ? lens.join(', ') : 'not known']);
  for (const [key, value] of Object.entries(run.config)) {
    const word = key.replaceAll('_', ' ');
    pairs.push([word.charAt(0).toUpperCase() + word.slice(1), said(value)]);
  }
  return section('origin', 'Where this comes from', list(pairs),
    el('p', { class: 'small' }, 'Every number stands in displacement.csv and displacement.h5 beside this page, all of the above in run.json. ' +
      'u is a standard uncertainty (k = 1); bands and \u00b1 are 95 % intervals, 1.96 u. Displacements are those of a target relative to the references since the reference frame; right and up are positive.'));
}

export function counts(run: Run, of: Report): HTMLElement {
  const rows = run.targets.map((target): (string | Cell)[] => [target.name, { text: String(target.frames), isNumber: true },
    { text: String(target.ok), isNumber: true },
    Object.entries(target.status_counts).filter(([word]) => word !== 'ok')
      .map(([word, count]) => `${count} ${word} (${of.statuses.find((s) => s.word === word)?.meaning ?? ''})`).join('; ') || 'none']);
  return table('Rows by status', ['Target', 'Rows', 'ok', 'Others'], rows);
}

export { duration };
