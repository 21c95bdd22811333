"""The worked examples of docs/OPTIMISATION.md, each with a figure."""

import copy

from plot import BLUE, ORANGE, GREEN, GREY, BLACK, Field, Sheet
from program import example, say, solve, sweep, with_values, worst_acceleration


def write(name, sheet):
    with open(f"docs/optimisation/{name}.svg", "w", encoding="utf-8") as file:
        file.write(sheet.finish())
    print(f"  docs/optimisation/{name}.svg")


def relief():
    """Relief for three torques, and the curves of input and best over the torque."""
    document = example("optimise_relief")
    result = solve(document)
    say(result)
    found = result["optimise"]
    axis = [{"pointer": "/operation/pinion_torque_nm", "from": 200, "to": 1400, "points": 25}]
    curves = [[(row["values"][0], worst_acceleration(row)) for row in sweep(design, axis)]
              for design in (document, with_values(document, found["best"]["values"]))]
    top = 1.1 * max(y for curve in curves for _, y in curve)
    sheet = Sheet(760, 330)
    sheet.title(70, 22, "Vibration over the torque, before and after")
    field = Field(sheet, (70, 40, 640, 230), (200, 1400, False), (0, top, False), "Torque of the pinion, N·m",
                  "RMS mesh acceleration, m/s²")
    for curve, color in zip(curves, (GREY, BLUE)):
        field.curve(curve, color)
    points = found["objectives"][0]["per_point"]
    field.dots([(point["pinion_torque_nm"], point["input"]) for point in points], GREY)
    field.dots([(point["pinion_torque_nm"], point["best"]) for point in points], BLUE)
    sheet.key(480, 62, GREY, "input; dots: the three torques")
    sheet.key(480, 82, BLUE, "best at the worst of three")
    write("relief", sheet)


def shafts():
    """Helix correction on shafts between bearings, robust to the torque."""
    document = example("optimise_helix_shafts")
    result = solve(document)
    say(result)
    found = result["optimise"]
    ratio, curves = [0.5 + 0.05 * i for i in range(21)], []
    torque = document["operation"]["pinion_torque_nm"]
    nominal = [row for row in found["points"] if row.get("phase") in ("confirm", "search", "polish", "sample")
               and row.get("violation") == 0 and row.get("objectives")]
    nominal = min(nominal, key=lambda row: row["objectives"][0])
    names = [variable["pointer"] for variable in document["variables"]]
    designs = [document, with_values(document, dict(zip(names, nominal["values"]))),
               with_values(document, found["best"]["values"])]
    for design in designs:
        axis = [{"pointer": "/operation/pinion_torque_nm", "from": ratio[0] * torque, "to": ratio[-1] * torque,
                 "points": len(ratio)}]
        # The sweep's rows have the face load of both halves; the motion is not of interest.
        design = copy.deepcopy(design)
        design["model"]["mesh_force"] = "stiffness"
        curves.append([(row["values"][0] / torque, max(row["k_h_beta_5mm"].values())) for row in sweep(design, axis)])
    sheet = Sheet(760, 330)
    sheet.title(70, 22, "Face load factor over the torque")
    top = max(y for curve in curves for _, y in curve)
    field = Field(sheet, (70, 40, 640, 230), (0.5, 1.5, False), (1.0, 1.05 * top, False), "Torque over the nominal one",
                  "K_Hβ, larger half")
    for curve, color, dashes in zip(curves, (GREY, ORANGE, BLUE), ("", "6 4", "")):
        field.curve(curve, color, dashes)
    for at in (0.8, 1.2):
        field.curve([(at, 1.0), (at, 1.05 * top)], GREEN, "3 3", 1.2)
    sheet.key(460, 62, GREY, "input")
    sheet.key(460, 82, ORANGE, "best at the nominal torque", "6 4")
    sheet.key(460, 102, BLUE, "best P90 within ±20 %")
    write("shafts", sheet)


def scatter():
    """Tolerances of the relief that was found."""
    document = example("tolerance_optimised")
    result = solve(document)
    found = result["tolerance"]
    print(f"  {found['samples']} points, {found['failed']} failed, {result['cost']['wall_s']:.0f} s")
    for measure in found["measures"]:
        shown = ", ".join(f"{name} {measure['percentiles'][name]['value']:.4g}" for name in ("p5", "p50", "p90", "p95"))
        print(f"  {measure['measure']}: nominal {measure['nominal']:.4g}, {shown}; beyond {measure['beyond_limit']}")
    for one in found["sensitivity"]:
        shares = f"alone {one['first_order']:.3f} (noise {one['first_order_noise']:.3f})"
        print(f"    {one['measure']} by {one['input']}: {shares}, P90 with half the tolerance {one['halved_p90']}")
    measure = next(one for one in found["measures"] if "response" in one["measure"])
    histogram = measure["histogram"]
    width = (histogram["to"] - histogram["from"]) / len(histogram["counts"])
    sheet = Sheet(760, 330)
    sheet.title(70, 22, "Vibration of pairs within their tolerances")
    top = 1.1 * max(histogram["counts"])
    # From a round number below, to one above.
    low, high = histogram["from"] - width, histogram["to"] + width
    field = Field(sheet, (70, 40, 300, 230), (low, high, False), (0, top, False), "RMS mesh acceleration, m/s²", "Pairs")
    for index, count in enumerate(histogram["counts"]):
        left = histogram["from"] + index * width
        field.curve([(left, 0), (left, count), (left + width, count), (left + width, 0)], BLUE, "", 1.2)
    for value, color in ((measure["nominal"], BLACK), (measure["percentiles"]["p90"]["value"], ORANGE)):
        field.curve([(value, 0), (value, top)], color, "4 3")
    sheet.key(250, 62, BLACK, "nominal", "4 3")
    sheet.key(250, 82, ORANGE, "P90", "4 3")
    own = [one for one in found["sensitivity"] if one["measure"] == measure["measure"]]
    own.sort(key=lambda one: -one["first_order"])
    sheet.title(420, 22, "Share of its variance by each tolerance, %")
    for place, one in enumerate(own):
        y, name = 60 + 40 * place, one["input"].removeprefix("/design/")
        sheet.text(420, y, name, size=11)
        sheet.add(f'<rect x="420" y="{y + 6}" width="{max(1.0, 300 * one["first_order"]):.1f}" height="12" fill="{BLUE}"/>')
        sheet.text(425 + 300 * one["first_order"], y + 16, f"{100 * one['first_order']:.0f}", size=11)
    write("scatter", sheet)
