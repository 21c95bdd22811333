"""Static stiffness of a stepped shaft on two bearings as a twelve-degree-of-freedom model can take it: springs of each
half to the housing and between the halves. Timoshenko beams, as docs/theory/shafts.md; no more than a careful
translation by hand would do."""

from math import pi


def sections(shaft):
    """(from mm, to mm, outer mm, bore mm) of each segment."""
    at, found = 0.0, []
    for segment in shaft["segments"]:
        found.append((at, at + segment["length_mm"], segment["diameter_mm"], segment.get("bore_mm", 0.0)))
        at += segment["length_mm"]
    return found


def solved(matrix, right):
    """Solution of a dense linear system, Gauss with pivots."""
    n = len(matrix)
    rows = [list(row) + [right[i]] for i, row in enumerate(matrix)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            if factor:
                for j in range(k, n + 1):
                    rows[i][j] -= factor * rows[k][j]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - sum(rows[k][j] * x[j] for j in range(k + 1, n))) / rows[k][k]
    return x


def lateral(shaft, places_mm, material):
    """Deflections (m/N) at the places by forces at the places, bearings included; and the mass (kg) of the whole shaft that moves with
    them: weighted with the square of the deflection under equal forces, over the mean one at the places (Rayleigh)."""
    e_pa, nu = material["youngs_modulus_gpa"] * 1e9, material["poissons_ratio"]
    nodes = sorted({round(z, 6) for a, b, _, _ in sections(shaft) for z in (a, b)}
                   | {round(bearing["position_mm"], 6) for bearing in shaft["bearings"]} | {round(z, 6) for z in places_mm})
    size = 2 * len(nodes)
    stiffness = [[0.0] * size for _ in range(size)]
    pieces = []
    for i, (a, b) in enumerate(zip(nodes, nodes[1:])):
        outer, bore = next((o, d) for low, high, o, d in sections(shaft) if low - 1e-9 <= a and b <= high + 1e-9)
        do, di, length = outer * 1e-3, bore * 1e-3, (b - a) * 1e-3
        m2 = (di / do) ** 2
        pieces.append(material["density_kg_m3"] * pi / 4 * (do**2 - di**2) * length)
        kappa = 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)
        ei, ga = e_pa * pi / 64 * (do**4 - di**4), e_pa / (2 * (1 + nu)) * pi / 4 * (do**2 - di**2)
        phi = 12 * ei / (kappa * ga * length**2)
        c = ei / ((1 + phi) * length**3)
        element = [[12, 6 * length, -12, 6 * length],
                   [6 * length, (4 + phi) * length**2, -6 * length, (2 - phi) * length**2],
                   [-12, -6 * length, 12, -6 * length],
                   [6 * length, (2 - phi) * length**2, -6 * length, (4 + phi) * length**2]]
        for p in range(4):
            for q in range(4):
                stiffness[2 * i + p][2 * i + q] += c * element[p][q]
    for bearing in shaft["bearings"]:
        at = nodes.index(round(bearing["position_mm"], 6))
        stiffness[2 * at][2 * at] += bearing["radial_n_per_um"] * 1e6
        stiffness[2 * at + 1][2 * at + 1] += bearing.get("tilting_nm_per_rad", 0.0)
    where = [2 * nodes.index(round(z, 6)) for z in places_mm]
    columns = [solved(stiffness, [1.0 if row == index else 0.0 for row in range(size)]) for index in where]
    together = [sum(column[row] for column in columns) for row in range(0, size, 2)]
    mean = sum(together[row // 2] for row in where) / len(where)
    body = (shaft.get("half_body") or {"mass_kg": 0.0})["mass_kg"]
    # The mass of a piece with the deflection between its ends taken as linear.
    mass_kg = sum(piece * (p * p + p * q + q * q) / 3 for piece, p, q in zip(pieces, together, together[1:]))
    mass_kg += sum(body * together[row // 2] ** 2 for row in where)
    return [[column[row] for column in columns] for row in where], mass_kg / mean**2


def between(shaft, a_mm, b_mm, material):
    """Axial (N/m) and torsional (N m/rad) stiffness between two places."""
    e_pa = material["youngs_modulus_gpa"] * 1e9
    g_pa = e_pa / (2 * (1 + material["poissons_ratio"]))
    axial = torsional = 0.0
    for low, high, outer, bore in sections(shaft):
        length = max(0.0, min(high, b_mm) - max(low, a_mm)) * 1e-3
        do, di = outer * 1e-3, bore * 1e-3
        axial += length / (e_pa * pi / 4 * (do**2 - di**2))
        torsional += length / (g_pa * pi / 32 * (do**4 - di**4))
    return 1 / axial, 1 / torsional


def inertia(shaft, density):
    """Mass (kg) and polar moment of inertia (kg m²) of the whole shaft with both half bodies."""
    mass = polar = 0.0
    for low, high, outer, bore in sections(shaft):
        part = density * pi / 4 * (outer**2 - bore**2) * 1e-6 * (high - low) * 1e-3
        mass += part
        polar += part * (outer**2 + bore**2) * 1e-6 / 8
    body = shaft.get("half_body") or {"mass_kg": 0.0, "polar_inertia_kg_m2": 0.0}
    return mass + 2 * body["mass_kg"], polar + 2 * body["polar_inertia_kg_m2"]
