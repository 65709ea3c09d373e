// Lines on the ground: outlines of what is deeper than a level, and lines that are given.

/** Pieces [x, y, x, y, ...], four numbers each, of the lines where a raster has a level (marching squares). */
function levelLines(raster, level) {
  const {nx, ny, x, y, cell, values} = raster, pieces = [];
  const value = (i, j) => i < 0 || j < 0 || i >= nx || j >= ny || isNaN(values[j * nx + i]) ? 0 : values[j * nx + i];
  for (let j = -1; j < ny; ++j)
    for (let i = -1; i < nx; ++i) {
      const corners = [value(i, j), value(i + 1, j), value(i + 1, j + 1), value(i, j + 1)], cuts = [];
      for (let k = 0; k < 4; ++k) {
        const a = corners[k], b = corners[(k + 1) % 4];
        if ((a > level) === (b > level)) continue;
        const s = Math.max(0, Math.min(1, (level - a) / (b - a)));
        const u = k === 0 ? s : k === 1 ? 1 : k === 2 ? 1 - s : 0, v = k === 0 ? 0 : k === 1 ? s : k === 2 ? 1 : 1 - s;
        cuts.push(x + (i + u) * cell, y + (j + v) * cell);
      }
      for (let k = 0; k + 3 < cuts.length; k += 4) pieces.push(cuts[k], cuts[k + 1], cuts[k + 2], cuts[k + 3]);
    }
  return pieces;
}

/** The same of a line of points [x, y, x, y, ...]. */
function piecesOf(line, closed) {
  const pieces = [];
  for (let k = 0; k + 3 < line.length; k += 2) pieces.push(line[k], line[k + 1], line[k + 2], line[k + 3]);
  const n = line.length;
  if (closed && n > 4) pieces.push(line[n - 2], line[n - 1], line[0], line[1]);
  return pieces;
}

/** Pieces laid on the ground, in parts no longer than its cells: [x, y, z, x, y, z, ...]. */
function laidOn(ground, pieces, above) {
  const places = [];
  for (let k = 0; k < pieces.length; k += 4) {
    const [ax, ay, bx, by] = pieces.slice(k, k + 4);
    const parts = Math.max(1, Math.min(1000, Math.ceil(Math.hypot(bx - ax, by - ay) / ground.cell)));
    for (let p = 0; p < parts; ++p) {
      const ends = [p / parts, (p + 1) / parts].map(s => {
        const x = ax + s * (bx - ax), y = ay + s * (by - ay);
        return [x, y, valueAt(ground, x, y) + above];
      });
      if (!isNaN(ends[0][2]) && !isNaN(ends[1][2])) places.push(...ends[0], ...ends[1]);
    }
  }
  return places;
}

/** Of pieces that follow one another those in every other stretch of a length: dashes. */
function everyOther(places, length) {
  const kept = [];
  let sum = 0;
  for (let k = 0; k < places.length; k += 6) {
    if (Math.floor(sum / length) % 2 === 0) kept.push(...places.slice(k, k + 6));
    sum += Math.hypot(places[k + 3] - places[k], places[k + 4] - places[k + 1]);
  }
  return kept;
}
