// SPDX-License-Identifier: Apache-2.0
// Draws several runs and trajectories of one sequence side by side.
'use strict';
const runs = data.runs.map((run, i) => ({...run, css: palette[i % palette.length]}));
const start = Math.min(...runs.map((run) => run.trajectory.stamp_s[0]).filter(Number.isFinite));
const colours = runs.map((run) => run.css);
const known = (get) => runs.filter((run) => get(run) !== undefined && get(run) !== null);

/// Rows for a plot: one column per run, null where a run has no value at that time.
function merged(list, timesOf, valuesOf) {
  const rows = new Map();
  list.forEach((run, k) => {
    const values = valuesOf(run);
    timesOf(run).forEach((t, i) => {
      const key = Math.round(1e6 * (t - start));
      if (!rows.has(key)) rows.set(key, [key / 1e6, ...list.map(() => null)]);
      rows.get(key)[k + 1] = numberOrNone(values[i]);
    });
  });
  return [...rows.values()].sort((a, b) => a[0] - b[0]);
}
function overlay(node, title, unit, list, timesOf, valuesOf, options) {
  if (!list.length) return;
  plot(node, title, unit, list.map((run) => run.name), merged(list, timesOf, valuesOf),
    {colors: list.map((run) => run.css), ...options});
}

// --- figures ------------------------------------------------------------------------------------
const dig = (value, ...keys) => keys.reduce((v, key) => v === undefined || v === null ? undefined : v[key], value);
function rejectedShare(run) {
  const kept = dig(run.summary, 'features_kept');
  if (!kept) return undefined;
  const rejected = Object.values(run.summary.features_rejected_by_rule || {}).reduce((a, b) => a + b, 0);
  const all = rejected + kept.mean * kept.count;
  return all > 0 ? 100 * rejected / all : undefined;
}
function lostFrames(run) {
  const spans = dig(run.summary, 'lost_spans');
  return spans && spans.reduce((n, s) => n + s.last - s.first + 1, 0);
}
const ateOf = (key) => (run) => dig(run.evaluation, 'ate', 'absolute_translational_error', key);
const rpe = dig(runs.find((run) => run.evaluation), 'evaluation', 'rpe');
const per = rpe ? '/' + rpe.delta + ' ' + rpe.unit : '';
/// Name, value, digits, and whether less (-1) or more (1) is better.
const figures = [
  ['variant', (run) => dig(run.summary, 'variant')],
  ['detector', (run) => run.summary && fileName(run.summary.detector || 'none')],
  ['poses', (run) => run.trajectory.xyz.length],
  ['ATE RMSE [m]', ateOf('rmse'), 4, -1],
  ['ATE median [m]', ateOf('median'), 4, -1],
  ['ATE max [m]', ateOf('max'), 4, -1],
  ['RPE' + per + ' RMSE [m]', (run) => dig(run.evaluation, 'rpe', 'translational_error', 'rmse'), 4, -1],
  ['RPE' + per + ' RMSE [°]', (run) => dig(run.evaluation, 'rpe', 'rotational_error', 'rmse'), 3, -1],
  ['frames tracked', (run) => dig(run.summary, 'frames_tracked')],
  ['frames lost', lostFrames],
  ['frames per second', (run) => dig(run.summary, 'frames_per_second'), 1, 1],
  ['tracking, median cpu [ms]', (run) => dig(run.timings, 'per_frame', 'total', 'cpu_ms', 'median'), 2, -1],
  ['points kept per frame', (run) => dig(run.summary, 'features_kept', 'mean'), 0],
  ['points rejected [%]', rejectedShare, 1],
  ['loops closed', (run) => dig(run.summary, 'loops', 'length')],
  ['keyframes kept', (run) => dig(run.summary, 'keyframes_kept')],
  ['map points', (run) => dig(run.summary, 'map_points')],
  ['peak memory [MB]', (run) => dig(run.summary, 'peak_resident_mb'), 0, -1],
];
function shown(value, digits) {
  if (value === undefined || value === null) return '–';
  return digits === undefined ? String(value) : fixed(value, digits);
}
function drawFigures() {
  const rows = figures.map(([name, get, digits, better]) => {
    const values = runs.map(get);
    const numbers = values.filter(Number.isFinite);
    const best = !better || numbers.length < 2 ? undefined
      : shown(better < 0 ? Math.min(...numbers) : Math.max(...numbers), digits);
    return {cells: [name, ...values.map((v) => shown(v, digits))], best};
  }).filter((row) => row.cells.slice(1).some((cell) => cell !== '–'));
  table(section('Figures'), ['', ...runs.map((run) => run.name)], rows.map((row) => row.cells),
    (r, c) => c > 0 && rows[r].cells[c] === rows[r].best);
}

// --- trajectories and errors --------------------------------------------------------------------
function drawTrajectories() {
  const list = runs.filter((run) => run.trajectory.xyz.length);
  if (!list.length) return;
  const node = section('Trajectories');
  const key = element(node, 'p', undefined, {className: 'dim'});
  if (data.truth.xyz.length) keyEntry(key, 'ground truth', 'var(--truth)');
  for (const run of list) keyEntry(key, run.name, run.css);
  element(node, 'p', data.truth.xyz.length ? 'Each aligned to ground truth.'
    : 'There is no ground truth: each is aligned to the first.', {className: 'dim'});
  const tracks = list.map((run) => ({name: run.name, css: run.css, pairs: [],
    times: run.trajectory.stamp_s.map((s) => s - start), xyz: run.trajectory.xyz,
    errors: new Map(run.pairs.map(([, e], i) => [e, run.ate_m[i]]))}));
  const ends = tracks.map((t) => t.times[t.times.length - 1]);
  drawViews(node, list[0].trajectory.mean_down, tracks, truthBetween(start, 0, Math.max(...ends)));
}
function drawErrors() {
  const list = runs.filter((run) => run.ate_m.length);
  if (!list.length) return;
  const node = section('Errors');
  const pose = (run) => (e) => run.trajectory.stamp_s[e];
  overlay(node, 'ATE: distance to ground truth after alignment', 'cm', list,
    (run) => run.pairs.map(([, e]) => pose(run)(e)), (run) => run.ate_m.map((m) => 100 * m));
  overlay(node, 'RPE: drift over ' + per.slice(1), 'cm', list.filter((run) => run.rpe.first.length),
    (run) => run.rpe.first.map(pose(run)), (run) => run.rpe.translation_m.map((m) => 100 * m));
  plotShares(node, 'Poses within so many centimetres of the truth', 'cm',
    list.map((run) => ({name: run.name, values: run.ate_m.map((m) => 100 * m)})),
    {colors: list.map((run) => run.css)});
}
function drawFrames() {
  const list = known((run) => run.frames);
  if (!list.length) return;
  const node = section('Frame by frame');
  const times = (run) => run.frames.stamp_s;
  const rejected = (run) => run.frames.kept.map((kept, i) => {
    const n = Object.values(run.frames.rejected).reduce((sum, rule) => sum + rule[i], 0);
    return n + kept > 0 ? 100 * n / (n + kept) : 0;
  });
  overlay(node, 'Points kept', 'points', list, times, (run) => run.frames.kept);
  overlay(node, 'Share of points rejected', '%', list, times, rejected);
  overlay(node, 'Map points that the pose agrees with', 'points', list, times, (run) => run.frames.inliers);
  overlay(node, 'Processor time of tracking', 'ms',
    list.filter((run) => run.frames.stages_cpu_ms.total), times, (run) => run.frames.stages_cpu_ms.total);
  plotShares(node, 'Frames that were tracked within so many milliseconds (processor time)', 'ms',
    list.filter((run) => run.frames.stages_cpu_ms.total)
      .map((run) => ({name: run.name, values: run.frames.stages_cpu_ms.total})),
    {colors: list.map((run) => run.css)});
  overlay(node, 'Keyframes in the map', 'keyframes', list, times, (run) => run.frames.keyframes, {stepPlot: true});
}

// --- configuration ------------------------------------------------------------------------------
/// The settings of a saved configuration: nested keys joined by dots.
function settings(yaml) {
  const out = new Map(), path = [];
  for (const line of yaml.split('\n')) {
    const match = /^( *)([^ #:][^:]*):\s*(.*)$/.exec(line);
    if (!match) continue;
    const depth = match[1].length / 2;
    path.length = depth;
    path[depth] = match[2];
    if (match[3]) out.set(path.join('.'), match[3].replace(/\s+#.*$/, ''));
  }
  return out;
}
function drawDifferences() {
  const list = known((run) => run.config || undefined);
  if (list.length < 2) return;
  const node = section('Settings that differ');
  const all = list.map((run) => settings(run.config));
  const keys = [...new Set(all.flatMap((s) => [...s.keys()]))];
  const rows = keys.map((key) => [key, ...all.map((s) => s.has(key) ? s.get(key) : '–')])
    .filter(([, ...values]) => new Set(values).size > 1);
  if (!rows.length) {
    element(node, 'p', 'None: these runs were configured alike.');
  } else {
    table(node, ['', ...list.map((run) => run.name)], rows);
  }
}

document.getElementById('title').textContent = data.title;
document.getElementById('subtitle').textContent = runs.map((run) => run.name).join(' · ');
document.getElementById('version').textContent = 'Report by ydd-slam ' + data.version;
drawFigures();
drawTrajectories();
drawErrors();
drawFrames();
drawDifferences();
finish();
