import type { FlagParameter, Parameter } from '../engine/messages';
import { element, freshId } from '../dom';
import { Row, type Change, type Control } from './control';

/** Yes or no. */
export class FlagControl implements Control {
  readonly row: Row;
  private readonly box: HTMLInputElement;

  constructor(parameter: FlagParameter, change: Change) {
    const id = freshId('flag');
    this.box = element('input', {
      id,
      type: 'checkbox',
      className: 'switch',
      attributes: { role: 'switch' },
    });
    this.box.addEventListener('change', () => change(parameter.key, this.box.checked));
    this.row = new Row(parameter, id, element('span', { hidden: true }), this.box);
    this.update(parameter);
  }

  get node(): HTMLElement {
    return this.row.node;
  }

  update(parameter: Parameter): void {
    if (parameter.kind === 'flag') this.box.checked = parameter.value;
  }

  setEnabled(enabled: boolean): void {
    this.box.disabled = !enabled;
  }
}
