import * as THREE from 'three';
import type { FrameBody, Surface } from '../engine/messages';
import type { ColourMapName } from './colour-map';
import { smoothNormals } from './normals';
import { splitRim, type DrawnSurface } from './rim';
import { tissueLook, type TissueLook } from './tissue-material';

/** Values shown as colours: which map, and the values at its ends. */
export interface ShownValues {
  readonly map: ColourMapName;
  readonly low: number;
  readonly high: number;
}

/** A body of the scene as it is drawn. */
export class Organ {
  readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshStandardMaterial>;
  private look: TissueLook;
  private readonly size: number;
  private readonly skin: THREE.Color;
  private drawn: DrawnSurface | undefined;
  private epoch = -1;
  private shown: ShownValues | null = null;

  constructor(size: number, coat: boolean, skin: THREE.Color) {
    this.size = size;
    this.skin = skin;
    this.look = tissueLook(size, coat, skin);
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), this.look.material);
    // Drawn before it has normals, the material would be made for flat faces and stay so.
    this.mesh.visible = false;
    this.mesh.castShadow = true;
    this.mesh.receiveShadow = true;
    // The bounds change with every frame, and the organ is what one looks at.
    this.mesh.frustumCulled = false;
  }

  /** Takes another surface: new buffers, as a cut adds vertices. */
  setSurface(surface: Surface): void {
    const drawn = splitRim(surface.vertices, surface.triangles, surface.cut);
    const count = drawn.source.length;
    const geometry = new THREE.BufferGeometry();
    const rest = new Float32Array(3 * count);
    gather(surface.rest, drawn.source, rest);
    const marks = new Float32Array(2 * count);
    for (let vertex = 0; vertex < count; vertex++) marks[2 * vertex + 1] = drawn.inner[vertex]!;
    const changing = (array: Float32Array, size: number) =>
      new THREE.BufferAttribute(array, size).setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute('position', changing(rest.slice(), 3));
    geometry.setAttribute('normal', changing(new Float32Array(3 * count), 3));
    geometry.setAttribute('rest', new THREE.BufferAttribute(rest, 3));
    geometry.setAttribute('value', changing(new Float32Array(count), 1));
    geometry.setAttribute('mark', changing(marks, 2));
    // Rays are tested against this ball first. The organ moves in every frame, so that no smaller one would stay right.
    geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), Infinity);
    geometry.setIndex(new THREE.BufferAttribute(drawn.triangles, 1));
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
    this.mesh.visible = true;
    this.drawn = drawn;
    this.epoch = surface.epoch;
    this.renewNormals();
  }

  /** Moves to the positions of a frame; one that belongs to another surface is passed over. */
  setFrame(body: FrameBody): void {
    const drawn = this.drawn;
    if (!drawn || body.epoch !== this.epoch) return;
    const position = this.attribute('position');
    gather(body.positions, drawn.source, position.array as Float32Array);
    position.needsUpdate = true;
    this.renewNormals();
    if (body.seared) {
      const mark = this.attribute('mark');
      for (let vertex = 0; vertex < drawn.source.length; vertex++)
        mark.array[2 * vertex] = body.seared[drawn.source[vertex]!] ?? 0;
      mark.needsUpdate = true;
    }
    if (this.shown && body.scalars) {
      const value = this.attribute('value');
      const { low, high } = this.shown;
      const scale = high > low ? 1 / (high - low) : 0;
      for (let vertex = 0; vertex < drawn.source.length; vertex++) {
        value.array[vertex] = Math.min(
          1,
          Math.max(0, ((body.scalars[drawn.source[vertex]!] ?? 0) - low) * scale),
        );
      }
      value.needsUpdate = true;
    }
  }

  showValues(shown: ShownValues | null): void {
    const map = shown?.map ?? null;
    if (map !== (this.shown?.map ?? null)) this.look.showValues(map);
    this.shown = shown;
  }

  setCoat(coat: boolean): void {
    this.look.material.dispose();
    this.look = tissueLook(this.size, coat, this.skin);
    this.look.showValues(this.shown?.map ?? null);
    this.mesh.material = this.look.material;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.look.material.dispose();
  }

  private renewNormals(): void {
    const normal = this.attribute('normal');
    smoothNormals(
      this.attribute('position').array as Float32Array,
      this.drawn?.triangles ?? new Uint32Array(),
      normal.array as Float32Array,
    );
    normal.needsUpdate = true;
  }

  private attribute(name: string): THREE.BufferAttribute {
    return this.mesh.geometry.getAttribute(name) as THREE.BufferAttribute;
  }
}

function gather(from: Float32Array, source: Uint32Array, into: Float32Array): void {
  for (let vertex = 0; vertex < source.length; vertex++) {
    const place = 3 * source[vertex]!;
    into[3 * vertex] = from[place] ?? 0;
    into[3 * vertex + 1] = from[place + 1] ?? 0;
    into[3 * vertex + 2] = from[place + 2] ?? 0;
  }
}
