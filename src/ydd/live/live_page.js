// SPDX-License-Identifier: Apache-2.0
// Asks the server for what is new, never for more than one thing of a kind at a time: a slow line
// sees fewer frames. Text goes through textContent only.
'use strict';
const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get('token') || '';
const headers = {'X-Ydd-Slam': '1', ...(token ? {'X-Ydd-Token': token} : {})};
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
const fixed = (value, digits) => Number.isFinite(value) ? value.toFixed(digits) : '–';
const human = (name) => name.replaceAll('_', ' ');
let state = null, map = null;

async function ask(path) {
  const answer = await fetch(path, {headers, cache: 'no-store'});
  if (answer.status === 503) return null;  // no frame yet
  if (!answer.ok) throw new Error(await answer.text());
  return answer;
}
/// Calls `work` again and again, `pause_ms` after it has finished; not while nobody looks.
function repeat(pause_ms, work) {
  const again = async () => {
    if (!document.hidden) {
      try {
        await work();
      } catch (error) {
        if (!(state && state.finished)) document.body.classList.add('gone');
      }
    }
    if (!(state && state.finished)) setTimeout(again, pause_ms);
  };
  again();
}

// --- state ---------------------------------------------------------------------------------------
function card(name, value) {
  let node = $('card-' + name.replaceAll(' ', '-'));
  if (!node) {
    const box = document.createElement('div');
    box.className = 'card';
    node = document.createElement('b');
    node.id = 'card-' + name.replaceAll(' ', '-');
    const label = document.createElement('span');
    label.textContent = name;
    box.append(node, label);
    $('cards').append(box);
  }
  node.textContent = value;
}
function showRules() {
  $('rules').replaceChildren(...Object.entries(state.rejected).map(([rule, {count, colour: css}]) => {
    const node = document.createElement('span'), dot = document.createElement('i');
    dot.style.background = css;
    node.append(dot, human(rule) + ' ' + count);
    return node;
  }));
}
const rejectedCount = () => Object.values(state.rejected).reduce((sum, r) => sum + r.count, 0);
function showState() {
  document.title = state.sequence + ' – ydd-slam live';
  $('title').textContent = state.sequence;
  $('state').textContent = state.finished ? 'finished' : state.paused ? state.state + ', paused' : state.state;
  $('state').className = state.state;
  $('message').textContent = state.finished ? 'The run has ended; its results are in its folder.' : state.message;
  $('pause').textContent = state.paused ? 'Resume' : 'Pause';
  $('localize').checked = state.localization_only;
  for (const id of ['pause', 'step', 'reset', 'localize', 'keep-map', 'quit']) $(id).disabled = state.finished;
  $('variant').disabled = state.finished;
  for (const option of $('variant').options) {
    option.disabled = !state.has_detector && !['off', 'evidence'].includes(option.value);
  }
  if (document.activeElement !== $('variant')) $('variant').value = state.variant;
  const rejected = rejectedCount(), all = rejected + state.kept;
  card('frame', state.frames ? state.frame + 1 + ' / ' + state.frames : state.frame + 1);
  card('fps', state.paused ? '–' : fixed(state.fps, 1));
  card('keyframes', state.keyframes);
  card('map points', state.points);
  card('points kept', state.kept + ' / ' + all);
  card('rejected', all ? fixed(100 * rejected / all, 0) + ' %' : '–');
  card('matched to map', state.inliers);
  card('boxes', state.boxes);
  card('tracking ms', fixed(state.stages_ms.total, 1));
  card('maps', state.maps);
  showRules();
  showPlots();
}

// --- plots ---------------------------------------------------------------------------------------
const plots = {};
function showPlot(name, labels, rows, options) {
  if (rows.length < 2) return;
  const themed = {axisLineColor: colour('line'), gridLineColor: colour('line')};
  if (plots[name]) return plots[name].updateOptions({file: rows, ...themed});
  plots[name] = new Dygraph($('plot-' + name), rows, {
    labels: ['frame', ...labels], labelsDiv: $('legend-' + name), legend: 'always', includeZero: true,
    strokeWidth: 1.4, axisLabelFontSize: 12, highlightCircleSize: 4, ...themed, ...options});
}
function showPlots() {
  const {frame, ms, kept, rejected} = state.recent;
  showPlot('ms', ['total'], frame.map((f, i) => [f, ms[i]]), {colors: ['#3b82e6']});
  showPlot('points', ['kept', 'rejected'], frame.map((f, i) => [f, kept[i], rejected[i]]),
    {colors: ['#1a9850', '#d62020'], stackedGraph: true, strokeWidth: .8});
}

// --- picture -------------------------------------------------------------------------------------
async function showPicture() {
  if (!state || showPicture.serial === state.serial) return;
  const serial = state.serial, answer = await ask('frame.jpg');
  if (!answer) return;
  const url = URL.createObjectURL(await answer.blob()), old = $('picture').src;
  $('picture').src = url;
  showPicture.serial = serial;
  if (old.startsWith('blob:')) URL.revokeObjectURL(old);
}

// --- map from above: drag moves, wheel or two fingers zoom ------------------------------------------
const view = {x: 0, y: 0, metres: 4, follows: true};  // centre and height
function fitView() {
  if (!map || !map.path.length) return;
  const xs = [], ys = [];
  const take = (list, cut) => {
    const x = [], y = [];
    for (let i = 0; i + 1 < list.length; i += 2) if (list[i] !== null) { x.push(list[i]); y.push(list[i + 1]); }
    x.sort((a, b) => a - b);
    y.sort((a, b) => a - b);
    const low = Math.floor(cut * x.length), high = x.length - 1 - low;
    if (x.length) { xs.push(x[low], x[high]); ys.push(y[low], y[high]); }
  };
  take(map.path, 0);
  take(map.points, .02);  // a few points far off must not make the rest small
  const canvas = $('map'), ratio = canvas.clientWidth / canvas.clientHeight || 4 / 3;
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  view.x = (x0 + x1) / 2;
  view.y = (y0 + y1) / 2;
  view.metres = 1.15 * Math.max(y1 - y0, (x1 - x0) / ratio, 1);
}
function drawLines(g, at, list, css, width) {
  g.strokeStyle = css;
  g.lineWidth = width;
  g.beginPath();
  for (let i = 0, pen = false; i + 1 < list.length; i += 2) {
    if (list[i] === null) { pen = false; continue; }
    const [x, y] = at(list[i], list[i + 1]);
    pen ? g.lineTo(x, y) : g.moveTo(x, y);
    pen = true;
  }
  g.stroke();
}
function drawCamera(g, at) {
  if (!map.camera) return;
  const [x, y] = at(map.camera[0], map.camera[1]), angle = -map.camera[2];
  g.fillStyle = colour(map.lost ? 'error' : 'camera');
  g.beginPath();
  g.moveTo(x, y);
  g.arc(x, y, 16, angle - .5, angle + .5);
  g.fill();
}
/// People and moving things: a disc of half a metre, and where each will be in a second.
function drawTracks(g, at, k) {
  g.font = '12px system-ui, sans-serif';
  for (const [x, y, vx, vy, id, name] of map.tracks) {
    const [cx, cy] = at(x, y), [ex, ey] = at(x + vx, y + vy);
    g.strokeStyle = g.fillStyle = colour('track');
    g.lineWidth = 2;
    g.beginPath();
    g.arc(cx, cy, Math.max(3, .25 * k), 0, 2 * Math.PI);
    g.moveTo(cx, cy);
    g.lineTo(ex, ey);
    g.stroke();
    g.fillText(name + ' ' + id, cx + 6, cy - 6);
  }
}
function drawScale(g, h, k) {
  const least = 60 / k, power = 10 ** Math.floor(Math.log10(least));
  const length = power * [1, 2, 5, 10].find((m) => m * power >= least);
  g.strokeStyle = g.fillStyle = colour('dim');
  g.lineWidth = 2;
  g.beginPath();
  g.moveTo(10, h - 10);
  g.lineTo(10 + length * k, h - 10);
  g.stroke();
  g.font = '12px system-ui, sans-serif';
  g.fillText(length >= 1 ? length + ' m' : Math.round(100 * length) + ' cm', 10, h - 16);
}
function drawMap() {
  const canvas = $('map'), w = canvas.clientWidth, h = canvas.clientHeight, dpr = devicePixelRatio || 1;
  if (!map || !w) return;
  canvas.width = w * dpr;
  canvas.height = h * dpr;
  const g = canvas.getContext('2d');
  g.scale(dpr, dpr);
  const k = h / view.metres;
  const at = (x, y) => [w / 2 + (x - view.x) * k, h / 2 - (y - view.y) * k];
  g.fillStyle = colour('point');
  for (let i = 0; i + 1 < map.points.length; i += 2) {
    const [x, y] = at(map.points[i], map.points[i + 1]);
    g.fillRect(x - .75, y - .75, 1.5, 1.5);
  }
  for (const loop of map.loops) drawLines(g, at, loop, colour('loop'), 2);
  drawLines(g, at, map.truth, colour('truth'), 1.5);
  drawLines(g, at, map.path, colour('estimate'), 2);
  g.fillStyle = colour('estimate');
  for (let i = 0; i + 1 < map.keyframes.length; i += 2) {
    const [x, y] = at(map.keyframes[i], map.keyframes[i + 1]);
    g.fillRect(x - 2.5, y - 2.5, 5, 5);
  }
  drawTracks(g, at, k);
  drawCamera(g, at);
  drawScale(g, h, k);
  $('map-key').textContent = 'from above: path blue, keyframes squares' + (map.tracks.length ? ', people and things purple, with their way of the next second' : '') + (map.truth.length ? ', truth ' +
    (matchMedia('(prefers-color-scheme: dark)').matches ? 'white' : 'black') : '');
  canvas.dataset.drawn = map.points.length / 2;
}
async function showMap() {
  if (!state || (map && map.serial === state.serial)) return;
  const answer = await ask('map.json');
  if (!answer) return;
  map = await answer.json();
  if (view.follows) fitView();
  drawMap();
}
function listenToMap() {
  const canvas = $('map'), fingers = new Map();
  const zoom = (factor) => { view.follows = false; view.metres = Math.min(1e4, Math.max(.05, view.metres * factor)); drawMap(); };
  canvas.addEventListener('wheel', (event) => { event.preventDefault(); zoom(Math.exp(event.deltaY / 400)); }, {passive: false});
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener('pointermove', (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const other = [...fingers].filter(([id]) => id !== event.pointerId).map(([, p]) => p)[0];
    const to = [event.clientX, event.clientY];
    fingers.set(event.pointerId, to);
    if (other) return zoom(Math.hypot(from[0] - other[0], from[1] - other[1]) / Math.max(1, Math.hypot(to[0] - other[0], to[1] - other[1])));
    const k = canvas.clientHeight / view.metres;
    view.follows = false;
    view.x -= (to[0] - from[0]) / k;
    view.y += (to[1] - from[1]) / k;
    drawMap();
  });
  for (const type of ['pointerup', 'pointercancel']) canvas.addEventListener(type, (event) => fingers.delete(event.pointerId));
  $('fit').addEventListener('click', () => { view.follows = true; fitView(); drawMap(); });
  addEventListener('resize', drawMap);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawMap);
}

// --- commands --------------------------------------------------------------------------------------
async function command(text) {
  try {
    const answer = await fetch('command', {method: 'POST', headers, body: text});
    if (!answer.ok) $('message').textContent = await answer.text();
  } catch (error) {
    document.body.classList.add('gone');
  }
}
async function save(path, name) {
  const answer = await ask(path).catch(() => null);
  if (!answer) return;
  const link = document.createElement('a');
  link.href = URL.createObjectURL(await answer.blob());
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
function listenToControls() {
  const click = (id, action) => $(id).addEventListener('click', action);
  click('pause', () => command(state && state.paused ? 'resume' : 'pause'));
  click('step', () => command('step'));
  click('reset', () => { if (confirm('Forget map and trajectory?')) command('reset'); });
  click('quit', () => { if (confirm('End the run? Its results are written.')) command('quit'); });
  click('keep-map', () => command('save map'));
  $('localize').addEventListener('change', () => command('localize ' + ($('localize').checked ? 'on' : 'off')));
  click('save-trajectory', () => save('trajectory.tum', 'trajectory.tum'));
  click('save-map', () => save('map.ply', 'map.ply'));
  click('save-picture', () => save('frame.jpg', 'frame.jpg'));
  $('variant').addEventListener('change', () => { command('variant ' + $('variant').value); $('variant').blur(); });
}

listenToControls();
listenToMap();
repeat(150, async () => {
  const answer = await ask('state.json');
  document.body.classList.remove('gone');
  if (!answer) return;
  const fresh = await answer.json();
  if (state && fresh.serial === state.serial) return;
  state = fresh;
  showState();
  await showPicture();
});
repeat(700, showMap);
