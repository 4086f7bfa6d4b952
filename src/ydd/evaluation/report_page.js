// SPDX-License-Identifier: Apache-2.0
// Draws the report from the JSON block beside it. Text goes through textContent only.
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const summary = data.summary || {};
const frames = data.frames;
const timings = data.timings;
const main = document.getElementById('main');
const redraws = [];  // what to call when colours change
const plots = [];
const palette = ['#3b82e6', '#e07b00', '#1a9850', '#d62020', '#8e44ad', '#00a0b0', '#b8860b',
  '#e0559b', '#6b7a8f', '#7cb518', '#a0522d', '#3f51b5', '#009688', '#c2185b', '#795548'];

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
const human = (name) => name.replaceAll('_', ' ');
const plural = (n, word) => n + ' ' + word + (n === 1 ? '' : 's');
const mean = (values) => values.length ? values.reduce((a, b) => a + b, 0) / values.length : NaN;

// --- time: seconds since the first frame --------------------------------------------------------
const start = frames && frames.stamp_s.length ? frames.stamp_s[0]
  : data.trajectory.stamp_s.length ? data.trajectory.stamp_s[0] : 0;
const frameTimes = frames ? frames.stamp_s.map((s) => s - start) : [];
const timeOfFrame = new Map(frames ? frames.index.map((index, i) => [index, frameTimes[i]]) : []);
const poseTimes = data.trajectory.stamp_s.map((s) => s - start);

// --- summary ------------------------------------------------------------------------------------
function card(parent, name, value, bad) {
  const node = element(parent, 'div', undefined, {className: bad ? 'card bad' : 'card'});
  element(node, 'b', value);
  element(node, 'span', name);
}
function errorCards(cards) {
  if (!data.evaluation) return;
  const ate = data.evaluation.ate.absolute_translational_error;
  const rpe = data.evaluation.rpe;
  const per = '/' + rpe.delta + ' ' + rpe.unit;
  card(cards, 'ATE, RMSE (' + data.evaluation.ate.alignment + ')', fixed(ate.rmse, 4) + ' m');
  if (!rpe.translational_error) return;
  card(cards, 'RPE' + per + ', RMSE', fixed(rpe.translational_error.rmse, 4) + ' m');
  card(cards, 'RPE' + per + ', RMSE', fixed(rpe.rotational_error.rmse, 3) + '°');
}
function drawSummary() {
  document.getElementById('title').textContent = data.title;
  const cards = element(main, 'div', undefined, {className: 'cards'});
  if (!data.summary) return errorCards(cards);
  const lost = summary.lost_spans;
  const skipped = summary.frames_skipped.length;
  document.getElementById('subtitle').textContent = [
    'variant ' + summary.variant,
    summary.detector ? 'detector ' + summary.detector : 'no detector',
    summary.deterministic ? 'deterministic' : 'threaded',
    summary.realtime ? 'real time' : '',
    'seed ' + summary.seed].filter(Boolean).join(' · ');
  errorCards(cards);
  card(cards, 'frames tracked', summary.frames_tracked + ' of ' + summary.frames_processed,
    summary.frames_tracked < summary.frames_processed);
  if (skipped + summary.frames_dropped) {
    card(cards, 'frames not seen', skipped + ' skipped, ' + summary.frames_dropped + ' dropped', true);
  }
  card(cards, 'frames per second', fixed(summary.frames_per_second, 1));
  card(cards, 'lost', lost.length
    ? lost.slice(0, 4).map((s) => s.first === s.last ? s.first : s.first + '–' + s.last).join(', ') +
      (lost.length > 4 ? ', … (' + lost.length + ')' : '')
    : 'never', lost.length > 0);
  card(cards, 'loops closed', summary.loops.length
    ? summary.loops.length + ' (' + summary.loops.map((l) => l.matched_frame + '→' + l.frame).join(', ') + ')'
    : 'none');
  card(cards, 'keyframes kept', summary.keyframes_kept + ' of ' + summary.keyframes_inserted);
  card(cards, 'map points', summary.map_points);
  card(cards, 'peak memory', fixed(summary.peak_resident_mb, 0) + ' MB');
}

// --- trajectory ---------------------------------------------------------------------------------
const axisNames = ['x', 'y', 'z'];
function spread(points, axis) {
  let low = Infinity, high = -Infinity;
  for (const p of points) { low = Math.min(low, p[axis]); high = Math.max(high, p[axis]); }
  return [low, high];
}
/// Which world axes a view shows: the vertical one is that along which the camera's feet point.
function views() {
  const down = data.trajectory.mean_down;
  const c = [0, 1, 2].reduce((a, b) => Math.abs(down[b]) > Math.abs(down[a]) ? b : a);
  const up = down[c] < 0 ? 1 : -1;
  const [u, v] = up > 0 ? [(c + 1) % 3, (c + 2) % 3] : [(c + 2) % 3, (c + 1) % 3];
  const extent = (axis) => { const [low, high] = spread(data.trajectory.xyz, axis); return high - low; };
  const side = extent(v) > extent(u) ? v : u;
  return [{name: 'From above', u, v, sign: 1}, {name: 'From the side', u: side, v: c, sign: up}];
}
function niceStep(range) {
  const raw = range / 5, power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].find((m) => m * power >= raw) * power;
}
let W = 640;  // of a view, in its own pixels
const margin = {left: 46, right: 12, top: 12, bottom: 34};
class TrajectoryView {
  constructor(parent, view, truth) {
    this.view = view; this.truth = truth;
    const figure = element(parent, 'figure');
    element(figure, 'h3', view.name + ' (' + axisNames[view.u] + ', ' + axisNames[view.v] + ')');
    this.svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    this.svg.setAttribute('role', 'img');
    this.svg.setAttribute('aria-label', 'Trajectory, ' + view.name.toLowerCase());
    figure.append(this.svg);
    this.caption = element(figure, 'figcaption', '\u00a0');
    this.estimate = data.trajectory.xyz.map((p) => this.project(p));
    this.real = truth.map((p) => this.project(p.xyz));
    this.reset();
    this.listen();
  }
  project(p) { return [p[this.view.u], this.view.sign * p[this.view.v]]; }
  reset() {
    const all = this.estimate.concat(this.real);
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
    const clip = 'clip-' + axisNames[this.view.u] + axisNames[this.view.v];
    const box = {x: margin.left, y: margin.top, width: w, height: h};
    this.add(this.add(this.svg, 'clipPath', {id: clip}), 'rect', box);
    const group = this.add(this.svg, 'g', {'clip-path': 'url(#' + clip + ')'});
    const errors = data.pairs.map(([t, e]) => {
      const [x0, y0] = this.at(this.project(data.truth.xyz[t])), [x1, y1] = this.at(this.estimate[e]);
      return 'M' + x0.toFixed(1) + ' ' + y0.toFixed(1) + 'L' + x1.toFixed(1) + ' ' + y1.toFixed(1);
    }).join('');
    this.add(group, 'path', {class: 'error', d: errors});
    this.add(group, 'path', {class: 'truth', d: this.path(this.real,
      (i) => this.truth[i].stamp - this.truth[i - 1].stamp > 0.5)});
    this.add(group, 'path', {class: 'estimate', d: this.path(this.estimate,
      (i) => poseTimes[i] - poseTimes[i - 1] > 0.5)});
    if (this.estimate.length) {
      const [x, y] = this.at(this.estimate[0]);
      this.add(group, 'circle', {cx: x, cy: y, r: 4, fill: 'var(--estimate)'});
      this.add(group, 'text', {x: x + 7, y: y - 5}, 'start');
    }
    this.mark = this.add(group, 'circle', {r: 5, fill: 'none', stroke: 'var(--ink)', 'stroke-width': 2,
      visibility: 'hidden'});
    this.rubber = this.add(this.svg, 'rect', {fill: 'var(--estimate)', opacity: .15, visibility: 'hidden'});
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
    let best = -1, nearest = 30;
    this.estimate.forEach((p, i) => {
      const [px, py] = this.at(p), d = Math.hypot(px - x, py - y);
      if (d < nearest) { nearest = d; best = i; }
    });
    this.mark.setAttribute('visibility', best < 0 ? 'hidden' : 'visible');
    if (best < 0) return;
    const [px, py] = this.at(this.estimate[best]);
    this.mark.setAttribute('cx', px);
    this.mark.setAttribute('cy', py);
    const pair = pairOfPose.get(best);
    this.caption.textContent = 't = ' + fixed(poseTimes[best], 2) + ' s, at (' +
      data.trajectory.xyz[best].map((c) => fixed(c, 3)).join(', ') + ') m' +
      (pair === undefined ? '' : ', error ' + fixed(100 * data.ate_m[pair], 1) + ' cm');
  }
}
const pairOfPose = new Map(data.pairs.map(([, e], i) => [e, i]));
function drawTrajectory() {
  if (!data.trajectory.xyz.length) return;
  const node = section('Trajectory');
  const key = element(node, 'p', undefined, {className: 'dim'});
  const entry = (name, variable) => {
    const line = element(key, 'span', undefined, {className: 'key'});
    line.style.borderColor = 'var(--' + variable + ')';
    key.append(name);
  };
  if (data.truth.xyz.length) entry('ground truth', 'truth');
  entry(data.truth.xyz.length ? 'estimate, aligned' : 'estimate', 'estimate');
  if (data.pairs.length) entry('error', 'error');
  const end = frames && frameTimes.length ? frameTimes[frameTimes.length - 1] : poseTimes[poseTimes.length - 1];
  const truth = data.truth.stamp_s.map((s, i) => ({stamp: s - start, xyz: data.truth.xyz[i]}))
    .filter((p) => p.stamp > -0.1 && p.stamp < end + 0.1);
  const pair = element(node, 'div', undefined, {className: 'pair'});
  W = Math.max(300, Math.min(W, pair.clientWidth));
  for (const view of views()) new TrajectoryView(pair, view, truth);
}

// --- plots over time ----------------------------------------------------------------------------
function underlay(canvas, area, graph) {
  canvas.fillStyle = colour('lost');
  for (const span of summary.lost_spans || []) {
    const x0 = graph.toDomXCoord(timeOfFrame.get(span.first)), x1 = graph.toDomXCoord(timeOfFrame.get(span.last));
    canvas.fillRect(x0 - 1, area.y, x1 - x0 + 2, area.h);
  }
  canvas.strokeStyle = colour('ink');
  canvas.setLineDash([5, 4]);
  for (const loop of summary.loops || []) {
    const x = graph.toDomXCoord(timeOfFrame.get(loop.frame));
    canvas.beginPath(); canvas.moveTo(x, area.y); canvas.lineTo(x, area.y + area.h); canvas.stroke();
  }
  canvas.setLineDash([]);
}
function linkZoom(source, low, high) {
  const dateWindow = source.isZoomed('x') ? [low, high] : null;
  for (const other of plots) {
    if (other !== source) other.updateOptions({dateWindow});
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
function plot(parent, title, unit, labels, rows, options) {
  const figure = element(parent, 'figure');
  element(figure, 'h3', title);
  const div = element(figure, 'div', undefined, {className: 'plot'});
  const legend = element(figure, 'div', undefined, {className: 'legend'});
  const seconds = (t) => fixed(t, 2) + ' s';
  const frameAt = new Map(frameTimes.map((t, i) => [t, frames.index[i]]));
  const graph = new Dygraph(div, rows, {
    labels: ['t', ...labels], colors: palette, legend: 'always', labelsDiv: legend, strokeWidth: 1.4,
    includeZero: true, connectSeparatedPoints: true, axisLabelFontSize: 12, xLabelHeight: 16,
    xlabel: 'time [s]', ylabel: unit, yLabelWidth: 16, highlightCircleSize: 4,
    interactionModel: interaction(), underlayCallback: underlay,
    zoomCallback: (low, high) => linkZoom(graph, low, high),
    axes: {x: {valueFormatter: (t) => seconds(t) +
      (frameAt.has(t) ? ', frame ' + frameAt.get(t) : '')}, y: {axisLabelWidth: 52}},
    ...themed(), ...options});
  plots.push(graph);
  redraws.push(() => graph.updateOptions(themed()));
}
function drawErrors() {
  if (!data.ate_m.length) return;
  const node = section('Error over time');
  const per = data.evaluation.rpe.delta + ' ' + data.evaluation.rpe.unit;
  plot(node, 'ATE: distance to ground truth after alignment', 'cm', ['ATE'],
    data.pairs.map(([, e], i) => [poseTimes[e], 100 * data.ate_m[i]]), {colors: [colour('error')]});
  if (data.rpe.first.length) {
    plot(node, 'RPE: drift over ' + per, '', ['translation [cm]', 'rotation [°]'],
      data.rpe.first.map((e, i) => [poseTimes[e], 100 * data.rpe.translation_m[i], data.rpe.rotation_deg[i]]));
  }
  drawErrorTable(node);
}
function table(parent, header, rows) {
  const node = element(element(parent, 'div', undefined, {className: 'scroll'}), 'table');
  const head = element(element(node, 'thead'), 'tr');
  for (const cell of header) element(head, 'th', cell);
  const body = element(node, 'tbody');
  for (const row of rows) {
    const line = element(body, 'tr');
    for (const cell of row) element(line, 'td', cell);
  }
}
function drawErrorTable(node) {
  const {ate, rpe} = data.evaluation;
  const per = 'RPE/' + rpe.delta + ' ' + rpe.unit;
  const rows = [['ATE [m]', ate.absolute_translational_error, ate.pairs],
    [per + ' [m]', rpe.translational_error, rpe.pairs], [per + ' [°]', rpe.rotational_error, rpe.pairs]];
  table(node, ['', 'RMSE', 'mean', 'median', 'S.D.', 'min', 'max', 'pairs'],
    rows.filter(([, s]) => s).map(([name, s, pairs]) =>
      [name, ...['rmse', 'mean', 'median', 'std', 'min', 'max'].map((k) => fixed(s[k], 6)), pairs]));
}
function columns(...series) { return frameTimes.map((t, i) => [t, ...series.map((s) => s[i])]); }
function drawFeatures() {
  const node = section('Feature points');
  const kept = mean(frames.kept), requested = mean(frames.requested);
  plot(node, 'Requested and kept per frame (means ' + fixed(requested, 0) + ' and ' + fixed(kept, 0) + ')',
    'points', ['requested', 'kept', 'mean kept', 'matched to the map'],
    columns(frames.requested, frames.kept, frames.kept.map(() => kept), frames.inliers),
    {colors: ['#e07b00', '#3b82e6', '#6b7a8f', '#1a9850'],
      series: {'mean kept': {strokePattern: [6, 4], strokeWidth: 1}}});
  const rules = Object.keys(frames.rejected).filter((rule) => frames.rejected[rule].some((n) => n > 0));
  if (!rules.length) {
    element(node, 'p', 'No point was rejected.');
  } else {
    plot(node, 'Rejected per rule, stacked', 'points', rules.map(human),
      columns(...rules.map((rule) => frames.rejected[rule])), {stackedGraph: true, strokeWidth: .8});
  }
}
function drawTimes() {
  const node = section('Time per frame');
  const cpu = frames.stages_cpu_ms;
  const stages = Object.keys(cpu).filter((s) => s !== 'total')
    .filter((s) => cpu[s].some((t) => t > 0.02)).sort((a, b) => mean(cpu[b]) - mean(cpu[a]));
  if (cpu.total) {
    plot(node, 'Tracking per frame', 'ms', ['processor time', 'wall time'],
      columns(cpu.total, frames.total_wall_ms));
  }
  plot(node, 'Processor time per stage, stacked', 'ms', stages.map(human),
    columns(...stages.map((s) => cpu[s].map((t) => t === null ? 0 : t))), {stackedGraph: true, strokeWidth: .8});
}
function drawTimeTable() {
  if (!timings) return;
  const node = section('Distribution of times [ms]');
  const header = ['', 'median', 'p95', 'p99', 'max', 'cpu median', 'cpu p95', 'cpu p99', 'count'];
  for (const [name, key] of [['Frames', 'per_frame'], ['Keyframes, beside tracking', 'per_keyframe']]) {
    const rows = Object.entries(timings[key] || {}).sort(([, a], [, b]) => b.wall_ms.median - a.wall_ms.median);
    if (!rows.length) continue;
    element(node, 'h3', name);
    table(node, header, rows.map(([stage, {wall_ms: w, cpu_ms: c}]) => [human(stage),
      ...[w.median, w.p95, w.p99, w.max, c.median, c.p95, c.p99].map((t) => fixed(t, 2)), w.count]));
  }
}
function drawMap() {
  const node = section('Map');
  const pair = element(node, 'div', undefined, {className: 'pair'});
  plot(pair, 'Keyframes', 'keyframes', ['keyframes'], columns(frames.keyframes), {stepPlot: true});
  plot(pair, 'Points', 'points', ['points'], columns(frames.points), {stepPlot: true, colors: ['#1a9850']});
}
function drawMoments() {
  if (!data.moments.length) return;
  const node = element(section('Key moments'), 'div', undefined, {className: 'moments'});
  for (const moment of data.moments) {
    const figure = element(node, 'figure');
    element(figure, 'img', undefined, {src: moment.image, alt: moment.caption});
    element(figure, 'figcaption', moment.caption);
  }
}
function drawConfiguration() {
  document.getElementById('version').textContent = 'ydd-slam ' + data.version;
  if (!data.config) return;
  const node = element(section('Configuration'), 'details');
  element(node, 'summary', 'Every setting of this run');
  element(node, 'pre', data.config);
}

drawSummary();
drawTrajectory();
drawMoments();
drawErrors();
if (frameTimes.length) {
  drawFeatures();
  drawTimes();
}
drawTimeTable();
if (frameTimes.length) drawMap();
drawConfiguration();

// --- colours follow the reader's, paper is white ------------------------------------------------
const redraw = () => redraws.forEach((f) => f());
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
addEventListener('beforeprint', () => {
  document.documentElement.classList.add('printing');
  document.querySelectorAll('main details').forEach((d) => { d.open = true; });
  redraw();
});
addEventListener('afterprint', () => { document.documentElement.classList.remove('printing'); redraw(); });
document.documentElement.dataset.drawn = plots.length;
