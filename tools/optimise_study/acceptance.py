"""Whole searches against grids and random points, the promise, robust choices, coverage of intervals, time."""

import math
import random

from program import (ACCELERATION, example, put, response, say, say_cost, solve, sweep, with_values,
                     worst_acceleration)

# As a search has them, so that both see one function.
SEARCH = {"positions": 32, "accuracy": 0.01}


def relief_alone(variables=2):
    document = example("optimise_relief")
    document["variables"] = document["variables"][:variables]
    for variable in document["variables"]:
        del variable["step"]
    del document["constraints"]
    document["model"]["mesh_stiffness"].update(SEARCH)
    return document


def against_grid(document, count, thirds, evaluations):
    """Prints the least of a grid at three torques, and what searches find with a number of evaluations."""
    worst = {}
    axes = [{"pointer": variable["pointer"], "also": variable.get("also", []), "from": variable["from"],
             "to": variable["to"], "points": count} for variable in document["variables"][:2]]
    for point in document["operating_points"]:
        document["operation"]["pinion_torque_nm"] = point["pinion_torque_nm"]
        for third in thirds:
            if third is not None:
                put(document, document["variables"][2]["pointer"], third)
            for row in sweep(document, axes):
                place = (*row["values"], third)
                worst[place] = max(worst.get(place, 0.0), worst_acceleration(row))
    document["operation"]["pinion_torque_nm"] = 800.0
    if thirds[0] is not None:
        put(document, document["variables"][2]["pointer"], thirds[0])
    place = min(worst, key=worst.get)
    print(f"  grid: least {worst[place]:.4f} m/s2 at {place}, of {len(worst)} designs")
    for seed in range(1, 6):
        document["budget"], document["seed"] = {"evaluations": evaluations}, seed
        result = solve(document)
        found = result["optimise"]
        best = found["objectives"][0]["best"]
        searched = sum(row["phase"] in ("sample", "search", "polish") for row in found["points"])
        print(f"  seed {seed}: {best:.4f} m/s2 at {list(found['best']['values'].values())}, {100 * (best / worst[place] - 1):+.2f} % "
              f"of the grid's, {searched} evaluations of the search, {result['cost']['cpu_s']:.0f} s of processor")


def grid():
    """Relief amount and length at three torques against a grid of 41 x 41 designs (at most 200 evaluations, 1 %)."""
    against_grid(relief_alone(), 41, [None], 200)


def grid_crowning():
    """The same with crowning as a third variable against 21 x 21 x 21 designs (at most 300 evaluations)."""
    against_grid(relief_alone(3), 21, [0.75 * step for step in range(21)], 300)


def promise_document():
    document = example("optimise_relief")
    contact = example("contact")
    document["design"], document["model"] = contact["design"], contact["model"]
    for gear in ("pinion", "gear"):
        document["design"][gear]["tip_relief"] = {"amount_um": 0.0, "length_mm": 6.0}
    bounds = [("/design/pinion/tip_relief/amount_um", 0, 40), ("/design/pinion/tip_relief/length_mm", 2, 12),
              ("/design/gear/tip_relief/amount_um", 0, 40), ("/design/gear/tip_relief/length_mm", 2, 12),
              ("/design/pinion/lead_crowning_um", 0, 15), ("/design/half_stagger", 0, 0.5)]
    document["variables"] = [{"pointer": pointer, "from": low, "to": high} for pointer, low, high in bounds]
    del document["constraints"]
    document["budget"] = {"evaluations": 400}
    return document


TOLERANCES = [{"pointer": "/design/pinion/tip_relief/amount_um", "tolerance": 5},
              {"pointer": "/design/gear/tip_relief/amount_um", "tolerance": 5},
              {"pointer": "/design/pinion/helix_slope_um", "halves": "independent", "distribution": "uniform", "plus": 6},
              {"pointer": "/design/assembly/in_plane_misalignment_um", "tolerance": 15}]


def promise():
    """The source's pair with contact in the equations: 30 % at the worst of three torques, and a robust gain."""
    document = promise_document()
    document["tolerances"] = TOLERANCES
    document["robust"] = {"samples": 16, "candidates": 3, "confirm_samples": 64}
    result = solve(document)
    say(result)


def promise_shafts():
    """A pair on shafts: relief, crowning and slopes of both halves at two torques."""
    document = example("shafts")
    document["kind"] = "optimise"
    document["operating_points"] = [{"pinion_torque_nm": torque} for torque in (500, 800)]
    pinion = document["design"]["pinion"]
    # A length, so that the tolerance of the amount has a meaning for the input too.
    pinion["left"] = pinion["right"] = {"tip_relief": {"amount_um": 0.0, "length_mm": 6.0}}
    halves = ["/design/pinion/left", "/design/pinion/right"]
    both = lambda name: {"pointer": f"{halves[0]}/{name}", "also": [f"{halves[1]}/{name}"]}
    document["variables"] = [{**both("tip_relief/amount_um"), "from": 0, "to": 40},
                             {**both("tip_relief/length_mm"), "from": 2, "to": 12},
                             {**both("lead_crowning_um"), "from": 0, "to": 10},
                             {"pointer": f"{halves[0]}/helix_slope_um", "from": -15, "to": 15},
                             {"pointer": f"{halves[1]}/helix_slope_um", "from": -15, "to": 15}]
    document["objectives"] = [{"measure": ACCELERATION, "relative_to": "input"}]
    document["budget"] = {"evaluations": 120}
    document["tolerances"] = [{"pointer": f"{half}/tip_relief/amount_um", "tolerance": 5} for half in halves]
    document["tolerances"] += [{"pointer": f"{half}/helix_slope_um", "distribution": "uniform", "plus": 6} for half in halves]
    document["robust"] = {"samples": 8, "candidates": 2, "confirm_samples": 32}
    result = solve(document)
    say(result)


def cliff():
    """Relief by transmission error: the robust choice against the nominal one on an independent sample of 4096."""
    document = relief_alone()
    document["model"]["mesh_force"] = "stiffness"
    document["operating_points"] = [{"pinion_torque_nm": 800.0}]
    document["tolerances"] = [{"pointer": "/design/pinion/tip_relief/amount_um", "tolerance": 6},
                              {"pointer": "/design/gear/tip_relief/amount_um", "tolerance": 6},
                              {"pointer": "/design/pinion/tip_relief/length_mm", "tolerance": 1.0}]
    document["budget"] = {"evaluations": 300}
    document["objectives"] = [{"measure": "/mesh/transmission_error_pp_um"}]
    document["robust"] = {"samples": 32, "candidates": 10, "confirm_samples": 4096, "search": True}
    result = solve(document)
    say(result)


def coverage():
    """A linear measure of normal inputs: 95 % intervals of 100 seeds against the exact percentiles."""
    document = response(example("given_stiffness"))
    document["kind"] = "tolerance"
    document["tolerances"] = [{"pointer": "/design/face_width_mm", "tolerance": 3.0, "cut": False}]
    document["measures"] = [{"measure": "/geometry/overlap_ratio"}]
    document["sensitivity"] = "none"
    held = {"p50": 0, "p90": 0, "p95": 0}
    exact = {"p50": 0.0, "p90": 1.2815515655446004, "p95": 1.6448536269514722}
    for seed in range(100):
        document["seed"] = seed
        result = solve(document)
        geometry, measure = result["geometry"], result["tolerance"]["measures"][0]
        per_mm = math.tan(math.radians(geometry["base_helix_angle_deg"])) / geometry["transverse_base_pitch_mm"]
        for name, score in exact.items():
            interval, value = measure["percentiles"][name], geometry["overlap_ratio"] + per_mm * score
            held[name] += interval["low"] <= value <= interval["high"]
    print(f"  intervals that hold the exact percentile, of 100 seeds of 1024 points: {held}")


def time():
    """1500 evaluations with a mesh stiffness from the loaded contact; 100 000 rows."""
    document = promise_document()
    del document["operating_points"]
    document["model"]["mesh_force"] = "stiffness"
    document["budget"] = {"evaluations": 1500, "accuracy": 1e-12}
    result = solve(document)
    say_cost(result)
    cost = result["cost"]
    print(f"  {1e3 * cost['cpu_s'] / result['optimise']['numerics']['evaluations']:.1f} ms of processor for each, "
          f"{cost['memory_mib']:.0f} MiB")
    document = response(example("given_stiffness"))
    document["kind"] = "optimise"
    names = ["pinion/profile_shift", "gear/profile_shift", "pinion/addendum", "gear/addendum", "pinion/dedendum",
             "gear/dedendum", "face_width_mm", "helix_angle_deg", "pressure_angle_deg", "gap_width_mm",
             "pinion/bore_diameter_mm", "gear/bore_diameter_mm"]
    bounds = [(0, 0.3), (0, 0.3), (0.9, 1.1), (0.9, 1.1), (1.2, 1.4), (1.2, 1.4), (60, 90), (15, 30), (18, 22), (20, 60),
              (30, 60), (60, 120)]
    document["variables"] = [{"pointer": f"/design/{name}", "from": low, "to": high} for name, (low, high) in zip(names, bounds)]
    document["objectives"] = [{"measure": "/geometry/total_contact_ratio", "goal": "maximise"}]
    for evaluations in (5000, 100_000):
        document["budget"] = {"evaluations": evaluations, "accuracy": 1e-12}
        result = solve(document)
        found, cost = result["optimise"], result["cost"]
        print(f"  geometry alone, 12 variables: {found['numerics']['evaluations']} rows in {cost['wall_s']:.1f} s, "
              f"{1e6 * cost['cpu_s'] / found['numerics']['evaluations']:.0f} us of processor for each with its evaluation, "
              f"{cost['memory_mib']:.0f} MiB")
