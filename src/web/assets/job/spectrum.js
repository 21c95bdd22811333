// The spectrum of the left circumferential acceleration, in mesh orders.

import { byId, show } from "../common/dom.js";
import { number } from "../common/format.js";
import { draw } from "../common/plots.js";
import { remember, told } from "./address.js";
import { orderWords, spectrumPlot, strongestLines } from "./motion_plots.js";

/** @param {JobContext} context */
export async function showSpectrum({ result: { response, numerics } }) {
  if (!response || !spectrumPlot(response, numerics)) return;
  show(byId("spectrum"));
  const choices = [...byId("spectrum-scale").querySelectorAll("input")];
  const update = () => {
    const plot = spectrumPlot(response, numerics, { decibel: byId("scale-db").checked });
    return plot && draw(byId("spectrum-plot"), plot.traces, plot.axes);
  };
  byId("scale-db").checked = told().get("scale") === "db";
  for (const choice of choices) {
    choice.addEventListener("change", () => {
      remember({ scale: byId("scale-db").checked ? "db" : null });
      update();
    });
  }
  const { mesh_frequency_hz: mesh, period_mesh_periods: periods } = response;
  const lines = strongestLines(response, 5).map(({ order, hertz, amplitude }) => `order ${orderWords(order, periods)} (${number(hertz, 4)} Hz) ${number(amplitude, 3)} m/s²`);
  byId("spectrum-note").textContent = `Mesh frequency ${number(mesh)} Hz = order 1. Strongest: ${lines.join("; ")}. Dotted: natural frequencies of modes that the mesh excites.`;
  await update();
}
