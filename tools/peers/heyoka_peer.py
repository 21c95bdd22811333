"""heyoka (Taylor series compiled at run time, with events) on the reference cases of the equations of motion.

Requests and replies as in scipy_peer.py. METHOD: the number of motions side by side in vector instructions (1: taylor_adaptive; more: taylor_adaptive_batch, all
of the same case); RESTART is always meant. heyoka is given what our own method uses:
one half of the mirrored pair, relative rotation instead of the two arcs (10 states), changes of contact as terminal events, restarts at the edges of the impact.
Compiling is not part of the time.
"""

import json
import math
import sys
import time

import heyoka as hy
import numpy as np

from scipy_peer import Equations


class Half:
    """The left half: y_p, z_p, u = R_p θ_p − R_g θ_g, y_g, z_g and their velocities, scaled as Equations has them."""

    def __init__(self, common, case):
        full = Equations(common, case)
        self.full = full
        # The arcs that belong to u where the free rotation stands still.
        jp = common["pinion_inertia_kg_m2"] / common["pinion_radius_m"] ** 2
        jg = common["gear_inertia_kg_m2"] / common["gear_radius_m"] ** 2
        back = np.zeros((12, 5))
        for j, mirrored in enumerate((1, -1)):
            i = 6 * j
            back[i, 0], back[i + 1, 1], back[i + 3, 3], back[i + 4, 4] = 1, mirrored, 1, mirrored
            back[i + 2, 2], back[i + 5, 2] = jg / (jp + jg), -jp / (jp + jg)
        pick = np.zeros((5, 12))
        for row, column in enumerate((0, 1, 2, 3, 4)):
            pick[row, column] = 1
        pick[2, 5] = -1
        zero = np.zeros_like
        self.back = np.block([[back, zero(back)], [zero(back), back]])
        self.pick = np.block([[pick, zero(pick)], [zero(pick), pick]])
        self.start = self.pick @ full.start
        # What u does not hold: the free rotation, at rest.
        self.free = full.start - self.back @ self.start
        self.matrix = self.pick @ full.matrix @ self.back
        self.push = self.pick @ full.push.sum(axis=1)
        self.along = self.pick @ full.along
        self.direction = full.direction[0] @ self.back
        self.compiled = {}

    def integrator(self, tolerance, motions):
        if (tolerance, motions) in self.compiled:
            return self.compiled[tolerance, motions]
        full = self.full
        states = hy.make_vars(*(f"q{i}" for i in range(10)))

        def linear(row):
            return hy.sum([float(c) * q for c, q in zip(row, states) if abs(c) > 1e-14])

        s = linear(self.direction)
        k = hy.sum(
            [hy.expression(1.0)]
            + [
                float(math.hypot(a, b)) * hy.cos(2 * math.pi * (i + 1) * hy.time + math.atan2(b, a))
                for i, (a, b) in enumerate(full.harmonics)
            ]
        )
        # Parameters: in contact or not, its side times the backlash, the size of the impact and its phase.
        force = k * (hy.par[0] * s - hy.par[1])
        along = full.load - hy.par[2] * hy.sin(math.pi / full.duration * hy.time + hy.par[3])
        equations = []
        for i, q in enumerate(states):
            rate = linear(self.matrix[i])
            if self.push[i] != 0:
                rate = rate + float(self.push[i]) * force
            if self.along[i] != 0:
                rate = rate + float(self.along[i]) * along
            equations.append((q, rate))
        direction, backlash = self.direction[:5], full.backlash

        def change(side):
            def callback(ta, _, lane=None):
                state, pars = (ta.state, ta.pars) if lane is None else (ta.state[:, lane], ta.pars[:, lane])
                outward = side * (direction @ state[5:]) > 0
                pars[0] = 1.0 if outward else 0.0
                pars[1] = side * backlash if outward else 0.0
                return True

            return callback

        event = hy.t_event if motions == 1 else hy.t_event_batch
        events = [event(s - backlash, callback=change(1)), event(s + backlash, callback=change(-1))]
        if motions == 1:
            ta = hy.taylor_adaptive(equations, self.start, tol=tolerance, t_events=events, pars=[0.0] * 4)
        else:
            start = np.repeat(self.start[:, None], motions, axis=1)
            ta = hy.taylor_adaptive_batch(equations, start, tol=tolerance, t_events=events, pars=np.zeros((4, motions)))
        self.compiled[tolerance, motions] = ta
        return ta

    def reset(self, ta, motions):
        if motions == 1:
            ta.time = 0.0
        else:
            ta.set_time(0.0)
        ta.state[:] = self.start if motions == 1 else self.start[:, None]
        ta.reset_cooldowns()
        s, b = self.direction @ self.start, self.full.backlash
        side = 1.0 if s > b else -1.0 if s < -b else 0.0
        ta.pars[0], ta.pars[1] = abs(side), side * b

    def follow(self, ta, motions, periods):
        pulse, turn = self.full.pulse, math.pi / self.full.duration
        for n in range(periods):
            ta.pars[2], ta.pars[3] = pulse, -turn * n
            ta.propagate_until(n + self.full.duration)
            ta.pars[2] = 0.0
            outcome = ta.propagate_until(float(n + 1))
        outcomes = [outcome[0]] if motions == 1 else [lane[0] for lane in ta.propagate_res]
        if any(outcome != hy.taylor_outcome.time_limit for outcome in outcomes):
            raise RuntimeError(str(outcomes))
        state = ta.state if motions == 1 else ta.state[:, 0]
        return (self.back @ state + self.free) * self.full.units


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        document = json.load(file)
    cases = {name: Half(document["common"], case) for name, case in document["cases"].items()}
    for line in sys.stdin:
        try:
            case, motions, tolerance, periods, _ = line.split()
            half = cases[case]
            ta = half.integrator(float(tolerance), int(motions))
            at = time.thread_time()
            half.reset(ta, int(motions))
            state = half.follow(ta, int(motions), int(periods))
            seconds = time.thread_time() - at
            print(repr(seconds), *(repr(float(value)) for value in state), flush=True)
        except Exception as error:  # every failure is an answer
            print("failed:", str(error).replace("\n", " "), flush=True)


if __name__ == "__main__":
    main()
