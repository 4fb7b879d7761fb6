import type { Parameter, Vector, VectorParameter } from '../engine/messages';
import { element, freshId } from '../dom';
import { Row, type Change, type Control } from './control';
import { shownNumber, typedNumber } from './units';

const AXES = ['x', 'y', 'z'] as const;

/** Three numbers, such as a fibre direction or gravity. */
export class VectorControl implements Control {
  readonly row: Row;
  private readonly fields: HTMLInputElement[];

  constructor(parameter: VectorParameter, change: Change) {
    const first = freshId('vector');
    this.fields = AXES.map((axis, index) =>
      element('input', {
        id: index === 0 ? first : freshId('vector'),
        type: 'text',
        inputMode: 'decimal',
        className: 'number',
        autocomplete: 'off',
        attributes: { 'aria-label': `${parameter.title}, ${axis}`, spellcheck: 'false' },
      }),
    );
    const cells = this.fields.map((field, index) =>
      element(
        'span',
        { className: 'component' },
        element('span', { className: 'unit', ariaHidden: 'true' }, AXES[index]!),
        field,
      ),
    );
    const unit = parameter.unit ? element('span', { className: 'unit' }, parameter.unit) : undefined;
    this.row = new Row(parameter, first, element('div', { className: 'vector' }, ...cells), unit);
    for (const field of this.fields) {
      field.addEventListener('change', () => this.take(parameter.key, change));
      field.addEventListener('keydown', (event) => event.key === 'Enter' && field.blur());
    }
    this.update(parameter);
  }

  get node(): HTMLElement {
    return this.row.node;
  }

  update(parameter: Parameter): void {
    if (parameter.kind !== 'vector') return;
    this.fields.forEach((field, index) => {
      if (document.activeElement !== field) field.value = shownNumber(parameter.value[index] ?? 0, 3);
    });
  }

  setEnabled(enabled: boolean): void {
    for (const field of this.fields) field.disabled = !enabled;
  }

  private take(key: string, change: Change): void {
    const values = this.fields.map((field) => typedNumber(field.value));
    if (values.some((value) => value === undefined)) {
      this.row.refuse('These have to be three numbers.');
      return;
    }
    this.row.accept();
    change(key, values as Vector);
  }
}
