"""Whole searches and tolerance studies with the program: worked examples and acceptance. See scripts/optimise-study."""

import sys
from pathlib import Path

sys.path.insert(1, str(Path(__file__).parent.parent / "shaft_study"))

import acceptance  # noqa: E402
import examples  # noqa: E402

CASES = {"relief": examples.relief, "shafts": examples.shafts, "scatter": examples.scatter, "grid": acceptance.grid,
         "grid-crowning": acceptance.grid_crowning, "promise": acceptance.promise, "promise-shafts": acceptance.promise_shafts, "cliff": acceptance.cliff,
         "coverage": acceptance.coverage, "time": acceptance.time}

for name in sys.argv[1:] or CASES:
    if name not in CASES:
        raise SystemExit(f"{name} is none of {', '.join(CASES)}")
    print(f"{name}: {CASES[name].__doc__}", flush=True)
    CASES[name]()
