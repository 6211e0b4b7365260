#!/usr/bin/env python3
"""Piles of spheres and chains of rods: time per contact or link and step, next to the accuracy reached.

Orthant's scenes `spheres` and `spherical_chain`, and the same bodies in MuJoCo and Drake, each with its defaults and
with its stiffest contact. Their contacts are soft, so that the comparison needs both columns: time and overlap. Their
chains have minimal coordinates, so that joints do not drift; the column is then the change of the energy.

    build/peers/python/bin/python experiments/benchmarks/piles/piles.py --orthant build/release
"""
import argparse
import json
import math
import subprocess
import time

import numpy as np

G, STEP, FALL, COUNTED = 9.80665, 1e-3, 0.3, 20
RADIUS, DENSITY, MU = 0.05, 1000.0, 0.3


def pile(count):
    """Radii and positions of core/scenes/spheres.cpp, and the width of its well."""
    i = np.arange(count)
    pattern = lambda ratio: np.mod(ratio * i, 1.0) - 0.5
    side = next(s for s in range(1, count + 1) if (s + 1) ** 3 > count)
    apart = 2.2 * RADIUS
    radius = RADIUS * (1 - 0.1 * (pattern((1 + math.sqrt(5)) / 2) + 0.5))
    shift = 0.15 * RADIUS
    place = np.stack([(i % side + 0.5) * apart + shift * pattern(math.sqrt(2)),
                      (i // side % side + 0.5) * apart + shift * pattern(math.sqrt(3)),
                      (i // (side * side) + 0.5) * apart], axis=1)
    return radius, place, side * apart


def deepest(place, radius, width):
    """The largest overlap of two spheres, or of one with the floor or a wall [m]."""
    gaps = [np.min(place - radius[:, None]), np.min(width - place[:, :2] - radius[:, None])]
    for i in range(len(radius) - 1):
        gaps.append(np.min(np.linalg.norm(place[i + 1:] - place[i], axis=1) - radius[i + 1:] - radius[i]))
    return max(0.0, -min(gaps))


def timed(step, steps):
    """Seconds a step of the last COUNTED steps, in this thread."""
    for _ in range(steps - COUNTED):
        step()
    begin = time.thread_time()
    for _ in range(COUNTED):
        step()
    return (time.thread_time() - begin) / COUNTED


class Orthant:
    settings = {"auto, 1e-8": ["auto", "1e-8"], "psor, 1e-4": ["psor", "1e-4"]}

    def __init__(self, build):
        self.build = build

    def pile(self, count, setting):
        by, tolerance = self.settings[setting]
        table = subprocess.run([f"{self.build}/experiments/pile_scaling", "--dimension", "3", "--steps-only", "--sizes",
                                str(count), "--by", by, "--by-tolerance", tolerance, "--fall", str(FALL), "--step",
                                str(STEP)], check=True, capture_output=True, text=True).stdout
        row = [float(cell) for cell in table.strip().splitlines()[-1].strip("| ").split("|")]
        return row[3] * 1e-6 * row[1], int(row[1]), row[8] * 1e-3

    def chain(self, links, setting):
        if setting != next(iter(self.settings)):
            return None  # there are no contacts to solve
        run = json.loads(subprocess.run([f"{self.build}/orthant", "simulate", "spherical_chain", "--set",
                                         f"links={links}", "--duration", str(0.1), "--step", str(STEP), "--json"],
                                        check=True, capture_output=True, text=True).stdout)
        return run["seconds"] / run["steps"], abs(run["energy_final"] - run["energy_initial"])


class Mujoco:
    settings = {"defaults": "", "stiffest": 'solref="{} 1" solimp="0.9999 0.9999 0.001"'.format(2 * STEP)}

    def pile(self, count, setting):
        import mujoco
        radius, place, width = pile(count)
        contact = f'{self.settings[setting]} friction="{MU} 0 0" condim="3"'
        planes = [("0 0 0", "0 0 1"), ("0 0 0", "1 0 0"), (f"{width} 0 0", "-1 0 0"), ("0 0 0", "0 1 0"),
                  (f"0 {width} 0", "0 -1 0")]
        geoms = "".join(f'<geom type="plane" size="50 50 1" pos="{p}" zaxis="{z}" {contact}/>' for p, z in planes)
        bodies = "".join(f'<body pos="{p[0]} {p[1]} {p[2]}"><freejoint/><geom type="sphere" size="{r}" '
                         f'density="{DENSITY}" {contact}/></body>' for r, p in zip(radius, place))
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{STEP}" gravity="0 0 {-G}" cone="elliptic"/><size memory="2G"/>'
            f'<worldbody>{geoms}{bodies}</worldbody></mujoco>')
        data = mujoco.MjData(model)
        seconds = timed(lambda: mujoco.mj_step(model, data), round(FALL / STEP))
        return seconds, data.ncon, deepest(data.qpos.reshape(count, 7)[:, :3], radius, width)

    def chain(self, links, setting):
        import mujoco
        if setting != "defaults":
            return None
        along, across, nested = RADIUS**2 / 2, 1 / 12 + RADIUS**2 / 4, ""
        for i in reversed(range(links)):
            nested = (f'<body pos="{0 if i == 0 else 1} 0 0"><joint type="ball"/><inertial pos="0.5 0 0" mass="1" '
                      f'diaginertia="{along} {across} {across}"/>{nested}</body>')
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{STEP}" gravity="0 0 {-G}" integrator="implicitfast"><flag energy="enable"/>'
            f'</option><worldbody>{nested}</worldbody></mujoco>')
        data = mujoco.MjData(model)
        data.qvel[3 * links - 1] = 1
        mujoco.mj_forward(model, data)
        start = data.energy.sum()
        seconds = timed(lambda: mujoco.mj_step(model, data), 100)
        mujoco.mj_forward(model, data)
        return seconds, abs(data.energy.sum() - start)


class Drake:
    settings = {"defaults": None, "stiffest": 1e8}  # N/m of a contact

    def pile(self, count, setting):
        from pydrake.all import (AddContactMaterial, AddMultibodyPlantSceneGraph, CoulombFriction, DiagramBuilder,
                                 HalfSpace, ProximityProperties, RigidTransform, Simulator, SpatialInertia, Sphere)
        radius, place, width = pile(count)
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, STEP)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -G])
        material = ProximityProperties()
        stiffness = self.settings[setting]
        if stiffness is None:
            AddContactMaterial(friction=CoulombFriction(MU, MU), properties=material)
        else:
            AddContactMaterial(dissipation=None, point_stiffness=stiffness, friction=CoulombFriction(MU, MU),
                               properties=material)
        for n, p in (([0, 0, 1], [0, 0, 0]), ([1, 0, 0], [0, 0, 0]), ([-1, 0, 0], [width, 0, 0]),
                     ([0, 1, 0], [0, 0, 0]), ([0, -1, 0], [0, width, 0])):
            plant.RegisterCollisionGeometry(plant.world_body(), HalfSpace.MakePose(n, p), HalfSpace(), f"plane{n}",
                                            material)
        bodies = []
        for i, r in enumerate(radius):
            bodies.append(plant.AddRigidBody(f"sphere{i}", SpatialInertia.SolidSphereWithDensity(DENSITY, r)))
            plant.RegisterCollisionGeometry(bodies[-1], RigidTransform(), Sphere(r), f"sphere{i}", material)
        plant.Finalize()
        diagram = builder.Build()
        simulator = Simulator(diagram)
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        for body, p in zip(bodies, place):
            plant.SetFreeBodyPose(context, body, RigidTransform(p))
        steps = round(FALL / STEP)
        simulator.AdvanceTo((steps - COUNTED) * STEP)
        begin = time.thread_time()
        simulator.AdvanceTo(FALL)
        seconds = (time.thread_time() - begin) / COUNTED
        results = plant.get_contact_results_output_port().Eval(context)
        at = np.array([plant.EvalBodyPoseInWorld(context, body).translation() for body in bodies])
        return seconds, results.num_point_pair_contacts(), deepest(at, radius, width)

    def chain(self, links, setting):
        from pydrake.all import (BallRpyJoint, FixedOffsetFrame, MultibodyPlant, RigidTransform, Simulator,
                                 SpatialInertia, UnitInertia)
        if setting != "defaults":
            return None
        plant = MultibodyPlant(STEP)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -G])
        tip, joint = plant.world_frame(), None
        across = 1 / 12 + RADIUS**2 / 4
        unit = UnitInertia(RADIUS**2 / 2, across, across).ShiftFromCenterOfMass([-0.5, 0, 0])
        inertia = SpatialInertia(1, [0.5, 0, 0], unit)
        for i in range(links):
            rod = plant.AddRigidBody(f"rod{i}", inertia)
            joint = plant.AddJoint(BallRpyJoint(f"joint{i}", tip, rod.body_frame()))
            tip = plant.AddFrame(FixedOffsetFrame(f"tip{i}", rod.body_frame(), RigidTransform([1, 0, 0])))
        plant.Finalize()
        simulator = Simulator(plant)
        context = simulator.get_mutable_context()
        joint.set_angular_velocity(context, [0, 0, 1])
        energy = lambda: plant.CalcPotentialEnergy(context) + plant.CalcKineticEnergy(context)
        start = energy()
        simulator.AdvanceTo((100 - COUNTED) * STEP)
        begin = time.thread_time()
        simulator.AdvanceTo(100 * STEP)
        return (time.thread_time() - begin) / COUNTED, abs(energy() - start)


def reason(error):
    return (str(error).splitlines() or [type(error).__name__])[0][:80]


def cases(arguments, programs):
    return [(size, name, setting) for size in arguments.sizes for name in arguments.programs
            for setting in programs[name].settings]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--orthant", default="build/release", help="folder of Orthant's programs")
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 100, 1000])
    parser.add_argument("--programs", nargs="+", default=["orthant", "mujoco", "drake"],
                        choices=["orthant", "mujoco", "drake"])
    arguments = parser.parse_args()
    programs = {"orthant": Orthant(arguments.orthant), "mujoco": Mujoco(), "drake": Drake()}
    print("| spheres | program | setting | contacts | µs a contact, step | overlap / radius |")
    print("|---|---|---|---|---|---|")
    for count, name, setting in cases(arguments, programs):
        try:
            seconds, contacts, overlap = programs[name].pile(count, setting)
            cells = [contacts, f"{1e6 * seconds / contacts if contacts else math.nan:.3g}", f"{overlap / RADIUS:.2g}"]
        except Exception as error:  # a rival that fails is a row of the table
            cells = ["–", reason(error), "–"]
        print("|", " | ".join(map(str, [count, name, setting, *cells])), "|", flush=True)
    print("\n| links | program | µs a link, step | change of energy in 0.1 s, J |\n|---|---|---|---|")
    for links, name, setting in cases(arguments, programs):
        try:
            result = programs[name].chain(links, setting)
            if result is None:
                continue
            cells = [f"{1e6 * result[0] / links:.3g}", f"{result[1]:.2g}"]
        except Exception as error:
            cells = [reason(error), "–"]
        print("|", " | ".join(map(str, [links, name, *cells])), "|", flush=True)


if __name__ == "__main__":
    main()
