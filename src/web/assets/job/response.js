// RMS tables and what the response is like.

import { byId, fillRows, fillValues, show } from "../common/dom.js";
import { number, rowsOf, sentence, shownUnit } from "../common/format.js";

export function showResponse({ response }, catalogue) {
  if (!response) return;
  const { rms } = response;
  const row = (name, sides) => [name, number(sides?.left), number(sides?.right), "m/s²"];
  fillRows(byId("rms").tBodies[0], [
    row("Circumferential, mesh", rms.mesh_circumferential_acceleration_m_s2),
    row("Axial, pinion", rms.pinion_axial_acceleration_m_s2),
  ]);
  fillValues(byId("response-values"), [
    ...rowsOf(response).map(([label, value, unit]) => [label, sentence(value), unit]),
    ["Natural frequencies", (response.natural_frequencies_hz ?? []).map((hertz) => number(hertz, 4)).join(", "), "Hz"],
  ]);
  const known = new Map(catalogue.map((channel) => [channel.name, channel]));
  fillRows(byId("channels-rms").tBodies[0], Object.entries(rms.channels ?? {}).map(([name, value]) => {
    const channel = known.get(name);
    return [name, number(value), shownUnit(channel?.unit), channel ? number(channel.n) : "–"];
  }));
  show(byId("response"));
}
