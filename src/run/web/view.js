// The scene: terrain that lifts where it flows, what lies on it, and the camera.

const lineShades = {white: 0xffffff, survey: 0xe6003c, release: 0x1a1a1a, footprint: 0x0072b2, line: 0x5a5a5a};

function textureOf(pixels, nx, ny, format) {
  const texture = new THREE.DataTexture(pixels, nx, ny, format);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.generateMipmaps = false;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

/** Where a raster's pixels lie: [west, south, 1 / width, 1 / height]. */
function boxOf(grid) {
  return new THREE.Vector4(grid.x - grid.cell / 2, grid.y - grid.cell / 2, 1 / (grid.nx * grid.cell), 1 / (grid.ny * grid.cell));
}

/** The terrain as triangles; those that touch a node without a value are left out. */
function groundGeometry(ground) {
  const {nx, ny, x, y, cell, values} = ground, places = new Float32Array(3 * nx * ny);
  const corners = new Uint32Array(6 * (nx - 1) * (ny - 1));
  let used = 0;
  for (let j = 0, n = 0; j < ny; ++j)
    for (let i = 0; i < nx; ++i, ++n) {
      places[3 * n] = x + i * cell, places[3 * n + 1] = y + j * cell, places[3 * n + 2] = isNaN(values[n]) ? 0 : values[n];
      if (i + 1 === nx || j + 1 === ny) continue;
      const a = n, b = n + 1, c = n + nx, d = n + nx + 1, hole = k => isNaN(values[k]);
      if (!hole(a) && !hole(b) && !hole(d)) corners[used++] = a, corners[used++] = b, corners[used++] = d;
      if (!hole(a) && !hole(d) && !hole(c)) corners[used++] = a, corners[used++] = d, corners[used++] = c;
    }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
  geometry.setAttribute("lift", new THREE.BufferAttribute(new Float32Array(nx * ny), 1));
  geometry.setIndex(new THREE.BufferAttribute(corners.subarray(0, used), 1));
  return geometry;
}

function groundMaterial(ground) {
  const none = textureOf(new Uint8Array(4), 1, 1, THREE.RGBAFormat);
  return new THREE.ShaderMaterial({
    uniforms: {
      relief: {value: textureOf(reliefOf(ground), ground.nx, ground.ny, THREE.LuminanceFormat)}, reliefBox: {value: boxOf(ground)},
      flow: {value: none}, flowBox: {value: new THREE.Vector4(0, 0, 0, 0)}
    },
    vertexShader: `attribute float lift; varying vec2 place;
      void main() { place = position.xy;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position.xy, position.z + lift, 1.0); }`,
    fragmentShader: `uniform sampler2D relief, flow; uniform vec4 reliefBox, flowBox; varying vec2 place;
      void main() {
        vec3 colour = texture2D(relief, (place - reliefBox.xy) * reliefBox.zw).rgb * vec3(1.0, 0.985, 0.955);
        vec2 at = (place - flowBox.xy) * flowBox.zw;
        if (at.x > 0.0 && at.y > 0.0 && at.x < 1.0 && at.y < 1.0 && flowBox.z > 0.0) {
          vec4 shown = texture2D(flow, at);
          colour = colour * (1.0 - shown.a) + shown.rgb;
        }
        gl_FragColor = vec4(colour, 1.0); }`,
    side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1
  });
}

/** Walls from the terrain's edge down to a level: the model stands like a block. */
function edgeMesh(ground, level) {
  const {nx, ny, x, y, cell, values} = ground, places = [];
  const wall = (i, j, u, v) => {
    const a = values[j * nx + i], b = values[v * nx + u];
    if (isNaN(a) || isNaN(b)) return;
    const ax = x + i * cell, ay = y + j * cell, bx = x + u * cell, by = y + v * cell;
    places.push(ax, ay, a, ax, ay, level, bx, by, level, ax, ay, a, bx, by, level, bx, by, b);
  };
  for (let i = 0; i + 1 < nx; ++i) wall(i, 0, i + 1, 0), wall(i, ny - 1, i + 1, ny - 1);
  for (let j = 0; j + 1 < ny; ++j) wall(0, j, 0, j + 1), wall(nx - 1, j, nx - 1, j + 1);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
  return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({color: 0xb9aea0, side: THREE.DoubleSide}));
}

/** A strip along each piece [x, y, z, x, y, z]: four corners that the shader moves apart by a width in pixels. */
function ribbonGeometry(places) {
  const count = places.length / 6, here = new Float32Array(12 * count), there = new Float32Array(12 * count);
  const side = new Float32Array(4 * count), corners = new Uint32Array(6 * count);
  for (let k = 0; k < count; ++k) {
    const a = places.slice(6 * k, 6 * k + 3), b = places.slice(6 * k + 3, 6 * k + 6);
    here.set([...a, ...a, ...b, ...b], 12 * k), there.set([...b, ...b, ...a, ...a], 12 * k);
    side.set([1, -1, -1, 1], 4 * k);
    corners.set([0, 1, 2, 1, 3, 2].map(c => 4 * k + c), 6 * k);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(here, 3));
  geometry.setAttribute("other", new THREE.BufferAttribute(there, 3));
  geometry.setAttribute("side", new THREE.BufferAttribute(side, 1));
  geometry.setIndex(new THREE.BufferAttribute(corners, 1));
  return geometry;
}

function ribbonMaterial(shade, width, opacity, nearer, hidden) {
  return new THREE.ShaderMaterial({
    uniforms: {shade: {value: new THREE.Color(shade)}, opacity: {value: opacity}, width: {value: width},
      nearer: {value: 0.0004 * nearer}, pixels: {value: new THREE.Vector2(1, 1)}},
    vertexShader: `attribute vec3 other; attribute float side; uniform float width, nearer; uniform vec2 pixels;
      void main() {
        vec4 a = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        vec4 b = projectionMatrix * modelViewMatrix * vec4(other, 1.0);
        if (a.w <= 0.0 || b.w <= 0.0) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
        vec2 way = (b.xy / b.w - a.xy / a.w) * pixels;
        way = length(way) > 1e-6 ? normalize(way) : vec2(1.0, 0.0);
        vec2 out_of = vec2(-way.y, way.x) * side - 0.7 * way;
        gl_Position = vec4(a.xy + out_of * width / pixels * a.w, a.z - nearer * a.w, a.w); }`,
    fragmentShader: `uniform vec3 shade; uniform float opacity; void main() { gl_FragColor = vec4(shade, opacity); }`,
    transparent: opacity < 1, depthTest: !hidden, depthWrite: !hidden, side: THREE.DoubleSide
  });
}

class View {
  constructor(holder, ground) {
    this.holder = holder;
    this.ground = this.surface = ground;  // the surface is what is seen: ground, or the flow on it
    THREE.Object3D.DefaultUp.set(0, 0, 1);
    this.renderer = new THREE.WebGLRenderer({antialias: true, alpha: true, preserveDrawingBuffer: true});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    holder.insertBefore(this.renderer.domElement, holder.firstChild);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(35, 1, 1, 10);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.screenSpacePanning = true;
    this.controls.maxPolarAngle = 0.49 * Math.PI;
    this.controls.addEventListener("change", () => this.draw());
    this.lines = [];
    this.labels = [];
    this.measure();
    this.mesh = new THREE.Mesh(groundGeometry(ground), groundMaterial(ground));
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh, edgeMesh(ground, this.low - 0.03 * this.size));
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8a8378, 0.75));
    const sun = new THREE.DirectionalLight(0xffffff, 0.5);
    sun.position.set(-1, 1, 1.4);
    this.scene.add(sun);
    window.addEventListener("resize", () => this.fit());
  }

  measure() {
    const g = this.ground;
    this.low = Infinity, this.high = -Infinity, this.top = 0;  // of the ground, and the deepest flow on it
    for (const z of g.values)
      if (!isNaN(z)) this.low = Math.min(this.low, z), this.high = Math.max(this.high, z);
    if (!(this.low <= this.high)) this.low = this.high = 0;
    this.size = Math.hypot(g.nx * g.cell, g.ny * g.cell, this.high - this.low);
  }

  /** A look at places of the ground, [[x, y], ...], all of them in the picture, from the side that `towards` (x, y) runs to. */
  lookAt(places, towards) {
    const points = places.map(([x, y]) => new THREE.Vector3(x, y, valueAt(this.ground, x, y))).filter(p => !isNaN(p.z));
    if (!points.length) points.push(new THREE.Vector3(0, 0, this.low), new THREE.Vector3(this.size, this.size, this.high));
    const turn = Math.hypot(...towards) > 0 ? Math.atan2(towards[1], towards[0]) : -Math.PI / 2, up = 0.62;
    const back = new THREE.Vector3(Math.cos(up) * Math.cos(turn), Math.cos(up) * Math.sin(turn), Math.sin(up));
    const right = new THREE.Vector3(-Math.sin(turn), Math.cos(turn), 0), upwards = back.clone().cross(right);
    const box = new THREE.Box3().setFromPoints(points), target = box.getCenter(new THREE.Vector3());
    let away = 2 * Math.max(box.getSize(new THREE.Vector3()).length(), 3 * this.ground.cell);
    const half = Math.tan(this.camera.fov * Math.PI / 360), wide = half * this.camera.aspect;
    for (let n = 0; n < 8; ++n) {  // each round puts the places in the middle, and comes as near as all stay in
      let left = Infinity, most = -Infinity, low = Infinity, high = -Infinity;
      for (const point of points) {
        const way = point.clone().sub(target), depth = away - way.dot(back);
        const x = way.dot(right) / depth / wide, y = way.dot(upwards) / depth / half;
        left = Math.min(left, x), most = Math.max(most, x), low = Math.min(low, y), high = Math.max(high, y);
      }
      target.addScaledVector(right, (left + most) / 2 * away * wide).addScaledVector(upwards, (low + high) / 2 * away * half);
      away *= Math.max(0.5, Math.min(2, Math.max(most - left, high - low) / 2 / 0.86));
    }
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(back, away);
    this.controls.update();
  }

  fit() {
    const width = Math.max(50, this.holder.clientWidth), height = Math.max(50, this.holder.clientHeight);
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    for (const line of this.lines) line.material.uniforms.pixels.value.set(width, height);
    this.draw();
  }

  /** Once before the next picture of the screen, however often it is asked for. */
  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this.asked = false;
    const away = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(away / 500, 1e-4), this.camera.far = away + 3 * this.size;
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
    this.placeLabels();
    const turn = this.controls.getAzimuthalAngle();
    document.querySelector("#compass svg").style.transform = `rotate(${turn}rad)`;
  }

  /** Turns the view so that north is up. */
  northUp() {
    const target = this.controls.target, way = this.camera.position.clone().sub(target);
    const flat = Math.hypot(way.x, way.y);
    this.camera.position.set(target.x, target.y - flat, target.z + way.z);
    this.controls.update();
    this.draw();
  }

  /** Lines on the ground in a colour on a white casing; also seen, faintly, through what hides them. */
  addLines(pieces, colour, dashed) {
    let places = laidOn(this.ground, pieces, 0.0012 * this.size);
    if (dashed) places = everyOther(places, 0.012 * this.size);
    if (!places.length) return;
    const geometry = ribbonGeometry(places);
    const add = (shade, width, opacity, nearer, hidden) => {
      const mesh = new THREE.Mesh(geometry, ribbonMaterial(shade, width, opacity, nearer, hidden));
      mesh.frustumCulled = false;
      mesh.renderOrder = hidden ? 1 : nearer;
      this.lines.push(mesh);
      this.scene.add(mesh);
    };
    if (!dashed) add(lineShades.white, 3.6, 1, 2, false);
    add(colour, 1.8, 1, 3, false);
    add(colour, 1.4, 0.25, 3, true);
  }

  /** A solid between outlines, or along a line, from below the ground to its top. */
  addBarrier(barrier) {
    const material = new THREE.MeshLambertMaterial({color: 0xd9773f, side: THREE.DoubleSide});
    const add = geometry => {
      geometry.computeVertexNormals();
      this.scene.add(new THREE.Mesh(geometry, material));
    };
    if (barrier.points) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(barrier.points), 3));
      geometry.setIndex(barrier.corners);
      add(geometry.toNonIndexed());
      this.addLabel(barrier.name, barrier.points[0], barrier.points[1], barrier.points[2]);
      return;
    }
    const rings = barrier.polygons.length ? barrier.polygons : [[]];
    for (const polygon of rings) this.addPrism(barrier, polygon, add);
    if (barrier.line) this.addWall(barrier, barrier.line, false, add);
    const first = barrier.line || (barrier.polygons[0] || [[]])[0];
    if (first.length) {
      let x = 0, y = 0;
      for (let k = 0; k < first.length; k += 2) x += 2 * first[k] / first.length, y += 2 * first[k + 1] / first.length;
      this.addLabel(barrier.name, x, y, this.topOf(barrier, x, y));
    }
  }

  topOf(barrier, x, y) {
    if (barrier.level !== undefined) return barrier.level;
    const z = valueAt(this.ground, x, y);
    return (isNaN(z) ? this.low : z) + barrier.height;
  }

  addWall(barrier, ring, closed, add) {
    const places = [], pieces = piecesOf(ring, closed);
    for (let k = 0; k < pieces.length; k += 4) {
      const parts = Math.max(1, Math.min(200, Math.ceil(Math.hypot(pieces[k + 2] - pieces[k], pieces[k + 3] - pieces[k + 1]) / this.ground.cell)));
      for (let p = 0; p < parts; ++p) {
        const [a, b] = [p / parts, (p + 1) / parts].map(s => [pieces[k] + s * (pieces[k + 2] - pieces[k]),
          pieces[k + 1] + s * (pieces[k + 3] - pieces[k + 1])]);
        const at = this.topOf(barrier, ...a), bt = this.topOf(barrier, ...b);
        const foot = place => { const z = valueAt(this.ground, ...place); return (isNaN(z) ? this.low : z) - this.ground.cell; };
        const af = Math.min(at, foot(a)), bf = Math.min(bt, foot(b));
        places.push(...a, af, ...b, bf, ...b, bt, ...a, af, ...b, bt, ...a, at);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    add(geometry);
  }

  addPrism(barrier, polygon, add) {
    if (!polygon.length) return;
    const contour = ring => { const points = []; for (let k = 0; k < ring.length; k += 2) points.push(new THREE.Vector2(ring[k], ring[k + 1])); return points; };
    for (const ring of polygon) this.addWall(barrier, ring, true, add);
    const outer = contour(polygon[0]), holes = polygon.slice(1).map(contour);
    const points = outer.concat(...holes), places = [];
    for (const face of THREE.ShapeUtils.triangulateShape(outer, holes))
      for (const corner of face) places.push(points[corner].x, points[corner].y, this.topOf(barrier, points[corner].x, points[corner].y));
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    add(geometry);
  }

  /** A pin with a name; returns what moveLabel() takes. */
  addLabel(name, x, y, z) {
    const element = document.createElement("span");
    element.textContent = name;
    document.getElementById("labels").append(element);
    const label = {element, place: new THREE.Vector3(x, y, z)};
    this.labels.push(label);
    return label;
  }

  /** A label that stands on the surface, also when that rises. */
  addPin(name, x, y) {
    const z = valueAt(this.surface, x, y);
    if (isNaN(z)) return null;
    const label = this.addLabel(name, x, y, z);
    label.element.classList.add("pin");
    label.pinned = true;
    return label;
  }

  /** In shares of the picture, so that they stay where they belong on paper. */
  placeLabels() {
    for (const label of this.labels) {
      const at = label.place.clone().project(this.camera);
      label.element.hidden = at.z > 1;
      label.element.style.left = `${50 * (at.x + 1)}%`;
      label.element.style.top = `${50 * (1 - at.y)}%`;
    }
  }

  /** Colours `raster` on the ground: pixels of pixelsOf(). Null: nothing. */
  show(raster, pixels) {
    const uniforms = this.mesh.material.uniforms, old = uniforms.flow.value;
    if (raster) uniforms.flow.value = textureOf(pixels, raster.nx, raster.ny, THREE.RGBAFormat), uniforms.flowBox.value = boxOf(raster);
    else uniforms.flowBox.value = new THREE.Vector4(0, 0, 0, 0);
    if (raster && old) old.dispose();
  }

  /** Raises the surface by a depth; null: back to the ground. */
  lift(depth) {
    const g = this.ground, attribute = this.mesh.geometry.attributes.lift, lifts = attribute.array;
    if (!depth && this.surface === g) return;
    lifts.fill(0);
    this.top = 0;
    if (depth) {
      const first = (low, cell, from) => Math.max(0, Math.ceil((from - low) / cell));
      const west = depth.x - depth.cell / 2, south = depth.y - depth.cell / 2;
      const i1 = Math.min(g.nx - 1, Math.floor((west + depth.nx * depth.cell - g.x) / g.cell));
      const j1 = Math.min(g.ny - 1, Math.floor((south + depth.ny * depth.cell - g.y) / g.cell));
      for (let j = first(g.y, g.cell, south); j <= j1; ++j)
        for (let i = first(g.x, g.cell, west); i <= i1; ++i) {
          const lift = valueAt(depth, g.x + i * g.cell, g.y + j * g.cell) || 0;
          lifts[j * g.nx + i] = lift, this.top = Math.max(this.top, lift);
        }
    }
    attribute.needsUpdate = true;
    this.surface = depth ? {...g, values: g.values.map((z, n) => z + lifts[n])} : g;
    for (const label of this.labels)
      if (label.pinned) label.place.z = valueAt(this.surface, label.place.x, label.place.y);
  }

  /** The place [x, y] of the surface under a point of the window, or null: along the ray until it is below the surface. */
  under(clientX, clientY) {
    const frame = this.renderer.domElement.getBoundingClientRect(), g = this.ground;
    const pointer = new THREE.Vector2(2 * (clientX - frame.left) / frame.width - 1, 1 - 2 * (clientY - frame.top) / frame.height);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(pointer, this.camera);
    const {origin, direction} = caster.ray, step = Math.max(g.cell, this.size / 4000) / 2;
    const at = s => [origin.x + s * direction.x, origin.y + s * direction.y, origin.z + s * direction.z];
    const above = s => { const [x, y, z] = at(s); return z - valueAt(this.surface, x, y); };
    let s = direction.z < 0 ? Math.max(0, (this.high + this.top - origin.z) / direction.z) : 0;
    for (const end = s + 4 * this.size + this.camera.position.length(); s < end; s += step) {
      if (!(above(s) <= 0)) continue;
      let low = s - step, high = s;
      for (let n = 0; n < 12; ++n) above((low + high) / 2) > 0 ? low = (low + high) / 2 : high = (low + high) / 2;
      return at(high).slice(0, 2);
    }
    return null;
  }
}
