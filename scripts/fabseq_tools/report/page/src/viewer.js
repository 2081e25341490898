// SPDX-License-Identifier: MIT
// The views of the part side by side, and the controls above them.

import { legendOf } from './answer.js';
import { colourGradient, colourTable } from './colours.js';
import { element } from './dom.js';
import { colourTexture } from './material.js';
import { Model } from './model.js';
import { number, plainBelow } from './numbers.js';
import { Stage } from './stage.js';

const DRAWN = 0.1;       // of the box's longest edge: how far the largest displacement is drawn at first
const SECONDS = 8;       // of a build that is played

// Returns a function that draws again.
export async function buildViewer(place, data, parts, address, remember) {
  const grid = element('div', { class: 'views' });
  const largest = [0, 1, 2].map((k) => Math.max(...parts.map((part) => part.size[k])));
  const stage = new Stage(grid, largest, parts[0].plate, parts.every((part) => part.flat), (words) => remember('camera', words));
  const views = [];
  for (const packed of data.scene.views) views.push(await buildView(grid, stage, parts[packed.part], packed));
  const viewer = new Viewer(data, views, stage, Math.max(...largest), address, remember);
  place.append(viewer.controls(), grid);
  if (address.has('camera')) stage.setCamera(address.get('camera'));
  viewer.show();
  return () => stage.request();
}

async function buildView(grid, stage, part, packed) {
  const model = new Model(part, packed, stage.lamp);
  await model.load();
  const surface = element('div', { class: 'surface', tabindex: 0, role: 'img',
    'aria-label': `${packed.label} in 3D; arrow keys move it, with shift they turn it` });
  const [low, colours, high] = [element('span'), element('span', { class: 'colours' }), element('span')];
  const kinds = element('div', { class: 'note' });
  const legend = element('div', { class: 'legend' }, low, colours, high);
  const state = element('div', { class: 'state' });
  grid.append(element('figure', {}, element('figcaption', {}, packed.label), surface, legend, kinds, state));
  stage.add(surface, model.scene);
  return { model, packed, legend, kinds, low, colours, high, state };
}

// Ranges of a view's fields, as built and, where it is stored, released.
function rangesOf({ packed }) {
  return [packed.ranges, packed.released?.ranges].filter(Boolean);
}

class Viewer {
  constructor(data, views, stage, longest, address, remember) {
    Object.assign(this, { data, views, stage, remember });
    this.fields = data.scene.fields;
    this.colours = Object.fromEntries(Object.values(this.fields).map(({ colours, kinds }) => [colours,
      colourTexture(colourTable(colours, kinds))]));
    const most = Math.max(...views.flatMap(rangesOf).map((ranges) => ranges.displacement[1]));
    this.usualMagnification = most > 0 ? plainBelow((DRAWN * longest) / most) : 1;
    const known = (key, usual) => (Number.isFinite(Number(address.get(key) ?? NaN)) ? Number(address.get(key)) : usual);
    this.time = Math.min(Math.max(known('time', 1), 0), 1);
    this.magnification = Math.max(known('magnification', this.usualMagnification), 0);
    this.field = address.get('field') in this.fields ? address.get('field') : Object.keys(this.fields)[0];
    this.same = address.get('scale') !== 'own';
    this.released = address.get('state') === 'released' && views.some(({ packed }) => packed.released);
  }

  controls() {
    const slider = (value, most, step, onInput) => element('input', { type: 'range', min: 0, max: most, step, value,
      input: (event) => onInput(Number(event.target.value)) });
    this.slider = slider(this.time, 1, 0.005, (time) => { this.stop(); this.set({ time }); });
    this.timeWords = element('output');
    this.button = element('button', { type: 'button', click: () => (this.playing ? this.stop() : this.play()) }, '▶ Play');
    const choice = element('select', { change: (event) => this.set({ field: event.target.value }) },
      ...Object.entries(this.fields).map(([name, { label }]) => element('option', { value: name }, label)));
    choice.value = this.field;
    this.states = this.stateChoice();
    const most = Math.max(4 * this.usualMagnification, this.magnification);
    this.magnifier = slider(this.magnification, most, this.usualMagnification / 20, (magnification) => this.set({ magnification }));
    this.magnifierWords = element('output');
    this.magnifierLabel = element('label', {}, 'drawn', this.magnifier, this.magnifierWords);
    const same = element('input', { type: 'checkbox', change: (event) => this.set({ same: event.target.checked }) });
    same.checked = this.same;
    return element('div', { class: 'bar' }, this.button,
      element('label', { class: 'time' }, 'built up to pseudo-time', this.slider, this.timeWords),
      element('label', {}, 'colour', choice), this.states, this.magnifierLabel, element('label', {}, same, 'one scale for all views'),
      element('button', { type: 'button', click: () => { this.stage.goHome(); this.remember('camera', null); } }, 'Reset view'));
  }

  // As built or released, for the fields that differ.
  stateChoice() {
    const choice = element('select', { change: (event) => this.set({ released: event.target.value === 'released' }) },
      element('option', { value: 'built' }, 'as built'), element('option', { value: 'released' }, 'released'));
    choice.value = this.released ? 'released' : 'built';
    return element('label', {}, 'part', choice);
  }

  set(values) {
    Object.assign(this, values);
    if (!this.playing) this.store();
    this.show();
  }

  store() {
    this.remember('time', this.time === 1 ? null : this.time);
    this.remember('field', this.field);
    this.remember('state', this.released ? 'released' : null);
    this.remember('magnification', this.magnification === this.usualMagnification ? null : Number(this.magnification.toPrecision(4)));
    this.remember('scale', this.same ? null : 'own');
  }

  show() {
    const field = this.fields[this.field];
    const moved = this.field === 'displacement';
    this.timeWords.textContent = this.time.toFixed(3);
    this.magnifierWords.textContent = `${number(this.magnification)} ×`;
    this.magnifierLabel.style.display = moved ? '' : 'none';
    this.states.style.display = this.views.some(({ packed }) => this.field in (packed.released?.ranges ?? {})) ? '' : 'none';
    for (const view of this.views) {
      const range = this.range(view);
      view.model.show(this.time, this.released, moved ? this.magnification : 0, this.field, range, this.colours[field.colours]);
      view.legend.style.display = field.kinds ? 'none' : '';
      view.kinds.replaceChildren(...legendOf(field.kinds ?? []));
      if (!field.kinds) {
        view.colours.style.background = colourGradient(field.colours);
        [view.low.textContent, view.high.textContent] = this.ends(range);
      }
      const { share, layer, layers } = view.model.progress(this.time);
      view.state.textContent = [`${layers ? `layer ${layer} of ${layers}, ` : ''}${Math.round(100 * share)} % built`,
        ...this.notes(view)].join('; ');
    }
    this.stage.request();
  }

  // What stands at both ends of a colour bar.
  ends([low, high]) {
    const { open, length, unit, words } = this.fields[this.field];
    if (words) return words;
    const ending = length ? this.data.unit : unit;
    return [`${open ? '≤ ' : ''}${number(low)}`, `${open ? '≥ ' : ''}${number(high)}${ending ? ` ${ending}` : ''}`];
  }

  // What is said of the field below a view.
  notes(view) {
    const { label } = this.fields[this.field];
    const { notes, released } = view.packed;
    if (!(this.field in view.packed.ranges)) return [`${label} is not stored here`];
    const told = notes[this.field] ? [notes[this.field]] : [];
    if (this.field === 'displacement') told.push(`displaced by ${number(this.shown(view).displacement[1])} ${this.data.unit} at most`);
    if (this.released && this.states.style.display === '' && !released) told.push('as built, as no release is stored here');
    return told;
  }

  // Ranges of the fields as they are shown.
  shown({ packed }) {
    return this.released && packed.released ? { ...packed.ranges, ...packed.released.ranges } : packed.ranges;
  }

  // Of all views together, as built and released, or of one; layers are counted by each view for itself.
  range(view) {
    const own = this.shown(view)[this.field] ?? [0, 1];
    if (!this.same || this.field === 'layer') return own;
    const all = this.views.flatMap(rangesOf).map((ranges) => ranges[this.field]).filter(Boolean);
    return [Math.min(...all.map((range) => range[0])), Math.max(...all.map((range) => range[1]))];
  }

  play() {
    const from = this.time < 1 ? this.time : 0;
    const start = performance.now();
    this.playing = true;
    this.button.textContent = '❚❚ Pause';
    const step = (now) => {
      if (!this.playing) return;
      const time = Math.min(from + Math.max(now - start, 0) / 1000 / SECONDS, 1);
      this.slider.value = time;
      this.set({ time });
      if (time < 1) requestAnimationFrame(step);
      else this.stop();
    };
    requestAnimationFrame(step);
  }

  stop() {
    if (!this.playing) return;
    this.playing = false;
    this.button.textContent = '▶ Play';
    this.set({ time: Number(this.time.toFixed(3)) });
  }
}
