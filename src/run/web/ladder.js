// What the runs of an ensemble say of each place: how likely more than a threshold is. A row of a table belongs to a place: a
// pixel of data.runs.reached that has a value, in their order.

class Ladder {
  /** `packed` is one of data.runs.ladders, `reached` the raster of data.runs.reached. */
  static async of(packed, reached) {
    const [probabilities, quantiles] = await Promise.all([rasterOf(packed.probabilities), rasterOf(packed.quantiles)]);
    return new Ladder(packed, reached, probabilities.values, quantiles.values);
  }

  constructor({thresholds}, reached, probabilities, quantiles) {
    Object.assign(this, {thresholds, reached, probabilities, quantiles});
    let count = 0;
    this.rows = Int32Array.from(reached.values, value => isNaN(value) ? -1 : count++);
  }

  /** A raster [%]: how likely more than the k-th threshold is; NaN where no run comes. */
  above(k) {
    const rows = this.rows, width = this.thresholds.length, values = new Float32Array(rows.length);
    for (let n = 0; n < rows.length; ++n) values[n] = rows[n] < 0 ? NaN : 100 * this.probabilities[rows[n] * width + k];
    return {...this.reached, values};
  }

  /** The same at a place for all thresholds; nothing where no run comes. */
  curveAt(x, y) {
    return this.rowOf(this.probabilities, this.thresholds.length, x, y).map(share => 100 * share);
  }

  /** What each of data.runs.shares of the runs does not exceed; nothing where no run comes. */
  quantilesAt(x, y) { return this.rowOf(this.quantiles, data.runs.shares.length, x, y); }

  rowOf(table, width, x, y) {
    const row = nearestValue({...this.reached, values: this.rows}, x, y);
    return row >= 0 ? Array.from(table.subarray(row * width, (row + 1) * width)) : [];
  }

  /** Area [m2] where more than each threshold has a probability above `share`. What is equal to it may be a rounding error off. */
  areas(share) {
    const width = this.thresholds.length, areas = new Array(width).fill(0), pixel = this.reached.cell ** 2;
    this.probabilities.forEach((probability, n) => { if (probability > share + 1e-6) areas[n % width] += pixel; });
    return areas;
  }
}

/** 95 % bounds of a probability that was found as p in n independent runs: wilson_bounds() of src/ensemble/statistics.h. */
function wilson(p, n) {
  if (!(n > 0)) return [0, 1];
  const z = 1.959963984540054, z2 = z * z / n, middle = (p + z2 / 2) / (1 + z2);
  const half = z / (1 + z2) * Math.sqrt((p * (1 - p) + z2 / 4) / n);
  return [Math.max(0, Math.min(p, middle - half)), Math.min(1, Math.max(p, middle + half))];
}
