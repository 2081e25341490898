// SPDX-License-Identifier: MIT
// The page of a report: reads its data, draws curves and views, and keeps what is shown in the address, so
// that a link leads to the same view: report.html#time=0.5&field=displacement.

import { drawCharts } from './charts.js';
import { buildViewer } from './viewer.js';

const address = new URLSearchParams(location.hash.slice(1));

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

async function start() {
  const data = JSON.parse(document.getElementById('data').textContent);
  let redraw = () => {};
  chooseScheme(() => {
    drawCharts(document.getElementById('charts'), data.charts);
    redraw();
  });
  const place = document.getElementById('viewer');
  if (data.scene.views.length) {
    try {
      redraw = await buildViewer(place, data, address, remember);
    } catch (error) {
      place.textContent = `This browser cannot show the part in 3D: ${error.message}`;
    }
  }
  requestAnimationFrame(() => requestAnimationFrame(() => {
    document.documentElement.dataset.ready = Math.round(performance.now());
  }));
}

start();
