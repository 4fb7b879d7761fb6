import { Vector3 } from 'three';
import type { View } from '../drawing/view';
import type { Tools } from './tools';

/** What keys do that is not the tool's or the camera's. */
export interface Shortcuts {
  pauseOrPlay(): void;
  step(): void;
  reset(): void;
  help(): void;
}

/** One press of an arrow: parts of the scene's radius, and radians for the camera. */
const STRIDE = 0.03;
const FINE = 0.2;
const TURN = 0.09;

/** All keys, as the help shows them. */
export const KEYS: readonly (readonly [keys: string, what: string])[] = [
  ['Arrows', 'move the tool across the view'],
  ['W / S, Page Up / Down', 'move it away, or towards you'],
  ['Q / E', 'turn it about its shaft'],
  ['T', 'lead its shaft through the wall of the belly, or let it go'],
  ['I J K L, U / O', 'move where it enters: up, left, down, right; away, or towards you'],
  ['Space', 'close or open the jaws, switch the current'],
  ['Alt', 'with any of these: finely'],
  ['1 … 9', 'choose a tool'],
  ['Shift + arrows', 'turn the view'],
  ['+ / −, 0', 'zoom, and the first view again'],
  ['P', 'pause, or go on'],
  ['. (full stop)', 'one step, while paused'],
  ['R', 'reset the scene'],
  ['? or H', 'this help'],
];

/** Keys while the picture has the focus; those of the scene work wherever nothing is typed. */
export function handleKeys(view: View, tools: Tools, radius: () => number, shortcuts: Shortcuts): void {
  view.canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey) return;
    if (moveTool(event, view, tools, radius()) || moveCamera(event, view)) event.preventDefault();
  });
  window.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target)) return;
    if (scene(event.key, tools, shortcuts)) event.preventDefault();
  });
}

function moveTool(event: KeyboardEvent, view: View, tools: Tools, radius: number): boolean {
  if (event.shiftKey) return false;
  if (event.key === ' ') {
    if (!event.repeat) tools.toggleTrigger();
    return true;
  }
  const roll = { q: -1, e: 1 }[event.key.toLowerCase()];
  if (roll !== undefined) {
    tools.roll(roll * TURN * (event.altKey ? FINE : 1));
    return true;
  }
  if (event.code === 'KeyT') {
    if (!event.repeat) tools.toggleTrocar();
    return true;
  }
  const stride = STRIDE * radius * (event.altKey ? FINE : 1);
  const across = (way: Vector3) => way.applyQuaternion(view.camera.quaternion).multiplyScalar(stride);
  const way = {
    ArrowLeft: new Vector3(-1, 0, 0),
    ArrowRight: new Vector3(1, 0, 0),
    ArrowUp: new Vector3(0, 1, 0),
    ArrowDown: new Vector3(0, -1, 0),
    PageUp: new Vector3(0, 0, -1),
    PageDown: new Vector3(0, 0, 1),
    KeyW: new Vector3(0, 0, -1),
    KeyS: new Vector3(0, 0, 1),
  }[event.code];
  if (way) tools.nudge(across(way));
  const entry = {
    KeyJ: new Vector3(-1, 0, 0),
    KeyL: new Vector3(1, 0, 0),
    KeyI: new Vector3(0, 1, 0),
    KeyK: new Vector3(0, -1, 0),
    KeyU: new Vector3(0, 0, -1),
    KeyO: new Vector3(0, 0, 1),
  }[event.code];
  if (entry && tools.trocar) tools.moveTrocar(tools.trocar.add(across(entry)));
  return way !== undefined || entry !== undefined;
}

function moveCamera(event: KeyboardEvent, view: View): boolean {
  if (event.shiftKey && event.key.startsWith('Arrow')) {
    const around = { ArrowLeft: -TURN, ArrowRight: TURN }[event.key] ?? 0;
    const over = { ArrowUp: -TURN, ArrowDown: TURN }[event.key] ?? 0;
    view.orbit(around, over);
  } else if (event.key === '+' || event.key === '=') view.zoom(0.88);
  else if (event.key === '-') view.zoom(1 / 0.88);
  else if (event.key === '0') view.goHome();
  else return false;
  return true;
}

function scene(key: string, tools: Tools, shortcuts: Shortcuts): boolean {
  const chosen = /^[1-9]$/.test(key) ? tools.list[Number(key) - 1] : undefined;
  if (chosen) tools.choose(chosen.instrument);
  else if (key === 'p' || key === 'P') shortcuts.pauseOrPlay();
  else if (key === '.') shortcuts.step();
  else if (key === 'r' || key === 'R') shortcuts.reset();
  else if (key === '?' || key === 'h' || key === 'H') shortcuts.help();
  else return false;
  return true;
}

function isTyping(target: EventTarget | null): boolean {
  return (
    target instanceof HTMLElement &&
    (target.isContentEditable || /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName))
  );
}
