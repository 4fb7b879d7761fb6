import { element, freshId, say } from '../dom';
import type { InstrumentKind, SceneInstrument } from '../engine/messages';
import type { SessionClient } from '../engine/session';
import type { Tools } from '../handling/tools';
import { iconButton } from './button';
import { icon, type IconName } from './icons';
import { menuOn } from './menu';

/** How far one pixel of the depth strip moves the tool: a part of its distance to the eye. */
const DEPTH_PER_PIXEL = 0.002;

/** The icons of what tools do. */
export const MANNERS: Record<SceneInstrument['manner'], IconName> = {
  hold: 'grasp',
  burn: 'burn',
  push: 'push',
};

/** The tools at the left: which there are, which is in hand, hold, and a strip for depth where there is no wheel. */
export class ToolStrip {
  readonly node = element('div', {
    className: 'tools',
    attributes: { role: 'group', 'aria-label': 'Tools' },
  });
  private readonly list = element('div', {
    className: 'tool-list',
    attributes: { role: 'radiogroup', 'aria-label': 'Tool in hand' },
  });
  private readonly hold: HTMLButtonElement;
  private readonly entry: HTMLButtonElement;
  private readonly remove: HTMLButtonElement;
  private readonly session: SessionClient;
  private readonly tools: Tools;
  private shape = '';

  constructor(session: SessionClient, tools: Tools, deepen: (part: number) => void) {
    this.session = session;
    this.tools = tools;
    const add = element(
      'button',
      { type: 'button', className: 'tool', title: 'Bring in another tool' },
      icon('add'),
      'Add',
    );
    this.hold = element(
      'button',
      { type: 'button', className: 'tool hold', ariaPressed: 'false' },
      icon('hold'),
      'Hold',
    );
    this.hold.addEventListener('click', () => tools.toggleTrigger());
    this.entry = element(
      'button',
      {
        type: 'button',
        className: 'tool entry',
        ariaPressed: 'false',
        title: 'Lead its shaft through a point in the wall of the belly, which can be dragged (T)',
      },
      icon('entry'),
      'Entry',
    );
    this.entry.addEventListener('click', () => tools.toggleTrocar());
    this.remove = iconButton('remove', 'Take this tool away', () => {
      if (tools.chosen) tools.remove(tools.chosen.instrument);
    });
    this.remove.classList.add('remove');
    const depth = depthStrip(deepen);
    this.node.append(this.list, add, this.hold, this.entry, depth, this.remove);
    this.node.append(
      menuOn(add, 'Bring in', () =>
        (session.catalogue?.instruments ?? []).map((kind) => ({
          title: kind.title,
          note: kind.summary,
          run: () => tools.add(kind.kind),
        })),
      ),
    );
    session.on('catalogue', () => this.show());
    session.on('scene', () => this.show());
    session.on('role', () => this.show());
    session.on('frame', () => (this.entry.ariaPressed = String(tools.trocar !== undefined)));
  }

  show(): void {
    const { list, chosen, latched, mayDrive } = this.tools;
    const shape = JSON.stringify(list.map(({ instrument, kind, name }) => [instrument, kind, name]));
    if (shape !== this.shape) {
      this.shape = shape;
      this.list.replaceChildren(...list.map((instrument, index) => this.button(instrument, index)));
    }
    for (const button of this.list.children) {
      button.setAttribute(
        'aria-checked',
        String(button instanceof HTMLElement && button.dataset['instrument'] === String(chosen?.instrument)),
      );
    }
    const trigger = this.kindOf(chosen)?.trigger ?? '';
    this.hold.hidden = this.entry.hidden = this.remove.hidden = !chosen;
    this.hold.disabled = this.entry.disabled = this.remove.disabled = !mayDrive;
    this.hold.ariaPressed = String(latched);
    this.hold.title =
      trigger === '' ? 'This tool has no trigger' : `Keep on without pressing: ${trigger} (space)`;
    if (trigger === '') this.hold.hidden = true;
  }

  private kindOf(instrument: SceneInstrument | undefined): InstrumentKind | undefined {
    return this.session.catalogue?.instruments.find(({ kind }) => kind === instrument?.kind);
  }

  private button(instrument: SceneInstrument, index: number): HTMLButtonElement {
    const kind = this.kindOf(instrument);
    const label = element('span', { id: freshId('tool') });
    say(label, capital(instrument.name || kind?.title || instrument.kind));
    const button = element(
      'button',
      {
        type: 'button',
        className: 'tool',
        title: `${kind?.summary ?? ''} (${index + 1})`.trim(),
        data: { instrument: String(instrument.instrument) },
        attributes: { role: 'radio', 'aria-checked': 'false' },
      },
      icon(MANNERS[instrument.manner]),
      label,
    );
    button.addEventListener('click', () => this.tools.choose(instrument.instrument));
    return button;
  }
}

/** A strip to drag on: up is deeper. For fingers, which have no wheel; hidden where there is a mouse. */
function depthStrip(deepen: (part: number) => void): HTMLElement {
  const strip = element(
    'div',
    { className: 'depth', title: 'Drag: deeper, or nearer', ariaHidden: 'true' },
    icon('depth'),
    'Depth',
  );
  let from: number | undefined;
  strip.addEventListener('pointerdown', (event) => {
    from = event.clientY;
    strip.setPointerCapture(event.pointerId);
  });
  strip.addEventListener('pointermove', (event) => {
    if (from === undefined) return;
    deepen((from - event.clientY) * DEPTH_PER_PIXEL);
    from = event.clientY;
  });
  for (const end of ['pointerup', 'pointercancel'] as const)
    strip.addEventListener(end, () => (from = undefined));
  return strip;
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
