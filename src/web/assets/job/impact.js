// The mesh-in impact: the forces beside each other, the pulse, what they come from.

import { byId, fillRows, fillValues, show, showFigureOf } from "../common/dom.js";
import { number } from "../common/format.js";
import { draw } from "../common/plots.js";
import { pulsePlot } from "./impact_plots.js";
import { ACTS_ON, IMPACTS } from "./words.js";

/** @param {JobContext} context */
export async function showImpact({ result: { impact, geometry, response, mesh }, input }) {
  if (!impact) return;
  fillRows(byId("impact-table").tBodies[0], impactRows(impact));
  fillValues(byId("impact-values"), impactValues(impact));
  show(byId("impact"));
  const frequency = response?.mesh_frequency_hz ?? geometry?.mesh_frequency_hz;
  const pulse = pulsePlot(impact, frequency ?? null);
  showFigureOf(byId("impact-plot"), Boolean(pulse));
  if (!pulse || !frequency) return;
  const stagger = input?.design?.half_stagger;
  byId("impact-note").textContent = [
    `Once per mesh period (${number(1e6 / frequency, 4)} µs) and half.`,
    stagger ? `The right half's begins ${number(stagger, 3)} mesh periods earlier.` : "",
    mesh?.right_curve ? "The halves differ: these are the numbers of the left one." : "",
  ].filter(Boolean).join(" ");
  await draw(byId("impact-plot"), pulse.traces, pulse.axes);
}

/** @param {ImpactResult} impact @returns {Child[][]} */
export function impactRows(impact) {
  const calculated = typeof impact.zhou2008_force_n === "number";
  const first = impact.source === "given" ? "Given" : "Corner contact, buffered by the pairs in mesh";
  return [
    [first, `${number(impact.force_n)} N`],
    ...(calculated ? [["Zhou 2008, unbuffered", `${number(impact.zhou2008_force_n)} N`], ["Reduction", `${number(impact.reduction_percent, 4)} %`]] : []),
  ];
}

/** @param {ImpactResult} impact @returns {ValueRow[]} */
export function impactValues(impact) {
  /** @param {number | null | undefined} shown */
  const value = (shown, digits = 4) => (typeof shown === "number" ? number(shown, digits) : null);
  return [
    ["Excites the response", impact.applied === false ? "no: only reported" : (IMPACTS[impact.source] ?? impact.source)],
    ["Moves", impact.applied === false ? null : (ACTS_ON[impact.acts_on] ?? null)],
    ["Impact velocity", value(impact.velocity_m_s), "m/s"],
    ["Length of the pulse", value(impact.duration_us), "µs"],
    ["Length by the balance of energy", value(impact.energy_balance_duration_us), "µs"],
    ["Start", value(impact.start_mesh_periods), "mesh periods"],
    ["Inclination of the line of action θ", value(impact.theta_deg), "°"],
    ["Equivalent mass", value(impact.equivalent_mass_kg), "kg"],
    ["Stiffness of the entering pair", value(impact.single_pair_stiffness_n_per_um), "N/µm"],
    ["Stiffness of the pairs in mesh", value(impact.other_pairs_stiffness_n_per_um), "N/µm"],
    ["Deflection at the first touch", value(impact.corner_deflection_um), "µm"],
    ["Roll before the theoretical start", value(impact.corner_overrun_mm), "mm"],
  ];
}
