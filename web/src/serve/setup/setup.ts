// Set up in the picture: pitch, roles and names of the markers, areas, zero and rest, with the expected U before measuring.
import { commandText, get, picture, post, query, series, type Box, type Entry, type FoundMarker, type Inspection, type Role } from '../api';
import { attempt, button, card, commandBox, field, say, sayProblem, select } from '../parts/parts';
import { entries, fileAt, refreshEntries } from '../store';
import { FramePicture, roleWords, type ShownMarker, type Tool } from './picture';
import { Timeline } from './timeline';
import { hasChoice, inspection, kPitches_mm, measureArguments, nameOf, rememberPitch, roleOf, setupOf, siteText, type Setup } from './state';
import { digitsFor, expanded, plain, sentence } from '../../format';
import { el } from '../../element';

const kWait_ms = 250; // after the last change, before the frame is inspected
const kMaxMarkersWithList = 60; // more are edited in the picture only

export class SetupView {
  readonly element: HTMLElement;
  private readonly setup: Setup;
  private readonly frame = new FramePicture('First frame with its markers');
  private readonly timeline: Timeline;
  private readonly panel = el('div', { class: 'panel' });
  private readonly status = el('p', { class: 'status-line', role: 'status', 'aria-live': 'polite' });
  private readonly command = commandBox();
  private readonly popover = el('div', { class: 'popover', role: 'dialog', 'aria-label': 'Marker' });
  private readonly pitch = el('input', { type: 'text', inputmode: 'decimal', class: 'pitch', 'aria-label': 'Pitch of the gratings in mm' });
  private readonly distance = el('div', { class: 'distance' });
  private readonly markers = el('div', { class: 'markers' });
  private readonly expected = el('div', { class: 'expected' });
  private readonly areas = el('ul', { class: 'areas' });
  private readonly remarks = el('ul', { class: 'remarks' });
  private readonly measure: HTMLButtonElement;
  private abort = new AbortController();
  private frameAbort = new AbortController();
  private timer?: ReturnType<typeof setTimeout>;

  constructor(private readonly entry: Entry, private readonly onMeasure: (args: string[]) => Promise<void>) {
    this.setup = setupOf(entry);
    this.measure = button('Measure', () => void this.start(), { class: 'primary' });
    this.timeline = new Timeline([
      { name: 'Zero', meaning: 'the reference frame is zero', range: this.setup.zero, onChange: (range) => this.changeRange('zero', range) },
      { name: 'Rest', meaning: 'no rest is stated', range: this.setup.rest, onChange: (range) => this.changeRange('rest', range) },
    ]);
    this.timeline.onFrame = (frame) => {
      this.setup.frame = frame;
      void this.showFrame();
      this.later();
    };
    this.popover.hidden = true;
    this.frame.element.append(this.popover);
    this.frame.onMarker = (shown) => this.edit(shown);
    this.frame.onBox = (tool, box) => this.addBox(tool, box);
    this.frame.onEnlarge = () => void this.showFrame();
    this.fillPanel();
    this.element = el('div', { class: 'setup' }, el('div', { class: 'work' }, this.tools(), this.frame.element, this.timeline.element, this.status), this.panel);
    this.popover.addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.closePopover();
    });
    void this.begin();
  }

  leave(): void {
    this.abort.abort();
    this.frameAbort.abort();
    clearTimeout(this.timer);
  }

  private async begin(): Promise<void> {
    await attempt(async () => {
      if (this.setup.siteFile && this.setup.siteText === undefined) this.setup.siteText = await (await fileAt(this.setup.siteFile)).text();
    });
    void this.showFrame();
    void this.inspect();
  }

  private tools(): HTMLElement {
    const tools: [Tool, string, string][] = [['select', 'Select', 'Click a marker to change it'], ['look', 'Look here', 'Drag a box: markers are searched only inside'],
      ['ignore', 'Ignore here', 'Drag a box: nothing inside is a marker']];
    const hint = el('span', { class: 'quiet hint' }, tools[0]![2]);
    const buttons = tools.map(([tool, text, meaning]) => button(text, () => {
      this.frame.tool = tool;
      this.frame.element.dataset.tool = tool;
      buttons.forEach((one, k) => one.setAttribute('aria-pressed', String(tools[k]![0] === tool)));
      hint.textContent = meaning;
    }, { 'aria-pressed': String(tool === 'select'), title: meaning }));
    return el('div', { class: 'tools', role: 'toolbar', 'aria-label': 'Tools of the picture' }, el('div', { class: 'segments' }, ...buttons), hint);
  }

  private fillPanel(): void {
    this.panel.append(this.scaleCard(), card('Expected before measuring', this.expected), card('Markers', this.markers), this.areaCard(), this.moreCard(), this.remarks, this.command.element,
      el('div', { class: 'go stuck' }, this.measure, button('Save as site.toml', () => void this.saveSite())));
    this.drawPitch();
  }

  private scaleCard(): HTMLElement {
    const step = (by: number): void => {
      const { pitch_mm } = this.setup;
      const next = by > 0 ? kPitches_mm.find((one) => one > pitch_mm) : [...kPitches_mm].reverse().find((one) => one < pitch_mm);
      if (next !== undefined) this.setPitch(next);
    };
    this.pitch.addEventListener('change', () => {
      const value = Number(this.pitch.value.replace(',', '.').replace(/\s*mm$/, ''));
      if (value > 0 && Number.isFinite(value)) this.setPitch(value);
      else {
        say('The pitch is a length in mm, such as 10.', 'bad');
        this.drawPitch();
      }
    });
    const own = el('div', { class: 'pitch-row' }, el('span', {}, 'Grating pitch'),
      el('span', { class: 'stepper' }, button('\u2212', () => step(-1), { 'aria-label': 'Smaller pitch' }), this.pitch, el('span', { class: 'unit' }, 'mm'),
        button('+', () => step(1), { 'aria-label': 'Larger pitch' })));
    const body = card('Scale');
    if (this.entry.site) {
      const site = this.entry.site;
      body.append(select([['site', `Site file ${site}`], ['pitch', 'Pitch only']], this.setup.siteFile ? 'site' : 'pitch', (value) => {
        this.setup.siteFile = value === 'site' ? site : undefined;
        own.hidden = value === 'site';
        void this.begin();
      }, 'Where the markers come from'));
      own.hidden = this.setup.siteFile !== undefined;
    }
    body.append(own, this.distance);
    return body;
  }

  private setPitch(pitch_mm: number): void {
    this.setup.pitch_mm = pitch_mm;
    this.setup.isChecked = false;
    rememberPitch(pitch_mm);
    this.drawPitch();
    this.later();
  }

  private drawPitch(): void {
    this.pitch.value = String(Number(this.setup.pitch_mm.toPrecision(6)));
    this.drawDistance();
    this.command.set(commandText('measure', measureArguments(this.setup)));
  }

  // "R1 to R2: 256 mm: right?", with the length that a tape shows instead.
  private drawDistance(): void {
    const found = this.setup.found?.distances[0];
    if (!found) {
      this.distance.replaceChildren(el('p', { class: 'quiet' }, 'The distance between two references appears here.'));
      return;
    }
    const { siteFile, isChecked } = this.setup;
    const name = `${nameOf(this.setup, found.from)} to ${nameOf(this.setup, found.to)}`;
    const right = button(isChecked ? '\u2713 Checked' : 'Yes, right', () => {
      this.setup.isChecked = true;
      this.drawDistance();
    }, { class: isChecked ? 'small checked' : 'small' });
    const tape = el('input', { type: 'text', inputmode: 'decimal', 'aria-label': `Distance ${name} by tape in mm` });
    tape.addEventListener('change', () => {
      const value = Number(tape.value.replace(',', '.'));
      if (value > 0 && Number.isFinite(value)) this.setPitch(Number(((this.setup.pitch_mm * value) / found.mm).toPrecision(5)));
    });
    this.distance.replaceChildren(el('p', {}, `${name}: `, el('strong', {}, `${plain(found.mm, found.mm < 100 ? 2 : 1)} mm`), '. Is that right?'),
      el('div', { class: 'row' }, right, !siteFile && field('or by tape', tape, 'mm')));
  }

  private areaCard(): HTMLElement {
    return card('Areas', this.areas);
  }

  private moreCard(): HTMLElement {
    const cameras = entries.flatMap(({ kind, path, run, exit_code }) => (kind === 'camera' ? [path] : kind === 'run' && exit_code !== 4 ? [`${run ?? path}/camera.toml`] : []));
    const lens = select([['', 'solved from the footage'], ...cameras.map((path): [string, string] => [path, path])], this.setup.lens ?? '', (value) => {
      this.setup.lens = value || undefined;
      this.drawPitch();
    }, 'Lens');
    return card('Lens', field('Lens', lens));
  }

  private changeRange(key: 'zero' | 'rest', range: Setup['zero']): void {
    this.setup[key] = range;
    this.drawPitch();
    if (key === 'rest' && range) void this.checkRest(range);
  }

  // An earlier run of this clip shows whether the targets move in these frames. Without one, measuring checks it.
  private async checkRest({ from, to }: NonNullable<Setup['rest']>): Promise<void> {
    const { run } = this.entry;
    if (!run) {
      this.status.textContent = 'Rest is checked when the measurement ends: a target that moves there is named.';
      return;
    }
    await attempt(async () => {
      const { targets } = await get<{ targets: { name: string; u_dy_mm: number | null }[] }>(query('/api/run', { run }));
      for (const { name } of targets) {
        const columns = await series(run, name);
        for (const axis of ['dx', 'dy'] as const) {
          const values = [...columns[axis]!.keys()].filter((k) => columns.frame![k]! >= from && columns.frame![k]! < to && columns.status![k] === 0);
          if (values.length < 2) continue;
          const all = values.map((k) => columns[axis]![k]!);
          const u = values.reduce((sum, k) => sum + columns[`u_${axis}`]![k]!, 0) / values.length;
          const moved = Math.max(...all) - Math.min(...all);
          if (!(moved > 6 * u)) continue;
          this.status.textContent = `${name} moves by ${plain(moved, digitsFor(2 * u))} mm (${axis}) in these frames, so they are not at rest. Choose others.`;
          return;
        }
      }
      this.status.textContent = 'No target moves in these frames beyond its uncertainty.';
    });
  }

  private addBox(tool: 'look' | 'ignore', box: Box): void {
    (tool === 'look' ? this.setup.regions : this.setup.excluded).push(box);
    this.drawAreas();
    this.later();
  }

  private drawAreas(): void {
    const line = (list: Box[], words: string) => list.map((box, k) => el('li', {}, `${words}: ${box[2]} \u00d7 ${box[3]} px at (${box[0]}, ${box[1]})`,
      button('\u00d7', () => {
        list.splice(k, 1);
        this.drawAreas();
        this.later();
      }, { class: 'quiet', 'aria-label': `Remove this area: ${words}` })));
    const all = [...line(this.setup.regions, 'Look only here'), ...line(this.setup.excluded, 'Ignore')];
    this.areas.replaceChildren(...(all.length > 0 ? all : [el('li', { class: 'quiet' }, 'The whole picture is searched.')]));
  }

  private async showFrame(): Promise<void> {
    this.frameAbort.abort();
    this.frameAbort = new AbortController();
    const { path, frame } = this.setup;
    await attempt(async () => {
      const shown = await picture(query('/api/frame', { path, frame, max_width: this.frame.wantedWidth }), this.frameAbort.signal);
      await this.frame.show(shown.blob, shown.width, shown.height);
      this.timeline.set(frame, shown.frames, shown.time_s);
      document.documentElement.dataset.frame = String(frame);
    });
  }

  private later(): void {
    this.drawPitch();
    clearTimeout(this.timer);
    this.element.setAttribute('aria-busy', 'true');
    this.timer = setTimeout(() => void this.inspect(), kWait_ms);
  }

  private async inspect(): Promise<void> {
    this.abort.abort();
    this.abort = new AbortController();
    const { signal } = this.abort;
    this.element.setAttribute('aria-busy', 'true');
    try {
      this.setup.found = await inspection(this.setup, false, signal);
      this.setup.chosen = await inspection(this.setup, true, signal);
      this.status.textContent = '';
    } catch (problem) {
      if (signal.aborted) return;
      this.status.textContent = problem instanceof Error ? problem.message : String(problem);
      this.setup.chosen = undefined;
    }
    this.element.removeAttribute('aria-busy');
    this.draw();
    const { dataset } = document.documentElement;
    dataset.inspected = String(Number(dataset.inspected ?? 0) + 1);
  }

  private shown(): ShownMarker[] {
    return (this.setup.found?.markers ?? []).map((marker) => ({ marker, name: nameOf(this.setup, marker.name), role: roleOf(this.setup, marker) }));
  }

  private draw(): void {
    const { setup } = this;
    const now = setup.chosen ?? setup.found;
    this.frame.mark(this.shown(), [...setup.regions.map((box) => ({ box, isExcluded: false })), ...setup.excluded.map((box) => ({ box, isExcluded: true }))],
      setup.found?.mm_per_px ?? undefined);
    this.drawDistance();
    this.drawMarkers();
    this.drawExpected(now);
    this.drawAreas();
    this.remarks.replaceChildren(...(now?.warnings ?? []).map((text) => el('li', {}, sentence(text))));
    if (now?.measurable === false && now.missing) this.status.textContent = sentence(now.missing);
    this.measure.disabled = now === undefined || now.measurable === false;
  }

  private drawExpected(now: Inspection | undefined): void {
    const targets = (now?.markers ?? []).filter(({ u_dx_mm, u_dy_mm }) => u_dx_mm != null || u_dy_mm != null);
    const value = (u: number | null | undefined): string => (u == null ? '\u2013' : plain(expanded(u), digitsFor(expanded(u))));
    if (targets.length === 0) {
      this.expected.replaceChildren(el('p', { class: 'quiet' }, 'No target is found yet.'));
      return;
    }
    this.expected.replaceChildren(el('table', {}, el('caption', { class: 'quiet' }, 'U of one displacement in mm (k = 2), by noise and codec'),
      el('thead', {}, el('tr', {}, el('th', { scope: 'col' }, 'Target'), el('th', { scope: 'col', class: 'number' }, 'dx'), el('th', { scope: 'col', class: 'number' }, 'dy'))),
      el('tbody', {}, ...targets.map(({ name, u_dx_mm, u_dy_mm }) => el('tr', {}, el('th', { scope: 'row' }, nameOf(this.setup, name)), el('td', { class: 'number' }, value(u_dx_mm)), el('td', { class: 'number' }, value(u_dy_mm)))))));
  }

  private drawMarkers(): void {
    const all = this.shown().filter(({ marker }) => marker.name !== '');
    const used = all.filter(({ role }) => role === 'reference' || role === 'target').length;
    if (all.length === 0) {
      this.markers.replaceChildren(el('p', { class: 'quiet' }, 'No marker is found in this frame.'));
      return;
    }
    const count = (role: Role): number => all.filter((one) => one.role === role).length;
    const counted = (n: number, what: string): string => `${n} ${what}${n === 1 ? '' : 's'}`;
    const summary = el('p', {}, `${counted(count('reference'), 'reference')} and ${counted(count('target'), 'target')}.`, used < all.length ? ` ${all.length - used} not used.` : '');
    const list = all.slice(0, kMaxMarkersWithList).map((shown) => el('li', { class: shown.role }, this.nameField(shown),
      select([['reference', 'reference'], ['target', 'target'], ['ignored', 'ignore'], ...(shown.role === 'none' ? [['none', 'not used'] as [string, string]] : [])], shown.role,
        (role) => this.setRole(shown.marker, role as Role), `Role of ${shown.name}`)));
    this.markers.replaceChildren(summary, el('ul', { class: 'marker-list' }, ...list),
      ...(hasChoice(this.setup) ? [button('As found', () => {
        this.setup.roles.clear();
        this.setup.names.clear();
        this.later();
        this.draw();
      }, { class: 'small' })] : []));
  }

  private nameField({ marker, name }: ShownMarker): HTMLInputElement {
    const box = el('input', { type: 'text', value: name, 'aria-label': `Name of ${name}`, maxlength: '40', spellcheck: 'false' });
    box.addEventListener('change', () => this.rename(marker, box.value.trim()));
    return box;
  }

  private rename(marker: FoundMarker, name: string): void {
    if (name === '' || name === marker.name) this.setup.names.delete(marker.name);
    else this.setup.names.set(marker.name, name);
    this.draw();
    this.later();
  }

  private setRole(marker: FoundMarker, role: Role): void {
    if (role === marker.role || role === 'none') this.setup.roles.delete(marker.name);
    else this.setup.roles.set(marker.name, role);
    this.draw();
    this.later();
  }

  // The small window at a marker that was clicked.
  private edit(shown: ShownMarker): void {
    const { marker, name, role } = shown;
    const name_field = this.nameField(shown);
    const roles: Role[] = ['reference', 'target', 'ignored'];
    const choices = roles.map((one) => button(one === 'ignored' ? 'Ignore' : one === 'target' ? 'Target' : 'Reference', () => {
      this.closePopover();
      this.setRole(marker, one);
    }, { 'aria-pressed': String(one === role), title: roleWords[one] }));
    const facts = [marker.pitch_px ? `pitch ${plain(marker.pitch_px, 1)} px` : '', roleWords[role]].filter((text) => text !== '').join(', ');
    this.popover.replaceChildren(el('div', { class: 'row' }, el('strong', {}, name), el('span', { class: 'quiet' }, facts),
      button('\u00d7', () => this.closePopover(), { class: 'quiet', 'aria-label': 'Close' })), el('div', { class: 'segments' }, ...choices), field('Name', name_field));
    name_field.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') this.closePopover();
    });
    this.popover.hidden = false;
    const group = [...this.frame.element.querySelectorAll<SVGElement>('[data-marker]')].find(({ dataset }) => dataset.marker === marker.name);
    if (group) {
      const at = group.getBoundingClientRect();
      const area = this.frame.element.getBoundingClientRect();
      const left = Math.max(8, Math.min(area.width - this.popover.offsetWidth - 8, at.left + at.width / 2 - area.left - this.popover.offsetWidth / 2));
      const below = at.bottom - area.top + 8;
      const isRoom = below + this.popover.offsetHeight < area.height;
      this.popover.style.left = `${left}px`;
      this.popover.style.top = `${isRoom ? below : Math.max(8, at.top - area.top - this.popover.offsetHeight - 8)}px`;
    }
    choices[Math.max(0, roles.indexOf(role))]!.focus();
  }

  private closePopover(): void {
    this.popover.hidden = true;
  }

  private async saveSite(): Promise<void> {
    if (this.element.hasAttribute('aria-busy')) {
      clearTimeout(this.timer);
      await this.inspect();
    }
    const { path } = this.setup;
    await attempt(async () => {
      const text = await siteText(this.setup);
      if (!text) throw new Error('No site file can be written before the markers are found.');
      const saved = await post<{ path: string }>('/api/site', { path, text });
      this.entry.site = saved.path;
      say(`Saved as ${saved.path}. It can be read and edited as text.`);
      await refreshEntries();
    });
  }

  private async start(): Promise<void> {
    this.measure.disabled = true;
    try {
      await this.onMeasure(measureArguments(this.setup));
    } catch (problem) {
      sayProblem(problem);
    }
    this.measure.disabled = false;
  }
}
