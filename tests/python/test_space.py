"""Scenes in space: built here, by name and from text; runs, joint coordinates, files, pictures, other processes."""

import copy
import math
import pickle
import xml.etree.ElementTree as ET

import matplotlib.figure
import numpy as np
import orthant
import pytest
from orthant._solids import SolidSketch


def ball(**law):
    scene = orthant.Scene(dimension=3, gravity=[0, 0, -9.81], duration=0.5, step=1e-3)
    scene.add("body", name="ball", mass=2, inertia=0.008, position=[0, 0, 0.1], velocity=[3, 4, 0])
    scene.add("contact", type="sphere-wall", name="floor", body="ball", radius=0.1, wall={"normal": [0, 0, 1]}, **law)
    return scene


def turn_of(run, row, body):
    w, a, b, c = (run[f"{body}.q{part}"][row] for part in "wxyz")
    return np.array([[1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)],
                     [2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)],
                     [2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)]])


def test_a_scene_built_here_slides_by_coulombs_law():
    run = orthant.simulate(ball(mu=0.2))
    assert run.solved and run.columns[:8] == [
        "t", "ball.x", "ball.y", "ball.z", "ball.qw", "ball.qx", "ball.qy", "ball.qz"
    ]
    assert run.columns[14:18] == ["floor.gap", "floor.impulse_n", "floor.impulse_t1", "floor.impulse_t2"]
    # Sliding: the deceleration is µ g along the velocity, the spin grows by µ m g r / J.
    speed = np.hypot(run["ball.vx"], run["ball.vy"])
    assert np.max(np.abs(speed - (5 - 0.2 * 9.81 * run.t))) < 1e-9
    spin = 0.2 * 2 * 9.81 * 0.1 / 0.008 * run.t
    assert np.max(np.abs(run["ball.wx"] + 0.8 * spin)) < 1e-8 and np.max(np.abs(run["ball.wy"] - 0.6 * spin)) < 1e-8
    friction = np.hypot(run["floor.impulse_t1"], run["floor.impulse_t2"])
    assert np.allclose(friction[1:], 0.2 * run["floor.impulse_n"][1:], rtol=1e-9)
    assert ball().dimension == 3 and orthant.Scene.named("bouncing_ball").dimension == 2
    assert list(run.events) == [] and run.warnings == []


def test_event_driven_locates_the_instant_from_which_the_ball_rolls():
    run = orthant.simulate(ball(mu=0.2), integrator="event-driven", step=0.25, duration=1)
    assert run.solved and list(run.events["kind"]) == ["stick"] and run.events["contact"][0] == "floor"
    assert abs(run.events["t"][0] - 2 * 5 / (7 * 0.2 * 9.81)) < 1e-10
    assert abs(np.hypot(run["ball.vx"][-1], run["ball.vy"][-1]) - 5 * 5 / 7) < 1e-10


def test_a_built_in_scene_its_joint_coordinates_and_the_planar_motion():
    space = orthant.simulate("slider_crank_space", duration=0.06, step=1e-5, every=100)
    plane = orthant.simulate("slider_crank", duration=0.06, step=1e-5, every=100)
    turn = space["shaft.angle"]
    assert len(turn) == len(space) and turn[-1] - turn[0] > math.pi  # followed past the wrap
    assert np.max(np.abs(turn - plane["crank.theta"])) < 1e-9
    assert np.max(np.abs(space["rod.x"] - plane["rod.x"])) < 1e-9
    assert space.final["shaft.angle"] == turn[-1] and space.final["rod.x"] == space["rod.x"][-1]
    assert set(plane.final) == set(plane.columns)
    assert space.summary["status"] == "solved" and space.summary["max_joint_residual"] < 1e-9
    sleeve = orthant.simulate("flyball", duration=0.01)
    assert abs(sleeve.final["sleeve.displacement"] - 0.5) < 0.1
    with pytest.raises(KeyError, match="shaft.turn: must be one of t, .*, shaft.angle"):
        space["shaft.turn"]


def test_scenes_from_text_with_overrides_and_other_processes(tmp_path):
    text = ball(mu=0.2).toml()
    (tmp_path / "ball.toml").write_text(text)
    here = orthant.simulate(ball(mu=0.2)).table
    for scene in (orthant.Scene.parse(text), orthant.Scene.load(tmp_path / "ball.toml"), ball(mu=0.2),
                  orthant.Scene.parse(ball().toml(), **{"contact.floor.mu": 0.2})):
        again = pickle.loads(pickle.dumps(scene))
        assert again.dimension == 3 and np.array_equal(orthant.simulate(again).table, here)
    run = orthant.simulate("slider_crank_space", duration=0.01)
    for copied in (copy.deepcopy(run), pickle.loads(pickle.dumps(run))):
        assert np.array_equal(copied.table, run.table) and copied.final == run.final
        copied.write(tmp_path / "run.csv")
    frame = run.to_pandas()
    assert list(frame.columns) == run.columns[1:] and frame.index[-1] == run.t[-1]


def test_trajectories_as_files(tmp_path):
    run = orthant.simulate(ball(mu=0.2), duration=0.01)
    run.write(tmp_path / "run.csv")
    lines = (tmp_path / "run.csv").read_text().splitlines()
    assert lines[0].split(",") == run.columns and [float(x) for x in lines[-1].split(",")] == run.table[-1].tolist()
    run.write(tmp_path / "run.h5")
    assert b"ball.qw" in (tmp_path / "run.h5").read_bytes()
    run.write(tmp_path / "run.pvd")
    moments = ET.parse(tmp_path / "run.pvd").getroot().findall("Collection/DataSet")
    assert [float(m.get("timestep")) for m in moments] == run.t.tolist()
    piece = ET.parse(tmp_path / moments[-1].get("file")).getroot().find("UnstructuredGrid/Piece")

    def numbers(name):
        return np.array(piece.find(f".//DataArray[@Name='{name}']").text.split(), dtype=float)
    points, bodies = numbers("position").reshape(-1, 3), numbers("body").astype(int)
    corners, ends = numbers("connectivity").astype(int), numbers("offsets").astype(int)
    assert len(points) == int(piece.get("NumberOfPoints")) and set(bodies) == {0, -1} and ends[-1] == len(corners)
    centre = [run[f"ball.{part}"][-1] for part in "xyz"]
    first = sum(bodies == 0)
    sphere = np.unique(corners[:ends[first - 1]])
    assert np.allclose(np.linalg.norm(points[sphere] - centre, axis=1), 0.1, rtol=0, atol=1e-12)
    assert np.allclose(points[np.unique(corners[ends[first - 1]:])][:, 2], 0, atol=1e-12)  # the floor
    velocity, omega = numbers("velocity").reshape(-1, 3), numbers("omega").reshape(-1, 3)
    assert np.array_equal(velocity[0], [run[f"ball.v{part}"][-1] for part in "xyz"])
    assert np.array_equal(omega[0], [run[f"ball.w{part}"][-1] for part in "xyz"])
    assert not velocity[first:].any() and not omega[first:].any()


@pytest.mark.parametrize("name", ["slider_crank_space", "top", "masse"])
def test_drawings(name, tmp_path):
    scene = orthant.Scene.named(name)
    axes = scene.draw(file=tmp_path / "scene.png")
    assert axes.name == "3d" and (tmp_path / "scene.png").stat().st_size > 5000
    run = orthant.simulate(scene, duration=0.02)
    figure = matplotlib.figure.Figure()
    own = figure.add_subplot(projection="3d")
    assert run.draw(axes=own) is own
    faces = own.collections[0]
    # A point of each body lies where the last row has its centre, in the middle of the drawing's range at least.
    low, high = np.array([own.get_xlim(), own.get_ylim(), own.get_zlim()]).T
    for body in scene.bodies:
        centre = np.array([run[f"{body}.{part}"][-1] for part in "xyz"])
        assert np.all(low < centre) and np.all(centre < high)
    assert len(faces.get_facecolor()) >= 6
    assert "<svg" in scene._repr_html_()


def test_a_box_is_drawn_where_its_pose_is():
    scene = orthant.Scene(dimension=3, duration=1, step=0.01)
    scene.add("body", name="box", mass=1, inertia=[1, 1, 1], position=[1, 2, 3], omega=[1, 2, 3])
    scene.add("contact", type="box-wall", name="floor", body="box", size=[0.2, 0.4, 0.6],
              wall={"point": [0, 0, -9], "normal": [0, 0, 1]})
    run = orthant.simulate(scene)
    sketch = SolidSketch(run._scene, ["red"])
    [(body, plane, own, faces, kind)] = [solid for solid in sketch.solids if not solid[1]]
    assert (body, kind, len(faces)) == (0, "polytope", 6)
    corners = sketch.place(run._poses(len(run) - 1), body, own)
    turn, centre = turn_of(run, -1, "box"), [run[f"box.{part}"][-1] for part in "xyz"]
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    for corner in centre + (signs * [0.1, 0.2, 0.3]) @ turn.T:
        assert np.min(np.linalg.norm(corners - corner, axis=1)) < 1e-8


def test_films_and_plots(tmp_path):
    run = orthant.simulate("top", duration=0.05)
    run.film(tmp_path / "frames", fps=40)
    assert len(list((tmp_path / "frames").glob("*.png"))) >= 2
    axes = orthant.simulate("slider_crank_space", duration=0.01).plot("shaft.angle")
    assert axes.get_ylabel() == "[rad]"


def test_check_claims_no_more_digits_than_agree():
    check = orthant.simulate(ball(), check=True).summary["check"]
    assert all(0 <= digits <= 12 for digits in check["digits"].values())
    assert all(error >= 0 for error in check["error"].values())


def test_elements_of_planar_scenes_alone_are_refused_in_space():
    scene = ball()
    scene.add("contact", type="custom", bodies=["ball", "ground"], gap=lambda a, b: 1.0, rows=lambda a, b: [0] * 6)
    with pytest.raises(ValueError, match="must be in a planar scene"):
        orthant.simulate(scene)
    orthant.register_integrator("planar-only", lambda step: (step.q, step.v))
    with pytest.raises(ValueError, match="planar-only: takes planar scenes only: must be one of .*, event-driven"):
        orthant.simulate(ball(), integrator="planar-only")
    with pytest.raises(ValueError, match="override body.ball.mass=-2: body .ball.: mass = -2: must be > 0"):
        orthant.simulate(orthant.Scene.parse(ball().toml(), **{"body.ball.mass": -2}))
    names = [entry.name for entry in orthant.scenes()]
    assert "slider_crank_space" in names and "bricard" in names
    assert orthant.simulate(ball(), solver="auto", duration=0.01).solved
