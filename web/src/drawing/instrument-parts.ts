import * as THREE from 'three';
import type { InstrumentPart, SceneInstrument } from '../engine/messages';

/**
 * One rigid part of an instrument as it is drawn: in its own frame it ends in the origin and comes along +z from behind, with the same round
 * ends as what touches.
 */
export interface DrawnPart {
  readonly node: THREE.Object3D;
  /** Whether its +y is to face its like. */
  readonly facing: boolean;
  /** Jaws are closed, the current is on. */
  setActive(active: boolean): void;
  setChosen(chosen: boolean): void;
  dispose(): void;
}

const STEEL = new THREE.MeshStandardMaterial({ color: 0xc9cfd2, metalness: 0.85, roughness: 0.26 });
/** What burns, told from what pushes at a glance. */
const ELECTRODE = new THREE.MeshStandardMaterial({ color: 0xc08a4e, metalness: 0.85, roughness: 0.34 });
const SLEEVE = new THREE.MeshStandardMaterial({ color: 0x1d2326, metalness: 0.1, roughness: 0.42 });
const RING = new THREE.MeshStandardMaterial({ color: 0x2f8f88, metalness: 0.2, roughness: 0.4 });
const CHOSEN_RING = new THREE.MeshStandardMaterial({
  color: 0xf0b266,
  emissive: 0x6b3d05,
  metalness: 0.2,
  roughness: 0.4,
});
const ROUND = 24;
const HOT = 0xff6a1f;

/** A rod: bare steel at its end, an insulated sleeve behind, and the ring that shows which tool is in hand. */
export function drawnShaft(
  part: InstrumentPart,
  manner: SceneInstrument['manner'],
  hinged: boolean,
): DrawnPart {
  const { radius, length } = part;
  const node = new THREE.Group();
  const bare = Math.min(manner === 'burn' ? 5 * radius : hinged ? 2.5 * radius : 3 * radius, 0.4 * length);
  const ending = (manner === 'burn' ? ELECTRODE : STEEL).clone();
  ending.emissive.set(HOT);
  ending.emissiveIntensity = 0;
  node.add(
    ball(radius, 0, ending),
    rod(radius, -bare, 0, ending),
    rod(radius, -length, -bare, SLEEVE),
    ball(radius, -length, SLEEVE),
  );
  const ring = rod(1.02 * radius, -bare - 2.2 * radius, -bare - 0.8 * radius, RING);
  node.add(ring);
  return {
    node,
    facing: false,
    setActive: (active) => (ending.emissiveIntensity = active && manner === 'burn' ? 1.6 : 0),
    setChosen: (chosen) => (ring.material = chosen ? CHOSEN_RING : RING),
    dispose: () => {
      ending.dispose();
      disposeShapes(node);
    },
  };
}

/** A jaw: a rod with round ends, flattened towards the other one (+y), with teeth across. */
export function drawnJaw({ radius, length }: InstrumentPart): DrawnPart {
  const node = new THREE.Group();
  node.add(new THREE.Mesh(jawShape(radius, length), STEEL));
  return {
    node,
    facing: true,
    setActive: () => undefined,
    setChosen: () => undefined,
    dispose: () => disposeShapes(node),
  };
}

/**
 * What acts without touching: the ball around the tip in which it takes hold, burns or pushes, and a line of light that shows where it
 * comes from. Seen through, and without a shadow, so that nobody takes it for a rod.
 */
export function drawnField(reach: number, manner: SceneInstrument['manner']): DrawnPart {
  const colour = manner === 'burn' ? 0xffb27a : 0x63cfc2;
  const glass = new THREE.MeshBasicMaterial({
    color: colour,
    transparent: true,
    opacity: 0.16,
    depthWrite: false,
  });
  const line = glass.clone();
  line.opacity = 0.4;
  const node = new THREE.Group();
  const field = new THREE.Mesh(new THREE.SphereGeometry(reach, 32, 20), glass);
  const beam = rod(0.06 * reach, -12 * reach, 0, line);
  const rim = new THREE.Mesh(new THREE.TorusGeometry(reach, 0.02 * reach, 8, 64), line);
  node.add(field, beam, rim);
  for (const mesh of node.children) mesh.renderOrder = 3;
  let chosen = false;
  let active = false;
  const shade = () => {
    glass.color.set(active && manner === 'burn' ? HOT : colour);
    glass.opacity = active ? 0.3 : 0.16;
    line.color.set(chosen ? 0xf0b266 : colour);
  };
  return {
    node,
    facing: false,
    setActive: (is) => {
      active = is;
      shade();
    },
    setChosen: (is) => {
      chosen = is;
      shade();
    },
    dispose: () => {
      glass.dispose();
      line.dispose();
      disposeShapes(node);
    },
  };
}

/** The capsule of a jaw, never outside of it: the side towards the other jaw is cut flat, and grooved. */
export function jawShape(radius: number, length: number): THREE.BufferGeometry {
  const pieces = Math.max(12, 4 * Math.round(length / radius));
  const shape = new THREE.CapsuleGeometry(radius, length, 8, ROUND, pieces);
  shape.rotateX(Math.PI / 2);
  shape.translate(0, 0, -0.5 * length);
  const places = shape.getAttribute('position');
  const groove = 0.75 * radius;
  for (let vertex = 0; vertex < places.count; vertex++) {
    const behind = -places.getZ(vertex);
    if (behind > 0.85 * length) continue;
    const flat = (0.62 + 0.16 * Math.cos((2 * Math.PI * behind) / groove)) * radius;
    places.setY(vertex, Math.min(places.getY(vertex), flat));
  }
  shape.computeVertexNormals();
  return shape;
}

function rod(radius: number, from: number, to: number, material: THREE.Material): THREE.Mesh {
  const mesh = new THREE.Mesh(
    new THREE.CylinderGeometry(radius, radius, Math.abs(to - from), ROUND, 1, true),
    material,
  );
  mesh.rotation.x = Math.PI / 2;
  mesh.position.z = 0.5 * (from + to);
  return mesh;
}

function ball(radius: number, at: number, material: THREE.Material): THREE.Mesh {
  const mesh = new THREE.Mesh(new THREE.SphereGeometry(radius, ROUND, ROUND / 2), material);
  mesh.position.z = at;
  return mesh;
}

function disposeShapes(node: THREE.Object3D): void {
  node.traverse((part) => {
    if (part instanceof THREE.Mesh) (part.geometry as THREE.BufferGeometry).dispose();
  });
}
