import { loadImages, type Run } from './data';
import { el, metres } from './dom';

// The images and figures of the frame under the pointer.
export class Inspector {
  readonly element = el('aside', { class: 'inspector', id: 'inspector' });

  constructor(private readonly run: Run) {
    this.element.append(el('p', {}, 'Point at an image of the route.'));
  }

  look = (i: number) => {
    const f = this.run.frames;
    const images = loadImages();
    const key = f.key_frame[i];
    const list = el('dl');
    const say = (name: string, value: string) =>
      list.append(el('dt', {}, name), el('dd', {}, value));
    say('state', `${f.state[i]}, by ${f.carried_by[i]}`);
    if (f.support[i] > 0) say('features that agree', String(f.support[i]));
    say('confidence', f.confidence[i].toFixed(2));
    for (const row of this.run.rows) {
      const error = f.errors[row.name]?.[i];
      if (error != null) say(row.label, `${metres(error)} m`);
    }
    this.show(
      `Image ${f.frame[i]}, ${f.distance_m[i].toFixed(0)} m along the route`,
      [
        picture(images?.live[i], `live image ${f.frame[i]}`),
        picture(images?.keys[key], `recollected: ${this.origin(key)}`),
        ...(f.nearest_key_frame[i] === key
          ? []
          : [picture(images?.keys[f.nearest_key_frame[i]], `nearest: ${this.origin(f.nearest_key_frame[i])}`)]),
      ],
      el(
        'p',
        {},
        `Most votes of the committee: ${f.votes[i].map(([frame, votes]) => `key frame ${frame}: ${votes}`).join(', ')}.`,
      ),
      list,
    );
  };

  lookKey = (key: number) =>
    this.show(
      `Key frame ${key}`,
      [picture(loadImages()?.keys[key], this.origin(key))],
    );

  private origin(key: number) {
    return `key frame ${key} (${this.run.keys.lap[key]}, image ${this.run.keys.frame[key]})`;
  }

  private show(title: string, pictures: HTMLElement[], ...figures: HTMLElement[]) {
    this.element.replaceChildren(
      el('h3', {}, title),
      el('div', { class: 'pictures' }, ...pictures),
      ...figures,
    );
  }
}

function picture(base64: string | undefined, caption: string) {
  if (base64 === undefined) return el('figure', {}, el('figcaption', {}, `${caption}: no image kept`));
  const image = el('img', { src: `data:image/jpeg;base64,${base64}`, alt: caption });
  return el('figure', {}, image, el('figcaption', {}, caption));
}
