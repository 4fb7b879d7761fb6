import type { Parameter } from '../engine/messages';
import { element } from '../dom';

/** What a control of a parameter is to the panel. `P` is the kind of parameter. */
export interface Control {
  readonly node: HTMLElement;
  /** Shows what the session says is so; leaves alone what is being typed or dragged. */
  update(parameter: Parameter): void;
  setEnabled(enabled: boolean): void;
}

/** Says a change to the session. */
export type Change = (key: string, value: Parameter['value']) => void;

/** The row around a control: its name, a mark where a change restarts the scene, what it is, and why a change was refused. */
export class Row {
  readonly node: HTMLElement;
  readonly refusal = element('p', { className: 'refusal', hidden: true, attributes: { role: 'alert' } });

  constructor(parameter: Parameter, labelled: string, body: HTMLElement, beside?: HTMLElement) {
    const label = element(
      'label',
      { className: 'name', htmlFor: labelled, title: parameter.summary },
      parameter.title,
    );
    const mark =
      parameter.effect === 'restarts'
        ? element('span', { className: 'restarts', title: 'A change starts the scene again' }, 'restarts')
        : undefined;
    this.node = element(
      'div',
      { className: 'row', data: { key: parameter.key, kind: parameter.kind } },
      element('div', { className: 'row-head' }, label, mark, beside),
      body,
      this.refusal,
    );
  }

  refuse(reason: string): void {
    this.refusal.textContent = reason;
    this.refusal.hidden = false;
  }

  accept(): void {
    this.refusal.hidden = true;
  }
}
