// Colours of the charts: those of the style sheet, and one a row that holds in light and dark.
export interface Theme {
  text: string;
  faint: string;
  line: string;
  paper: string;
}

export const dark = window.matchMedia('(prefers-color-scheme: dark)');

export const print = window.matchMedia('print');

// Paper is always light.
export function theme(): Theme {
  if (dark.matches && !print.matches) {
    return { text: '#e4e7eb', faint: '#9aa5b1', line: '#3a4550', paper: '#161b21' };
  }
  return { text: '#1f2933', faint: '#616e7c', line: '#d3d9e0', paper: '#ffffff' };
}

const colours: Record<string, string> = {
  gps: '#8b8f98',
  oracle_cnn: '#5aa9e6',
  system: '#1f77b4',
  pnp_oracle: '#7bc8a4',
  pnp: '#2a9d6f',
  fused: '#d1495b',
  localised: '#9b5de5',
  retrieval: '#e09f3e',
  oracle: '#c9ada7',
};

export const colour = (row: string) => colours[row] ?? '#888888';
