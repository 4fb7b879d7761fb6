import * as THREE from 'three';
import type { FrameBody, Surface } from '../engine/messages';
import { edgesOf } from './edges';

/** The linear model beside the non-linear one: a fine wireframe that neither hides anything nor throws a shadow. */
export class Ghost {
  readonly lines = new THREE.LineSegments(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ color: 0x2b7f94, transparent: true, opacity: 0.55, depthWrite: false }),
  );
  private epoch = -1;

  constructor() {
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 2;
  }

  setSurface(surface: Surface): void {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(surface.rest.slice(), 3).setUsage(THREE.DynamicDrawUsage));
    geometry.setIndex(new THREE.BufferAttribute(edgesOf(surface.triangles, surface.vertices), 1));
    this.lines.geometry.dispose();
    this.lines.geometry = geometry;
    this.epoch = surface.epoch;
  }

  setFrame(body: FrameBody): void {
    if (body.epoch !== this.epoch) return;
    const position = this.lines.geometry.getAttribute('position') as THREE.BufferAttribute;
    if (position.array.length !== body.positions.length) return;
    (position.array as Float32Array).set(body.positions);
    position.needsUpdate = true;
  }

  setTheme(dark: boolean): void {
    this.lines.material.color.set(dark ? 0x7fe0ee : 0x14596b);
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
  }
}
