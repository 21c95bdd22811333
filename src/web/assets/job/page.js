// The page of one job: follows it while it is live and shows its result when it has succeeded.

import * as api from "../common/api.js";
import { byId, el, fillWarnings, notify, show } from "../common/dom.js";
import { gearDataOf } from "../common/gear_data.js";
import { watchJob } from "../common/watch.js";
import { showOptimisation } from "../evaluations/optimise.js";
import { showScatter } from "../evaluations/tolerance.js";
import { showSweep } from "../sweep/panel.js";
import { showBearings } from "./bearings.js";
import { showHeadline } from "./headline.js";
import { showImpact } from "./impact.js";
import { Life } from "./life.js";
import { showMesh } from "./mesh.js";
import { showModes } from "./modes.js";
import { showNumerics } from "./numerics.js";
import { showPhase } from "./phase.js";
import { showResponse } from "./response.js";
import { showRotor } from "./rotor.js";
import { showSeries } from "./series.js";
import { shaftsDrawingOf, showShafts } from "./shafts.js";
import { showSpectrum } from "./spectrum.js";
import { showGeometry } from "./tables.js";
import { showValues } from "./values.js";

const id = byId("job").dataset.id ?? "";
const notice = byId("notice");
const life = new Life(id, follow);
let shown = false;
let revision = -1;

/** @param {Job} job */
function follow(job) {
  // Events and answers may overtake each other; states older than the one shown are ignored.
  if (job.revision < revision) return;
  revision = job.revision;
  life.show(job);
  if (job.kind === "sweep") {
    showSweepOf(job).catch((error) => notify(notice, error));
  } else if (job.kind === "optimise" || job.kind === "tolerance") {
    if (job.state !== "succeeded" || shown) return;
    shown = true;
    showEvaluations(job).catch((error) => notify(notice, error));
  } else if (job.state === "succeeded" && !shown) {
    shown = true;
    showResult(job).catch((error) => notify(notice, error));
  }
}

/** The panel of a sweep reads its rows itself, while they are solved. @param {Job} job */
async function showSweepOf(job) {
  await showSweep({ id, job });
  if (job.state === "succeeded") byId("job").dataset.ready = "true";
}

/** An optimisation or a tolerance study. @param {Job} job */
async function showEvaluations(job) {
  const [result, input] = await Promise.all([api.result(id), api.input(id)]);
  fillWarnings(byId("warnings"), result.warnings);
  await Promise.all([showOptimisation({ id, job, result, input }), showScatter({ id, job, result })]);
  byId("job").dataset.ready = "true";
}

/** @param {Job} job */
async function showResult(job) {
  const [result, input, gearData] = await Promise.all([api.result(id), api.input(id), gearDataOf(id)]);
  const shafts = result.shafts || result.response?.rotor ? await shaftsDrawingOf(input) : null;
  const catalogue = result.response ? (await api.catalogue(id)).items : [];
  /** @type {JobContext} */
  const all = { id, job, result, input, catalogue, gearData };
  fillWarnings(byId("warnings"), result.warnings);
  if (input.sweep_point) life.showOrigin(input.sweep_point);
  showHeadline(result);
  showResponse(all);
  showGeometry(all);
  showNumerics(all);
  showValues(all);
  const drawn = [showSeries(all), showPhase(all), showSpectrum(all), showModes(all), showMesh(all), showShafts(all, shafts), showBearings(all), showImpact(all)];
  showRotor(all, shafts);
  // With the sections, so that nothing moves when their plots are drawn.
  showContents();
  await Promise.all(drawn);
  byId("job").dataset.ready = "true";
}

/** Links to the sections that there are. */
function showContents() {
  /** @type {HTMLElement[]} */
  const all = [...document.querySelectorAll("#job section[aria-labelledby]")].map((node) => /** @type {HTMLElement} */ (node));
  const sections = all.filter((section) => !section.hidden);
  byId("contents").replaceChildren(...sections.map((section) => el("a", { href: `#${section.id}` }, section.dataset.short ?? section.querySelector("h2")?.textContent)));
  show(byId("contents"), sections.length > 1);
}

try {
  const job = await api.job(id);
  follow(job);
  if (!api.isEnded(job)) {
    watchJob(id, {
      onJob: follow,
      onMode: (mode) => life.showMode(mode),
      onGone: () => notify(notice, { problem: { title: "This job was deleted." } }),
    });
  }
} catch (error) {
  notify(notice, error);
}
