// Elements without ceremony. Text goes in as text: nothing of a run is ever read as HTML.

type Child = Node | string | undefined | false;

export function el<Name extends keyof HTMLElementTagNameMap>(
  name: Name,
  attributes: Record<string, string> = {},
  ...children: Child[]
): HTMLElementTagNameMap[Name] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    // A style attribute would be inline style, which the policy of `moiregauge serve` forbids.
    if (key === 'style') element.style.cssText = value;
    else element.setAttribute(key, value);
  }
  for (const child of children) if (child) element.append(child);
  return element;
}

// Changes an element's text. An equal text stays as it is, so that the browser need not draw it again.
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function section(id: string, title: string, ...children: Child[]): HTMLElement {
  return el('section', { id, 'aria-labelledby': `${id}-title` }, el('h2', { id: `${id}-title` }, title), ...children);
}

export interface Cell {
  text: string;
  isNumber?: boolean;
  bar?: number; // 0 to 1
}

export function table(caption: string, head: string[], rows: (string | Cell)[][]): HTMLElement {
  const line = (cells: (string | Cell)[]): HTMLTableRowElement => {
    const row = el('tr');
    cells.forEach((cell, k) => {
      const { text, isNumber = false, bar } = typeof cell === 'string' ? { text: cell } : cell;
      const box = k === 0 ? el('th', { scope: 'row' }, text) : el('td', isNumber ? { class: 'number' } : {}, text);
      if (bar !== undefined) {
        box.classList.add('bar');
        box.style.setProperty('--share', `${(100 * bar).toFixed(1)}%`);
      }
      row.append(box);
    });
    return row;
  };
  const top = el('tr');
  const isNumber = (k: number): boolean => rows.some((row) => typeof row[k] === 'object' && row[k].isNumber === true);
  head.forEach((text, k) => top.append(el('th', { scope: 'col', ...(isNumber(k) && { class: 'number' }) }, text)));
  return el('div', { class: 'wide', tabindex: '0', role: 'region', 'aria-label': caption },
    el('table', {}, el('caption', {}, caption), el('thead', {}, top), el('tbody', {}, ...rows.map(line))));
}

// Lets a table become one block per row on a phone (`.stacked` in serve.css): every cell then shows its column's heading.
// The roles keep it a table for screen readers whatever its layout is.
export function stacked(box: HTMLElement): HTMLElement {
  const found = box.querySelector('table')!;
  const heads = [...found.querySelectorAll('thead th')].map(({ textContent }) => textContent ?? '');
  box.classList.add('stacked');
  found.setAttribute('role', 'table');
  found.querySelectorAll('thead, tbody').forEach((part) => part.setAttribute('role', 'rowgroup'));
  found.querySelectorAll('thead th').forEach((head) => head.setAttribute('role', 'columnheader'));
  found.querySelectorAll('tr').forEach((row) => {
    row.setAttribute('role', 'row');
    row.querySelectorAll('td, th[scope=row]').forEach((cell, k) => {
      cell.setAttribute('role', k === 0 ? 'rowheader' : 'cell');
      cell.setAttribute('data-label', heads[k] ?? '');
    });
  });
  return box;
}
