// Just enough to write elements down.
type Child = Node | string;

export function el(tag: string, attributes: Record<string, string> = {}, ...children: Child[]) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function section(id: string, title: string, text: string, ...children: Child[]) {
  return el('section', { id }, el('h2', {}, title), el('p', { class: 'lead' }, text), ...children);
}

// Columns after the first `texts` ones hold numbers.
export function table(caption: string, head: string[], rows: string[][], texts = 1) {
  const cell = (tag: string) => (text: string, column: number) =>
    el(tag, column >= texts ? { class: 'number' } : {}, text);
  return el(
    'div',
    { class: 'table' },
    el(
      'table',
      {},
      el('caption', {}, caption),
      el('thead', {}, el('tr', {}, ...head.map(cell('th')))),
      el('tbody', {}, ...rows.map((row) => el('tr', {}, ...row.map(cell('td'))))),
    ),
  );
}

export const metres = (value: number) => (value < 10 ? value.toFixed(3) : value.toFixed(1));
export const percent = (share: number) => (100 * share).toFixed(1);
export const count = (value: number) => value.toLocaleString('en');
