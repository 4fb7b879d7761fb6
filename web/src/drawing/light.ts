import * as THREE from 'three';

/** The lamps of the room: one key lamp that throws the shadow, a cool one from behind for the rim, and soft panels all around. */
export class Lighting {
  readonly group = new THREE.Group();
  private readonly key = new THREE.DirectionalLight(0xfff1e2, 2.2);
  private readonly rim = new THREE.DirectionalLight(0xcfe6ff, 1.5);
  /** In place of the room's reflections, where drawing them takes too long. */
  private readonly plain = new THREE.HemisphereLight(0xf2f6f6, 0x8f7d76, 1.5);
  private readonly floorMaterial = new THREE.ShadowMaterial({ opacity: 0.26 });
  private readonly floor = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), this.floorMaterial);

  constructor() {
    this.key.castShadow = true;
    this.key.shadow.mapSize.set(1024, 1024);
    this.key.shadow.radius = 5;
    this.floor.rotation.x = -Math.PI / 2;
    this.floor.receiveShadow = true;
    this.group.add(this.key, this.key.target, this.rim, this.rim.target, this.plain, this.floor);
  }

  /** Places lamps and floor around what is shown. `down`: lowest point [m]. */
  frame(centre: THREE.Vector3, radius: number, down: number): void {
    this.key.position.copy(centre).addScaledVector(new THREE.Vector3(0.5, 1.25, 0.75), 3 * radius);
    this.key.target.position.copy(centre);
    this.rim.position.copy(centre).addScaledVector(new THREE.Vector3(-0.8, 0.5, -1), 3 * radius);
    this.rim.target.position.copy(centre);
    const camera = this.key.shadow.camera;
    const reach = 1.7 * radius;
    Object.assign(camera, {
      left: -reach,
      right: reach,
      bottom: -reach,
      top: reach,
      near: radius,
      far: 9 * radius,
    });
    camera.updateProjectionMatrix();
    // In units of the scene, so that an organ in metres and one in millimetres are shaded alike.
    this.key.shadow.normalBias = 0.012 * radius;
    this.key.shadow.bias = -0.0006;
    this.floor.position.set(centre.x, down - 0.28 * radius, centre.z);
    this.floor.scale.setScalar(14 * radius);
  }

  setShadow(shown: boolean): void {
    this.key.castShadow = shown;
    this.floor.visible = shown;
  }

  setPlain(plain: boolean): void {
    this.plain.visible = plain;
  }

  setTheme(dark: boolean): void {
    this.floorMaterial.opacity = dark ? 0.5 : 0.24;
  }
}

/** What shines in wet tissue and steel: a pale room with three lamp panels. No file has to be loaded for it. */
export function roomReflections(renderer: THREE.WebGLRenderer): THREE.Texture {
  const room = new THREE.Scene();
  const box = new THREE.BoxGeometry(1, 1, 1);
  const panel = (colour: number, strength: number, place: THREE.Vector3Tuple, size: THREE.Vector3Tuple) => {
    const material = new THREE.MeshBasicMaterial({
      color: new THREE.Color(colour).multiplyScalar(strength),
      side: THREE.DoubleSide,
    });
    const mesh = new THREE.Mesh(box, material);
    mesh.position.set(...place);
    mesh.scale.set(...size);
    room.add(mesh);
  };
  panel(0xaab8b8, 0.42, [0, 0, 0], [20, 14, 20]);
  panel(0xb3a49b, 0.75, [0, -6.9, 0], [19.9, 0.1, 19.9]);
  panel(0xfff4e6, 16, [3, 6.6, 3], [4.2, 0.1, 2.6]);
  panel(0xffffff, 7, [-9.7, 2.5, 1], [0.1, 3, 6]);
  panel(0xdcecff, 6, [2, 2, -9.7], [8, 2.2, 0.1]);
  const generator = new THREE.PMREMGenerator(renderer);
  const reflections = generator.fromScene(room, 0.03, 0.1, 100, { size: 64 }).texture;
  generator.dispose();
  box.dispose();
  for (const child of room.children) ((child as THREE.Mesh).material as THREE.Material).dispose();
  return reflections;
}
