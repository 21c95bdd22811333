// The report of a comparison: the tables and figures of the page, on paper.

import { byId, el, notify, show } from "../common/dom.js";
import { instant } from "../common/format.js";
import * as address from "../compare/address.js";
import { LETTERS, entriesOf } from "../compare/entries.js";
import { figuresOf, optionsTold } from "../compare/figures.js";
import { load } from "../compare/load.js";
import { sweepFigureOf } from "../compare/sweeps.js";
import { showTables } from "../compare/tables.js";
import { HIGH, showFigures } from "./figures.js";
import { showSheet } from "./sheet.js";

/** @type {Record<string, string>} */
const TITLES = {
  stiffness: "Mesh stiffness of one half", error: "Loaded transmission error", share: "Share of the load of one pair", "face-load": "Line load along both faces, on the shafts", "bearing-forces": "Dynamic forces of the bearings", impact: "Mesh-in impact",
  series: "Time series, aligned at the mesh period", phase: "Phase plane of the mesh", spectrum: "Spectrum of the left circumferential acceleration",
};

async function start() {
  const view = address.read();
  byId("back").href = `/compare${window.location.search}`;
  if (!view.ids.length) throw new Error("The address names no jobs: the report is opened from the comparison.");
  const known = new Map((await Promise.all(view.ids.map((id) => load(id)))).map((entry) => [entry.id, entry]));
  const jobs = entriesOf(view.ids, known, (id) => view.ids.indexOf(id) % LETTERS.length);
  const reference = jobs.find(({ id }) => id === view.reference) ?? jobs[0];
  document.title = `Comparison of ${jobs.map(({ name }) => name).join(", ")} · report`;
  byId("facts").replaceChildren(...jobs.map(({ mark, name, job, id }) => el("div", {}, el("dt", {}, mark(), ` ${name}`), el("dd", {}, job?.ended_at ? instant(job.ended_at) : job?.state ?? "deleted", el("br"), el("code", {}, id)))));
  show(byId("head"));
  showSheet(view.ids.join(","));
  showTables(jobs, reference);
  const figures = await figuresOf(jobs, optionsTold());
  const swept = sweepFigureOf(jobs, reference);
  await showFigures([
    ...(swept ? [{ title: swept.axes.name, traces: swept.traces, axes: swept.axes, size: HIGH }] : []),
    ...figures.map(({ id, traces, axes }) => ({ title: TITLES[id], traces, axes: { ...axes, link: undefined } })),
  ]);
  byId("print").disabled = false;
  byId("report").dataset.ready = "true";
}

byId("print").addEventListener("click", () => window.print());
start().catch((error) => notify(byId("notice"), error));
