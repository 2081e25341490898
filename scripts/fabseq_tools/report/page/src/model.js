// SPDX-License-Identifier: MIT
// The part as one view shows it: one mesh of the faces that are seen at a time.

import * as THREE from 'three';
import { chooseFaces, facesOf } from './faces.js';
import { faceGeometry, faceMaterial, gridTexture } from './material.js';
import { unpack } from './unpack.js';

const NEVER = 2;             // later than any time
const NO_VALUE = 1e30;       // drawn grey
const PLATE = 0.05;          // of the box's longest edge: how far the plate reaches beyond the box

// What all views of a part share: which elements there are, and their faces.
export async function readPart(packed) {
  const { values: built, shape } = await unpack(packed.built);
  const flat = shape.length === 2;
  const grid = flat ? [1, ...shape] : shape;
  const spacing = flat ? [...packed.spacing, 0] : packed.spacing;
  const counts = [grid[2], grid[1], grid[0]];
  return { built, grid, flat, spacing, plate: packed.plate, size: counts.map((n, k) => n * spacing[k]),
    faces: facesOf(built, grid, flat) };
}

export class Model {
  constructor(part, packed, lamp) {
    this.part = part;
    this.packed = packed;
    this.textures = {};
    const half = part.size.map((length) => 0.5 * length);
    this.uniforms = {
      values: { value: null }, displacements: { value: null }, colours: { value: null },
      spacing: { value: new THREE.Vector3(...part.spacing) },
      centre: { value: new THREE.Vector3(...half) }, eye: { value: new THREE.Vector3() }, lamp: { value: lamp },
      magnification: { value: 0 }, low: { value: 0 }, high: { value: 1 },
      ofNodes: { value: false }, banded: { value: false }, known: { value: true },
    };
    this.geometry = faceGeometry(part.faces.before.length);
    this.scene = new THREE.Scene();
    const [mesh, ghost] = [false, true].map((pale) => new THREE.Mesh(this.geometry, faceMaterial(this.uniforms, pale)));
    this.ghost = ghost;
    for (const each of [mesh, ghost]) {
      each.frustumCulled = false;
      this.scene.add(each);
    }
    this.scene.add(plateOf(part, half));
  }

  async load() {
    const { part, packed } = this;
    const time = await unpack(packed.time);
    time.values.forEach((_, i) => { if (!part.built[i]) time.values[i] = NEVER; });
    this.rememberProgress(time.values);
    this.times = time.values;
    this.textures.time = gridTexture(time.values, part.grid);
    Object.assign(this.textures, await this.shapeTextures(packed));
    this.released = packed.released && { ...this.textures, ...await this.shapeTextures(packed.released) };
    const layers = (await unpack(packed.fields.layer)).values;
    this.rememberLayers(layers, time.values);
    if (packed.fields.fault) await this.addFaults(packed.fields.fault, layers);
  }

  // The kind of fault, and whether the layer is an odd one: a number for each of the colours of `faults`.
  async addFaults(packed, layers) {
    const { values } = await unpack(packed);
    const texture = gridTexture(values.map((fault, i) => (this.part.built[i] ? 2 * fault + ((layers[i] + 1) % 2) : NO_VALUE)),
      this.part.grid);
    this.textures.fault = texture;
    if (this.released) this.released.fault = texture;
  }

  // What the part looks like as built or released.
  async shapeTextures({ displacement, fields }) {
    const { part } = this;
    const moved = await unpack(displacement);
    const nodes = part.flat ? [1, ...moved.shape.slice(1)] : moved.shape.slice(1);
    const textures = { displacement: gridTexture(moved.values, nodes, moved.shape[0]) };
    for (const [name, field] of Object.entries(fields)) textures[name] = gridTexture((await unpack(field, NO_VALUE)).values, part.grid);
    return textures;
  }

  // For the line below the view: when which share of the part is built, and when which layer begins.
  rememberProgress(times) {
    this.sortedTimes = times.filter((time) => time <= 1).sort();
  }

  rememberLayers(layers, times) {
    const begins = [];
    layers.forEach((layer, i) => { if (times[i] <= 1) begins[layer] = Math.min(begins[layer] ?? NEVER, times[i]); });
    this.layers = layers.map((layer, i) => (times[i] <= 1 ? layer : Infinity));
    this.layerBegins = begins.filter((begin) => begin !== undefined);
  }

  progress(now) {
    let low = 0, high = this.sortedTimes.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.sortedTimes[middle] <= now) low = middle + 1;
      else high = middle;
    }
    const layer = this.layerBegins?.filter((begin) => begin <= now).length;
    return { share: low / this.sortedTimes.length, layer, layers: this.layerBegins?.length };
  }

  // Up to a time, or to a layer where one is given.
  build(now, layer) {
    if (now === this.now && layer === this.layer) return;
    Object.assign(this, { now, layer });
    const { face } = this.geometry.attributes;
    this.geometry.instanceCount = chooseFaces(this.part.faces, layer ? this.layers : this.times, layer ?? now, face.array);
    face.clearUpdateRanges();
    face.addUpdateRange(0, 4 * this.geometry.instanceCount);
    face.needsUpdate = true;
  }

  show(now, released, magnification, name, [low, high], colours, layer = null) {
    const { uniforms } = this;
    const textures = (released && this.released) || this.textures;
    this.build(now, layer);
    uniforms.displacements.value = textures.displacement;
    uniforms.magnification.value = magnification;
    uniforms.ofNodes.value = name === 'displacement';
    uniforms.banded.value = name === 'layer';
    uniforms.known.value = name in textures;
    uniforms.values.value = uniforms.ofNodes.value ? textures.time : textures[name] ?? textures.time;
    uniforms.low.value = low;
    uniforms.high.value = high > low ? high : low + 1;
    uniforms.colours.value = colours;
    this.ghost.visible = magnification > 0;
  }
}

// A slab beyond the plate's face of the box, in a grey that suits both schemes.
function plateOf(part, half) {
  const axis = 'xyz'.indexOf(part.plate[0]), sign = part.plate[1] === '+' ? 1 : -1;
  const longest = Math.max(...part.size);
  const size = part.size.map((length, k) => (k === axis ? 0.6 * PLATE * longest : length && length + 2 * PLATE * longest));
  const shades = [0.62, 0.62, 0.66, 0.66, 0.72, 0.72];
  const slab = new THREE.Mesh(new THREE.BoxGeometry(...size.map((length) => length || 1e-6 * longest)),
    shades.map((shade) => new THREE.MeshBasicMaterial({ color: new THREE.Color().setRGB(shade, shade, shade + 0.02, THREE.SRGBColorSpace) })));
  slab.position.setComponent(axis, sign * (half[axis] + 0.5 * size[axis] + 2e-3 * longest));
  return slab;
}
