// A group of checkboxes: what a plot shows.
import { el } from './element';

export interface Choice {
  label: string;
  isOn: boolean;
  colour?: number; // number of its line in the theme
  title?: string;
}

export interface Choices {
  element: HTMLElement;
  isOn: (index: number) => boolean;
  set: (index: number, on: boolean) => void; // without calling `onChange`
}

// `onChange` gets the box that was clicked; -1 for all of them.
export function choices(legend: string, list: Choice[], onChange: (index: number) => void, hasAll = false): Choices {
  const boxes = list.map(({ isOn, title }) => {
    const box = el('input', { type: 'checkbox', ...(title && { title }) });
    box.checked = isOn;
    return box;
  });
  const labels = list.map(({ label, colour, title }, k) =>
    el('label', title ? { title } : {}, boxes[k], colour !== undefined && el('span', { class: 'swatch', style: `--colour: var(--series-${colour + 1})`, 'aria-hidden': 'true' }), label));
  boxes.forEach((box, k) => box.addEventListener('change', () => onChange(k)));
  const all = (text: string, on: boolean): HTMLElement => {
    const button = el('button', { type: 'button', 'aria-label': `${text}: ${legend}` }, text);
    button.addEventListener('click', () => {
      boxes.forEach((box) => (box.checked = on));
      onChange(-1);
    });
    return button;
  };
  const element = el('fieldset', { class: 'choices' }, el('legend', {}, legend), ...labels, hasAll && all('All', true), hasAll && all('None', false));
  return { element, isOn: (k) => boxes[k]!.checked, set: (k, on) => (boxes[k]!.checked = on) };
}
