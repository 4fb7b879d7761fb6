import { element } from '../dom';
import { KEYS } from '../handling/keyboard';
import { iconButton } from './button';

const POINTER: readonly (readonly [string, string])[] = [
  ['Press on tissue', 'the tool goes there and works: jaws close, the electrode burns, a probe pushes'],
  ['Drag', 'moves it in the plane of the picture'],
  [
    'Wheel while pressing, or with Alt',
    'moves it in depth; on a tablet a second finger, or the strip at the left',
  ],
  ['Press on a tool', 'takes it in hand and moves it without working'],
  ['Press on the collar of a shaft', 'moves where it enters, in the wall of the belly'],
  ['Drag beside the tissue, right button', 'turns the view; with Shift or two fingers moves it'],
  ['Wheel, two fingers', 'zooms'],
  ['Drop a file', 'opens a mesh, a scene, a recording'],
];

/** All that hands can do here, as a dialog. */
export function helpDialog(): HTMLDialogElement {
  const close = iconButton('remove', 'Close', () => dialog.close());
  const dialog: HTMLDialogElement = element(
    'dialog',
    { className: 'help', attributes: { 'aria-labelledby': 'help-title' } },
    element('header', {}, element('h2', { id: 'help-title' }, 'How to work here'), close),
    element('h3', {}, 'Mouse and fingers'),
    table(POINTER),
    element('h3', {}, 'Keys, while the picture has the focus'),
    table(KEYS),
  );
  // A press beside the dialog lands on the dialog element itself, one within on what it holds.
  dialog.addEventListener('click', (event) => event.target === dialog && dialog.close());
  return dialog;
}

function table(lines: readonly (readonly [string, string])[]): HTMLElement {
  return element(
    'dl',
    {},
    ...lines.flatMap(([term, meaning]) => [element('dt', {}, term), element('dd', {}, meaning)]),
  );
}
