// How the page begins: what stands on the terrain, the first look, and what the page says of its own data.

function addKey(name, colour, dashed) {
  const item = document.createElement("li"), sample = svg("svg", {viewBox: "0 0 26 10"});
  sample.append(svg("line", {x1: 0, x2: 26, y1: 5, y2: 5, stroke: "#" + colour.toString(16).padStart(6, "0"), "stroke-width": 3,
    "stroke-dasharray": dashed ? "5 3" : "none"}));
  item.append(sample, name);
  get("key").append(item);
}

/** Where the flow was at the start (or null), and wherever it came: a raster of depths, or of shares of the runs, or null. */
async function extents() {
  const peak = data.drapes.some(drape => drape.name === "peak_depth");
  const [first, reach] = await Promise.all([flowOf(0), data.runs ? rasterOf(data.runs.reached) : peak ? drapeNamed("peak_depth") : null]);
  if (data.runs) state.reached = reach;
  return {first, reach};
}

/** Lines, places and barriers. */
function furnish({first, reach}) {
  const start = first ? levelLines(first.depth, data.footprint_depth) : [];
  if (start.length) view.addLines(start, lineShades.release), addKey("at the start", lineShades.release);
  if (reach) {
    const level = data.runs ? 0.05 : data.footprint_depth;  // of probability or depth
    view.addLines(levelLines(reach, level), lineShades.footprint, false);
    addKey(data.runs ? `reached by ${100 * level} % of the runs` : `ever deeper than ${written(level)} m`, lineShades.footprint);
  }
  if (data.survey.length) {
    view.addLines(data.survey.flatMap(ring => piecesOf(ring, true)), lineShades.survey);
    addKey("surveyed extent", lineShades.survey);
  }
  for (const line of data.lines) {
    view.addLines(piecesOf(line.line, false), lineShades.line, true);
    view.addPin(line.name, line.line[0], line.line[1]);
  }
  if (data.lines.length) addKey(data.runs ? "path of the runout" : "profile or section", lineShades.line, true);
  for (const gauge of data.gauges) view.addPin(gauge.name, gauge.x, gauge.y);
  for (const barrier of data.barriers) view.addBarrier(barrier);
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
  const from = data.runs ? data.runs.start : first && middleOf(first.depth), all = middleOf(reach);
  view.lookAt(places, from && all ? [all[0] - from[0], all[1] - from[1]] : [0, 0]);
}

/** What the page shows of an ensemble, for the test: percents of all pixels at all thresholds, and quantiles. */
async function checkRuns() {
  const told = [];
  for (const {name, unit, thresholds} of packedLadders) {
    await choose(name);
    const ladder = state.ladders[name], {nx, ny, x, y, cell} = ladder.reached, above = [];
    for (let k = 0; k < thresholds.length; ++k) {
      await setThreshold(k);
      above.push({threshold: thresholds[k], percents: Array.from((await sight()).raster.values)});
    }
    const place = n => [x + cell * (n % nx), y + cell * Math.floor(n / nx)];
    const quantiles = Array.from(ladder.rows, (row, n) => row < 0 ? null : ladder.quantilesAt(...place(n)));
    told.push({name, unit, thresholds, nx, ny, x: data.origin[0] + x, y: data.origin[1] + y, cell, above, quantiles, likelier: ladder.areas(0.5)});
  }
  return {ladders: told, effective: data.runs.effective, wilson: [0, 0.3, 1].map(p => wilson(p, data.runs.effective))};
}

/** Likewise of a run: volume, runout and the depth at gauges, of each frame. */
async function checkFrames() {
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
  return told;
}

async function check() {
  const element = document.createElement("pre");
  element.id = "check";
  element.textContent = JSON.stringify(data.runs ? await checkRuns() : await checkFrames());
  document.body.append(element);
}

function trouble(text) {
  get("trouble").textContent = text;
  get("trouble").hidden = false;
}

/** "#show=peak_speed&t=12&check" or "#show=peak_depth&above=0.5": what to begin with. */
async function showFirst() {
  const asked = new URLSearchParams(location.hash.slice(1)), names = shows().map(show => show.name);
  if (data.frames.length) setFrame(asked.has("t") ? nearest(data.frames.map(frame => frame.t), Number(asked.get("t"))) : 0);
  const usual = names.includes("peak_depth") && !asked.has("t") ? "peak_depth" : names[0];
  const show = state.show || (names.includes(asked.get("show")) ? asked.get("show") : usual);
  for (const ladder of packedLadders)
    if (ladder.name === show && asked.has("above")) state.rungs[show] = nearest(ladder.thresholds, Number(asked.get("above")));
  if (show) await choose(show);
}

async function begin() {
  fillPage();
  listen();
  if (typeof DecompressionStream === "undefined")
    return trouble("This browser is too old to unpack the page: expected Chrome 80, Firefox 113, Safari 16.4 or newer.");
  await loadThree();
  ground = await rasterOf(data.terrain);
  try {
    view = new View(get("view"), ground);
  } catch (error) {
    trouble(`This browser shows no three-dimensional pictures (WebGL): switch it on, or try another browser (${error.message}).`);
    return showFirst();
  }
  view.fit();  // the terrain alone is drawn while the rest is unpacked
  const where = await extents();
  furnish(where);
  startView(where);
  listenToPointer();
  await showFirst();
  view.drawNow();
  document.body.dataset.ready = Math.round(performance.now());
  if (location.hash.includes("check")) await check();
}

begin().catch(error => {
  const note = document.createElement("p");
  note.textContent = `This browser cannot show the page: ${error.message}`;
  get("notes").prepend(note);
});
