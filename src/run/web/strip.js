// Curves under the picture: through time, or over thresholds.

/** A round number at or above. */
function roundAbove(value) {
  if (!(value > 0)) return 1;
  const ten = 10 ** Math.floor(Math.log10(value));
  return [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].find(m => m * ten >= value * (1 - 1e-9)) * ten;
}

/** As people write numbers: 24 300, 3.4, 0.12. */
function written(value) {
  if (!isFinite(value)) return "–";
  const size = Math.abs(value);
  const digits = size >= 100 || size === 0 ? 0 : Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(size))));
  const [whole, part] = value.toFixed(digits).split(".");
  const shortened = part ? part.replace(/0+$/, "") : "";
  return whole.replace(/\B(?=(\d{3})+$)/g, "\u2009") + (shortened ? "." + shortened : "");
}

const svg = (name, attributes, text) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
};

class Chart {
  /** `pick` is called with the place on the axis that is clicked. */
  constructor(holder, pick) {
    this.element = svg("svg", {role: "img"});
    holder.append(this.element);
    this.element.addEventListener("click", event => pick(this.alongAt(event.clientX)));
  }

  /** A curve {name, unit, values, along, alongUnit, most}: `values` over `along`, which ascends; `most` is the top, if not the largest. No
   * values: the axes alone. */
  show(curve) {
    this.curve = curve;
    this.element.setAttribute("aria-label", curve.name);
    this.draw();
  }

  /** Of a text as the browser draws it; 0 while the chart is hidden. */
  widthOf(text) {
    const element = svg("text", {}, text);
    this.element.append(element);
    const width = element.getComputedTextLength();
    element.remove();
    return width;
  }

  draw() {
    const {name, unit, values, along, alongUnit} = this.curve;
    const last = along[along.length - 1] || 1, most = this.curve.most || roundAbove(Math.max(...values));
    const widest = Math.max(...[0, 0.5, 1].map(share => this.widthOf(written(share * most))));  // a volume may have 1e8 m³
    const width = this.element.clientWidth || 500, height = 104, right = 12, top = 20, bottom = 18;
    const left = Math.max(58, Math.ceil(widest) + 8);
    this.x = t => left + (width - left - right) * t / last;
    this.toAlong = x => Math.max(0, Math.min(last, (x - left) / (width - left - right) * last));
    const y = value => height - bottom - (height - top - bottom) * value / most;
    this.element.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.element.replaceChildren(svg("text", {x: 0, y: 12, class: "name"}, `${name} [${unit}]`));
    for (const share of [0, 0.5, 1]) {
      const at = y(share * most);
      this.element.append(svg("line", {x1: left, x2: width - right, y1: at, y2: at, stroke: "#dadada"}),
        svg("text", {x: left - 6, y: at + 4, "text-anchor": "end"}, written(share * most)));
    }
    for (const share of [0, 0.25, 0.5, 0.75, 1])
      this.element.append(svg("text", {x: this.x(share * last), y: height - 4, "text-anchor": share === 1 ? "end" : "middle"},
        `${written(share * last)}${share === 1 ? ` ${alongUnit}` : ""}`));
    const points = values.map((value, k) => `${this.x(along[k]).toFixed(1)},${y(value).toFixed(1)}`);
    this.element.append(svg("polyline", {points: points.join(" "), fill: "none", stroke: "#0072b2", "stroke-width": 2}));
    this.cursor = svg("line", {y1: top - 4, y2: height - bottom, stroke: "#d55e00", "stroke-width": 1.5});
    this.now = svg("text", {x: width - right, y: 12, "text-anchor": "end", class: "name"});
    this.element.append(this.cursor, this.now);
  }

  alongAt(clientX) { return this.toAlong(clientX - this.element.getBoundingClientRect().left); }

  at(place) {
    const {unit, values, along} = this.curve;
    let k = 0;
    while (k + 1 < along.length && along[k + 1] <= place + 1e-9) ++k;
    this.cursor.setAttribute("x1", this.x(place)), this.cursor.setAttribute("x2", this.x(place));
    this.now.textContent = `${written(values[k])} ${unit}`;
  }
}
