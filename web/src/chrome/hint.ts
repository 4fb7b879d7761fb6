import { element } from '../dom';
import type { SceneInstrument } from '../engine/messages';
import { icon, type IconName } from './icons';
import { remember, remembered } from './theme';

type Manner = SceneInstrument['manner'];

const KEY = 'viscera.hint';

const WORK: Record<Manner, readonly [icon: IconName, text: string]> = {
  hold: ['grasp', 'Press on the tissue to grasp it, and drag to pull.'],
  burn: ['burn', 'Press on the tissue to burn it, and drag along the cut.'],
  push: ['push', 'Press on the tissue to push it in, and drag to slide.'],
};
const NO_TOOL = ['add', 'Bring in a tool at the left, or press on the tissue to get one.'] as const;

/** How to begin, for those who see the page for the first time. Gone for good once it was read or done. */
export class Hint {
  readonly node = element('section', {
    className: 'hint',
    hidden: true,
    attributes: { 'aria-label': 'How to begin' },
  });
  private shown = '';

  /** `inHand`: what the tool in hand does; `others`: what the other tools of the scene do, and what they are called. */
  show(
    inHand: Manner | undefined,
    others: readonly (readonly [Manner, name: string])[],
    touch = matchMedia('(pointer: coarse)').matches,
  ): void {
    const wanted = JSON.stringify([inHand, others]);
    if (wanted === this.shown || remembered(KEY) !== null) return;
    this.shown = wanted;
    const cutter = inHand === 'burn' ? undefined : others.find(([manner]) => manner === 'burn');
    const line = (name: IconName, text: string) => element('li', {}, icon(name), element('span', {}, text));
    const close = element('button', { type: 'button', className: 'text-button' }, 'Understood');
    close.addEventListener('click', () => this.dismiss());
    this.node.replaceChildren(
      element(
        'ul',
        {},
        line(...(inHand ? WORK[inHand] : NO_TOOL)),
        cutter ? line('burn', `To cut, choose the ${cutter[1]} at the left, and press likewise.`) : undefined,
        line(
          'depth',
          touch
            ? 'A second finger, or the strip at the left, moves it in depth.'
            : 'While pressing, the wheel moves it in depth.',
        ),
        line(
          'reset',
          touch
            ? 'Beside the tissue, a finger turns the view; two move and zoom it.'
            : 'Beside the tissue, or with the right button, you turn the view; the wheel zooms.',
        ),
      ),
      element(
        'div',
        { className: 'hint-foot' },
        element('span', { className: 'note' }, touch ? '' : 'H shows all keys.'),
        close,
      ),
    );
    this.node.hidden = false;
  }

  dismiss(): void {
    this.node.hidden = true;
    remember(KEY, 'read');
  }
}
