// Mesh stiffness, transmission error, load sharing and the load on the flank.

import { byAnyId, byId, fillValues, show, showFigureOf } from "../common/dom.js";
import { number } from "../common/format.js";
import { draw } from "../common/plots.js";
import { rowsFrom, scalarAt } from "../common/scalars.js";
import { errorPlot, flankPlot, harmonicsPlot, sharePlot, sharingPlot, stiffnessPlot } from "./mesh_plots.js";
import { STIFFNESS } from "./words.js";

const LAWS = { transmission_error: "equivalent to the transmission error", secant: "secant", tangent: "tangent" };

/** @param {JobContext} context */
export async function showMesh({ result: { mesh }, input, gearData }) {
  if (!mesh) return;
  fillValues(byId("mesh-values"), meshValues(mesh, input));
  show(byId("mesh"));
  await Promise.all([
    plot("stiffness-plot", stiffnessPlot(mesh)),
    plot("error-plot", errorPlot(mesh)),
    plot("harmonics-plot", harmonicsPlot(mesh)),
    plot("share-plot", sharePlot(mesh, gearData)),
    plot("sharing-plot", sharingPlot(mesh)),
    plot("flank-plot", flankPlot(mesh, gearData)),
  ]);
  if (typeof mesh.max_line_load_n_per_mm === "number") {
    byId("flank-note").textContent = [
      `Mean over the mesh period in each cell. Greatest at any position: ${number(mesh.max_line_load_n_per_mm, 4)} N/mm`,
      typeof mesh.max_line_load_interior_n_per_mm === "number" ? `, away from the ends of the lines ${number(mesh.max_line_load_interior_n_per_mm, 4)} N/mm` : "",
      ". Dashed: lines of contact when a pair enters.",
    ].join("");
  }
  byId("share-note").textContent = `A to E: theoretical start, inner and outer limits of single contact and end at the end of the face where teeth enter.`;
  show(byId("share-note"), Boolean(gearData));
}

/** @param {number | null | undefined} low @param {number | null | undefined} high @param {number} [digits] */
const range = (low, high, digits) => (typeof low === "number" && typeof high === "number" ? (low === high ? number(low, digits) : `${number(low, digits)} to ${number(high, digits)}`) : null);

/** @param {MeshResult} mesh @param {JobInput} input @returns {ValueRow[]} */
export function meshValues(mesh, input) {
  const law = mesh.contact_force ? "none: the force of the loaded contact over approach and phase" : mesh.source === "ltca" ? LAWS[input?.model?.mesh_stiffness?.law] : null;
  const row = rowsFrom({ mesh });
  return [
    [scalarAt("/mesh/source").label, STIFFNESS[mesh.source] ?? mesh.source, "", scalarAt("/mesh/source")],
    ["Stiffness in the equations", law, "", { help: "", theory: "vibration#mesh-force" }],
    row("/mesh/stiffness_mean_n_per_um"),
    ["Mesh stiffness of one half, range", range(mesh.stiffness_min_n_per_um, mesh.stiffness_max_n_per_um, 4), scalarAt("/mesh/stiffness_mean_n_per_um").unit, scalarAt("/mesh/stiffness_min_n_per_um")],
    row("/mesh/secant_stiffness_mean_n_per_um"),
    row("/mesh/transmission_error_mean_um", 4),
    row("/mesh/transmission_error_pp_um", 4),
    row("/mesh/load_share_at_mesh_in", 3),
    row("/mesh/loaded_contact_ratio"),
    ["Pairs in contact", range(mesh.pairs_in_contact_min, mesh.pairs_in_contact_max), "", scalarAt("/mesh/pairs_in_contact_min")],
    row("/mesh/max_line_load_n_per_mm", 4),
    row("/mesh/max_contact_pressure_mpa", 4),
    row("/mesh/force_n"),
    row("/mesh/axial_force_n/{half}", 4),
    row("/mesh/pinion_axial_shift_um", 3),
    row("/mesh/apex_sensitivity/load_split_percent_per_um", 3),
  ];
}

/** @param {string} id @param {Plot | null} picture */
async function plot(id, picture) {
  const box = byAnyId(id);
  showFigureOf(box, Boolean(picture));
  if (picture) await draw(box, picture.traces, picture.axes);
}
