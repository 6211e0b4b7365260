// One run: the motion with contact forces, plots of any column that follow it, the events. Data: report/view.h.
// Motion in the plane: Stage, over Film of animation.js. In space: SpaceStage, over SpaceFilm of space.js.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const main = document.getElementById("page");
const { values, scene, events } = data;
const t = values.t;
const inSpace = data.dimension === 3;
const first = t[0],
  last = t.at(-1);

function add(parent, tag, text, properties = {}) {
  const element = Object.assign(document.createElement(tag), properties);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

/** The place of the last frame that is not after a time, but for rounding. */
function frameAt(time) {
  time += 1e-12 * Math.abs(time);
  let [low, high] = [0, t.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Forces of contacts: impulses of a frame by its length. */
for (const column of data.columns.filter((name) => /\.impulse_(n|t[12]?)$/.test(name)))
  values[column.replace("impulse", "force")] = values[column].map((x, i) =>
    i === 0 || x === null ? 0 : x / Math.max(t[i] - t[i - 1], 1e-300),
  );
const forces = Object.keys(values).filter((name) => /\.force_(n|t[12]?)$/.test(name));
const choices = [...data.columns.filter((name) => name !== "t"), ...forces].sort();

const UNITS = [
  [/\.([xyz]|gap)$|^penetration$|^joint_residual$/, "m"],
  [/\.theta$/, "rad"],
  [/\.v[xyz]$/, "m/s"],
  [/\.(omega|w[xyz])$/, "rad/s"],
  [/\.impulse(_(n|t[12]?))?$/, "N s"],
  [/\.force_(n|t[12]?)$/, "N"],
  [/^energy$/, "J"],
];
const unitOf = (name) => UNITS.find(([pattern]) => pattern.test(name))?.[1] ?? "";

const seconds = (x) => `${Number(x.toPrecision(8))} s`;

/** The frames as Film reads them: t, then x, y, θ of each body, then gap and normal impulse of each contact. Those of
 *  SpaceFilm likewise. */
function frames() {
  const columns = [t];
  const zero = new Array(t.length).fill(0);
  const ofBody = inSpace ? ["x", "y", "z", "qw", "qx", "qy", "qz"] : ["x", "y", "theta"];
  const ofContact = inSpace ? ["gap", "impulse_n", "impulse_t1", "impulse_t2"] : ["gap", "impulse_n"];
  for (const { name } of scene.bodies) for (const part of ofBody) columns.push(values[`${name}.${part}`] ?? zero);
  for (const { name } of scene.contacts) for (const part of ofContact) columns.push(values[`${name}.${part}`] ?? zero);
  return t.map((_, i) => columns.map((column) => column[i]));
}

/** The canvas of a planar scene. */
class Stage extends Film {
  events() {} // a table of its own

  frameAt(time) {
    return frameAt(time);
  }

  /** What the frames need: of many points every few frames, of the centres of mass all. */
  bounds() {
    const [shapes, all] = [this.shapes(), this.film.frames];
    const points = shapes.reduce((sum, shape) => sum + shape.points.length, 1);
    const stride = Math.max(1, Math.ceil((points * all.length) / 4e5));
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    const take = ([x, y]) => {
      left = Math.min(left, x);
      right = Math.max(right, x);
      low = Math.min(low, y);
      high = Math.max(high, y);
    };
    all.forEach((frame, k) => {
      this.scene.bodies.forEach((_, i) => take([frame[1 + 3 * i], frame[2 + 3 * i]]));
      if (k % stride === 0 || k === all.length - 1)
        for (const shape of shapes) for (const point of shape.points) take(this.place(frame, shape.body, point));
    });
    for (const pin of this.scene.pins) if (pin.a < 0) take(pin.point_a);
    const size = Math.max(right - left, high - low, 1e-9);
    const width = Math.max(right - left, (high - low) / 0.6) + 0.12 * size;
    const height = Math.max(high - low, (right - left) / 3.2) + 0.12 * size;
    const [x, y] = [(left + right) / 2, (low + high) / 2];
    return { left: x - width / 2, right: x + width / 2, low: y - height / 2, high: y + height / 2 };
  }

  /** Where a contact's force acts on a body and its direction, where the drawing knows it. */
  forceAt(frame, contact) {
    if (contact.centres) {
      const { a, point_a, radius_a, b, point_b, radius_b, inside } = contact.centres;
      const [pa, pb] = [this.place(frame, a, point_a), this.place(frame, b, point_b)];
      const length = Math.hypot(pa[0] - pb[0], pa[1] - pb[1]) || 1;
      let n = [(pa[0] - pb[0]) / length, (pa[1] - pb[1]) / length]; // from b to a
      if (!inside) return [[pb[0] + radius_b * n[0], pb[1] + radius_b * n[1]], n]; // what pushes a away
      const [centre, radius] = radius_a < radius_b ? [pa, radius_a] : [pb, radius_b]; // the journal, pushed inwards
      if (radius_a < radius_b) n = [-n[0], -n[1]];
      return [[centre[0] - radius * n[0], centre[1] - radius * n[1]], n];
    }
    if (contact.body === undefined) return null;
    const { angle } = this.pose(frame, contact.on ?? -1);
    const [nx, ny] = contact.normal;
    const n = [Math.cos(angle) * nx - Math.sin(angle) * ny, Math.sin(angle) * nx + Math.cos(angle) * ny];
    return [this.place(frame, contact.body, contact.point), n];
  }

  arrows(c, at, k) {
    if (!show.forces.checked) return;
    const frames = this.film.frames,
      back = Math.max(1, Math.round(kFade * frames.length)),
      longest = 0.16 * this.canvas.clientWidth;
    const most = Math.max(this.strongest, this.pushed());
    const draw = (place, size, age) => {
      const [x, y] = at(place[0]),
        [nx, ny] = place[1],
        length = Math.max(6, longest * Math.sqrt(size / most)),
        [ex, ey] = [x + length * nx, y - length * ny];
      c.globalAlpha = 1 - age;
      c.strokeStyle = c.fillStyle = colour("--c1");
      c.lineWidth = 2.5;
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(ex, ey);
      c.stroke();
      c.beginPath();
      c.moveTo(ex + 7 * nx, ey - 7 * ny);
      c.lineTo(ex - 4.5 * ny, ey - 4.5 * nx);
      c.lineTo(ex + 4.5 * ny, ey + 4.5 * nx);
      c.fill();
    };
    this.scene.contacts.forEach((contact, i) => {
      for (let j = Math.max(0, k - back + 1); j <= k; ++j) {
        const size = this.impulse(frames[j], i);
        const place = size > 1e-9 * this.strongest && this.forceAt(frames[k], contact);
        if (!place) continue;
        draw(place, size, (k - j) / back);
      }
    });
    for (const [x, y, nx, ny, size] of data.pushes[k] ?? []) // of searched collisions: where they are now
      if (size > 1e-9 * most) draw([[x, y], [nx, ny]], size, 0);
    c.globalAlpha = 1;
  }

  /** The largest impulse of a searched collision's pair. */
  pushed() {
    this.largest ??= data.pushes.reduce((most, frame) => frame.reduce((m, push) => Math.max(m, push[4]), most), 0);
    return this.largest;
  }

  /** The paths of the bodies' centres up to now. */
  walls(c, at, width) {
    super.walls(c, at, width);
    if (!show.paths.checked) return;
    const k = frameAt(player?.time ?? first);
    c.lineWidth = 1;
    c.globalAlpha = 0.6;
    this.scene.bodies.forEach((_, i) => {
      c.strokeStyle = lineColour(i);
      c.beginPath();
      for (let j = 0; j <= k; ++j) c.lineTo(...at(this.place(this.film.frames[j], i, [0, 0])));
      c.stroke();
    });
    c.globalAlpha = 1;
  }
}

/** The animation of a scene in space. */
const SpaceStage =
  inSpace &&
  class extends SpaceFilm {
    events() {} // a table of its own

    frameAt(time) {
      return frameAt(time);
    }
  };

/** Columns over time; a line marks the animation's moment, a click moves it there. */
class TimePlot {
  constructor(element, columns) {
    this.box = add(element, "section", undefined, { className: "timeplot" });
    this.bar = add(this.box, "div", undefined, { className: "controls" });
    this.element = add(this.box, "div", undefined, { className: "plot" });
    this.columns = columns;
    new ResizeObserver(() => this.fit()).observe(this.element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.draw();
  }

  controls() {
    this.bar.replaceChildren();
    const select = add(this.bar, "select");
    select.setAttribute("aria-label", "add a column");
    select.add(new Option("add a column …", ""));
    for (const name of choices) if (!this.columns.includes(name)) select.add(new Option(name, name));
    select.onchange = () => {
      this.columns.push(select.value);
      this.draw();
    };
    this.columns.forEach((name, i) => {
      const button = add(this.bar, "button", `${name} ×`, { type: "button", title: `remove ${name}` });
      button.style.color = `var(--c${i % 9})`;
      button.onclick = () => {
        this.columns = this.columns.filter((other) => other !== name);
        this.draw();
      };
    });
  }

  fit() {
    const width = this.element.clientWidth;
    if (width && width !== this.plot.width) this.plot.setSize({ width, height: 230 });
  }

  draw() {
    this.controls();
    this.plot?.destroy();
    const units = [...new Set(this.columns.map(unitOf))].filter((unit) => unit);
    const lines = { stroke: colour("--rule"), width: 1 };
    const axis = { stroke: colour("--faint"), grid: lines, ticks: lines, font: "12px system-ui", labelFont: "13px system-ui", labelSize: 24 };
    this.plot = new uPlot(
      {
        width: Math.max(200, this.element.clientWidth),
        height: 230,
        scales: { x: { time: false } },
        axes: [
          { ...axis, label: "t [s]", size: 34, values: (_, ticks) => ticks.map((v) => String(Number(v.toPrecision(9)))) },
          { ...axis, label: units.join(", "), size: roomFor, values: (_, ticks) => ticks.map((v) => (v === null ? "" : shown(v))) },
        ],
        series: [
          { label: "t" },
          ...this.columns.map((name, i) => ({
            label: name,
            stroke: lineColour(i),
            width: 1.6,
            value: (_, v) => `${shown(v)} ${unitOf(name)}`,
          })),
        ],
        cursor: { sync: { key: "time" }, drag: { x: true, y: false } },
        legend: { live: true },
        hooks: { draw: [() => this.marks()] },
      },
      [t, ...this.columns.map((name) => values[name])],
      this.element,
    );
    this.seek();
  }

  /** A click goes to its time; where the pointer moved in between it was a zoom. */
  seek() {
    let down = 0;
    this.plot.over.addEventListener("mousedown", (event) => (down = event.clientX));
    this.plot.over.addEventListener("click", (event) => {
      if (Math.abs(event.clientX - down) < 4) player.go(this.plot.posToVal(event.clientX - this.plot.over.getBoundingClientRect().left, "x"));
    });
  }

  /** Ticks of events at the lower edge, a line at the animation's moment. */
  marks() {
    const { ctx, bbox } = this.plot;
    const left = (time) => this.plot.valToPos(time, "x", true);
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.fillStyle = colour("--c1");
    ctx.globalAlpha = 0.7;
    for (const [time] of events) ctx.fillRect(left(time), bbox.top + bbox.height - 8 * devicePixelRatio, devicePixelRatio, 8 * devicePixelRatio);
    ctx.globalAlpha = 1;
    ctx.fillStyle = colour("--ink");
    if (player) ctx.fillRect(left(player.time) - 0.75 * devicePixelRatio, bbox.top, 1.5 * devicePixelRatio, bbox.height);
    ctx.restore();
  }
}

/** The animation on the run's own clock: factor 1 is real time. */
class Player extends Animation {
  get time() {
    return this.position * this.duration;
  }

  go(time) {
    this.position = Math.min(1, Math.max(first / last, time / last));
    this.draw();
  }

  step(count) {
    if (this.playing) this.toggle();
    this.go(t[Math.min(t.length - 1, Math.max(0, frameAt(this.time) + count))]);
  }

  draw() {
    super.draw();
    if (!ready) return;
    const k = frameAt(this.time);
    clock.textContent = `t = ${seconds(t[k])} of ${seconds(last)}, frame ${k + 1} of ${t.length}`;
    plots.forEach((plot) => plot.plot.redraw(false, false));
    mark(this.time);
  }
}

/** The slowest of the offered speeds at which the run takes ten seconds at most. */
function speeds() {
  const factors = [1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10, 100];
  const chosen = factors.find((factor) => (last - first) / factor <= 10) ?? 100;
  return factors.map((factor) => [factor === 1 ? "real time" : `× ${factor}`, factor, factor === chosen]);
}

/** The table of events; a click goes there, the one that was last is marked. */
let rowsOfEvents = [];
let markedRow = null;
function eventTable(parent) {
  add(parent, "h2", data.event_count ? `${data.event_count} events` : "Events");
  if (!data.event_count) {
    add(parent, "p", "None were located: the integrators adaptive and event-driven locate them.", { className: "note" });
    return;
  }
  const box = add(parent, "div", undefined, { className: "scroll events" });
  const table = add(box, "table");
  const row = (cells, tag) => {
    const tr = add(table, "tr");
    cells.forEach((cell, i) => add(tr, tag, cell, { className: i === 1 || i === 2 ? "word" : "" }));
    return tr;
  };
  row(["t [s]", "kind", "contact", "normal impulse [N s]", "tangential [N s]"], "th");
  for (const [time, kind, contact, normal, tangent] of events) {
    const tr = row([String(Number(time.toPrecision(10))), kind, contact, shown(normal), shown(tangent)], "td");
    tr.onclick = () => player.go(time);
    rowsOfEvents.push([time, tr]);
  }
  if (events.length < data.event_count) row([`… ${data.event_count - events.length} more`], "td");
}

function mark(time) {
  const now = rowsOfEvents.findLast(([when]) => when <= time)?.[1] ?? null;
  if (now === markedRow) return;
  markedRow?.classList.remove("now");
  now?.classList.add("now");
  markedRow = now;
  if (now) now.parentElement.parentElement.scrollTop = now.offsetTop - 120;
}

document.title = `Orthant: ${data.name}`;
add(main, "p", "Orthant, a run", { className: "name" });
add(main, "h1", data.name);
add(main, "p", data.note, { className: "note" });
const place = add(main, "div");
const options = add(main, "div", undefined, { className: "controls" });
let show = {};
const clock = add(options, "span", "", { className: "facts" });
for (const [key, words, on] of inSpace // has its own
  ? []
  : [
      ["forces", "contact forces", true],
      ["paths", "paths", false],
    ]) {
  const label = add(options, "label");
  show[key] = add(label, "input", undefined, { type: "checkbox", checked: on });
  label.append(` ${words}`);
}
const save = add(options, "button", "Save picture", { type: "button" });
let ready = false,
  player = null,
  plots = [];
player = new Player(place, {
  scene,
  seconds: last,
  speeds: speeds(),
  stage: inSpace ? SpaceStage : Stage,
  films: [{ label: "", status: "solved", frames: frames(), events: [] }],
});
player.position = first / last || 0;
if (inSpace) {
  show = player.films[0].options;
  player.films[0].label.remove(); // the clock says it
}
if (!inSpace) for (const key in show) show[key].onchange = () => player.draw();
save.onclick = () => {
  const link = Object.assign(document.createElement("a"), {
    href: player.films[0].canvas.toDataURL("image/png"),
    download: `${data.name}_${frameAt(player.time) + 1}.png`,
  });
  link.click();
};
const columns = add(main, "div");
const firstForce = forces.find((name) => name.endsWith(".force_n") && values[name].some((x) => x > 0));
const firstBody = scene.bodies[0]?.name;
for (const chosen of [["energy"], [firstForce ?? `${firstBody}.y`]])
  if (chosen.every((name) => values[name])) plots.push(new TimePlot(columns, chosen));
add(main, "button", "Add a plot", { type: "button" }).onclick = () => plots.push(new TimePlot(columns, [`${firstBody}.x`].filter((name) => values[name])));
eventTable(main);
add(
  main,
  "footer",
  `${data.rows} rows of ${data.columns.length} columns` +
    (data.every > 1 ? `; a frame is ${data.every} rows: impulses summed, of others the last.` : ".") +
    (inSpace
      ? " Arrows: contact impulses of late on the first body, longer for larger ones (by the root), in their friction cones. Drag turns, the wheel zooms, the right button moves."
      : " Arrows: normal impulses of late, longer for larger ones (by the root).") +
    " Space plays, ← and → step, a click into a plot goes there.",
);
document.addEventListener("keydown", (event) => {
  if (/^(SELECT|INPUT|BUTTON)$/.test(event.target.tagName)) return;
  if (event.key === " ") player.toggle();
  else if (event.key === "ArrowLeft") player.step(-1);
  else if (event.key === "ArrowRight") player.step(1);
  else return;
  event.preventDefault();
});
ready = true;
player.draw();
