// Small parts of all views: buttons, fields, commands to copy, messages, pictures that need the token.
import { request } from '../api';
import { el, setText } from '../../element';

export type Child = Node | string | undefined | false;

export function button(text: string, act: () => void, attributes: Record<string, string> = {}): HTMLButtonElement {
  const made = el('button', { type: 'button', ...attributes }, text);
  made.addEventListener('click', act);
  return made;
}

export const card = (title: string, ...children: Child[]): HTMLElement => el('section', { class: 'card', 'aria-label': title }, el('h3', {}, title), ...children);

// A field with its label in front and its unit behind.
export function field(label: string, input: HTMLElement, unit = ''): HTMLElement {
  return el('label', { class: 'field' }, el('span', {}, label), input, unit !== '' && el('span', { class: 'unit' }, unit));
}

export function select(options: [string, string][], value: string, onChange: (value: string) => void, label: string): HTMLSelectElement {
  const box = el('select', { 'aria-label': label }, ...options.map(([key, text]) => el('option', { value: key }, text)));
  box.value = value;
  box.addEventListener('change', () => onChange(box.value));
  return box;
}

export function checkbox(label: string, isOn: boolean, onChange: (on: boolean) => void = () => undefined): { element: HTMLElement; box: HTMLInputElement } {
  const box = el('input', { type: 'checkbox' });
  box.checked = isOn;
  box.addEventListener('change', () => onChange(box.checked));
  return { element: el('label', { class: 'check' }, box, label), box };
}

async function copy(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = el('textarea', { readonly: '' });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}

export interface CommandBox {
  element: HTMLElement;
  set: (command: string) => void;
}

// The command line that does the same, with a button that copies it.
export function commandBox(command = ''): CommandBox {
  const code = el('code', {}, command);
  const act = button('Copy', () => {
    void copy(code.textContent ?? '').then(() => {
      act.textContent = 'Copied';
      setTimeout(() => (act.textContent = 'Copy'), 1500);
    });
  }, { class: 'small', 'aria-label': 'Copy as command' });
  const element = el('div', { class: 'command' }, el('span', { class: 'command-title' }, 'As a command'), code, act);
  element.hidden = command === '';
  return { element, set: (text) => {
    setText(code, text);
    element.hidden = text === '';
  } };
}

const kShown_ms = 9000;

// A sentence at the lower edge, read aloud by screen readers.
export function say(text: string, kind: 'note' | 'bad' = 'note'): void {
  let list = document.getElementById('messages');
  if (!list) {
    list = el('div', { id: 'messages', role: 'status', 'aria-live': 'polite' });
    document.body.append(list);
  }
  const line = el('div', { class: `message ${kind}` }, el('span', {}, text));
  line.append(button('\u00d7', () => line.remove(), { class: 'quiet', 'aria-label': 'Close the message' }));
  list.append(line);
  setTimeout(() => line.remove(), kShown_ms);
}

export const sayProblem = (problem: unknown): void => say(problem instanceof Error ? problem.message : String(problem), 'bad');

// Runs `act`; a failure becomes a message.
export async function attempt(act: () => Promise<void>): Promise<void> {
  try {
    await act();
  } catch (problem) {
    if (!(problem instanceof DOMException && problem.name === 'AbortError')) sayProblem(problem);
  }
}

// Sets an image from a blob and frees the blob before it.
export function showBlob(image: HTMLImageElement, blob: Blob): Promise<void> {
  const before = image.src;
  const address = URL.createObjectURL(blob);
  return new Promise((done) => {
    const settle = (): void => {
      if (before.startsWith('blob:')) URL.revokeObjectURL(before);
      done();
    };
    image.onload = settle;
    image.onerror = settle;
    image.src = address;
  });
}

const thumbnails = new Map<string, { key: string; url: string }>(); // by address; a newer one replaces the last
const waiting: (() => Promise<void>)[] = [];
let running = 0;
const kAtOnce = 2; // requests for small pictures at the same time

function pump(): void {
  while (running < kAtOnce && waiting.length > 0) {
    ++running;
    void waiting.shift()!().finally(() => {
      --running;
      pump();
    });
  }
}

// A small picture that is requested when it comes into view. `key` changes when the file does.
export function thumbnail(address: string, key: string): HTMLElement {
  const image = el('img', { alt: '', class: 'thumbnail' });
  const known = thumbnails.get(address);
  if (known) image.src = known.url;
  else image.classList.add('empty');
  if (known?.key === key) return image;
  const seen = new IntersectionObserver((found) => {
    if (!found.some((one) => one.isIntersecting)) return;
    seen.disconnect();
    waiting.push(async () => {
      try {
        const url = URL.createObjectURL(await (await request(address)).blob());
        const before = thumbnails.get(address);
        thumbnails.set(address, { key, url });
        image.src = url;
        if (before) URL.revokeObjectURL(before.url);
        image.classList.remove('empty');
      } catch {
        // A clip without a picture keeps the grey box.
      }
    });
    pump();
  });
  seen.observe(image);
  return image;
}

export const sizeText = (bytes: number): string =>
  bytes >= 1e9 ? `${(bytes / 1e9).toFixed(1)} GB` : bytes >= 1e6 ? `${(bytes / 1e6).toFixed(1)} MB` : `${Math.max(1, Math.round(bytes / 1e3))} kB`;
