"""Files of the service as the programs read them for which they are: the numbers are those of the JSON, to the bit."""

import io
import json
import os
import wave
from pathlib import Path

import numpy
import openpyxl
import pandas
import pytest
import scipy.io
from herringbone import Herringbone, Job, Problem

EXAMPLES = Path(__file__).parents[2] / "examples"
# Since 3.1 pandas reads every number exactly.
OLD = tuple(int(part) for part in pandas.__version__.split(".")[:2]) < (3, 1)
EXACT = {"float_precision": "round_trip"} if OLD else {}


@pytest.fixture(scope="module")
def hb():
    with Herringbone(os.environ.get("HERRINGBONE_URL", "http://127.0.0.1:8080")) as service:
        yield service


def run(hb: Herringbone, document: dict) -> Job:
    job = hb.submit(document)
    job.wait(timeout=300)
    return job


@pytest.fixture(scope="module")
def response(hb):
    return run(hb, json.loads((EXAMPLES / "given_stiffness.json").read_text()))


@pytest.fixture(scope="module")
def mesh(hb):
    document = json.loads((EXAMPLES / "table1.json").read_text())
    document["kind"] = "mesh"
    return run(hb, document)


@pytest.fixture(scope="module")
def sweep(hb):
    document = json.loads((EXAMPLES / "given_stiffness.json").read_text())
    document["kind"] = "sweep"
    document["axes"] = [
        {"pointer": "/operation/pinion_speed_rpm", "values": [1000.1, 1234.5678901234567, 2000.0]},
        {"pointer": "/operation/pinion_torque_nm", "values": [10.1, 400.3]},
    ]
    return run(hb, document)


def get(job: Job, path: str, **parameters) -> bytes:
    return job._get(path, params=parameters).content


def same(a, b) -> bool:
    a, b = (numpy.asarray(values, dtype=float).ravel() for values in (a, b))
    return a.size == b.size and a.tobytes() == b.tobytes()


def rows(job: Job) -> list[dict]:
    return json.loads(get(job, "/points"))["items"]


def columns(job: Job) -> dict[str, list]:
    return json.loads(get(job, "/points/columns"))["columns"]


def test_series_in_numpy_and_scipy(response):
    names = [channel["name"] for channel in response.channels()]
    npz = numpy.load(io.BytesIO(get(response, "/series", format="npz")))
    mat = scipy.io.loadmat(io.BytesIO(get(response, "/series", format="mat")))
    assert list(npz["channels"]) == names and [name.strip() for name in mat["channels"]] == names
    assert [unit.strip() for unit in mat["units"]] == list(npz["units"])
    for name in names:
        exact = json.loads(get(response, f"/series/{name}", method="none"))
        assert same(npz[name], exact["y"]) and same(mat[name], exact["y"]), name
        assert same(npz["t_s"], exact["t"]) and same(mat["t_s"], exact["t"])
    assert npz["dt_s"] == mat["dt_s"][0, 0]


def numbers_of(columns: dict[str, list]) -> dict[str, list]:
    """The columns of numbers, not a number where there is none."""
    of_numbers = {
        name: values for name, values in columns.items() if not any(isinstance(value, str) for value in values)
    }
    return {name: [numpy.nan if value is None else value for value in values] for name, values in of_numbers.items()}


def test_points_in_numpy_and_scipy(sweep):
    expected = numbers_of(columns(sweep))
    npz = numpy.load(io.BytesIO(get(sweep, "/points", format="npz")))
    mat = scipy.io.loadmat(io.BytesIO(get(sweep, "/points", format="mat")))
    speeds = [row["point"]["values"][0] for row in rows(sweep)]
    assert same(npz["operation_pinion_speed_rpm"], speeds) and same(mat["operation_pinion_speed_rpm"], speeds)
    assert len(expected) > 20
    for name, values in expected.items():
        if name in ("error", "contact", "regime"):
            continue
        assert numpy.array_equal(npz[name], values, equal_nan=True), name
        assert numpy.array_equal(mat[name].ravel(), values, equal_nan=True), name
    regimes = columns(sweep)["regime"]
    assert list(npz["regime"]) == regimes and [word.strip() for word in mat["regime"]] == regimes


def test_points_in_pandas_with_either_decimal_sign(sweep):
    point = pandas.read_csv(io.BytesIO(get(sweep, "/points", decimal="point")), **EXACT)
    comma = get(sweep, "/points", decimal="comma")
    assert comma.startswith(b"\xef\xbb\xbf") and b"\r\n" in comma
    comma = pandas.read_csv(io.BytesIO(comma), sep=";", decimal=",", encoding="utf-8-sig", **EXACT)
    speeds = [row["point"]["values"][0] for row in rows(sweep)]
    for table in (point, comma):
        assert same(table["/operation/pinion_speed_rpm"], speeds)
        name = "mesh_circumferential_acceleration_rms_left_m_s2"
        assert same(table[name], columns(sweep)[name])


def parquet(job: Job, path: str, **parameters) -> bytes:
    """A Parquet file; skips the test where the service was built without that form, unless it is to be tested."""
    if "TEST_PARQUET" not in os.environ:
        pytest.importorskip("pyarrow")
        try:
            get(job, path, format="parquet")
        except Problem as problem:
            if problem.status == 406 and "Parquet" in problem.detail:
                pytest.skip(problem.detail)
            raise
    return get(job, path, format="parquet", **parameters)


def test_points_as_parquet_in_pandas_and_pyarrow(sweep):
    content = parquet(sweep, "/points")
    table = pandas.read_parquet(io.BytesIO(content))
    assert same(table["/operation/pinion_speed_rpm"], [row["point"]["values"][0] for row in rows(sweep)])
    assert list(table["position"]) == [row["position"] for row in rows(sweep)] and table["position"].dtype == "int64"
    exact = columns(sweep)
    assert len(exact) > 20
    for name, values in exact.items():
        if any(isinstance(value, str) for value in values):
            assert [None if pandas.isna(word) else word for word in table[name]] == values, name
        else:
            numbers = [numpy.nan if value is None else value for value in values]
            assert numpy.array_equal(table[name].astype(float), numbers, equal_nan=True), name
    schema = pyarrow_parquet().read_schema(io.BytesIO(content))
    assert json.loads(schema.metadata[b"units"])["/operation/pinion_speed_rpm"] == "r/min"
    assert schema.metadata[b"job_id"].decode() == sweep.id and schema.metadata[b"solver_version"]
    assert json.loads(schema.metadata[b"input"])["kind"] == "sweep"


def test_series_as_parquet_in_pandas_and_pyarrow(response):
    names = [channel["name"] for channel in response.channels()]
    content = parquet(response, "/series")
    table = pandas.read_parquet(io.BytesIO(content))
    assert list(table.columns) == ["t_s", *names]
    for name in names:
        exact = json.loads(get(response, f"/series/{name}", method="none"))
        assert same(table[name], exact["y"]) and same(table["t_s"], exact["t"]), name
    metadata = pyarrow_parquet().read_schema(io.BytesIO(content)).metadata
    assert json.loads(metadata[b"units"])["a_x_left"] == "m/s2" and float(metadata[b"dt_s"]) > 0


def pyarrow_parquet():
    import pyarrow.parquet

    return pyarrow.parquet


def test_workbooks_in_openpyxl_and_pandas(sweep, response):
    content = get(sweep, "/points", format="xlsx")
    book = openpyxl.load_workbook(io.BytesIO(content))
    assert book.sheetnames == ["points", "input", "units"]
    table = pandas.read_excel(io.BytesIO(content), sheet_name="points")
    assert same(table["/operation/pinion_speed_rpm"], [row["point"]["values"][0] for row in rows(sweep)])
    name = "mesh_circumferential_acceleration_rms_left_m_s2"
    assert same(table[name], columns(sweep)[name])
    units = {row[0]: row[1] for row in book["units"].iter_rows(min_row=2, values_only=True)}
    assert units[name] == "m/s2" and units["/operation/pinion_speed_rpm"] == "r/min"
    inputs = {row[0]: row[1] for row in book["input"].iter_rows(min_row=2, values_only=True)}
    assert inputs["/design/pinion/teeth"] == 17

    book = openpyxl.load_workbook(io.BytesIO(get(response, "/result", format="xlsx")))
    values = {row[4]: row[1] for row in book["result"].iter_rows(min_row=2, values_only=True)}
    result = response.result()
    assert values["/response/dynamic_factor"] == result["response"]["dynamic_factor"]
    left = result["response"]["rms"]["mesh_circumferential_acceleration_m_s2"]["left"]
    assert values["/response/rms/mesh_circumferential_acceleration_m_s2/left"] == left


def test_the_sound_in_the_wave_module(response):
    with wave.open(io.BytesIO(get(response, "/series/a_x_left.wav", seconds=1.5, rate_hz=44100))) as sound:
        assert (sound.getframerate(), sound.getnframes(), sound.getsampwidth()) == (44100, 66150, 2)
        samples = numpy.frombuffer(sound.readframes(66150), dtype="<i2").astype(float)
    # The strongest line is a multiple of what the record repeats.
    record = response.series("a_x_left")
    spectrum = numpy.abs(numpy.fft.rfft(samples * numpy.hanning(samples.size)))
    strongest_hz = spectrum.argmax() / 1.5
    period_s = record.y.size * (record.t[1] - record.t[0])
    order = strongest_hz * period_s
    assert abs(order - round(order)) < 0.02 * max(1, period_s / 1.5 * 50), order


def test_tables_of_the_mesh(mesh):
    exact = {table["name"]: table for table in json.loads(get(mesh, "/tables"))["tables"]}
    curve = mesh.result()["mesh"]["curve"]
    assert numpy.allclose(exact["stiffness"]["values"][:-1], numpy.array(curve["stiffness_n_per_um"]) * 1e6, rtol=1e-15)
    mat = scipy.io.loadmat(io.BytesIO(get(mesh, "/tables", format="simulink")))
    lines = get(mesh, "/tables", format="modelica").decode().splitlines()
    assert lines[0] == "#1"
    for name, table in exact.items():
        assert same(mat[name], table["values"]) and same(mat[f"{name}_angle_rad"], table["pinion_angle_rad"])
        start = lines.index(f"double {name}({len(table['values'])},2)")
        read = numpy.loadtxt(lines[start + 1 : start + 1 + len(table["values"])])
        assert same(read[:, 0], table["pinion_angle_rad"]) and same(read[:, 1], table["values"])
        pairs = numpy.loadtxt(io.BytesIO(get(mesh, "/tables", format="simpack", quantity=name)))
        assert same(pairs[:, 1], table["values"])
    assert exact["stiffness"]["values"][0] == exact["stiffness"]["values"][-1]
