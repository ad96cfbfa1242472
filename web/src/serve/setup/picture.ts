// One frame with its markers outlined and named, a scale bar and boxes. Markers can be clicked, boxes drawn, the image enlarged.
import type { Box, FoundMarker, Point, Role } from '../api';
import { button, showBlob } from '../parts/parts';
import { el } from '../../element';

export interface ShownMarker {
  marker: FoundMarker;
  name: string;
  role: Role;
}

export type Tool = 'select' | 'look' | 'ignore';

export const roleWords: Record<Role, string> = { reference: 'reference, must not move', target: 'target, moves', ignored: 'ignored', none: 'not used' };

const kSvg = 'http://www.w3.org/2000/svg';
const kBar_px = 150; // longest scale bar, screen pixels
const kLabel_px = 13;
const kLeastBox_px = 8; // a smaller drag is a click
const kZooms = [1, 1.5, 2, 3, 4, 6, 8];

function svg(name: string, attributes: Record<string, string | number>, ...children: (Node | string)[]): SVGElement {
  const made = document.createElementNS(kSvg, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  made.append(...children);
  return made;
}

const centreOf = (points: Point[]): Point =>
  [points.reduce((sum, [x]) => sum + x, 0) / points.length, points.reduce((sum, [, y]) => sum + y, 0) / points.length];

// The longest round length that fits.
export function roundLength(most_mm: number): number {
  const decade = 10 ** Math.floor(Math.log10(most_mm));
  return [5, 2, 1].map((digit) => digit * decade).find((length) => length <= most_mm) ?? decade;
}

export class FramePicture {
  readonly element: HTMLElement;
  tool: Tool = 'select';
  onMarker?: (marker: ShownMarker, at: DOMRect) => void;
  onBox?: (tool: Exclude<Tool, 'select'>, box: Box) => void;
  onEnlarge?: () => void; // a finer image is useful
  private readonly image = el('img', { alt: '', draggable: 'false' });
  private readonly drawing = svg('svg', { class: 'drawing', role: 'group', 'aria-label': 'Markers in the picture' });
  private readonly stage = el('div', { class: 'stage' });
  private readonly view = el('div', { class: 'picture-view' });
  private width = 0; // frame, px
  private height = 0;
  private zoom = 1;
  private markers: ShownMarker[] = [];
  private boxes: { box: Box; isExcluded: boolean }[] = [];
  private mmPerPx?: number;

  constructor(label: string) {
    this.stage.append(this.image, this.drawing);
    this.view.append(this.stage);
    const zooms = el('div', { class: 'zooms', role: 'group', 'aria-label': 'Size of the picture' },
      button('\u2212', () => this.enlarge(-1), { 'aria-label': 'Smaller' }), button('+', () => this.enlarge(1), { 'aria-label': 'Larger' }));
    this.element = el('div', { class: 'picture', role: 'region', 'aria-label': label }, this.view, zooms);
    this.drawing.addEventListener('pointerdown', (event) => this.startBox(event as PointerEvent));
    new ResizeObserver(() => this.draw()).observe(this.view);
    this.view.addEventListener('wheel', (event) => {
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.enlarge(event.deltaY < 0 ? 1 : -1);
    }, { passive: false });
  }

  // Width in device pixels that the image can show.
  get wantedWidth(): number {
    return Math.ceil((this.view.clientWidth || 900) * this.zoom * devicePixelRatio);
  }

  async show(blob: Blob, width: number, height: number): Promise<void> {
    const isOther = width !== this.width || height !== this.height;
    this.width = width;
    this.height = height;
    this.drawing.setAttribute('viewBox', `-0.5 -0.5 ${width} ${height}`); // pixel centres are whole numbers
    this.stage.style.aspectRatio = `${width} / ${height}`;
    await showBlob(this.image, blob);
    if (isOther) this.draw();
  }

  mark(markers: ShownMarker[], boxes: { box: Box; isExcluded: boolean }[], mmPerPx?: number): void {
    this.markers = markers;
    this.boxes = boxes;
    this.mmPerPx = mmPerPx;
    this.draw();
  }

  private enlarge(step: number): void {
    const at = kZooms.indexOf(this.zoom) + step;
    if (at < 0 || at >= kZooms.length) return;
    const { view } = this;
    const middle = [(view.scrollLeft + view.clientWidth / 2) / this.zoom, (view.scrollTop + view.clientHeight / 2) / this.zoom];
    this.zoom = kZooms[at]!;
    this.stage.style.width = `${100 * this.zoom}%`;
    view.scrollLeft = middle[0]! * this.zoom - view.clientWidth / 2;
    view.scrollTop = middle[1]! * this.zoom - view.clientHeight / 2;
    this.draw();
    this.onEnlarge?.();
  }

  // Frame pixels per screen pixel.
  private get scale(): number {
    return this.width / ((this.view.clientWidth || 900) * this.zoom);
  }

  private draw(): void {
    if (this.width === 0) return;
    const focused = (document.activeElement as HTMLElement | null)?.dataset?.marker;
    this.drawing.replaceChildren(...this.boxes.map(({ box: [x, y, width, height], isExcluded }) =>
      svg('rect', { x, y, width, height, class: isExcluded ? 'box excluded' : 'box' })), ...this.markers.map((shown) => this.outline(shown)), ...this.scaleBar());
    if (focused !== undefined) [...this.drawing.querySelectorAll<SVGElement>('[data-marker]')].find(({ dataset }) => dataset.marker === focused)?.focus();
  }

  private outline(shown: ShownMarker): SVGElement {
    const { marker, name, role } = shown;
    const parts: SVGElement[] = [];
    const centres: Point[] = [];
    const ring = marker.circle?.outline ?? marker.outline;
    if (ring && ring.length > 2) {
      parts.push(svg('polygon', { points: ring.map((point) => point.join(',')).join(' ') }));
      centres.push(centreOf(ring));
    } else if (marker.circle?.x !== undefined && marker.circle.y !== undefined) {
      parts.push(svg('circle', { cx: marker.circle.x, cy: marker.circle.y, r: (marker.circle.diameter_px ?? 20) / 2 }));
      centres.push([marker.circle.x, marker.circle.y]);
    }
    if (marker.grating) {
      parts.push(svg('polygon', { points: marker.grating.outline.map((point) => point.join(',')).join(' ') }));
      centres.unshift(centreOf(marker.grating.outline));
    }
    if (centres.length === 2) parts.unshift(svg('line', { x1: centres[0]![0], y1: centres[0]![1], x2: centres[1]![0], y2: centres[1]![1], class: 'link' }));
    const at = centres[0] ?? [0, 0];
    const size = kLabel_px * this.scale;
    const label = svg('text', { x: at[0], y: at[1] + 0.35 * size, 'font-size': size, 'text-anchor': 'middle' }, name);
    // An object without a name cannot be chosen on the command line either.
    if (marker.name === '') return svg('g', { class: `marker ${role} nameless`, role: 'img', 'aria-label': 'not identified' }, ...parts);
    const group = svg('g', { class: `marker ${role}`, tabindex: 0, role: 'button', 'data-marker': marker.name, 'aria-label': `${name}: ${roleWords[role]}` }, ...parts, label);
    group.append(svg('title', {}, `${name}: ${roleWords[role]}`));
    const act = (): void => this.onMarker?.(shown, group.getBoundingClientRect());
    group.addEventListener('click', () => {
      if (this.tool === 'select') act();
    });
    group.addEventListener('keydown', (event) => {
      const { key } = event as KeyboardEvent;
      if (key !== 'Enter' && key !== ' ') return;
      event.preventDefault();
      act();
    });
    return group;
  }

  private scaleBar(): SVGElement[] {
    if (!this.mmPerPx) return [];
    const { scale } = this;
    const length_mm = roundLength(kBar_px * scale * this.mmPerPx);
    const length = length_mm / this.mmPerPx;
    const x = 16 * scale;
    const y = this.height - 20 * scale;
    const text = length_mm >= 1000 ? `${length_mm / 1000} m` : `${length_mm} mm`;
    return [svg('g', { class: 'scale-bar', role: 'img', 'aria-label': `Scale bar of ${text}` },
      svg('rect', { x: x - 8 * scale, y: y - 22 * scale, width: length + 16 * scale, height: 34 * scale, rx: 5 * scale }),
      svg('path', { d: `M${x} ${y - 4 * scale}v${8 * scale}M${x} ${y}h${length}m0 ${-4 * scale}v${8 * scale}` }),
      svg('text', { x: x + length / 2, y: y - 7 * scale, 'font-size': 12 * scale, 'text-anchor': 'middle' }, text))];
  }

  private toFrame(event: PointerEvent): Point {
    const area = this.stage.getBoundingClientRect();
    const x = ((event.clientX - area.left) / area.width) * this.width;
    const y = ((event.clientY - area.top) / area.height) * this.height;
    return [Math.min(this.width, Math.max(0, x)), Math.min(this.height, Math.max(0, y))];
  }

  private startBox(start: PointerEvent): void {
    const { tool } = this;
    if (tool === 'select' || start.button !== 0) return;
    start.preventDefault();
    const from = this.toFrame(start);
    const shape = svg('rect', { class: tool === 'ignore' ? 'box excluded' : 'box' });
    this.drawing.append(shape);
    this.drawing.setPointerCapture(start.pointerId);
    let box: Box = [0, 0, 0, 0];
    const move = (event: Event): void => {
      const to = this.toFrame(event as PointerEvent);
      box = [Math.min(from[0], to[0]), Math.min(from[1], to[1]), Math.abs(to[0] - from[0]), Math.abs(to[1] - from[1])];
      ['x', 'y', 'width', 'height'].forEach((key, k) => shape.setAttribute(key, String(box[k])));
    };
    const end = (): void => {
      this.drawing.removeEventListener('pointermove', move);
      shape.remove();
      if (box[2] > kLeastBox_px * this.scale && box[3] > kLeastBox_px * this.scale) this.onBox?.(tool, box.map(Math.round) as Box);
    };
    this.drawing.addEventListener('pointermove', move);
    this.drawing.addEventListener('pointerup', end, { once: true });
    this.drawing.addEventListener('pointercancel', end, { once: true });
  }
}
