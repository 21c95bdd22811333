"""The source's conclusions, one by one, on shafts."""

from measure import AXIAL, CIRCUMFERENTIAL, band, both, k_h_beta
from page import sig, span
from plot import BLACK, BLUE, Field, GREEN, ORANGE, Sheet
from service import at
from survival import RATIOS

SHOWN = {"2_72": "2.72", "2_91": "2.91", "3_30": "3.30", "3_68": "3.68", "4_07": "4.07"}
MOUNTED = ("stiff", "straddle", "slender", "overhung")


def rms(result, key="mesh_circumferential_acceleration_m_s2"):
    return both(at(result, f"response/rms/{key}"))


def quiet(results):
    """Teeth in contact, every mesh period like the one before, in all of them."""
    return all(at(result, "response/contact") == "continuous" and at(result, "response/regime") == "period-1" for result in results)


def swept_quiet(found):
    return all(point.get("contact") == "continuous" and point.get("regime") == "period-1"
               for entry in found.values() if "sweep" in entry for point in entry["sweep"] if not point.get("error"))


class Answers:
    """Numbers of the source's questions on shafts."""

    def __init__(self, ratios, torques, backlash, widths):
        self.ratios, self.torques, self.backlash, self.widths = ratios, torques, backlash, widths

    def each(self, mounting, of):
        return [of(self.ratios[name, mounting]) for name in RATIOS]

    def bands(self, mounting, key=CIRCUMFERENTIAL):
        return self.each(mounting, lambda entry: band(entry["sweep"], key))

    def impacts(self, mounting):
        return [(at(point, "impact/zhou2008_force_n") / 1e3, at(point, "impact/force_n") / 1e3, at(point, "impact/reduction_percent"))
                for point in self.each(mounting, lambda entry: entry["point"])]


def write(page, answers):
    page.say("## The source's conclusions on shafts, one by one\n\nThe five documents of the source's Table 2 (`examples/table2_*.json`: tooth height up to ε 3.30, then face width) with contact in the equations on four mountings "
             "(*stiff*: ø 97 mm, bearings of 100 000 N/µm; *straddle*: ø 80 mm, 1000 N/µm, bearings 80 mm beside the faces; *slender*: ø 65 mm, 500 mm apart; *overhung*: ø 97 mm, bearings 260 mm apart), and on one rigid body with the default "
             "supports. Inertias are those of the bodies drawn; the printed ones are three to five times as large and belong to other parts too. "
             "RMS: quadratic mean over 13 speeds from 1000 to 4000 r/min, so that no single resonance decides; brackets: at 2000 r/min.")
    def cell(name, mounting):
        entry = answers.ratios[name, mounting]
        return f"{sig(band(entry['sweep'], CIRCUMFERENTIAL))} ({sig(rms(entry['point']))})"
    columns = ("one body", "stiff", "straddle", "straddle, evened", "slender", "overhung", "overhung, evened")
    page.table("ε | " + " | ".join(columns) + " | K_Hβ: straddle, slender, overhung",
               [[SHOWN[name]] + [cell(name, mounting) for mounting in columns]
                + [", ".join(sig(k_h_beta(answers.ratios[name, mounting]["point"]), 3) for mounting in MOUNTED[1:])] for name in RATIOS])
    page.table("ε | impact by Zhou, kN: one body, straddle, overhung | reduction, %: one body, straddle, overhung | mesh stiffness, N/µm: one body, straddle, overhung | "
               "axial RMS, m/s²: one body, straddle, overhung | contact ratio under load: one body, straddle, overhung",
               [[SHOWN[name]] + [", ".join(sig(of(answers.ratios[name, mounting]), digits) for mounting in ("one body", "straddle", "overhung"))
                                 for of, digits in ((lambda entry: round(at(entry["point"], "impact/zhou2008_force_n") / 1e3, 2), 3),
                                                    (lambda entry: round(at(entry["point"], "impact/reduction_percent"), 2), 2),
                                                    (lambda entry: entry["point"]["mesh"]["stiffness_mean_n_per_um"], 4),
                                                    (lambda entry: band(entry["sweep"], AXIAL), 3),
                                                    (lambda entry: entry["point"]["mesh"]["loaded_contact_ratio"], 3))] for name in RATIOS])
    own = {mounting: [rms(entry["point"]) for entry in (answers.ratios[name, mounting] for name in RATIOS)] for mounting in ("source", "straddle, source's model")}
    free, pulse = own.values()
    page.claim(min(pulse) > max(free),
               f"The source's own model, stiffness and pulse, on the straddle gives {', '.join(sig(value) for value in pulse)} m/s² at 2000 r/min, where its free halves have "
               f"{', '.join(sig(value) for value in free)}: bodies as light as they are drawn, and shafts that ring, make more of a pulse that is not there in the contact.")
    draw_ratios(page, answers)


def draw_ratios(page, answers):
    sheet = Sheet(900, 360)
    colors = {"one body": (BLACK, ""), "straddle": (BLUE, ""), "straddle, evened": (BLUE, "5 4"), "overhung": (ORANGE, "")}
    sheet.title(66, 26, "The source's five contact ratios")
    field = Field(sheet, (66, 36, 370, 250), (2.6, 4.2, False), (3.0, 60.0, True), "contact ratio", "RMS, m/s²")
    for mounting, (color, dashes) in colors.items():
        points = [(float(SHOWN[name]), value) for name, value in zip(RATIOS, answers.bands(mounting))]
        field.curve(points, color, dashes)
        field.dots(points, color, hollow=bool(dashes))
    sheet.title(496, 26, "By face width alone")
    faces = sorted({face for _, face in answers.widths})
    field = Field(sheet, (496, 36, 370, 250), (50.0, 120.0, False), (3.0, 60.0, True), "face width of a half, mm", "")
    for mounting, (color, dashes) in colors.items():
        points = [(face, band(answers.widths[mounting, face], CIRCUMFERENTIAL)) for face in faces]
        field.curve(points, color, dashes)
        field.dots(points, color, hollow=bool(dashes))
    for i, (mounting, (color, dashes)) in enumerate(colors.items()):
        sheet.key(66 + 180 * i, 345, color, mounting, dashes)
    page.figure("shafts_contact_ratio", sheet, "Vibration over the contact ratio on one rigid body and on shafts. Quadratic mean over speeds of 1000 to 4000 r/min.")
