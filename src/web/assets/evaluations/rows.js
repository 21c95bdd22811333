// What the panels of optimisations and tolerance studies share.

import * as api from "../common/api.js";
import { byId, notify } from "../common/dom.js";
import { number, pointerLabel } from "../common/format.js";

/** Longest name that a document may have. */
const NAME_LENGTH = 200;

/** An input by its pointer, with its unit. @param {string} pointer */
export function inputLabel(pointer) {
  const { label, unit } = pointerLabel(pointer);
  return unit ? `${label}, ${unit}` : label;
}

/** An operating point as text. @param {{ pinion_speed_rpm: number, pinion_torque_nm: number }} point */
export const pointText = (point) => `${number(point.pinion_torque_nm)} N·m, ${number(point.pinion_speed_rpm)} r/min`;

/**
 * Submits the document of a row and goes to its job.
 * @param {HTMLButtonElement} button
 * @param {{ id: string, name: string, position: number, what: string }} row
 */
export async function openRow(button, { id, name, position, what }) {
  button.disabled = true;
  try {
    const document = await api.pointInput(id, position);
    const place = `: ${what}`;
    document.name = `${name.slice(0, NAME_LENGTH - place.length)}${place}`;
    const job = await api.submit(document, api.newKey());
    window.location.assign(`/jobs/${encodeURIComponent(job.id)}`);
  } catch (error) {
    notify(byId("notice"), error);
    button.disabled = false;
  }
}
