import { colourGradient } from '../drawing/colour-map';
import { mapOf } from '../drawing/colouring';
import { element, say } from '../dom';
import type { SessionClient } from '../engine/session';
import { shownNumber, shownUnit } from '../panel/units';

/** The legend of the colours on the tissue: what, in which unit, from where to where. */
export function legendOf(session: SessionClient): HTMLElement {
  const title = element('figcaption');
  const ramp = element('div', { className: 'ramp' });
  const [low, middle, high] = [element('span'), element('span'), element('span')];
  const node = element(
    'figure',
    { className: 'legend', hidden: true },
    title,
    ramp,
    element('div', { className: 'ends' }, low, middle, high),
  );
  let painted = '';
  session.on('frame', ({ colouring }) => {
    const map = mapOf(colouring.by, colouring.low);
    node.hidden = map === null;
    if (map === null) return;
    const known = session.catalogue?.colourings.find(({ name }) => name === colouring.by);
    const percent = colouring.unit === '' && map !== 'binary';
    const scale = percent
      ? { unit: '%', factor: 0.01 }
      : shownUnit(colouring.unit, Math.max(Math.abs(colouring.low), Math.abs(colouring.high)));
    if (painted !== map) {
      painted = map;
      ramp.style.background = colourGradient(map);
    }
    const name = known?.title ?? colouring.by;
    say(title, map === 'binary' || scale.unit === '' ? name : `${name} [${scale.unit}]`);
    const number = (value: number) => shownNumber(value / scale.factor, 3);
    say(low, map === 'binary' ? 'linear' : number(colouring.low));
    say(middle, map === 'binary' ? '' : number(0.5 * (colouring.low + colouring.high)));
    say(high, map === 'binary' ? 'non-linear' : number(colouring.high));
  });
  return node;
}
