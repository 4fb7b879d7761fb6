import { Vector3 } from 'three';
import type { View } from '../drawing/view';
import type { Tools } from './tools';

/** How far one notch of the wheel, or a pixel of the second finger, moves a tool in depth: parts of its distance to the eye. */
const DEPTH_PER_WHEEL = 0.00025;
const DEPTH_PER_PIXEL = 0.0012;

/** Milliseconds between two looks at what the mouse passes over. */
const HOVER_PAUSE = 60;

interface Drag {
  pointer: number;
  /** From the point under the pointer to what is dragged [m], kept while dragging. */
  offset: Vector3;
  /** The plane of the drag goes through this point. */
  anchor: Vector3;
  /** What is dragged: a tool that works, one that is only moved, or where its shaft enters. */
  what: 'work' | 'tool' | 'trocar';
  second?: { pointer: number; y: number };
}

/**
 * Mouse, pen and fingers. Pressed on tissue, the chosen tool goes there and works: jaws close, the electrode burns, a probe pushes.
 * Dragging moves it in the plane that faces the eye, and the wheel or a second finger in depth. Pressed on a tool, it is taken
 * and moved without working; pressed where its shaft enters, that is moved. Everywhere else the camera turns.
 */
export class PointerHandling {
  private drag: Drag | undefined;
  private readonly fingers = new Set<number>();
  private lastHover = 0;
  private readonly view: View;
  private readonly tools: Tools;
  private readonly onWork: () => void;

  constructor(view: View, tools: Tools, onWork: () => void) {
    this.view = view;
    this.tools = tools;
    this.onWork = onWork;
    const { canvas } = view;
    // Capturing, so that a press on tissue is known before the camera hears of it.
    canvas.addEventListener('pointerdown', (event) => this.down(event), { capture: true });
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const)
      canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener('wheel', (event) => this.wheel(event), { capture: true, passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  get working(): boolean {
    return this.drag !== undefined;
  }

  private down(event: PointerEvent): void {
    if (event.pointerType === 'touch') this.fingers.add(event.pointerId);
    if (this.drag) {
      if (event.pointerType === 'touch') this.drag.second = { pointer: event.pointerId, y: event.clientY };
      return;
    }
    // A second finger on a turning view zooms it, also where it lands on tissue.
    if (this.fingers.size > 1) return;
    if (event.button !== 0 || event.ctrlKey || event.metaKey || event.shiftKey || !this.tools.mayDrive)
      return;
    const hit = this.view.pick(event.clientX, event.clientY);
    if (!hit) return;
    if (hit.kind !== 'tissue') {
      this.tools.choose(hit.instrument);
      const place = hit.kind === 'trocar' ? this.tools.trocar : this.tools.lead();
      if (place) this.begin(event, hit.point, place, hit.kind === 'trocar' ? 'trocar' : 'tool');
      return;
    }
    this.tools.begin(hit.point, hit.normal, this.heading(hit.point, hit.normal));
    const goal = this.tools.lead();
    if (goal) this.begin(event, hit.point, goal, 'work');
  }

  private begin(event: PointerEvent, point: Vector3, place: Vector3, what: Drag['what']): void {
    this.drag = { pointer: event.pointerId, offset: place.clone().sub(point), anchor: point.clone(), what };
    this.view.controls.enabled = false;
    this.view.canvas.setPointerCapture(event.pointerId);
    this.view.canvas.dataset['cursor'] = 'working';
    this.view.canvas.focus({ preventScroll: true });
    this.onWork();
  }

  private move(event: PointerEvent): void {
    const drag = this.drag;
    if (!drag) return this.hover(event);
    if (event.pointerId === drag.second?.pointer) {
      this.deepen((drag.second.y - event.clientY) * DEPTH_PER_PIXEL);
      drag.second.y = event.clientY;
      return;
    }
    if (event.pointerId !== drag.pointer) return;
    const point = this.view.onViewPlane(event.clientX, event.clientY, drag.anchor);
    if (!point) return;
    drag.anchor.copy(point);
    this.moveTo(drag, point);
  }

  private moveTo(drag: Drag, point: Vector3): void {
    const place = point.clone().add(drag.offset);
    if (drag.what === 'trocar') this.tools.moveTrocar(place);
    else this.tools.moveTo(place);
  }

  private up(event: PointerEvent): void {
    this.fingers.delete(event.pointerId);
    const drag = this.drag;
    if (drag?.second?.pointer === event.pointerId) {
      delete drag.second;
      return;
    }
    if (drag?.pointer !== event.pointerId) return;
    this.drag = undefined;
    this.view.controls.enabled = true;
    this.view.canvas.dataset['cursor'] = '';
    if (drag.what === 'work') this.tools.end();
  }

  private wheel(event: WheelEvent): void {
    if (!this.drag && !event.altKey) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    // Some systems turn the wheel sideways while Alt is held.
    this.deepen(-(event.deltaY || event.deltaX) * DEPTH_PER_WHEEL);
  }

  /** Moves the tool along the line of sight, away from the eye for positive `part`s of the distance. */
  deepen(part: number): void {
    const tip = this.tools.lead();
    if (!tip) return;
    const { drag } = this;
    const from = drag?.what === 'trocar' ? drag.anchor : tip;
    const step = from.clone().sub(this.view.camera.position).multiplyScalar(part);
    drag?.anchor.add(step);
    if (drag?.what === 'trocar') this.moveTo(drag, drag.anchor);
    else this.tools.nudge(step);
  }

  private hover(event: PointerEvent): void {
    if (
      event.pointerType === 'touch' ||
      event.buttons !== 0 ||
      event.timeStamp - this.lastHover < HOVER_PAUSE
    )
      return;
    this.lastHover = event.timeStamp;
    const hit = this.tools.mayDrive ? this.view.pick(event.clientX, event.clientY) : undefined;
    this.view.canvas.dataset['cursor'] = hit?.kind ?? '';
  }

  /** A free tool comes from where the user looks, a little from above, and never from inside the tissue. */
  private heading(point: Vector3, normal: Vector3): Vector3 {
    const sight = point.clone().sub(this.view.camera.position).normalize();
    const up = new Vector3(0, 1, 0).applyQuaternion(this.view.camera.quaternion);
    return sight.addScaledVector(normal, -0.9).addScaledVector(up, -0.55).normalize();
  }
}
