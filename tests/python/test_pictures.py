"""Pages, plots, drawings and films of runs: they show the run's own numbers."""

import html
import importlib.util
import json
import re
import shutil
import struct

import numpy as np
import orthant
import pytest


@pytest.fixture(scope="module")
def run():
    return orthant.simulate("slider_crank", integrator="adaptive", step=1e-4)


def data_of(page):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)[1])


def test_a_view_holds_the_run(run, tmp_path):
    file = run.view(tmp_path / "run.html")
    assert file == str(tmp_path / "run.html")
    page = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert len(page) < 2_000_000
    data = data_of(page)
    assert data["columns"] == run.columns and data["rows"] == len(run)
    assert data["values"]["t"][0] == run.t[0] and data["values"]["t"][-1] == pytest.approx(run.t[-1], rel=1e-11)
    np.testing.assert_allclose(data["values"]["crank.theta"][-1], run["crank.theta"][-1], rtol=1e-6)
    for column in ("corner1.impulse_n", "corner4.impulse_t"):  # no impulse is lost between frames
        np.testing.assert_allclose(sum(data["values"][column]), run[column].sum(), rtol=1e-5)
    assert data["event_count"] == len(run.events)
    assert data["events"][0][1:3] == [run.events["kind"][0], run.events["contact"][0]]
    assert [body["name"] for body in data["scene"]["bodies"]] == ["crank", "rod", "slider"]


def test_a_notebook_shows_the_page_in_a_frame(run):
    shown = run._repr_html_()
    assert shown.startswith("<iframe srcdoc=")
    assert data_of(html.unescape(re.search(r'srcdoc="(.*?)"', shown, re.S)[1]))["rows"] == len(run)


def test_frames_of_pandas(run):
    pandas = pytest.importorskip("pandas")
    frame = run.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.index.name == "t"
    np.testing.assert_array_equal(frame["rod.x"], run["rod.x"])


def test_plots_draw_columns(run, tmp_path):
    pytest.importorskip("matplotlib")
    axes = run.plot("crank.omega", "slider.x", file=tmp_path / "plot.svg")
    np.testing.assert_array_equal(axes.lines[1].get_ydata(), run["slider.x"])
    assert axes.get_ylabel() == "[rad/s, m]" and axes.get_xlabel() == "t [s]"
    assert (tmp_path / "plot.svg").read_text(encoding="utf-8").rstrip().endswith("</svg>")
    assert run.plot(axes=axes) is axes and axes.lines[-1].get_label() == "energy"
    with pytest.raises(KeyError, match="must be one of t, crank.x"):
        run.plot("crank.z")


def test_a_drawing_has_the_bodies_in_their_pose(run, tmp_path):
    pytest.importorskip("matplotlib")
    crank_pin = {  # where the pin of crank and rod is drawn, against the crank's angle
        "start": (orthant.Scene.named("slider_crank").draw(), run["crank.theta"][0]),
        "end": (run.draw(file=tmp_path / "end.png"), run["crank.theta"][-1]),
    }
    for axes, angle in crank_pin.values():
        pins = [line.get_xydata()[0] for line in axes.lines if line.get_marker() == "o"]
        expected = 0.153 * np.array([np.cos(angle), np.sin(angle)])
        assert min(np.linalg.norm(pin - expected) for pin in pins) < 1e-3
    with open(tmp_path / "end.png", "rb") as stream:
        assert stream.read(8) == b"\x89PNG\r\n\x1a\n"
    assert orthant.Scene.named("slider_crank")._repr_html_().startswith("<svg")


def test_films_have_a_picture_a_frame(run, tmp_path):
    pytest.importorskip("PIL")
    pytest.importorskip("matplotlib")
    run.film(tmp_path / "pictures", speed=0.1, fps=3)
    assert len(list((tmp_path / "pictures").glob("frame_*.png"))) == 7  # 0.2 s / 0.1 * 3, and the first
    run.film(tmp_path / "film.gif", speed=0.1, fps=3)
    content = (tmp_path / "film.gif").read_bytes()
    assert content[:6] == b"GIF89a" and struct.unpack("<H", content[6:8])[0] > 300
    if shutil.which("ffmpeg"):
        run.film(tmp_path / "film.mp4", speed=0.1, fps=3)
        assert (tmp_path / "film.mp4").stat().st_size > 1000
    else:
        with pytest.raises(RuntimeError, match="needs the program ffmpeg"):
            run.film(tmp_path / "film.mp4")
    with pytest.raises(ValueError, match="must end in .mp4 or .gif"):
        run.film(tmp_path / "film.avi")
    with pytest.raises(ValueError, match="speed = 0: must be > 0"):
        run.film(tmp_path / "film.gif", speed=0)


@pytest.mark.parametrize("draw, words", [
    (lambda run: run.draw(0.3), r"t = 0.3: must be in \[0, 0.2\] \[s\]"),
    (lambda run: run.draw(float("nan")), "t = nan: must be finite"),
    (lambda run: run.draw("now"), "t = 'now': must be a number"),
    (lambda run: run.draw(0.1, file="pose.xyz"), r"pose.xyz: must end in one of .*, \.png, .*, \.svg"),
    (lambda run: run.plot("energy", file="energy"), r"energy: must end in one of"),
    (lambda run: run.film("long.gif", speed=1e-9), r"speed = 1e-09: gives 5e\+09 pictures: must be at most 100000"),
    (lambda run: run.film("none.gif", speed=float("nan")), "speed = nan: must be finite"),
])
def test_pictures_refuse_other_times_and_files(run, tmp_path, monkeypatch, draw, words):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    with pytest.raises((TypeError, ValueError), match=words):
        draw(run)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("draw, words", [
    (lambda run: run.plot(), "a picture needs matplotlib: pip install matplotlib"),
    (lambda run: run.film("a.gif"), "a film needs matplotlib: pip install matplotlib"),
    (lambda run: run.to_pandas(), r"to_pandas\(\) needs pandas: pip install pandas"),
])
def test_a_package_that_is_missing_is_named_with_its_remedy(run, monkeypatch, draw, words):
    found = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None
                        if name in ("matplotlib", "pandas") else found(name))
    with pytest.raises(ModuleNotFoundError, match=words):
        draw(run)
