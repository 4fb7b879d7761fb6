import type { ChoiceParameter, Parameter } from '../engine/messages';
import { element, freshId } from '../dom';
import { Row, type Change, type Control } from './control';

/** One of several: a list, in which what is not to be had says why. */
export class ChoiceControl implements Control {
  readonly row: Row;
  private readonly select: HTMLSelectElement;
  private shown = '';

  constructor(parameter: ChoiceParameter, change: Change) {
    const id = freshId('choice');
    this.select = element('select', { id });
    this.select.addEventListener('change', () => change(parameter.key, this.select.value));
    this.row = new Row(parameter, id, this.select);
    this.update(parameter);
  }

  get node(): HTMLElement {
    return this.row.node;
  }

  update(parameter: Parameter): void {
    if (parameter.kind !== 'choice') return;
    const shape = JSON.stringify(parameter.choices);
    if (shape !== this.shown) {
      this.shown = shape;
      this.select.replaceChildren(
        ...parameter.choices.map(({ name, title, available, reason }) =>
          element(
            'option',
            { value: name, disabled: !available && name !== parameter.value, title: reason ?? '' },
            available || !reason ? title : `${title} (${reason})`,
          ),
        ),
      );
    }
    this.select.value = parameter.value;
  }

  setEnabled(enabled: boolean): void {
    this.select.disabled = !enabled;
  }
}
