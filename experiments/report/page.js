// The page from its data: for each sweep the question, the answer, the motion, the figures, the tables.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const main = document.getElementById("page");

function add(parent, tag, text, properties = {}) {
  const element = Object.assign(document.createElement(tag), properties);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

/**
 * A header and rows of texts; `words`: how many columns from the left are words; best: [row, column] pairs to mark;
 * `prose`: the last column is sentences.
 */
function table(parent, header, rows, words = 1, best = [], prose = false) {
  const element = add(add(parent, "div", undefined, { className: "scroll" }), "table");
  const line = (cells, tag, r) => {
    const tr = add(element, "tr");
    cells.forEach((cell, c) =>
      add(tr, tag, cell, {
        className: (c < words ? "word " : prose && c === cells.length - 1 ? "prose " : "") + (best.some(([i, j]) => i === r && j === c) ? "best" : ""),
      }),
    );
  };
  line(header, "th", -1);
  rows.forEach((row, r) => line(row, "td", r));
}

const letters = { mu: "µ", omega3: "ω₃", theta3: "θ₃", e_n: "e" };
const letter = (name) => letters[name.split(".").at(-1)] ?? name;
const units = { clearance: " m", omega3: " rad/s", theta3: " rad" }; // of built-in scenes
const parametersInWords = (text) =>
  Object.entries(JSON.parse(text))
    .map(([k, v]) => (k === "scene" ? v : `${letter(k)} = ${v}${units[k] ?? ""}`))
    .join(", ") || "as the scene has it";

/** The columns of a sweep as a list of rows; parameters are columns too, and so are losses that follow from others. */
function rowsOf(sweep) {
  const names = Object.keys(sweep.rows);
  return sweep.rows.status.map((_, i) => {
    const row = Object.fromEntries(names.map((name) => [name, sweep.rows[name][i]]));
    const lost = row.energy_initial === null ? null : row.energy_initial - row.energy_final;
    return {
      ...JSON.parse(row.parameters),
      ...row,
      energy_lost: lost,
      // of what turns by half a revolution at least
      lost_per_turn: lost === null || !(Math.abs(row.value) > Math.PI) ? null : (2 * Math.PI * lost) / Math.abs(row.value),
    };
  });
}

const unique = (list) => [...new Set(list)];
const worst = (rows, column) => rows.reduce((most, row) => Math.max(most, row[column] ?? Infinity), 0);

/** One point a setting, the worst of its rows in both directions; a setting that failed anywhere is left out. */
function worstOfSettings(rows, figure) {
  const setting = (row) => row.rtol ?? row.step;
  return unique(rows.map(setting))
    .map((s) => rows.filter((row) => setting(row) === s))
    .filter((same) => same.every((row) => row.status === "solved"))
    .map((same) => ({
      x: worst(same, figure.x),
      y: worst(same, figure.y),
      note: same[0].rtol ? `rtol ${shown(same[0].rtol)}` : `h ${shown(same[0].step)} s`,
    }));
}

function linesOf(sweep, rows, figure, choice) {
  const lines = [];
  const colours = unique(sweep.rows[figure.by] ?? rows.map((row) => row[figure.by])); // the same name, the same colour
  unique(rows.map((row) => row[figure.by])).forEach((name) => {
    const colour = colours.indexOf(name);
    const own = rows.filter((row) => row[figure.by] === name && row.status === "solved");
    const all = rows.filter((row) => row[figure.by] === name);
    const points =
      figure.worst && !choice
        ? worstOfSettings(all, figure)
        : own.map((row) => ({
            x: row[figure.x],
            y: row[figure.y],
            note: figure.x === "step" ? "" : row.rtol ? `rtol ${shown(row.rtol)}` : `h ${shown(row.step)} s`,
          })).sort((a, b) => a.x - b.x); // whatever grid a point is of
    const fit =
      figure.octaves &&
      sweep.orders.find((o) => o.integrator === name && o.parameters === choice && o.solver === own[0]?.solver);
    const line = (list, more) =>
      lines.push({
        name: String(name),
        label: String(name),
        colour,
        x: list.map((p) => p.x),
        y: list.map((p) => p.y),
        notes: list.map((p) => p.note),
        ...more,
      });
    if (fit)
      line(
        fit.worst.map(([x, y]) => ({ x, y, note: "the worst of its octave" })),
        { label: `${name}: order ${fit.order.toFixed(2)}` },
      );
    if (points.length) line(points, { dots: Boolean(fit || figure.octaves || figure.dots), faint: Boolean(fit || figure.octaves) });
  });
  return lines;
}

/** The parameters that no axis shows, as text: what a reader has to choose. */
function besideAxes(row, figure) {
  const axes = [figure.x, figure.y, figure.by];
  const all = JSON.parse(row.parameters);
  if (!axes.some((name) => name in all)) return row.parameters;
  return JSON.stringify(Object.fromEntries(Object.entries(all).filter(([name]) => !axes.includes(name))));
}

function drawFigure(parent, sweep, rows, figure) {
  const block = add(parent, "section");
  add(block, "h2", figure.title);
  if (figure.note) add(block, "p", figure.note, { className: "note" });
  const used = rows.filter(
    (row) =>
      (figure.timed ? row.repeats > 0 : row.repeats === 0 || figure.timed === undefined) &&
      Number.isFinite(row[figure.x]) &&
      Number.isFinite(row[figure.y]) &&
      !(figure.x === "step" && row.rtol) && // there it is no step size but how far a call goes
      ["solver", "integrator"].every((name) => !figure[name] || row[name] === figure[name]) &&
      Object.entries(figure.where ?? {}).every(([name, wanted]) => row[name] === undefined || [wanted].flat().includes(row[name])),
  );
  const choices = unique(used.map((row) => besideAxes(row, figure)));
  const chosen = choices.length > 1;
  const pick = document.createElement("select");
  pick.setAttribute("aria-label", "parameters");
  if (figure.worst) pick.add(new Option("the worst of all parameters", ""));
  for (const text of choices) pick.add(new Option(parametersInWords(text), text));
  const middle = choices.find((text) => text === figure.first);
  if (!figure.worst && middle) pick.value = middle;
  const build = () => {
    const choice = chosen ? pick.value : "";
    const some = choice ? used.filter((row) => besideAxes(row, figure) === choice) : used;
    return {
      lines: linesOf(sweep, some, figure, chosen ? choice : choices[0]),
      log: figure.log ?? "",
      x_label: figure.x_label ?? figure.x,
      y_label: figure.y_label ?? figure.y,
    };
  };
  const controls = add(block, "div", undefined, { className: "controls" });
  if (chosen) controls.append(pick);
  add(controls, "span", "Drag to zoom, double-click for all; a name in the legend hides its line.", {
    className: "note",
  });
  const element = add(block, "div");
  const plot = new Plot(element, build());
  pick.onchange = () => plot.set(build());
  plots.push(plot);
}

function drawTimes(parent, sweep) {
  if (!sweep.times.length) return;
  add(parent, "h2", "Time to an error");
  add(
    parent,
    "p",
    "Processor time in milliseconds, the worst over the parameters; the cheapest timed setting from which on every finer timed one is as good, so known to the factor between two settings; –: not reached in this sweep.",
    { className: "note" },
  );
  const best = sweep.targets.map((_, k) =>
    sweep.times.reduce(
      (at, entry, r) =>
        entry.seconds[k] !== null && (at < 0 || entry.seconds[k] < sweep.times[at].seconds[k]) ? r : at,
      -1,
    ),
  );
  table(
    parent,
    ["method", ...sweep.targets.map((t) => `10${raised(Math.round(Math.log10(t)))}`)],
    sweep.times.map((entry) => [
      entry.integrator,
      ...entry.seconds.map((s) => (s === null ? "–" : shown(Number((1e3 * s).toPrecision(2))))),
    ]),
    1,
    best.flatMap((r, k) => (r < 0 ? [] : [[r, k + 1]])),
  );
}

function drawOrders(parent, sweep) {
  if (!sweep.orders.length) return;
  add(parent, "h2", "Orders of convergence");
  add(
    parent,
    "p",
    "Slope of the worst error of each octave of h, in logarithms; in brackets its scatter (above about 0.5 it is no straight line).",
    { className: "note" },
  );
  const cases = unique(sweep.orders.map((o) => o.parameters)),
    methods = unique(sweep.orders.map((o) => o.integrator));
  const cell = (method, parameters) => {
    const o = sweep.orders.find((x) => x.integrator === method && x.parameters === parameters);
    return o ? `${o.order.toFixed(2)} (${o.scatter.toFixed(1)})` : "–";
  };
  table(
    parent,
    ["method", ...cases.map((text) => parametersInWords(text).replaceAll(", ", "\n"))],
    methods.map((m) => [m, ...cases.map((p) => cell(m, p))]),
  );
}

function drawFailures(parent, rows) {
  const failed = rows.filter((row) => row.status !== "solved");
  add(parent, "h2", failed.length ? `What failed: ${failed.length} of ${rows.length} runs` : "Nothing failed");
  if (!failed.length)
    return void add(
      parent,
      "p",
      `All ${rows.length} runs ended solved: every complementarity problem was accepted by the judge.`,
      { className: "note" },
    );
  const hint = add(parent, "p", undefined, { className: "note" });
  add(hint, "code", "orthant results FILE --failures");
  hint.append(" writes each problem to a file that ");
  add(hint, "code", "orthant solve");
  hint.append(" replays.");
  const groups = unique(failed.map((row) => [row.integrator, row.solver, row.status, row.why].join("\n")));
  const said = failed.some((row) => row.why); // a limit that was reached says all by its name
  table(
    parent,
    ["method", "solver", "ended as", "runs", ...(said ? ["in words"] : [])],
    groups.map((key) => {
      const [integrator, solver, status, why] = key.split("\n");
      return [
        integrator,
        solver,
        status,
        String(failed.filter((row) => [row.integrator, row.solver, row.status, row.why].join("\n") === key).length),
        ...(said ? [why] : []),
      ];
    }),
    3,
    [],
    said,
  );
}

const plots = [],
  animations = [];
for (const sweep of data.sweeps) {
  const rows = rowsOf(sweep);
  add(main, "p", `Orthant · ${sweep.name.replaceAll("_", " ")}`, { className: "name" });
  add(main, "h1", sweep.question || sweep.name);
  add(main, "p", sweep.answer, { className: "answer" });
  const missing = sweep.asked - rows.length;
  if (missing > 0) add(main, "p", `${missing} of ${sweep.asked} cases are still to be run.`, { className: "note" });
  for (const animation of sweep.animations) {
    add(main, "h2", animation.title);
    if (animation.note) add(main, "p", animation.note, { className: "note" });
    animations.push(new Animation(add(main, "div"), animation));
  }
  for (const figure of sweep.figures) drawFigure(main, sweep, rows, figure);
  drawTimes(main, sweep);
  drawOrders(main, sweep);
  drawFailures(main, rows);
}
add(
  main,
  "footer",
  `Revision ${data.revision}; ${data.compiler}, ${data.flags}; ${data.cpu}, ${data.cores} cores; ${Object.entries(
    data.packages,
  )
    .map((p) => p.join(" "))
    .join(", ")}. Plots: uPlot${typeof THREE === "undefined" ? "" : ", in space three.js"}.`,
);
document.title = `Orthant: ${data.sweeps.map((s) => s.name.replaceAll("_", " ")).join(", ")}`;
