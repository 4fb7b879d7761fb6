/** Icons as strokes on a 24 × 24 grid; they take the colour of the text around them. */
const STROKES = {
  pause: 'M8 5v14M16 5v14',
  play: 'M7 5l12 7-12 7z',
  step: 'M6 5l9 7-9 7zM18 5v14',
  reset: 'M4.5 12a7.5 7.5 0 1 0 2.4-5.5M4.5 4.5v4h4',
  record: 'M12 6a6 6 0 1 0 0 12 6 6 0 0 0 0-12z',
  stop: 'M7 7h10v10H7z',
  replay: 'M4 6h10M4 12h7M4 18h7M14 12l6 4-6 4z',
  keep: 'M6 4h9l4 4v12H6zM9 4v5h5M9 20v-6h7v6',
  picture: 'M4 8h4l1.5-2.5h5L16 8h4v11H4zM12 10.5a3 3 0 1 0 0 6 3 3 0 0 0 0-6z',
  export: 'M12 4v11M7.5 10.5L12 15l4.5-4.5M5 19h14',
  open: 'M12 15V4M7.5 8.5L12 4l4.5 4.5M5 15v4h14v-4',
  light:
    'M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM12 2.5v2M12 19.5v2M2.5 12h2M19.5 12h2M5.3 5.3l1.4 1.4M17.3 17.3l1.4 1.4M5.3 18.7l1.4-1.4M17.3 6.7l1.4-1.4',
  dark: 'M19.5 14.5A8 8 0 0 1 9.5 4.5a8 8 0 1 0 10 10z',
  help: 'M9 9.2A3.1 3.1 0 1 1 13.2 12c-.8.4-1.2.9-1.2 1.9M12 17.3v.2',
  home: 'M4 11.5L12 5l8 6.5M6.5 10v9h11v-9',
  add: 'M12 6v12M6 12h12',
  remove: 'M6 6l12 12M18 6L6 18',
  grasp: 'M12 21v-7M12 14L7.5 9 9.5 3.5M12 14l4.5-5-2-5.5M9.8 14h4.4',
  burn: 'M9 3v12a4 4 0 0 0 7 2.6M17.5 9.5c1.5 1.6 1 3.5-.5 3.5s-2-1.9.5-3.5z',
  push: 'M12 3v13M12 16a2.5 2.5 0 1 0 0 5 2.5 2.5 0 0 0 0-5z',
  hold: 'M8 11V8a4 4 0 0 1 8 0v3M6 11h12v9H6z',
  entry: 'M3 9.5c3-2 5.5-2.7 9-2.7s6 .7 9 2.7M14.5 2.5L8.5 21M8.7 6.5a3.4 1.6 0 1 0 6.6 0',
  panel: 'M4 5h16v14H4zM14.5 5v14',
  depth: 'M12 20V4M8 8l4-4 4 4M8 16l4 4 4-4',
} as const;

export type IconName = keyof typeof STROKES;

const SVG = 'http://www.w3.org/2000/svg';

/** A picture beside a name: hidden from those who hear the page. */
export function icon(name: IconName): SVGSVGElement {
  const drawing = document.createElementNS(SVG, 'svg');
  drawing.setAttribute('viewBox', '0 0 24 24');
  drawing.setAttribute('aria-hidden', 'true');
  drawing.classList.add('icon');
  const path = document.createElementNS(SVG, 'path');
  path.setAttribute('d', STROKES[name]);
  drawing.append(path);
  return drawing;
}
