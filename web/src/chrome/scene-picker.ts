import { element } from '../dom';
import type { SessionClient } from '../engine/session';

/** The list of ready-made scenes; a scene of one's own stands above them by its title. */
export function scenePicker(session: SessionClient): HTMLElement {
  const select = element('select', { className: 'scene', ariaLabel: 'Scene', title: 'Scene' });
  const show = () => {
    const { catalogue, scene, role } = session;
    select.disabled = role.role !== 'controller';
    const scenes = catalogue?.scenes ?? [];
    const own =
      scene && !scenes.some(({ name }) => name === scene.name)
        ? [{ name: '', title: scene.title || scene.name }]
        : [];
    const options = [...own, ...scenes];
    const titles = options.map(({ title }) => title).join('\n');
    if (select.dataset['titles'] !== titles) {
      select.dataset['titles'] = titles;
      select.replaceChildren(...options.map(({ name, title }) => element('option', { value: name }, title)));
    }
    select.value = own.length > 0 ? '' : (scene?.name ?? '');
  };
  select.addEventListener('change', () => {
    if (select.value !== '') session.send({ type: 'open-scene', name: select.value });
  });
  session.on('catalogue', show);
  session.on('scene', show);
  session.on('role', show);
  return select;
}
