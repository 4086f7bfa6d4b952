// SPDX-License-Identifier: Apache-2.0
// What pages of one run and of several have in common: elements, trajectories, plots over time.
// Everything is read from the JSON block beside it. Text goes through textContent only.
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const main = document.getElementById('main');
const redraws = [];  // what to call when colours change
const plots = [];
const palette = ['#3b82e6', '#e07b00', '#1a9850', '#d62020', '#8e44ad', '#00a0b0', '#b8860b',
  '#e0559b', '#6b7a8f', '#7cb518', '#a0522d', '#3f51b5', '#009688', '#c2185b', '#795548'];
/// What every plot over time knows of the frames: number by time, spans without pose, loops.
const timeline = {frameAt: new Map(), lost: [], loops: []};

function element(parent, tag, text, properties) {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  Object.assign(node, properties || {});
  parent.append(node);
  return node;
}
function section(title) {
  const node = element(main, 'section');
  element(node, 'h2', title);
  return node;
}
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
const fixed = (value, digits) => Number.isFinite(value) ? value.toFixed(digits) : '–';
/// A gap where a file of the run has something else: plots take nothing but numbers.
const numberOrNone = (value) => Number.isFinite(value) ? value : null;
const human = (name) => name.replaceAll('_', ' ');
/// The end of a path is what tells.
const fileName = (path) => path.split('/').slice(-2).join('/');
const mean = (values) => values.length ? values.reduce((a, b) => a + b, 0) / values.length : NaN;

function table(parent, header, rows, mark) {
  const node = element(element(parent, 'div', undefined, {className: 'scroll'}), 'table');
  const head = element(element(node, 'thead'), 'tr');
  for (const cell of header) element(head, 'th', cell);
  const body = element(node, 'tbody');
  rows.forEach((row, r) => {
    const line = element(body, 'tr');
    row.forEach((cell, c) => element(line, 'td', cell, {className: mark && mark(r, c) ? 'best' : ''}));
  });
}
function keyEntry(parent, name, css) {
  const entry = element(parent, 'span', undefined, {className: 'entry'});
  element(entry, 'span', undefined, {className: 'key'}).style.borderColor = css;
  entry.append(name);
}

// --- trajectory ---------------------------------------------------------------------------------
const axisNames = ['x', 'y', 'z'];
function spread(points, axis) {
  let low = Infinity, high = -Infinity;
  for (const p of points) { low = Math.min(low, p[axis]); high = Math.max(high, p[axis]); }
  return [low, high];
}
/// Which world axes a view shows: the vertical one is that along which the camera's feet point.
function viewsOf(down, points) {
  const c = [0, 1, 2].reduce((a, b) => Math.abs(down[b]) > Math.abs(down[a]) ? b : a);
  const up = down[c] < 0 ? 1 : -1;
  const [u, v] = up > 0 ? [(c + 1) % 3, (c + 2) % 3] : [(c + 2) % 3, (c + 1) % 3];
  const extent = (axis) => { const [low, high] = spread(points, axis); return high - low; };
  const side = extent(v) > extent(u) ? v : u;
  return [{name: 'From above', u, v, sign: 1}, {name: 'From the side', u: side, v: c, sign: up}];
}
function niceStep(range) {
  const raw = range / 5, power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].find((m) => m * power >= raw) * power;
}
let viewCount = 0;
let W = 640;  // of a view, in its own pixels
const margin = {left: 46, right: 12, top: 12, bottom: 34};
/// Tracks {name, css, times, xyz, errors: index of the pose -> metres, pairs: [truth, pose]} and
/// the truth [{stamp, xyz}] seen along one axis. Drag zooms, a double click shows all.
class TrajectoryView {
  constructor(parent, view, tracks, truth) {
    this.view = view; this.tracks = tracks; this.truth = truth;
    this.number = ++viewCount;  // a clip of the same name in another drawing would cut this one
    const figure = element(parent, 'figure');
    element(figure, 'h3', view.name + ' (' + axisNames[view.u] + ', ' + axisNames[view.v] + ')');
    this.svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    this.svg.setAttribute('role', 'img');
    this.svg.setAttribute('aria-label', 'Trajectory, ' + view.name.toLowerCase());
    figure.append(this.svg);
    this.caption = element(figure, 'figcaption', '\u00a0');
    this.paths = tracks.map((track) => track.xyz.map((p) => this.project(p)));
    this.real = truth.map((p) => this.project(p.xyz));
    this.reset();
    this.listen();
  }
  project(p) { return [p[this.view.u], this.view.sign * p[this.view.v]]; }
  reset() {
    const all = this.real.concat(...this.paths);
    const [u0, u1] = spread(all, 0), [v0, v1] = spread(all, 1);
    this.show(u0, u1, v0, v1);
  }
  /// Shows at least the given window, with one scale for both axes.
  show(u0, u1, v0, v1) {
    const inner = W - margin.left - margin.right;
    const size = Math.max(u1 - u0, v1 - v0, 0.01);
    const width = Math.max(u1 - u0, 0.6 * size) * 1.08;
    const height = Math.max(v1 - v0, 0.3 * width) * 1.08;
    this.u0 = (u0 + u1 - width) / 2;
    this.v1 = (v0 + v1 + height) / 2;
    this.scale = Math.min(inner / width, 620 / height);
    this.width = inner / this.scale;
    this.u0 -= (this.width - width) / 2;
    this.height = height;
    this.draw();
  }
  at([u, v]) { return [margin.left + (u - this.u0) * this.scale, margin.top + (this.v1 - v) * this.scale]; }
  add(parent, tag, attributes, text) {
    const node = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
    if (text !== undefined) node.textContent = text;
    parent.append(node);
    return node;
  }
  path(points, breaks) {
    return points.map((p, i) => {
      const [x, y] = this.at(p);
      return (i === 0 || breaks(i) ? 'M' : 'L') + x.toFixed(1) + ' ' + y.toFixed(1);
    }).join('');
  }
  draw() {
    const w = this.width * this.scale, h = this.height * this.scale;
    const H = h + margin.top + margin.bottom;
    this.svg.replaceChildren();
    this.svg.setAttribute('viewBox', '0 0 ' + W + ' ' + H.toFixed(0));
    this.drawGrid(w, h);
    const clip = 'clip-' + this.number;
    const box = {x: margin.left, y: margin.top, width: w, height: h};
    this.add(this.add(this.svg, 'clipPath', {id: clip}), 'rect', box);
    const group = this.add(this.svg, 'g', {'clip-path': 'url(#' + clip + ')'});
    this.tracks.forEach((track, k) => this.drawErrors(group, track, k));
    this.add(group, 'path', {class: 'truth', d: this.path(this.real,
      (i) => this.truth[i].stamp - this.truth[i - 1].stamp > 0.5)});
    this.tracks.forEach((track, k) => this.drawTrack(group, track, k));
    this.mark = this.add(group, 'circle', {r: 5, fill: 'none', stroke: 'var(--ink)', 'stroke-width': 2,
      visibility: 'hidden'});
    this.rubber = this.add(this.svg, 'rect', {fill: 'var(--estimate)', opacity: .15, visibility: 'hidden'});
  }
  drawErrors(group, track, k) {
    const d = track.pairs.map(([t, e]) => {
      const [x0, y0] = this.at(this.project(data.truth.xyz[t])), [x1, y1] = this.at(this.paths[k][e]);
      return 'M' + x0.toFixed(1) + ' ' + y0.toFixed(1) + 'L' + x1.toFixed(1) + ' ' + y1.toFixed(1);
    }).join('');
    this.add(group, 'path', {class: 'error', d});
  }
  drawTrack(group, track, k) {
    const path = this.add(group, 'path', {class: 'estimate', d: this.path(this.paths[k],
      (i) => track.times[i] - track.times[i - 1] > 0.5)});
    path.style.stroke = track.css;
    if (!this.paths[k].length) return;
    const [x, y] = this.at(this.paths[k][0]);
    this.add(group, 'circle', {cx: x, cy: y, r: 4}).style.fill = track.css;
    if (k === 0) this.add(group, 'text', {x: x + 7, y: y - 5}, 'start');
  }
  drawGrid(w, h) {
    const step = niceStep(this.width), digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const bottom = margin.top + h, {u, v, sign} = this.view;
    for (let i = Math.ceil(this.u0 / step); i * step <= this.u0 + this.width; ++i) {
      const x = this.at([i * step, 0])[0];
      this.add(this.svg, 'path', {class: 'grid', d: 'M' + x + ' ' + margin.top + 'V' + bottom});
      this.add(this.svg, 'text', {x, y: bottom + 14, 'text-anchor': 'middle'}, (i * step).toFixed(digits));
    }
    for (let i = Math.ceil((this.v1 - this.height) / step); i * step <= this.v1; ++i) {
      const y = this.at([0, i * step])[1];
      this.add(this.svg, 'path', {class: 'grid', d: 'M' + margin.left + ' ' + y + 'h' + w});
      const value = sign * i * step;
      this.add(this.svg, 'text', {x: margin.left - 5, y: y + 4, 'text-anchor': 'end'},
        (value || 0).toFixed(digits));
    }
    this.add(this.svg, 'text', {x: margin.left + w, y: bottom + 29, 'text-anchor': 'end'},
      axisNames[u] + ' [m]');
    this.add(this.svg, 'text', {x: 4, y: bottom + 29}, '↑ ' + (sign < 0 ? '−' : '') + axisNames[v] + ' [m]');
  }
  pointer(event) {
    const box = this.svg.getBoundingClientRect(), k = W / box.width;
    return [(event.clientX - box.left) * k, (event.clientY - box.top) * k];
  }
  world([x, y]) { return [this.u0 + (x - margin.left) / this.scale, this.v1 - (y - margin.top) / this.scale]; }
  listen() {
    let from = null;
    this.svg.addEventListener('pointerdown', (event) => {
      if (event.pointerType === 'mouse' && event.button === 0) {
        from = this.pointer(event);
        this.svg.setPointerCapture(event.pointerId);
      }
    });
    this.svg.addEventListener('pointermove', (event) => {
      const to = this.pointer(event);
      if (!from) return this.hover(to);
      const box = {x: Math.min(from[0], to[0]), y: Math.min(from[1], to[1]),
        width: Math.abs(from[0] - to[0]), height: Math.abs(from[1] - to[1]), visibility: 'visible'};
      for (const [name, value] of Object.entries(box)) this.rubber.setAttribute(name, value);
    });
    this.svg.addEventListener('pointerup', (event) => {
      if (!from) return;
      const a = this.world(from), b = this.world(this.pointer(event));
      const moved = Math.hypot(a[0] - b[0], a[1] - b[1]) * this.scale;
      from = null;
      this.rubber.setAttribute('visibility', 'hidden');
      if (moved > 8) {
        this.show(Math.min(a[0], b[0]), Math.max(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[1], b[1]));
      }
    });
    this.svg.addEventListener('dblclick', () => this.reset());
  }
  hover([x, y]) {
    let best = null, nearest = 30;
    this.paths.forEach((path, k) => path.forEach((p, i) => {
      const [px, py] = this.at(p), d = Math.hypot(px - x, py - y);
      if (d < nearest) { nearest = d; best = {k, i, px, py}; }
    }));
    this.mark.setAttribute('visibility', best ? 'visible' : 'hidden');
    if (!best) return;
    const track = this.tracks[best.k], error = track.errors.get(best.i);
    this.mark.setAttribute('cx', best.px);
    this.mark.setAttribute('cy', best.py);
    this.caption.textContent = (track.name ? track.name + ', ' : '') + 't = ' +
      fixed(track.times[best.i], 2) + ' s, at (' +
      track.xyz[best.i].map((c) => fixed(c, 3)).join(', ') + ') m' +
      (error === undefined ? '' : ', error ' + fixed(100 * error, 1) + ' cm');
  }
}
/// The truth between two times, with stamps relative to `start`.
function truthBetween(start, first, last) {
  return data.truth.stamp_s.map((s, i) => ({stamp: s - start, xyz: data.truth.xyz[i]}))
    .filter((p) => p.stamp > first - 0.1 && p.stamp < last + 0.1);
}
function drawViews(parent, down, tracks, truth) {
  const pair = element(parent, 'div', undefined, {className: 'pair'});
  W = Math.max(300, Math.min(W, pair.clientWidth));
  const points = tracks.flatMap((track) => track.xyz);
  for (const view of viewsOf(down, points)) new TrajectoryView(pair, view, tracks, truth);
}

// --- plots --------------------------------------------------------------------------------------
function underlay(canvas, area, graph) {
  canvas.fillStyle = colour('lost');
  for (const [first, last] of timeline.lost) {
    const x0 = graph.toDomXCoord(first), x1 = graph.toDomXCoord(last);
    canvas.fillRect(x0 - 1, area.y, x1 - x0 + 2, area.h);
  }
  canvas.strokeStyle = colour('ink');
  canvas.setLineDash([5, 4]);
  for (const time of timeline.loops) {
    const x = graph.toDomXCoord(time);
    canvas.beginPath(); canvas.moveTo(x, area.y); canvas.lineTo(x, area.y + area.h); canvas.stroke();
  }
  canvas.setLineDash([]);
}
function linkZoom(source, low, high) {
  const dateWindow = source.isZoomed('x') ? [low, high] : null;
  for (const other of plots) {
    if (other !== source && other.overTime) other.updateOptions({dateWindow});
  }
}
/// One finger scrolls the page, two zoom.
function interaction() {
  const model = Dygraph.defaultInteractionModel;
  const two = (name) => (event, graph, context) => {
    if (event.touches.length > 1) model[name](event, graph, context);
  };
  return {...model, touchstart: two('touchstart'), touchmove: two('touchmove')};
}
function themed() {
  return {axisLineColor: colour('line'), gridLineColor: colour('line')};
}
/// What the legend says, made of nodes: the library's own would take text of the run as markup.
function legendOf({x, xHTML, series}) {
  const legend = document.createDocumentFragment();
  if (x !== undefined) legend.append(xHTML + ':');
  for (const s of series) {
    if (!s.isVisible || (x !== undefined && !s.yHTML)) continue;
    const entry = element(legend, 'span');
    const name = element(entry, 'b');
    name.style.color = s.color;
    if (x === undefined) {
      element(name, 'span').innerHTML = s.dashHTML;  // of this page's colours and dashes alone
      name.append(' ' + s.label);
    } else {
      name.append(' ' + s.label);
      entry.append(':\u00a0' + s.yHTML);
    }
    legend.append(' ');
  }
  return legend;
}
function basicPlot(parent, title, unit, labels, rows, options) {
  const figure = element(parent, 'figure');
  element(figure, 'h3', title);
  const div = element(figure, 'div', undefined, {className: 'plot'});
  const legend = element(figure, 'div', undefined, {className: 'legend'});
  const graph = new Dygraph(div, rows, {
    labels, colors: palette, legend: 'always', labelsDiv: legend, legendFormatter: legendOf,
    strokeWidth: 1.4, includeZero: true, connectSeparatedPoints: true, axisLabelFontSize: 12, xLabelHeight: 16,
    ylabel: unit, yLabelWidth: 16, highlightCircleSize: 4,
    interactionModel: interaction(), ...themed(), ...options});
  plots.push(graph);
  redraws.push(() => graph.updateOptions(themed()));
  return graph;
}
/// Rows begin with seconds; zooming one such plot zooms all.
function plot(parent, title, unit, labels, rows, options) {
  const seconds = (t) => fixed(t, 2) + ' s' +
    (timeline.frameAt.has(t) ? ', frame ' + timeline.frameAt.get(t) : '');
  const graph = basicPlot(parent, title, unit, ['t', ...labels], rows, {
    xlabel: 'time [s]', underlayCallback: underlay,
    zoomCallback: (low, high) => linkZoom(graph, low, high),
    axes: {x: {valueFormatter: seconds}, y: {axisLabelWidth: 52}}, ...options});
  graph.overTime = true;
}
/// Series [{name, values}]: which share of the values is at most x.
function plotShares(parent, title, unit, series, options) {
  const kSteps = 200;
  const sorted = series.map((s) => s.values.filter(Number.isFinite).sort((a, b) => a - b));
  const top = Math.max(...sorted.map((v) => v[Math.min(v.length - 1, Math.floor(0.995 * v.length))] || 0));
  const rows = [];
  const reached = sorted.map(() => 0);
  for (let i = 0; i <= kSteps; ++i) {
    const x = top * i / kSteps;
    rows.push([x, ...sorted.map((v, k) => {
      while (reached[k] < v.length && v[reached[k]] <= x) ++reached[k];
      return v.length ? 100 * reached[k] / v.length : null;
    })]);
  }
  basicPlot(parent, title, '% of all', [unit, ...series.map((s) => s.name)], rows, {
    xlabel: unit, valueRange: [0, 101], axes: {
      x: {valueFormatter: (x) => 'at most ' + fixed(x, 2) + ' ' + unit},
      y: {axisLabelWidth: 40, valueFormatter: (y) => fixed(y, 1) + ' %'}}, ...options});
}

// --- colours follow the reader's, paper is white ------------------------------------------------
function finish() {
  const redraw = () => redraws.forEach((f) => f());
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  addEventListener('beforeprint', () => {
    document.documentElement.classList.add('printing');
    document.querySelectorAll('main details').forEach((d) => { d.open = true; });
    redraw();
  });
  addEventListener('afterprint', () => { document.documentElement.classList.remove('printing'); redraw(); });
  document.documentElement.dataset.drawn = plots.length;
}
