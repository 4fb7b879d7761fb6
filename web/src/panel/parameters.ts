import type { Parameter, Refusal, Scene } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import { element } from '../dom';
import { ChoiceControl } from './choice-control';
import type { Change, Control, Row } from './control';
import { FlagControl } from './flag-control';
import { NumberControl } from './number-control';
import { VectorControl } from './vector-control';

/** The parameters of the scene, a section per group; which there are, and what they may be, is the session's to say. */
export class ParameterPanel {
  readonly node = element('div', { className: 'parameters' });
  private readonly controls = new Map<string, Control & { readonly row: Row }>();
  private readonly closed = new Set<string>();
  private readonly session: SessionClient;
  private shape = '';

  constructor(session: SessionClient) {
    this.session = session;
    session.on('scene', (scene) => this.show(scene));
    session.on('refusal', (refusal) => this.refuse(refusal));
    session.on('role', () => this.enable());
  }

  /** Whether there is a control for this parameter: then it shows what is said about it, and nobody else has to. */
  showsKey(key: string | undefined): boolean {
    return key !== undefined && this.controls.has(key);
  }

  private refuse({ key, reason, help }: Refusal): void {
    const control = key === undefined ? undefined : this.controls.get(key);
    control?.row.refuse([reason, help].filter(Boolean).join(' '));
    // Nothing has changed: back to what is so.
    const parameter = this.session.scene?.parameters.find((other) => other.key === key);
    if (parameter) control?.update(parameter);
  }

  private show(scene: Scene): void {
    const shape = JSON.stringify(scene.parameters.map((parameter) => [scene.epoch, ...shapeOf(parameter)]));
    if (shape !== this.shape) {
      this.shape = shape;
      this.rebuild(scene.parameters);
    } else {
      for (const parameter of scene.parameters) this.controls.get(parameter.key)?.update(parameter);
    }
    this.enable();
  }

  private rebuild(parameters: readonly Parameter[]): void {
    const focused = document.activeElement?.closest<HTMLElement>('.row')?.dataset['key'];
    this.controls.clear();
    const change: Change = (key, value) => {
      this.controls.get(key)?.row.accept();
      this.session.send({ type: 'set', key, value });
    };
    const groups = new Map<string, HTMLElement[]>();
    for (const parameter of parameters) {
      const control = controlOf(parameter, change);
      this.controls.set(parameter.key, control);
      groups.set(parameter.group, [...(groups.get(parameter.group) ?? []), control.node]);
    }
    this.node.replaceChildren(...[...groups].map(([group, rows]) => this.section(group, rows)));
    // A choice of law may bring other parameters; whoever was there stays there.
    if (focused !== undefined)
      this.controls.get(focused)?.node.querySelector<HTMLElement>('input, select')?.focus();
  }

  private section(group: string, rows: HTMLElement[]): HTMLElement {
    const section = element(
      'details',
      { className: 'section', open: !this.closed.has(group) },
      element('summary', {}, element('h2', {}, group)),
      ...rows,
    );
    section.addEventListener('toggle', () =>
      section.open ? this.closed.delete(group) : this.closed.add(group),
    );
    return section;
  }

  private enable(): void {
    const enabled = this.session.role.role === 'controller';
    for (const control of this.controls.values()) control.setEnabled(enabled);
  }
}

/** What a control is built from; while it stays, the control stays and only its value changes. */
function shapeOf(parameter: Parameter): unknown[] {
  const { key, kind, group, title, unit, effect } = parameter;
  return [key, kind, group, title, unit, effect];
}

function controlOf(parameter: Parameter, change: Change): Control & { readonly row: Row } {
  switch (parameter.kind) {
    case 'number':
      return new NumberControl(parameter, change);
    case 'choice':
      return new ChoiceControl(parameter, change);
    case 'vector':
      return new VectorControl(parameter, change);
    case 'flag':
      return new FlagControl(parameter, change);
  }
}
