"""SciPy on the reference cases of the equations of motion.

Reads requests "CASE METHOD TOLERANCE PERIODS RESTART" from standard input, one per line, and replies to each with the processor seconds the solution took
and the 24 states it got to (SI, the order of the reference), or with a message.

METHOD: DOP853, RK45 or LSODA of solve_ivp; dop853 of ode (compiled, equations in Python); odeint. RESTART: 1 to begin afresh at the edges of
the impact and at the ends of the mesh periods.

The equations are scaled as src/equations.rs has them, and put together as matrices: with 24 states that is the fastest form in NumPy.
"""

import json
import math
import sys
import time

import numpy as np
from scipy.integrate import ode, odeint, solve_ivp

LENGTH_M = 5e-6
METHODS = ("DOP853", "RK45", "LSODA", "dop853", "odeint")


class Equations:
    def __init__(self, common, case):
        frequency = 2000 / 60 * 17
        k = common["mean_stiffness_n_per_m"]
        omega = math.sqrt(k / common["equivalent_mass_kg"])
        zeta = common["support_damping_ratio"]
        mp, mg = common["pinion_mass_kg"], common["gear_mass_kg"]
        rp, rg = common["pinion_radius_m"], common["gear_radius_m"]
        angle = math.radians(common["helix_angle_deg"])
        cos, sin = math.cos(angle), math.sin(angle)
        masses = np.array([mp, mp, common["pinion_inertia_kg_m2"] / rp**2, mg, mg, common["gear_inertia_kg_m2"] / rg**2] * 2)
        units = np.array([1, 1, 1 / rp, 1, 1, 1 / rg] * 2) * LENGTH_M
        self.units = np.concatenate([units, units * omega])

        stiffness, damping = np.zeros((12, 12)), np.zeros((12, 12))

        def spring(value, mass, ends):
            for a in ends:
                for b in ends:
                    sign = 1 if a == b else -1
                    stiffness[a, b] += sign * value
                    damping[a, b] += sign * 2 * zeta * math.sqrt(value * mass)

        for i in (0, 6):
            spring(common["lateral_n_per_m"], mp, [i])
            spring(common["lateral_n_per_m"], mg, [i + 3])
            spring(common["gear_axial_n_per_m"], mg, [i + 4])
        spring(common["pinion_axial_coupling_n_per_m"], mp, [1, 7])
        spring(common["gear_axial_coupling_n_per_m"], mg, [4, 10])

        rate = omega / frequency
        direction = np.zeros((2, 12))
        for j, s in enumerate((sin, -sin)):
            direction[j, 6 * j : 6 * j + 6] = [cos, s, cos, -cos, -s, -cos]
        damping += 2 * case["mesh_damping_ratio"] * math.sqrt(k * common["equivalent_mass_kg"]) * direction.T @ direction
        self.matrix = np.zeros((24, 24))
        self.matrix[:12, 12:] = rate * np.eye(12)
        self.matrix[12:, :12] = -rate * stiffness / masses[:, None] / omega**2
        self.matrix[12:, 12:] = -rate * damping / masses[:, None] / omega
        # Mesh deflections; what a force over k does.
        self.direction = np.hstack([direction, np.zeros((2, 12))])
        self.push = np.vstack([np.zeros((12, 2)), -rate * k / masses[:, None] / omega**2 * direction.T])
        along = np.array([0, 0, 1, 0, 0, -1] * 2)
        self.along = np.concatenate([np.zeros(12), rate * k / masses / omega**2 * along])
        self.load = case["pinion_torque_per_half_nm"] / rp / (k * LENGTH_M)
        self.pulse = common["impact_force_n"] / (k * LENGTH_M)
        self.duration = common["impact_duration_mesh_periods"]
        self.backlash = case["half_backlash_m"] / LENGTH_M
        self.harmonics = [
            (a * math.cos(p), a * math.sin(p)) for a, p in zip(case["amplitudes"], common["phases_rad"])
        ]
        self.start = np.array(case["initial_state"]) / self.units
        self.force = np.empty(2)

    def derivative(self, t, y):
        phase = t - math.floor(t)
        sin1, cos1 = math.sin(2 * math.pi * phase), math.cos(2 * math.pi * phase)
        sin, cos, k = sin1, cos1, 1.0
        for a, b in self.harmonics:
            k += a * cos - b * sin
            sin, cos = sin * cos1 + cos * sin1, cos * cos1 - sin * sin1
        along = self.load
        if phase < self.duration:
            along -= self.pulse * math.sin(math.pi * phase / self.duration)
        b, force = self.backlash, self.force
        left, right = self.direction.dot(y).tolist()
        force[0] = k * (left - b if left > b else left + b if left < -b else 0.0)
        force[1] = k * (right - b if right > b else right + b if right < -b else 0.0)
        return self.matrix.dot(y) + self.push.dot(force) + along * self.along

    def edges(self, periods):
        for n in range(periods):
            yield n + self.duration
            yield n + 1


def solve(equations, method, tolerance, periods, restart):
    y, t, h = equations.start, 0.0, None
    for end in list(equations.edges(periods)) if restart else [periods]:
        if method == "odeint":
            y = odeint(equations.derivative, y, [t, end], rtol=tolerance, atol=tolerance, tfirst=True, mxstep=10**7)[-1]
        elif method == "dop853":
            solver = ode(equations.derivative)
            solver.set_integrator("dop853", rtol=tolerance, atol=tolerance, nsteps=10**7, first_step=h or 0.0)
            solver.set_initial_value(y, t)
            y = solver.integrate(end)
            if not solver.successful():
                raise RuntimeError("dop853 failed")
        else:
            first = None if h is None else min(h, end - t)
            found = solve_ivp(equations.derivative, (t, end), y, method=method, rtol=tolerance, atol=tolerance, first_step=first)
            if not found.success:
                raise RuntimeError(found.message)
            y = found.y[:, -1]
            # The last step was cut short by the end.
            h = max(np.diff(found.t)[-2:])
        t = float(end)
    return y * equations.units


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        document = json.load(file)
    cases = {name: Equations(document["common"], case) for name, case in document["cases"].items()}
    for line in sys.stdin:
        try:
            case, method, tolerance, periods, restart = line.split()
            if method not in METHODS:
                raise ValueError(f"no method {method}")
            at = time.thread_time()
            state = solve(cases[case], method, float(tolerance), int(periods), restart == "1")
            seconds = time.thread_time() - at
            print(repr(seconds), *(repr(float(value)) for value in state), flush=True)
        except Exception as error:  # every failure is an answer
            print("failed:", str(error).replace("\n", " "), flush=True)


if __name__ == "__main__":
    main()
