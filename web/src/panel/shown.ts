import type { Scene } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import { element, freshId, say } from '../dom';

/** What is shown: colouring, the linear ghost, and what the bodies consist of. */
export class ShownPanel {
  readonly node: HTMLElement;
  private readonly colouring: HTMLSelectElement;
  private readonly summary = element('p', { className: 'note' });
  private readonly ghost: HTMLInputElement;
  private readonly facts = element('dl', { className: 'facts' });
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
    session.on('role', () => this.show());
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

function factsOf(scene: Scene): [what: string, value: string][] {
  const bodies = scene.bodies.filter(({ ghostOf }) => ghostOf === undefined);
  return bodies.map(({ name, cells, nodes }) => [
    name,
    `${cells.toLocaleString('en')} cells, ${nodes.toLocaleString('en')} nodes`,
  ]);
}
