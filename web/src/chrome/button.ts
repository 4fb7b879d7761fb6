import { element } from '../dom';
import { icon, type IconName } from './icons';

/** A button with a picture; `label` is its name for all who do not see it, and its tip for all who do. */
export function iconButton(name: IconName, label: string, onClick?: () => void): HTMLButtonElement {
  const button = element(
    'button',
    { type: 'button', className: 'icon-button', title: label, ariaLabel: label },
    icon(name),
  );
  if (onClick) button.addEventListener('click', onClick);
  return button;
}

/** Gives a button another picture and name, where they differ. */
export function relabel(button: HTMLButtonElement, name: IconName, label: string): void {
  if (button.title === label) return;
  button.title = button.ariaLabel = label;
  button.replaceChildren(icon(name));
}
