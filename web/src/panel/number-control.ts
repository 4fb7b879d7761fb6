import type { NumberParameter, Parameter } from '../engine/messages';
import { element, freshId } from '../dom';
import { Row, type Change, type Control } from './control';
import { positionOf, STEPS, tidy, valueAt } from './scale';
import { shownNumber, shownUnit, typedNumber } from './units';

/** Milliseconds between two changes said while a slider is dragged. */
const PAUSE = 80;

/** A number: a slider over its usual span, and a field for any other value. */
export class NumberControl implements Control {
  readonly row: Row;
  private parameter: NumberParameter;
  private readonly slider: HTMLInputElement;
  private readonly field: HTMLInputElement;
  private readonly change: Change;
  private lastSaid = 0;
  private dragging = false;

  constructor(parameter: NumberParameter, change: Change) {
    this.parameter = parameter;
    this.change = change;
    const id = freshId('number');
    this.field = element('input', {
      id,
      type: 'text',
      inputMode: 'decimal',
      className: 'number',
      autocomplete: 'off',
      attributes: { spellcheck: 'false' },
    });
    this.slider = element('input', {
      type: 'range',
      min: '0',
      max: String(STEPS),
      step: '1',
      attributes: { 'aria-label': parameter.title },
    });
    const unit = element('span', { className: 'unit' }, this.unit.unit);
    const quantity = element('span', { className: 'quantity' }, this.field, unit);
    this.row = new Row(parameter, id, this.slider, quantity);
    this.listen();
    this.show();
  }

  get node(): HTMLElement {
    return this.row.node;
  }

  update(parameter: Parameter): void {
    if (parameter.kind !== 'number') return;
    this.parameter = parameter;
    this.show();
  }

  setEnabled(enabled: boolean): void {
    this.field.disabled = this.slider.disabled = !enabled;
  }

  private get unit() {
    const { unit, low, high, scale } = this.parameter;
    return shownUnit(
      unit,
      scale === 'logarithmic' && low > 0 ? Math.sqrt(low * high) : 0.5 * (Math.abs(low) + Math.abs(high)),
    );
  }

  private listen(): void {
    this.slider.addEventListener('input', () => {
      this.dragging = true;
      const value = this.sliderValue();
      this.field.value = shownNumber(value / this.unit.factor);
      this.announce(value);
      // What restarts the scene waits until the slider is let go.
      if (this.parameter.effect === 'continues' && performance.now() - this.lastSaid > PAUSE)
        this.sayChange(value);
    });
    this.slider.addEventListener('change', () => {
      this.dragging = false;
      this.sayChange(this.sliderValue());
    });
    this.field.addEventListener('change', () => {
      const typed = typedNumber(this.field.value);
      if (typed === undefined) {
        this.row.refuse('This is no number.');
        return;
      }
      this.row.accept();
      this.sayChange(typed * this.unit.factor);
    });
    // Enter takes a value as leaving the field does, escape gives the old one back.
    this.field.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') this.field.blur();
      if (event.key === 'Escape') {
        this.field.value = shownNumber(this.parameter.value / this.unit.factor);
        this.field.blur();
      }
    });
  }

  private sliderValue(): number {
    return tidy(valueAt(Number(this.slider.value), this.parameter), this.parameter);
  }

  private sayChange(value: number): void {
    this.lastSaid = performance.now();
    this.change(this.parameter.key, value);
  }

  private show(): void {
    const { value } = this.parameter;
    if (document.activeElement !== this.field && !this.dragging)
      this.field.value = shownNumber(value / this.unit.factor);
    if (!this.dragging) this.slider.value = String(positionOf(value, this.parameter));
    this.announce(value);
  }

  /** Fills the track up to the thumb, and says the value with its unit to those who hear the page. */
  private announce(value: number): void {
    const { unit, factor } = this.unit;
    this.slider.setAttribute('aria-valuetext', `${shownNumber(value / factor)} ${unit}`);
    this.slider.style.setProperty('--filled', `${(100 * Number(this.slider.value)) / STEPS}%`);
  }
}
