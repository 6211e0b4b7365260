// The mechanism in motion, films side by side on one clock. A frame: t, then x, y, θ of each body, then gap and normal
// impulse of each contact. Where a body is magnified, its way across the guide and its tilt are drawn larger, and walls
// are moved out by as much, so that a gap of 1 mm can be seen; impulses are arrows that fade.
"use strict";

const kMostRows = 12; // of contacts over time
const kFade = 0.03; // share of the film in which an arrow fades

/** A canvas of this size in the page's pixels, empty; what to draw into. */
function sized(canvas, width, height) {
  const dots = devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * dots) || canvas.height !== Math.round(height * dots)) {
    canvas.width = Math.round(width * dots);
    canvas.height = Math.round(height * dots);
    canvas.style.height = `${height}px`;
  }
  const c = canvas.getContext("2d");
  c.setTransform(dots, 0, 0, dots, 0, 0);
  c.clearRect(0, 0, width, height);
  return c;
}

/** A film's figure, in the plane or in space: caption, canvas, contact modes, events. */
class Shots {
  constructor(element, film, animation) {
    Object.assign(this, { film, animation, scene: animation.scene });
    this.figure = document.createElement("figure");
    this.caption = Object.assign(document.createElement("figcaption"), {
      textContent:
        film.label +
        (film.status === "solved" ? "" : ` (ended: ${film.status}, at ${(1e3 * film.frames.at(-1)[0]).toFixed(2)} ms; then it stands still)`),
    });
    this.canvas = document.createElement("canvas");
    this.strip = document.createElement("canvas");
    this.strip.className = "strip";
    this.figure.append(this.caption, this.canvas, this.strip);
    this.events(this.figure);
    element.append(this.figure);
    this.bodies = this.scene.bodies.length;
  }

  /** The frame nearest to a time; the last one when the film is over. */
  frameAt(t) {
    const frames = this.film.frames;
    const after = frames.findIndex((frame) => frame[0] >= t);
    if (after <= 0) return after < 0 ? frames.length - 1 : 0;
    return frames[after][0] - t < t - frames[after - 1][0] ? after : after - 1;
  }

  /** Contact modes over time: a row a contact, filled where it pushes; the line is now. */
  modes(k) {
    const frames = this.film.frames;
    const rows = this.scene.contacts.length;
    if (rows === 0 || rows > kMostRows) return void (this.strip.hidden = true);
    const c = sized(this.strip, this.strip.clientWidth, 13 * rows + 4);
    const left = 64;
    const scale = (this.strip.clientWidth - left) / frames.length;
    c.font = "11px system-ui";
    this.scene.contacts.forEach((contact, i) => {
      c.fillStyle = colour("--faint");
      c.fillText(contact.name, 2, 13 * i + 11);
      c.fillStyle = colour("--rule");
      c.fillRect(left, 13 * i + 7, frames.length * scale, 1);
      c.fillStyle = colour("--c1");
      frames.forEach((frame, j) => {
        if (this.impulse(frame, i) > 1e-9) c.fillRect(left + j * scale, 13 * i + 2, Math.max(1, scale), 10);
      });
    });
    c.fillStyle = colour("--ink");
    const last = frames.at(-1)[0];
    for (const [t, , contact] of this.film.events) // located ones: a tick at their time
      if (contact < rows) c.fillRect(left + (t / last) * frames.length * scale, 13 * contact + 2, 1, 10);
    c.fillRect(left + k * scale, 0, 1.5, 13 * rows + 4);
  }

  /** Time, kind, contact and impulse of each located event, in a table that opens. */
  events(figure) {
    const { events, event_count: count } = this.film;
    if (!count) return;
    const details = document.createElement("details");
    details.className = "events";
    details.append(Object.assign(document.createElement("summary"), { textContent: count === 1 ? "1 event" : `${count} events` }));
    const table = document.createElement("table");
    const row = (cells, tag) => {
      const tr = table.insertRow();
      for (const text of cells) tr.append(Object.assign(document.createElement(tag), { textContent: text }));
    };
    row(["t [s]", "kind", "contact", "normal impulse [N s]", "tangential [N s]"], "th");
    for (const [t, kind, contact, normal, tangent] of events)
      row([t, kind, this.scene.event_contacts[contact], normal, tangent], "td");
    if (events.length < count) row([`… ${count - events.length} more`], "td");
    details.append(table);
    figure.append(details);
  }
}

class Film extends Shots {
  constructor(element, film, animation) {
    super(element, film, animation);
    this.magnified = this.scene.bodies.findIndex((b) => b.name === animation.magnify);
    this.gain = this.magnified < 0 ? 1 : this.clearance() > 0 ? Math.max(1, 0.018 / this.clearance()) : 1;
    this.strongest = Math.max(
      1e-12,
      ...film.frames.map((f) => Math.max(...this.scene.contacts.map((_, i) => this.impulse(f, i)))),
    );
    this.box = this.bounds();
  }

  gap(frame, i) {
    return frame[1 + 3 * this.bodies + 2 * i];
  }
  impulse(frame, i) {
    return frame[2 + 3 * this.bodies + 2 * i];
  }

  /** Of the magnified body at the start, the least gap to a wall of the ground. */
  clearance() {
    return Math.min(
      ...this.scene.contacts.map((c, i) =>
        c.ground && c.body === this.magnified ? this.gap(this.film.frames[0], i) : Infinity,
      ),
    );
  }

  /** The bodies' outlines; walls are drawn longer than all else. */
  shapes() {
    return this.scene.outlines.filter((shape) => !shape.wall);
  }

  pose(frame, body) {
    if (body < 0) return { x: 0, y: 0, angle: 0 }; // the ground
    const [x, y, angle] = frame.slice(1 + 3 * body, 4 + 3 * body);
    return body === this.magnified ? { x, y: y * this.gain, angle: angle * this.gain } : { x, y, angle };
  }

  /** Where a body's point is drawn; one that is pinned to the magnified body, where that one's is. */
  place(frame, body, [px, py]) {
    const pin =
      body !== this.magnified &&
      this.scene.pins.find(
        (p) => p.a === body && p.body === this.magnified && p.point_a[0] === px && p.point_a[1] === py,
      );
    if (pin) return this.place(frame, pin.body, pin.point);
    const { x, y, angle } = this.pose(frame, body);
    return [x + Math.cos(angle) * px - Math.sin(angle) * py, y + Math.sin(angle) * px + Math.cos(angle) * py];
  }

  wallPoint(contact) {
    const out = contact.body === this.magnified ? (this.gain - 1) * this.clearance() : 0;
    return [contact.wall[0] - out * contact.normal[0], contact.wall[1] - out * contact.normal[1]];
  }

  /** What all frames need, no taller than 3/4 and no flatter than 1/4 of its width. */
  bounds() {
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    const bare = this.scene.bodies.map((_, i) => ({ body: i, points: [[0, 0]] })); // at least the centres of mass
    for (const frame of this.film.frames)
      for (const shape of [...bare, ...this.shapes()])
        for (const point of shape.points) {
          const [x, y] = this.place(frame, shape.body, point);
          left = Math.min(left, x);
          right = Math.max(right, x);
          low = Math.min(low, y);
          high = Math.max(high, y);
        }
    const size = Math.max(right - left, high - low, 1e-9);
    const width = Math.max(right - left, (high - low) / 0.75) + 0.1 * size;
    const height = Math.max(high - low, (right - left) / 4) + 0.1 * size;
    const [x, y] = [(left + right) / 2, (low + high) / 2];
    return { left: x - width / 2, right: x + width / 2, low: y - height / 2, high: y + height / 2 };
  }

  /** Draws the frame of a time. */
  show(t) {
    const frames = this.film.frames,
      k = this.frameAt(t),
      frame = frames[k];
    const { left, right, low, high } = this.box;
    const width = this.canvas.clientWidth;
    const c = sized(this.canvas, width, Math.round((width * (high - low)) / (right - left)));
    const scale = width / (right - left);
    const at = ([x, y]) => [(x - left) * scale, (high - y) * scale];
    c.lineCap = c.lineJoin = "round";
    this.walls(c, at, width);
    this.scene.bodies.forEach((_, i) => this.centre(c, at, frame, i));
    for (const shape of this.scene.outlines)
      if (!shape.wall || shape.body >= 0) this.shape(c, at, frame, shape);
    for (const pin of this.scene.pins) {
      c.beginPath();
      c.arc(...at(this.place(frame, pin.body, pin.point)), 4.5, 0, 7);
      c.fillStyle = colour("--paper");
      c.strokeStyle = colour("--ink");
      c.lineWidth = 1.5;
      c.fill();
      c.stroke();
    }
    this.arrows(c, at, k, scale);
    this.modes(k);
    c.fillStyle = colour("--faint");
    c.font = "12px system-ui";
    c.textAlign = "left";
    c.fillText(frames.at(-1)[0] < 1 ? `t = ${(1e3 * frame[0]).toFixed(2)} ms` : `t = ${frame[0].toFixed(3)} s`, 10, 18);
    if (this.gain > 1) ((c.textAlign = "right"), c.fillText(`gaps and tilt × ${this.gain.toFixed(0)}`, width - 10, 18));
  }

  walls(c, at, width) {
    const seen = new Set();
    for (const contact of this.scene.contacts) {
      if (!contact.ground) continue;
      const [x, y] = at(this.wallPoint(contact)),
        [nx, ny] = contact.normal,
        key = [x, y, nx, ny].join();
      if (seen.has(key)) continue;
      seen.add(key);
      c.save();
      (c.translate(x, y), c.rotate(Math.atan2(-ny, nx) + Math.PI / 2)); // the free side is up
      c.fillStyle = colour("--rule");
      c.fillRect(-2 * width, 0, 4 * width, 9);
      c.fillStyle = colour("--faint");
      c.fillRect(-2 * width, 0, 4 * width, 1.5);
      c.restore();
    }
  }

  /** Of a body without an outline. */
  centre(c, at, frame, i) {
    if (this.scene.outlines.some((shape) => shape.body === i)) return;
    c.beginPath();
    c.arc(...at(this.place(frame, i, [0, 0])), 3, 0, 7);
    c.fillStyle = lineColour(i);
    c.fill();
  }

  shape(c, at, frame, shape) {
    const colourOf = shape.body < 0 ? colour("--faint") : lineColour(shape.body);
    c.beginPath();
    shape.points.forEach((p, j) => c[j ? "lineTo" : "moveTo"](...at(this.place(frame, shape.body, p))));
    c.strokeStyle = colourOf;
    c.lineWidth = shape.closed || shape.wall ? 2 : 4;
    if (shape.closed) {
      c.closePath();
      c.globalAlpha = 0.18;
      c.fillStyle = colourOf;
      c.fill();
      c.globalAlpha = 1;
    }
    c.stroke();
  }

  /** At the corners that were pushed lately, longer for a larger impulse (by its root, so that small ones are seen). */
  arrows(c, at, k, scale) {
    const frames = this.film.frames,
      back = Math.max(1, Math.round(kFade * frames.length));
    this.scene.contacts.forEach((contact, i) => {
      if (contact.body === undefined) return;
      for (let j = Math.max(0, k - back + 1); j <= k; ++j) {
        const size = this.impulse(frames[j], i);
        if (!(size > 1e-9)) continue;
        const [x, y] = at(this.place(frames[k], contact.body, contact.point));
        const length = 0.12 * Math.sqrt(size / this.strongest) * scale,
          [nx, ny] = contact.normal;
        const [ex, ey] = [x + length * nx, y - length * ny];
        c.globalAlpha = 1 - (k - j) / back;
        c.strokeStyle = c.fillStyle = colour("--c1");
        c.lineWidth = 2.5;
        c.beginPath();
        c.moveTo(x, y);
        c.lineTo(ex, ey);
        c.stroke();
        c.beginPath(); // the head: along the normal, and across it
        c.moveTo(ex + 7 * nx, ey - 7 * ny);
        c.lineTo(ex - 4.5 * ny, ey - 4.5 * nx);
        c.lineTo(ex + 4.5 * ny, ey + 4.5 * nx);
        c.fill();
      }
      c.globalAlpha = 1;
    });
  }
}

class Animation {
  constructor(element, animation) {
    const films = Object.assign(document.createElement("div"), { className: "films" });
    const controls = Object.assign(document.createElement("div"), { className: "controls" });
    this.button = Object.assign(document.createElement("button"), { type: "button", textContent: "Play" });
    this.slider = Object.assign(document.createElement("input"), {
      type: "range",
      min: 0,
      max: 1,
      step: "any",
      value: 0,
    });
    this.slider.setAttribute("aria-label", "time");
    this.speed = document.createElement("select");
    this.speed.setAttribute("aria-label", "speed");
    const speeds = animation.speeds ?? [
      ["¼ speed", 0.25, false],
      ["½ speed", 0.5, false],
      ["full speed", 1, true],
      ["double speed", 2, false],
    ];
    for (const [text, factor, chosen] of speeds) this.speed.add(new Option(text, factor, chosen, chosen));
    controls.append(this.button, this.slider, this.speed);
    element.append(controls, films);
    this.films = animation.films.map((film) => new (animation.stage ?? (animation.scene.dimension === 3 ? SpaceFilm : Film))(films, film, animation));
    this.duration = Math.max(...this.films.map(({ film }) => film.frames.at(-1)[0])); // one that ended early waits
    this.seconds = animation.seconds ?? 12;
    this.position = 0.012; // of the longest film, in [0, 1]
    this.last = null;
    this.button.onclick = () => this.toggle();
    this.slider.oninput = () => {
      this.position = Number(this.slider.value);
      this.draw();
    };
    new ResizeObserver(() => this.draw()).observe(films);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.draw();
  }

  toggle() {
    this.playing = !this.playing;
    this.button.textContent = this.playing ? "Pause" : "Play";
    if (this.playing && this.position >= 1) this.position = 0;
    this.last = null;
    if (this.playing) requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    if (!this.playing) return;
    if (this.last !== null)
      this.position = Math.min(
        1,
        this.position + (Number(this.speed.value) * (now - this.last)) / (1e3 * this.seconds),
      );
    this.last = now;
    this.draw();
    if (this.position >= 1) this.toggle();
    else requestAnimationFrame((next) => this.tick(next));
  }

  draw() {
    this.slider.value = this.position;
    for (const film of this.films) film.show(this.position * this.duration);
  }
}
