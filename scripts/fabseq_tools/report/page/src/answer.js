// SPDX-License-Identifier: MIT
// The two views that the page begins with: the best alternative and the optimized layers, coloured by what cannot
// be built, with numbered places. A place in the list, or its number in a view, turns both views to it.

import { colourTable } from './colours.js';
import { element } from './dom.js';
import { colourTexture } from './material.js';
import { Model } from './model.js';
import { Pins } from './pins.js';
import { Stage } from './stage.js';

const SEEN_WHILE_BUILT = ['hanging', 'local_thickness', 'blocked'];  // such a place may lie inside the part
const SHOWN = 0.3;  // of a view: how large a place is drawn
const MOST = 4;     // times: how far a click zooms in

// Returns a function that draws again.
export async function buildAnswer(place, data, parts) {
  const grid = element('div', { class: 'views' });
  const shown = data.answer.views;
  const part = parts[data.scene.views[shown[0].view].part];
  const stage = new Stage(grid, part.size, part.plate, part.flat, () => {});
  stage.frame(part);
  const colours = colourTexture(colourTable('faults', data.scene.fields.fault.kinds));
  const views = [];
  for (const told of shown) views.push(await buildView(grid, stage, part, data.scene.views[told.view], told));
  const answer = new Answer(data, stage, part, views, colours);
  place.prepend(grid, element('p', { class: 'note' }, ...legendOf(data.scene.fields.fault.kinds),
    element('button', { type: 'button', id: 'whole', click: () => answer.choose(null) }, 'Whole part')));
  answer.connect();
  answer.choose(null);
  return () => stage.request();
}

export function legendOf(kinds) {
  return kinds.map(({ label, colour }) => element('span', { class: 'kind' },
    element('i', { style: `background: ${colour}` }), label));
}

async function buildView(grid, stage, part, packed, told) {
  const model = new Model(part, packed, stage.lamp);
  await model.load();
  const surface = element('div', { class: 'surface', tabindex: 0, role: 'img',
    'aria-label': `${told.title} in 3D; arrow keys move it, with shift they turn it` });
  grid.append(element('figure', {}, element('figcaption', {}, told.title, ' ', element('span', { class: told.look }, told.verdict)),
    surface, element('div', { class: 'state' })));
  const pins = new Pins(surface, model.scene, part, told.places);
  stage.add(surface, model.scene, (camera) => pins.draw(camera));
  return { model, told, pins, state: grid.lastChild.lastChild };
}

class Answer {
  constructor(data, stage, part, views, colours) {
    Object.assign(this, { data, stage, part, views, colours, range: [0, 2 * data.scene.fields.fault.kinds.length + 1] });
    this.buttons = [...document.querySelectorAll('#places button')];
  }

  // Entries of the list and numbers in the views lead to their place.
  connect() {
    const toggle = (view, place) => this.choose(this.chosen?.view === view && this.chosen.place === place ? null : { view, place });
    for (const button of this.buttons) button.addEventListener('click', () => toggle(+button.dataset.view, +button.dataset.place));
    this.views.forEach((view, number) => view.pins.connect((place) => toggle(number, place)));
  }

  // Of both views, the one with the place is drawn as it is when the place begins.
  choose(chosen) {
    this.chosen = chosen;
    for (const button of this.buttons) {
      const active = chosen && +button.dataset.view === chosen.view && +button.dataset.place === chosen.place;
      button.setAttribute('aria-pressed', Boolean(active));
      if (active) button.scrollIntoView({ block: 'nearest' });
    }
    const place = chosen && this.views[chosen.view].told.places[chosen.place];
    this.views.forEach((view, number) => {
      const own = chosen?.view === number ? chosen.place : null;
      const layer = own !== null && SEEN_WHILE_BUILT.includes(place.kind) ? place.layer : null;
      view.model.show(1, false, 0, 'fault', this.range, this.colours, layer);
      view.pins.mark(own);
      view.state.textContent = layer ? `built up to layer ${layer}` : `${view.model.progress(1).layers} layers`;
    });
    document.getElementById('whole').disabled = !chosen;
    if (place) this.stage.focus(place, this.part.size.map((length) => 0.5 * length), SHOWN, MOST);
    else this.stage.goHome();
  }
}
