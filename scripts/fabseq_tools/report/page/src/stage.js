// SPDX-License-Identifier: MIT
// One canvas behind all views, one camera for all of them. Draws when something has changed.

import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

const MARGIN = 1.18;  // room for the plate and for displacements

export class Stage {
  // `size`: the largest box that must fit; `plate`: the face it stands on; `flat`: seen straight from above.
  constructor(place, size, plate, flat, onCamera) {
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.autoClear = false;
    place.append(this.renderer.domElement);
    this.place = place;
    this.views = [];
    this.onCamera = onCamera;
    this.camera = new THREE.OrthographicCamera();
    this.target = new THREE.Vector3();
    this.middle = new THREE.Vector3();  // what home looks at
    this.flat = flat;
    this.controls = [];
    this.aim(size, plate);
    // The wheel scrolls the page until a view is touched.
    const zoom = (on) => this.controls.forEach((one) => { one.enableZoom = on; });
    place.addEventListener('pointerdown', () => zoom(true), true);
    place.addEventListener('pointerleave', () => zoom(false));
    new ResizeObserver(() => this.request()).observe(place);
  }

  // Directions of the view, and what it has to hold around the middle of the box.
  aim(size, plate) {
    const up = 'xyz'.indexOf(plate[0]);
    const upward = new THREE.Vector3().setComponent(up, plate[1] === '+' ? -1 : 1);
    const axes = [1, 2].map((step) => new THREE.Vector3().setComponent((up + step) % 3, 1));
    const from = this.flat ? new THREE.Vector3(0, 0, 1)
      : upward.clone().multiplyScalar(0.55).addScaledVector(axes[0], 0.62).addScaledVector(axes[1], -1);
    this.lamp = upward.clone().multiplyScalar(0.9).addScaledVector(axes[0], 0.15).addScaledVector(axes[1], -0.5).normalize();
    this.camera.up.copy(this.flat ? new THREE.Vector3(0, 1, 0) : upward);
    this.reach = 4 * Math.hypot(...size);
    this.home = from.normalize().multiplyScalar(this.reach);
    const right = new THREE.Vector3().crossVectors(this.camera.up, from).normalize();
    const high = new THREE.Vector3().crossVectors(from, right).normalize();
    const extent = (axis) => 0.5 * MARGIN * size.reduce((sum, length, k) => sum + length * Math.abs(axis.getComponent(k)), 0);
    this.half = { width: extent(right), height: extent(high) };
    this.camera.near = 0.01 * this.reach;
    this.camera.far = 3 * this.reach;
    this.goHome();
  }

  // Home is where the part's own elements just fit, and not all of its box.
  frame({ built, grid, spacing, size }) {
    this.camera.position.copy(this.home);
    this.camera.lookAt(0, 0, 0);
    const axes = [0, 1].map((column) => new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, column));
    const ends = axes.map(() => [Infinity, -Infinity]);
    const place = new THREE.Vector3();
    built.forEach((there, i) => {
      if (!there) return;
      const cell = [i % grid[2], Math.floor(i / grid[2]) % grid[1], Math.floor(i / (grid[2] * grid[1]))];
      place.set(...cell.map((at, k) => (at + 0.5) * spacing[k] - 0.5 * size[k]));
      ends.forEach((end, k) => {
        const along = place.dot(axes[k]);
        ends[k] = [Math.min(end[0], along), Math.max(end[1], along)];
      });
    });
    const edge = Math.hypot(...spacing);
    const half = ends.map(([low, high]) => 0.5 * MARGIN * (high - low + edge));
    this.half = { width: half[0], height: half[1] };
    ends.forEach(([low, high], k) => this.middle.addScaledVector(axes[k], 0.5 * (low + high)));
    this.goHome();
  }

  goHome() {
    this.target.copy(this.middle);
    this.camera.position.copy(this.home).add(this.middle);
    this.camera.zoom = 1;
    this.camera.lookAt(this.target);
    this.controls.forEach((one) => one.update());
    this.request();
  }

  // Turns to a box, `lower` to `upper` from the corner of the part's box, whose middle is `half` from there: it fills
  // that share of a view, if it does not have to be drawn `most` times larger than at home.
  focus({ lower, upper }, half, share, most) {
    const from = this.home.clone().normalize();
    this.target.set(...half.map((length, k) => 0.5 * ((lower[k] ?? 0) + (upper[k] ?? 0)) - length));
    this.camera.position.copy(from).setLength(this.reach).add(this.target);
    const extent = Math.hypot(...half.map((_, k) => (upper[k] ?? 0) - (lower[k] ?? 0)));
    this.camera.zoom = Math.min(Math.max((2 * share * this.half.height) / extent, 1), most);
    this.controls.forEach((one) => one.update());
    this.request();
  }

  // A view is an element that the pointer turns the camera in, and a scene. `afterwards`: is called with the camera
  // once it is drawn.
  add(surface, scene, afterwards = () => {}) {
    const controls = new OrbitControls(this.camera, surface);
    controls.target = this.target;
    controls.enableRotate = !this.flat;
    controls.enableZoom = false;
    controls.keyRotateSpeed = 6;
    if (this.flat) {
      controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
      controls.touches.ONE = THREE.TOUCH.PAN;
    }
    controls.listenToKeyEvents(surface);
    controls.addEventListener('change', () => this.request());
    controls.addEventListener('end', () => this.onCamera(this.cameraWords()));
    surface.addEventListener('keyup', () => this.onCamera(this.cameraWords()));
    this.controls.push(controls);
    this.views.push({ surface, scene, afterwards });
  }

  // The camera as numbers for the address, lengths relative to the box: direction, target, zoom.
  cameraWords() {
    const from = this.camera.position.clone().sub(this.target).normalize();
    const target = this.target.clone().divideScalar(this.reach);
    return [...from.toArray(), ...target.toArray(), this.camera.zoom].map((value) => Number(value.toFixed(4))).join(',');
  }

  setCamera(words) {
    const numbers = words.split(',').map(Number);
    if (numbers.length !== 7 || !numbers.every(Number.isFinite) || !(numbers[6] > 0)) return;
    this.target.fromArray(numbers, 3).multiplyScalar(this.reach);
    this.camera.position.fromArray(numbers).setLength(this.reach).add(this.target);
    this.camera.zoom = numbers[6];
    this.controls.forEach((one) => one.update());
    this.request();
  }

  request() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.render();
    });
  }

  render() {
    const all = this.place.getBoundingClientRect();
    if (!all.width) return;
    this.renderer.setSize(all.width, all.height, false);
    this.renderer.setScissorTest(false);
    this.renderer.setClearColor(0, 0);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    const eye = this.camera.position.clone().sub(this.target).normalize();
    for (const { surface, scene, afterwards } of this.views) {
      const box = surface.getBoundingClientRect();
      const frame = [box.left - all.left, all.bottom - box.bottom, box.width, box.height];
      this.renderer.setViewport(...frame);
      this.renderer.setScissor(...frame);
      this.fit(box.width / box.height);
      scene.traverse((mesh) => mesh.material?.uniforms?.eye?.value.copy(eye));
      this.renderer.render(scene, this.camera);
      afterwards(this.camera);
    }
  }

  fit(aspect) {
    const height = Math.max(this.half.height, this.half.width / aspect);
    Object.assign(this.camera, { left: -height * aspect, right: height * aspect, bottom: -height, top: height });
    this.camera.updateProjectionMatrix();
  }
}
