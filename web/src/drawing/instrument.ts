import * as THREE from 'three';
import type { FrameInstrument, SceneInstrument } from '../engine/messages';
import { orientation } from './orientation';

const STEEL = new THREE.MeshStandardMaterial({ color: 0xc9cfd2, metalness: 0.85, roughness: 0.26 });
const SLEEVE = new THREE.MeshStandardMaterial({ color: 0x1d2326, metalness: 0.1, roughness: 0.42 });
const RING = new THREE.MeshStandardMaterial({ color: 0x2f8f88, metalness: 0.2, roughness: 0.4 });
const CHOSEN_RING = new THREE.MeshStandardMaterial({
  color: 0xf0b266,
  emissive: 0x6b3d05,
  metalness: 0.2,
  roughness: 0.4,
});
const ROUND = 24;

/**
 * An instrument as it is drawn. In its own frame the tip is the origin and the shaft comes along +z from behind, so that one
 * rotation and one translation place it.
 */
export class DrawnInstrument {
  readonly group = new THREE.Group();
  readonly description: SceneInstrument;
  private readonly jaws: THREE.Group[] = [];
  private readonly glow: THREE.MeshStandardMaterial;
  private readonly ring: THREE.Mesh;
  private readonly trocar: THREE.Mesh | undefined;

  constructor(description: SceneInstrument) {
    this.description = description;
    this.glow = STEEL.clone();
    this.glow.emissive.set(0xff6a1f);
    this.glow.emissiveIntensity = 0;
    const front = description.jaw
      ? this.addJaws(description.jaw)
      : description.hook
        ? this.addHook(description.hook)
        : this.addTip();
    this.ring = this.addShaft(front);
    this.group.traverse((part) => {
      part.castShadow = true;
      part.userData['instrument'] = description.instrument;
    });
    if (description.trocar) {
      const radius = description.shaft.radius;
      this.trocar = new THREE.Mesh(new THREE.TorusGeometry(1.7 * radius, 0.45 * radius, 10, 32), RING);
      this.trocar.position.set(...description.trocar);
    }
  }

  /** What does not move with the tool, to be added to the scene as well. */
  get fixture(): THREE.Object3D | undefined {
    return this.trocar;
  }

  setFrame(frame: FrameInstrument): void {
    this.group.position.set(...frame.tip);
    this.group.quaternion.copy(orientation(new THREE.Vector3(...frame.direction), frame.roll));
    this.jaws.forEach((jaw, index) => (jaw.rotation.x = (index === 0 ? -0.5 : 0.5) * frame.opening));
    this.glow.emissiveIntensity = frame.active && this.description.hook ? 1.6 : 0;
    this.trocar?.lookAt(this.group.position);
  }

  setChosen(chosen: boolean): void {
    this.ring.material = chosen ? CHOSEN_RING : RING;
  }

  dispose(): void {
    this.glow.dispose();
    for (const root of [this.group, this.trocar]) {
      root?.traverse((part) => {
        if (part instanceof THREE.Mesh) (part.geometry as THREE.BufferGeometry).dispose();
      });
    }
  }

  /** A steel neck, the insulated sleeve, and a coloured ring that shows which tool is in hand. `front`: where it begins. */
  private addShaft(front: number): THREE.Mesh {
    const { radius, length } = this.description.shaft;
    const neck = Math.min(3 * radius, 0.2 * length);
    const back = -Math.max(length, -front + 2 * neck);
    this.group.add(rod(0.86 * radius, front, front - neck, STEEL));
    this.group.add(rod(radius, front - neck, back, SLEEVE));
    const ring = rod(1.12 * radius, front - 1.6 * neck, front - 1.6 * neck - 1.4 * radius, RING);
    this.group.add(ring);
    return ring;
  }

  /** A rounded tip, as of a probe; returns where the shaft begins. */
  private addTip(): number {
    const radius = this.description.shaft.radius;
    const ball = new THREE.Mesh(new THREE.SphereGeometry(radius, ROUND, ROUND / 2), STEEL);
    this.group.add(ball);
    return 0;
  }

  private addJaws(jaw: { length: number; radius: number }): number {
    const hinge = -jaw.length;
    for (const side of [1, -1] as const) {
      const blade = new THREE.Group();
      blade.position.z = hinge;
      blade.add(new THREE.Mesh(bladeGeometry(jaw.length, jaw.radius, side), STEEL));
      this.jaws.push(blade);
      this.group.add(blade);
    }
    const pin = new THREE.Mesh(
      new THREE.CylinderGeometry(0.9 * jaw.radius, 0.9 * jaw.radius, 2.6 * jaw.radius, ROUND),
      STEEL,
    );
    pin.rotation.z = Math.PI / 2;
    pin.position.z = hinge;
    this.group.add(pin);
    return hinge;
  }

  /** An L of wire: its heel comes first, and the short arm points sideways. */
  private addHook(hook: { length: number; radius: number }): number {
    const neck = -1.6 * hook.length;
    const path = new THREE.CatmullRomCurve3(
      [
        new THREE.Vector3(0, 0, neck),
        new THREE.Vector3(0, 0, -0.35 * hook.length),
        new THREE.Vector3(0, 0.12 * hook.length, -0.04 * hook.length),
        new THREE.Vector3(0, 0.45 * hook.length, 0),
        new THREE.Vector3(0, hook.length, 0),
      ],
      false,
      'centripetal',
    );
    const wire = new THREE.Mesh(new THREE.TubeGeometry(path, 24, hook.radius, 12), this.glow);
    const end = new THREE.Mesh(new THREE.SphereGeometry(hook.radius, 12, 8), this.glow);
    end.position.set(0, hook.length, 0);
    this.group.add(wire, end);
    return neck;
  }
}

function rod(radius: number, from: number, to: number, material: THREE.Material): THREE.Mesh {
  const mesh = new THREE.Mesh(
    new THREE.CylinderGeometry(radius, radius, Math.abs(to - from), ROUND),
    material,
  );
  mesh.rotation.x = Math.PI / 2;
  mesh.position.z = 0.5 * (from + to);
  return mesh;
}

/** One blade from the hinge (z = 0) to its rounded end (z = length): flat towards the other blade, with teeth. */
function bladeGeometry(length: number, radius: number, side: 1 | -1): THREE.BufferGeometry {
  const profile = new THREE.Shape();
  const teeth = 7;
  const root = 0.25 * length;
  profile.moveTo(0, 0);
  profile.lineTo(root, 0.12 * radius);
  for (let tooth = 0; tooth < teeth; tooth++) {
    const begin = root + ((0.97 * length - root) * tooth) / teeth;
    const end = root + ((0.97 * length - root) * (tooth + 1)) / teeth;
    profile.lineTo(0.5 * (begin + end), 0.3 * radius);
    profile.lineTo(end, 0.04 * radius);
  }
  profile.quadraticCurveTo(1.03 * length, 0.4 * radius, 0.94 * length, 0.85 * radius);
  profile.lineTo(root, 1.15 * radius);
  profile.lineTo(0, 0.9 * radius);
  profile.closePath();
  const geometry = new THREE.ExtrudeGeometry(profile, {
    depth: 1.5 * radius,
    bevelEnabled: true,
    bevelSize: 0.16 * radius,
    bevelThickness: 0.16 * radius,
    bevelSegments: 2,
    curveSegments: 6,
  });
  // The profile lies in (z, y); `side` mirrors it by turning the blade about its long axis.
  geometry.translate(0, 0, -0.75 * radius);
  geometry.rotateY(-Math.PI / 2);
  if (side === -1) geometry.rotateZ(Math.PI);
  return geometry;
}
