// Parallel coordinates of a front: a line for each design through its variables and objectives.

import { byId, showFigureOf } from "../common/dom.js";
import { number, sentence } from "../common/format.js";
import { draw, line } from "../common/plots.js";
import { inputLabel } from "./rows.js";

/**
 * Variables between their bounds, objectives between the least and the largest of the front.
 * @param {Optimisation} found
 * @param {JobInput} input
 */
export async function drawCoordinates({ front = [], objectives, points }, input) {
  const box = byId("optimise-coordinates-plot");
  showFigureOf(box, front.length > 1);
  if (front.length < 2) return;
  const values = (place) => front.map((design) => Number(design.objectives[place]));
  const spans = [
    ...input.variables.map(({ from, to }) => [from, to]),
    ...objectives.map((_, place) => [Math.min(...values(place)), Math.max(...values(place))]),
  ];
  const names = [...input.variables.map(({ pointer }) => inputLabel(pointer)), ...objectives.map(({ label }) => sentence(label))];
  const part = (value, [from, to]) => (to > from ? (value - from) / (to - from) : 0.5);
  const traces = front.map((design) => {
    const own = [...points[design.position].values, ...design.objectives];
    const name = `design ${number(design.position + 1)}${design.knee ? " (knee)" : ""}`;
    return line(names, own.map((value, place) => part(value, spans[place])), name);
  });
  await draw(box, traces, { x: "Variables and objectives", y: "Part of the range" });
}
