// SPDX-License-Identifier: MIT
// Curves with uPlot. fabseq_tools/report/charts.py says what a chart holds.

import uPlot from 'uplot';
import style from 'uplot/dist/uPlot.min.css';
import { curveColour, pageColour } from './colours.js';
import { element } from './dom.js';
import { number, plainAbove, plainBelow } from './numbers.js';

const HEIGHT = 240;
const LOGARITHMIC = 8;  // times the smallest value: where the largest is less, the axis is linear
let drawn = [];
let observer = null;

export function drawCharts(place, charts) {
  if (!observer) document.head.append(element('style', {}, style));
  observer?.disconnect();
  drawn.forEach((plot) => plot.destroy());
  place.replaceChildren();
  observer = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) target.plot.setSize({ width: Math.floor(contentRect.width), height: HEIGHT });
  });
  drawn = charts.map((chart) => {
    const box = element('div', { class: 'chart' }, element('h3', {}, chart.title), element('p', { class: 'note' }, chart.note ?? ''));
    place.append(box);
    box.plot = new uPlot(options(chart, box.clientWidth), [chart.x, ...chart.series.map((s) => s.y), ...flatLines(chart)], box);
    observer.observe(box);
    return box.plot;
  });
}

// A curve that is the same everywhere, such as the planar layers' distortion.
function flatLines(chart) {
  return (chart.lines ?? []).map((line) => chart.x.map(() => line.y));
}

function options(chart, width) {
  const axis = { stroke: pageColour('--soft'), grid: { stroke: pageColour('--line'), width: 1 }, ticks: { stroke: pageColour('--line') } };
  const curve = (series, more) => ({ label: series.label, stroke: curveColour(series.role), width: 2, ...more,
    value: (_, value) => (value == null ? '–' : number(value)) });
  return {
    width, height: HEIGHT,
    scales: { x: { time: false }, y: yScale(chart) },
    axes: [{ ...axis, label: chart.xLabel, labelSize: 20, size: 34, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] },
      { ...axis, size: 64, values: (_, ticks) => ticks.map((tick) => (tick == null ? '' : number(tick).replace(/\.?0*·/, '·'))) }],
    series: [{ label: chart.xLabel },
      ...chart.series.map((s) => curve(s, { points: points(chart, s), width: s.dots ? 0 : 2 })),
      ...(chart.lines ?? []).map((line) => curve(line, { dash: [6, 4], width: 1.5, points: { show: false } }))],
    hooks: { drawClear: [(plot) => shadeBand(plot, chart.band)], draw: [(plot) => markResult(plot, chart)] },
    cursor: { y: false },
  };
}

function points(chart, series) {
  return chart.dotted || series.dots ? { show: true, size: 6, fill: curveColour(series.role) } : { show: false };
}

// The range holds the band and the flat lines; logarithms only of what is positive.
function yScale(chart) {
  const all = [...chart.series.flatMap((s) => s.y), ...(chart.lines ?? []).map((line) => line.y), ...(chart.band ?? [])];
  const known = all.filter((value) => value != null);
  const [low, high] = [Math.min(...known), Math.max(...known)];
  if (chart.symmetric) return { distr: 4, asinh: 1 };
  if (chart.log && low > 0 && high > LOGARITHMIC * low) return { distr: 3, range: () => [plainBelow(low), plainAbove(high)] };
  const margin = 0.06 * (high - low || Math.abs(high) || 1);
  return { range: () => [low >= 0 ? Math.max(low - margin, 0) : low - margin, high + margin] };
}

// Greenish between the two values; null stands for the axis's end.
function shadeBand(plot, band) {
  if (!band) return;
  const { left, top, width, height } = plot.bbox;
  const [low, high] = band.map((value, side) => {
    const at = value == null ? [top + height, top][side] : plot.valToPos(value, 'y', true);
    return Math.min(Math.max(at, top), top + height);
  });
  plot.ctx.save();
  plot.ctx.fillStyle = 'rgba(60, 160, 110, 0.16)';
  plot.ctx.fillRect(left, high, width, low - high);
  plot.ctx.restore();
}

// A dot at the iteration that became the result.
function markResult(plot, chart) {
  const at = chart.mark == null ? -1 : chart.x.indexOf(chart.mark);
  if (at < 0 || chart.series[0].y[at] == null) return;
  plot.ctx.save();
  plot.ctx.fillStyle = curveColour(chart.series[0].role);
  plot.ctx.beginPath();
  plot.ctx.arc(plot.valToPos(chart.mark, 'x', true), plot.valToPos(chart.series[0].y[at], 'y', true), 5 * devicePixelRatio, 0, 7);
  plot.ctx.fill();
  plot.ctx.restore();
}
