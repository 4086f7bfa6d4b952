// SPDX-License-Identifier: Apache-2.0
// Draws the report of one run.
'use strict';
const summary = data.summary || {};
const frames = data.frames;
const timings = data.timings;

// --- time: seconds since the first frame --------------------------------------------------------
const start = frames && frames.stamp_s.length ? frames.stamp_s[0]
  : data.trajectory.stamp_s.length ? data.trajectory.stamp_s[0] : 0;
const frameTimes = frames ? frames.stamp_s.map((s) => s - start) : [];
const timeOfFrame = new Map(frames ? frames.index.map((index, i) => [index, frameTimes[i]]) : []);
const poseTimes = data.trajectory.stamp_s.map((s) => s - start);
timeline.frameAt = new Map(frameTimes.map((t, i) => [t, frames.index[i]]));
timeline.lost = (summary.lost_spans || []).map((s) => [timeOfFrame.get(s.first), timeOfFrame.get(s.last)]);
timeline.loops = (summary.loops || []).map((l) => timeOfFrame.get(l.frame));

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
function rejectedShare() {
  const rejected = Object.values(summary.features_rejected_by_rule || {}).reduce((a, b) => a + b, 0);
  const kept = summary.features_kept.mean * summary.features_kept.count;
  return rejected + kept > 0 ? fixed(100 * rejected / (rejected + kept), 1) + ' %' : '–';
}
function drawSummary() {
  document.getElementById('title').textContent = data.title;
  const cards = element(main, 'div', undefined, {className: 'cards'});
  if (!data.summary) return errorCards(cards);
  const lost = summary.lost_spans;
  const skipped = summary.frames_skipped.length;
  document.getElementById('subtitle').textContent = [
    'variant ' + summary.variant,
    summary.detector ? 'detector ' + fileName(summary.detector) : 'no detector',
    summary.detector_device && summary.detector_device !== 'cpu' ? 'network on ' + summary.detector_device : '',
    summary.deterministic ? 'deterministic' : 'threaded',
    summary.realtime ? 'real time' : '',
    'seed ' + summary.seed].filter(Boolean).join(' · ');
  errorCards(cards);
  card(cards, 'frames tracked', summary.frames_tracked + ' of ' + summary.frames_processed,
    summary.frames_tracked < summary.frames_processed);
  if (summary.camera && summary.camera.pauses + summary.camera.unplugged) {
    card(cards, 'camera', 'paused ' + summary.camera.pauses + ' times, unplugged ' + summary.camera.unplugged, true);
  }
  if (skipped + summary.frames_dropped) {
    card(cards, 'frames not seen', skipped + ' skipped, ' + summary.frames_dropped + ' dropped', true);
  }
  card(cards, 'frames per second', fixed(summary.frames_per_second, 1));
  card(cards, 'lost', lost.length
    ? lost.slice(0, 4).map((s) => s.first === s.last ? s.first : s.first + '–' + s.last).join(', ') +
      (lost.length > 4 ? ', … (' + lost.length + ')' : '')
    : 'never', lost.length > 0);
  card(cards, 'loops closed', summary.loops.length
    ? summary.loops.length + ' (' + summary.loops.slice(0, 4).map((l) => l.matched_frame + '→' + l.frame).join(', ') +
      (summary.loops.length > 4 ? ', …)' : ')')
    : 'none');
  card(cards, 'points rejected', rejectedShare());
  card(cards, 'keyframes kept', summary.keyframes_kept + ' of ' + summary.keyframes_inserted);
  card(cards, 'map points', summary.map_points);
  card(cards, 'peak memory', fixed(summary.peak_resident_mb, 0) + ' MB');
}

// --- trajectory ---------------------------------------------------------------------------------
function drawTrajectory() {
  if (!data.trajectory.xyz.length) return;
  const node = section('Trajectory');
  const key = element(node, 'p', undefined, {className: 'dim'});
  if (data.truth.xyz.length) keyEntry(key, 'ground truth', 'var(--truth)');
  keyEntry(key, data.truth.xyz.length ? 'estimate, aligned' : 'estimate', 'var(--estimate)');
  if (data.pairs.length) keyEntry(key, 'error', 'var(--error)');
  const end = frameTimes.length ? frameTimes[frameTimes.length - 1] : poseTimes[poseTimes.length - 1];
  const track = {css: 'var(--estimate)', times: poseTimes, xyz: data.trajectory.xyz, pairs: data.pairs,
    errors: new Map(data.pairs.map(([, e], i) => [e, data.ate_m[i]]))};
  drawViews(node, data.trajectory.mean_down, [track], truthBetween(start, 0, end));
}
function drawTracks() {
  if (!data.tracks.length) return;
  const node = section('People and moving things');
  element(node, 'p', 'Where they were and went in the map\'s frame (tracks.jsonl has every frame). The camera\'s path is grey.',
    {className: 'dim'});
  const end = poseTimes.length ? poseTimes[poseTimes.length - 1] : 0;
  const shown = data.tracks.slice(0, 40).map((t, i) => ({name: t.class + ' ' + t.id, css: palette[i % palette.length],
    times: t.stamp_s.map((s) => s - start), xyz: t.xyz, pairs: [], errors: new Map()}));
  const camera = {name: 'camera', css: 'var(--keyframe)', times: poseTimes, xyz: data.trajectory.xyz, pairs: [],
    errors: new Map()};
  const key = element(node, 'p', undefined, {className: 'dim'});
  shown.slice(0, 12).forEach((t) => keyEntry(key, t.name, t.css));
  keyEntry(key, 'camera', camera.css);
  drawViews(node, data.trajectory.mean_down, [camera, ...shown], []);
  table(node, ['', 'first [s]', 'last [s]', 'seen [frames]', 'way [m]', 'mean speed [m/s]', 'top speed [m/s]',
    'judged moving', 'size w × h [m]'],
    data.tracks.slice(0, 200).map((t) => [t.class + ' ' + t.id, fixed(t.first_s - start, 2), fixed(t.last_s - start, 2),
      t.seen, fixed(t.way_m, 2), fixed(t.mean_m_s, 2), fixed(t.top_m_s, 2), fixed(100 * t.moving, 0) + ' %',
      fixed(t.extent_m[0], 2) + ' × ' + fixed(t.extent_m[1], 2)]));
  if (data.tracks.length > 40) element(node, 'p', 'The drawing has the 40 longest of ' + data.tracks.length + '.');
}
function drawMoments() {
  if (!data.moments.length) return;
  const node = element(section('Key moments'), 'div', undefined, {className: 'moments'});
  for (const moment of data.moments) {
    const figure = element(node, 'figure', undefined, {className: moment.wide ? 'wide' : ''});
    const zoom = element(figure, 'button', undefined, {type: 'button', title: 'Enlarge'});
    zoom.setAttribute('aria-label', 'Enlarge: ' + moment.caption);
    element(zoom, 'img', undefined, {src: moment.image, alt: moment.caption});
    zoom.addEventListener('click', () => figure.classList.toggle('large'));
    element(figure, 'figcaption', moment.caption);
  }
}

// --- plots over time ----------------------------------------------------------------------------
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
function drawErrorTable(node) {
  const {ate, rpe} = data.evaluation;
  const per = 'RPE/' + rpe.delta + ' ' + rpe.unit;
  const rows = [['ATE [m]', ate.absolute_translational_error, ate.pairs],
    [per + ' [m]', rpe.translational_error, rpe.pairs], [per + ' [°]', rpe.rotational_error, rpe.pairs]];
  table(node, ['', 'RMSE', 'mean', 'median', 'S.D.', 'min', 'max', 'pairs'],
    rows.filter(([, s]) => s).map(([name, s, pairs]) =>
      [name, ...['rmse', 'mean', 'median', 'std', 'min', 'max'].map((k) => fixed(s[k], 6)), pairs]));
}
function columns(...series) { return frameTimes.map((t, i) => [t, ...series.map((s) => numberOrNone(s[i]))]); }
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
function drawTimeDistribution() {
  const node = section('Distribution of times');
  if (frameTimes.length && frames.stages_cpu_ms.total) {
    plotShares(node, 'Frames that were tracked within so many milliseconds', 'ms',
      [{name: 'processor time', values: frames.stages_cpu_ms.total},
        {name: 'wall time', values: frames.total_wall_ms}]);
  }
  if (!timings) return;
  const header = ['ms', 'median', 'p95', 'p99', 'max', 'cpu median', 'cpu p95', 'cpu p99', 'count'];
  for (const [name, key] of [['Frames', 'per_frame'], ['Keyframes, beside tracking', 'per_keyframe']]) {
    const rows = Object.entries(timings[key] || {}).sort(([, a], [, b]) => b.wall_ms.median - a.wall_ms.median);
    if (!rows.length) continue;
    element(node, 'h3', name);
    table(node, header, rows.map(([stage, {wall_ms: w, cpu_ms: c}]) => [human(stage),
      ...[w.median, w.p95, w.p99, w.max, c.median, c.p95, c.p99].map((t) => fixed(t, 2)), w.count]));
  }
}
function drawMap() {
  const node = section('Map growth');
  const pair = element(node, 'div', undefined, {className: 'pair'});
  plot(pair, 'Keyframes', 'keyframes', ['keyframes'], columns(frames.keyframes), {stepPlot: true});
  plot(pair, 'Points', 'points', ['points'], columns(frames.points), {stepPlot: true, colors: ['#1a9850']});
}
function drawConfiguration() {
  const versions = Object.entries(summary.versions || {}).map(([name, version]) => name + ' ' + version);
  document.getElementById('version').textContent =
    ['Report by ydd-slam ' + data.version, ...(summary.version ? ['run by ydd-slam ' + summary.version] : []),
      ...versions].join(' · ');
  if (!data.config) return;
  const node = element(section('Configuration'), 'details');
  element(node, 'summary', 'Every setting of this run');
  element(node, 'pre', data.config);
}

drawSummary();
drawTrajectory();
drawTracks();
drawMoments();
drawErrors();
if (frameTimes.length) {
  drawFeatures();
  drawTimes();
}
if (frameTimes.length || timings) drawTimeDistribution();
if (frameTimes.length) drawMap();
drawConfiguration();
finish();
