"""The source's questions, asked of the pair on shafts."""

import copy

from cases import BASE, DAMPING, with_changes
from documents import example, on_shafts, swept, with_modification
from service import solve

RATIOS = ("2_72", "2_91", "3_30", "3_68", "4_07")
# Mountings: the straddle of examples/shafts.json by four numbers, a slender one, and an overhung pinion.
MOUNTINGS = {
    "stiff": dict(mounting="straddle", span_mm=None, diameter_mm=97.0, bearing=1e5),
    "straddle": dict(mounting="straddle", span_mm=None, diameter_mm=80.0),
    "slender": dict(mounting="straddle", span_mm=500.0, diameter_mm=65.0),
    "overhung": dict(mounting="overhung", span_mm=260.0, diameter_mm=97.0),
}
BAND = [round(1000.0 * 4 ** (i / 12), 1) for i in range(13)]


def contact(document):
    document = copy.deepcopy(document)
    document["model"] = {**document["model"], "mesh_force": "contact", "plane": "base", "mesh_damping_ns_per_m": DAMPING}
    return document


def mounted(document, mounting):
    """The document's pair on the shafts of a mounting; a straddle grows with the faces."""
    arrangement = {**BASE, **MOUNTINGS[mounting]}
    if arrangement["span_mm"] is None:
        arrangement["span_mm"] = 2 * document["design"]["face_width_mm"] + document["design"]["gap_width_mm"] + 160.0
    document = copy.deepcopy(document)
    document["design"]["pinion"].pop("inertia_kg_m2", None)
    document["design"]["gear"].pop("inertia_kg_m2", None)
    return on_shafts(document, **arrangement)


def contact_ratios():
    """Results of the documents of Table 2 by mounting: operating point and sweep over the speed, contact in the equations; the
    source's stiffness and impact on the straddle; the same with evened helices."""
    found = {}
    for name in RATIOS:
        source = example(f"table2_{name}")
        source["name"] = f"table2 {name}"
        for mounting in MOUNTINGS:
            document = mounted(contact(source), mounting)
            point = solve(document)
            found[name, mounting] = {"point": point, "sweep": solve(swept(document, BAND))["sweep"]["points"]}
            if mounting in ("straddle", "overhung"):
                even = with_modification(document, point, 1)
                found[name, mounting + ", evened"] = {"point": solve(even), "sweep": solve(swept(even, BAND))["sweep"]["points"]}
        for mounting in ("straddle", "overhung"):
            found[name, mounting + ", source's model"] = {"point": solve(mounted(source, mounting))}
        body = contact(source)
        body["design"]["supports"] = {"damping_ratio": 0.03}
        for gear in ("pinion", "gear"):
            body["design"][gear].pop("inertia_kg_m2")
        found[name, "one body"] = {"point": solve(body), "sweep": solve(swept(body, BAND))["sweep"]["points"]}
        found[name, "source"] = {"point": solve(source)}
    return found


def torques():
    """The pair at light and heavy loads: contact, dynamic factor."""
    found = {}
    for mounting in ("straddle", "slender", "overhung"):
        for torque in (10.0, 200.0, 800.0, 4000.0):
            document = with_changes(mounted(contact(example("contact")), mounting), {"/operation/pinion_torque_nm": torque})
            document["name"] = f"{mounting}, {torque:.0f} N·m"
            found[mounting, torque] = solve(document)
    return found


def backlash():
    """The same motion whatever the backlash, as long as contact is kept."""
    document = mounted(contact(example("contact")), "straddle")
    return [solve(with_changes(document, {"/design/backlash_um": value})) for value in (230.0, 0.0)]


def face_widths():
    """Contact ratio by face width, on shafts that grow with it."""
    found = {}
    for mounting in ("one body", "straddle", "straddle, evened", "overhung"):
        for face in [55.0 + 10.0 * i for i in range(7)]:
            document = with_changes(contact(example("contact")), {"/design/face_width_mm": face})
            document["name"] = f"{mounting}, face {face:.0f} mm"
            if mounting == "one body":
                document["design"]["supports"] = {"damping_ratio": 0.03}
                for gear in ("pinion", "gear"):
                    document["design"][gear].pop("inertia_kg_m2", None)
            else:
                document = mounted(document, mounting.split(",")[0])
            if mounting.endswith("evened"):
                document = with_modification(document, solve(document), 1)
            found[mounting, face] = solve(swept(document, BAND[::2]))["sweep"]["points"]
    return found
