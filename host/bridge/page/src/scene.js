// The scene: camera, light, floor grid. It is drawn only when something changed.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

const VIEWS = { corner: [-0.75, -1.2, 0.85], top: [0, -0.001, 1], front: [1, 0, 0.12], side: [0, -1, 0.12] };
const KEY_STEP_PX = 40;

export class Scene {
  /** @param {HTMLElement} element that the canvas fills */
  constructor(element) {
    this.element = element;
    this.renderer = new THREE.WebGLRenderer({ antialias: true, powerPreference: 'low-power' });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.domElement.tabIndex = 0;
    this.renderer.domElement.setAttribute('role', 'application');
    this.renderer.domElement.setAttribute(
      'aria-label',
      'The map in three dimensions. Arrow keys turn, plus and minus zoom, Enter picks the voxel in the middle.',
    );
    element.append(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.02, 200);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.request());
    this.target = new THREE.Vector3(0.35, 0, 0.4);
    this.size_m = 1.6;
    this.#addLight();
    this.look('corner');
    new ResizeObserver(() => this.resize()).observe(element);
    this.isDue = false;
    this.drawn = { count: 0, last_ms: 0 };
    this.beforeDrawing = [];
    this.afterDrawing = [];
    this.resize();
  }

  get canvas() {
    return this.renderer.domElement;
  }

  #addLight() {
    this.scene.add(new THREE.HemisphereLight('#ffffff', '#7d8894', 1.7));
    const sun = new THREE.DirectionalLight('#ffffff', 1.6);
    sun.position.set(2, -3, 5);
    this.scene.add(sun);
  }

  /** @param {object} theme of colours.js */
  setTheme(theme) {
    this.scene.background = new THREE.Color(theme.background);
    if (this.grid) {
      this.scene.remove(this.grid);
      this.grid.geometry.dispose();
      this.grid.material.dispose();
    }
    this.grid = new THREE.GridHelper(6, 12, theme.grid, theme.gridMinor);
    this.grid.rotation.x = Math.PI / 2;
    this.grid.position.z = -0.05; // beneath the voxels of a floor at 0
    this.scene.add(this.grid);
    this.request();
  }

  /** What the view turns about: centre and radius, metres, map frame. */
  frame(centre, radius_m) {
    this.target.copy(centre);
    this.size_m = radius_m;
  }

  /** @param {'corner' | 'top' | 'front' | 'side'} name */
  look(name) {
    const narrow = this.camera.aspect < 1 ? 1.25 / Math.sqrt(this.camera.aspect) : 1;
    const away = new THREE.Vector3(...VIEWS[name]).normalize().multiplyScalar(this.size_m * 2.1 * narrow);
    this.controls.target.copy(this.target);
    this.camera.position.copy(this.target).add(away);
    this.controls.update();
    this.request();
  }

  /** By keyboard. @param {number} right px @param {number} up px */
  turn(right, up) {
    const spherical = new THREE.Spherical().setFromVector3(this.#awayYUp());
    spherical.theta += (right * KEY_STEP_PX) / 400;
    spherical.phi = Math.min(Math.PI - 0.05, Math.max(0.05, spherical.phi - (up * KEY_STEP_PX) / 400));
    const away = new THREE.Vector3().setFromSpherical(spherical);
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(away.x, -away.z, away.y));
    this.controls.update();
    this.request();
  }

  #awayYUp() {
    const away = this.camera.position.clone().sub(this.controls.target);
    return new THREE.Vector3(away.x, away.z, -away.y);
  }

  zoom(factor) {
    const away = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(away);
    this.controls.update();
    this.request();
  }

  resize() {
    const { clientWidth, clientHeight } = this.element;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.request();
  }

  /** Pixels that 1 m has at a distance of 1 m. */
  get pointScale() {
    return this.renderer.domElement.height / (2 * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  /**
   * The ray through a pixel of the canvas.
   * @returns {{origin: number[], direction: number[], far_m: number}} metres, map frame
   */
  rayThrough(x_px, y_px) {
    this.camera.updateMatrixWorld();
    const { clientWidth, clientHeight } = this.element;
    const near = new THREE.Vector3((x_px / clientWidth) * 2 - 1, 1 - (y_px / clientHeight) * 2, -1).unproject(
      this.camera,
    );
    const direction = near.clone().sub(this.camera.position).normalize();
    return { origin: this.camera.position.toArray(), direction: direction.toArray(), far_m: 60 };
  }

  /** The pixel of a point of the map frame. @returns {{x: number, y: number, isAhead: boolean}} */
  pixelOf(point) {
    this.camera.updateMatrixWorld();
    const at = new THREE.Vector3(...point).project(this.camera);
    const { clientWidth, clientHeight } = this.element;
    return { x: ((at.x + 1) / 2) * clientWidth, y: ((1 - at.y) / 2) * clientHeight, isAhead: at.z < 1 };
  }

  /** Draws in the next frame of the browser. */
  request() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    const begin = performance.now();
    this.isDue = false;
    for (const prepare of this.beforeDrawing) prepare();
    this.renderer.render(this.scene, this.camera);
    this.drawn.count += 1;
    this.drawn.last_ms = performance.now() - begin;
    for (const hear of this.afterDrawing) hear(this.drawn.last_ms);
  }
}
