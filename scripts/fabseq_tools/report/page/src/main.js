// SPDX-License-Identifier: MIT
// The page of a report: reads its data, draws the two views of the answer, and what is folded once it is opened.
// What the views below show stands in the address, so that a link leads there: report.html#time=0.5&field=layer.

import { buildAnswer } from './answer.js';
import { drawCharts } from './charts.js';
import { readPart } from './model.js';
import { buildViewer } from './viewer.js';

const address = new URLSearchParams(location.hash.slice(1));
const OF_VIEWS = ['time', 'field', 'state', 'magnification', 'scale', 'camera'];

// Keeps a value in the address; nothing where it is the usual one.
function remember(key, value) {
  if (value === null) address.delete(key);
  else address.set(key, value);
  try {
    history.replaceState(null, '', '#' + address.toString().replaceAll('%2C', ','));
  } catch {
    // Some browsers allow no more than a few changes a second: the next one counts.
  }
}

// Light or dark: as the address says, else as the system does.
function chooseScheme(onChange) {
  const system = matchMedia('(prefers-color-scheme: dark)');
  const show = () => {
    document.documentElement.dataset.scheme = address.get('scheme') ?? (system.matches ? 'dark' : 'light');
    onChange();
  };
  const button = document.createElement('button');
  button.id = 'scheme';
  button.textContent = 'Light / dark';
  button.onclick = () => {
    remember('scheme', document.documentElement.dataset.scheme === 'dark' ? 'light' : 'dark');
    show();
  };
  document.querySelector('main').prepend(button);
  system.addEventListener('change', show);
  show();
}

// Calls a function once the section around a place is seen, at once where it is not folded.
async function onceOpen(place, build) {
  const folded = place.closest('details');
  if (!folded || folded.open) return build();
  return new Promise((resolve) => {
    folded.addEventListener('toggle', () => resolve(build()), { once: true });
  });
}

async function built(place, build) {
  try {
    return await build();
  } catch (error) {
    place.append(`This browser cannot show the part in 3D: ${error.message}`);
    return () => {};
  }
}

async function start() {
  const data = JSON.parse(document.getElementById('data').textContent);
  const [answer, viewer, charts] = ['pair', 'viewer', 'charts'].map((id) => document.getElementById(id));
  const redraw = {};
  chooseScheme(() => Object.values(redraw).forEach((draw) => draw()));
  const parts = data.scene.views.length ? await Promise.all(data.scene.parts.map(readPart)) : [];
  if (answer) redraw.answer = await built(answer, () => buildAnswer(answer, data, parts));
  const linked = OF_VIEWS.some((key) => address.has(key));
  if (linked) viewer.closest('details').open = true;
  const views = !parts.length ? null : onceOpen(viewer, async () => {
    redraw.viewer = await built(viewer, () => buildViewer(viewer, data, parts, address, remember));
  });
  if (viewer.closest('details').open) await views;
  if (linked) viewer.closest('details').scrollIntoView();
  onceOpen(charts, () => {
    redraw.charts = () => drawCharts(charts, data.charts);
    redraw.charts();
  });
  requestAnimationFrame(() => requestAnimationFrame(() => {
    document.documentElement.dataset.ready = Math.round(performance.now());
  }));
}

start();
