"""Documents of the study: the pair on shafts, and its translation to twelve degrees of freedom."""

import copy
import json
from math import cos, pi, radians

from beam import between, inertia, lateral
from service import ROOT

STEEL = {"youngs_modulus_gpa": 206.0, "poissons_ratio": 0.3, "density_kg_m3": 7850.0}


def example(name):
    return json.loads((ROOT / "examples" / f"{name}.json").read_text())


def pair_of(document):
    """Sizes of the halves by their basic rack: reference and root diameters of pinion and gear, mm."""
    design = document["design"]
    module, beta = design["normal_module_mm"], radians(design["helix_angle_deg"])
    reference = [design[gear]["teeth"] * module / cos(beta) for gear in ("pinion", "gear")]
    return reference, [diameter - 2.5 * module for diameter in reference]


def shaft(document, member, diameter_mm, bearings, coupling_mm, body_mm=None):
    """A stepped shaft: the body over both faces, a groove between, the shaft's diameter elsewhere. `bearings`: (place from
    the middle of the gap in mm, radial N/µm, axial N/µm)."""
    design, index = document["design"], ("pinion", "gear").index(member)
    (reference, root), width = pair_of(document), design["face_width_mm"]
    root_mm, inner = body_mm or root[index], 0.5 * design["gap_width_mm"]
    outer = inner + width
    seat = 0.25 * diameter_mm
    left = min(-outer, coupling_mm, *(at - seat for at, _, _ in bearings))
    right = max(outer, coupling_mm, *(at + seat for at, _, _ in bearings))
    groove = max(root_mm - design["normal_module_mm"], min(diameter_mm, root_mm))
    pieces = [(left, -outer, diameter_mm), (-outer, -inner, root_mm), (-inner, inner, groove), (inner, outer, root_mm),
              (outer, right, diameter_mm)]
    ring_kg = STEEL["density_kg_m3"] * pi / 4 * (reference[index]**2 - root[index]**2) * 1e-6 * width * 1e-3
    squares = (reference[index]**2 + root[index]**2) * 1e-6
    return {
        "gear_position_mm": -left,
        "segments": [{"length_mm": b - a, "diameter_mm": d} for a, b, d in pieces if b - a >= 0.1],
        "bearings": [dict(position_mm=at - left, radial_n_per_um=radial, axial_n_per_um=axial,
                          radial_damping_ns_per_m=10 * radial, axial_damping_ns_per_m=10 * axial)
                     for at, radial, axial in bearings],
        "coupling": {"position_mm": coupling_mm - left},
        "half_body": {"mass_kg": ring_kg, "polar_inertia_kg_m2": ring_kg * squares / 8,
                      "diametral_inertia_kg_m2": ring_kg * (squares / 16 + (width * 1e-3)**2 / 12)},
    }


def on_shafts(base, *, mounting="straddle", input="left", output=None, span_mm=340.0, diameter_mm=80.0, gear_diameter_mm=120.0,
              bearing=1000.0, gear_bearing=None, overhang_mm=30.0, coupling_mm=120.0):
    """The pair on explicit shafts; bearing stiffness in N/µm."""
    document = copy.deepcopy(base)
    design = document["design"]
    outer = 0.5 * design["gap_width_mm"] + design["face_width_mm"]
    side = -1.0 if input == "left" else 1.0
    out = side * (-1.0 if output in (None, "other") else 1.0)
    if mounting == "straddle":
        places = [-0.5 * span_mm, 0.5 * span_mm]
    else:
        near = outer + overhang_mm
        places = sorted([side * near, side * (near + span_mm)])
    end = (max(places) if side > 0 else min(places)) + side * coupling_mm
    gear_span = max(span_mm, 2 * outer + 40.0) if mounting == "straddle" else 2 * outer + 130.0
    gear_places, gear_radial = [-0.5 * gear_span, 0.5 * gear_span], gear_bearing or 1.2 * bearing
    locating = 0 if out > 0 else 1
    design["shafts"] = {
        "pinion": shaft(document, "pinion", diameter_mm, [(at, bearing, 0.0) for at in places], end),
        "gear": shaft(document, "gear", gear_diameter_mm,
                      [(at, gear_radial, gear_radial / 3 if i == locating else 0.0) for i, at in enumerate(gear_places)],
                      gear_places[1 if out > 0 else 0] + out * coupling_mm),
    }
    for member in ("pinion", "gear"):
        mass, polar = inertia(design["shafts"][member], STEEL["density_kg_m3"])
        design[member].update(mass_kg=mass, inertia_kg_m2=polar)
        design[member].pop("bore_diameter_mm", None)
    design.pop("supports", None)
    return document


def translated(document):
    """The same drive with twelve degrees of freedom, springs and inertias from its shafts."""
    document = copy.deepcopy(document)
    design = document["design"]
    shafts = design.pop("shafts")
    middle = 0.5 * (design["gap_width_mm"] + design["face_width_mm"])
    supports = {"damping_ratio": 0.03}
    for member, given in shafts.items():
        places = [given["gear_position_mm"] + side * middle for side in (-1.0, 1.0)]
        ((a, b), (c, d)), mass_kg = lateral(given, places, STEEL)
        design[member]["mass_kg"] = mass_kg
        together, against = 0.5 * (a + b + c + d), 0.5 * (a - b - c + d)
        supports[f"{member}_lateral_n_per_um"] = 1e-6 / together
        supports[f"{member}_halves_lateral_n_per_um"] = max(0.0, 0.5e-6 * (1 / against - 1 / together))
        axial, torsional = between(given, *places, STEEL)
        supports[f"{member}_halves_axial_n_per_um"] = axial * 1e-6
        supports[f"{member}_halves_torsional_nm_per_rad"] = torsional
    supports["gear_axial_n_per_um"] = 0.5 * sum(bearing["axial_n_per_um"] for bearing in shafts["gear"]["bearings"])
    design["supports"] = supports
    return document


def by_default(document):
    """The same pair as one writes it down without shafts: supports, masses and inertias left to the program."""
    document = copy.deepcopy(document)
    design = document["design"]
    design.pop("shafts")
    for member in ("pinion", "gear"):
        design[member].pop("mass_kg", None)
        design[member].pop("inertia_kg_m2", None)
    return document


def swept(document, speeds_rpm):
    document = copy.deepcopy(document)
    document["kind"] = "sweep"
    document["record"] = ["spectrum"]
    document["axes"] = [{"pointer": "/operation/pinion_speed_rpm", "values": [float(speed) for speed in speeds_rpm]}]
    return document


def with_modification(document, result, factor):
    """With the helix modifications that the result of the shafts proposes, times a factor: 1 evens the load on the shafts, -1 gives
    flanks on stiff shafts the unevenness of the shafts' deflection."""
    document = copy.deepcopy(document)
    for half in ("left", "right"):
        proposed = result["shafts"][half]["helix_modification"]
        document["design"]["pinion"][half] = {"helix_slope_um": factor * proposed["slope_um"],
                                              "lead_crowning_um": factor * proposed["crowning_um"]}
    return document
