import { element, say } from '../dom';
import { shownNumber, shownUnit } from '../panel/units';
import { roundSpan } from './axis';
import type { Series } from './series';

/** Seconds that a chart shows. */
export const WINDOW = 20;

/** How dark it is between a line and zero. */
const SHADE = 0.12;

export interface Curve {
  readonly name: string;
  readonly series: Series;
}

/** A small chart: title, the present value large, and the last seconds as a line. Two curves at most. */
export class Chart {
  readonly node: HTMLElement;
  private readonly canvas = element('canvas', { attributes: { 'aria-hidden': 'true' } });
  private readonly value = element('span', { className: 'value' });
  private readonly top = element('span', { className: 'limit' });
  private readonly bottom = element('span', { className: 'limit' });
  private readonly unit: string;
  private readonly curves: readonly Curve[];
  private readonly least: number;

  /** `least`: a span in SI below which the chart does not zoom in, so that noise does not look like an event. */
  constructor(title: string, unit: string, curves: readonly Curve[], least: number) {
    this.unit = unit;
    this.curves = curves;
    this.least = least;
    const names =
      curves.length > 1
        ? curves.map(({ name }, index) => element('span', { className: `key key-${index + 1}` }, name))
        : [];
    this.node = element(
      'figure',
      { className: 'chart' },
      element('figcaption', {}, element('span', {}, title), element('span', { className: 'keys' }, ...names)),
      this.value,
      element(
        'div',
        { className: 'plot' },
        this.canvas,
        element('span', { className: 'limits' }, this.top, this.bottom),
        element('span', { className: 'limit since' }, `−${WINDOW} s`),
      ),
    );
  }

  /** `now`: wall time [s]. */
  draw(now: number): void {
    let low = Infinity;
    let high = -Infinity;
    for (const { series } of this.curves) {
      for (const [, value] of series.after(now - WINDOW)) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    if (high - low < this.least) {
      const middle = 0.5 * (low + high);
      low = low >= 0 && middle < this.least ? 0 : middle - 0.5 * this.least;
      high = low + this.least;
    }
    const [from, to] = roundSpan(low, high);
    const scale = shownUnit(this.unit, Math.max(Math.abs(from), Math.abs(to)));
    const number = (value: number, digits: number) => shownNumber(value / scale.factor, digits);
    say(this.top, number(to, 3));
    say(this.bottom, number(from, 3));
    const last = this.curves[0]?.series.last;
    say(this.value, last === undefined ? '–' : `${number(last, 3)} ${scale.unit}`);
    this.paint(now, from, to);
  }

  private paint(now: number, from: number, to: number): void {
    const { clientWidth, clientHeight } = this.canvas;
    const context = this.canvas.getContext('2d');
    if (!context || clientWidth === 0) return;
    const ratio = Math.min(2, window.devicePixelRatio);
    const [width, height] = [Math.round(ratio * clientWidth), Math.round(ratio * clientHeight)];
    if (this.canvas.width !== width || this.canvas.height !== height)
      Object.assign(this.canvas, { width, height });
    const style = getComputedStyle(this.node);
    const x = (time: number) => width * (1 - (now - time) / WINDOW);
    const y = (value: number) => (height - 2 * ratio) * (1 - (value - from) / (to - from)) + ratio;
    context.clearRect(0, 0, width, height);
    if (from < 0 && to > 0) {
      context.strokeStyle = style.getPropertyValue('--line');
      context.lineWidth = ratio;
      context.beginPath();
      context.moveTo(0, y(0));
      context.lineTo(width, y(0));
      context.stroke();
    }
    this.curves.forEach(({ series }, index) => {
      const colour = style.getPropertyValue(`--chart-${index + 1}`);
      context.strokeStyle = context.fillStyle = colour;
      context.lineWidth = 1.5 * ratio;
      context.lineJoin = 'round';
      context.beginPath();
      let [first, last]: (number | undefined)[] = [];
      for (const [time, value] of series.after(now - WINDOW)) {
        if (first === undefined) context.moveTo(x(time), y(value));
        else context.lineTo(x(time), y(value));
        first ??= x(time);
        last = x(time);
      }
      context.stroke();
      if (first === undefined || last === undefined || from > 0 || to < 0) return;
      context.lineTo(last, y(0));
      context.lineTo(first, y(0));
      context.globalAlpha = SHADE;
      context.fill();
      context.globalAlpha = 1;
    });
  }
}
