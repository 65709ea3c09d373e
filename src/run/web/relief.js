// Light on surfaces, and colours of values: pixels of the textures.

/** Four lamps 45 degrees high, as in vtk_io/hillshade.h: [azimuth in degrees, weight]. */
const lamps = [[315, 0.5], [270, 0.2], [360, 0.2], [225, 0.1]].map(([azimuth, weight]) => {
  const turn = azimuth * Math.PI / 180, half = Math.SQRT1_2;
  return {x: half * Math.sin(turn), y: half * Math.cos(turn), z: half, weight};
});

/** Light from 0 to 1 on a surface that rises by gx to the east and gy to the north. */
function lightOn(gx, gy) {
  const length = Math.sqrt(gx * gx + gy * gy + 1);
  let light = 0;
  for (let k = 0; k < lamps.length; ++k) light += lamps[k].weight * Math.max(0, lamps[k].z - gx * lamps[k].x - gy * lamps[k].y);
  return light / length;
}

/** Change of z from one neighbour of node n to the other, per cell; a neighbour that is not there, or has no value, is n. */
function changeAt(z, n, before, after, cell) {
  const a = before < 0 || z[before] !== z[before] ? n : before, b = after < 0 || z[after] !== z[after] ? n : after;
  return a === b ? 0 : (z[b] - z[a]) / (a !== n && b !== n ? 2 * cell : cell);
}
const eastward = (z, nx, ny, i, j, cell) => changeAt(z, j * nx + i, i > 0 ? j * nx + i - 1 : -1, i + 1 < nx ? j * nx + i + 1 : -1, cell);
const northward = (z, nx, ny, i, j, cell) => changeAt(z, j * nx + i, j > 0 ? (j - 1) * nx + i : -1, j + 1 < ny ? (j + 1) * nx + i : -1, cell);

/** Grey of each node, 255 white. Gentle terrain is shaded as if it were steeper; heights stay what they are. */
function reliefOf(raster) {
  const {nx, ny, cell, values} = raster, slopes = new Float32Array(2 * nx * ny);
  let sum = 0, count = 0;
  for (let j = 0, n = 0; j < ny; ++j)
    for (let i = 0; i < nx; ++i, ++n) {
      if (isNaN(values[n])) continue;
      const gx = eastward(values, nx, ny, i, j, cell), gy = northward(values, nx, ny, i, j, cell);
      slopes[2 * n] = gx, slopes[2 * n + 1] = gy;
      sum += Math.sqrt(gx * gx + gy * gy), ++count;
    }
  const steeper = Math.max(1, Math.min(5, 0.6 / Math.max(1e-6, sum / Math.max(1, count))));
  const light = new Float32Array(nx * ny), stride = Math.max(7, Math.ceil(nx * ny / 20000)), some = [];
  for (let n = 0; n < nx * ny; ++n) {
    light[n] = isNaN(values[n]) ? NaN : lightOn(steeper * slopes[2 * n], steeper * slopes[2 * n + 1]);
    if (n % stride === 0 && !isNaN(light[n])) some.push(light[n]);
  }
  const sorted = Float32Array.from(some).sort();  // numbers sort as numbers, without a function
  const at = share => sorted[Math.floor(share * (sorted.length - 1))] ?? 0.7;
  const middle = at(0.5), span = Math.max(0.35, at(0.99) - at(0.01));
  const grey = new Uint8Array(nx * ny);
  for (let n = 0; n < nx * ny; ++n)
    grey[n] = isNaN(light[n]) ? 226 : 255 * Math.max(0.38, Math.min(0.98, 0.78 + 0.6 * (light[n] - middle) / span));
  return grey;
}

/** [r, g, b] of a share of a scale. */
function colourOf(colours, share) {
  const place = Math.max(0, Math.min(1, share)) * (colours.length - 1), k = Math.min(colours.length - 2, Math.floor(place));
  return colours[k].map((c, n) => c + (place - k) * (colours[k + 1][n] - c));
}

/**
 * Pixels of `values` in the scale's colours, red, green and blue times opacity. `shown(n)` says where; `light(i, j)` is a little
 * below 1 on level ground.
 */
function pixelsOf(raster, scale, shown, light) {
  const {nx, ny, values} = raster, pixels = new Uint8Array(4 * nx * ny), opacity = 0.92;
  const table = [];
  for (let k = 0; k <= 255; ++k) table.push(colourOf(scale.colours, k / 255));
  for (let j = 0, n = 0; j < ny; ++j)
    for (let i = 0; i < nx; ++i, ++n) {
      if (!shown(n)) continue;
      const share = (values[n] - scale.from) / (scale.to - scale.from);
      const colour = table[Math.max(0, Math.min(255, Math.round(255 * share)))], bright = light(i, j) * opacity;
      for (let c = 0; c < 3; ++c) pixels[4 * n + c] = Math.min(255 * opacity, bright * colour[c]);
      pixels[4 * n + 3] = 255 * opacity;
    }
  return pixels;
}
