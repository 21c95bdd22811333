// Mesh stiffness, transmission error, load sharing and the load on the flank.

import { byId, fillValues, show } from "../common/dom.js";
import { number, rowsOf } from "../common/format.js";
import { draw, heatMap, line } from "../common/plots.js";

export async function showMesh({ mesh }) {
  if (!mesh) return;
  const { axial_force_n: axial } = mesh;
  fillValues(byId("mesh-values"), [
    ...rowsOf(mesh),
    ["Axial force left / right", axial ? `${number(axial.left)} / ${number(axial.right)}` : null, "N"],
  ]);
  show(byId("mesh"));
  const { curve, right_curve: right } = mesh;
  if (!curve?.phase?.length) {
    for (const figure of byId("mesh").querySelectorAll("figure")) show(figure, false);
    return;
  }
  const phase = "Position in the mesh period";
  const both = (pick) => [line(curve.phase, pick(curve), right ? "left" : ""), ...(right ? [line(right.phase, pick(right), "right")] : [])];
  await plotOrHide("stiffness-plot", both((half) => half.stiffness_n_per_um), { x: phase, y: "N/µm" });
  await plotOrHide("error-plot", both((half) => half.transmission_error_um), { x: phase, y: "µm" });
  const shares = (curve.load_share ?? []).map((share, index, all) =>
    line(curve.load_share_phase, share, all.length > 1 ? (["left", "right"][index] ?? `half ${index + 1}`) : ""));
  await plotOrHide("share-plot", shares, { x: "Base pitches from the theoretical start of contact", y: "Share" });
  if (curve.flank?.line_load_n_per_mm?.length) {
    const { roll_mm: roll, face_mm: face, line_load_n_per_mm: load } = curve.flank;
    show(byId("flank"));
    await draw(byId("flank-plot"), [heatMap(roll, face, load, "N/mm")], { x: "Roll path, mm", y: "Face width, mm" });
  }
}

async function plotOrHide(id, traces, axes) {
  const drawn = traces.some((trace) => trace.y?.length);
  show(byId(id).closest("figure"), drawn);
  if (drawn) await draw(byId(id), traces, axes);
}
