// Plots of a report, as drawings in the colours of paper.

import { byId, el, show } from "../common/dom.js";
import { axesOfFile, summary } from "../common/plot_tools.js";
import { picture } from "../common/plots.js";

/** Sizes of the drawings, px: they are made smaller on paper, by about a quarter. */
export const HALF = { width: 460, height: 280 };
export const WHOLE = { width: 930, height: 250 };
export const HIGH = { width: 930, height: 420 };

/**
 * Appends the drawings under their titles.
 * @param {{ title: string, traces: Trace[], axes: PlotAxes, size?: typeof HALF }[]} plots
 */
export async function showFigures(plots) {
  show(byId("plots"), plots.length > 0);
  for (const { title, traces, axes, size = HALF } of plots) {
    const named = { ...axes, name: title };
    const image = el("img", { width: size.width, height: size.height, alt: summary({ traces, axes: named }) });
    byId("figures").append(el("figure", { class: size === HALF ? "" : "whole" }, el("figcaption", {}, title), image));
    // The title stands above the drawing.
    const drawing = await picture(traces, { ...axesOfFile({ node: image, axes: named }), title: undefined }, { format: "svg", ...size });
    image.src = `data:image/svg+xml,${encodeURIComponent(drawing)}`;
    await image.decode();
  }
}
