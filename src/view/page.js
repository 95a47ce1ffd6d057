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
const main = paths[0];
const told = data.events.map((event) => event.t);
const begin = times.length ? Math.min(times[0], ...told) : 0;
const end = times.length ? Math.max(times[times.length - 1], ...told) : 1;
const listeners = []; // of the cursor
let cursor = begin;
let shown = [begin, end]; // times in view

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
  if (!times.length) return;
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
function number(value) {
  const size = Math.abs(value);
  if (value === 0) return "0";
  return size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(+value.toPrecision(4));
}

// ---- theme and cursor
const wantsDark = matchMedia("(prefers-color-scheme: dark)");
let dark = wantsDark.matches;
const themed = []; // called when the colours change
function setTheme(isDark) {
  document.documentElement.classList.toggle("dark", isDark);
  for (const redraw of themed) redraw();
}
setTheme(dark);
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
const buttons = []; // on the strip
const hand = element($("strip"), "div", "hair");
function placeEvents() {
  const place = (e, t) => {
    e.hidden = t < shown[0] - 1e-3 || t > shown[1] + 1e-3;
    e.style.left = `${(100 * (t - shown[0])) / Math.max(1e-6, shown[1] - shown[0])}%`;
  };
  for (const button of buttons) place(button, button.t);
  place(hand, cursor);
  ["from", "to"].forEach((id, i) => ($(id).textContent = `${shown[i].toFixed(1)} s`));
}
$("happened").hidden = data.events.length === 0;
for (const event of data.events) {
  const text = `${event.t.toFixed(2)} s: ${event.text}`;
  for (const place of [$("strip"), element($("events"), "li")]) {
    const button = element(place, "button", event.serious ? "serious" : "");
    Object.assign(button, { t: event.t, title: text, onclick: () => moveTo(event.t) });
    if (place !== $("strip")) button.textContent = text;
    else buttons.push(Object.assign(button, { tabIndex: -1 })); // the keyboard has the list
  }
}
listeners.push(placeEvents);

// ---- series
const graphs = [];
const dashes = [null, [7, 3], [2, 2], [9, 3, 2, 3], [12, 4], [4, 4]];
const hues = ["x", "y", "z", "w", "ink", "soft"]; // of a curve and a path by its index
let zooming = false;
function zoomTo(range, from) {
  if (zooming || (range[0] === shown[0] && range[1] === shown[1])) return;
  zooming = true;
  shown = range;
  for (const graph of graphs) if (graph !== from) graph.updateOptions({ dateWindow: range });
  zooming = false;
  moveTo(cursor);
}
function rowsOf(curves, banded, zero) {
  return Array.from(times, (t, i) => [t, ...curves.map((c) => {
    const v = c.v[i];
    if (Number.isNaN(v)) return banded ? [null, null, null] : null;
    if (!banded) return v;
    if (c.l) return [c.l[i], v, c.h[i]];
    const band = c.s ? 3 * c.s[i] : 0;
    return c.s && zero ? [-band, v, band] : [v - band, v, v + band];
  })]);
}
/** A graph under its title and, where a group begins, under that of the group. */
let group = "";
function graphOf(plot, rows, unit, shades, more) {
  if (plot.group !== group) element($("series"), "h2", "", (group = plot.group));
  const box = element($("series"), "div", "plot");
  element(box, "h3", "", plot.title);
  element(box, "p", "note", plot.note);
  const labelsDiv = element(box, "div", "legend");
  const area = element(box, "div", "area");
  area.setAttribute("role", "img");
  area.setAttribute("aria-label", `${plot.title}. ${plot.note}`);
  const coloured = () => ({ colors: shades.map((i) => style(hues[i % 6])), gridLineColor: style("line"), axisLineColor: style("line") });
  const graph = new Dygraph(area, rows, {
    ...coloured(), legend: "always", labelsDiv, strokeWidth: 1.3, axisLabelFontSize: 12, gridLineWidth: 0.5,
    labelsKMB: false, highlightCircleSize: 3, rightGap: 14, fillAlpha: 0.16, ...more,
    axes: {
      x: { axisLabelFormatter: (v) => `${+v.toPrecision(7)} ${unit}`, valueFormatter: (v) => `${v.toFixed(2)} ${unit}` },
      y: { axisLabelWidth: 56, axisLabelFormatter: number, valueFormatter: number, ...more.y },
    },
  });
  graph.whole = more.valueRange ?? null;
  themed.push(() => graph.updateOptions(coloured()));
  return { area, graph };
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
  const curves = plot.curves.map((c) => ({ ...c, v: column[c.value], s: column[`s${c.value}`],
    l: column[`${c.value}-`], h: column[`${c.value}+`] }));
  const banded = curves.some((c) => c.s || c.l);
  const series = {};
  for (const c of curves) series[c.label] = { strokePattern: dashes[(c.index + Math.floor(c.index / 6)) % 6], sigma: c.s };
  const { area, graph } = graphOf(plot, rowsOf(curves, banded, plot.zero), "s", curves.map((c) => c.index), {
    labels: ["t", ...curves.map((c) => c.label)], customBars: banded, series, stepPlot: plot.steps, dateWindow: shown,
    y: { valueFormatter: (v, o, name, g, row) => number(v) + (series[name].sigma ? ` ± ${number(series[name].sigma[row])}` : "") },
    valueRange: plot.range.length ? plot.range : null,
    underlayCallback: (ctx, { x, w }, g) => rule(ctx, "soft", [3, 3],
      plot.lines.map((y) => g.toDomYCoord(y)).map((at) => [x, at, x + w, at])),
    drawCallback: (g, initial) => {
      if (initial) return;
      zoomTo(g.xAxisRange(), g);
      place(cursor);
    },
    clickCallback: (e, x) => moveTo(x),
    highlightCallback: (e, x) => { if (!playing && !e.buttons) moveTo(x); },
    unhighlightCallback: () => moveTo(cursor),
  });
  const hair = element(area, "div", "hair");
  graphs.push(graph);
  const place = (t) => {
    hair.hidden = t < shown[0] || t > shown[1];
    hair.style.left = `${graph.toDomXCoord(t)}px`;
    graph.setSelection(before(times, t));
  };
  listeners.push(place);
  place(cursor);
}
function drawHistogram(h) {
  const rows = h.counts.map((count, i) => [h.first + i * h.width, count]);
  rows.push([h.first + h.counts.length * h.width, 0]);
  const reach = [rows[0][0], rows[rows.length - 1][0], ...h.lines];
  graphOf(h, rows, h.unit, [0], {
    labels: [h.unit, "number"], stepPlot: true, fillGraph: true, includeZero: true,
    dateWindow: [Math.min(...reach) - h.width, Math.max(...reach) + h.width],
    underlayCallback: (ctx, { y, h: height }, g) => rule(ctx, "bad", [],
      h.lines.map((x) => g.toDomXCoord(x)).map((at) => [at, y, at, y + height])),
  });
}
const toDraw = [];
if (typeof Dygraph !== "undefined") {
  for (const plot of data.plots) toDraw.push(() => drawPlot(plot));
  for (const h of data.histograms) toDraw.push(() => drawHistogram(h));
}
const whenIdle = window.requestIdleCallback || ((call) => setTimeout(call, 1)); // not in Safari
function drawSome(deadline) {
  while (toDraw.length && (!deadline || deadline.timeRemaining() > 8 || deadline.didTimeout)) toDraw.shift()();
  if (toDraw.length) whenIdle(drawSome, { timeout: 50 });
  else document.documentElement.dataset.drawn = "yes";
}
$("keys").hidden = toDraw.length === 0;
function showAll() {
  for (const graph of graphs) graph.updateOptions({ valueRange: graph.whole });
  zoomTo([begin, end]);
}
$("whole").onclick = showAll;
document.onkeydown = (e) => {
  if (e.target.closest("#view, select") || e.ctrlKey || e.altKey || e.metaKey) return;
  const step = (shown[1] - shown[0]) / 100;
  const zoom = (factor) => zoomTo([Math.max(begin, cursor - (cursor - shown[0]) * factor),
    Math.min(end, cursor + (shown[1] - cursor) * factor)]);
  const act = { ArrowLeft: () => moveTo(cursor - step), ArrowRight: () => moveTo(cursor + step),
    "+": () => zoom(0.5), "-": () => zoom(2), 0: showAll }[e.key];
  if (act) { act(); e.preventDefault(); }
};
$("folded").textContent = (data.every > 1
  ? `Series are drawn by the smallest and the largest value of every ${data.every} scans. ` : "") +
  (data.marks.stride > 1 ? `The points of one scan in ${data.marks.stride} are kept.` : "");

// ---- paths and points
// of each label a shape, so that they are told apart without colour: outline, whether filled, colour
const shapes = [["M32 10a22 22 0 1 0 .1 0z", false, "soft"], ["M32 6a26 26 0 1 0 .1 0z", true, "x"],
  ["M10 10h44v44h-44z", true, "z"], ["M32 6L60 56H4z", true, "w"], ["M10 10L54 54M54 10L10 54", false, "y"],
  ["M8 32H56", false, "soft"], ["M32 4L60 32L32 60L4 32z", false, "ink"]];
const landmark = shapes.length - 1;
const byResidual = () => $("colour").value === "residual";
function startScene() {
  const canvas = $("view");
  let renderer;
  $("scene").hidden = false;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  } catch (e) {
    $("scene-note").textContent = "This browser has no WebGL: no paths and points.";
    canvas.hidden = true;
    return;
  }
  const scene = new THREE.Scene();
  const box = new THREE.Box3();
  const colour = (name) => new THREE.Color(style(name));
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
  for (const path of paths) for (let i = 0; i < path.t.length; ++i) box.expandByPoint(at(path.p, i));
  const size = Math.max(1, box.getSize(new THREE.Vector3()).length());
  const centre = box.getCenter(new THREE.Vector3());
  const lines = paths.map((path) => add(new THREE.Line(geometryOf(path.p), new THREE.LineBasicMaterial())));
  const places = []; // lines are a pixel wide: dots make the first one thicker, in the time in view
  const firstDot = [0]; // of each pose
  for (let i = 0; i + 1 < main.t.length; ++i) {
    const [from, to] = [at(main.p, i), at(main.p, i + 1)];
    const dots = Math.min(1000, Math.ceil((700 * from.distanceTo(to)) / size)); // as close as pixels
    for (let n = 0; n < dots; ++n) places.push(...from.clone().lerp(to, n / dots).toArray());
    firstDot.push(places.length / 3);
  }
  const thick = new THREE.PointsMaterial({ size: 2, sizeAttenuation: false });
  thick.color = lines[0].material.color;
  const dots = add(new THREE.Points(geometryOf(places), thick));

  function markers(label, pixels, positions = [], vertexColors = THREE.NoColors) {
    const icon = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
    const g = icon.getContext("2d");
    Object.assign(g, { fillStyle: "#fff", strokeStyle: "#fff", lineWidth: 10 });
    g[shapes[label][1] ? "fill" : "stroke"](new Path2D(shapes[label][0]));
    const map = new THREE.CanvasTexture(icon);
    return add(new THREE.Points(geometryOf(positions), new THREE.PointsMaterial(
      { size: pixels, sizeAttenuation: false, vertexColors, map, alphaTest: 0.4, transparent: true })));
  }
  const clouds = shapes.map((shape, i) => markers(i, i === landmark ? 13 : 9, [], THREE.VertexColors));
  function showPoints(t) {
    const scan = before(marks.t, t);
    const last = scan + 1 < marks.t.length ? marks.first[scan + 1] : marks.labels.length;
    const [slower, fits, faster] = ["x", "soft", "y"].map(colour);
    const byLabel = shapes.map((shape) => colour(shape[2]));
    const positions = shapes.map(() => []);
    const tints = shapes.map(() => []);
    for (let i = marks.t.length ? marks.first[scan] : last; i < last; ++i) {
      const label = marks.labels[i];
      for (let k = 0; k < 3; ++k) positions[label].push(marks.centre[3 * scan + k] + marks.values[4 * i + k] / 100);
      const share = Math.max(-1, Math.min(1, marks.values[4 * i + 3] / 300)); // mm/s, full colour from 0.3 m/s
      const c = label !== landmark && byResidual() ? fits.clone().lerp(share < 0 ? slower : faster, Math.abs(share)) : byLabel[label];
      tints[label].push(c.r, c.g, c.b);
    }
    clouds.forEach((cloud, i) => {
      cloud.geometry.dispose();
      cloud.geometry = geometryOf(positions[i]);
      cloud.geometry.setAttribute("color", new THREE.Float32BufferAttribute(tints[i], 3));
    });
  }
  const serious = data.events.filter((event) => event.serious);
  const bad = markers(0, 16, serious.flatMap((event) => at(main.p, before(main.t, event.t)).toArray()));

  // the body at the cursor: its axes, forward the longest
  const body = add(new THREE.Group());
  body.add(markers(0, 11, [0, 0, 0]));
  for (const [direction, name, length] of [[[1, 0, 0], "x", 1], [[0, 1, 0], "y", 0.5], [[0, 0, 1], "z", 0.5]]) {
    const arrow = new THREE.ArrowHelper(new THREE.Vector3(...direction), new THREE.Vector3(), length * size * 0.08);
    arrow.name = name;
    body.add(arrow);
  }

  // a grid whose lines are a round number apart, on the ground of the path
  const spacing = [1, 2, 5, 10].map((s) => s * 10 ** Math.floor(Math.log10(size / 10))).find((s) => size / s <= 12);
  const count = 2 * Math.ceil(size / spacing);
  let grid;
  function makeGrid() {
    if (grid) scene.remove(grid);
    grid = add(new THREE.GridHelper(count * spacing, count, style("line"), style("line")));
    grid.rotation.x = Math.PI / 2;
    grid.position.set(Math.round(centre.x / spacing) * spacing, Math.round(centre.y / spacing) * spacing, box.min.z);
  }

  // plan and side show what the 3-D view looks at, zoomed as far; areas: left, bottom, width, height
  const flat = () => new THREE.OrthographicCamera(-1, 1, 1, -1, -10 * size, 10 * size);
  const far = 1.15 * size; // of the camera, for all of the path
  const views = [
    { camera: flat(), name: `plan: x right, y up, grid ${number(spacing)} m`, from: [0, 0, 1], wide: [0, 0.34, 0.5, 0.66], narrow: [0, 0.6, 1, 0.4] },
    { camera: flat(), name: "side: x right, z up", from: [0, -1, 0], wide: [0, 0, 0.5, 0.34], narrow: [0, 0.42, 1, 0.18] },
    { camera: new THREE.PerspectiveCamera(45, 1, size / 1000, 50 * size), name: "3-D", from: [-0.7, -1, 0.8], wide: [0.5, 0, 0.5, 1], narrow: [0, 0, 1, 0.42] },
  ];
  for (const view of views) view.caption = element($("views"), "span", "", view.name);
  for (const view of views.slice(1)) view.camera.up.set(0, 0, 1);
  const camera = views[2].camera;
  camera.position.copy(centre).addScaledVector(new THREE.Vector3(...views[2].from).normalize(), far);
  canvas.addEventListener("wheel", (e) => { // else it scrolls the page
    if (document.activeElement !== canvas) e.stopImmediatePropagation();
  }, true);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.target.copy(centre);
  controls.enableKeys = false;
  controls.update();
  function lookAt(place) {
    camera.position.add(place).sub(controls.target);
    controls.target.copy(place);
  }

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
    const extent = box.getSize(new THREE.Vector3());
    const zoomed = camera.position.distanceTo(controls.target) / far;
    for (const view of views) {
      const area = width < 600 ? view.narrow : view.wide;
      const [x, y, w, h] = area.map((share, i) => share * (i % 2 ? height : width));
      Object.assign(view.caption.style, { left: `${x + 5}px`, top: `${height - y - h + 2}px` });
      renderer.setViewport(x + 1, y + 1, w - 2, h - 2);
      renderer.setScissor(x + 1, y + 1, w - 2, h - 2);
      if (view.camera === camera) {
        Object.assign(camera, { aspect: w / h, fov: 45 * Math.max(1, h / w) });
      } else {
        const up = view.from[1] ? extent.z : extent.y;
        const half = Math.max(extent.x, (up * w) / h, 0.3 * size) * 0.62 * zoomed;
        Object.assign(view.camera, { left: -half, right: half, top: (half * h) / w, bottom: (-half * h) / w });
        view.camera.position.copy(controls.target).addScaledVector(new THREE.Vector3(...view.from), size);
        view.camera.lookAt(controls.target);
      }
      view.camera.updateProjectionMatrix();
      renderer.render(scene, view.camera);
    }
  }
  addEventListener("beforeprint", () => { // what is drawn now does not reach the paper otherwise
    Object.assign($("paper"), { width: canvas.width, height: canvas.height });
    $("paper").getContext("2d").drawImage(canvas, 0, 0);
  });
  const redraw = () => {
    if (!scheduled) requestAnimationFrame(draw);
    scheduled = true;
  };
  function entry(sample, text) {
    const item = element($("legend"), "span");
    item.innerHTML = sample;
    item.append(` ${text}`);
  }
  function restyle() {
    $("legend").textContent = "";
    lines.forEach((line, i) => {
      line.material.color.set(style(paths[i].name === "truth" ? "truth" : hues[i % 6]));
      entry(`<i style="background:#${line.material.color.getHexString()}"></i>`, paths[i].name);
    });
    shapes.forEach(([outline, filled, name], i) => {
      if (!marks.labels.includes(i)) return;
      const paint = filled ? 'fill="currentColor"' : 'fill="none" stroke="currentColor" stroke-width="10"';
      entry(`<svg viewBox="0 0 64 64" style="color:var(--${byResidual() ? "ink" : name})"><path d="${outline}" ${paint}/></svg>`, data.labels[i]);
    });
    if (marks.labels.length && byResidual()) entry("<i class='ramp'></i>", "Doppler residual −0.3 to 0.3 m/s, orange: recedes faster than a static point");
    body.children.forEach((arrow) => (arrow.setColor ? arrow.setColor(colour(arrow.name)) : (arrow.material.color = colour("ink"))));
    bad.material.color = colour("bad");
    makeGrid();
    showPoints(cursor);
    draw();
  }
  $("points").hidden = !marks.labels.length;
  $("scene-note").textContent = "Drag to turn, click and wheel to zoom. Thick: the time in view." + (serious.length ? " Red rings: serious events." : "") +
    (marks.labels.length ? " Points and landmarks are those of the scan at the cursor." : "");
  listeners.push((t) => {
    showPoints(t);
    const [from, to] = shown.map((border) => firstDot[before(main.t, border)]);
    dots.geometry.setDrawRange(from, to - from);
    const i = before(main.t, t);
    body.position.copy(at(main.p, i));
    if (main.q.length) body.quaternion.fromArray(main.q, 4 * i);
    if ($("follow").checked) lookAt(body.position);
    redraw();
  });
  controls.addEventListener("change", redraw);
  canvas.onkeydown = (e) => {
    const angle = { ArrowLeft: 0.1, ArrowRight: -0.1 }[e.key];
    const factor = { "+": 0.9, "-": 1.1, ArrowUp: 0.9, ArrowDown: 1.1 }[e.key];
    if (!angle && !factor) return;
    const offset = camera.position.clone().sub(controls.target);
    if (angle) offset.applyAxisAngle(new THREE.Vector3(0, 0, 1), angle);
    camera.position.copy(controls.target).add(offset.multiplyScalar(factor || 1));
    controls.update();
    redraw();
    e.preventDefault();
  };
  $("colour").onchange = restyle;
  $("follow").onchange = (e) => {
    lookAt(e.target.checked ? body.position : centre);
    redraw();
  };
  new ResizeObserver(redraw).observe(canvas);
  themed.push(restyle);
  restyle();
}
function setWidth(width, isDark) { // graphs follow the width of the page, not that of the paper
  document.body.style.width = width;
  setTheme(isDark);
}
addEventListener("beforeprint", () => {
  drawSome();
  setWidth("700px", false);
});
addEventListener("afterprint", () => setWidth("", dark));
if (typeof THREE !== "undefined" && paths.length) startScene();
const trouble = data.events.find((event) => event.serious); // where it went wrong
moveTo(trouble ? trouble.t : begin + 0.4 * (end - begin));
whenIdle(drawSome, { timeout: 50 });
