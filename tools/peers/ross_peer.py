"""ROSS on the geared rotors of tools/src/bin/rotor_frequencies.rs: natural frequencies at rest and turning, against ours.

    ross_peer.py FILE     FILE: what that program printed

Builds every shaft from ROSS's own beam, disc and bearing elements on our nodes, joins both by our formula of the mesh rows (helical) or by
ROSS's MultiRotor (spur), finds the frequencies with SciPy and prints the largest relative difference of each case. Fails beyond 1e-4.
"""

import json
import math
import os
import sys
import warnings

import numpy as np
from scipy.linalg import eigvals

# What ROSS's libraries say when they are loaded is not part of the output.
warnings.filterwarnings("ignore")
shown = [os.dup(stream) for stream in (1, 2)]
with open(os.devnull, "w") as nothing:
    for stream in (1, 2):
        os.dup2(nothing.fileno(), stream)
try:
    import ross
finally:
    for stream, original in zip((1, 2), shown):
        os.dup2(original, stream)

LIMIT = 1e-4
# Below: rigid-body motions, which rounding moves off zero.
LEAST_HZ = 5.0


def node_at(shaft, z_m):
    nodes = np.array(shaft["nodes_z_m"])
    node = int(np.argmin(abs(nodes - z_m)))
    assert abs(nodes[node] - z_m) < 1e-9, f"no node at {z_m}"
    return node


def rotor(shaft, gear=None):
    """A ROSS rotor; `gear` = (node, teeth, base radius, pressure angle) makes the body there a gear."""
    material = ross.Material(
        "Shaft",
        rho=shaft["density_kg_m3"],
        E=shaft["youngs_modulus_pa"],
        Poisson=shaft["poissons_ratio"],
    )
    nodes = shaft["nodes_z_m"]
    ends = nodes[0] + np.cumsum([segment[0] for segment in shaft["segments_m"]])
    elements = []
    for left, right in zip(nodes, nodes[1:]):
        segment = shaft["segments_m"][int(np.searchsorted(ends, 0.5 * (left + right)))]
        elements.append(
            ross.ShaftElement(
                L=right - left,
                idl=segment[2],
                odl=segment[1],
                material=material,
                shear_effects=True,
                rotary_inertia=True,
                gyroscopic=True,
                shear_method_calc="cowper",
            )
        )
    discs = []
    for body in shaft["bodies"]:
        n = node_at(shaft, body["z_m"])
        values = {"n": n, "m": body["mass_kg"], "Id": body["diametral_inertia_kg_m2"], "Ip": body["polar_inertia_kg_m2"]}
        if gear and gear[0] == n:
            values |= {"n_teeth": gear[1], "base_diameter": 2 * gear[2], "pr_angle": gear[3]}
            discs.append(ross.GearElement(**values))
        else:
            discs.append(ross.DiskElement(**values))
    bearings = []
    for bearing in shaft["bearings"]:
        k = bearing["radial_n_per_m"]
        bearings.append(
            ross.BearingElement(
                n=node_at(shaft, bearing["z_m"]),
                kxx=k[0][0],
                kxy=k[0][1],
                kyx=k[1][0],
                kyy=k[1][1],
                kzz=bearing["axial_n_per_m"],
                cxx=0.0,
            )
        )
    return ross.Rotor(elements, discs, bearings)


def joined(first, second):
    size = len(first)
    matrix = np.zeros((size + len(second), size + len(second)))
    matrix[:size, :size], matrix[size:, size:] = first, second
    return matrix


def mesh_row(case, half, size, offset):
    """h = [n, r_p × n | −n, −r_g × n] with the levers to the pitch point."""
    mesh = case["mesh"]
    alpha, beta, sense = mesh["working_pressure_angle_rad"], mesh["base_helix_angle_rad"], mesh["rotation_sense"]
    hand = (-1 if mesh["apex_leading"] else 1) * (1 if half == 1 else -1)
    n = np.array([math.sin(alpha) * math.cos(beta), sense * math.cos(alpha) * math.cos(beta), -hand * math.sin(beta)])
    radii = [radius / math.cos(alpha) for radius in mesh["base_radii_m"]]
    row = np.zeros(size)
    for member, (sign, lever) in enumerate([(1, radii[0]), (-1, -radii[1])]):
        first = offset * member + 6 * node_at(case["shafts"][member], mesh["z_m"][half])
        row[first : first + 3] = sign * n
        row[first + 3 : first + 6] = sign * np.cross([lever, 0, 0], n)
    return row


def frequencies(mass, gyroscopic, stiffness):
    size = len(mass)
    inverse = np.linalg.inv(mass)
    state = np.zeros((2 * size, 2 * size))
    state[:size, size:] = np.eye(size)
    state[size:, :size], state[size:, size:] = -inverse @ stiffness, -inverse @ gyroscopic
    found = eigvals(state).imag / (2 * math.pi)
    return np.sort(found[found > LEAST_HZ])


def ours(case, result):
    return np.array([f for f in result["frequencies_hz"] if f > LEAST_HZ])


def main():
    with open(sys.argv[1]) as file:
        cases = json.load(file)
    print(f"ROSS {ross.__version__}, frequencies compared with ours\n")
    print("| case | r/min | frequencies | up to Hz | largest relative difference |")
    print("|---|---|---|---|---|")
    worst = 0.0

    def report(name, rpm, own, other):
        nonlocal worst
        other = other[: len(own)]
        difference = float(np.max(abs(own / other - 1)))
        worst = max(worst, difference)
        print(f"| {name} | {rpm:g} | {len(own)} | {own[-1]:.0f} | {difference:.1e} |", flush=True)

    for case in cases:
        mesh = case["mesh"]
        shafts = [rotor(shaft) for shaft in case["shafts"]]
        ratio = -mesh["teeth"][0] / mesh["teeth"][1]
        mass = joined(*(shaft.M(0) for shaft in shafts))
        offset = shafts[0].ndof
        spur = mesh["base_helix_angle_rad"] == 0
        if spur:
            # ROSS's own mesh: the pinion drives in the direction of +z, its gear on +x.
            half = 1
            gears = [
                rotor(
                    shaft,
                    (
                        node_at(shaft, mesh["z_m"][half]),
                        mesh["teeth"][member],
                        mesh["base_radii_m"][member],
                        mesh["working_pressure_angle_rad"],
                    ),
                )
                for member, shaft in enumerate(case["shafts"])
            ]
            nodes = tuple(node_at(shaft, mesh["z_m"][half]) for shaft in case["shafts"])
            both = ross.MultiRotor(*gears, nodes, gear_mesh_stiffness=mesh["stiffness_n_per_m"][half])
            stiffness = both.K(0)
        else:
            stiffness = joined(*(shaft.K(0) for shaft in shafts))
            for half in range(2):
                row = mesh_row(case, half, len(mass), offset)
                stiffness += mesh["stiffness_n_per_m"][half] * np.outer(row, row)
        for result in case["results"]:
            speed = mesh["rotation_sense"] * result["pinion_speed_rpm"] * 2 * math.pi / 60
            gyroscopic = joined(shafts[0].G() * speed, shafts[1].G() * speed * ratio)
            other = frequencies(mass, gyroscopic, stiffness)
            own = ours(case, result)
            report(case["name"] + (" (MultiRotor)" if spur else ""), result["pinion_speed_rpm"], own, other)
        if case is cases[0]:
            # ROSS's own modal analysis of the pinion's shaft: each of its frequencies is among ours.
            result = case["results"][-1]
            speed = result["pinion_speed_rpm"] * 2 * math.pi / 60
            modal = shafts[0].run_modal(speed, num_modes=24)
            other = np.array(sorted(set(w for w in modal.wd / (2 * math.pi) if w > LEAST_HZ)))
            own = ours(case, result)
            other = other[other < own[-1]]
            nearest = np.array([own[np.argmin(abs(own - w))] for w in other])
            report("run_modal of the pinion's shaft", result["pinion_speed_rpm"], nearest, other)
    if not worst <= LIMIT:
        sys.exit(f"largest difference {worst:.1e}, allowed {LIMIT:g}")


main()
