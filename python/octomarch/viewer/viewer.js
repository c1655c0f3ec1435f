// The viewer's front end: what the hand does goes to Python, which sends pictures back; `messages.py` says how they talk.
// `model` needs `send(message)`, `on("msg:custom", (message, buffers) => …)` and `get("picture")`, a PNG file to begin with, or
// nothing: it is a widget's model, or that of `page.html`.
//
// What the hand does while inputs are in flight is added up, and goes as one when an answer has come, so that the latest
// wins however slow pictures are.

const TITLES = {
  color: "colour", depth: "depth", normal: "normal", steps: "steps", status: "status", error: "error",
  max_steps: "max steps", epsilon: "epsilon", pixel_tolerance: "pixel tolerance",
};
const HINTS = {
  max_steps: "evaluations per ray at the most",
  epsilon: "absolute hit epsilon, in scene units",
  pixel_tolerance: "hit epsilon in pixel radii",
};
const KEYS = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
};
const KEY_WAY = 0.05; // heights of the picture
const WHEEL = 0.0015; // of the logarithm of the distance, for each pixel of the wheel
const RATE_SECONDS = 1;
// Inputs that may be in flight: one is rendered, the next on its way. Jupyter's server leaves Nagle's algorithm on, which
// holds a picture back until the browser has acknowledged the short message before: for 40 ms, or until it sends something.
const WINDOW = 2;
const LOST_MILLISECONDS = 5000; // after which an input is not waited for any more: kernels may be interrupted

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

function written(number, digits = 3) {
  if (number === null || number === undefined) return "∞";
  if (number === 0) return "0";
  const size = Math.abs(number);
  return size < 1e-3 || size >= 1e6 ? number.toExponential(1) : Number(number.toPrecision(digits)).toString();
}

// Adds up what the hand does, and sends it when Python is ready for more.
class Inputs {
  constructor(send) {
    this.send = send;
    this.sum = null;
    this.client = Math.random().toString(36).slice(2); // there may be other front ends
    this.number = 0;
    this.lastAnswered = 0;
    this.sentAt = 0;
    this.since = new Map(); // when what an input brings was first done
    this.delay = 0; // milliseconds from the hand to the last answer
  }

  add(change) {
    const sum = (this.sum ??= { since: performance.now() });
    for (const way of ["orbit", "pan"]) {
      if (change[way]) sum[way] = [0, 1].map((i) => (sum[way]?.[i] ?? 0) + change[way][i]);
    }
    if (change.zoom) sum.zoom = (sum.zoom ?? 1) * change.zoom;
    if (change.march !== undefined) sum.march = change.march && { ...sum.march, ...change.march };
    for (const name of ["home", "plane", "pick"]) {
      if (change[name] !== undefined) sum[name] = change[name];
    }
    this.go();
  }

  go() {
    const isLost = performance.now() - this.sentAt > LOST_MILLISECONDS;
    if (!this.sum || (this.number - this.lastAnswered >= WINDOW && !isLost)) return;
    this.number += 1;
    this.sentAt = performance.now();
    const { since, ...what } = this.sum;
    this.since.set(this.number, since);
    this.send({ kind: "input", client: this.client, number: this.number, ...what });
    this.sum = null;
  }

  answered(answers) {
    const number = answers[this.client] ?? this.lastAnswered;
    if (number > this.lastAnswered) {
      this.delay = performance.now() - this.since.get(this.lastAnswered + 1);
      while (this.lastAnswered < number) this.since.delete((this.lastAnswered += 1));
    }
    this.go();
  }
}

// Follows the pointers over a picture, and the keys, and tells what they mean.
function followHand(picture, add) {
  const pointers = new Map();
  const way = (event, from) => {
    const height = picture.clientHeight;
    return [(event.clientX - from.x) / height, (event.clientY - from.y) / height];
  };
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  picture.addEventListener("pointerdown", (event) => {
    picture.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  picture.addEventListener("pointermove", (event) => {
    const from = pointers.get(event.pointerId);
    if (!from) return;
    const moved = way(event, from);
    const before = pointers.size === 2 ? spread() : 0;
    Object.assign(from, { x: event.clientX, y: event.clientY });
    if (pointers.size === 2) {
      add({ pan: moved.map((part) => part / 2), zoom: before / Math.max(spread(), 1) });
    } else {
      add(event.shiftKey || event.buttons & 4 ? { pan: moved } : { orbit: moved });
    }
  });
  for (const name of ["pointerup", "pointercancel"]) {
    picture.addEventListener(name, (event) => pointers.delete(event.pointerId));
  }
  picture.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    add({ zoom: Math.exp(WHEEL * lines * event.deltaY) });
  }, { passive: false });
  picture.addEventListener("dblclick", (event) => {
    const box = picture.getBoundingClientRect();
    add({ pick: [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height] });
  });
  picture.addEventListener("keydown", (event) => {
    const arrow = KEYS[event.key]?.map((step) => step * KEY_WAY);
    if (arrow) add(event.shiftKey ? { pan: arrow } : { orbit: arrow });
    else if (event.key === "+" || event.key === "=") add({ zoom: 1 / 1.1 });
    else if (event.key === "-") add({ zoom: 1.1 });
    else if (event.key === "Home") add({ home: true });
    else return;
    event.preventDefault();
    event.stopPropagation(); // notebooks have their own use for arrows
  });
}

// A slider whose way is the logarithm of its number.
function slider(name, add) {
  const range = element("input", { type: "range", min: 0, max: 1, step: "any", title: HINTS[name] });
  const shown = element("output");
  let ends = [1, 2];
  const value = () => {
    const number = ends[0] * (ends[1] / ends[0]) ** Number(range.value);
    return name === "max_steps" ? Math.round(number) : Number(number.toPrecision(3));
  };
  range.addEventListener("input", () => {
    shown.value = written(value());
    add({ march: { [name]: value() } });
  });
  const set = ({ value: number, low, high, is_default: isDefault }) => {
    ends = [low, high];
    range.value = Math.log(Math.max(number, low) / low) / Math.log(high / low);
    shown.value = written(number) + (isDefault ? " (default)" : "");
  };
  range.dataset.name = name;
  return { set, row: element("label", {}, element("span", { textContent: TITLES[name] }), range, shown) };
}

function legendRow(legend) {
  if (!legend) return [];
  const swatch = (color) => {
    const made = element("i");
    made.style.background = color;
    return made;
  };
  if (!legend.is_ramp) return legend.labels.flatMap((label, i) => [swatch(legend.colors[i]), label]);
  const [low, high, ...others] = legend.labels;
  const stops = legend.colors.slice(0, legend.colors.length - others.length);
  const ramp = element("i", { className: "ramp" });
  ramp.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  return [low, ramp, high, ...others.flatMap((label, i) => [swatch(legend.colors[stops.length + i]), label])];
}

// The table of numbers beside the sliders.
function numbers() {
  const cells = {};
  const row = (name, title, hint) => {
    cells[name] = element("output", { textContent: "…" });
    cells[name].dataset.name = name;
    return element("div", { title: hint }, element("span", { textContent: title }), cells[name]);
  };
  const table = element("div", { className: "numbers" },
    row("evaluations", "evaluations per ray", "of the field, cones included"),
    row("milliseconds", "milliseconds", "for this picture, in the kernel"),
    row("error", "error, median | p95", "of depth in scene units, over sampled rays, against the scalar reference in float64"),
    row("wrong", "wrong rays", "that hit where nothing is, or miss a surface"),
    row("statuses", "rays", "what became of them"),
    row("picture", "picture", "how fine it is, how many come a second, and how long after the hand"));
  const showErrors = (errors) => {
    cells.error.value = errors ? `${written(errors.p50, 2)} | ${written(errors.p95, 2)}` : "…";
    const wrong = errors && errors.false_hits + errors.false_misses;
    cells.wrong.value = errors ? `${wrong} of ${errors.rays}` : "…";
  };
  const show = (message, rate, delay) => {
    cells.evaluations.value = written(message.evaluations);
    cells.milliseconds.value = written(message.milliseconds);
    const all = message.size[0] * message.size[1];
    cells.statuses.value = Object.entries(message.statuses)
      .map(([name, count]) => `${written((100 * count) / all, 2)} % ${name.toLowerCase().replace("_", " ")}`).join(", ");
    const fine = message.samples > 1 ? `, ${message.samples} rays a pixel` : message.is_lit ? "" : ", no shadows";
    const live = rate ? `, ${rate.toFixed(0)} a second, ${delay.toFixed(0)} ms after the hand` : "";
    cells.picture.value = `${message.size.join("×")}${fine}${live}`;
    showErrors(message.errors);
  };
  return { table, show, showErrors };
}

function pickedRows(picked) {
  const vector = (parts) => `(${parts.map((part) => written(part, 5)).join(", ")})`;
  const rows = { pixel: picked.pixel.join(", "), status: picked.status.toLowerCase().replace("_", " ") };
  if (picked.t !== null) {
    Object.assign(rows, { t: written(picked.t, 7), position: vector(picked.position), normal: vector(picked.normal) });
  }
  if (picked.object_id >= 0) {
    rows.object = `${picked.object_id}: ${picked.object}`;
    rows.material = picked.material_id;
  }
  rows.steps = picked.steps;
  return Object.entries(rows).map(([name, value]) =>
    element("div", {}, element("span", { textContent: name }), element("output", { textContent: value })));
}

function render({ model, el }) {
  const canvas = element("canvas", { tabIndex: 0, title: "drag: orbit, wheel: zoom, shift-drag: pan, double click: pick" });
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "rendered scene; arrow keys orbit, + and - zoom, Home goes back");
  const cross = element("div", { className: "cross", hidden: true });
  const legend = element("div", { className: "legend" });
  const picked = element("div", { className: "picked", hidden: true });
  const failure = element("div", { className: "failure", hidden: true });
  const planes = element("select", { title: "the plane shown" });
  const home = element("button", { textContent: "home", title: "back to the first view" });
  const defaults = element("button", { textContent: "defaults", title: "sliders back to the defaults" });
  const beside = numbers();
  const inputs = new Inputs((message) => model.send(message));
  const moved = (change) => {
    cross.hidden = picked.hidden = true;
    inputs.add(change);
  };
  const sliders = Object.fromEntries(["max_steps", "epsilon", "pixel_tolerance"].map((name) =>
    [name, slider(name, (change) => inputs.add(change))]));
  const root = element("div", { className: "octomarch-viewer" },
    element("div", { className: "picture" }, canvas, cross, legend, picked, failure),
    element("div", { className: "panel" },
      element("div", { className: "buttons" }, planes, home, defaults),
      ...Object.values(sliders).map(({ row }) => row), beside.table));
  root.dataset.lmSuppressShortcuts = true; // JupyterLab's: keys are the viewer's while it has the focus
  el.append(root);

  followHand(canvas, (change) => (change.pick ? inputs.add(change) : moved(change)));
  planes.addEventListener("change", () => inputs.add({ plane: planes.value }));
  home.addEventListener("click", () => moved({ home: true }));
  defaults.addEventListener("click", () => inputs.add({ march: null }));

  const times = [];
  let drawn = 0; // number of the frame on the canvas; decoding may end in another order
  let received = 0;
  let failed = 0; // how many had been received when the last failure was told
  const rate = () => {
    const now = performance.now();
    times.push(now);
    while (times[0] < now - 1000 * RATE_SECONDS) times.shift();
    return times.length > 2 ? (1000 * (times.length - 1)) / (now - times[0]) : 0;
  };

  const resize = (width, height) => {
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    Object.assign(canvas.style, { width: `${width}px`, aspectRatio: `${width} / ${height}` });
  };

  const drawFirst = async (file) => {
    const bitmap = await createImageBitmap(new Blob([file], { type: "image/png" }));
    if (received) return;
    resize(bitmap.width, bitmap.height);
    canvas.getContext("2d").drawImage(bitmap, 0, 0);
  };

  const onState = ({ size, plane, planes: names, sliders: states }) => {
    resize(...size);
    planes.replaceChildren(...names.map((name) => element("option", { value: name, textContent: TITLES[name] })));
    planes.value = plane;
    for (const [name, state] of Object.entries(states)) sliders[name].set(state);
  };

  const onFrame = async (message, buffer) => {
    const number = (received += 1);
    inputs.answered(message.answers); // the next one may be rendered while this one is decoded
    const bitmap = await createImageBitmap(new Blob([buffer], { type: message.type }));
    if (number < drawn) return;
    drawn = number;
    const context = canvas.getContext("2d");
    context.imageSmoothingEnabled = message.plane === "color";
    context.drawImage(bitmap, 0, 0, canvas.width, canvas.height);
    bitmap.close();
    if (number > failed) failure.hidden = true;
    legend.replaceChildren(...legendRow(message.legend));
    beside.show(message, message.is_last ? (times.length = 0) : rate(), inputs.delay);
    Object.assign(canvas.dataset, { frames: number, last: message.is_last, delay: inputs.delay });
  };

  const onPicked = (message) => {
    picked.replaceChildren(...pickedRows(message));
    const [x, y] = message.pixel;
    cross.style.left = `${(100 * (x + 0.5)) / canvas.width}%`;
    cross.style.top = `${(100 * (y + 0.5)) / canvas.height}%`;
    cross.hidden = picked.hidden = false;
  };

  const onMessage = (message, buffers) => {
    if (message.kind === "state") return onState(message);
    if (message.kind === "frame") return onFrame(message, buffers[0]);
    if (message.kind === "errors") beside.showErrors(message.errors);
    if (message.kind === "picked") onPicked(message);
    if (message.kind === "error") {
      failure.textContent = message.text;
      failure.hidden = false;
      failed = received;
    }
    return inputs.answered(message.answers);
  };
  const first = model.get("picture");
  if (first?.byteLength) drawFirst(first);
  model.on("msg:custom", onMessage);
  model.send({ kind: "hello" });
  return () => model.off("msg:custom", onMessage);
}

export default { render };
