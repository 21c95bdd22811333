// The outcome of a tolerance study: histogram, percentiles with their intervals, influence of the tolerances.

import { bodyOf, byId, el, fillRows, fillValues, show, showFigureOf } from "../common/dom.js";
import { number, sentence, shownUnit } from "../common/format.js";
import { bars, draw } from "../common/plots.js";
import { inputLabel, openRow } from "./rows.js";

/** @param {{ id: string, job: Job, result: JobResult }} context */
export async function showScatter({ id, job, result }) {
  const found = result.tolerance;
  if (!found) return;
  show(byId("tolerance"));
  const choice = byId("tolerance-measure");
  choice.replaceChildren(...found.measures.map(({ label }, index) => el("option", { value: String(index) }, sentence(label))));
  const chosen = () => found.measures[Number(choice.value)];
  choice.addEventListener("change", () => showMeasure(chosen(), found));
  fillValues(byId("tolerance-numerics"), [
    ["Points", number(found.samples)],
    ["Sampling", found.sampling === "sobol" ? "scrambled Sobol" : "random"],
    ["Failed", number(found.failed)],
    ["Values cut at the range of their field", found.clipped ? number(found.clipped) : null],
    ["Seed", number(found.seed)],
  ]);
  byId("tolerance-csv").href = `/api/v1/jobs/${encodeURIComponent(id)}/points?decimal=point`;
  const button = byId("tolerance-open");
  button.addEventListener("click", () => openRow(button, { id, name: job.name ?? "Tolerances", position: chosen().worst_position ?? 0, what: "worst point" }));
  await showMeasure(found.measures[0], found);
}

/** @param {MeasureScatter} measure @param {ToleranceStudy} found */
async function showMeasure(measure, found) {
  const unit = shownUnit(measure.unit);
  const { percentiles, histogram, beyond_limit: beyond } = measure;
  const p90 = percentiles.p90;
  const limit = beyond ? ` ${number(100 * beyond.share, 3)} % (${number(100 * beyond.low, 2)} to ${number(100 * beyond.high, 2)} %) are beyond the limit.` : "";
  byId("tolerance-verdict").textContent = p90 ? `${sentence(measure.label)}: ${number(measure.nominal, 4)} ${unit} without deviations, below ${number(p90.value, 4)} ${unit} in 90 of 100 pairs.${limit}` : `${sentence(measure.label)}: ${number(measure.nominal, 4)} ${unit} without deviations.`;
  fillRows(bodyOf(byId("tolerance-table")), Object.entries(percentiles).sort(([a], [b]) => Number(a.slice(1)) - Number(b.slice(1))).map(([name, { value, low, high }]) => [name.toUpperCase(), number(value), low === null ? "sample too small" : number(low), high === null ? "sample too small" : number(high)]));
  const of = found.sensitivity.filter((one) => one.measure === measure.measure);
  const share = (value) => (typeof value === "number" ? number(100 * value, 3) : "–");
  fillRows(bodyOf(byId("tolerance-inputs")), of.map((one) => [inputLabel(one.input), number(one.rank_correlation, 3), share(one.first_order), share(one.total), number(one.halved_p90, 4), number(one.effect, 3)]));
  const box = byId("tolerance-plot");
  showFigureOf(box, Boolean(histogram));
  if (histogram) {
    const width = (histogram.to - histogram.from) / histogram.counts.length;
    const x = histogram.counts.map((_, index) => histogram.from + (index + 0.5) * width);
    const marks = [[measure.nominal, "nominal"], [p90?.value, "P90"], [beyond?.at_most, "limit"], [beyond?.at_least, "limit"]].filter(([at]) => typeof at === "number").map(([at, text]) => ({ x: Number(at), text: String(text) }));
    await draw(box, [bars(x, histogram.counts)], { x: { label: sentence(measure.label), unit }, y: "Points", marks });
  }
  await drawInputs(of);
}

/** @param {InputSensitivity[]} inputs */
async function drawInputs(inputs) {
  const box = byId("tolerance-inputs-plot");
  const shown = inputs.filter((one) => typeof one.first_order === "number");
  showFigureOf(box, shown.length > 0);
  if (shown.length === 0) return;
  shown.sort((a, b) => Number(b.first_order) - Number(a.first_order));
  const noise = shown[0].first_order_noise;
  byId("tolerance-inputs-note").textContent = typeof noise === "number" ? `Shares below ${number(100 * noise, 2)} % are not different from zero.` : "";
  const levels = typeof noise === "number" ? [{ y: 100 * noise, text: "noise" }] : [];
  const totals = shown.some((one) => typeof one.total === "number") ? [bars(shown.map((one) => inputLabel(one.input)), shown.map((one) => (typeof one.total === "number" ? 100 * one.total : null)), "with interactions")] : [];
  await draw(box, [bars(shown.map((one) => inputLabel(one.input)), shown.map((one) => 100 * Number(one.first_order)), "alone"), ...totals], { x: "Input", y: { label: "Share of the variance", unit: "%" }, levels, fromZero: true });
}
