"""What two models of one drive are compared on."""

from math import exp, log, pi, sqrt, tan

from beam import inertia, sections
from service import at

CIRCUMFERENTIAL = "mesh_circumferential_acceleration_rms_m_s2"
AXIAL = "pinion_axial_acceleration_rms_m_s2"


def both(value):
    """Quadratic mean of the halves."""
    return None if value is None else sqrt((value["left"] ** 2 + value["right"] ** 2) / 2)


def band(points, key):
    """Quadratic mean over the speeds that were solved."""
    values = [both(point.get(key)) for point in points]
    values = [value for value in values if value is not None]
    return sqrt(sum(value * value for value in values) / len(values))


def ratios(model, shafts, key):
    """Ratio of the model to the shafts at every speed that both solved."""
    pairs = [(both(a.get(key)), both(b.get(key))) for a, b in zip(model, shafts)]
    return [a / b for a, b in pairs if a and b]


def typical(values):
    """The factor that half of the ratios keep within, above or below 1."""
    return quantile([abs(log(value)) for value in values], 0.5, exp)


def most(values):
    """The factor that nine of ten keep within."""
    return quantile([abs(log(value)) for value in values], 0.9, exp)


def quantile(values, part, then=lambda value: value):
    ordered = sorted(values)
    place = part * (len(ordered) - 1)
    low = int(place)
    high = min(low + 1, len(ordered) - 1)
    return then(ordered[low] + (place - low) * (ordered[high] - ordered[low]))


def largest(points, of):
    return max(of(point) for point in points if of(point) is not None)


def k_h_beta(result):
    """The larger face load factor of the halves, means over 5 mm."""
    return max(at(result, f"shafts/{half}/k_h_beta_5mm") for half in ("left", "right"))


def deflection_ratio(result):
    """Twist and bending along the faces over the deflection of the teeth: how much the proposed modification takes away at the
    outer end (slope and crowning) over the mean approach of the teeth."""
    most_um = 0.0
    for half in ("left", "right"):
        proposed = at(result, f"shafts/{half}/helix_modification")
        slope, crown = proposed["slope_um"], proposed["crowning_um"]
        shape = [slope * x + crown * (2 * x - 1) ** 2 for x in (i / 50 for i in range(51))]
        most_um = max(most_um, max(shape) - min(shape))
    return most_um / result["mesh"]["transmission_error_mean_um"]


def mesh_modes(result):
    """Natural frequencies (Hz) and the part of their strain energy in both meshes, by ascending frequency."""
    rotor = at(result, "response/rotor")
    if rotor:
        return [(mode["frequency_hz"], sum(mode["strain_energy_mesh"].values())) for mode in rotor["modes"]]
    modes = at(result, "response/natural_modes")
    return [(mode["frequency_hz"], mode["strain_energy"].get("mesh_left", 0) + mode["strain_energy"].get("mesh_right", 0))
            for mode in modes if mode["frequency_hz"] > 1]


def mesh_mode(result, below_hz=2500.0):
    """Centre (Hz) of the modes above `below_hz` that hold the energy of the mesh: weighted by its part, squared."""
    modes = [(f, part) for f, part in mesh_modes(result) if below_hz < f < 9000.0]
    return max(modes, key=lambda mode: mode[1])


def by_frequency(model, shafts, teeth, width=0.5):
    """Ratio of the amplitudes of all mesh orders (1 to 8) of all speeds, by the middle frequency (Hz) of bands of `width` octaves."""
    bins = {}
    for a, b in zip(model, shafts):
        mine, theirs = a.get("acceleration_spectrum_m_s2"), b.get("acceleration_spectrum_m_s2")
        if not mine or not theirs:
            continue
        mesh_hz = a["values"][0] * teeth / 60
        for order in range(1, 9):
            # Orders in steps of a quarter.
            p, q = mine[4 * order - 1], theirs[4 * order - 1]
            if p > 0 and q > 0:
                bins.setdefault(round(log(order * mesh_hz / 100, 2) / width), []).append(p / q)
    return {100 * 2 ** (key * width): values for key, values in sorted(bins.items()) if len(values) >= 5}


def shaft_ends(document, member):
    """Polar moment of inertia (kg m²), length (m) of the shaft beyond the outer end of each face; and the moment of inertia of the
    whole shaft with its half bodies."""
    design = document["design"]
    shaft = design["shafts"][member]
    density = 7850.0
    outer = 0.5 * design["gap_width_mm"] + design["face_width_mm"]
    ends = []
    for low_mm, high_mm in ((0.0, shaft["gear_position_mm"] - outer), (shaft["gear_position_mm"] + outer, 1e9)):
        polar = length = 0.0
        for a, b, diameter, bore in sections(shaft):
            part = max(0.0, min(b, high_mm) - max(a, low_mm)) * 1e-3
            polar += density * pi / 32 * (diameter**4 - bore**4) * 1e-12 * part
            length += part
        ends.append((polar, length))
    return ends, inertia(shaft, density)[1]


def frequency_limit_hz(document, deviation=0.2):
    """Frequency at which the ends of the shafts, elastic in torsion, change the equivalent mass of the mesh by `deviation`: an end of
    inertia J and length L that turns with its body at a frequency f acts as J tan(x)/x, x = (π/2) f/f_e, f_e = c/(4 L) its own
    frequency with the body held, c the speed of torsional waves (3.18 km/s in steel)."""
    design = document["design"]
    wave_m_s = sqrt(206e9 / 2.6 / 7850.0)
    radii = [design[gear]["teeth"] for gear in ("pinion", "gear")]
    members = [shaft_ends(document, member) for member in ("pinion", "gear")]

    def mass(f):
        inverse = 0.0
        for (ends, total), radius in zip(members, radii):
            polar = total
            for end, length in ends:
                x = 2 * pi * f * length / wave_m_s
                polar += end * (tan(x) / x - 1) if x > 1e-6 else 0.0
            inverse += radius**2 / polar
        return 1 / inverse

    first_pole = min(wave_m_s / (4 * length) for ends, _ in members for _, length in ends if length > 0)
    at_rest, f = mass(1e-3), 1.0
    while f < first_pole and abs(mass(f) / at_rest - 1) < deviation:
        f *= 1.005
    return min(f, first_pole)
