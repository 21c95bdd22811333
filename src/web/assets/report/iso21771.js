// The gear data in the terms and symbols of ISO 21771, of one helix half where widths and forces are meant: from the result's geometry and the
// document.

import { el } from "../common/dom.js";

const PI = Math.PI;
const rad = (degrees) => (degrees * PI) / 180;

/** Rows { symbol: [letter, index], name, pinion, gear, unit } of the members and { symbol, name, value, unit } of the pair. What is not known is
 *  null. */
export function gearData({ geometry, input, response }) {
  const { design = {}, operation = {} } = input ?? {};
  const { pinion = {}, gear = {} } = geometry;
  const [z1, z2] = [design.pinion?.teeth, design.gear?.teeth];
  const beta = rad(design.helix_angle_deg ?? 0);
  const mn = design.normal_module_mm;
  const mt = mn / Math.cos(beta);
  const a = geometry.center_distance_mm;
  const working = z1 && z2 ? [(2 * a * z1) / (z1 + z2), (2 * a * z2) / (z1 + z2)] : [null, null];
  const speed = operation.pinion_speed_rpm;
  const ratio = z1 && z2 ? z2 / z1 : null;
  const pair = (letter, index, name, value, unit = "") => ({ symbol: [letter, index], name, value: finite(value), unit });
  const member = (letter, index, name, first, second, unit = "") => ({ symbol: [letter, index], name, pinion: finite(first), gear: finite(second), unit });
  const hand = (member) => design[member]?.left_half_hand ?? null;
  const both = (pick) => [pick(design.pinion ?? {}), pick(design.gear ?? {})];
  const ownWidths = [pinion, gear].some((one) => one.face_width_mm && one.face_width_mm !== geometry.face_width_mm);
  return {
    pair: [
      pair("m", "n", "Normal module", mn, "mm"),
      pair("m", "t", "Transverse module", mt, "mm"),
      pair("α", "n", "Normal pressure angle", geometry.normal_pressure_angle_deg, "°"),
      pair("α", "t", "Transverse pressure angle", geometry.transverse_pressure_angle_deg, "°"),
      pair("α", "wt", "Working transverse pressure angle", geometry.working_pressure_angle_deg, "°"),
      pair("β", "", "Helix angle", design.helix_angle_deg, "°"),
      pair("β", "b", "Base helix angle", geometry.base_helix_angle_deg, "°"),
      pair("u", "", "Gear ratio", ratio),
      pair("a", "", "Centre distance, working", a, "mm"),
      pair("b", "", "Face width of a half", geometry.face_width_mm ?? design.face_width_mm, "mm"),
      pair("", "", "Gap between the halves", geometry.gap_width_mm ?? design.gap_width_mm, "mm"),
      pair("p", "bt", "Transverse base pitch", geometry.transverse_base_pitch_mm, "mm"),
      pair("p", "x", "Axial pitch", beta > 0 ? (PI * mn) / Math.sin(beta) : null, "mm"),
      pair("g", "α", "Length of the path of contact", geometry.path_of_contact_mm, "mm"),
      pair("ε", "α", "Transverse contact ratio", geometry.transverse_contact_ratio),
      pair("ε", "β", "Overlap ratio", geometry.overlap_ratio),
      pair("ε", "γ", "Total contact ratio", geometry.total_contact_ratio),
      pair("j", "", "Backlash along s, total", response?.backlash_um ?? design.backlash_um, "µm"),
      pair("v", "w", "Pitch line velocity", speed && working[0] ? (PI * working[0] * 1e-3 * speed) / 60 : null, "m/s"),
    ],
    members: [
      member("z", "", "Number of teeth", z1, z2),
      { ...member("", "", "Hand of the left half", null, null), pinion: hand("pinion"), gear: hand("gear") },
      member("x", "", "Profile shift coefficient", ...both((one) => one.profile_shift ?? 0)),
      member("d", "", "Reference diameter", pinion.reference_diameter_mm, gear.reference_diameter_mm, "mm"),
      member("d", "b", "Base diameter", pinion.base_diameter_mm, gear.base_diameter_mm, "mm"),
      member("d", "w", "Working pitch diameter", ...working, "mm"),
      member("d", "a", "Tip diameter", pinion.tip_diameter_mm, gear.tip_diameter_mm, "mm"),
      member("d", "f", "Root diameter", pinion.root_diameter_mm, gear.root_diameter_mm, "mm"),
      member("d", "Ff", "Root form diameter", pinion.root_form_diameter_mm, gear.root_form_diameter_mm, "mm"),
      member("s", "an", "Normal tooth thickness at the tip", pinion.tip_thickness_normal_mm, gear.tip_thickness_normal_mm, "mm"),
      member("h*", "aP", "Addendum of the rack, modules", ...both((one) => one.addendum)),
      member("h*", "fP", "Dedendum of the rack, modules", ...both((one) => one.dedendum)),
      member("ρ*", "fP", "Root fillet radius of the rack, modules", ...both((one) => one.fillet_radius)),
      ...(ownWidths ? [member("b", "", "Face width of a half of its own", pinion.face_width_mm, gear.face_width_mm, "mm")] : []),
      member("d", "i", "Bore diameter", pinion.bore_diameter_mm, gear.bore_diameter_mm, "mm"),
      member("n", "", "Speed", speed, speed && ratio ? speed / ratio : null, "r/min"),
      member("T", "", "Torque, both halves", operation.pinion_torque_nm, operation.pinion_torque_nm && ratio ? operation.pinion_torque_nm * ratio : null, "N·m"),
      member("m", "", "Mass", pinion.mass_kg, gear.mass_kg, "kg"),
      member("J", "", "Moment of inertia", pinion.inertia_kg_m2, gear.inertia_kg_m2, "kg·m²"),
    ],
  };
}

const finite = (value) => (Number.isFinite(value) ? value : null);

/** A symbol with its index. */
export function symbolOf([letter, index]) {
  return letter ? el("span", { class: "symbol" }, el("i", {}, letter), index ? el("sub", {}, index) : null) : null;
}
