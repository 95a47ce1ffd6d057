"use strict";
// Draws a run: its data are the JSON in #data, base64 of float32 (columns, paths) and int16 (marks).
const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const floats = (text) => new Float32Array(bytes(text));
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const column = {};
for (const name in data.columns) column[name] = floats(data.columns[name]);
const times = column.t;
const paths = data.paths.map((p) => ({ name: p.name, t: floats(p.t), p: floats(p.p), q: floats(p.q) }));
const marks = {
  t: floats(data.marks.t), centre: floats(data.marks.centre), first: new Uint32Array(bytes(data.marks.first)),
  values: new Int16Array(bytes(data.marks.values)), labels: new Uint8Array(bytes(data.marks.labels)),
};
const main = paths[0] || { t: new Float32Array(), p: new Float32Array(), q: new Float32Array() };
const begin = times.length ? times[0] : 0;
const end = times.length ? times[times.length - 1] : 1;
const listeners = []; // of the cursor
let cursor = begin;

/** Index of the last of sorted values that is not above t. */
function before(values, t) {
  let low = 0;
  let high = values.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (values[middle] <= t + 1e-4) low = middle;
    else high = middle - 1;
  }
  return low;
}
function moveTo(t) {
  cursor = Math.min(end, Math.max(begin, t));
  $("cursor").value = cursor;
  for (const listener of listeners) listener(cursor);
}
function element(parent, tag, name, text) {
  const e = parent.appendChild(document.createElement(tag));
  if (name) e.className = name;
  if (text) e.textContent = text;
  return e;
}

// ---- theme and cursor
const wantsDark = matchMedia("(prefers-color-scheme: dark)");
let dark = wantsDark.matches;
const themed = []; // called when the colours change
function setTheme(isDark) {
  document.documentElement.classList.toggle("dark", isDark);
  for (const redraw of themed) redraw();
}
document.documentElement.classList.toggle("dark", dark);
$("theme").onclick = () => setTheme((dark = !dark));
wantsDark.onchange = () => setTheme((dark = wantsDark.matches));
Object.assign($("cursor"), { min: begin, max: end, value: begin });
$("cursor").oninput = (e) => moveTo(+e.target.value);
$("time").hidden = times.length === 0;
let playing = 0;
function play(last) {
  const now = performance.now();
  if (cursor >= end) moveTo(begin);
  moveTo(cursor + (now - last) / 1000);
  playing = cursor < end ? requestAnimationFrame(() => play(now)) : 0;
  $("play").textContent = playing ? "❚❚" : "▶";
}
$("play").onclick = () => {
  if (!playing) return play(performance.now());
  cancelAnimationFrame(playing);
  playing = 0;
  $("play").textContent = "▶";
};
listeners.push((t) => {
  const row = before(times, t);
  const at = (name) => column[name][row].toFixed(2).replace(/^-(0\.0+)$/, "$1");
  $("now").textContent = `${t.toFixed(2)} s` +
    (column["p.x"] ? `   position ${at("p.x")} ${at("p.y")} ${at("p.z")} m   speed ${at("speed")} m/s` : "");
});

// ---- events
let shown = [begin, end]; // times in view
function placeEvents() {
  const span = Math.max(1e-6, shown[1] - shown[0]);
  for (const button of $("strip").children) button.style.left = `${(100 * (button.t - shown[0])) / span}%`;
}
$("happened").hidden = data.events.length === 0;
for (const event of data.events) {
  const text = `${event.t.toFixed(2)} s: ${event.text}`;
  for (const place of [$("strip"), element($("events"), "li")]) {
    const button = element(place, "button", event.serious ? "serious" : "");
    if (place === $("strip")) button.setAttribute("aria-label", text);
    else button.textContent = text;
    Object.assign(button, { t: event.t, title: text, onclick: () => moveTo(event.t) });
  }
}
placeEvents();

// ---- series
const graphs = [];
const dashes = [null, [7, 3], [2, 2], [9, 3, 2, 3], [12, 4], [4, 4]];
const colours = () => ["x", "y", "z", "w", "ink", "soft"].map(style);
let zooming = false;
function zoomTo(range, from) {
  if (zooming || (range[0] === shown[0] && range[1] === shown[1])) return;
  zooming = true;
  shown = range;
  for (const graph of graphs) if (graph !== from) graph.updateOptions({ dateWindow: range });
  placeEvents();
  zooming = false;
  moveTo(cursor);
}
function number(value) {
  const size = Math.abs(value);
  if (value === 0) return "0";
  return size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(+value.toPrecision(4));
}
function rowsOf(plot) {
  const curves = plot.curves.map((c) => ({ ...c, v: column[c.value], s: column[c.sigma], l: column[c.low], h: column[c.high] }));
  const banded = curves.some((c) => c.s || c.l);
  const rows = [];
  for (let i = 0; i < times.length; ++i) {
    const row = [times[i]];
    for (const c of curves) {
      const v = c.v[i];
      if (Number.isNaN(v)) row.push(banded ? [null, null, null] : null);
      else if (!banded) row.push(v);
      else if (c.l) row.push([c.l[i], v, c.h[i]]);
      else if (c.s) row.push(c.zero ? [-3 * c.s[i], v, 3 * c.s[i]] : [v - 3 * c.s[i], v, v + 3 * c.s[i]]);
      else row.push([v, v, v]);
    }
    rows.push(row);
  }
  return [rows, banded];
}
/** A graph under its title: its place on the page, and itself. */
function graphOf(title, note, rows, xAxis, more) {
  const box = element($("series"), "div", "plot");
  element(box, "h3", "", title);
  element(box, "p", "note", note);
  const labelsDiv = element(box, "div", "legend");
  const area = element(box, "div", "area");
  area.tabIndex = 0;
  area.setAttribute("role", "img");
  area.setAttribute("aria-label", `${title}. ${note} Arrow keys move the cursor, plus and minus zoom, 0 shows all.`);
  const coloured = () => ({ colors: colours(), gridLineColor: style("line"), axisLineColor: style("line") });
  const graph = new Dygraph(area, rows, {
    ...coloured(), legend: "always", labelsDiv, strokeWidth: 1.3, axisLabelFontSize: 12, gridLineWidth: 0.5,
    labelsKMB: false, highlightCircleSize: 3, rightGap: 8, fillAlpha: 0.16,
    axes: { x: xAxis, y: { axisLabelWidth: 56, axisLabelFormatter: number, valueFormatter: number } }, ...more,
  });
  themed.push(() => graph.updateOptions(coloured()));
  return { box, area, graph };
}
/** Straight lines over a plot, each from one point to another, in pixels. */
function rule(ctx, colour, dash, ends) {
  ctx.strokeStyle = style(colour);
  ctx.setLineDash(dash);
  for (const [x0, y0, x1, y1] of ends) {
    ctx.beginPath();
    ctx.moveTo(x0, y0);
    ctx.lineTo(x1, y1);
    ctx.stroke();
  }
  ctx.setLineDash([]);
}
function drawPlot(plot) {
  const [rows, banded] = rowsOf(plot);
  const names = plot.curves.map((c) => c.label);
  const series = {};
  names.forEach((name, i) => (series[name] = { strokePattern: dashes[i % dashes.length] }));
  const xAxis = { axisLabelFormatter: (t) => `${+t.toPrecision(7)}`, valueFormatter: (t) => `${t.toFixed(2)} s` };
  const { box, area, graph } = graphOf(plot.title, plot.note, rows, xAxis, {
    labels: ["t", ...names], customBars: banded, series, stepPlot: plot.steps, dateWindow: shown,
    underlayCallback: (ctx, { x, w }, g) => rule(ctx, "soft", [3, 3],
      plot.lines.map((y) => g.toDomYCoord(y)).map((at) => [x, at, x + w, at])),
    drawCallback: (g, initial) => { if (!initial) zoomTo(g.xAxisRange(), g); },
    clickCallback: (e, x) => moveTo(x),
    highlightCallback: (e, x) => { if (!playing && !e.buttons) moveTo(x); },
    unhighlightCallback: () => moveTo(cursor),
  });
  const hair = element(box, "div", "hair");
  graphs.push(graph);
  const place = (t) => {
    const area_ = graph.getArea();
    const [from, to] = graph.xAxisRange();
    hair.hidden = t < from || t > to;
    hair.style.cssText = `left:${graph.toDomXCoord(t) + area.offsetLeft}px;top:${area.offsetTop + area_.y}px;height:${area_.h}px`;
    graph.setSelection(before(times, t));
  };
  listeners.push(place);
  area.onkeydown = (e) => {
    const step = (shown[1] - shown[0]) / 100;
    const zoom = (factor) => zoomTo([cursor - (cursor - shown[0]) * factor, cursor + (shown[1] - cursor) * factor]);
    const act = { ArrowLeft: () => moveTo(cursor - step), ArrowRight: () => moveTo(cursor + step),
      "+": () => zoom(0.5), "-": () => zoom(2), 0: () => zoomTo([begin, end]) }[e.key];
    if (act) { act(); e.preventDefault(); }
  };
  place(cursor);
}
function drawHistogram(h) {
  const rows = h.counts.map((count, i) => [h.first + i * h.width, count]);
  rows.push([h.first + h.counts.length * h.width, 0]);
  graphOf(h.title, h.note, rows, {}, {
    labels: ["range rate", "points"], stepPlot: true, fillGraph: true, includeZero: true,
    underlayCallback: (ctx, { y, h: height }, g) => rule(ctx, "bad", [],
      h.lines.map((x) => g.toDomXCoord(x)).map((at) => [at, y, at, y + height])),
  });
}
const toDraw = [];
if (typeof Dygraph !== "undefined") {
  let group = "";
  for (const plot of data.plots) {
    toDraw.push(() => {
      if (plot.group !== group) element($("series"), "h2", "", (group = plot.group));
      drawPlot(plot);
    });
  }
  for (const h of data.histograms) toDraw.push(() => drawHistogram(h));
}
function drawSome(deadline) {
  while (toDraw.length && (!deadline || deadline.timeRemaining() > 8 || deadline.didTimeout)) toDraw.shift()();
  if (toDraw.length) requestIdleCallback(drawSome, { timeout: 50 });
  else document.documentElement.dataset.drawn = "yes";
}
$("whole").onclick = () => {
  zoomTo([begin, end]);
  for (const graph of graphs) if (graph.isZoomed("y")) graph.updateOptions({ valueRange: null });
};
$("folded").textContent = (data.every > 1
  ? `Series are drawn by the smallest and the largest value of every ${data.every} scans. ` : "") +
  (data.marks.stride > 1 ? `The points of one scan in ${data.marks.stride} are kept.` : "");

// ---- paths and points
function startScene() {
  const canvas = $("view");
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  } catch (e) {
    $("scene").hidden = false;
    $("scene-note").textContent = "This browser has no WebGL: no paths and points.";
    canvas.hidden = true;
    return;
  }
  $("scene").hidden = false;
  const scene = new THREE.Scene();
  const box = new THREE.Box3();
  const at = (p, i) => new THREE.Vector3(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
  const geometryOf = (positions) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
    return geometry;
  };
  function add(object) { // is drawn wherever the camera looks
    object.frustumCulled = false;
    scene.add(object);
    return object;
  }
  const lines = paths.map((path, k) => {
    for (let i = 0; i < path.t.length; ++i) box.expandByPoint(at(path.p, i));
    const line = add(new THREE.Line(geometryOf(path.p), new THREE.LineBasicMaterial()));
    line.renderOrder = k === 0 ? 1 : 0;
    if (k === 0) { // lines are a pixel wide: dots make the first one thicker
      const between = Math.max(1, Math.ceil(8000 / path.t.length)); // as close as the pixels of a line
      const places = [];
      for (let i = 0; i + 1 < path.t.length; ++i) {
        for (let k = 0; k < between; ++k) places.push(...at(path.p, i).lerp(at(path.p, i + 1), k / between).toArray());
      }
      const dots = add(new THREE.Points(geometryOf(places), new THREE.PointsMaterial({ size: 2, sizeAttenuation: false })));
      dots.material.color = line.material.color;
    }
    return line;
  });
  const size = Math.max(1, box.getSize(new THREE.Vector3()).length());
  const centre = box.getCenter(new THREE.Vector3());

  // markers: one shape for each label, so that they are told apart without colour
  const shapes = ["ring", "disc", "square", "triangle", "cross", "bar", "diamond"];
  function shape(name, side = 64) {
    const c = Object.assign(document.createElement("canvas"), { width: side, height: side });
    const g = c.getContext("2d");
    g.scale(side / 64, side / 64);
    g.fillStyle = g.strokeStyle = "#fff";
    g.lineWidth = 10;
    g.beginPath();
    if (name === "ring") g.arc(32, 32, 22, 0, 7);
    if (name === "disc") g.arc(32, 32, 26, 0, 7);
    if (name === "square") g.rect(10, 10, 44, 44);
    if (name === "triangle") { g.moveTo(32, 6); g.lineTo(60, 56); g.lineTo(4, 56); g.closePath(); }
    if (name === "diamond") { g.moveTo(32, 2); g.lineTo(62, 32); g.lineTo(32, 62); g.lineTo(2, 32); g.closePath(); }
    if (name === "cross") { g.moveTo(10, 10); g.lineTo(54, 54); g.moveTo(54, 10); g.lineTo(10, 54); }
    if (name === "bar") { g.moveTo(8, 32); g.lineTo(56, 32); }
    if (["ring", "cross", "bar", "diamond"].includes(name)) g.stroke();
    else g.fill();
    return c;
  }
  const tint = () => ["soft", "x", "z", "w", "y", "soft", "ink"].map((n) => new THREE.Color(style(n)));
  const clouds = shapes.map((name, i) => {
    const material = new THREE.PointsMaterial({
      size: name === "diamond" ? 13 : 9, sizeAttenuation: false, vertexColors: THREE.VertexColors,
      map: new THREE.CanvasTexture(shape(name)), alphaTest: 0.4, transparent: true,
    });
    return add(new THREE.Points(new THREE.BufferGeometry(), material));
  });
  function residualColour(r) { // blue: approaches too fast, grey: fits, orange: recedes too fast
    const share = Math.max(-1, Math.min(1, r / 0.3));
    const target = new THREE.Color(style(share < 0 ? "x" : "y"));
    return new THREE.Color(style("soft")).lerp(target, Math.abs(share));
  }
  function showPoints(t) {
    const scan = before(marks.t, t);
    const positions = shapes.map(() => []);
    const tints = shapes.map(() => []);
    const byLabel = tint();
    if (marks.t.length) {
      const last = scan + 1 < marks.t.length ? marks.first[scan + 1] : marks.labels.length;
      for (let i = marks.first[scan]; i < last; ++i) {
        const label = marks.labels[i];
        for (let k = 0; k < 3; ++k) positions[label].push(marks.centre[3 * scan + k] + marks.values[4 * i + k] / 100);
        const c = label < 6 && $("colour").value === "residual" ? residualColour(marks.values[4 * i + 3] / 1000) : byLabel[label];
        tints[label].push(c.r, c.g, c.b);
      }
    }
    clouds.forEach((cloud, i) => {
      cloud.geometry.dispose();
      cloud.geometry = geometryOf(positions[i]);
      cloud.geometry.setAttribute("color", new THREE.Float32BufferAttribute(tints[i], 3));
    });
  }

  // serious events on the path
  const serious = [];
  for (const event of data.events) if (event.serious && main.t.length) serious.push(...at(main.p, before(main.t, event.t)).toArray());
  const bad = add(new THREE.Points(geometryOf(serious), new THREE.PointsMaterial({
    size: 16, sizeAttenuation: false, map: new THREE.CanvasTexture(shape("ring")), alphaTest: 0.4, transparent: true })));

  // the body at the cursor: its axes, forward the longest
  const body = new THREE.Group();
  for (const [direction, name, length] of [[[1, 0, 0], "y", 1], [[0, 1, 0], "z", 0.5], [[0, 0, 1], "x", 0.5]]) {
    const arrow = new THREE.ArrowHelper(new THREE.Vector3(...direction), new THREE.Vector3(), length * size * 0.06);
    arrow.name = name;
    body.add(arrow);
  }
  scene.add(body);

  // a grid whose lines are a round number apart, on the ground of the path
  const spacing = [1, 2, 5, 10].map((s) => s * 10 ** Math.floor(Math.log10(size / 10))).find((s) => size / s <= 12);
  const count = 2 * Math.ceil(size / spacing);
  let grid;
  function makeGrid() {
    if (grid) scene.remove(grid);
    grid = new THREE.GridHelper(count * spacing, count, style("line"), style("line"));
    grid.rotation.x = Math.PI / 2;
    grid.position.set(Math.round(centre.x / spacing) * spacing, Math.round(centre.y / spacing) * spacing, box.min.z);
    scene.add(grid);
  }

  const flat = () => new THREE.OrthographicCamera(-1, 1, 1, -1, -10 * size, 10 * size);
  const views = [
    { camera: flat(), name: "plan: x right, y up", from: [0, 0, 1], area: [0, 0.34, 0.5, 0.66] },
    { camera: flat(), name: "side: x right, z up", from: [0, -1, 0], area: [0, 0, 0.5, 0.34] },
    { camera: new THREE.PerspectiveCamera(45, 1, size / 1000, 50 * size), name: "3-D", from: [-0.7, -1, 0.8], area: [0.5, 0, 0.5, 1] },
  ];
  for (const view of views.slice(1)) view.camera.up.set(0, 0, 1);
  views[2].camera.position.copy(centre).addScaledVector(new THREE.Vector3(...views[2].from).normalize(), 1.15 * size);
  const controls = new THREE.OrbitControls(views[2].camera, canvas);
  controls.target.copy(centre);
  controls.enableKeys = false;
  controls.update();

  let scheduled = false;
  function draw() {
    scheduled = false;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    if (!width) return;
    renderer.setPixelRatio(devicePixelRatio);
    renderer.setSize(width, height, false);
    renderer.setScissorTest(false);
    renderer.setClearColor(style("line"));
    renderer.clear();
    renderer.setClearColor(style("ground"));
    renderer.setScissorTest(true);
    const target = $("follow").checked ? body.position : centre;
    const extent = box.getSize(new THREE.Vector3());
    for (const view of views) {
      const [x, y, w, h] = [view.area[0] * width, view.area[1] * height, view.area[2] * width, view.area[3] * height];
      renderer.setViewport(x + 1, y + 1, w - 2, h - 2);
      renderer.setScissor(x + 1, y + 1, w - 2, h - 2);
      if (view.camera.isOrthographicCamera) {
        const side = view.from[1] !== 0;
        const wide = Math.max(extent.x, ((side ? extent.z : extent.y) * w) / h, 0.3 * size) * 0.62;
        Object.assign(view.camera, { left: -wide, right: wide, top: (wide * h) / w, bottom: (-wide * h) / w });
        view.camera.position.copy(target).addScaledVector(new THREE.Vector3(...view.from), size);
        view.camera.lookAt(target);
      } else {
        view.camera.aspect = w / h;
      }
      view.camera.updateProjectionMatrix();
      renderer.render(scene, view.camera);
    }
  }
  const redraw = () => {
    if (!scheduled) requestAnimationFrame(draw);
    scheduled = true;
  };
  function restyle() {
    const pathColours = ["x", "truth", "y", "z", "w", "soft"].map(style);
    lines.forEach((line, i) => line.material.color.set(paths[i].name === "truth" ? style("truth") : pathColours[i === 0 ? 0 : 1 + (i % 5)]));
    body.children.forEach((arrow) => arrow.setColor(new THREE.Color(style(arrow.name))));
    bad.material.color.set(style("bad"));
    makeGrid();
    const legend = $("legend");
    legend.textContent = "";
    paths.forEach((path, i) => {
      const item = element(legend, "span", "", `━ ${path.name}`);
      item.style.color = `#${lines[i].material.color.getHexString()}`;
    });
    data.labels.forEach((label, i) => {
      if (!marks.labels.includes(i)) return;
      const item = element(legend, "span");
      const icon = shape(shapes[i], 14);
      const g = icon.getContext("2d");
      g.setTransform(1, 0, 0, 1, 0, 0);
      g.globalCompositeOperation = "source-in";
      g.fillStyle = `#${tint()[i].getHexString()}`;
      g.fillRect(0, 0, 14, 14);
      item.append(icon, ` ${label}`);
    });
    showPoints(cursor);
    redraw();
  }
  $("scene-note").textContent = `Left above plan (x right, y up), below side view (x right, z up), right 3-D: drag to turn, wheel to zoom. ` +
    `Grid ${number(spacing)} m. Rings in red: serious events. Points are those of the scan at the cursor; orange: recedes faster than a static point, blue: slower, full colour from 0.3 m/s.`;
  listeners.push((t) => {
    showPoints(t);
    if (main.t.length) {
      const i = before(main.t, t);
      body.position.copy(at(main.p, i));
      if (main.q.length) body.quaternion.fromArray(main.q, 4 * i);
    }
    redraw();
  });
  controls.addEventListener("change", redraw);
  canvas.onkeydown = (e) => {
    const angle = { ArrowLeft: 0.1, ArrowRight: -0.1 }[e.key];
    const factor = { "+": 0.9, "-": 1.1, ArrowUp: 0.9, ArrowDown: 1.1 }[e.key];
    if (!angle && !factor) return;
    const offset = views[2].camera.position.clone().sub(controls.target);
    if (angle) offset.applyAxisAngle(new THREE.Vector3(0, 0, 1), angle);
    views[2].camera.position.copy(controls.target).add(offset.multiplyScalar(factor || 1));
    controls.update();
    redraw();
    e.preventDefault();
  };
  for (const id of ["colour", "follow"]) $(id).onchange = () => moveTo(cursor);
  new ResizeObserver(redraw).observe(canvas);
  themed.push(restyle);
  restyle();
}
if (typeof THREE !== "undefined" && paths.length) startScene();
const trouble = data.events.find((event) => event.serious); // where it went wrong
moveTo(trouble ? trouble.t : begin + 0.4 * (end - begin));
requestIdleCallback(drawSome, { timeout: 50 });
addEventListener("beforeprint", () => {
  drawSome();
  setTheme(false);
});
addEventListener("afterprint", () => setTheme(dark));
