"""Drake: free bodies or joint angles, point contact.

Contact is a stiff spring; its discrete solvers convexify friction ("lagged" less so), as does CENIC, its integrator
with error control; its continuous plant regularizes friction below a slip of a tenth of the accuracy. For the ball that
bounces the spring is stiffer as the step or the accuracy shrinks; its damper is fitted to the restitution: with "sap"
a linear one, for every speed; else Hunt and Crossley's, at the speed of the first impact only. The loop's
constraint is the same for all discrete solvers; the continuous plant and CENIC refuse it.
"""
import math

import numpy as np
from pydrake.all import (AddContactMaterial, AddMultibodyPlantSceneGraph, ApplySimulatorConfig, CoulombFriction,
                         DiagramBuilder, DiscreteContactApproximation, FixedOffsetFrame, HalfSpace, PrismaticJoint,
                         ProximityProperties, RevoluteJoint, RigidTransform, Simulator, SimulatorConfig,
                         SpatialInertia, SpatialVelocity, Sphere, UnitInertia)

from motions import (AXIS, DROP, DURATION, END, FIRST_IMPACT, G, MASS, MU, OMEGA, PIN, RADIUS, SQUARE, TURN, V,
                     damping_ratio, hunt_crossley, stiff_rate, timed)

BALL = {"discrete, lagged": "step", "discrete, similar": "step", "discrete, sap": "step", "continuous": "accuracy",
        "CENIC": "accuracy"}


class Drake:
    settings = {"masse": BALL, "slider_crank": {"discrete, sap": "step", "continuous": "accuracy", "CENIC": "accuracy"},
                "bounces": BALL}

    @staticmethod
    def plant(method, at):
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, at if method.startswith("discrete") else 0.0)
        if method.startswith("discrete"):
            name = method.split(", ")[1]
            plant.set_discrete_contact_approximation(getattr(DiscreteContactApproximation, "k" + name.capitalize()))
        return builder, plant

    @staticmethod
    def run(builder, plant, method, at, duration, start, value):
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
            # the step that begins at the end is not due, whatever the rounding of its time
            simulator.AdvanceTo(duration - at / 2 if method.startswith("discrete") else duration)
            return value(context)
        return timed(once)

    def ball(self, method, at, material, duration, height, radius, mass, v, omega):
        builder, plant = self.plant(method, at)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -G])
        plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "table", material)
        ball = plant.AddRigidBody("ball", SpatialInertia(mass, [0, 0, 0], UnitInertia.SolidSphere(radius)))
        plant.RegisterCollisionGeometry(ball, RigidTransform(), Sphere(radius), "ball", material)
        if not method.startswith("discrete"):
            plant.set_stiction_tolerance(0.1 * at)  # [m/s] of slip, below which friction is regularized
        plant.Finalize()

        def start(context):
            plant.SetFreeBodyPose(context, ball, RigidTransform([0, 0, radius + height]))
            plant.SetFreeBodySpatialVelocity(context=context, body=ball, V_JpJc=SpatialVelocity(omega, v))
        return self.run(builder, plant, method, at, duration, start,
                        lambda context: plant.EvalBodyPoseInWorld(context, ball).translation().copy())

    def masse(self, method, at):
        material = ProximityProperties()
        AddContactMaterial(dissipation=10.0, point_stiffness=1e6, friction=CoulombFriction(MU, MU), properties=material)
        end, seconds = self.ball(method, at, material, DURATION["masse"], 0, RADIUS, MASS, V, OMEGA)
        return end[:2], seconds

    def bounces(self, method, at):
        # CENIC steps over the impacts of stiffer springs
        rate = 3 / math.sqrt(at) if method == "CENIC" else stiff_rate(at, method.startswith("discrete"))
        material = ProximityProperties()
        # two equal materials: half of each one's stiffness, in series; the dissipation of one; both relaxation times
        AddContactMaterial(dissipation=hunt_crossley(DROP["e"], FIRST_IMPACT),
                           point_stiffness=2 * DROP["mass"] * rate**2, friction=CoulombFriction(DROP["mu"], DROP["mu"]),
                           properties=material)
        material.AddProperty("material", "relaxation_time", damping_ratio(DROP["e"]) / rate)
        return self.ball(method, at, material, DURATION["bounces"], DROP["height"], DROP["radius"], DROP["mass"],
                         DROP["v"], DROP["omega"])

    def slider_crank(self, method, at):
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
        return self.run(builder, plant, method, at, DURATION["slider_crank"], start,
                        lambda context: np.array([0.2 + slide.get_translation(context)]))
