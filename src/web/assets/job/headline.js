// The few numbers that people look for first.

import { byId, el, show } from "../common/dom.js";
import { number } from "../common/format.js";

export function showHeadline({ geometry, mesh, impact, response }) {
  const rms = response?.rms;
  const tiles = [
    ["Circumferential acceleration, RMS", pair(rms?.mesh_circumferential_acceleration_m_s2), "m/s²", "left / right"],
    ["Axial acceleration of the pinion, RMS", pair(rms?.pinion_axial_acceleration_m_s2), "m/s²", "left / right"],
    ["Dynamic factor", value(response?.dynamic_factor, 4), "", [response?.regime, response?.contact].filter(Boolean).join(", ")],
    ["Impact force", value(impact?.force_n, 4), "N", impactNote(impact)],
    ["Mean mesh stiffness of a half", value(mesh?.stiffness_mean_n_per_um, 4), "N/µm", mesh?.source ?? ""],
    ["Transmission error, peak to peak", value(mesh?.transmission_error_pp_um, 3), "µm", ""],
    ["Total contact ratio", value(geometry?.total_contact_ratio, 4), "", geometry ? `transverse ${number(geometry.transverse_contact_ratio, 4)}, overlap ${number(geometry.overlap_ratio, 4)}` : ""],
  ].filter(([, shown]) => shown !== null);
  const box = byId("headline");
  box.replaceChildren(
    ...tiles.map(([name, shown, unit, note]) =>
      el("div", { class: "tile" }, el("span", { class: "name" }, name), el("span", { class: "number" }, shown, unit ? el("span", { class: "unit" }, ` ${unit}`) : null), el("span", { class: "note" }, note)),
    ),
  );
  show(box, tiles.length > 0);
}

const value = (shown, digits) => (shown === null || shown === undefined ? null : number(shown, digits));
const impactNote = (impact) => (typeof impact?.zhou2008_force_n === "number" ? `Zhou 2008: ${number(impact.zhou2008_force_n, 4)} N` : impact?.source ?? "");
const pair = (sides) => (sides ? `${number(sides.left, 4)} / ${number(sides.right, 4)}` : null);
