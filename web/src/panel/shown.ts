import type { Observables, Scene } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import { element, freshId, say } from '../dom';
import { shownNumber } from './units';

/** What is shown: colouring, the linear ghost, what the bodies consist of, and how well they keep what they promise. */
export class ShownPanel {
  readonly node: HTMLElement;
  private readonly colouring: HTMLSelectElement;
  private readonly summary = element('p', { className: 'note' });
  private readonly ghost: HTMLInputElement;
  private readonly facts = element('dl', { className: 'facts' });
  private readonly errors = element('dl', { className: 'facts errors', hidden: true });
  private readonly errorValues = new Map<string, HTMLElement>();
  private readonly session: SessionClient;

  constructor(session: SessionClient) {
    this.session = session;
    const colouringId = freshId('colouring');
    const ghostId = freshId('ghost');
    this.colouring = element('select', { id: colouringId });
    this.ghost = element('input', {
      id: ghostId,
      type: 'checkbox',
      className: 'switch',
      attributes: { role: 'switch' },
    });
    this.colouring.addEventListener('change', () =>
      session.send({ type: 'colour', by: this.colouring.value }),
    );
    this.ghost.addEventListener('change', () => session.send({ type: 'ghost', on: this.ghost.checked }));
    this.node = element(
      'section',
      { className: 'section' },
      element('h2', {}, 'Shown'),
      element(
        'div',
        { className: 'row' },
        element(
          'div',
          { className: 'row-head' },
          element('label', { className: 'name', htmlFor: colouringId }, 'Colours'),
        ),
        this.colouring,
        this.summary,
      ),
      element(
        'div',
        { className: 'row' },
        element(
          'div',
          { className: 'row-head' },
          element('label', { className: 'name', htmlFor: ghostId }, 'Linear model as wireframe'),
          this.ghost,
        ),
      ),
      this.facts,
      this.errors,
    );
    session.on('catalogue', ({ colourings }) => {
      this.colouring.replaceChildren(
        ...colourings.map(({ name, title, unit }) =>
          element('option', { value: name }, unit ? `${title} [${unit}]` : title),
        ),
      );
      this.show();
    });
    session.on('scene', () => this.show());
    session.on('frame', ({ observables }) => observables && this.measure(observables));
    session.on('role', () => this.show());
  }

  private measure(observables: readonly Observables[]): void {
    const bodies = this.session.scene?.bodies ?? [];
    const found = observables.flatMap((seen, index) => {
      const body = bodies[index];
      return body && body.ghostOf === undefined ? errorsOf(body.name, seen) : [];
    });
    if (found.map(([what]) => what).join() !== [...this.errorValues.keys()].join()) {
      this.errorValues.clear();
      for (const [what] of found) this.errorValues.set(what, element('dd'));
      this.errors.replaceChildren(
        ...found.flatMap(([what, why]) => [element('dt', { title: why }, what), this.errorValues.get(what)!]),
      );
      this.errors.hidden = found.length === 0;
    }
    for (const [what, , value] of found) say(this.errorValues.get(what)!, value);
  }

  private show(): void {
    const { scene, catalogue, role } = this.session;
    this.colouring.disabled = this.ghost.disabled = role.role !== 'controller';
    if (!scene) return;
    this.colouring.value = scene.colouring;
    this.ghost.checked = scene.ghost;
    say(this.summary, catalogue?.colourings.find(({ name }) => name === scene.colouring)?.summary ?? '');
    this.facts.replaceChildren(
      ...factsOf(scene).flatMap(([what, value]) => [element('dt', {}, what), element('dd', {}, value)]),
    );
  }
}

/** What a body that promises something exact tells of it: name, what that is, and the value. */
function errorsOf(
  name: string,
  { volumeError, interfaceResidual }: Observables,
): [what: string, why: string, value: string][] {
  const percent = (value: number) => `${shownNumber(100 * value, 2)} %`;
  const found: [string, string, string][] = [];
  if (volumeError !== undefined)
    found.push([
      `${name}, volume error`,
      'Of the volumes that are kept exactly, the one that is farthest off',
      percent(volumeError),
    ]);
  if (interfaceResidual !== undefined)
    found.push([
      `${name}, interface`,
      'How much the reaction of the pre-computed part changed in the last step',
      percent(interfaceResidual),
    ]);
  return found;
}

function factsOf(scene: Scene): [what: string, value: string][] {
  const bodies = scene.bodies.filter(({ ghostOf }) => ghostOf === undefined);
  return bodies.map(({ name, cells, nodes }) => [
    name,
    `${cells.toLocaleString('en')} cells, ${nodes.toLocaleString('en')} nodes`,
  ]);
}
