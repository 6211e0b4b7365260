// Plots over uPlot: several lines of their own x each, logarithmic axes, the value under the pointer, zoom by dragging.
//   new Plot(element, {lines: [{name, label, x: [], y: [], notes: [], dots, faint, colour}], log: "xy", x_label, y_label})
"use strict";

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const lineColour = (i) => colour(`--c${i % 9}`);

// A shape for each colour, for those who do not tell colours apart: paths in units of a mark's half width.
const MARKS = [
  "M-.9-.9H.9V.9H-.9Z",
  "M0-1.25L1.25 0 0 1.25-1.25 0Z",
  "M-1 0A1 1 0 1 1 1 0 1 1 0 1 1-1 0Z",
  "M0-1.1L1.15.95H-1.15Z",
  "M0 1.1L1.15-.95H-1.15Z",
  "M-.4-1.15H.4V-.4H1.15V.4H.4V1.15H-.4V.4H-1.15V-.4H-.4Z",
  "M0-.55L.6-1.15 1.15-.6.55 0 1.15.6.6 1.15 0 .55-.6 1.15-1.15.6-.55 0-1.15-.6-.6-1.15Z",
  "M0-1.3L.35-.4 1.24-.4.52.17.8 1.05 0 .53-.8 1.05-.52.17-1.24-.4-.35-.4Z",
  "M0-1.35L.75 0 0 1.35-.75 0Z",
];
const markPaths = MARKS.map((path) => new Path2D(path));

/** Three digits, powers of ten where plain digits would be long. */
function shown(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size < 1e-3 || size >= 1e5
    ? value.toExponential(2).replace(/\.?0*e\+?/, "e")
    : String(Number(value.toPrecision(4)));
}

const raised = (power) => String(power).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻");

const mantissa = (v) => v / 10 ** Math.floor(Math.log10(v) + 1e-9);
const isTen = (v) => v !== null && Math.abs(mantissa(v) - 1) < 1e-6;

/** Where a logarithmic axis has ticks, in any range: m · 10^k, powers of ten alone where these are many; round numbers
 *  evenly apart in less than half a decade. (uPlot's own begin at the lower end and need not meet a power of ten.) */
function logTicks(plot, axis, min, max) {
  if (!(min > 0 && max > min && max < Infinity)) return [];
  if (max / min < 4) {
    const rough = (max - min) / 4,
      ten = 10 ** Math.floor(Math.log10(rough)),
      step = [1, 2, 5, 10].find((m) => m * ten >= rough) * ten,
      first = Math.ceil(min / step);
    return Array.from({ length: Math.floor(max / step) - first + 1 }, (_, i) => (first + i) * step);
  }
  const low = Math.floor(Math.log10(min)),
    high = Math.ceil(Math.log10(max)),
    every = high - low > 6 ? [1] : [1, 2, 3, 4, 5, 6, 7, 8, 9];
  const ticks = [];
  for (let k = low; k <= high; ++k) for (const m of every) ticks.push(Number(`${m}e${k}`));
  return ticks.filter((v) => v >= min && v <= max);
}

/** Labels of a logarithmic axis: powers of ten, thinned where there are many; where there are few, 2 and 5 between. */
function powers(plot, ticks) {
  const few = plot.width < 600 ? 2 : 3;
  const tens = ticks.filter(isTen),
    every = Math.ceil(tens.length / 9);
  return ticks.map((v) => {
    if (tens.length === 0) return shown(v);
    if (isTen(v)) return tens.indexOf(v) % every ? "" : "10" + raised(Math.round(Math.log10(v)));
    return tens.length < few && v !== null && [2, 5].some((m) => Math.abs(mantissa(v) - m) < 1e-6) ? shown(v) : "";
  });
}
const tensOnly = (plot, ticks) => (ticks.some(isTen) ? ticks.map((v) => (isTen(v) ? v : null)) : ticks);

/** Room for the longest label of a y axis: 18.0835 takes more than 0.1. */
const roomFor = (plot, values) => Math.max(56, 28 + 7 * Math.max(0, ...(values ?? []).map((text) => String(text ?? "").length)));

class Plot {
  constructor(element, figure) {
    this.element = element;
    this.figure = figure;
    this.hidden = new Set(); // names of lines
    element.classList.add("plot");
    this.draw();
    new ResizeObserver(() => this.fit()).observe(element);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  set(figure) {
    this.figure = figure;
    this.draw();
  }

  fit() {
    const width = this.element.clientWidth;
    if (width && width !== this.plot.width) this.plot.setSize({ width, height: this.height() });
  }

  height() {
    return Math.round(Math.min(460, Math.max(300, 0.62 * this.element.clientWidth)));
  }

  axis(log, label, size) {
    const lines = { stroke: colour("--rule"), width: 1, ...(log ? { filter: tensOnly } : {}) };
    return {
      stroke: colour("--faint"),
      grid: lines,
      ticks: lines,
      label,
      labelSize: 26,
      size,
      font: "12px system-ui",
      labelFont: "13px system-ui",
      ...(log
        ? { splits: logTicks, values: powers, filter: (plot, ticks) => ticks }
        : { values: (plot, ticks) => ticks.map((v) => String(Number(v.toPrecision(7)))) }),
    };
  }

  draw() {
    const { lines, log, x_label, y_label } = this.figure;
    const usable = (v, is_log) => Number.isFinite(v) && (!is_log || v > 0);
    const log_x = log.includes("x"),
      log_y = log.includes("y");
    this.points = lines.map((line) =>
      line.x
        .map((x, i) => ({ x, y: line.y[i], note: line.notes?.[i] ?? "" }))
        .filter((p) => usable(p.x, log_x) && usable(p.y, log_y)),
    );
    // uPlot wants one ascending x list for all. So it has the axes and scales, and ink() draws lines and marks, in the order
    // given (of settings: the times that they take may go up and down). Equal x of one line are moved apart by rounding.
    const ascending = this.points.map((points) => points.toSorted((a, b) => a.x - b.x));
    for (const points of ascending)
      for (let i = 1; i < points.length; ++i)
        if (points[i].x <= points[i - 1].x) points[i].x = points[i - 1].x * (1 + 1e-12) + 1e-300;
    const some = this.points.some((points) => points.length > 0);
    const data = some
      ? uPlot.join(ascending.map((points) => [points.map((p) => p.x), points.map((p) => p.y)]))
      : [[1, 10], ...lines.map(() => [null, null])];
    const series = lines.map((line) => ({
      label: line.label,
      paths: () => null,
      show: !this.hidden.has(line.name),
      points: { show: false },
    }));
    const grow = (is_log) => (_, low, high) => {
      if (!(low < high)) return is_log ? [low / 3, high * 3] : [low - 1, high + 1];
      const margin = is_log ? Math.pow(high / low, 0.06) : 0.06 * (high - low);
      return is_log ? [low / margin, high * margin] : [low - margin, high + margin];
    };
    this.plot?.destroy();
    this.element.replaceChildren();
    this.tip = Object.assign(document.createElement("div"), { className: "tip", hidden: true });
    this.plot = new uPlot(
      {
        width: Math.max(200, this.element.clientWidth),
        height: this.height(),
        scales: {
          x: { time: false, distr: log_x ? 3 : 1, range: grow(log_x) },
          y: { distr: log_y ? 3 : 1, range: grow(log_y) },
        },
        axes: [this.axis(log_x, x_label, 42), this.axis(log_y, y_label, roomFor)],
        series: [{}, ...series],
        cursor: { drag: { x: true, y: true, uni: 25 }, points: { show: false } },
        legend: { show: false },
        hooks: { setCursor: [() => this.tell()], drawAxes: [() => this.ink()] },
      },
      data,
      this.element,
    );
    this.plot.over.append(this.tip);
    this.legend();
  }

  /** Lines and marks; later marks are smaller, so that those of lines that coincide are all seen. */
  ink() {
    const { ctx, bbox } = this.plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    this.figure.lines.forEach((line, i) => {
      if (this.hidden.has(line.name)) return;
      const which = line.colour ?? i;
      const places = this.points[i].map((p) => [this.plot.valToPos(p.x, "x", true), this.plot.valToPos(p.y, "y", true)]);
      ctx.strokeStyle = ctx.fillStyle = lineColour(which);
      ctx.globalAlpha = line.faint ? 0.5 : 1;
      if (!line.dots) {
        ctx.lineWidth = 2 * devicePixelRatio;
        ctx.lineJoin = "round";
        ctx.beginPath();
        for (const place of places) ctx.lineTo(...place);
        ctx.stroke();
      }
      const size = (line.faint ? 2.5 : 5.5 - (2 * i) / this.figure.lines.length) * devicePixelRatio;
      for (const place of places) {
        ctx.save();
        ctx.translate(...place);
        ctx.scale(size, size);
        ctx.fill(markPaths[which % MARKS.length]);
        ctx.restore();
      }
    });
    ctx.restore();
  }

  /** A button a name; all that has the name, line and dots, is shown or hidden. */
  legend() {
    const names = new Map();
    this.figure.lines.forEach((line, i) => {
      if (!names.has(line.name)) names.set(line.name, { label: line.label, colour: line.colour ?? i });
    });
    const box = Object.assign(document.createElement("div"), { className: "legend" });
    for (const [name, { label, colour }] of names) {
      const button = Object.assign(document.createElement("button"), { type: "button", textContent: label });
      button.style.setProperty("--mark", `var(--c${colour % 9})`);
      button.insertAdjacentHTML("afterbegin", `<svg viewBox="-1.4 -1.4 2.8 2.8"><path d="${MARKS[colour % MARKS.length]}"/></svg>`);
      button.setAttribute("aria-pressed", !this.hidden.has(name));
      button.onclick = () => {
        this.hidden[this.hidden.has(name) ? "delete" : "add"](name);
        button.setAttribute("aria-pressed", !this.hidden.has(name));
        this.figure.lines.forEach((line, i) => {
          if (line.name === name) this.plot.setSeries(i + 1, { show: !this.hidden.has(name) });
        });
      };
      box.append(button);
    }
    this.element.append(box);
  }

  /** The point next to the pointer, if one is near. */
  tell() {
    const { left, top } = this.plot.cursor;
    let best = null,
      distance = 30 ** 2;
    this.points.forEach((points, i) => {
      if (!this.plot.series[i + 1].show) return;
      for (const p of points) {
        const d = (this.plot.valToPos(p.x, "x") - left) ** 2 + (this.plot.valToPos(p.y, "y") - top) ** 2;
        if (d < distance) [best, distance] = [{ ...p, label: this.figure.lines[i].label }, d];
      }
    });
    this.tip.hidden = !best || left < 0;
    if (!best) return;
    this.tip.innerText =
      `${best.label}\n${this.figure.x_label}: ${shown(best.x)}\n${this.figure.y_label}: ${shown(best.y)}` +
      (best.note ? `\n${best.note}` : "");
    const right = left > this.plot.over.clientWidth / 2;
    this.tip.style.left = right ? "" : `${left + 14}px`;
    this.tip.style.right = right ? `${this.plot.over.clientWidth - left + 14}px` : "";
    this.tip.style.top = `${Math.min(top, this.plot.over.clientHeight - 80)}px`;
  }
}
