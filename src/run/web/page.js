// What the reader does: choose, slide, play, point.

/** The legend of what is shown. */
function drawScale() {
  const scale = scaleShown();
  get("scale").hidden = !scale;
  if (!scale) return;
  get("scale-name").textContent = `${capital(scale.label).replace(" in time", "")} [${scale.unit}]`;
  const pen = get("ramp").getContext("2d");
  for (let k = 0; k < 130; ++k) {
    pen.fillStyle = `rgb(${colourOf(scale.colours, 1 - k / 129).map(Math.round)})`;
    pen.fillRect(0, k, 1, 1);
  }
  const ticks = [0, 0.25, 0.5, 0.75, 1].map(share => {
    const tick = document.createElement("span"), beyond = share === 1 && scale.above ? "≥ " : share === 0 && scale.below ? "≤ " : "";
    tick.style.bottom = `${100 * share}%`;
    tick.textContent = beyond + written(scale.from + share * (scale.to - scale.from));
    return tick;
  });
  get("ticks").replaceChildren(...ticks);
}

/** Slider, clock and charts as the state has them. */
function showPlace() {
  const ladder = packedLadder(), slider = get("slider");
  const time = data.frames.length ? data.frames[state.frame].t : 0;
  slider.max = Math.max(0, (ladder ? ladder.thresholds : data.frames).length - 1);
  slider.value = ladder ? rungOf(ladder) : state.frame;
  get("clock").textContent = ladder ? `> ${thresholdText(ladder)}` : `${written(time)} s`;
  for (const chart of charts) chart.at(ladder ? ladder.thresholds[rungOf(ladder)] : time);
}

const within = (k, list) => Math.max(0, Math.min(list.length - 1, k));

function setFrame(k) {
  state.frame = within(k, data.frames);
  showPlace();
}

/** The index of the number in a list that is nearest. */
const nearest = (list, number) => list.reduce((best, one, k) => Math.abs(one - number) < Math.abs(list[best] - number) ? k : best, 0);

/** Shows the probability of more than the k-th threshold. */
function setThreshold(k) {
  const ladder = packedLadder();
  state.rungs[ladder.name] = within(k, ladder.thresholds);
  showPlace();
  drawScale();
  return render();
}

async function choose(name) {
  state.show = name;
  for (const label of get("shows").querySelectorAll("label")) {
    label.firstChild.checked = label.dataset.name === name;
    label.classList.toggle("chosen", label.dataset.name === name);
  }
  drawScale();
  if (packedLadder()) await chartLadder();
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

/** What runs say of a place: [name, text], .... */
function rowsOfRuns(packed, x, y) {
  const ladder = state.ladders[packed.name], chances = ladder ? ladder.curveAt(x, y) : [], {effective, failed_share, shares} = data.runs;
  const percent = (...numbers) => `${numbers.map(written).join(" to ")} %`;
  const chance = chances[rungOf(packed)] || 0;
  const rows = [[`More than ${thresholdText(packed)}`, percent(chance)],
    ["95 % bounds", percent(...wilson(chance / 100, effective).map(p => 100 * p))]];
  if (failed_share > 0) rows.push(["As if none, or all, of the failed runs", percent((1 - failed_share) * chance, (1 - failed_share) * chance + 100 * failed_share)]);
  const found = chances.length ? ladder.quantilesAt(x, y) : shares.map(() => 0);
  shares.forEach((share, k) => rows.push([`${written(100 * share)} % of the runs at most`, `${written(found[k])} ${packed.unit}`]));
  return rows;
}

/** Values at the place under the pointer, or else at the one that was kept. */
function tell() {
  const place = state.hover || state.kept, packed = packedLadder();
  if (packed) chartPlace(packed, place);
  if (!place) return get("under").replaceChildren();
  const [x, y] = place, rows = [], z = valueAt(ground, x, y);
  rows.push(["Place", `${(data.origin[0] + x).toFixed(0)}, ${(data.origin[1] + y).toFixed(0)}`], ["Ground", `${written(z)} m`]);
  const value = (raster, unit) => {
    const found = raster ? nearestValue(raster, x, y) : 0;
    return found > 0 ? `${written(found)} ${unit}` : `0 ${unit}`;
  };
  if (packed) rows.push(...rowsOfRuns(packed, x, y));
  else if (isFlow()) {
    rows.push(["Depth", value(state.flow && state.flow.depth, "m")]);
    if (hasSpeed()) rows.push(["Speed", value(state.flow && state.flow.speed, "m/s")]);
  } else if (state.drapes[state.show]) {
    const scale = scaleShown(), found = nearestValue(state.drapes[state.show], x, y);
    rows.push([capital(scale.label), isNaN(found) ? (["final_depth", "lying_depth"].includes(state.show) ? `at most ${written(data.footprint_depth)} m` : "not reached") : `${written(found)} ${scale.unit}`]);
  }
  get("under").replaceChildren(...rows.flatMap(([name, text], k) => {
    const label = document.createElement("i"), number = document.createElement("b");
    label.textContent = `${name} `, number.textContent = text;
    return k ? [document.createElement("br"), label, number] : [label, number];
  }));
}

/** Charts of the probabilities on show: how much ground, and how likely at the place that is pointed at. */
async function chartLadder() {
  const packed = packedLadder(), ladder = await ladderShown();
  if (packed !== packedLadder()) return;
  const along = {along: packed.thresholds, alongUnit: packed.unit};
  if (!charts.length) charts = [0, 1].map(() => new Chart(get("strip"), threshold => setThreshold(nearest(packedLadder().thresholds, threshold))));
  charts[0].show({name: "Area where more is likelier than not", unit: "m²", values: ladder.areas(0.5), ...along});
  chartPlace(packed, state.hover || state.kept);
  showPlace();
}

function chartPlace(packed, place) {
  const ladder = state.ladders[packed.name], found = place && ladder ? ladder.curveAt(...place) : [];
  if (charts.length < 2) return;
  charts[1].show({name: place ? "Probability of more, at the place" : "Probability of more: point at a place", unit: "%", most: 100,
    values: found.length || !place ? found : packed.thresholds.map(() => 0), along: packed.thresholds, alongUnit: packed.unit});
  charts[1].at(packed.thresholds[rungOf(packed)]);
}

function keep(place) {
  state.kept = place;
  if (state.pin) state.pin.element.remove(), view.labels = view.labels.filter(label => label !== state.pin);
  state.pin = place && view.addPin("●", ...place);
  view.draw();
  tell();
}

/** What works without a picture too. */
function listen() {
  get("play").addEventListener("click", play);
  get("slider").addEventListener("input", () => {
    const k = Number(get("slider").value);
    packedLadder() ? setThreshold(k) : goTo(k);
  });
  window.addEventListener("resize", () => { for (const chart of charts) chart.draw(); showPlace(); });
}

function listenToPointer() {
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
  get("compass").addEventListener("click", () => view.northUp());
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
  const flowed = moves() || data.drapes.length || data.runs;
  const notes = flowed ? data.notes : [`Nothing flowed: the run left no depth above ${written(data.footprint_depth)} m anywhere.`, ...data.notes];
  get("notes").replaceChildren(...notes.map(text => {
    const note = document.createElement("p");
    note.textContent = text;
    return note;
  }));
  for (const show of shows()) {
    const label = document.createElement("label"), button = document.createElement("input");
    button.type = "radio", button.name = "show";
    label.dataset.name = show.name;
    label.append(button, " " + capital(show.label));
    button.addEventListener("change", () => { if (state.playing) play(); choose(show.name); });
    get("shows").append(label);
  }
  get("shows").hidden = !shows().length;
  document.body.classList.toggle("still", !moves() && !data.runs);
  document.body.classList.toggle("many", Boolean(data.runs));
  if (data.runs) get("shows").firstElementChild.textContent = "Probability of more", get("slider").setAttribute("aria-label", "Threshold");
  if (!moves() || !data.curves.time.length) return;
  const pick = time => goTo(nearest(data.frames.map(frame => frame.t), time));
  charts = [[data.curves.runout_name, "m", data.curves.runout], [data.curves.volume_name, "m³", data.curves.volume]].map(([name, unit, values]) => {
    const chart = new Chart(get("strip"), pick);
    chart.show({name, unit, values, along: data.curves.time, alongUnit: "s"});
    return chart;
  });
}
