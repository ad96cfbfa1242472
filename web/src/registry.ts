// All plots and strips of the page, in its order, for what concerns all of them: theme, printing.
import type { Plot } from './plot';
import type { Strip } from './strip';

export const plots: Plot[] = [];
export const strips: Strip[] = [];

// Removes plots that others replace.
export function forget(old: Plot[]): void {
  for (const plot of old) {
    plot.remove();
    plots.splice(plots.indexOf(plot), 1);
  }
}
