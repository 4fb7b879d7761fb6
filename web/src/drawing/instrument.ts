import * as THREE from 'three';
import type { FrameInstrument, InstrumentPart, SceneInstrument } from '../engine/messages';
import { drawnField, drawnJaw, drawnShaft, type DrawnPart } from './instrument-parts';
import { DrawnTrocar } from './trocar';

/** Numbers to each part of a frame: from, to, radius. */
const STRIDE = 7;

/**
 * An instrument as it is drawn: each of its rigid parts where the tissue feels it, and nothing else that tissue would seem to touch. One
 * without parts is drawn as what it is, a field around its tip.
 */
export class DrawnInstrument {
  readonly group = new THREE.Group();
  readonly description: SceneInstrument;
  private readonly parts: DrawnPart[];
  private readonly field: DrawnPart | undefined;
  private readonly trocar: DrawnTrocar;

  constructor(description: SceneInstrument) {
    this.description = description;
    const { manner, parts, reach } = description;
    const drawn = (part: InstrumentPart) =>
      part.kind === 'jaw' ? drawnJaw(part) : drawnShaft(part, manner, parts.length > 1);
    this.parts = parts.map(drawn);
    this.field = parts.length === 0 ? drawnField(reach, manner) : undefined;
    for (const part of this.all) {
      part.node.traverse((mesh) => {
        mesh.castShadow = part !== this.field;
        mesh.userData['instrument'] = description.instrument;
      });
      // Until a frame says where it is.
      part.node.visible = false;
      this.group.add(part.node);
    }
    const radius = parts[0]?.radius ?? 0.2 * reach;
    this.trocar = new DrawnTrocar(description.instrument, radius);
    this.group.add(this.trocar.node);
  }

  setFrame(frame: FrameInstrument): void {
    const at = (place: number): THREE.Vector3 => new THREE.Vector3().fromArray(frame.parts ?? [], place);
    const ends = this.parts.map((_, index) => [at(STRIDE * index), at(STRIDE * index + 3)] as const);
    const told = (frame.parts?.length ?? 0) === STRIDE * this.parts.length;
    this.parts.forEach((part, index) => {
      part.node.visible = told;
      const [from, to] = ends[index]!;
      // A jaw faces the other one.
      const other = part.facing ? ends.find((_, its) => its !== index && this.parts[its]!.facing) : undefined;
      if (told) place(part.node, from, to, other?.[1].clone().sub(to));
      part.setActive(frame.active);
    });
    const tip = new THREE.Vector3(...frame.tip);
    if (this.field) {
      this.field.node.visible = true;
      place(this.field.node, tip.clone().sub(new THREE.Vector3(...frame.direction)), tip);
      this.field.setActive(frame.active);
    }
    this.trocar.setFrame(frame.trocar, tip);
  }

  setChosen(chosen: boolean): void {
    for (const part of this.all) part.setChosen(chosen);
    this.trocar.setChosen(chosen);
  }

  dispose(): void {
    for (const part of this.all) part.dispose();
    this.trocar.dispose();
  }

  private get all(): readonly DrawnPart[] {
    return this.field ? [...this.parts, this.field] : this.parts;
  }
}

/** Turns a part that ends in its own origin and comes along its own +z, so that it does so from `from` to `to`; its +y to `facing`. */
function place(node: THREE.Object3D, from: THREE.Vector3, to: THREE.Vector3, facing?: THREE.Vector3): void {
  const along = to.clone().sub(from).normalize();
  const across = new THREE.Vector3(0, Math.abs(along.y) < 0.9 ? 1 : 0, Math.abs(along.y) < 0.9 ? 0 : 1);
  const up = facing && facing.lengthSq() > 0 ? facing : across;
  const side = new THREE.Vector3().crossVectors(up, along).normalize();
  const basis = new THREE.Matrix4().makeBasis(side, new THREE.Vector3().crossVectors(along, side), along);
  node.position.copy(to);
  node.quaternion.setFromRotationMatrix(basis);
}
