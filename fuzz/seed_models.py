#!/usr/bin/env python3
"""Writes gear models to start fuzzing from: those of the tests, and small ones, of which a mutation is seen sooner.
Standard library only.

    fuzz/seed_models.py CORPUS
"""

import io
import json
import sys
import zipfile
from copy import deepcopy
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from mutate_imports import DATA, calculation

PAIR = DATA / "data" / "herringbone_pair_1_7.rexsj"
CASES = DATA / "data" / "FVA-Industriegetriebe_2stufig_1-4.rexsj"
# A byte of options: without, with a mirrored pair, with a chosen pair and point.
PLAIN, MIRRORED, CHOSEN = b"\x10", b"\x01", b"\x2b"


def without(model, removed):
    """The model without the components that a predicate names, and without what refers to them."""
    model = deepcopy(model)
    gone = {part["id"] for part in model["components"] if removed(part)}
    model["components"] = [part for part in model["components"] if part["id"] not in gone]
    model["relations"] = [
        tie for tie in model["relations"] if not gone.intersection(ref["id"] for ref in tie["refs"])
    ]
    for tie in model["relations"]:
        for ref in tie["refs"]:
            ref.pop("hint", None)
    for part in model["components"]:
        part.pop("name", None)
    for case in model.get("load_spectrum", {}).get("load_cases", []):
        case["components"] = [part for part in case["components"] if part["id"] not in gone]
    return model


def small(model, stage):
    """One stage of a model: teeth, tools, shafts and loads, no modifications and sections."""
    other = {
        ref["id"]
        for tie in model["relations"]
        if tie["type"] in ("stage", "stage_gear_data") and all(ref["id"] != stage for ref in tie["refs"])
        for ref in tie["refs"]
    }
    for tie in model["relations"]:
        if tie["type"] == "flank" and other.intersection(ref["id"] for ref in tie["refs"]):
            other.update(ref["id"] for ref in tie["refs"])
    used = ("gear_unit", "cylindrical_stage", "cylindrical_gear", "cylindrical_gear_flank", "shaft", "external_load",
            "rack_shaped_tool", "cylindrical_stage_gear_data", "material", "gear_casing")
    return without(model, lambda part: part["type"] not in used or part["id"] in other)


def value(attribute):
    """What stands between the tags of an attribute."""
    [(_, content)] = [(key, item) for key, item in attribute.items() if key not in ("id", "unit")]
    if isinstance(content, list):
        return "<array>" + "".join(f"<c>{escape(str(item))}</c>" for item in content) + "</array>"
    return escape(json.dumps(content) if not isinstance(content, str) else content)


def components(parts):
    for part in parts:
        yield f'<component id="{part["id"]}" type={quoteattr(part["type"])}>'
        for attribute in part["attributes"]:
            unit = attribute.get("unit", "none")
            yield f'<attribute id="{attribute["id"]}" unit={quoteattr(unit)}>{value(attribute)}</attribute>'
        yield "</component>"


def xml(model):
    lines = [f'<model version="{model["version"]}" applicationId="a" applicationVersion="1" date="2026-01-01">']
    lines.append("<relations>")
    for tie in model["relations"]:
        order = f' order="{tie["order"]}"' if "order" in tie else ""
        refs = "".join(f'<ref id="{ref["id"]}" role="{ref["role"]}"/>' for ref in tie["refs"])
        lines.append(f'<relation id="{tie["id"]}" type="{tie["type"]}"{order}>{refs}</relation>')
    lines += ["</relations>", "<components>", *components(model["components"]), "</components>"]
    if cases := model.get("load_spectrum", {}).get("load_cases"):
        lines.append('<load_spectrum id="1">')
        for case in cases:
            lines += [f'<load_case id="{case["id"]}">', *components(case["components"]), "</load_case>"]
        lines.append("</load_spectrum>")
    return "\n".join([*lines, "</model>", ""])


def main(corpus):
    def write(target, name, content):
        folder = Path(corpus, target)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)

    pair, cases = (json.loads(path.read_text())["model"] for path in (PAIR, CASES))
    stages = [part["id"] for part in cases["components"] if part["type"] == "cylindrical_stage"]
    models = {
        "pair": without(pair, lambda part: False),
        "pair-bare": without(pair, lambda part: part["type"] in ("tip_relief", "helix_crowning", "shaft_section")),
        "half": small(pair, 60),
        **{f"stage-{stage}": small(cases, stage) for stage in stages},
    }
    for name, model in models.items():
        for suffix, options in (("plain", PLAIN), ("mirrored", MIRRORED), ("chosen", CHOSEN)):
            text = xml(model).encode()
            write("rexs_xml", f"{name}-{suffix}", options + text)
            write("rexs_json", f"{name}-{suffix}", options + json.dumps({"model": model}).encode())
    for path in sorted((DATA / "data").glob("*.rexs*")):
        target = "rexs_json" if path.suffix == ".rexsj" else "rexs_xml"
        write(target, path.name, MIRRORED + path.read_bytes())
    half, half_json = xml(models["half"]).encode(), json.dumps({"model": models["half"]}).encode()
    for name, method in (("stored", zipfile.ZIP_STORED), ("deflated", zipfile.ZIP_DEFLATED)):
        packed = io.BytesIO()
        with zipfile.ZipFile(packed, "w", method) as archive:
            archive.writestr("a/model.rexs", half)
            archive.writestr("picture.png", b"\x89PNG")
        write("rexs_zip", f"raw-{name}", MIRRORED + b"\x00" + packed.getvalue())
    for form in (b"\x01", b"\x02"):
        name = f"built-{form[0]}"
        write("rexs_zip", f"{name}-xml", MIRRORED + form + b"model.rexs\0" + half + b"\0readme.txt\0text\0\x01\x0a\x05")
        write("rexs_zip", f"{name}-json", MIRRORED + form + b"m.rexsj\0" + half_json)
        write("rexs_zip", f"{name}-two", MIRRORED + form + b"m.rexsj\0{}\0b.rexs\0<model/>")
    lines = calculation()
    double = lines + "ZS.PfeilZahn=1¶\r\nZR[0].PfeilNutB=20¶\r\nZR[1].PfeilNutB=18¶\r\n"
    for form in range(4):
        for name, text in (("single", lines), ("double", double)):
            head = "VERSION=20.0;\r\nMODULE=Z012;\r\n" if form == 0 else ""
            content = (head + text).encode("cp1252" if form == 0 else "utf-8")
            write("z12", f"{name}-{form}", MIRRORED + bytes([form]) + content)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
