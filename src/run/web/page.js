// What the reader does: choose, play, point. `state` is all that changes.

const get = id => document.getElementById(id);
const state = {show: null, frame: 0, flow: null, drapes: {}, playing: 0, hover: null, kept: null, pin: null};
const flowShows = [{name: "depth", label: "Depth in time", unit: "m"}, {name: "speed", label: "Speed in time", unit: "m/s"}];
const isFlow = () => flowShows.some(show => show.name === state.show);
let view = null, ground = null, charts = [], wanted = 0;

const scaleOf = name => name === "depth" || name === "speed"
  ? {...data[name], ...flowShows.find(show => show.name === name)} : data.drapes.find(drape => drape.name === name);

/** The legend of what is shown. */
function drawScale() {
  const scale = scaleOf(state.show);
  get("scale").hidden = !scale;
  if (!scale) return;
  const name = scale.label[0].toUpperCase() + scale.label.slice(1);
  get("scale-name").textContent = `${name.replace(" in time", "")} [${scale.unit}]`;
  const pen = get("ramp").getContext("2d");
  for (let k = 0; k < 130; ++k) {
    pen.fillStyle = `rgb(${colourOf(scale.colours, 1 - k / 129).map(Math.round)})`;
    pen.fillRect(0, k, 1, 1);
  }
  const ticks = [0, 0.25, 0.5, 0.75, 1].map(share => {
    const tick = document.createElement("span");
    tick.style.bottom = `${100 * share}%`;
    tick.textContent = (share === 1 && scale.above !== false ? "≥ " : share === 0 && scale.below ? "≤ " : "") + written(scale.from + share * (scale.to - scale.from));
    return tick;
  });
  get("ticks").replaceChildren(...ticks);
}

/** Colours and raises what is chosen; a frame that has been overtaken meanwhile is dropped. */
async function render() {
  const turn = ++wanted, scale = scaleOf(state.show);
  let raster = null, depth = null;
  if (isFlow()) {
    const flow = await flowOf(state.frame);
    if (turn !== wanted) return;
    state.flow = flow;
    depth = flow && flow.depth;
    raster = flow && (state.show === "speed" ? flow.speed : flow.depth);
  } else if (scale) {
    state.drapes[state.show] = state.drapes[state.show] || await rasterOf(scale);
    if (turn !== wanted) return;
    raster = state.drapes[state.show];
  }
  if (raster) {
    const shown = depth ? n => depth.values[n] > data.footprint_depth : n => !isNaN(raster.values[n]);
    view.show(raster, pixelsOf(raster, scale, shown, lightOver(raster, depth)));
  } else view.show(null);
  view.lift(depth);
  view.draw();
  tell();
}

/** Light on the ground, or on the flow that lies on it; a little below 1 where it is level. */
function lightOver(raster, depth) {
  const {nx, ny, x, y, cell} = raster, surface = new Float32Array(nx * ny);
  for (let j = 0, n = 0; j < ny; ++j)
    for (let i = 0; i < nx; ++i, ++n) surface[n] = valueAt(ground, x + i * cell, y + j * cell) + (depth ? depth.values[n] : 0);
  return (i, j) => 0.86 + 0.28 * (lightOn(eastward(surface, nx, ny, i, j, cell), northward(surface, nx, ny, i, j, cell)) - Math.SQRT1_2) + 0.06;
}

function setFrame(k) {
  state.frame = Math.max(0, Math.min(data.frames.length - 1, k));
  const time = data.frames.length ? data.frames[state.frame].t : 0;
  get("slider").value = state.frame;
  get("clock").textContent = `${written(time)} s`;
  for (const chart of charts) chart.at(time);
}

function nearestFrame(time) {
  let best = 0;
  data.frames.forEach((frame, k) => { if (Math.abs(frame.t - time) < Math.abs(data.frames[best].t - time)) best = k; });
  return best;
}

function choose(name) {
  state.show = name;
  for (const label of get("shows").querySelectorAll("label")) {
    label.firstChild.checked = label.dataset.name === name;
    label.classList.toggle("chosen", label.dataset.name === name);
  }
  drawScale();
  return render();
}

function goTo(k) {
  if (!isFlow()) choose("depth");
  setFrame(k);
  return render();
}

/** Plays all frames in about ten seconds. */
function play() {
  if (state.playing) {
    clearInterval(state.playing);
    state.playing = 0;
    get("play").innerHTML = "&#9654;";
    return;
  }
  if (state.frame + 1 >= data.frames.length) setFrame(0);
  goTo(state.frame);
  get("play").innerHTML = "&#10074;&#10074;";
  state.playing = setInterval(() => state.frame + 1 < data.frames.length ? goTo(state.frame + 1) : play(),
    Math.max(40, Math.min(400, 10000 / data.frames.length)));
}

/** Values at the place under the pointer, or else at the one that was kept. */
function tell() {
  const place = state.hover || state.kept;
  if (!place) return get("under").replaceChildren();
  const [x, y] = place, rows = [], z = valueAt(ground, x, y);
  rows.push(["Place", `${(data.origin[0] + x).toFixed(0)}, ${(data.origin[1] + y).toFixed(0)}`], ["Ground", `${written(z)} m`]);
  const value = (raster, unit) => {
    const found = raster ? nearestValue(raster, x, y) : 0;
    return found > 0 ? `${written(found)} ${unit}` : `0 ${unit}`;
  };
  if (isFlow()) {
    rows.push(["Depth", value(state.flow && state.flow.depth, "m")]);
    if (data.frames.some(frame => frame.fastest !== undefined)) rows.push(["Speed", value(state.flow && state.flow.speed, "m/s")]);
  } else if (state.drapes[state.show]) {
    const scale = scaleOf(state.show), found = nearestValue(state.drapes[state.show], x, y);
    rows.push([scale.label[0].toUpperCase() + scale.label.slice(1), isNaN(found) ? (state.show === "final_depth" ? `at most ${written(data.footprint_depth)} m` : "not reached") : `${written(found)} ${scale.unit}`]);
  }
  get("under").replaceChildren(...rows.flatMap(([name, text], k) => {
    const label = document.createElement("i"), number = document.createElement("b");
    label.textContent = `${name} `, number.textContent = text;
    return k ? [document.createElement("br"), label, number] : [label, number];
  }));
}

function keep(place) {
  state.kept = place;
  if (state.pin) state.pin.element.remove(), view.labels = view.labels.filter(label => label !== state.pin);
  state.pin = place && view.addPin("●", ...place);
  view.draw();
  tell();
}

function listen() {
  const canvas = view.renderer.domElement;
  let down = null;
  canvas.addEventListener("pointermove", event => {
    if (event.buttons) return;
    state.hover = view.under(event.clientX, event.clientY);
    tell();
  });
  canvas.addEventListener("pointerleave", () => { state.hover = null; tell(); });
  canvas.addEventListener("pointerdown", event => { down = [event.clientX, event.clientY]; });
  canvas.addEventListener("pointerup", event => {
    if (down && event.button === 0 && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4)
      keep(view.under(event.clientX, event.clientY));
  });
  get("play").addEventListener("click", play);
  get("slider").addEventListener("input", () => goTo(Number(get("slider").value)));
  get("compass").addEventListener("click", () => view.northUp());
  window.addEventListener("resize", () => { for (const chart of charts) chart.draw(); setFrame(state.frame); });
}

/** Texts, choices and the strip: what needs no picture. */
function fillPage() {
  get("caption").textContent = data.caption;
  get("made").textContent = `Made by frana ${data.version}`;
  get("facts").replaceChildren(...data.facts.map(fact => {
    const row = document.createElement("tr");
    row.append(...fact.map(text => { const cell = document.createElement("td"); cell.textContent = text; return cell; }));
    return row;
  }));
  const notes = data.drapes.length || data.frames.length ? data.notes : ["Nothing flowed: the run left no depth above "
    + `${written(data.footprint_depth)} m anywhere.`, ...data.notes];
  get("notes").replaceChildren(...notes.map(text => {
    const note = document.createElement("p");
    note.textContent = text;
    return note;
  }));
  const speeds = data.frames.some(frame => frame.fastest !== undefined), moves = data.frames.some(frame => frame.deepest > data.footprint_depth);
  const shows = moves ? flowShows.filter(show => show.name === "depth" || speeds) : [];
  for (const show of [...shows, ...data.drapes]) {
    const label = document.createElement("label"), button = document.createElement("input");
    button.type = "radio", button.name = "show";
    label.dataset.name = show.name;
    label.append(button, " " + show.label[0].toUpperCase() + show.label.slice(1));
    button.addEventListener("change", () => { if (state.playing) play(); choose(show.name); });
    get("shows").append(label);
  }
  get("shows").hidden = !shows.length && !data.drapes.length;
  get("slider").max = Math.max(0, data.frames.length - 1);
  document.body.classList.toggle("still", !moves);
  if (!moves || !data.curves.time.length) return;
  const pick = time => goTo(nearestFrame(time));
  charts = [["Runout from the release", "m", data.curves.runout], ["Volume", "m³", data.curves.volume]].map(
    ([name, unit, values]) => new Chart(get("strip"), name, unit, values, data.curves.time, pick));
  for (const chart of charts) chart.draw();
}

function addKey(name, colour, dashed) {
  const item = document.createElement("li"), sample = svg("svg", {viewBox: "0 0 26 10"});
  sample.append(svg("line", {x1: 0, x2: 26, y1: 5, y2: 5, stroke: "#" + colour.toString(16).padStart(6, "0"), "stroke-width": 3,
    "stroke-dasharray": dashed ? "5 3" : "none"}));
  item.append(sample, name);
  get("key").append(item);
}

/** Lines, places and barriers; where the flow was, for the camera: its part of the map and the way it went. */
async function furnish() {
  const peak = data.drapes.find(drape => drape.name === "peak_depth");
  const first = await flowOf(0), reach = peak ? state.drapes.peak_depth = await rasterOf(peak) : null;
  const start = first ? levelLines(first.depth, data.footprint_depth) : [];
  if (start.length) view.addLines(start, lineShades.release), addKey("at the start", lineShades.release);
  if (reach) {
    view.addLines(levelLines(reach, data.footprint_depth), lineShades.footprint, false);
    addKey(`ever deeper than ${written(data.footprint_depth)} m`, lineShades.footprint);
  }
  if (data.survey.length) {
    view.addLines(data.survey.flatMap(ring => piecesOf(ring, true)), lineShades.survey);
    addKey("surveyed extent", lineShades.survey);
  }
  for (const line of data.lines) {
    view.addLines(piecesOf(line.line, false), lineShades.line, true);
    view.addPin(line.name, line.line[0], line.line[1]);
  }
  if (data.lines.length) addKey("profile or section", lineShades.line, true);
  for (const gauge of data.gauges) view.addPin(gauge.name, gauge.x, gauge.y);
  for (const barrier of data.barriers) view.addBarrier(barrier);
  return {first, reach};
}

/** Mean place of what a raster holds, by its values. */
function middleOf(raster) {
  let sum = 0, x = 0, y = 0;
  raster.values.forEach((value, n) => {
    if (!(value > 0)) return;
    sum += value, x += value * (n % raster.nx), y += value * Math.floor(n / raster.nx);
  });
  return sum > 0 ? [raster.x + raster.cell * x / sum, raster.y + raster.cell * y / sum] : null;
}

/** The whole terrain, or where the flow came, seen up its way. */
function startView({first, reach}) {
  const g = ground, places = [];
  if (!reach) {
    for (let j = 0; j < 5; ++j)
      for (let i = 0; i < 5; ++i) places.push([g.x + i / 4 * (g.nx - 1) * g.cell, g.y + j / 4 * (g.ny - 1) * g.cell]);
    return view.lookAt(places, [0, 0]);
  }
  const stride = Math.ceil(reach.values.length / 20000);
  for (let n = 0; n < reach.values.length; n += stride)
    if (!isNaN(reach.values[n])) places.push([reach.x + reach.cell * (n % reach.nx), reach.y + reach.cell * Math.floor(n / reach.nx)]);
  for (const ring of data.survey)
    for (let k = 0; k < ring.length; k += 2) places.push([ring[k], ring[k + 1]]);
  const from = first && middleOf(first.depth), all = middleOf(reach);
  view.lookAt(places, from && all ? [all[0] - from[0], all[1] - from[1]] : [0, 0]);
}

/** What the page's own data say, for the test: volume, runout and the depth at gauges, of each frame. */
async function check() {
  const told = {times: [], volume: [], runout: [], gauges: data.gauges.map(gauge => ({name: gauge.name, depth: []}))};
  let start = null;
  for (let k = 0; k < data.frames.length; ++k) {
    const flow = await flowOf(k), depth = flow && flow.depth;
    start = start || (depth && middleOf(depth));
    let volume = 0, far = 0;
    if (depth)
      depth.values.forEach((value, n) => {
        volume += value * depth.cell ** 2;
        if (value > data.footprint_depth)
          far = Math.max(far, Math.hypot(depth.x + depth.cell * (n % depth.nx) - start[0],
            depth.y + depth.cell * Math.floor(n / depth.nx) - start[1]));
      });
    told.times.push(data.frames[k].t), told.volume.push(volume), told.runout.push(far);
    told.gauges.forEach((gauge, n) => gauge.depth.push((depth && valueAt(depth, data.gauges[n].x, data.gauges[n].y)) || 0));
  }
  const element = document.createElement("pre");
  element.id = "check";
  element.textContent = JSON.stringify(told);
  document.body.append(element);
}

function trouble(text) {
  get("trouble").textContent = text;
  get("trouble").hidden = false;
}

/** "#show=peak_speed&t=12&check": what to begin with. */
async function begin() {
  const asked = new URLSearchParams(location.hash.slice(1));
  fillPage();
  if (typeof DecompressionStream === "undefined")
    return trouble("This browser is too old to unpack the page: expected Chrome 80, Firefox 113, Safari 16.4 or newer.");
  await loadThree();
  ground = await rasterOf(data.terrain);
  try {
    view = new View(get("view"), ground);
  } catch (error) {
    return trouble("This browser shows no three-dimensional pictures (WebGL): switch it on, or try another browser.");
  }
  view.fit();
  startView(await furnish());
  view.fit();
  listen();
  const names = [...get("shows").querySelectorAll("label")].map(label => label.dataset.name);
  setFrame(asked.has("t") ? nearestFrame(Number(asked.get("t"))) : 0);
  const show = names.includes(asked.get("show")) ? asked.get("show") : names.includes("peak_depth") && !asked.has("t") ? "peak_depth" : names[0];
  if (show) await choose(show);
  view.drawNow();
  document.body.dataset.ready = Math.round(performance.now());
  if (asked.has("check")) await check();
}

begin().catch(error => {
  const note = document.createElement("p");
  note.textContent = `This browser cannot show the page: ${error.message}`;
  get("notes").prepend(note);
});
