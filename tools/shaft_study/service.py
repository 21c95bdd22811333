"""Runs documents with the program on the command line, and keeps the results."""

import functools
import hashlib
import json
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("HERRINGBONE", str(ROOT / "target/release/herringbone"))
KEPT = ROOT / "target/shaft-study"


class Refused(Exception):
    """A document that is refused or cannot be solved."""


@functools.cache
def solver_version():
    """The version of the program's calculation."""
    example = str(ROOT / "examples/given_stiffness.json")
    return json.loads(subprocess.run([PROGRAM, "solve", example], capture_output=True, text=True, check=True).stdout)["numerics"]["solver_version"]


def solve(document):
    """The result of a document; kept under a hash of the document and of the calculation's version."""
    version = solver_version()
    text = json.dumps(document, sort_keys=True)
    name = hashlib.sha256((version + text).encode()).hexdigest()[:24]
    path = KEPT / f"{name}.json"
    if path.exists():
        kept = json.loads(path.read_text())
        if "refused" in kept:
            raise Refused(kept["refused"])
        return kept
    KEPT.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    run = subprocess.run([PROGRAM, "solve", "-"], input=text, capture_output=True, text=True)
    if run.returncode != 0:
        path.write_text(json.dumps({"refused": (run.stderr or run.stdout)[-2000:]}))
        return solve(document)
    result = slim(json.loads(run.stdout))
    result["seconds"] = time.monotonic() - began
    print(f"{document.get('name', '')}: {result['seconds']:.1f} s", file=sys.stderr, flush=True)
    path.write_text(json.dumps(result))
    return result


def slim(result):
    """Without what the study does not read: shapes along shafts."""
    rotor = (result.get("response") or {}).get("rotor") or {}
    for mode in rotor.get("modes", []):
        mode.pop("along", None)
    return result


def at(value, pointer):
    """The value at a JSON pointer, or None."""
    for name in pointer.strip("/").split("/"):
        if value is None:
            return None
        value = value[int(name)] if isinstance(value, list) else value.get(name)
    return value
