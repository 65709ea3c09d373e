"use strict";
// The page's data: what run/web/packed.h makes small is made large again here.

const data = JSON.parse(document.getElementById("data").textContent);

/** Bytes behind base64 of zlib's format. */
async function bytesOf(text) {
  const packed = atob(text), bytes = new Uint8Array(packed.length);
  for (let n = 0; n < packed.length; ++n) bytes[n] = packed.charCodeAt(n);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Runs three.js, which travels as small as the data do. */
async function loadThree() {
  const script = document.createElement("script");
  script.textContent = new TextDecoder().decode(await bytesOf(document.getElementById("three").textContent));
  document.head.append(script);
}

/** A raster {nx, ny, x, y, cell, values}: x, y of its south-west node, rows to the north, NaN without a value. */
async function rasterOf(packed) {
  const bytes = await bytesOf(packed.values), nx = packed.nx, count = nx * packed.ny;
  const codes = new Uint16Array(count), values = new Float32Array(count);
  for (let n = 0, i = 0; n < count; ++n, i = i + 1 === nx ? 0 : i + 1) {
    const kept = 256 * bytes[n] + bytes[count + n];
    const west = i > 0 ? codes[n - 1] : 0, south = n >= nx ? codes[n - nx] : 0;
    const corner = i > 0 && n >= nx ? codes[n - nx - 1] : 0;
    codes[n] = (kept & 1 ? ~(kept >> 1) : kept >> 1) + west + south - corner;
    values[n] = codes[n] > 0 ? packed.low + packed.step * (codes[n] - 1) : NaN;
  }
  return {nx, ny: packed.ny, x: packed.x, y: packed.y, cell: packed.cell, values};
}

/** Values of bytes that were rounded up; each stands in the middle of what it may mean. */
function valuesOf(bytes, first, count, top, steps) {
  const table = new Float32Array(256), values = new Float32Array(count);
  for (let b = 1; b < 256; ++b) table[b] = top * ((b - 0.5) / steps) ** 2;
  for (let n = 0; n < count; ++n) values[n] = table[bytes[first + n]];
  return values;
}

/** Depth and speed (or null) of frame k as rasters; null where nothing is wet. */
async function flowOf(k) {
  const frame = data.frames[k];
  if (!frame || !frame.grid) return null;
  const bytes = await bytesOf(frame.values), grid = frame.grid, count = grid.nx * grid.ny;
  return {
    depth: {...grid, values: valuesOf(bytes, 0, count, frame.deepest, 255)},
    speed: frame.fastest === undefined ? null : {...grid, values: valuesOf(bytes, count, count, frame.fastest, 63)}
  };
}

/** Between the four nodes around a place, NaN beyond them or beside one without a value. */
function valueAt(raster, x, y) {
  const u = (x - raster.x) / raster.cell, v = (y - raster.y) / raster.cell;
  if (!(u >= -0.5 && v >= -0.5 && u <= raster.nx - 0.5 && v <= raster.ny - 0.5)) return NaN;
  const i = Math.max(0, Math.min(raster.nx - 2, Math.floor(u))), j = Math.max(0, Math.min(raster.ny - 2, Math.floor(v)));
  const a = Math.max(0, Math.min(1, u - i)), b = Math.max(0, Math.min(1, v - j));
  const i1 = Math.min(i + 1, raster.nx - 1), j1 = Math.min(j + 1, raster.ny - 1), z = raster.values;
  const share = (weight, k) => weight > 0 ? weight * z[k] : 0;  // no data beside a node is nothing to the node
  return share((1 - b) * (1 - a), j * raster.nx + i) + share((1 - b) * a, j * raster.nx + i1) +
      share(b * (1 - a), j1 * raster.nx + i) + share(b * a, j1 * raster.nx + i1);
}

/** The value of the nearest node. */
function nearestValue(raster, x, y) {
  const i = Math.round((x - raster.x) / raster.cell), j = Math.round((y - raster.y) / raster.cell);
  return i < 0 || j < 0 || i >= raster.nx || j >= raster.ny ? NaN : raster.values[j * raster.nx + i];
}
