"""What Schemathesis is told of this service beside its description: a check of its own, and that jobs are canceled."""

import json
import random
import re
from collections import deque
from pathlib import Path

import requests
import schemathesis

# Problems that hang on more than one field, or on what is stored.
BEYOND_THE_SCHEMA = {"invalid-cursor", "idempotency-key-reused", "unsupported-design"}

# What the reader of documents and parameters says of a single field. All of it is in the published schemas.
OF_A_FIELD = {"missing", "unknown-field", "wrong-type", "out-of-range", "not-one-of", "too-long", "further"}

# Fields whose need or range depends on another field.
DEPENDENT = re.compile(
    # needed where the axis has no values; the range of a swept value is that of the input it varies
    r"/axes/\d+(/from|/to)?"
    # the range of a variable is that of the input it varies, and whole numbers have whole steps
    r"|/variables/\d+(/(from|to|step))?"
    # needed for a robust search; needed with their distribution
    r"|/tolerances(/\d+/(tolerance|plus|values))?"
    # needed with the goal "target"; one of measure and margin is needed
    r"|/objectives/\d+/target|/constraints/\d+/measure"
    # needed with source "given"
    r"|/model/mesh_stiffness/mean_n_per_um|/model/impact/(force_n|duration_mesh_periods)"
    # needed by measures of the shafts
    r"|/design/shafts"
    # needed without an arrangement; a spring and the machine on it need each other
    r"|/design/shafts/(pinion|gear)(/coupling/(inertia_kg_m2|torsional_nm_per_rad))?"
    # one of the names that GET /jobs/{id}/series lists
    r"|/analysis/channels/\d+"
)


@schemathesis.check
def only_rules_beyond_the_schema(ctx, response, case):
    """Data that fits the schema is refused for rules between fields only."""
    if case.meta is None or not case.meta.generation.mode.is_positive or response.status_code not in (400, 422):
        return
    problem = response.json()
    if problem["code"] in BEYOND_THE_SCHEMA:
        return
    told = [
        violation
        for violation in problem["errors"]
        if violation["code"] in OF_A_FIELD and not DEPENDENT.fullmatch(violation["pointer"])
    ]
    assert problem["errors"] and not told, f"the schema permits what is refused: {told or problem}"


EXAMPLE = json.loads((Path(__file__).parents[2] / "examples" / "table1.json").read_text())


@schemathesis.hook
def before_call(context, case, **kwargs):
    """Bends data that fits the schema to rules that no schema can say."""
    if case.meta is None or not case.meta.generation.mode.is_positive:
        return
    if case.operation.label.startswith("GET /api/v1/jobs/{id}/series"):
        window(case.query)
    elif case.operation.label == "GET /api/v1/jobs/{id}/points" and "decimal" in case.query:
        # The decimal sign is of CSV.
        case.query.pop("format", None)
    elif case.operation.label in ("POST /api/v1/jobs", "POST /api/v1/jobs/validate") and isinstance(case.body, dict):
        gear(case)


def window(query):
    """`from` lies before `to`; every sample and a number of points are not both asked for."""
    if {"from", "to"} <= query.keys() and query["from"] > query["to"]:
        query["from"], query["to"] = query["to"], query["from"]
    if query.get("method") == "none":
        query.pop("max_points", None)


def gear(case):
    """Gears made up of random numbers hardly ever exist: every other document gets one that does, so that there are jobs
    that run, end, and leave results and series for the links to lead to."""
    chance = random.Random(json.dumps(case.body, sort_keys=True))
    linked = case.meta.phase.name.value == "stateful"
    if not linked and chance.random() < 0.5:
        return
    case.body["design"] = EXAMPLE["design"]
    # Few operating points: most jobs then take the result of an earlier one.
    case.body["operation"] = {**EXAMPLE["operation"], "pinion_speed_rpm": chance.choice([500, 2000, 5000])}
    if linked or chance.random() < 0.1:
        # The same key again would refuse all but the first.
        case.headers.pop("Idempotency-Key", None)
        if chance.random() < (0.8 if linked else 0.5):
            for name in ("axes", "continuation", "record"):
                case.body.pop(name, None)
            case.body.update(kind="response", model=EXAMPLE["model"], analysis=EXAMPLE["analysis"])
            case.headers["Prefer"] = "wait=5"


# Generated jobs may take long: the oldest of more than a few that wait or run is canceled.
MOST_LIVE = 6
live = deque()


@schemathesis.hook
def after_call(context, case, response):
    if case.operation.label != "POST /api/v1/jobs" or response.status_code not in (200, 202):
        return
    job = response.json()
    if job["state"] not in ("queued", "running"):
        return
    origin = response.request.url.split("/api/")[0]
    live.append(f"{origin}{job['links']['self']}/cancel")
    while len(live) > MOST_LIVE:
        requests.post(live.popleft(), timeout=20)
