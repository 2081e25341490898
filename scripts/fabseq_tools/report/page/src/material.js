// SPDX-License-Identifier: MIT
// How faces are drawn: placed and coloured on the graphics card, from textures with a number for each element
// or node.

import * as THREE from 'three';

const VERTEX = `
precision highp float;
precision highp int;
precision highp sampler3D;
uniform mat4 projectionMatrix, modelViewMatrix;
uniform sampler3D values, displacements;
uniform vec3 spacing, centre, eye, lamp;
uniform float magnification;
uniform bool ghost, ofNodes;
in vec2 corner;
in vec4 face;
out vec2 within;
out float value;
out float shade;

void main() {
  bool ofBehind = face.w > 2.5;
  float axis = ofBehind ? face.w - 3.0 : face.w;
  ivec3 along = ivec3(axis == 0.0, axis == 1.0, axis == 2.0);
  ivec3 behind = ivec3(face.xyz);
  vec3 normal = vec3(along) * (ofBehind ? -1.0 : 1.0);
  if (ghost && dot(normal, eye) > 0.0) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  bool flat2d = spacing.z == 0.0;
  ivec3 node = behind + ivec3(corner.x) * along.zxy + ivec3(corner.y) * along.yzx;
  vec3 moved = texelFetch(displacements, flat2d ? ivec3(node.xy, 0) : node, 0).xyz;
  value = ofNodes ? length(moved) : texelFetch(values, ofBehind ? behind : behind - along, 0).r;
  shade = flat2d ? 1.0 : 0.78 + 0.23 * dot(normal, lamp);
  within = corner;
  vec3 place = vec3(node) * spacing - centre + magnification * moved;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(place, 1.0);
}`;

const FRAGMENT = `
precision highp float;
precision highp int;
uniform sampler2D colours;
uniform float low, high;
uniform bool ghost, banded, known;
in vec2 within;
in float value;
in float shade;
out vec4 colour;

void main() {
  if (ghost) {
    colour = vec4(0.5, 0.54, 0.58, 0.22);
    return;
  }
  float share = clamp((value - low) / (high - low), 0.0, 1.0);
  vec3 paint = !known || value > 1e29 ? vec3(0.6) : texture(colours, vec2((255.0 * share + 0.5) / 256.0, 0.5)).rgb;
  if (banded && mod(floor(value + 0.5), 2.0) == 0.0) paint *= 0.84;
  vec2 width = fwidth(within);
  vec2 distance = min(within, 1.0 - within) / width;
  float edge = 1.0 - smoothstep(0.4, 1.4, min(distance.x, distance.y));
  paint *= 1.0 - 0.2 * edge * smoothstep(4.0, 9.0, 1.0 / max(width.x, width.y));
  colour = vec4(paint * shade, 1.0);
}`;

// A number for each place of a grid [z][y][x], or with three components a vector.
export function gridTexture(values, [nz, ny, nx], components = 1) {
  let data = values;
  if (components > 1) {
    const count = nz * ny * nx;
    data = new Float32Array(4 * count);
    for (let k = 0; k < components; k++) for (let i = 0; i < count; i++) data[4 * i + k] = values[k * count + i];
  }
  const texture = new THREE.Data3DTexture(data, nx, ny, nz);
  texture.format = components > 1 ? THREE.RGBAFormat : THREE.RedFormat;
  texture.type = THREE.FloatType;
  texture.needsUpdate = true;
  return texture;
}

export function colourTexture(bytes) {
  const texture = new THREE.DataTexture(bytes, bytes.length / 4, 1);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

// `uniforms` are shared between the material and its ghost but for `ghost` and `magnification`.
export function faceMaterial(uniforms, ghost) {
  const own = ghost ? { ghost: { value: true }, magnification: { value: 0 } } : { ghost: { value: false } };
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { ...uniforms, ...own },
    side: THREE.DoubleSide, transparent: ghost, depthWrite: !ghost,
  });
}

// Room for so many faces; the attribute `face` has four numbers each.
export function faceGeometry(most) {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('corner', new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
  geometry.setAttribute('face', new THREE.InstancedBufferAttribute(new Uint16Array(4 * most), 4));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  return geometry;
}
