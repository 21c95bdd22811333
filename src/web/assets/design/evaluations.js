// Documents of an optimisation and of a tolerance study made of a response: usual inputs, to be changed.

const ACCELERATION = "/response/rms/mesh_circumferential_acceleration_m_s2";
const ERROR = "/mesh/transmission_error_pp_um";

/**
 * The document of another kind made of that of a response.
 * @param {JobInput} document
 * @param {string | null} kind
 */
export function asKind(document, kind) {
  if (kind === "optimise") return optimisation(document);
  if (kind === "tolerance") return toleranceStudy(document);
  return document;
}

/** @param {JobInput} document */
function base(document) {
  const { sweep_point: _point, name, ...rest } = document;
  return { rest, name: name ?? "" };
}

/** Relief and crowning at half, full and one and a half times the torque. @param {JobInput} document */
function optimisation(document) {
  const { rest, name } = base(document);
  const torque = document.operation.pinion_torque_nm;
  return {
    ...rest,
    kind: "optimise",
    name: `Optimised: ${name}`.slice(0, 200),
    operating_points: [0.5, 1, 1.5].map((factor) => ({ pinion_torque_nm: factor * torque })),
    variables: [
      { pointer: "/design/pinion/tip_relief/amount_um", also: ["/design/gear/tip_relief/amount_um"], from: 0, to: 40, step: 1 },
      { pointer: "/design/pinion/tip_relief/length_mm", also: ["/design/gear/tip_relief/length_mm"], from: document.design.normal_module_mm / 3, to: 2 * document.design.normal_module_mm },
      { pointer: "/design/pinion/lead_crowning_um", from: 0, to: 15, step: 1 },
    ],
    objectives: [{ measure: ACCELERATION, halves: "larger", over: "worst" }],
  };
}

/** Usual deviations. @param {JobInput} document */
function toleranceStudy(document) {
  const { rest, name } = base(document);
  return {
    ...rest,
    kind: "tolerance",
    name: `Tolerances: ${name}`.slice(0, 200),
    tolerances: [
      { pointer: "/design/pinion/tip_relief/amount_um", distribution: "normal", tolerance: 5 },
      { pointer: "/design/gear/tip_relief/amount_um", distribution: "normal", tolerance: 5 },
      { pointer: "/design/pinion/helix_slope_um", distribution: "uniform", plus: 8 },
      { pointer: "/design/assembly/in_plane_misalignment_um", distribution: "normal", tolerance: 20 },
    ],
    measures: [{ measure: ACCELERATION }, { measure: ERROR }],
    samples: 256,
  };
}
