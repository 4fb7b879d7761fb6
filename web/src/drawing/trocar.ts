import * as THREE from 'three';
import type { Vector } from '../engine/messages';

const SEAL = new THREE.MeshStandardMaterial({ color: 0x2f8f88, metalness: 0.1, roughness: 0.5 });
const CHOSEN_SEAL = new THREE.MeshStandardMaterial({ color: 0xf0b266, metalness: 0.1, roughness: 0.5 });

/**
 * Where a shaft enters: a collar with a short sleeve below it, turned along the shaft. It can be pressed and moved; fingers need not hit it
 * to the pixel.
 */
export class DrawnTrocar {
  readonly node = new THREE.Group();
  private readonly collar: THREE.Mesh;
  private readonly sleeve: THREE.Mesh;

  /** `radius`: of the shaft [m]. */
  constructor(instrument: number, radius: number) {
    this.collar = new THREE.Mesh(new THREE.TorusGeometry(1.9 * radius, 0.6 * radius, 12, 36), SEAL);
    const sleeve = new THREE.CylinderGeometry(1.45 * radius, 1.45 * radius, 5 * radius, 24, 1, true);
    sleeve.rotateX(Math.PI / 2);
    sleeve.translate(0, 0, 2.5 * radius);
    this.sleeve = new THREE.Mesh(sleeve, SEAL);
    const hold = new THREE.Mesh(new THREE.SphereGeometry(4.5 * radius, 12, 8));
    hold.visible = false;
    for (const part of [this.collar, this.sleeve, hold]) {
      part.castShadow = part !== hold;
      part.userData['trocar'] = instrument;
    }
    this.node.add(this.collar, this.sleeve, hold);
    this.node.visible = false;
  }

  setFrame(at: Vector | undefined, tip: THREE.Vector3): void {
    this.node.visible = at !== undefined;
    if (!at) return;
    this.node.position.set(...at);
    this.node.lookAt(tip);
  }

  setChosen(chosen: boolean): void {
    this.collar.material = this.sleeve.material = chosen ? CHOSEN_SEAL : SEAL;
  }

  dispose(): void {
    for (const part of this.node.children)
      if (part instanceof THREE.Mesh) (part.geometry as THREE.BufferGeometry).dispose();
  }
}
