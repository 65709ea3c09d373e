// tests/web_page.sh puts this at the end of a copy of a page: it uses what the page offers, and tells what came of it.
const probe = {errors: [], legends: {}, notes: "", flat: false, under: [], pointing: null, left: null};
window.addEventListener("error", event => probe.errors.push(event.message));
window.addEventListener("unhandledrejection", event => probe.errors.push(String(event.reason)));
const rest = ms => new Promise(done => setTimeout(done, ms));

/** The point of the window where a place of the surface is seen. */
function pointOf(x, y) {
  const at = new THREE.Vector3(x, y, valueAt(view.surface, x, y)).project(view.camera);
  const box = view.renderer.domElement.getBoundingClientRect();
  return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height];
}

/** Points at the deepest flow of the first frame, which stands high above the ground. */
async function pointAtFlow() {
  await goTo(0);
  const {nx, x, y, cell, values} = state.flow.depth, n = values.indexOf(Math.max(...values));
  const place = [x + cell * (n % nx), y + cell * Math.floor(n / nx)], [clientX, clientY] = pointOf(...place);
  view.renderer.domElement.dispatchEvent(new PointerEvent("pointermove", {clientX, clientY}));
  probe.pointing = {place, found: state.hover, depth: values[n]};
}

/** Points at the place that most of the runs come to. */
function pointAtRuns() {
  const {nx, x, y, cell, values} = state.reached, n = values.reduce((best, share, k) => share > (values[best] || 0) ? k : best, 0);
  const place = [x + cell * (n % nx), y + cell * Math.floor(n / nx)], [clientX, clientY] = pointOf(...place);
  view.renderer.domElement.dispatchEvent(new PointerEvent("pointermove", {clientX, clientY}));
  probe.pointing = {place, found: state.hover};
}

/** Where the labels of a chart begin that reaches 40 million m3: below 0 they are cut. */
function leftOfLabels() {
  charts[0].show({name: "Volume", unit: "m³", values: [0, 4e7], along: [0, 10], alongUnit: "s"});
  return Math.min(...[...charts[0].element.querySelectorAll("text")].map(text => text.getBBox().x));
}

async function useAll() {
  while (!get("check") && get("trouble").hidden) await rest(20);  // which chooses too
  await rest(300);
  probe.notes = get("notes").textContent;
  probe.flat = !get("trouble").hidden;
  for (const button of document.querySelectorAll("#shows input")) {
    button.click();
    await rest(300);
    probe.legends[state.show] = document.querySelector("#ticks span:last-child").textContent;
    get("slider").value = Number(get("slider").max) / 2;
    get("slider").dispatchEvent(new Event("input"));
    for (const chart of document.querySelectorAll("#strip svg")) chart.dispatchEvent(new MouseEvent("click", {clientX: 300}));
    await rest(300);
  }
  for (const times of data.frames.length ? [1, 2] : []) {
    get("play").click();
    await rest(300 * times);
  }
  if (view && data.frames.some(frame => frame.deepest)) await pointAtFlow();
  if (view && data.runs) pointAtRuns();
  if (charts.length) probe.left = leftOfLabels();
  probe.under = [...get("under").querySelectorAll("b")].map(value => value.textContent);
}

useAll().catch(error => probe.errors.push(String(error))).finally(() => {
  const element = document.createElement("pre");
  element.id = "probe";
  element.textContent = JSON.stringify(probe);
  document.body.append(element);
});
