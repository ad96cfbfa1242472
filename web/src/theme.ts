// Colours of the canvases, from the page's own style sheet: one place for light, dark and print.

const read = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export interface Theme {
  ink: string;
  grid: string;
  series: string[]; // by kColour
  paper: string;
  band: string[];
}

// One colour, one meaning (page.css).
export const kColour = { x: 0, y: 1, reference: 2, target: 3, camera: 4, other: 5 } as const;

export function theme(): Theme {
  const series = [1, 2, 3, 4, 5, 6].map((n) => read(`--series-${n}`));
  return { ink: read('--ink-soft'), grid: read('--grid'), series, paper: read('--card'), band: series.map((colour) => colour + '38') };
}

export const statusColour = (index: number): string => read(`--status-${index}`);

// While the page is printed everything is as on paper, whatever the screen's theme.
export function setPrinting(on: boolean): void {
  if (on) document.documentElement.dataset.theme = 'print';
  else delete document.documentElement.dataset.theme;
}

export const isPrinting = (): boolean => document.documentElement.dataset.theme === 'print';
