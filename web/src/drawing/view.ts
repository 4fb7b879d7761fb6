import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import type { Frame, Scene, Surface } from '../engine/messages';
import { Lighting, roomReflections } from './light';
import { firstLevel, QualityControl, type Quality } from './quality';
import { Stage } from './stage';

/** What lies under the pointer. */
export type Hit =
  | { kind: 'tissue'; body: number; point: THREE.Vector3; normal: THREE.Vector3 }
  | { kind: 'instrument' | 'trocar'; instrument: number; point: THREE.Vector3 };

/** What tools at the left and charts below cover of the canvas [CSS pixels]. */
const COVERED_LEFT = 60;
const COVERED_BELOW = 124;

/** What is tall fills this part of the height that is free. */
const MARGIN = 0.94;

/** The canvas with camera and lamps. Draws when something changed, and no oftener than the screen shows. */
export class View {
  readonly canvas: HTMLCanvasElement;
  readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 10);
  readonly controls: OrbitControls;
  readonly stage = new Stage();
  /** Pictures drawn since the page began, and in the last second; below one where a picture takes longer than that. */
  drawn = 0;
  drawnPerSecond = 0;

  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly lighting = new Lighting();
  private readonly quality: QualityControl;
  private reflections: THREE.Texture | undefined;
  private readonly caster = new THREE.Raycaster();
  private home: Scene | undefined;
  private shownScene = '';
  /** Another scene came, and no picture of it yet. */
  private isNew = false;
  private changed = true;
  private lastDrawn = 0;
  private drawnTimes: number[] = [];

  constructor(canvas: HTMLCanvasElement) {
    this.canvas = canvas;
    // Transparent: the calm ground behind the organ is the page's own, and follows its theme.
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    const wanted = new URLSearchParams(location.search).get('quality');
    this.quality = new QualityControl(firstLevel(wanted, graphicsOf(this.renderer)), wanted !== null);
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.scene.environmentIntensity = 0.75;
    this.scene.add(this.lighting.group, this.stage.group);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.invalidate());
    this.apply(this.quality.quality);
    new ResizeObserver(() => this.invalidate()).observe(canvas);
    requestAnimationFrame((now) => this.turn(now));
  }

  get qualityName(): Quality['name'] {
    return this.quality.quality.name;
  }

  invalidate(): void {
    this.changed = true;
  }

  /** Takes another scene; the camera goes home only when it is another one. */
  setScene(scene: Scene): void {
    this.home = scene;
    this.stage.setScene(scene, this.quality.quality.coat);
    const shown = JSON.stringify([scene.name, scene.title, scene.centre, scene.radius]);
    if (shown !== this.shownScene) {
      this.shownScene = shown;
      this.isNew = true;
      this.goHome();
    }
    this.invalidate();
  }

  setSurface(surface: Surface): void {
    const first = this.stage.isBare;
    this.stage.setSurface(surface);
    // Where the floor is depends on how far down the organ reaches, known with its first surface.
    if (first) this.frameLights();
    this.invalidate();
  }

  setFrame(frame: Frame): void {
    this.stage.setFrame(frame);
    // All surfaces came before the frame: now it is known what the ball around the scene is filled with.
    if (this.isNew) {
      this.isNew = false;
      this.goHome();
    }
    this.invalidate();
  }

  /** The view that shows the whole scene from where it is best seen. */
  goHome(): void {
    const home = this.home;
    if (!home) return;
    const centre = new THREE.Vector3(...home.centre);
    const look = new THREE.Vector3(...home.camera.look);
    if (look.lengthSq() === 0) look.set(-0.3, -0.4, -1);
    look.normalize();
    const radius = home.radius > 0 ? home.radius : 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    // So that a ball of that radius fits into what is left free; organs are flatter than balls, so that it may reach a little over.
    const free = (part: number) => Math.max(0.3, part / Math.max(1, height));
    const fit = Math.max(0.85 / free(height - COVERED_BELOW), 1 / free(width - 2 * COVERED_LEFT));
    const slope = Math.tan(THREE.MathUtils.degToRad(this.camera.fov) / 2);
    const up = new THREE.Vector3(...home.camera.up);
    const tall = this.stage.distanceToSee(centre, look, up, MARGIN * slope * free(height - COVERED_BELOW));
    const distance = Math.max((fit * radius) / slope, tall);
    this.camera.up.copy(up);
    this.camera.position.copy(centre).addScaledVector(look, -distance);
    this.camera.near = 0.02 * radius;
    this.camera.far = 60 * radius;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(centre);
    this.controls.minDistance = 0.3 * radius;
    this.controls.maxDistance = 15 * radius;
    this.controls.update();
    this.frameLights();
    this.invalidate();
  }

  private frameLights(): void {
    if (!this.home) return;
    const { radius } = this.home;
    const centre = new THREE.Vector3(...this.home.centre);
    this.lighting.frame(centre, radius > 0 ? radius : 1, this.stage.lowest(centre.y - 0.6 * radius));
  }

  setTheme(dark: boolean): void {
    this.lighting.setTheme(dark);
    this.stage.setTheme(dark);
    this.invalidate();
  }

  /** Turns the camera about its target, by angles in radians. */
  orbit(around: number, over: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const place = new THREE.Spherical().setFromVector3(offset);
    place.theta += around;
    place.phi = THREE.MathUtils.clamp(place.phi + over, 0.05, Math.PI - 0.05);
    this.camera.position.copy(this.controls.target).add(offset.setFromSpherical(place));
    this.controls.update();
  }

  zoom(factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = THREE.MathUtils.clamp(
      offset.length() * factor,
      this.controls.minDistance,
      this.controls.maxDistance,
    );
    this.camera.position.copy(this.controls.target).add(offset.setLength(length));
    this.controls.update();
  }

  /** What the ray through a point of the page meets first. */
  pick(clientX: number, clientY: number): Hit | undefined {
    this.aim(clientX, clientY);
    return this.stage.pick(this.caster);
  }

  /** Where the ray through a point of the page meets the plane through `anchor` that faces the camera. */
  onViewPlane(clientX: number, clientY: number, anchor: THREE.Vector3): THREE.Vector3 | undefined {
    this.aim(clientX, clientY);
    const facing = this.camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, anchor);
    return this.caster.ray.intersectPlane(plane, new THREE.Vector3()) ?? undefined;
  }

  /** Where a point of the scene appears on the page [CSS pixels]. */
  project(point: THREE.Vector3): { x: number; y: number } {
    const bounds = this.canvas.getBoundingClientRect();
    const shown = point.clone().project(this.camera);
    return {
      x: bounds.left + (0.5 + 0.5 * shown.x) * bounds.width,
      y: bounds.top + (0.5 - 0.5 * shown.y) * bounds.height,
    };
  }

  /** The picture as it is now, over the page's ground. */
  async picture(): Promise<Blob> {
    this.draw();
    const { width, height } = this.canvas;
    const sheet = new OffscreenCanvas(width, height);
    const context = sheet.getContext('2d');
    if (!context) throw new Error('This browser gives no canvas to draw the picture on.');
    const style = getComputedStyle(document.documentElement);
    const ground = context.createLinearGradient(0, 0, 0, height);
    ground.addColorStop(0, style.getPropertyValue('--ground-top').trim());
    ground.addColorStop(1, style.getPropertyValue('--ground-bottom').trim());
    context.fillStyle = ground;
    context.fillRect(0, 0, width, height);
    context.drawImage(this.canvas, 0, 0);
    return sheet.convertToBlob({ type: 'image/png' });
  }

  private aim(clientX: number, clientY: number): void {
    const bounds = this.canvas.getBoundingClientRect();
    const x = (2 * (clientX - bounds.left)) / bounds.width - 1;
    const y = 1 - (2 * (clientY - bounds.top)) / bounds.height;
    this.caster.setFromCamera(new THREE.Vector2(x, y), this.camera);
  }

  private apply(quality: Quality): void {
    if (quality.reflections) this.reflections ??= roomReflections(this.renderer);
    this.scene.environment = quality.reflections ? (this.reflections ?? null) : null;
    this.lighting.setShadow(quality.shadow);
    this.lighting.setPlain(!quality.reflections);
    this.stage.setCoat(quality.coat);
    this.invalidate();
  }

  private turn(now: number): void {
    requestAnimationFrame((next) => this.turn(next));
    this.controls.update();
    const latest = this.drawnTimes.at(-1) ?? now;
    this.drawnTimes = this.drawnTimes.filter((time) => now - time < 1000 || time === latest);
    this.drawnPerSecond = now - latest < 1000 ? this.drawnTimes.length : 1000 / (now - latest);
    if (!this.changed) {
      this.lastDrawn = 0;
      return;
    }
    if (now - latest < this.quality.quality.pause && this.drawn > 0) return;
    this.changed = false;
    this.draw();
    this.drawn += 1;
    this.drawnTimes.push(now);
    // Only pictures that follow each other tell how long one takes; after a rest there is nothing to compare with.
    if (this.lastDrawn > 0 && this.quality.observe(now - this.lastDrawn)) this.apply(this.quality.quality);
    this.lastDrawn = now;
  }

  private draw(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    const ratio = Math.min(window.devicePixelRatio, this.quality.quality.pixelRatio);
    const wanted = this.renderer.getSize(new THREE.Vector2());
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    if (wanted.x !== clientWidth || wanted.y !== clientHeight) {
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.camera.aspect = clientWidth / clientHeight;
      // The middle of the picture is the middle of what tools and charts leave free of it.
      this.camera.setViewOffset(
        clientWidth,
        clientHeight,
        -COVERED_LEFT / 2,
        COVERED_BELOW / 2,
        clientWidth,
        clientHeight,
      );
    }
    this.renderer.render(this.scene, this.camera);
  }
}

/** What draws the page, as the browser names it. */
function graphicsOf(renderer: THREE.WebGLRenderer): string {
  const context = renderer.getContext();
  const names = context.getExtension('WEBGL_debug_renderer_info');
  return names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : '';
}
