"""What the shafts do to the contact, what twelve degrees of freedom make of it, and the rule."""

from math import log


from beam import lateral
from documents import STEEL
from measure import (AXIAL, CIRCUMFERENTIAL, band, frequency_limit_hz, k_h_beta, largest, mesh_mode, mesh_modes, most, quantile, ratios, typical)
from page import sig, span
from plot import BLACK, BLUE, Field, GREEN, GREY, ORANGE, Sheet
from service import at


def contact(page, cases):
    """Load along the faces."""
    page.say("## What shafts do to the contact\n\nThe source's pair (800 N·m), one thing changed at a time from a straddle-mounted pinion: bearings 340 mm apart, "
             "shaft ø 80 mm, 1000 N/µm each, torque from the left, gear output on the right. K_Hβ with means over 5 mm; *evened*: with the helix slope "
             "and crowning that the result proposes. On rigid shafts, which twelve degrees of freedom assume, it is 1.")
    rows = []
    for found in cases:
        name, words, _, _ = found["case"]
        point, even = found["shafts"]["point"], found.get("evened", {}).get("point")
        plain = found["translated"]["point"]
        rows.append([words, *(sig(at(point, f"shafts/{half}/k_h_beta_5mm")) for half in ("left", "right")),
                     sig(k_h_beta(even)) if even else "–", f"{100 * at(point, 'shafts/open_fraction'):.0f}",
                     sig(at(point, "shafts/transmission_error/between_couplings_mean_um")),
                     f"{sig(point['mesh']['max_contact_pressure_mpa'], 3)} ({sig(plain['mesh']['max_contact_pressure_mpa'], 3)})",
                     *(f"{sig(harmonic(point, i), 2)} ({sig(harmonic(plain, i), 2)})" for i in (0, 1)),
                     sig(at(point, "shafts/iso6336/k_h_beta")) if at(point, "shafts/iso6336") and not overhung(found) else "–"])
    page.table("shafts | K_Hβ left | right | evened | open, % | deflection between the couplings, µm | pressure, MPa (rigid) | "
               "transmission error, order 1, µm (rigid) | order 2, µm (rigid) | K_Hβ by ISO 6336-1", rows)
    of = {found["case"][0]: found for found in cases}
    k = {name: k_h_beta(found["shafts"]["point"]) for name, found in of.items()}
    soft = [k[name] for name in ("base", "k100", "k300", "k10000", "d65", "d50", "stiff")]
    page.claim(max(soft) / min(soft) < 1.05 and k["b30"] < 1.15 < k["b50"] < k["base"] < k["b110"],
               f"**The pinion's own body decides, not its shaft.** From ø 50 to 97 mm, from 100 to 10 000 N/µm, K_Hβ stays at {span(soft, 3)}: what bends and winds up "
               f"is the pinion between the outer ends of its faces. It goes with the width: {sig(k['b30'])} at 2 × 30 mm, {sig(k['b50'])} at 2 × 50, {sig(k['base'])} at 2 × 75, "
               f"{sig(k['b110'])} at 2 × 110; and with the span ({sig(k['span270'])} at 270 mm, {sig(k['span700'])} at 700), which sets the bending of that body. "
               "\"Stiff shafts\" are no argument for leaving them out of the contact.")
    halves = [at(of["base"]["shafts"]["point"], f"shafts/{half}/k_h_beta_5mm") for half in ("left", "right")]
    mirrored = [at(of["right"]["shafts"]["point"], f"shafts/{half}/k_h_beta_5mm") for half in ("right", "left")]
    page.claim(halves[0] > 1.15 * halves[1] and all(abs(a / b - 1) < 1e-3 for a, b in zip(halves, mirrored)),
               f"**The halves are not alike.** The half towards the torque carries wind-up and bending ({sig(halves[0])}), the other only little wind-up ({sig(halves[1])}); with "
               "the input on the other side they change places exactly. The source computes one half and takes the other as its mirror image.")
    over = [k[name] for name in k if name.startswith("overhung")]
    evened = [k_h_beta(found["evened"]["point"]) for found in cases if "point" in found.get("evened", {})]
    page.claim(min(over) > 2.0 and max(evened) < 1.2,
               f"**Overhung pinions** reach {span(over)} and leave a part of the face without load. Everywhere the proposed slope and crowning bring it back to {span(evened, 3)}.")
    symmetric = [of[name] for name in ("base", "span270", "span500", "span700", "k100", "d50", "stiff")]
    by_standard = [at(found["shafts"]["point"], "shafts/iso6336/k_h_beta") for found in symmetric]
    ours = [k_h_beta(found["shafts"]["point"]) for found in symmetric]
    page.claim(max(by_standard) / min(by_standard) < 1.01 and min(ours) > max(by_standard),
               f"**ISO 6336-1's estimate**, for a pinion in the middle of its span, knows nothing but the face width over the diameter: {span(by_standard, 3)} in all of these, where the contact on shafts finds {span(ours, 3)}. It holds for "
               "the wind-up and a usual bearing distance, not for the bending of a long span.")
    second = [harmonic(found["shafts"]["point"], 1) / harmonic(found["translated"]["point"], 1) for found in cases if found["case"][0] not in ("b30", "b50")]
    first = [harmonic(found["shafts"]["point"], 0) / harmonic(found["translated"]["point"], 0) for found in cases]
    page.claim(min(second) > 1.0,
               f"**The excitation changes with it**: the first order of the transmission error to {span(first)} times its value on rigid shafts, the second, which a rigid mounting nearly "
               f"cancels at this contact ratio, to {span(second)} times.")


def harmonic(result, index):
    return result["mesh"]["transmission_error_harmonics_um"][index]


def pooled(cases, model, reference):
    """(frequency over the limit, ratio of amplitudes) of all orders, speeds and cases; amplitudes over the same order of the transmission
    error of each model, so that only the dynamics differ. Orders without excitation (below 1 nm) are left out."""
    found = []
    for case in cases:
        if "sweep" not in case.get(reference, {}) or "sweep" not in case.get(model, {}):
            continue
        limit = frequency_limit_hz(case["document"])
        teeth = case["document"]["design"]["pinion"]["teeth"]
        excitation = [[harmonic(case[name]["point"], i) for i in range(8)] for name in (model, reference)]
        for a, b in zip(case[model]["sweep"], case[reference]["sweep"]):
            mine, theirs = a.get("acceleration_spectrum_m_s2"), b.get("acceleration_spectrum_m_s2")
            if mine and theirs:
                for order in range(1, 9):
                    p, q = mine[4 * order - 1], theirs[4 * order - 1]
                    e, f = (orders[order - 1] for orders in excitation)
                    if min(p, q) > 0 and min(e, f) > 1e-3:
                        found.append((order * a["values"][0] * teeth / 60 / limit, p / e / (q / f)))
    return found


BANDS = [(0.0, 0.5), (0.5, 0.9), (0.9, 1.5), (1.5, 3.0)]


def in_bands(points):
    return [[ratio for x, ratio in points if low <= x < high] for low, high in BANDS]


def frequency(page, one, combined, turbo):
    """Up to which frequency the dynamics of twelve degrees of freedom are those of the shafts."""
    page.say("## Up to which frequency twelve degrees of freedom move as the shafts do\n\nSo that the contact is the same in both, the shafts have the evened helices here, and the twelve-degree "
             "model perfect flanks. Its springs come from the shafts: the deflection of both mid-faces under equal and under opposite forces (support and lateral coupling of the halves), "
             "G J/L and E A/L between them, the locating bearing; its moments of inertia are those of the whole shafts, its masses what moves with the static deflection (Rayleigh). "
             "The amplitudes of the circumferential acceleration are compared order by order (1 to 8, left half) at 31 speeds, each over the same order of the transmission error, so that only the dynamics are compared.")
    page.say("What ends the agreement is **the shaft beyond the faces**. Twelve degrees of freedom turn it with the body as if rigid. An end of inertia J and length L whose own frequency (held at the "
             "body, free at the coupling) is f_e = c/(4 L), c = 3.18 km/s in steel, acts at a frequency f as J tan(x)/x, x = (π/2) f/f_e. With both members' ends that changes the equivalent mass of the mesh; the "
             "**frequency limit f_lim** is where it has changed by a fifth. For one end whose inertia is a part μ of all that turns on that shaft, and where that shaft dominates:")
    shares = (0.05, 0.1, 0.2, 0.3, 0.5)
    page.table("μ = J_end/J_all | " + " | ".join(sig(share, 2) for share in shares), [["f_lim/f_e"] + [sig(part_of_limit(share), 2) for share in shares]])
    sets = [("one at a time", [found for found in one if not overhung(found)]), ("combined", [found for found in combined if not overhung(found)]),
            ("second pair", turbo), ("overhung", [found for found in one + combined if overhung(found)])]
    rows, numbers = [], {}
    for words, cases in sets:
        bands = in_bands(pooled(cases, "translated", "evened"))
        numbers[words] = bands
        rows.append([words, str(len(cases))] + [f"{sig(typical(band_), 3)}; {sig(most(band_), 3)}" if len(band_) > 20 else "–" for band_ in bands])
    page.table("cases | number | " + " | ".join(f"f/f_lim {low:g} to {high:g}" for low, high in BANDS), rows)
    page.say("*Typical; nine of ten*: the factor, up or down, within which half and nine of ten of the amplitudes agree.")
    draw_frequency(page, sets)
    straddle = [bands for words, bands in numbers.items() if words != "overhung"]
    low, middle, high = ([of(bands[i]) for bands in straddle if len(bands[i]) > 20] for i, of in enumerate([typical] * 3))
    most_low, most_middle = ([most(bands[i]) for bands in straddle if len(bands[i]) > 20] for i in (0, 1))
    page.claim(max(low) < 1.25 and max(middle) < 1.35 and min(high) > 1.4,
               f"**Straddle-mounted**: below half of f_lim half of all amplitudes agree within {percent(low)} and nine of ten within {percent(most_low)}; up to 0.9 f_lim within {percent(middle)} and {percent(most_middle)}. "
               f"Beyond, a factor of {span(high)} is typical and nothing can be said of a single order. The limit was found on the cases with one change; the combined ones, drawn afterwards, tested it. The second pair meshes above its limit at every speed and can only say that there "
               f"it is the same: a factor of {sig(typical(numbers['second pair'][3]))}.")
    softer = [ratio_of_supports(found["document"]) for found in one if overhung(found)]
    page.claim(typical(numbers["overhung"][0]) > max(low) and min(softer) > 1.5,
               f"**Overhung**: not even there (below half of the limit {sig(typical(numbers['overhung'][0]))} typically, {sig(most(numbers['overhung'][0]))} for nine of ten). The support of the outer half is {span(softer)} times softer than that of the inner one, and "
               "bending couples both with tilting; one spring for each half cannot say that.")
    return numbers


def overhung(found):
    return found["case"][2].get("mounting") == "overhung"


def ratio_of_supports(document):
    """Deflection of one half under its own force over that of the other, on the pinion's shaft."""
    shaft, design = document["design"]["shafts"]["pinion"], document["design"]
    middle = 0.5 * (design["gap_width_mm"] + design["face_width_mm"])
    ((a, _), (_, d)), _ = lateral(shaft, [shaft["gear_position_mm"] + side * middle for side in (-1.0, 1.0)], STEEL)
    return max(a / d, d / a)


def part_of_limit(share):
    """f_lim over f_e of one end with a part of the inertia of its shaft."""
    from math import pi, tan
    x = 1e-3
    while share * (tan(x) / x - 1) < 0.2 and x < pi / 2 - 1e-3:
        x += 1e-3
    return x / (pi / 2)


def percent(factors):
    return span([100 * (factor - 1) for factor in factors], 2) + " %"


def draw_frequency(page, sets):
    sheet = Sheet(970, 360)
    for i, (words, cases) in enumerate(sets):
        left = 60 + i * 230
        sheet.title(left, 26, words[0].upper() + words[1:])
        field = Field(sheet, (left, 36, 195, 250), (0.08, 8.0, True), (1.0, 10.0, True), "frequency over f_lim", "factor" if i == 0 else "")
        for case in cases:
            field.curve(octaves(pooled([case], "translated", "evened"), 0.5, 4), GREY, width=1.0)
        field.curve(octaves(pooled(cases, "translated", "evened"), 0.5, 20), BLACK, width=2.4)
        field.curve(octaves(pooled(cases, "translated", "evened"), 0.5, 20, most), BLUE, "5 4")
        field.rule(x=1.0, color=ORANGE)
    sheet.key(66, 345, BLACK, "half of all amplitudes agree within this factor")
    sheet.key(380, 345, BLUE, "nine of ten", "5 4")
    sheet.key(490, 345, GREY, "single cases")
    sheet.key(610, 345, ORANGE, "f_lim", "4 4")
    page.figure("shafts_frequency", sheet, "Twelve degrees of freedom against shafts: factor between the amplitudes of mesh orders, over the frequency in parts of the limit that follows from the "
                "shafts' ends.")


def octaves(points, width, least, of=typical):
    bins = {}
    for x, ratio in points:
        bins.setdefault(round(log(x, 2) / width), []).append(ratio)
    return [(2 ** (key * width), max(of(values), 1.001)) for key, values in sorted(bins.items()) if len(values) >= least]


def vibration(page, cases, combined, turbo):
    """RMS, dynamic factor and forces by each model."""
    page.say("## RMS, dynamic factor and resonances\n\nThe flanks as designed, on shafts and with twelve degrees of freedom in three ways: *default*, supports left to the program, as one writes a document "
             "without shafts; *translated*, springs, masses and inertias from the shafts as above; *deflected*, the same with the deflection of the shafts as a deviation of the flanks: the helix slope and crowning that a "
             "`mesh` job on shafts proposes, with the opposite sign. *Band*: quadratic mean of the RMS over the speeds (500 to 8000 r/min) over that of the shafts. *Typical; nine of ten*: factor at single speeds.")
    rows = []
    for found in cases + combined + turbo:
        _, words, _, _ = found["case"]
        shafts = found["shafts"]["sweep"]
        row = [words, f"{sig(k_h_beta(found['shafts']['point']))}",
               sig(frequency_limit_hz(found["document"]) / mesh_mode(found["translated"]["point"])[0], 2)]
        for model in ("default", "translated", "deflected"):
            row.append(compared(found, model, CIRCUMFERENTIAL))
        row.append(compared(found, "deflected", AXIAL))
        row.append(" / ".join(sig(largest(found[model]["sweep"], lambda point: point.get("dynamic_factor")), 3)
                              for model in ("shafts", "deflected") if "sweep" in found[model]))
        rows.append(row)
    page.table("case | K_Hβ | f_lim over the mesh mode | default: band; typical; nine of ten | translated | deflected | axial, deflected | largest dynamic factor: shafts / deflected", rows)
    stats, over = gathered([found for found in cases + combined if not overhung(found)]), gathered([found for found in cases + combined if overhung(found)])
    middle = {model: quantile(stats[model]["band"], 0.5) for model in stats}
    axial_bands = [band(found["deflected"]["sweep"], AXIAL) / band(found["shafts"]["sweep"], AXIAL) for found in cases + combined if not overhung(found)]
    page.say("What follows is of the straddle-mounted cases of the first pair.")
    page.claim(middle["translated"] < 0.9 < middle["deflected"] < 1.2,
               f"**Most of the error is the contact, not the springs.** Over the speed band the twelve degrees of freedom give {sig(middle['translated'], 2)} of the vibration of the shafts in the median (all: "
               f"{span(stats['translated']['band'])}); with the deflection in the flanks {sig(middle['deflected'], 2)} ({span(stats['deflected']['band'])}). Translating the springs by itself is worth little: the program's "
               f"default supports do about as well ({sig(middle['default'], 2)}; {span(stats['default']['band'])}).")
    groups = {words: [found for found in cases + combined if not overhung(found) and low <= k_h_beta(found["shafts"]["point"]) < high]
              for words, low, high in (("up to 1.4", 1.0, 1.4), ("1.4 to 1.9", 1.4, 1.9), ("above 1.9", 1.9, 9.0))}
    by_k = {words: {model: [band(found[model]["sweep"], CIRCUMFERENTIAL) / band(found["shafts"]["sweep"], CIRCUMFERENTIAL) for found in group] for model in MODELS_12}
            for words, group in groups.items()}
    page.say("By the face load factor, RMS over the speed band in parts of that on shafts, median and range:")
    page.table("K_Hβ | cases | default | translated | deflected",
               [[words, str(len(group))] + [f"{sig(quantile(by_k[words][model], 0.5), 2)}; {span(by_k[words][model])}" for model in MODELS_12] for words, group in groups.items()])
    page.claim(quantile(by_k["up to 1.4"]["translated"], 0.5) > 0.8 > quantile(by_k["1.4 to 1.9"]["translated"], 0.5) and abs(quantile(by_k["1.4 to 1.9"]["deflected"], 0.5) - 1) < 0.15,
               "Up to K_Hβ 1.4 the deflection may be left out; from there to 1.9 it brings the median to within a tenth; above, it overdoes it.")
    page.claim(1.1 < typical(stats["deflected"]["all"]) < 1.4,
               f"**At a single speed** half of all RMS values agree within a factor of {sig(typical(stats['default']['all']))} (default), {sig(typical(stats['translated']['all']))} (translated) and "
               f"{sig(typical(stats['deflected']['all']))} (deflected), nine of ten within {sig(most(stats['default']['all']))}, {sig(most(stats['translated']['all']))} and {sig(most(stats['deflected']['all']))}: the orders about the mesh mode, "
               "which make the RMS, lie near or beyond f_lim, and resonances stand at other speeds.")
    page.claim(typical(stats["deflected"]["axial"]) > 1.4 and quantile(axial_bands, 0.5) < 0.8,
               f"**The axial vibration is another one.** Half of the RMS values agree within {sig(typical(stats['translated']['axial']))} (translated) and {sig(typical(stats['deflected']['axial']))} (deflected) only; over the band the twelve degrees have {span(axial_bands)} of it. On shafts the pinion moves along its axis as a "
               "whole, because its halves are not alike, and its sections rock; symmetrical halves on springs do neither.")
    page.claim(max(over["translated"]["band"]) < 0.9 and max(over["deflected"]["band"]) > 1.3,
               f"**Overhung pinions**: {span(over['translated']['band'])} of the vibration of the shafts without the deflection, {span(over['deflected']['band'])} with it: no estimate either way.")
    modes = [[frequency for frequency, part in mesh_modes(cases[0][model]["point"]) if part > 0.1 and frequency < 6000] for model in ("shafts", "translated", "default")]
    parts = [max(part for _, part in mesh_modes(cases[0][model]["point"])) for model in ("shafts", "translated")]
    page.claim(len(modes[0]) > len(modes[1]) and parts[0] < 0.6 < 0.9 < parts[1],
               f"**Resonances.** Of the first case's modes below 6 kHz those with more than a tenth of their strain energy in the meshes lie at {hertz(modes[0])} on shafts, {hertz(modes[1])} with twelve degrees (translated) and "
               f"{hertz(modes[2])} (default). One mesh mode that holds {sig(100 * parts[1], 2)} % of its energy in the teeth becomes several, none above {sig(100 * parts[0], 2)} %: the ends of the shafts turn with or against the bodies. "
               "The first one, axial with the meshes opposed, moves too: on shafts the whole pinion and the gear on its locating bearing take part.")
    near, far = ([typical(ratios(found["deflected"]["sweep"], found["shafts"]["sweep"], CIRCUMFERENTIAL)) for found in cases + combined
                  if not overhung(found) and low <= frequency_limit_hz(found["document"]) / mesh_mode(found["translated"]["point"])[0] < high]
                 for low, high in ((0.8, 9.0), (0.0, 0.6)))
    page.claim(quantile(near, 0.5) < quantile(far, 0.5),
               f"The ratio of f_lim to the mesh mode shows in the RMS: with the deflection, the typical factor at a speed is {span(near, 3)} where it is above 0.8 (median {sig(quantile(near, 0.5))}), and {span(far, 3)} where it is "
               f"below 0.6 (median {sig(quantile(far, 0.5))}).")
    return {"straddle": stats, "overhung": over, "by_k": by_k, "near": near, "far": far}


MODELS_12 = ("default", "translated", "deflected")


def hertz(frequencies):
    return ", ".join(f"{frequency:.0f}" for frequency in frequencies) + " Hz"


def gathered(cases):
    """Ratios of every model to the shafts: of the band, and at all speeds."""
    stats = {}
    for model in MODELS_12:
        able = [found for found in cases if "sweep" in found[model]]
        stats[model] = {
            "band": [band(found[model]["sweep"], CIRCUMFERENTIAL) / band(found["shafts"]["sweep"], CIRCUMFERENTIAL) for found in able],
            "all": [ratio for found in able for ratio in ratios(found[model]["sweep"], found["shafts"]["sweep"], CIRCUMFERENTIAL)],
            "axial": [ratio for found in able for ratio in ratios(found[model]["sweep"], found["shafts"]["sweep"], AXIAL)],
        }
    return stats


def compared(found, model, key):
    if "sweep" not in found[model]:
        return "refused"
    mine, shafts = found[model]["sweep"], found["shafts"]["sweep"]
    values = ratios(mine, shafts, key)
    return f"{sig(band(mine, key) / band(shafts, key), 2)}; {sig(typical(values), 3)}; {sig(most(values), 3)}"


def draw_speed(page, found):
    """RMS over the speed of one case."""
    sheet = Sheet(900, 380)
    colors = {"shafts": (BLACK, ""), "translated": (BLUE, ""), "deflected": (ORANGE, "5 4"), "default": (GREEN, "2 3")}
    for i, (key, words, y) in enumerate(((CIRCUMFERENTIAL, "Mesh circumferential", (1.0, 100.0, True)), (AXIAL, "Pinion axial", (0.03, 30.0, True)))):
        left = 66 + i * 430
        sheet.title(left, 26, words)
        field = Field(sheet, (left, 36, 370, 270), (500.0, 8000.0, True), y, "speed of the pinion, r/min", "RMS, m/s²")
        for model, (color, dashes) in colors.items():
            both_halves = [(point["values"][0], point[key]) for point in found[model]["sweep"] if point.get(key)]
            field.curve([(x, (v["left"]**2 + v["right"]**2) ** 0.5 / 2**0.5) for x, v in both_halves], color, dashes)
    for i, (model, (color, dashes)) in enumerate(colors.items()):
        sheet.key(66 + 200 * i, 365, color, {"shafts": "on shafts", "translated": "12 degrees, translated", "deflected": "12 degrees, deflected", "default": "12 degrees, default"}[model], dashes)
    page.figure("shafts_speed", sheet, "RMS over the speed of the straddle-mounted pair, by each model. Quadratic mean of the halves.")
