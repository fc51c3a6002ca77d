"""What a user of the package relies on."""

from __future__ import annotations

import dataclasses
import os
import resource
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import sagnac


@pytest.fixture(scope="module")
def white() -> npt.NDArray[np.float64]:
    """White noise with N = 0.01 deg/sqrt(h) at 1 Hz."""
    return np.random.default_rng(7).normal(scale=0.6, size=200_000)


def test_terms_have_named_fields_and_intervals(white: npt.NDArray[np.float64]) -> None:
    noise = sagnac.identify(white, tau0=1.0)
    n = noise["angle_random_walk"]
    assert n.unit == "deg/sqrt(h)" and n.level == 0.95 and n.interval is not None
    low, high = n.interval
    assert low < 0.01 < high and n.value is not None and low < n.value < high
    b = noise["bias_instability"]
    assert b.value is None and b.upper_limit is not None and b.upper_limit.level == 0.95
    assert [t.id for t in noise.terms][0] == "angle_random_walk" and len(noise) > 20
    with pytest.raises(dataclasses.FrozenInstanceError):
        n.value = 0.0  # type: ignore[misc]


def test_a_unit_scales_the_terms(white: npt.NDArray[np.float64]) -> None:
    in_deg_s = sagnac.identify(white / 3600.0, tau0=1.0, unit="deg/s")["angle_random_walk"].value
    in_deg_h = sagnac.identify(white, tau0=1.0)["angle_random_walk"].value
    assert in_deg_s is not None and in_deg_h is not None
    assert in_deg_s == pytest.approx(in_deg_h, rel=1e-9)
    with pytest.raises(sagnac.ArgumentError, match="unit"):
        sagnac.identify(white, tau0=1.0, unit="kg")


def test_deviations_are_those_of_allantools(white: npt.NDArray[np.float64]) -> None:
    allantools = pytest.importorskip("allantools")
    taus = [1.0, 2.0, 10.0, 64.0, 500.0, 2_000.0]
    names = ["oadev", "mdev", "hdev", "totdev"]
    found = sagnac.allan(white, 1.0, taus=taus, deviations=names)
    # totdev of allantools is not corrected for its bias.
    for name, function in [("oadev", "oadev"), ("mdev", "mdev"), ("hdev", "ohdev")]:
        _, expected, _, _ = getattr(allantools, function)(white, rate=1.0, data_type="freq", taus=taus)
        np.testing.assert_allclose(found[name].deviation, expected, rtol=1e-9)
    assert [c.estimator for c in found] == names and len(found["totdev"]) == len(taus)


def test_intervals_of_white_noise_hold_the_truth() -> None:
    rng = np.random.default_rng(11)
    hits = np.zeros(9)
    for _ in range(400):
        curve = sagnac.allan(rng.normal(size=4096), 1.0)["oadev"]
        truth = 1.0 / np.sqrt(curve.tau_s[:9])
        hits += (curve.low[:9] <= truth) & (truth <= curve.high[:9])
    # 95 % of 400 is 380 ± 4.4: five standard deviations.
    assert np.all(hits > 358) and np.all(hits < 402), hits


@pytest.mark.parametrize("kind", ["float64", "float32", "int32", "big", "strided", "list", "arrow"])
def test_every_kind_of_array_is_read(kind: str) -> None:
    base = np.random.default_rng(3).integers(-1000, 1000, size=20_000).astype(np.float64)
    expected = sagnac.allan(base, 0.5)
    given: object
    if kind == "arrow":
        pyarrow = pytest.importorskip("pyarrow")
        given = pyarrow.chunked_array([base[:7_000], base[7_000:7_001], base[7_001:]])
    elif kind == "big":
        given = base.astype(">f8")
    elif kind == "strided":
        given = np.column_stack([base, base + 1.0])[:, 0]
    elif kind == "list":
        given = base.tolist()
    else:
        given = base.astype(kind)
    found = sagnac.allan(given, 0.5)  # type: ignore[arg-type]
    np.testing.assert_array_equal(found.deviation, expected.deviation)
    np.testing.assert_array_equal(found.tau_s, 0.5 * 2.0 ** np.arange(len(found.tau_s)))


@pytest.mark.parametrize("library", ["pandas", "polars", "pyarrow"])
def test_a_frame_gives_what_its_file_gives(library: str, samples: Path) -> None:
    module = pytest.importorskip(library)
    path = samples / "unit-indeterminate.csv"
    if library == "pandas":
        table = module.read_csv(path, comment="#")
    elif library == "polars":
        table = module.read_csv(path, comment_prefix="#")
    else:
        csv = pytest.importorskip("pyarrow.csv")
        # A comment stands above the header.
        table = csv.read_csv(path, read_options=csv.ReadOptions(skip_rows=1))
    of_file, of_frame = sagnac.analyze(path), sagnac.analyze(table)
    assert [m.value for m in of_frame] == [m.value for m in of_file]
    assert [m.interval for m in of_frame] == [m.interval for m in of_file]


def test_missing_values_and_stamps_of_a_frame(white: npt.NDArray[np.float64]) -> None:
    polars = pytest.importorskip("polars")
    start = np.datetime64("2026-03-01T00:00:00", "us")
    stamps = start + np.arange(50_000) * np.timedelta64(1_000_000, "us")
    values = white[:50_000].copy()
    values[100] = np.nan
    frame = polars.DataFrame({"time": stamps, "rate_deg_h": values, "who": ["a"] * 50_000})
    result = sagnac.analyze(frame)
    assert result.faults["non_finite"] == 1
    n = result["angle_random_walk"]
    assert n.interval is not None and n.interval[0] < 0.01 < n.interval[1]
    assert result.to_dict()["recording"][0]["sample_interval_s"] == pytest.approx(1.0, abs=1e-9)


def test_results_go_into_frames_files_and_notebooks(samples: Path, tmp_path: Path) -> None:
    result = sagnac.analyze(samples / "unit-indeterminate.csv")
    for library in ("pandas", "polars"):
        pytest.importorskip(library)
        assert len(result.to_frame(library)) == len(result)
    page = result._repr_html_()
    assert "<svg" in page and "angle_random_walk" in page
    result.write(tmp_path / "out", lang="ru")
    assert "<svg" in (tmp_path / "out" / "report.html").read_text()
    again = sagnac.read(tmp_path / "out")
    assert isinstance(again, sagnac.RunResult)
    assert again.to_dict()["measurands"] == result.to_dict()["measurands"]
    assert {f.id for f in result.figures()} >= {"sigma_tau", "time_series"}
    with pytest.raises(sagnac.ArgumentError, match="form"):
        result.write(tmp_path / "other", forms=["odt"])


def test_a_simulation_is_explained(samples: Path) -> None:
    made = sagnac.simulate(samples / "model-step.toml", seed=7)
    assert np.array_equal(made.rate_deg_h, sagnac.simulate(samples / "model-step.toml", seed=7)["rate_deg_h"])
    found = sagnac.explain(made.to_dict(), samples / "model-static.toml")
    assert found.verdict == "mismatch" and found.effects[0].kind == "bias_step"
    assert found.time_s is not None and found.correction_deg_h is not None
    assert len(found.time_s) == len(found.correction_deg_h) > 1000
    assert "bias_step" in found.augmented and "<svg" in found._repr_html_()


def test_units_are_compared_and_promised(samples: Path, tmp_path: Path) -> None:
    result = sagnac.analyze(samples / "unit-indeterminate.csv")
    compared = sagnac.compare(result, samples / "unit-pass.csv")
    assert len(compared.units) == 2 and "unit-pass" in {u["name"] for u in compared.units}
    lot = sorted((samples / "lot").glob("*/result.json"))
    sheet = sagnac.datasheet(lot)
    assert sheet.units == len(lot) and sheet["angle_random_walk"].bounds
    read = [sagnac.read(path) for path in lot]
    in_memory = sagnac.datasheet([r for r in read if isinstance(r, sagnac.RunResult)])
    assert [q.bounds for q in in_memory.quantities] == [q.bounds for q in sheet.quantities]


def test_what_a_recording_holds(samples: Path) -> None:
    found = sagnac.inspect(samples / "unit-faults.csv")
    assert any(c.role == "rate" and c.unit == "deg/h" for c in found.columns)
    assert "rate" in str(found) and "<pre>" in found._repr_html_()


def test_errors_tell_where_the_mistake_is(tmp_path: Path, samples: Path, procedures: Path) -> None:
    wrong = tmp_path / "procedure.toml"
    text = (procedures / "static-bias.toml").read_text()
    wrong.write_text(text.replace('"angle_random_walk"', '"angle_random_wlak"'))
    expected = next(i for i, line in enumerate(wrong.read_text().splitlines(), 1) if "wlak" in line)
    with pytest.raises(sagnac.ConfigurationError) as caught:
        sagnac.run(wrong, samples / "unit-pass.csv")
    error = caught.value
    assert isinstance(error, ValueError) and error.file == str(wrong)
    assert error.line == expected and error.column is not None and str(wrong) in str(error)
    with pytest.raises(sagnac.RecordingError) as missing:
        sagnac.analyze(tmp_path / "none.csv")
    assert missing.value.file == str(tmp_path / "none.csv")
    with pytest.raises(sagnac.ArgumentError):
        sagnac.analyze({"x": np.zeros(100)})
    with pytest.raises(sagnac.ArgumentError):
        sagnac.allan(np.zeros((3, 3)), 1.0)
    with pytest.raises(sagnac.ArgumentError, match="no multiple|multiple"):
        sagnac.allan(np.arange(100.0), 1.0, taus=[1.5])
    with pytest.raises(sagnac.ArgumentError):
        sagnac.allan(np.full(10, np.nan), 1.0)
    with pytest.raises(sagnac.ArgumentError):
        sagnac.allan(["a", "b"], 1.0)  # type: ignore[list-item]


def test_progress_is_told_and_other_threads_run() -> None:
    rate = np.random.default_rng(5).normal(size=2_000_000)
    told: list[float] = []
    counted = 0
    stop = threading.Event()

    def count() -> None:
        nonlocal counted
        while not stop.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        sagnac.identify(rate, 1.0, progress=lambda doing, share: told.append(share))
    finally:
        stop.set()
        thread.join()
    assert told and told == sorted(told) and told[-1] == 1.0
    assert counted > 20


def test_an_error_in_the_function_of_the_user_comes_back(white: npt.NDArray[np.float64]) -> None:
    def refuse(doing: str, share: float) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        sagnac.allan(white, 1.0, progress=refuse)


def test_ctrl_c_stops_within_a_second() -> None:
    work = """
        import numpy as np, sagnac
        rate = np.random.default_rng(1).normal(size=30_000_000)
        print("ready", flush=True)
        while True:
            sagnac.allan(rate, 0.01, taus="decade", exact=True)
    """
    child = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(work)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert child.stdout is not None and child.stdout.readline() == "ready\n"
    time.sleep(1.0)
    child.send_signal(signal.SIGINT)
    begun = time.monotonic()
    _, errors = child.communicate(timeout=30)
    assert "KeyboardInterrupt" in errors
    assert time.monotonic() - begun < 3.0, "the interpreter itself needs a part of this to end"


def test_no_copy_of_the_samples_is_made() -> None:
    work = """
        import numpy as np, resource, sagnac
        rate = np.random.default_rng(1).normal(size=20_000_000)
        sagnac.allan(rate[:1000], 1.0)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        sagnac.allan(rate, 1.0)
        print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(work)], capture_output=True, text=True, check=True
    )
    more_mib = float(done.stdout)
    # The samples are 153 MiB.
    assert more_mib < 75, f"{more_mib} MiB"
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss > 0


def test_documents_are_objects(samples: Path, procedures: Path, tmp_path: Path) -> None:
    model = sagnac.Model.read(samples / "model-static.toml")
    model.tables["noise"]["N_deg_rt_h"] = 0.02
    changed = sagnac.simulate(model, seed=3, duration=600.0)
    plain = sagnac.simulate(samples / "model-static.toml", seed=3, duration=600.0)
    assert changed.rate_deg_h.std() > 3.0 * plain.rate_deg_h.std()
    model.write(tmp_path / "model.toml")
    written = sagnac.simulate(tmp_path / "model.toml", seed=3, duration=600.0)
    assert np.array_equal(written.rate_deg_h, changed.rate_deg_h)
    assert sagnac.Model.parse(model.to_toml()).tables == model.tables
    # The seed of the program, where nobody states one.
    unstated = sagnac.simulate(model, duration=600.0)
    assert unstated.seed == sagnac.simulate(model, seed=unstated.seed, duration=600.0).seed
    with pytest.raises(sagnac.ConfigurationError, match="N_deg_rt_hour") as refused:
        sagnac.simulate({"recording": {"sample_rate_hz": 1.0}, "noise": {"N_deg_rt_hour": 0.1}})
    assert refused.value.file == "in memory" and refused.value.line is not None
    limits = sagnac.Limits.read(procedures / "limits" / "sample-unit.toml")
    for limit in limits.tables["limit"]:
        if limit["measurand"] == "angle_random_walk":
            limit["max"] = "0.001 deg/sqrt(h)"
    judged = sagnac.run(
        procedures / "static-bias.toml", samples / "unit-pass.csv", limits=limits, serial="SN-0001"
    )
    assert judged["angle_random_walk"].verdict == "fail" and judged.verdict == "fail"
    with pytest.raises(sagnac.ArgumentError):
        sagnac.Limits.parse("limit = [")


def test_pandas_needs_no_pyarrow(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_csv(samples / "unit-indeterminate.csv", comment="#")
    frame["who"] = "operator"
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "pyarrow", None)
        found = sagnac.analyze(frame)
        noise = sagnac.identify(frame["rate_deg_h"], 1.0)
    expected = sagnac.analyze(samples / "unit-indeterminate.csv")
    assert found["angle_random_walk"].value == expected["angle_random_walk"].value
    assert noise["angle_random_walk"].value is not None


def test_results_are_drawn_on_axes(samples: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    result = sagnac.analyze(samples / "unit-indeterminate.csv")
    ax = result.plot()
    assert ax.get_xscale() == "log" and len(ax.lines[0].get_xdata()) == len(result.allan())
    assert sagnac.allan(np.arange(100.0) % 7, 1.0, deviations=["oadev", "mdev"]).plot(ax=ax) is ax
    assert len(ax.lines) == 3
    made = sagnac.simulate(samples / "model-static.toml", duration=36_000.0)
    course = made.plot().lines[0].get_ydata()
    assert len(course) <= 20_000 and course.max() == made.rate_deg_h.max()
    assert len(sagnac.compare(samples / "unit-pass.csv").plot().get_yticklabels()) == 1


def test_the_program_comes_with_the_package(samples: Path, procedures: Path, tmp_path: Path) -> None:
    told = subprocess.run(
        [sys.executable, "-m", "sagnac", "--version"], capture_output=True, text=True, check=True
    )
    assert told.stdout.split() == ["sagnac", sagnac.__version__]
    arguments = [
        *("run", str(procedures / "static-bias.toml"), str(samples / "unit-pass.csv")),
        *("--limits", str(procedures / "limits" / "sample-unit.toml")),
        *("--serial", "SN-0001", "--out", str(tmp_path / "report")),
    ]
    ran = subprocess.run([sys.executable, "-m", "sagnac", *arguments], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert sagnac.verify(tmp_path / "report")
    assert sagnac.verify(tmp_path / "report", recording=samples / "unit-pass.csv")
    record = tmp_path / "report" / "result.json"
    record.write_text(record.read_text().replace("SN-0001", "SN-0002", 1))
    broken = sagnac.verify(tmp_path / "report")
    assert not broken and any(check.state == "differs" for check in broken.checks)
    with pytest.raises(sagnac.SagnacError, match="without result.json"):
        sagnac.verify(tmp_path / "none")


def test_a_folder_is_watched(samples: Path, procedures: Path, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    recording = tmp_path / "in" / "SN-0001.csv"
    shutil.copy(samples / "unit-pass.csv", recording)
    os.utime(recording, (1e9, 1e9))

    def seen() -> list[tuple[str | None, str]]:
        results = sagnac.watch(
            tmp_path / "in",
            procedure=procedures / "static-bias.toml",
            limits=procedures / "limits" / "sample-unit.toml",
            out=tmp_path / "out",
            once=True,
        )
        return [(result.serial, result.verdict) for result in results]

    assert seen() == [("SN-0001", "pass")]
    assert seen() == []
    with pytest.raises(sagnac.SagnacError):
        next(sagnac.watch(tmp_path / "none", procedure=procedures / "static-bias.toml", out=tmp_path / "other"))


def test_the_next_test_is_planned(samples: Path, tmp_path: Path) -> None:
    made = sagnac.simulate(samples / "model-step.toml", seed=7)
    found = sagnac.explain(made.to_dict(), samples / "model-static.toml")
    found.write(tmp_path / "why")
    planned = sagnac.plan(tmp_path / "why", samples / "model-static.toml", "8h", chamber=False)
    assert planned.outcome in {"decides", "too_short", "undecidable", "nothing_to_decide"}
    assert planned.to_dict()["outcome"] == planned.outcome
    with pytest.raises(sagnac.SagnacError, match="budget"):
        sagnac.plan(tmp_path / "why", samples / "model-static.toml", "8 bananas")
