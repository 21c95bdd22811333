"""Writes docs/study/shafts.md; see scripts/study-shafts."""

import sys

import cases
import front
import models
import shafts_chapter
import source_chapter
import survival
from page import Page
from service import ROOT


def main():
    one = [models.solved(case) for case in cases.ONE_AT_A_TIME]
    combined = [models.solved(case) for case in cases.combined()]
    turbo = [models.solved(case, speeds=cases.TURBO_SPEEDS, document_of=cases.turbo_document) for case in cases.TURBO]
    answers = source_chapter.Answers(survival.contact_ratios(), survival.torques(), survival.backlash(), survival.face_widths())
    body = Page()
    shafts_chapter.contact(body, one)
    numbers = shafts_chapter.frequency(body, one, combined, turbo)
    stats = shafts_chapter.vibration(body, one, combined, turbo)
    shafts_chapter.draw_speed(body, one[0])
    source_chapter.write(body, answers)
    beginning, end = Page(), Page()
    front.beginning(beginning, one, combined, turbo, numbers, stats, answers)
    front.limits(end, one + combined + turbo)
    pages = (beginning, body, end)
    text = "\n\n".join(page.text().rstrip() for page in pages) + "\n"
    failed = [sentence for page in pages for sentence in page.failed]
    if "--draft" in sys.argv:
        print(text)
    if failed:
        sys.exit("the numbers do not bear out:\n- " + "\n- ".join(failed))
    if "--draft" not in sys.argv:
        (ROOT / "docs/study/shafts.md").write_text(text)
        for name, figure in body.figures.items():
            (ROOT / f"docs/study/{name}.svg").write_text(figure)


main()
