// Colours of the canvases, from the page's own style sheet: one place for light, dark and print.

const read = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export interface Theme {
  strong: string; // titles
  ink: string;
  grid: string;
  series: string[]; // by kColour
  paper: string;
  band: string[];
}

// One colour, one meaning (colours.css).
export const kColour = { x: 0, y: 1, reference: 2, target: 3, camera: 4, other: 5 } as const;

// Lines of one plot that differ in nothing but their name, such as targets: colours kFirstLine to kFirstLine + kLines - 1,
// then the same with dashes.
export const kFirstLine = 6;
export const kLines = 6;
export const kDashes: (number[] | undefined)[] = [undefined, [6, 3], [2, 2], [8, 3, 2, 3], [12, 3]];

export function theme(): Theme {
  const series = Array.from({ length: kFirstLine + kLines }, (_, n) => read(`--series-${n + 1}`));
  return { strong: read('--ink'), ink: read('--ink-soft'), grid: read('--grid'), series, paper: read('--card'), band: series.map((colour) => colour + '38') };
}

export const statusColour = (index: number): string => read(`--status-${index}`);

// While the page is printed everything is as on paper, whatever the screen's theme.
export function setPrinting(on: boolean): void {
  if (on) document.documentElement.dataset.theme = 'print';
  else delete document.documentElement.dataset.theme;
}

export const isPrinting = (): boolean => document.documentElement.dataset.theme === 'print';

// Gives the colours of paper until the returned function is called, for an image that leaves the page.
export function onPaper(): () => void {
  const before = document.documentElement.dataset.theme;
  document.documentElement.dataset.theme = 'print';
  return () => {
    if (before === undefined) delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = before;
  };
}
