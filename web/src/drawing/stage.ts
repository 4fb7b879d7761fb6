import * as THREE from 'three';
import type { Frame, Scene, Surface } from '../engine/messages';
import { mapOf } from './colouring';
import { Ghost } from './ghost';
import { DrawnInstrument } from './instrument';
import { Organ } from './organ';
import { LIVER_SKIN } from './tissue-material';
import type { Hit } from './view';

/** Skins of further bodies, so that two organs can be told apart: liver, gallbladder, kidney, stomach. */
const SKINS: readonly THREE.Color[] = [
  LIVER_SKIN,
  new THREE.Color(0.2, 0.21, 0.075),
  new THREE.Color(0.33, 0.1, 0.075),
  new THREE.Color(0.52, 0.22, 0.17),
];

/** The bodies, ghosts and instruments of the scene that is shown. */
export class Stage {
  readonly group = new THREE.Group();
  private scene: Scene | undefined;
  private coat = true;
  private dark = false;
  private bodies: (Organ | Ghost)[] = [];
  private instruments = new Map<number, DrawnInstrument>();
  private chosen: number | undefined;

  setScene(scene: Scene, coat: boolean): void {
    this.coat = coat;
    // A restarted program counts its epochs anew: what the bodies are has to agree as well.
    const consists = (of: Scene | undefined) => JSON.stringify([of?.epoch, of?.name, of?.bodies]);
    if (consists(scene) !== consists(this.scene)) this.replaceBodies(scene);
    this.scene = scene;
    this.replaceInstruments(scene);
  }

  /** Whether nothing was drawn yet. */
  get isBare(): boolean {
    return !this.bodies.some((body) => body instanceof Organ && body.mesh.geometry.hasAttribute('position'));
  }

  setSurface(surface: Surface): void {
    if (surface.scene === this.scene?.epoch) this.bodies[surface.body]?.setSurface(surface);
  }

  setFrame(frame: Frame): void {
    if (frame.scene !== this.scene?.epoch) return;
    const map = mapOf(frame.colouring.by, frame.colouring.low);
    frame.bodies.forEach((state, index) => {
      const body = this.bodies[index];
      if (body instanceof Organ) {
        body.showValues(
          map && state.scalars ? { map, low: frame.colouring.low, high: frame.colouring.high } : null,
        );
      }
      body?.setFrame(state);
    });
    for (const instrument of frame.instruments)
      this.instruments.get(instrument.instrument)?.setFrame(instrument);
  }

  setChosen(instrument: number | undefined): void {
    this.chosen = instrument;
    for (const [number, drawn] of this.instruments) drawn.setChosen(number === instrument);
  }

  setCoat(coat: boolean): void {
    this.coat = coat;
    for (const body of this.bodies) if (body instanceof Organ) body.setCoat(coat);
  }

  setTheme(dark: boolean): void {
    this.dark = dark;
    for (const body of this.bodies) if (body instanceof Ghost) body.setTheme(dark);
  }

  pick(caster: THREE.Raycaster): Hit | undefined {
    const organs = this.bodies.filter((body) => body instanceof Organ);
    const tools = [...this.instruments.values()];
    const roots = [...organs.map((organ) => organ.mesh), ...tools.map((tool) => tool.group)];
    const first = caster.intersectObjects(roots, true).find(({ object }) => isShown(object));
    if (!first) return undefined;
    const trocar: unknown = first.object.userData['trocar'];
    if (typeof trocar === 'number') return { kind: 'trocar', instrument: trocar, point: first.point };
    const instrument: unknown = first.object.userData['instrument'];
    if (typeof instrument === 'number') return { kind: 'instrument', instrument, point: first.point };
    const body = this.bodies.findIndex((other) => other instanceof Organ && other.mesh === first.object);
    const normal = first.face?.normal.clone() ?? new THREE.Vector3(0, 1, 0);
    if (normal.dot(caster.ray.direction) > 0) normal.negate();
    return { kind: 'tissue', body, point: first.point, normal };
  }

  /** Height of the lowest point drawn [m], or `otherwise` while nothing is. */
  lowest(otherwise: number): number {
    let lowest = Infinity;
    for (const body of this.bodies) {
      if (!(body instanceof Organ)) continue;
      const positions = body.mesh.geometry.getAttribute('position') as THREE.BufferAttribute | undefined;
      for (let vertex = 0; vertex < (positions?.count ?? 0); vertex++)
        lowest = Math.min(lowest, positions!.getY(vertex));
    }
    return Number.isFinite(lowest) ? lowest : otherwise;
  }

  /**
   * How far from `centre` one has to be, looking along `look` (of length 1), so that everything drawn lies below and above it within `slope` (height
   * over distance). [m]
   */
  distanceToSee(centre: THREE.Vector3, look: THREE.Vector3, up: THREE.Vector3, slope: number): number {
    const above = up.clone().addScaledVector(look, -up.dot(look)).normalize();
    const place = new THREE.Vector3();
    let distance = 0;
    for (const body of this.bodies) {
      if (!(body instanceof Organ)) continue;
      const positions = body.mesh.geometry.getAttribute('position') as THREE.BufferAttribute | undefined;
      for (let vertex = 0; vertex < (positions?.count ?? 0); vertex++) {
        place.fromBufferAttribute(positions!, vertex).sub(centre);
        distance = Math.max(distance, Math.abs(place.dot(above)) / slope - place.dot(look));
      }
    }
    return distance;
  }

  private replaceBodies(scene: Scene): void {
    for (const body of this.bodies) {
      this.group.remove(body instanceof Organ ? body.mesh : body.lines);
      body.dispose();
    }
    let skins = 0;
    this.bodies = scene.bodies.map((description) => {
      if (description.ghostOf === undefined) {
        const organ = new Organ(2 * scene.radius, this.coat, SKINS[skins++ % SKINS.length]!);
        this.group.add(organ.mesh);
        return organ;
      }
      const ghost = new Ghost();
      ghost.setTheme(this.dark);
      this.group.add(ghost.lines);
      return ghost;
    });
  }

  private replaceInstruments(scene: Scene): void {
    const wanted = new Map(scene.instruments.map((instrument) => [instrument.instrument, instrument]));
    for (const [number, drawn] of this.instruments) {
      if (sameShape(drawn.description, wanted.get(number))) {
        wanted.delete(number);
        continue;
      }
      this.group.remove(drawn.group);
      drawn.dispose();
      this.instruments.delete(number);
    }
    for (const [number, description] of wanted) {
      const drawn = new DrawnInstrument(description);
      drawn.setChosen(number === this.chosen);
      this.instruments.set(number, drawn);
      this.group.add(drawn.group);
    }
  }
}

/** What is only there to be pressed is not drawn itself, and what it belongs to is. */
function isShown(object: THREE.Object3D): boolean {
  return object.parent !== null && object.parent.visible;
}

function sameShape(
  one: Scene['instruments'][number],
  other: Scene['instruments'][number] | undefined,
): boolean {
  return JSON.stringify(one) === JSON.stringify(other);
}
