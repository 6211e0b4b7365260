"""Drake: a chain of revolute joints, the slider's corners small balls between two half spaces.

Minimal coordinates: joints do not drift. (A box would touch a half space in one point only.) Point contact, compliant:
Hunt and Crossley's dissipation fitted to the restitution at the speed of the first impact; at other speeds another
restitution comes out, and no other law can be had. Friction is regularized. Two methods: discrete steps (its "lagged"
approximation, the one with that dissipation), and error control of the continuous system; the contact is the stiffer
the smaller the step or the tolerance, so that the motion can converge.
"""
import math

from pydrake.all import (AddContactMaterial, AddMultibodyPlantSceneGraph, CoulombFriction, DiagramBuilder,
                         DiscreteContactApproximation, FixedOffsetFrame, HalfSpace, ProximityProperties,
                         ResetIntegratorFromFlags, RevoluteJoint, RigidTransform, Simulator, SpatialInertia, Sphere,
                         UnitInertia)

from driver import A, B, DURATION, G, J1, J2, J3, L1, L2, M1, M2, M3, OMEGA1, OMEGA2, WALL, drive, hunt_crossley

RADIUS, MASS = 1e-3, 0.047  # [m], [kg] a corner's share at the first impact


def plant(mu, e, step, omega):
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, step)
    if step > 0:
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kLagged)
    plant.mutable_gravity_field().set_gravity_vector([0, -G, 0])
    material = ProximityProperties()
    # Two equal materials in contact: half the stiffness each, in series; the dissipation of both is that of one.
    AddContactMaterial(hunt_crossley(e), 2 * MASS * omega * omega, CoulombFriction(mu, mu), material)
    for side in (1, -1):
        wall = HalfSpace.MakePose([0, -side, 0], [0, side * WALL, 0])
        plant.RegisterCollisionGeometry(plant.world_body(), wall, HalfSpace(), f"wall{side}", material)
    tip, joints = plant.world_frame(), []
    for name, mass, inertia, centre, length in (("crank", M1, J1, L1 / 2, L1), ("rod", M2, J2, L2 / 2, L2),
                                                ("slider", M3, J3, 0, 0)):
        unit = UnitInertia.TriaxiallySymmetric(inertia / mass).ShiftFromCenterOfMass([-centre, 0, 0])
        slider = plant.AddRigidBody(name, SpatialInertia(mass, [centre, 0, 0], unit))  # the last one is
        joints.append(plant.AddJoint(RevoluteJoint(name, tip, slider.body_frame(), [0, 0, 1])))
        tip = plant.AddFrame(FixedOffsetFrame(f"{name}_tip", slider.body_frame(), RigidTransform([length, 0, 0])))
    for x in (-A, A):
        for y in (-B + RADIUS, B - RADIUS):
            plant.RegisterCollisionGeometry(slider, RigidTransform([x, y, 0]), Sphere(RADIUS), f"corner{x}{y}",
                                            material)
    plant.Finalize()
    if step == 0:
        plant.set_stiction_tolerance(1e-3)
    return builder.Build(), plant, joints


def start(diagram, plant, joints):
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    for joint, rate in zip(joints, (OMEGA1, OMEGA2 - OMEGA1, -OMEGA2)):
        joint.set_angular_rate(context, rate)
    return simulator, lambda: joints[0].get_angle(context)


def discrete(mu, e, step):
    simulator, angle = start(*plant(mu, e, step, 2 * math.pi / (40 * step)))
    simulator.Initialize()

    def run():
        simulator.AdvanceTo(DURATION)
        return angle(), simulator.get_num_steps_taken()
    return run


def continuous(mu, e, tolerance):
    simulator, angle = start(*plant(mu, e, 0, min(1e3 / math.sqrt(tolerance), 1e6)))
    ResetIntegratorFromFlags(simulator, "runge_kutta3", 1e-3)
    simulator.get_mutable_integrator().set_target_accuracy(tolerance)
    simulator.Initialize()

    def run():
        simulator.AdvanceTo(DURATION)
        return angle(), simulator.get_integrator().get_num_steps_taken()
    return run


if __name__ == "__main__":
    drive({"discrete": ("step", discrete), "continuous": ("tolerance", continuous)})
