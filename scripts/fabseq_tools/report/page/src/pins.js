// SPDX-License-Identifier: MIT
// Numbers at the places of a view, and the box of the one that is chosen.

import * as THREE from 'three';
import { element } from './dom.js';

const MOST = 9;        // numbers in a view: more would hide the part
const WIDER = 0.012;   // of the part's longest edge: how far a box reaches beyond its place

export class Pins {
  // `places`: with `centre`, `lower`, `upper` from the box's corner, `colour` and `words`.
  constructor(surface, scene, part, places) {
    this.surface = surface;
    this.half = part.size.map((length) => 0.5 * length);
    this.margin = WIDER * Math.max(...part.size);
    this.places = places;
    this.box = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(1, 1, 1)),
      new THREE.LineBasicMaterial({ color: 0x111111, depthTest: false, transparent: true }));
    this.box.renderOrder = 1;
    this.box.frustumCulled = false;
    this.box.visible = false;
    scene.add(this.box);
    this.pins = places.slice(0, MOST).map(({ colour, words }, number) => element('button', { type: 'button', class: 'pin',
      tabindex: -1, style: `--pin: ${colour}`, title: words }, String(number + 1)));
    surface.append(...[...this.pins].reverse());  // the largest place on top
    this.middles = places.map(({ centre }) => this.fromMiddle(centre));
  }

  // A point from the corner of the part's box, as the scene has it.
  fromMiddle(point) {
    return new THREE.Vector3(...this.half.map((length, k) => (point[k] ?? 0) - length));
  }

  connect(onChoose) {
    this.pins.forEach((pin, number) => {
      pin.addEventListener('pointerdown', (event) => event.stopPropagation());
      pin.addEventListener('click', () => onChoose(number));
    });
  }

  mark(number) {
    this.pins.forEach((pin, each) => pin.classList.toggle('chosen', each === number));
    this.box.visible = number !== null;
    if (number === null) return;
    const { lower, upper } = this.places[number];
    this.box.position.lerpVectors(this.fromMiddle(lower), this.fromMiddle(upper), 0.5);
    this.box.scale.set(...this.half.map((_, k) => (upper[k] ?? 0) - (lower[k] ?? 0) + 2 * this.margin));
  }

  // Where the camera sees them.
  draw(camera) {
    const { clientWidth: width, clientHeight: height } = this.surface;
    this.pins.forEach((pin, number) => {
      const { x, y } = this.middles[number].clone().project(camera);
      pin.style.visibility = Math.abs(x) < 1 && Math.abs(y) < 1 ? '' : 'hidden';
      pin.style.left = `${0.5 * (1 + x) * width}px`;
      pin.style.top = `${0.5 * (1 - y) * height}px`;
    });
  }
}
