// What can lie on the terrain: the flow in time, peaks of a run, probabilities of many runs. `state` is all that changes.

const get = id => document.getElementById(id);
const state = {show: null, frame: 0, flow: null, drapes: {}, ladders: {}, rungs: {}, playing: 0, hover: null, kept: null, pin: null};
const flowShows = [{name: "depth", label: "Depth in time", unit: "m"}, {name: "speed", label: "Speed in time", unit: "m/s"}];
const packedLadders = data.runs ? data.runs.ladders : [];
let view = null, ground = null, charts = [], wanted = 0;

const isFlow = () => flowShows.some(show => show.name === state.show);
const capital = text => text[0].toUpperCase() + text.slice(1);
/** Of the field on show, as it lies in the page; nothing where it is no probability. */
const packedLadder = () => packedLadders.find(ladder => ladder.name === state.show);
const rungOf = ladder => state.rungs[ladder.name] ?? ladder.first;
const thresholdText = ladder => `${written(ladder.thresholds[rungOf(ladder)])} ${ladder.unit}`;

const hasSpeed = () => data.frames.some(frame => frame.fastest !== undefined);
/** Whether any frame is deeper than what counts as flow. */
const moves = () => data.frames.some(frame => frame.deepest > data.footprint_depth);

/** All that this page can show. */
function shows() {
  const flows = moves() ? flowShows.filter(show => show.name === "depth" || hasSpeed()) : [];
  return [...flows, ...data.drapes, ...packedLadders];
}

/** Colours and limits of what is on show, and its name for the legend. */
function scaleShown() {
  const ladder = packedLadder();
  if (ladder) return {...data.runs.probability, label: `Probability of a ${ladder.label} above ${thresholdText(ladder)}`};
  return isFlow() ? {...data[state.show], ...flowShows.find(show => show.name === state.show)}
    : data.drapes.find(drape => drape.name === state.show);
}

/** The ladder on show, unpacked. */
async function ladderShown() {
  const packed = packedLadder(), {name} = packed;
  state.reached = state.reached || await rasterOf(data.runs.reached);
  return state.ladders[name] = state.ladders[name] || await Ladder.of(packed, state.reached);
}

async function drapeNamed(name) {
  return state.drapes[name] = state.drapes[name] || await rasterOf(data.drapes.find(drape => drape.name === name));
}

/** What is on show: values, what lifts the surface (or null), and of which nodes the values are seen. */
async function sight() {
  const seen = {flow: null, raster: null, depth: null, shown: n => !isNaN(seen.raster.values[n])};
  const packed = packedLadder();
  if (packed) {
    const ladder = await ladderShown(), least = 100 * data.runs.shown_above;
    seen.raster = ladder.above(rungOf(packed));
    seen.shown = n => seen.raster.values[n] > least;
  } else if (isFlow()) {
    seen.flow = await flowOf(state.frame);
    seen.depth = seen.flow && seen.flow.depth;
    seen.raster = seen.flow && seen.flow[state.show];
    seen.shown = n => seen.depth.values[n] > data.footprint_depth;
  } else if (scaleShown()) seen.raster = await drapeNamed(state.show);
  return seen;
}

/** Light on the ground, or on the flow that lies on it; a little below 1 where it is level. */
function lightOver(raster, depth) {
  const {nx, ny, x, y, cell} = raster, surface = new Float32Array(nx * ny);
  for (let j = 0, n = 0; j < ny; ++j)
    for (let i = 0; i < nx; ++i, ++n) surface[n] = valueAt(ground, x + i * cell, y + j * cell) + (depth ? depth.values[n] : 0);
  return (i, j) => 0.86 + 0.28 * (lightOn(eastward(surface, nx, ny, i, j, cell), northward(surface, nx, ny, i, j, cell)) - Math.SQRT1_2) + 0.06;
}

/** Colours and raises what is on show; what has been overtaken meanwhile is dropped. Without WebGL nothing is drawn. */
async function render() {
  const turn = ++wanted, seen = await sight();
  if (turn !== wanted || !view) return;
  state.flow = seen.flow;
  view.show(seen.raster, seen.raster && pixelsOf(seen.raster, scaleShown(), seen.shown, lightOver(seen.raster, seen.depth)));
  view.lift(seen.depth);
  view.draw();
  tell();
}
