// Sweeps over the same input, one above the other.

import { byId, el, show } from "../common/dom.js";
import { labelOf, pointerLabel, unitOf } from "../common/format.js";
import { draw, line } from "../common/plots.js";

const NOT_QUANTITIES = ["values", "regime", "contact", "error", "branch", "poincare", "acceleration_spectrum_m_s2"];

let jobs = [];

export function watchQuantity(failed) {
  byId("quantity").addEventListener("change", () => update().catch(failed));
}

export async function showSweeps(all, reference) {
  const sweeps = all.filter(({ points }) => points?.length);
  show(byId("sweeps"), sweeps.length > 0);
  if (!sweeps.length) return;
  const single = sweeps.filter(({ input }) => input.axes.length === 1);
  const first = single.includes(reference) ? reference : single[0];
  const pointer = first?.input.axes[0].pointer;
  jobs = single.filter(({ input }) => input.axes[0].pointer === pointer);
  const other = single.filter((job) => !jobs.includes(job));
  const two = sweeps.filter(({ input }) => input.axes.length > 1);
  const letters = (list) => list.map(({ letter }) => letter).join(", ");
  byId("sweeps-note").textContent = [
    other.length ? `${letters(other)}: another input varies; sweeps over the same input are drawn together.` : "",
    two.length ? `${letters(two)}: two inputs vary; such maps are shown on the pages of their jobs.` : "",
  ].filter(Boolean).join(" ");
  fillQuantities();
  await update();
}

function fillQuantities() {
  const names = new Map();
  for (const { points } of jobs) {
    const samples = points.slice(0, 50);
    for (const point of samples) {
      for (const [name, value] of Object.entries(point)) {
        if (NOT_QUANTITIES.includes(name) || value === null) continue;
        if (typeof value === "number") names.set(name, textOf(name, ""));
        else for (const half of ["left", "right"]) if (typeof value?.[half] === "number") names.set(`${name} ${half}`, textOf(name, half));
      }
    }
  }
  const choice = byId("quantity");
  const chosen = choice.value;
  choice.replaceChildren(...[...names].map(([name, text]) => el("option", { value: name }, text)));
  if (names.has(chosen)) choice.value = chosen;
}

const textOf = (name, half) => [[labelOf(name).replace(" rms", ", RMS"), half].filter(Boolean).join(", "), unitOf(name)].filter(Boolean).join(", ");

async function update() {
  const [name, half] = byId("quantity").value.split(" ");
  const traces = jobs.flatMap((job) => {
    const branches = [...new Set(job.points.map((point) => point.branch ?? ""))];
    return branches.map((branch) => {
      const points = job.points.filter((point) => (point.branch ?? "") === branch).sort((a, b) => a.values[0] - b.values[0]);
      const values = points.map((point) => (half ? point[name]?.[half] : point[name]) ?? null);
      return { ...line(points.map((point) => point.values[0]), values, [job.short, branch].filter(Boolean).join(", ")), colour: job.slot };
    });
  });
  show(byId("sweep"), traces.length > 0);
  if (!traces.length) return;
  const { label, unit } = pointerLabel(jobs[0].input.axes[0].pointer);
  await draw(byId("sweep").querySelector(".plot"), traces, { x: [label, unit].filter(Boolean).join(", "), y: unitOf(name) || labelOf(name), name: `Sweeps: ${textOf(name, half)}`, csvName: "compare-sweeps" });
  byId("sweeps").dataset.ready = name;
}
