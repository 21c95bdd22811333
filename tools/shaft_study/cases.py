"""The design of cases: one pair on many shafts, one input at a time and combined, and a second pair."""

import copy
from math import exp, log

from documents import example, on_shafts

# Speeds of the pinion: mesh frequencies of 142 to 2270 Hz of the source's pair.
SPEEDS = [round(exp(log(500) + i * (log(8000) - log(500)) / 30), 1) for i in range(31)]

BASE = dict(mounting="straddle", input="left", span_mm=340.0, diameter_mm=80.0, bearing=1000.0)

# (short name, what is changed in words, changes of the arrangement, changes of the document)
ONE_AT_A_TIME = [
    ("base", "straddle, 340 mm, ø 80 mm, 1000 N/µm", {}, {}),
    ("stiff", "ø 97 mm (no step), bearings 10 000 N/µm", dict(diameter_mm=97.0, bearing=1e4), {}),
    ("d65", "ø 65 mm", dict(diameter_mm=65.0), {}),
    ("d50", "ø 50 mm", dict(diameter_mm=50.0), {}),
    ("span270", "span 270 mm", dict(span_mm=270.0), {}),
    ("span500", "span 500 mm", dict(span_mm=500.0), {}),
    ("span700", "span 700 mm", dict(span_mm=700.0), {}),
    ("k300", "bearings 300 N/µm", dict(bearing=300.0), {}),
    ("k100", "bearings 100 N/µm", dict(bearing=100.0), {}),
    ("k10000", "bearings 10 000 N/µm", dict(bearing=1e4), {}),
    ("right", "input right", dict(input="right"), {}),
    ("same", "output on the input's side", dict(output="same"), {}),
    ("gap10", "gap 10 mm", {}, {"/design/gap_width_mm": 10.0}),
    ("gap80", "gap 80 mm, span 390 mm", dict(span_mm=390.0), {"/design/gap_width_mm": 80.0}),
    ("b50", "faces of 2 × 50 mm", {}, {"/design/face_width_mm": 50.0}),
    ("b30", "faces of 2 × 30 mm, gap 10 mm, span 160 mm, ø 97 mm, bearings 100 000 N/µm",
     dict(span_mm=160.0, diameter_mm=97.0, bearing=1e5), {"/design/face_width_mm": 30.0, "/design/gap_width_mm": 10.0}),
    ("b110", "faces of 2 × 110 mm, span 410 mm", dict(span_mm=410.0), {"/design/face_width_mm": 110.0}),
    ("t200", "200 N·m", {}, {"/operation/pinion_torque_nm": 200.0}),
    ("t2000", "2000 N·m", {}, {"/operation/pinion_torque_nm": 2000.0}),
    ("overhung", "overhung, 260 mm, ø 97 mm", dict(mounting="overhung", diameter_mm=97.0, span_mm=260.0), {}),
    ("overhung80", "overhung, 260 mm, ø 80 mm", dict(mounting="overhung", diameter_mm=80.0, span_mm=260.0), {}),
    ("overhung97k", "overhung, 400 mm, ø 97 mm, 3000 N/µm",
     dict(mounting="overhung", diameter_mm=97.0, span_mm=400.0, bearing=3000.0), {}),
]

# Combined: values of each input, drawn in turn (a fixed Latin hypercube, so that every run has the same cases).
LEVELS = dict(
    diameter_mm=[97.0, 90.0, 80.0, 70.0, 60.0, 50.0],
    span_mm=[280.0, 320.0, 380.0, 450.0, 550.0, 700.0],
    bearing=[150.0, 300.0, 600.0, 1500.0, 4000.0, 20000.0],
    torque=[150.0, 300.0, 500.0, 800.0, 1300.0, 2000.0],
    gap=[10.0, 20.0, 30.0, 40.0, 60.0, 80.0],
    face=[50.0, 60.0, 75.0, 75.0, 90.0, 105.0],
)


def random(seed):
    """Numbers in [0, 1) of a linear congruential generator."""
    state = seed
    while True:
        state = (6364136223846793005 * state + 1442695040888963407) % 2**64
        yield (state >> 11) / 2**53


def shuffled(values, numbers):
    values = list(values)
    for i in reversed(range(1, len(values))):
        j = int(next(numbers) * (i + 1))
        values[i], values[j] = values[j], values[i]
    return values


def combined(count=18):
    numbers = random(17 * 44)
    columns = {name: shuffled((levels * (count // len(levels) + 1))[:count], numbers) for name, levels in LEVELS.items()}
    cases = []
    for i in range(count):
        at = {name: column[i] for name, column in columns.items()}
        overhung = i % 4 == 3
        # Bearings beside the faces; an overhung pinion has a narrow gap and a thicker shaft, and carries enough for its teeth to stay together.
        gap = min(at["gap"], 30.0) if overhung else at["gap"]
        width = 2 * at["face"] + gap
        span = max(at["span_mm"], 0.0 if overhung else width + 40.0)
        diameter = max(at["diameter_mm"], 80.0) if overhung else at["diameter_mm"]
        torque = max(at["torque"], 800.0) if overhung else at["torque"]
        arrangement = dict(mounting="overhung" if overhung else "straddle", input=("left", "right")[i % 2],
                           output=("other", "same")[(i // 2) % 2], span_mm=span, diameter_mm=diameter, bearing=at["bearing"])
        changes = {"/design/gap_width_mm": gap, "/design/face_width_mm": at["face"],
                   "/operation/pinion_torque_nm": torque}
        words = (f"{'overhung' if overhung else 'straddle'}, {span:.0f} mm, ø {diameter:.0f} mm, {at['bearing']:.0f} N/µm, "
                 f"2 × {at['face']:.0f} mm, gap {gap:.0f} mm, {torque:.0f} N·m, input {arrangement['input']}")
        cases.append((f"c{i + 1}", words, arrangement, changes))
    return cases


def with_changes(document, changes):
    document = copy.deepcopy(document)
    for pointer, value in changes.items():
        place = document
        *path, last = pointer.strip("/").split("/")
        for name in path:
            place = place.setdefault(name, {})
        place[last] = value
    return document


def contact_document(start, base_arrangement, damping, case):
    """The document of a case that changes an example, on shafts, with the contact in the equations."""
    name, words, arrangement, changes = case
    base = with_changes(example(start), changes)
    base["name"] = f"{name}: {words}"
    base["model"] = {"mesh_force": "contact", "plane": "base", "mesh_damping_ns_per_m": damping,
                     "mesh_stiffness": {"source": "ltca", "fidelity": "analytic", "body": "rim", "corner_contact": True}}
    for gear in ("pinion", "gear"):
        base["design"][gear].pop("inertia_kg_m2", None)
    return on_shafts(base, **{**base_arrangement, **arrangement})


def document(case):
    """The document of a case, on shafts."""
    return contact_document("contact", BASE, DAMPING, case)


TURBO_SPEEDS = [round(exp(log(2000) + i * (log(12000) - log(2000)) / 15), 1) for i in range(16)]
TURBO_BASE = dict(mounting="straddle", input="left", span_mm=540.0, diameter_mm=180.0, gear_diameter_mm=300.0, bearing=2000.0, coupling_mm=250.0)
TURBO = [
    ("turbo", "straddle, 540 mm, ø 180 mm, 2000 N/µm", {}, {}),
    ("turbo-d130", "ø 130 mm", dict(diameter_mm=130.0), {}),
    ("turbo-b100", "faces of 2 × 100 mm, span 440 mm", dict(span_mm=440.0), {"/design/face_width_mm": 100.0}),
]
TURBO_DAMPING = 64000.0


def turbo_document(case):
    """The document of a case of the second pair."""
    return contact_document("study/documents/turbo", TURBO_BASE, TURBO_DAMPING, case)


# Mesh damping of a half, N·s/m: a ratio of 0.1 on the base case's mesh mode, the same in every model.
DAMPING = 12000.0
