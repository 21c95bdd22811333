// Mesh stiffness, transmission error, load sharing and the load on the flank.

import { byAnyId, byId, fillValues, show, showFigureOf } from "../common/dom.js";
import { number } from "../common/format.js";
import { draw } from "../common/plots.js";
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
/** @param {number | null | undefined} shown */
const value = (shown, digits = 5) => (typeof shown === "number" ? number(shown, digits) : null);

/** @param {MeshResult} mesh @param {JobInput} input @returns {ValueRow[]} */
export function meshValues(mesh, input) {
  const { axial_force_n: axial, apex_sensitivity: apex } = mesh;
  const law = mesh.contact_force ? "none: the force of the loaded contact over approach and phase" : mesh.source === "ltca" ? LAWS[input?.model?.mesh_stiffness?.law] : null;
  return [
    ["From", STIFFNESS[mesh.source] ?? mesh.source],
    ["Stiffness in the equations", law],
    ["Tangent stiffness, mean", value(mesh.stiffness_mean_n_per_um), "N/µm"],
    ["Tangent stiffness, range", range(mesh.stiffness_min_n_per_um, mesh.stiffness_max_n_per_um, 4), "N/µm"],
    ["Secant stiffness, mean", value(mesh.secant_stiffness_mean_n_per_um), "N/µm"],
    ["Transmission error, mean", value(mesh.transmission_error_mean_um, 4), "µm"],
    ["Transmission error, peak to peak", value(mesh.transmission_error_pp_um, 4), "µm"],
    ["Load share at mesh-in", typeof mesh.load_share_at_mesh_in === "number" ? number(100 * mesh.load_share_at_mesh_in, 3) : null, "%"],
    ["Loaded contact ratio", value(mesh.loaded_contact_ratio)],
    ["Pairs in contact", range(mesh.pairs_in_contact_min, mesh.pairs_in_contact_max)],
    ["Line load, greatest", value(mesh.max_line_load_n_per_mm, 4), "N/mm"],
    ["Contact pressure, greatest", value(mesh.max_contact_pressure_mpa, 4), "MPa"],
    ["Force of a half along the base tangent", value(mesh.force_n), "N"],
    ["Axial force, left / right", axial ? `${number(axial.left, 4)} / ${number(axial.right, 4)}` : null, "N"],
    ["Axial shift of the floating pinion", value(mesh.pinion_axial_shift_um, 3), "µm"],
    ["Load moved by an apex offset", apex ? number(apex.load_split_percent_per_um, 3) : null, "% per µm"],
  ];
}

/** @param {string} id @param {Plot | null} picture */
async function plot(id, picture) {
  const box = byAnyId(id);
  showFigureOf(box, Boolean(picture));
  if (picture) await draw(box, picture.traces, picture.axes);
}
