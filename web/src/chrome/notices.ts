import type { Notice } from '../engine/messages';
import { element } from '../dom';
import { iconButton } from './button';

/** Seconds that a notice stays; errors stay until they are closed. */
const STAY = { info: 7, warning: 12, error: Infinity } as const;
const MOST = 4;

/** What the engine has to say, at the top of the picture: newest first, and the same thing once. */
export class Notices {
  readonly node = element('div', {
    className: 'notices',
    attributes: { role: 'log', 'aria-live': 'polite', 'aria-label': 'Notices' },
  });

  show(
    level: Notice['level'],
    text: string,
    help = '',
    excerpt?: { source: string; line: number; text: string; column: number; length: number },
  ): void {
    for (const other of this.node.children) {
      if (other instanceof HTMLElement && other.dataset['text'] === text) other.remove();
    }
    // A report of many lines would lie over the organ: its first says what it is about.
    const [first = text, ...others] = level === 'info' ? text.split('\n') : [text];
    const more =
      others.length > 0
        ? element('details', {}, element('summary', {}, 'More'), element('p', {}, others.join('\n')))
        : undefined;
    const close = iconButton('remove', 'Close this notice', () => notice.remove());
    const notice = element(
      'div',
      { className: `notice ${level}`, data: { text } },
      element(
        'div',
        { className: 'notice-text' },
        element('p', {}, first),
        more,
        help ? element('p', { className: 'note' }, help) : undefined,
        excerpt ? excerptOf(excerpt) : undefined,
      ),
      close,
    );
    if (level === 'error') notice.setAttribute('role', 'alert');
    this.node.prepend(notice);
    while (this.node.children.length > MOST) this.node.lastElementChild?.remove();
    // One that is being read stays.
    if (Number.isFinite(STAY[level])) setTimeout(() => !more?.open && notice.remove(), 1000 * STAY[level]);
  }
}

/** The line of a text in which something is wrong, with the place marked. */
function excerptOf({
  source,
  line,
  text,
  column,
  length,
}: {
  source: string;
  line: number;
  text: string;
  column: number;
  length: number;
}): HTMLElement {
  const begin = Math.max(0, column - 1);
  return element(
    'pre',
    {},
    `${source}:${line}\n${text.slice(0, begin)}`,
    element('mark', {}, text.slice(begin, begin + Math.max(1, length))),
    text.slice(begin + Math.max(1, length)),
  );
}
