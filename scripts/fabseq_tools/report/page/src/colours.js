// SPDX-License-Identifier: MIT
// Colour maps as a few colours in equal steps (viridis, YlOrRd and RdYlBu of Matplotlib, and one for marks of 0
// and 1), those of kinds of faults, and the colours of curves in both schemes.

const MAPS = {
  layers: ['440154', '472d7b', '3b528b', '2c728e', '21918c', '28ae80', '5ec962', 'addc30', 'fde725'],
  heat: ['ffffcc', 'ffeda0', 'fed976', 'feb24c', 'fd8d3c', 'fc4e2a', 'e31a1c', 'bd0026', '800026'],
  marked: ['cfd4da', 'cfd4da', 'cfd4da', 'cfd4da', 'c2222d', 'c2222d', 'c2222d', 'c2222d'],
  diverging: ['313695', '74add1', 'e0f3f8', 'ffffbf', 'fee090', 'f46d43', 'a50026'],
};

const LAYERS = ['e4e7eb', 'c8cdd4'];  // of odd and even layers where nothing is wrong
const SHADE = 0.84;                   // of a fault in every other layer

const CURVES = {
  light: { start: '#7a4fa3', baseline: '#b0762b', optimized: '#1f6f8b', binary: '#22262b', simulated: '#1f6f8b',
    numbered: ['#1f6f8b', '#b0762b', '#7a4fa3', '#c2452d', '#3c7d3c', '#8a5a44', '#6b727b'] },
  dark: { start: '#bb97e0', baseline: '#e0a95a', optimized: '#5bb8d6', binary: '#e8eaed', simulated: '#5bb8d6',
    numbered: ['#5bb8d6', '#e0a95a', '#bb97e0', '#f07f68', '#7fc47f', '#c89a80', '#a0a8b2'] },
};

export function curveColour(role) {
  const colours = CURVES[document.documentElement.dataset.scheme];
  return typeof role === 'number' ? colours.numbered[role % colours.numbered.length] : colours[role];
}

// A value of the page's style sheet, such as --ink.
export function pageColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function bytesOf(hex) {
  return [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

// Two for each kind of fault, and two for none: faultsAndLayers() in model.js counts like that.
function faultColours(kinds) {
  const both = ({ colour }) => [1, SHADE].map((shade) => bytesOf(colour.slice(1)).map((value) => shade * value));
  return [...LAYERS.map(bytesOf), ...kinds.flatMap(both)];
}

// 256 colours, four bytes each. `kinds`: of the map `faults`, with a `colour` each.
export function colourTable(name, kinds) {
  const anchors = name === 'faults' ? faultColours(kinds) : MAPS[name].map(bytesOf);
  const bytes = new Uint8Array(4 * 256).fill(255);
  for (let i = 0; i < 256; i++) {
    const position = (i / 255) * (anchors.length - 1);
    const low = Math.min(Math.floor(position), anchors.length - 2);
    for (let k = 0; k < 3; k++) bytes[4 * i + k] = anchors[low][k] + (position - low) * (anchors[low + 1][k] - anchors[low][k]);
  }
  return bytes;
}

export function colourGradient(name) {
  return `linear-gradient(to right, ${MAPS[name].map((hex) => '#' + hex).join(', ')})`;
}
