"""What is solved of each case: the shafts, and the pair with twelve degrees of freedom in three ways."""

from cases import SPEEDS, document
from documents import by_default, swept, translated, with_modification
from service import Refused, solve

# On shafts; on shafts with the proposed helix modification; twelve degrees of freedom with springs and inertias from the shafts; the same
# with the deflection of the shafts as deviation of its flanks; supports left to the program.
MODELS = ("shafts", "evened", "translated", "deflected", "default")


def solved(case, models=MODELS, speeds=SPEEDS, document_of=document):
    """Results of a case by model: the operating point, and the sweep over the speed."""
    on_shafts = document_of(case)
    try:
        point = solve(on_shafts)
    except Refused:
        # Its contact does not depend on the speed; the modes hardly do.
        on_shafts["operation"]["pinion_speed_rpm"] *= 1.01
        point = solve(on_shafts)
    documents = {
        "shafts": on_shafts,
        "evened": with_modification(on_shafts, point, 1),
        "translated": translated(on_shafts),
        "deflected": with_modification(translated(on_shafts), point, -1),
        "default": by_default(on_shafts),
    }
    found = {"case": case, "document": on_shafts, "moved": on_shafts["operation"] != document_of(case)["operation"]}
    for model in models:
        try:
            found[model] = {"point": solve(documents[model]), "sweep": solve(swept(documents[model], speeds))["sweep"]["points"]}
        except Refused as refused:
            found[model] = {"refused": str(refused)}
    return found
