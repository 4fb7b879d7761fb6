import { element, freshId } from '../dom';

export interface Entry {
  readonly title: string;
  readonly note?: string;
  readonly disabled?: boolean;
  run(): void;
}

/** Hangs a list of entries below a button: the browser's own popover, with arrow keys. Entries are asked for when it opens. */
export function menuOn(
  button: HTMLButtonElement,
  title: string,
  entries: () => readonly Entry[],
): HTMLElement {
  const menu = element('div', {
    id: freshId('menu'),
    className: 'menu',
    popover: 'auto',
    attributes: { role: 'menu', 'aria-label': title },
  });
  button.setAttribute('aria-haspopup', 'menu');
  button.popoverTargetElement = menu;
  menu.addEventListener('beforetoggle', (event) => {
    if (event.newState !== 'open') return;
    menu.replaceChildren(element('h3', {}, title), ...entries().map((entry) => entryOf(entry, menu)));
  });
  menu.addEventListener('toggle', (event) => {
    if (event.newState !== 'open') return;
    place(menu, button);
    items(menu)[0]?.focus();
  });
  menu.addEventListener('keydown', (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    const all = items(menu);
    const here = all.indexOf(document.activeElement as HTMLButtonElement);
    all[(here + step + all.length) % all.length]?.focus();
  });
  return menu;
}

function items(menu: HTMLElement): HTMLButtonElement[] {
  return [...menu.querySelectorAll<HTMLButtonElement>('button:not(:disabled)')];
}

function entryOf(entry: Entry, menu: HTMLElement): HTMLElement {
  const note = entry.note ? element('span', { className: 'note' }, entry.note) : undefined;
  const button = element(
    'button',
    { type: 'button', disabled: entry.disabled ?? false, attributes: { role: 'menuitem' } },
    element('span', {}, entry.title),
    note,
  );
  button.addEventListener('click', () => {
    menu.hidePopover();
    entry.run();
  });
  return button;
}

/** Below the button or beside it, and always within the page. */
function place(menu: HTMLElement, button: HTMLElement): void {
  const at = button.getBoundingClientRect();
  const size = menu.getBoundingClientRect();
  const gap = 6;
  const beside = at.left < size.width && at.bottom > 0.3 * innerHeight;
  const left = beside ? at.right + gap : Math.min(at.left, innerWidth - size.width - gap);
  const top = Math.min(beside ? at.top : at.bottom + gap, innerHeight - size.height - gap);
  Object.assign(menu.style, { left: `${Math.max(gap, left)}px`, top: `${Math.max(gap, top)}px` });
}
