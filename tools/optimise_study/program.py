"""The program on documents: results, and what they cost."""

import copy
import json
import os
import resource
import subprocess
import tempfile
import time

ACCELERATION = "/response/rms/mesh_circumferential_acceleration_m_s2"
OF_STUDIES = ["operating_points", "variables", "objectives", "constraints", "robust", "budget", "method", "tolerances",
              "correlations", "measures", "limits", "samples", "sampling", "sensitivity", "seed"]


def example(name):
    with open(f"examples/{name}.json", encoding="utf-8") as file:
        return json.load(file)


def solve(document):
    """The result of a document, with its cost in `cost`."""
    with tempfile.NamedTemporaryFile("w", suffix=".json", encoding="utf-8") as file:
        json.dump(document, file)
        file.flush()
        started, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        run = subprocess.run([os.environ["HERRINGBONE"], "solve", file.name], capture_output=True, text=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if run.returncode != 0:
        raise SystemExit(f"{document.get('name')}: {run.stderr}")
    result = json.loads(run.stdout)
    result["cost"] = {"wall_s": time.monotonic() - started, "cpu_s": after.ru_utime - before.ru_utime,
                      "memory_mib": after.ru_maxrss / 1024}
    return result


def put(document, pointer, value):
    *path, last = pointer.strip("/").split("/")
    for step in path:
        document = document.setdefault(step, {})
    document[last] = value


def with_values(document, values):
    """The document with the values of variables, by their first pointers."""
    document = copy.deepcopy(document)
    for variable in document["variables"]:
        value = values[variable["pointer"]]
        factors = variable.get("also_factors", [1] * len(variable.get("also", [])))
        put(document, variable["pointer"], value)
        for pointer, factor in zip(variable.get("also", []), factors):
            put(document, pointer, factor * value)
    return document


def response(document):
    """The document of a response at the point of `operation`."""
    document = {name: value for name, value in copy.deepcopy(document).items() if name not in OF_STUDIES}
    document["kind"] = "response"
    return document


def sweep(document, axes):
    document = response(document)
    document["kind"], document["axes"] = "sweep", axes
    return solve(document)["sweep"]["points"]


def worst_acceleration(row):
    found = row["mesh_circumferential_acceleration_rms_m_s2"]
    return max(found.values()) if found else float("inf")


def say(result):
    """Cost, gain and, of a robust choice, its percentiles."""
    say_cost(result)
    say_gain(result)
    if result["optimise"].get("robust"):
        say_robust(result)


def say_cost(result):
    cost, numerics = result["cost"], result["optimise"]["numerics"]
    print(f"  {numerics['evaluations']} evaluations, {cost['wall_s']:.0f} s ({cost['cpu_s']:.0f} s of processor), "
          f"ended by {numerics['stopped_by']}")


def say_gain(result):
    found = result["optimise"]
    for objective in found["objectives"]:
        print(f"  {found['verdict']}: {objective['measure']} {objective['input']:.4g} -> {objective['best']:.4g} "
              f"({objective['gain_percent']:.1f} %)")
        for point in objective["per_point"]:
            print(f"    {point['pinion_torque_nm']:g} N m: {point['input']:.4g} -> {point['best']:.4g} "
                  f"({point['gain_percent']:.1f} %)")
    for pointer, value in found["best"]["values"].items():
        print(f"    {pointer} = {value:.4g}")
    for flat in found["flatness"]:
        print(f"    within 2 %: {flat['pointer']} {flat['range_within_2_percent']}, alone worse by "
              f"{flat['rise_at_ends_percent']} %")
    for limit in found["active"]:
        print(f"    limited by {limit}")
    for near in found.get("neighbours", []):
        print(f"    {near['speed_percent']:+g} % speed: {near['objective']:.4g}{' JUMP' if near['jump'] else ''}")


def say_robust(result):
    robust = result["optimise"]["robust"]
    for name in ("input", "nominal_best", "best"):
        if robust.get(name):
            of = robust[name]
            print(f"    {name} over {robust['sample']} points: P50 {of['p50']:.4g}, P90 {of['p90']:.4g} "
                  f"{of['p90_interval']}, max {of['max']:.4g}, failed {of['failed']}")
    if robust.get("search"):
        print(f"    search on the measure: {robust['search']}")
    gain = robust["gain_percent"]
    print(f"    gain of {robust['measure']}: " + ("none is said: too many points failed" if gain is None else f"{gain:.1f} %"))
