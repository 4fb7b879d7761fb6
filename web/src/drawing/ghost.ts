import * as THREE from 'three';
import type { FrameBody, Surface } from '../engine/messages';
import { edgesOf } from './edges';

/** The linear model beside the non-linear one: a fine wireframe that neither hides anything nor throws a shadow. */
export class Ghost {
  readonly lines = new THREE.LineSegments(new THREE.BufferGeometry(), lineMaterial(0.6, true));
  /** The same lines where tissue hides them, faint: a ghost inside the organ is to be seen as well. */
  private readonly hidden = new THREE.LineSegments(this.lines.geometry, lineMaterial(0.13, false));
  private epoch = -1;

  constructor() {
    this.lines.add(this.hidden);
    for (const lines of [this.lines, this.hidden]) {
      lines.frustumCulled = false;
      lines.renderOrder = 2;
    }
  }

  setSurface(surface: Surface): void {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute(
      'position',
      new THREE.BufferAttribute(surface.rest.slice(), 3).setUsage(THREE.DynamicDrawUsage),
    );
    geometry.setIndex(new THREE.BufferAttribute(edgesOf(surface.triangles, surface.vertices), 1));
    this.lines.geometry.dispose();
    this.lines.geometry = this.hidden.geometry = geometry;
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
    for (const { material } of [this.lines, this.hidden]) material.color.set(dark ? 0x7fe0ee : 0x14596b);
  }

  dispose(): void {
    this.lines.geometry.dispose();
    this.lines.material.dispose();
    this.hidden.material.dispose();
  }
}

function lineMaterial(opacity: number, depthTest: boolean): THREE.LineBasicMaterial {
  return new THREE.LineBasicMaterial({ transparent: true, opacity, depthTest, depthWrite: false });
}
