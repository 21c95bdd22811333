#!/usr/bin/env python3
"""Sends damaged gear models to a running service for a while: each is answered with 200 or 422. Standard library only.

    fuzz/mutate_imports.py http://127.0.0.1:8080 [SECONDS] [SEED]
"""

import io
import random
import re
import sys
import time
import urllib.error
import urllib.request
import zipfile
from collections import Counter
from pathlib import Path

DATA = Path(__file__).parents[1] / "crates" / "exchange" / "tests"
NUMBERS = [b"-1e308", b"1e-320", b"0.0", b"NaN", b"1e999", b"-0.0", b"99999999999"]


def calculation():
    """The lines with values of the KISSsoft calculation in the tests of that format."""
    text = (DATA / "exchange" / "z12.rs").read_text()
    pairs = re.findall(r'\("(Z[^"]+)", "([^"]*)"\)', text.split("];")[0])
    return "".join(f"{key}={value}¶\r\n" for key, value in pairs)


def originals():
    files = [path.read_bytes() for path in sorted((DATA / "data").glob("*.rexs*"))]
    lines = "VERSION=20.0;\r\nMODULE=Z012;\r\n" + calculation()
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("model.rexs", files[0])
    return [*files, lines.encode("utf-16"), lines.encode("cp1252"), packed.getvalue()]


def damaged(files):
    content = bytearray(random.choice(files))
    for _ in range(random.randint(1, 8)):
        if not content:
            break
        at = random.randrange(len(content))
        kind = random.randrange(6)
        if kind == 0:
            del content[at:]
        elif kind == 1:
            content[at] = random.randrange(256)
        elif kind == 2:
            del content[at : at + random.randrange(400)]
        elif kind == 3:
            other = random.choice(files)
            start = random.randrange(len(other))
            content[at:at] = other[start : start + random.randrange(500)]
        elif kind == 4:
            content[at:at] = content[at : at + random.randrange(2000)]
        elif found := list(re.finditer(rb"\d+\.\d+", bytes(content[at : at + 3000]))):
            number = random.choice(found)
            content[at + number.start() : at + number.end()] = random.choice(NUMBERS)
    return bytes(content)


def main(url, seconds=60.0, seed=1):
    random.seed(seed)
    files, statuses, slowest = originals(), Counter(), 0.0
    end = time.monotonic() + float(seconds)
    while time.monotonic() < end:
        address = f"{url.rstrip('/')}/api/v1/import?mirror={random.choice(['true', 'false'])}"
        request = urllib.request.Request(
            address, data=damaged(files), headers={"Content-Type": "application/octet-stream"}
        )
        started = time.monotonic()
        try:
            status = urllib.request.urlopen(request, timeout=30).status
        except urllib.error.HTTPError as error:
            status = error.code
        slowest = max(slowest, time.monotonic() - started)
        statuses[status] += 1
    print(f"{statuses.total()} files, answers {dict(statuses)}, the slowest after {slowest:.2f} s")
    return 0 if set(statuses) <= {200, 422} else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
