// The mesh-in impact: the forces beside each other, the pulse, and the quantities from which they are calculated.

import { byId, fillRows, fillValues, show, showFigureOf, theoryLink } from "../common/dom.js";
import { number } from "../common/format.js";
import { draw } from "../common/plots.js";
import { rowsFrom, scalarAt } from "../common/scalars.js";
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
    [theoryLink(scalarAt("/impact/force_n"), first), `${number(impact.force_n)} N`],
    ...(calculated ? [[theoryLink(scalarAt("/impact/zhou2008_force_n"), "Zhou 2008, unbuffered"), `${number(impact.zhou2008_force_n)} N`], [theoryLink(scalarAt("/impact/reduction_percent"), "Reduction"), `${number(impact.reduction_percent, 4)} %`]] : []),
  ];
}

/** @param {ImpactResult} impact @returns {ValueRow[]} */
export function impactValues(impact) {
  const row = rowsFrom({ impact });
  return [
    [scalarAt("/impact/source").label, IMPACTS[impact.source] ?? impact.source, "", scalarAt("/impact/source")],
    [scalarAt("/impact/applied").label, impact.applied === false ? "no: only reported" : "yes", "", scalarAt("/impact/applied")],
    [scalarAt("/impact/acts_on").label, impact.applied === false ? null : (ACTS_ON[impact.acts_on] ?? null), "", scalarAt("/impact/acts_on")],
    row("/impact/velocity_m_s", 4),
    row("/impact/duration_us", 4),
    row("/impact/energy_balance_duration_us", 4),
    row("/impact/start_mesh_periods", 4),
    row("/impact/theta_deg", 4),
    row("/impact/equivalent_mass_kg", 4),
    row("/impact/single_pair_stiffness_n_per_um", 4),
    row("/impact/other_pairs_stiffness_n_per_um", 4),
    row("/impact/corner_deflection_um", 4),
    row("/impact/corner_overrun_mm", 4),
  ];
}
