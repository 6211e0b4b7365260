"""Drake: discrete plant, soft contact at points by its defaults ("lagged"), by "sap" or "similar".

"stiff" has springs of 1e8 N/m. Two boxes touch at one point only; "hydroelastic" has the pressure over their patch
instead, whose forces are not taken as points: there is no law to recompute. The chain has joint angles; "error control"
is its continuous plant by Runge and Kutta, with the accuracy (step / 1 s)³.
"""
import time

import numpy as np
from pydrake.all import (AddCompliantHydroelasticProperties, AddContactMaterial, AddMultibodyPlantSceneGraph,
                         AddRigidHydroelasticProperties, ApplySimulatorConfig, BallRpyJoint, Box, ContactModel,
                         CoulombFriction,
                         DiagramBuilder, DiscreteContactApproximation, FixedOffsetFrame, HalfSpace, MultibodyPlant,
                         ProximityProperties, RigidTransform, RotationMatrix, Simulator, SimulatorConfig,
                         SpatialInertia, Sphere, UnitInertia)

from achieved import Contact, Pose
from scenes import G

POINTS = ["lagged", "similar", "sap", "lagged, stiff"]


class Model:
    @staticmethod
    def settings(scene):
        if scene == "chain":
            return ["discrete", "error control"]
        return POINTS if scene == "pile" else [*POINTS, "lagged, hydroelastic"]

    def run(self, scene, setting, h):
        if scene.joints:
            return self.chain(scene, setting, h)
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, h)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -G])
        kind, _, way = setting.partition(", ")
        plant.set_discrete_contact_approximation(getattr(DiscreteContactApproximation, "k" + kind.capitalize()))
        patches = way == "hydroelastic"
        if patches:
            plant.set_contact_model(ContactModel.kHydroelastic)

        def material(rigid):
            made = ProximityProperties()
            AddContactMaterial(point_stiffness=1e8 if way == "stiff" else None,
                               friction=CoulombFriction(scene.mu, scene.mu), properties=made)
            if patches:
                AddRigidHydroelasticProperties(made) if rigid else AddCompliantHydroelasticProperties(0.1, 1e9, made)
            return made
        for k, (point, normal) in enumerate(scene.planes):
            plant.RegisterCollisionGeometry(plant.world_body(), HalfSpace.MakePose(normal, point), HalfSpace(),
                                            f"plane{k}", material(True))
        bodies = []
        for k, b in enumerate(scene.bodies):
            inertia = SpatialInertia(b.mass, np.zeros(3), UnitInertia(*(b.moments / b.mass)))
            bodies.append(plant.AddRigidBody(f"b{k}", inertia))
            what = Sphere(b.shape[1]) if b.shape[0] == "sphere" else Box(*b.shape[1:])
            plant.RegisterCollisionGeometry(bodies[-1], RigidTransform(), what, f"b{k}", material(False))
        plant.Finalize()
        simulator = Simulator(builder.Build())
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        for b, body in zip(scene.bodies, bodies):
            plant.SetFreeBodyPose(context, body, RigidTransform(RotationMatrix(b.rotation), b.place))
        run = self.timed(simulator, plant, context, bodies, h, scene.duration)
        run["contacts"] = None if patches else self.contacts(plant, context, bodies, h)
        return run

    def timed(self, simulator, plant, context, bodies, h, duration):
        steps = round(duration / h)
        simulator.Initialize()
        begin = time.thread_time()
        simulator.AdvanceTo((steps - 1.5) * h)  # the step that begins at the end is not due, whatever the rounding
        seconds = time.thread_time() - begin
        before = self.pose(plant, context, bodies)
        begin = time.thread_time()
        simulator.AdvanceTo((steps - 0.5) * h)
        seconds += time.thread_time() - begin
        return {"h": h, "seconds": seconds, "steps": steps, "before": before,
                "after": self.pose(plant, context, bodies)}

    @staticmethod
    def pose(plant, context, bodies):
        """Of the centres of mass."""
        place, rotation, velocity, omega = [], [], [], []
        for body in bodies:
            at = plant.EvalBodyPoseInWorld(context, body)
            twist = plant.EvalBodySpatialVelocityInWorld(context, body)
            arm = at.rotation() @ body.default_com()
            place.append(at.translation() + arm), rotation.append(at.rotation().matrix())
            velocity.append(twist.translational() + np.cross(twist.rotational(), arm)), omega.append(twist.rotational())
        return Pose(*map(np.array, (place, rotation, velocity, omega)))

    @staticmethod
    def contacts(plant, context, bodies, h):
        """Its results are those of the last step; normals from B to A, forces on B."""
        number = {int(body.index()): k for k, body in enumerate(bodies)}
        results = plant.get_contact_results_output_port().Eval(context)
        told = [results.point_pair_contact_info(i) for i in range(results.num_point_pair_contacts())]
        return [Contact(number.get(int(c.bodyA_index()), -1), number.get(int(c.bodyB_index()), -1), c.contact_point(),
                        c.point_pair().nhat_BA_W, -h * c.contact_force(), -c.point_pair().depth) for c in told]

    def chain(self, scene, setting, at):
        plant = MultibodyPlant(at if setting == "discrete" else 0.0)
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -G])
        tip, joint, rods = plant.world_frame(), None, []
        for i, b in enumerate(scene.bodies):
            unit = UnitInertia(*(b.moments / b.mass)).ShiftFromCenterOfMass([-0.5, 0, 0])
            rods.append(plant.AddRigidBody(f"rod{i}", SpatialInertia(b.mass, [0.5, 0, 0], unit)))
            joint = plant.AddJoint(BallRpyJoint(f"joint{i}", tip, rods[-1].body_frame()))
            tip = plant.AddFrame(FixedOffsetFrame(f"tip{i}", rods[-1].body_frame(), RigidTransform([1, 0, 0])))
        plant.Finalize()
        simulator = Simulator(plant)
        context = simulator.get_mutable_context()
        joint.set_angular_velocity(context, scene.bodies[-1].omega)
        if setting == "discrete":
            return self.timed(simulator, plant, context, rods, at, scene.duration)
        ApplySimulatorConfig(SimulatorConfig(integration_scheme="runge_kutta3", accuracy=at**3, max_step_size=0.1,
                                             use_error_control=True), simulator)
        simulator.Initialize()
        begin = time.thread_time()
        simulator.AdvanceTo(scene.duration)
        seconds = time.thread_time() - begin
        after = self.pose(plant, context, rods)
        steps = simulator.get_integrator().get_num_steps_taken()
        return {"h": at, "seconds": seconds, "steps": steps, "before": after, "after": after}
