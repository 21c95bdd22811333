"""Tests of the client against a running service (HERRINGBONE_URL) and against answers made here."""

import json
import os
from pathlib import Path

import httpx
import numpy
import pytest

import herringbone
from herringbone import Herringbone, JobFailed, Problem

EXAMPLES = Path(__file__).parents[3] / "examples"
URL = os.environ.get("HERRINGBONE_URL", "http://127.0.0.1:8080")


@pytest.fixture()
def hb():
    with Herringbone(URL, token=os.environ.get("HERRINGBONE_TOKEN")) as service:
        yield service


def example(name: str) -> dict:
    return json.loads((EXAMPLES / f"{name}.json").read_text())


def small_sweep(points: int = 4) -> dict:
    document = example("given_stiffness")
    document["kind"] = "sweep"
    document["axes"] = [{"pointer": "/operation/pinion_speed_rpm", "from": 1000, "to": 2500, "points": points}]
    return document


def test_a_job_from_document_to_series(hb):
    job = hb.submit(example("given_stiffness"))
    result = job.wait(timeout=120)
    assert job.state == "succeeded" and result["response"]["rms"]
    full = hb.request("GET", f"/jobs/{job.id}/series/a_x_left", params={"method": "none"}).json()
    series = job.series("a_x_left")
    assert series.unit == "m/s2"
    assert numpy.array_equal(series.y, numpy.array(full["y"])) and numpy.array_equal(series.t, numpy.array(full["t"]))
    assert {channel["name"] for channel in job.channels()} >= {"a_x_left", "s_left"}
    part = job.series("s_left", start=float(series.t[10]), end=float(series.t[20]))
    assert part.y.size == 11
    assert job.input()["design"]["pinion"]["teeth"] == example("given_stiffness")["design"]["pinion"]["teeth"]
    assert job.sound(seconds=0.5)[:4] == b"RIFF"
    assert b"<model" in job.rexs()


def test_a_violation_comes_with_its_pointer(hb):
    document = example("given_stiffness")
    document["design"]["normal_module_mm"] = -1
    with pytest.raises(Problem) as caught:
        hb.submit(document)
    assert caught.value.status == 422 and caught.value.code == "invalid-design"
    assert "/design/normal_module_mm" in [error["pointer"] for error in caught.value.errors]
    assert "/design/normal_module_mm" in str(caught.value)


def test_the_same_document_with_a_key_is_one_job(hb):
    key = os.urandom(8).hex()
    first = hb.submit(example("given_stiffness"), idempotency_key=key)
    assert hb.submit(example("given_stiffness"), idempotency_key=key).id == first.id
    assert hb.submit(example("given_stiffness")).id != first.id
    assert hb.job(first.id).id == first.id
    assert first.id in [job.id for job, _ in zip(hb.jobs(), range(50))]


def test_rows_of_a_sweep_are_a_table_with_the_numbers_of_the_json(hb):
    job = hb.submit(small_sweep())
    points = job.wait(timeout=120)["sweep"]["points"]
    table = job.points()
    assert list(table["/operation/pinion_speed_rpm"]) == [point["values"][0] for point in points]
    name = "mesh_circumferential_acceleration_rms_left_m_s2"
    assert list(table[name]) == [point["mesh_circumferential_acceleration_rms_m_s2"]["left"] for point in points]
    assert job.result(rows=False)["sweep"]["points"] == []


def test_many_documents_keep_their_order_and_their_problems(hb):
    documents = []
    for speed in (1000, 1200, -1, 1400):
        document = example("given_stiffness")
        document["operation"]["pinion_speed_rpm"] = speed
        documents.append(document)
    outcomes = list(hb.run_many(documents, limit=2))
    assert [isinstance(outcome, Problem) for outcome in outcomes] == [False, False, True, False]
    frequencies = [outcome["geometry"]["mesh_frequency_hz"] for outcome in outcomes if isinstance(outcome, dict)]
    assert frequencies == sorted(frequencies) and len(set(frequencies)) == 3


def test_a_canceled_job_is_told_as_such(hb):
    document = small_sweep(2000)
    document["operation"]["pinion_torque_nm"] = 700 + int.from_bytes(os.urandom(2)) / 1000
    job = hb.submit(document)
    job.cancel()
    with pytest.raises(JobFailed):
        job.wait(timeout=60)
    assert job.state == "canceled"


def test_an_unreadable_model_is_a_problem(hb):
    with pytest.raises(Problem) as caught:
        hb.import_rexs(b"<nothing/>")
    assert caught.value.status == 422


def service(answers: list) -> tuple[Herringbone, list]:
    """A service that gives these answers, and the requests it got."""
    requests: list[httpx.Request] = []

    def answer(request: httpx.Request) -> httpx.Response:
        requests.append(request)
        given = answers[min(len(requests), len(answers)) - 1]
        if isinstance(given, Exception):
            raise given
        return given

    return Herringbone("http://test", transport=httpx.MockTransport(answer)), requests


@pytest.fixture()
def pauses(monkeypatch):
    told: list[float] = []
    monkeypatch.setattr(herringbone.time, "sleep", told.append)
    return told


def test_a_full_service_is_asked_again_when_it_says(pauses):
    full = httpx.Response(503, headers={"Retry-After": "7"}, json={"code": "queue-full"})
    hb, requests = service([full, full, httpx.Response(202, json={"id": "1", "state": "queued"})])
    assert hb.submit({}).id == "1"
    assert (len(requests), pauses) == (3, [7.0, 7.0])


def test_a_restart_is_waited_for(pauses):
    running, done = ({"id": "1", "state": state} for state in ("running", "succeeded"))
    gone = httpx.ConnectError("refused")
    broken = httpx.RemoteProtocolError("closed")
    hb, requests = service(
        [httpx.Response(200, json=running), broken, gone, gone, httpx.Response(200, json=done), httpx.Response(200, json={})]
    )
    assert hb.job("1").wait() == {}
    assert [request.headers.get("Prefer") for request in requests[1:5]] == ["wait=30"] * 4


def test_a_submission_that_may_have_arrived_is_not_repeated_without_a_key(pauses):
    hb, requests = service([httpx.ReadError("closed")])
    with pytest.raises(httpx.ReadError):
        hb.submit({})
    assert len(requests) == 1
    with pytest.raises(httpx.ReadError):
        hb.submit({}, idempotency_key="k")
    assert len(requests) > 2


def test_nothing_is_asked_more_often_than_the_service_holds_back(pauses):
    running, done = ({"id": "1", "state": state} for state in ("running", "succeeded"))
    hb, _ = service([httpx.Response(200, json=running)] * 4 + [httpx.Response(200, json=done)])
    assert hb.job("1").wait()["state"] == "succeeded"
    assert pauses == [5.0] * 3


def test_a_timeout_is_told(pauses):
    hb, _ = service([httpx.Response(200, json={"id": "1", "state": "running"})])
    with pytest.raises(TimeoutError):
        hb.job("1").wait(timeout=0)
