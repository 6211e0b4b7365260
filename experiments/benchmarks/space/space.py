#!/usr/bin/env python3
"""Work and precision in space: two motions with known ends, by Orthant, MuJoCo and Drake, their settings swept.

masse         a ball slides on a rough table along a parabola, then rolls: the place after 1 s (Coriolis)
slider_crank  the rigid spatial slider-crank of the IFToMM library: the slider after 5 s, published to 11 digits

Writes space.csv, space.md and space.png, space.svg. Times are processor times of the run alone, the best of REPEATS.
The models differ: contacts of MuJoCo and Drake are soft (also with their stiffest settings), Drake's discrete solvers
regularize friction, MuJoCo's closed loop is a soft constraint. With a stiffness that does not grow as the step shrinks
errors level off. A setting that fails is a row that says why.

    build/peers/python/bin/python experiments/benchmarks/space/space.py --orthant build/release --output results/peers
"""
import argparse
import csv
import json
import math
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

REPEATS = 2
RADIUS, MASS, G, MU = 0.028575, 0.17, 9.81, 0.2  # core/scenes/masse.h
V, OMEGA = np.array([1.0, 0, 0]), np.array([-60.0, -100, 40])
SLIDER = 0.24071957373  # [m] x(5 s)
PIN, END = np.array([0, 0.1, 0.2]), np.array([0.2, 0, 0])  # core/scenes/spatial_slider_crank.cpp
AXIS = (END - PIN) / 0.3
SQUARE = np.array([0, 2, -1]) / math.sqrt(5)
TURN = np.array([1.92, -0.96, 0.48])  # [rad/s] of the rod, at 6 rad/s of the crank


def masse_end(duration=1.0):
    """The exact place: friction is constant while the ball slides, and ends with the slip."""
    slip = np.array([V[0] - RADIUS * OMEGA[1], V[1] + RADIUS * OMEGA[0]])
    rolls = 2 * np.linalg.norm(slip) / (7 * MU * G)
    pull = -MU * G * slip / np.linalg.norm(slip)
    sliding = min(duration, rolls)
    return V[:2] * sliding + pull * sliding**2 / 2 + (V[:2] + pull * sliding) * (duration - sliding)


def timed(run):
    """Its result, and the processor time of the fastest call."""
    best = math.inf
    for _ in range(REPEATS):
        begin = time.thread_time()
        result = run()
        best = min(best, time.thread_time() - begin)
    return result, best


class Orthant:
    settings = {"masse": {"moreau-jean": "step", "adaptive": "rtol", "event-driven": "rtol"},
                "slider_crank": {"moreau-jean": "step", "rattle": "step", "adaptive": "rtol"}}

    def __init__(self, build):
        self.build = build

    def simulate(self, scene, method, at, duration):
        stepped = self.settings[scene][method] == "step"
        command = [f"{self.build}/orthant", "simulate", {"slider_crank": "spatial_slider_crank"}.get(scene, scene),
                   "--integrator", method if stepped else f"{method}:rtol={at}", "--duration", str(duration), "--json",
                   "--step", str(at if stepped else duration)]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(command, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode != 0:
            raise RuntimeError(
                done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit code {done.returncode}")
        return json.loads(done.stdout)["final"], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def best(self, scene, method, at, duration):
        tiny = at if self.settings[scene][method] == "step" else 1e-6  # start and end of the program alone
        start = min(self.simulate(scene, method, at, tiny)[1] for _ in range(REPEATS))
        runs = [self.simulate(scene, method, at, duration) for _ in range(REPEATS)]
        return runs[0][0], max(min(seconds for _, seconds in runs) - start, 1e-4)

    def masse(self, method, at):
        final, seconds = self.best("masse", method, at, 1.0)
        return np.array([final["ball.x"], final["ball.y"]]), seconds

    def slider_crank(self, method, at):
        final, seconds = self.best("slider_crank", method, at, 5.0)
        return np.array([final["slider.x"]]), seconds


class Mujoco:
    settings = {scene: {"defaults": "step", "stiff": "step"} for scene in ("masse", "slider_crank")}

    @staticmethod
    def soft(method, h):
        return f'solref="{2 * h} 1" solimp="0.9999 0.9999 0.001"' if method == "stiff" else ""

    @staticmethod
    def run(text, velocity, duration, h, value):
        import mujoco
        mujoco.set_mju_user_warning(lambda text: None)  # it would write a file here; failures are rows
        model = mujoco.MjModel.from_xml_string(text)
        steps = round(duration / h)

        def once():
            data = mujoco.MjData(model)
            data.qvel[:] = velocity
            mujoco.mj_forward(model, data)
            for _ in range(steps):
                mujoco.mj_step(model, data)
            if not np.all(np.isfinite(data.qpos)) or data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
                raise RuntimeError("the motion is unstable")
            return value(data)
        return timed(once)

    def masse(self, method, h):
        contact = f'{self.soft(method, h)} friction="{MU} 0 0" condim="3"'
        inertia = 0.4 * MASS * RADIUS**2
        text = (
            f'<mujoco><option timestep="{h}" gravity="0 0 {-G}" cone="elliptic" iterations="200" tolerance="1e-12"/>'
            f'<worldbody><geom type="plane" size="50 50 1" {contact}/><body pos="0 0 {RADIUS}"><freejoint/>'
            f'<inertial pos="0 0 0" mass="{MASS}" diaginertia="{inertia} {inertia} {inertia}"/>'
            f'<geom type="sphere" size="{RADIUS}" {contact}/></body></worldbody></mujoco>')
        return self.run(text, [*V, *OMEGA], 1.0, h, lambda data: data.qpos[:2].copy())

    def slider_crank(self, method, h):
        # slider, universal joint (x of the slider, y of the rod), rod; the crank by itself; a loop closed at its pin
        third = np.cross(AXIS, SQUARE)
        axis = " ".join(map(repr, (float(x) for x in SQUARE)))
        frame = " ".join(repr(float(x)) for x in (*AXIS, *SQUARE))
        start = (PIN - END) / 2
        rates = np.linalg.lstsq(np.stack([[1, 0, 0], SQUARE], axis=1), TURN, rcond=None)[0]
        assert abs(third @ SQUARE) < 1e-12
        text = (
            f'<mujoco><option timestep="{h}" gravity="0 0 -9.81" integrator="implicitfast" iterations="200" '
            f'tolerance="1e-14"/><worldbody>'
            f'<body name="crank" pos="0 0.1 0.12"><joint type="hinge" axis="1 0 0"/>'
            f'<inertial pos="0 0 0.04" mass="0.12" diaginertia="1e-4 1e-4 1e-5"/></body>'
            f'<body name="slider" pos="0.2 0 0"><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="2" '
            f'diaginertia="1e-4 1e-4 1e-4"/><body name="rod"><joint type="hinge" axis="1 0 0"/>'
            f'<joint type="hinge" axis="{axis}"/><inertial pos="{start[0]} {start[1]} {start[2]}" mass="0.5" '
            f'diaginertia="4e-4 4e-3 4e-3" xyaxes="{frame}"/></body></body></worldbody>'
            f'<equality><connect body1="crank" body2="rod" anchor="0 0 0.08" {self.soft(method, h)}/></equality>'
            '</mujoco>')
        return self.run(text, [6, 0.24, *rates], 5.0, h, lambda data: 0.2 + data.qpos[1:2].copy())


class Drake:
    settings = {"masse": {"discrete, lagged": "step", "discrete, similar": "step", "discrete, sap": "step",
                          "continuous": "accuracy", "CENIC": "accuracy"},
                "slider_crank": {"discrete, sap": "step"}}

    @staticmethod
    def plant(method, at):
        from pydrake.all import AddMultibodyPlantSceneGraph, DiagramBuilder, DiscreteContactApproximation
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, at if method.startswith("discrete") else 0.0)
        if method.startswith("discrete"):
            name = method.split(", ")[1]
            plant.set_discrete_contact_approximation(getattr(DiscreteContactApproximation, "k" + name.capitalize()))
        return builder, plant

    @staticmethod
    def run(builder, plant, method, at, duration, start, value):
        from pydrake.all import ApplySimulatorConfig, Simulator, SimulatorConfig
        diagram = builder.Build()

        def once():
            simulator = Simulator(diagram)
            if not method.startswith("discrete"):
                scheme = "cenic" if method == "CENIC" else "runge_kutta3"
                ApplySimulatorConfig(SimulatorConfig(integration_scheme=scheme, accuracy=at, max_step_size=0.01,
                                                     use_error_control=True), simulator)
            context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
            start(context)
            simulator.Initialize()
            simulator.AdvanceTo(duration)
            return value(context)
        return timed(once)

    def masse(self, method, at):
        from pydrake.all import (AddContactMaterial, CoulombFriction, HalfSpace, ProximityProperties, RigidTransform,
                                 SpatialInertia, SpatialVelocity, Sphere, UnitInertia)
        builder, plant = self.plant(method, at)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -G])
        material = ProximityProperties()
        AddContactMaterial(dissipation=10.0, point_stiffness=1e6, friction=CoulombFriction(MU, MU), properties=material)
        plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "table", material)
        ball = plant.AddRigidBody("ball", SpatialInertia(MASS, [0, 0, 0], UnitInertia.SolidSphere(RADIUS)))
        plant.RegisterCollisionGeometry(ball, RigidTransform(), Sphere(RADIUS), "ball", material)
        if not method.startswith("discrete"):
            plant.set_stiction_tolerance(0.1 * at)  # [m/s] of slip, below which friction is regularized
        plant.Finalize()

        def start(context):
            plant.SetFreeBodyPose(context, ball, RigidTransform([0, 0, RADIUS]))
            plant.SetFreeBodySpatialVelocity(context=context, body=ball, V_JpJc=SpatialVelocity(OMEGA, V))
        return self.run(builder, plant, method, at, 1.0, start,
                        lambda context: plant.EvalBodyPoseInWorld(context, ball).translation()[:2].copy())

    def slider_crank(self, method, at):
        from pydrake.all import (FixedOffsetFrame, PrismaticJoint, RevoluteJoint, RigidTransform, RotationMatrix,
                                 SpatialInertia, UnitInertia)
        builder, plant = self.plant(method, at)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -9.81])

        def inertia(mass, at_centre, moments, R=np.eye(3)):
            J = R @ np.diag(moments) @ R.T / mass
            return SpatialInertia(mass, at_centre, UnitInertia(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2])
                                  .ShiftFromCenterOfMass(-np.asarray(at_centre)))
        crank = plant.AddRigidBody("crank", inertia(0.12, [0, 0, 0.04], [1e-4, 1e-4, 1e-5]))
        slider = plant.AddRigidBody("slider", inertia(2, [0, 0, 0], [1e-4, 1e-4, 1e-4]))
        cross = plant.AddRigidBody("cross", inertia(1e-6, [0, 0, 0], [1e-10, 1e-10, 1e-10]))
        R = np.stack([AXIS, SQUARE, np.cross(AXIS, SQUARE)], axis=1)
        rod = plant.AddRigidBody("rod", inertia(0.5, (PIN - END) / 2, [4e-4, 4e-3, 4e-3], R))
        world = plant.world_frame()
        shaft = plant.AddFrame(FixedOffsetFrame("shaft", world, RigidTransform([0, 0.1, 0.12])))
        rail = plant.AddFrame(FixedOffsetFrame("rail", world, RigidTransform([0.2, 0, 0])))
        turn = plant.AddJoint(RevoluteJoint("shaft", shaft, crank.body_frame(), [1, 0, 0]))
        slide = plant.AddJoint(PrismaticJoint("rail", rail, slider.body_frame(), [1, 0, 0]))
        first = plant.AddJoint(RevoluteJoint("first", slider.body_frame(), cross.body_frame(), [1, 0, 0]))
        second = plant.AddJoint(RevoluteJoint("second", cross.body_frame(), rod.body_frame(), SQUARE))
        plant.AddBallConstraint(crank, np.array([0, 0, 0.08]), rod, PIN - END)
        plant.Finalize()
        rates = np.linalg.lstsq(np.stack([[1, 0, 0], SQUARE], axis=1), TURN, rcond=None)[0]

        def start(context):
            turn.set_angular_rate(context, 6), slide.set_translation_rate(context, 0.24)
            first.set_angular_rate(context, rates[0]), second.set_angular_rate(context, rates[1])
        return self.run(builder, plant, method, at, 5.0, start,
                        lambda context: np.array([0.2 + slide.get_translation(context)]))


SWEEPS = {"step": [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5], "rtol": [1e-3, 1e-5, 1e-7, 1e-9, 1e-11],
          "accuracy": [1e-2, 1e-3, 1e-4, 1e-5, 1e-6]}
COLUMNS = ["scene", "program", "setting", "swept", "at", "seconds", "error", "failure"]


def measure(programs, quick, only):
    truth = {"masse": masse_end(), "slider_crank": np.array([SLIDER])}
    for scene, end in truth.items():
        for name, program in programs.items():
            for setting, swept in program.settings[scene].items():
                for at in SWEEPS[swept][:4 if quick else None]:
                    if only and scene not in only:
                        continue
                    row = dict.fromkeys(
                        COLUMNS, "") | {"scene": scene, "program": name, "setting": setting, "swept": swept, "at": at}
                    try:
                        got, seconds = getattr(program, scene)(setting, at)
                        row |= {"seconds": seconds, "error": float(np.linalg.norm(got - end))}
                        if not math.isfinite(row["error"]):
                            row |= {"error": "", "failure": "the end is not finite"}
                    except Exception as error:  # a rival that fails is a row of the table
                        row["failure"] = (str(error).splitlines() or [type(error).__name__])[0][:100]
                    yield row


def table(rows):
    """Least time to an error, of the values from which on all finer ones reach it; failures in words."""
    goals = (1e-2, 1e-3, 1e-4, 1e-6, 1e-9)
    lines = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        lines += [f"\n`{scene}`: milliseconds to an error of the end [m]\n", "| program | setting | least error | " +
                  " | ".join(f"to {g:g}" for g in goals) + " | failed |", "|---" * (len(goals) + 4) + "|"]
        own = [row for row in rows if row["scene"] == scene]
        for key in dict.fromkeys((row["program"], row["setting"]) for row in own):
            runs = [row for row in own if (row["program"], row["setting"]) == key]
            good = [row for row in runs if row["error"] != ""]
            cells = []
            for goal in goals:
                reached = []
                for row in sorted(runs, key=lambda row: row["at"]):  # the finest first
                    if row["error"] == "" or row["error"] > goal:
                        break
                    reached.append(row["seconds"])
                cells.append(f"{1e3 * min(reached):.3g}" if reached else "–")
            failed = sorted({row["failure"] for row in runs if row["failure"]})
            least = f"{min(row['error'] for row in good):.1e}" if good else "–"
            lines.append("| " + " | ".join([*key, least, *cells, f"{len(runs) - len(good)}" +
                                           (": " + "; ".join(failed) if failed else "")]) + " |")
    return "\n".join(lines).strip() + "\n"


def draw(rows, folder):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    page, grid = plt.subplots(1, len(scenes), figsize=(5 * len(scenes), 4.6), squeeze=False)
    for axis, scene in zip(grid[0], scenes):
        own = [row for row in rows if row["scene"] == scene and row["error"] != ""]
        for key in dict.fromkeys((row["program"], row["setting"]) for row in own):
            points = sorted(
                (row["seconds"], max(row["error"], 1e-16)) for row in own if (row["program"], row["setting"]) == key)
            axis.loglog(*np.array(points).T, {"orthant": "o-", "mujoco": "s--", "drake": "^:"}[key[0]], ms=4,
                        label=", ".join(key))
        axis.set(title=scene, xlabel="processor time [s]", ylabel="error of the end [m]")
        axis.legend(fontsize=6)
    page.tight_layout()
    page.savefig(folder / "space.png", dpi=150)
    page.savefig(folder / "space.svg", metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--orthant", default="build/release", help="folder of Orthant's programs")
    parser.add_argument("--output", type=Path, default=Path("results/peers"))
    parser.add_argument("--quick", action="store_true", help="the four coarsest values of each setting")
    parser.add_argument("--programs", nargs="+", default=["orthant", "mujoco", "drake"],
                        choices=["orthant", "mujoco", "drake"])
    parser.add_argument("--scenes", nargs="+", choices=["masse", "slider_crank"])
    arguments = parser.parse_args()
    made = {"orthant": lambda: Orthant(arguments.orthant), "mujoco": Mujoco, "drake": Drake}
    arguments.output.mkdir(parents=True, exist_ok=True)
    rows = []
    with open(arguments.output / "space.csv", "w", newline="") as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        for row in measure({name: made[name]() for name in arguments.programs}, arguments.quick, arguments.scenes):
            rows.append(row)
            out.writerow(row), file.flush()
    (arguments.output / "space.md").write_text(table(rows))
    sys.stdout.write(table(rows))
    draw(rows, arguments.output)


if __name__ == "__main__":
    main()
