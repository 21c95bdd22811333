"""Client of the herringbone service: double-helical gears under load, their impact and their vibration.

Documents are plain dictionaries: the JSON of the service is the contract, and what is wrong in one comes back with its
pointer (``Problem.errors``). Needs httpx; numpy for series, pandas for tables.

    hb = Herringbone("http://127.0.0.1:8080")
    job = hb.submit(document)
    result = job.wait(timeout=600)
    y = job.series("a_x_left")
"""

from __future__ import annotations

import io
import time
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import httpx

if TYPE_CHECKING:
    import numpy
    import pandas

__all__ = ["Document", "Herringbone", "Job", "JobFailed", "Problem", "Series"]
__version__ = "0.1.0"

Document = dict[str, Any]

# Longest wait of one request: the service answers then, or at the end of the job.
WAIT_S = 30.0
ENDED = frozenset({"succeeded", "failed", "canceled"})
# Pauses before another try when the service does not answer, as while it starts again.
PAUSES_S = (0.5, 1.0, 2.0, 4.0, 8.0, 15.0)


class Problem(Exception):
    """An answer of 400 or above (RFC 9457): ``code``, ``status``, ``detail``, and ``errors`` with pointers."""

    def __init__(self, status: int, body: dict[str, Any]) -> None:
        self.status = status
        self.body = body
        self.code: str = body.get("code", "")
        self.detail: str = body.get("detail", "")
        self.errors: list[dict[str, Any]] = body.get("errors", [])
        told = [f"{error.get('pointer', '')} {error.get('detail', '')}".strip() for error in self.errors]
        super().__init__("\n  ".join([f"{status} {self.code}: {self.detail}", *told]))


class JobFailed(Problem):
    """A job that failed, or was canceled."""


@dataclass(frozen=True)
class Series:
    """A recorded channel in full: times in seconds, values in ``unit``."""

    t: numpy.ndarray
    y: numpy.ndarray
    unit: str


class Herringbone:
    """A service. ``token`` as it was started with; ``timeout`` of a single answer in seconds."""

    def __init__(
        self,
        url: str = "http://127.0.0.1:8080",
        token: str | None = None,
        *,
        timeout: float = 60.0,
        transport: httpx.BaseTransport | None = None,
    ) -> None:
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        limit = httpx.Timeout(timeout, read=max(timeout, WAIT_S + 15.0))
        self._client = httpx.Client(
            base_url=f"{url.rstrip('/')}/api/v1", headers=headers, timeout=limit, transport=transport
        )

    def __enter__(self) -> Herringbone:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections."""
        self._client.close()

    def submit(self, document: Document, *, idempotency_key: str | None = None) -> Job:
        """Submits a job document. The same document with the same key is one job, however often it is sent."""
        headers = {"Idempotency-Key": idempotency_key} if idempotency_key else {}
        # Without a key a request that was lost on its way back would make a second job.
        answer = self.request("POST", "/jobs", json=document, headers=headers, again=idempotency_key is not None)
        return Job(self, answer.json())

    def validate(self, document: Document) -> dict[str, Any]:
        """What the service says of a document without computing it."""
        return self.request("POST", "/jobs/validate", json=document).json()

    def job(self, job_id: str) -> Job:
        """A job by its id."""
        return Job(self, self.request("GET", f"/jobs/{job_id}").json())

    def jobs(self, **filters: Any) -> Iterator[Job]:
        """The jobs, page after page, newest first; ``filters`` are the parameters of ``GET /jobs``."""
        cursor: str | None = None
        while True:
            parameters = filters | ({"cursor": cursor} if cursor else {})
            page = self.request("GET", "/jobs", params=parameters).json()
            yield from (Job(self, item) for item in page["items"])
            cursor = page.get("next_cursor")
            if not cursor:
                return

    def run(self, document: Document, *, timeout: float | None = None, idempotency_key: str | None = None) -> dict[str, Any]:
        """Submits a document and waits for its result."""
        return self.submit(document, idempotency_key=idempotency_key).wait(timeout)

    def run_many(
        self, documents: Iterable[Document], *, limit: int = 20, cancel_on_interrupt: bool = False
    ) -> Iterator[dict[str, Any] | Problem]:
        """Runs documents with ``limit`` of them in flight; yields their results in their order, a problem for each one that
        was refused or failed."""
        waiting = iter(documents)
        flying: deque[Job | Problem] = deque()
        try:
            while True:
                while len(flying) < limit and (document := next(waiting, None)) is not None:
                    try:
                        flying.append(self.submit(document))
                    except Problem as problem:
                        flying.append(problem)
                if not flying:
                    return
                first = flying[0]
                outcome: dict[str, Any] | Problem
                if isinstance(first, Problem):
                    outcome = first
                else:
                    try:
                        outcome = first.wait()
                    except Problem as problem:
                        outcome = problem
                flying.popleft()
                yield outcome
        except KeyboardInterrupt:
            if cancel_on_interrupt:
                for job in flying:
                    if isinstance(job, Job):
                        job.cancel()
            raise

    def import_rexs(
        self,
        file: str | Path | bytes,
        *,
        pair: int | None = None,
        mirror: bool = False,
        gap_mm: float | None = None,
        torque_nm: float | None = None,
        point: int | str | None = None,
    ) -> dict[str, Any]:
        """Makes a job document of a REXS model; the answer has ``document`` and the report. Nothing is submitted."""
        content = file if isinstance(file, bytes) else Path(file).read_bytes()
        given = {"pair": pair, "mirror": mirror or None, "gap_mm": gap_mm, "torque_nm": torque_nm, "point": point}
        parameters = {
            name: str(value).lower() if isinstance(value, bool) else value
            for name, value in given.items()
            if value is not None
        }
        headers = {"Content-Type": "application/octet-stream"}
        return self.request("POST", "/import", params=parameters, content=content, headers=headers).json()

    def request(self, method: str, path: str, *, again: bool = True, **options: Any) -> httpx.Response:
        """Sends a request. A full or starting service is asked again as ``Retry-After`` says, a connection that cannot be made
        after a pause; ``again=False`` leaves out what may have been done already."""
        for attempt in range(len(PAUSES_S) + 1):
            last = attempt == len(PAUSES_S)
            try:
                answer = self._client.request(method, path, **options)
            except (httpx.ConnectError, httpx.ConnectTimeout):
                if last:
                    raise
                time.sleep(PAUSES_S[attempt])
                continue
            except (httpx.ReadError, httpx.RemoteProtocolError):
                if last or not again:
                    raise
                time.sleep(PAUSES_S[attempt])
                continue
            if answer.status_code == 503 and not last:
                time.sleep(_retry_after(answer, PAUSES_S[attempt]))
                continue
            if answer.is_error:
                raise Problem(answer.status_code, _body(answer))
            return answer
        raise AssertionError("the last attempt answers or raises")


class Job:
    """A job of a service. ``record`` is what the service last said of it."""

    def __init__(self, service: Herringbone, record: dict[str, Any]) -> None:
        self._service = service
        self.record = record
        self.id: str = record["id"]

    def __repr__(self) -> str:
        return f"Job({self.id}, {self.state})"

    @property
    def state(self) -> str:
        """``queued``, ``running``, ``succeeded``, ``failed`` or ``canceled``, as of the last answer."""
        return self.record["state"]

    def refresh(self) -> Job:
        """Asks for the job's state."""
        self.record = self._get("").json()
        return self

    def wait(self, timeout: float | None = None) -> dict[str, Any]:
        """Waits for the end and returns the result. The service holds each request back for up to 30 s; nothing is asked more
        often. Goes on after a restart of the service. Raises ``JobFailed``, or ``TimeoutError`` after ``timeout`` seconds."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while self.state not in ENDED:
            left = WAIT_S if deadline is None else min(WAIT_S, deadline - time.monotonic())
            if left <= 0:
                raise TimeoutError(f"job {self.id} is {self.state} after {timeout} s")
            started = time.monotonic()
            self.record = self._get("", headers={"Prefer": f"wait={max(1, round(left))}"}).json()
            early = left - (time.monotonic() - started)
            if self.state not in ENDED and early > 1.0:
                # The service did not hold the request back: it is closing, or has no place for one who waits.
                time.sleep(min(early, 5.0))
        if self.state != "succeeded":
            error = self.record.get("error") or {"code": self.state, "detail": f"job {self.id} is {self.state}"}
            raise JobFailed(error.get("status", 409), error)
        return self.result()

    def result(self, *, rows: bool = True) -> dict[str, Any]:
        """The result; without ``rows``, ``sweep.points`` is empty."""
        return self._get("/result", params={} if rows else {"rows": "false"}).json()

    def input(self) -> Document:
        """The document with every default."""
        return self._get("/input").json()

    def cancel(self) -> Job:
        """Cancels the job."""
        self.record = self._service.request("POST", f"/jobs/{self.id}/cancel").json()
        return self

    def delete(self) -> None:
        """Deletes the job, which has ended."""
        self._service.request("DELETE", f"/jobs/{self.id}")

    def channels(self) -> list[dict[str, Any]]:
        """The recorded channels with their units."""
        return self._get("/series").json()["items"]

    def series(self, channel: str, *, start: float | None = None, end: float | None = None) -> Series:
        """A recorded channel with every sample between two times."""
        arrays = self.arrays(channel, start=start, end=end)
        return Series(arrays["t_s"], arrays[str(arrays["channels"][0])], str(arrays["units"][0]))

    def arrays(self, *channels: str, start: float | None = None, end: float | None = None) -> dict[str, numpy.ndarray]:
        """Recorded channels with every sample, all when none are named; with ``t_s``, ``channels`` and ``units``."""
        import numpy

        parameters: dict[str, Any] = {"format": "npz"}
        if channels:
            parameters["channels"] = ",".join(channels)
        if start is not None:
            parameters["from"] = start
        if end is not None:
            parameters["to"] = end
        with numpy.load(io.BytesIO(self._get("/series", params=parameters).content)) as arrays:
            return {name: arrays[name] for name in arrays.files}

    def points(self) -> pandas.DataFrame:
        """The rows of a sweep, as far as they are solved, with the columns of its CSV."""
        import pandas

        text = self._get("/points", headers={"Accept": "text/csv"}).text
        # Since 3.1 every number is read exactly.
        old = tuple(int(part) for part in pandas.__version__.split(".")[:2]) < (3, 1)
        return pandas.read_csv(io.StringIO(text), **({"float_precision": "round_trip"} if old else {}))

    def rexs(self, *, form: str = "xml") -> bytes:
        """The pair as a REXS model, ``xml`` or ``json``."""
        return self._get("/rexs", params={"format": form}).content

    def tables(self, form: str = "json", quantity: str = "stiffness") -> bytes:
        """The look-up tables of the mesh: ``json``, ``modelica``, ``simulink``, ``amesim`` or ``simpack``."""
        return self._get("/tables", params={"format": form, "quantity": quantity}).content

    def sound(self, channel: str = "a_x_left", *, seconds: float = 5.0, full_scale: float | None = None) -> bytes:
        """An acceleration as a WAV file, its record repeated."""
        parameters: dict[str, Any] = {"seconds": seconds}
        if full_scale is not None:
            parameters["full_scale"] = full_scale
        return self._get(f"/series/{channel}.wav", params=parameters).content

    def _get(self, path: str, **options: Any) -> httpx.Response:
        return self._service.request("GET", f"/jobs/{self.id}{path}", **options)


def _retry_after(answer: httpx.Response, otherwise: float) -> float:
    try:
        return min(float(answer.headers.get("Retry-After", otherwise)), 60.0)
    except ValueError:
        return otherwise


def _body(answer: httpx.Response) -> dict[str, Any]:
    try:
        body = answer.json()
    except ValueError:
        body = None
    return body if isinstance(body, dict) else {"detail": answer.text[:500]}
