"""EXUDYN: rigid bodies in all coordinates, joints as constraints, contact of a sphere with a triangle.

Contact is a spring and damper, friction is regularized below a slip of a tenth of the step (in m/s). For the ball that
slides the spring is as stiff as Drake's and damped critically; for the one that bounces it is its model of impacts with
a given restitution (Gonthier's, and Carvalho and Martins'), stiffer as the step or the tolerance shrinks. Two implicit
integrators (Euler parameters), for the balls also two explicit ones (rotation vectors), which take no joints.
"""
import math

import exudyn as exu
import numpy as np
from exudyn.rigidBodyUtilities import RigidBodyInertia

from motions import (AXIS, DROP, DURATION, END, G, MASS, MU, OMEGA, PIN, RADIUS, SQUARE, TURN, V, stiff_rate, timed)

IMPLICIT = {"generalized-alpha": exu.DynamicSolverType.GeneralizedAlpha,
            "trapezoidal-index-2": exu.DynamicSolverType.TrapezoidalIndex2}
EXPLICIT = {"rk44": exu.DynamicSolverType.RK44, "dopri5": exu.DynamicSolverType.DOPRI5}
CRITICAL, RESTITUTION = 0, 2  # its numbers of models of impact: linear; by a given restitution


class Exudyn:
    settings = {
        scene: dict.fromkeys(IMPLICIT, "step") |
        ({} if scene == "slider_crank" else {"rk44": "step", "dopri5": "accuracy"})
        for scene in ("masse", "slider_crank", "bounces")
    }

    @staticmethod
    def run(mbs, body, method, at, duration):
        mbs.Assemble()
        settings = exu.SimulationSettings()
        time = settings.timeIntegration
        settings.solution.file.write = False
        time.endTime, time.verboseMode, time.stepInformation = duration, 0, 0
        time.automaticStepSize = method == "dopri5"
        if method == "dopri5":
            time.absoluteTolerance = time.relativeTolerance = at
            time.numberOfSteps, time.minimumStepSize = round(100 * duration), 1e-12  # at least
        else:
            time.numberOfSteps = round(duration / at)

        def once():
            if not mbs.SolveDynamic(settings, solverType=(IMPLICIT | EXPLICIT)[method], updateInitialValues=False,
                                    showHints=False, showCausingItems=False):
                raise RuntimeError("the solver does not converge")
            return np.array(mbs.GetObjectOutputBody(body, exu.OutputVariableType.Position))
        return timed(once)

    def ball(self, method, at, scene, height, radius, mass, mu, v, omega, contact):
        mbs = exu.SystemContainer().AddSystem()
        ground = mbs.CreateGround()
        node = exu.NodeType.RotationRotationVector if method in EXPLICIT else exu.NodeType.RotationEulerParameters
        ball = mbs.CreateRigidBody(referencePosition=[0, 0, radius + height], initialVelocity=list(v),
                                   initialAngularVelocity=list(omega), gravity=[0, 0, -G], nodeType=node,
                                   inertia=RigidBodyInertia(mass, 0.4 * mass * radius**2 * np.eye(3)))
        mbs.CreateSphereTriangleContact(itemNumbers=[ball, ground], sphereRadius=radius, includeEdges=0,
                                        trianglePoints=exu.Vector3DList([[-50, -50, 0], [100, -50, 0], [-50, 100, 0]]),
                                        dynamicFriction=mu, frictionProportionalZone=0.1 * at, **contact)
        return self.run(mbs, ball, method, at, DURATION[scene])

    def masse(self, method, at):
        stiffness = 1e6
        end, seconds = self.ball(
            method, at, "masse", 0, RADIUS, MASS, MU, V, OMEGA,
            dict(contactStiffness=stiffness, contactDamping=2 * math.sqrt(stiffness * MASS), impactModel=CRITICAL))
        return end[:2], seconds

    def bounces(self, method, at):
        rate = stiff_rate(at, method != "dopri5")
        return self.ball(
            method, at, "bounces", DROP["height"], DROP["radius"], DROP["mass"], DROP["mu"], DROP["v"], DROP["omega"],
            dict(contactStiffness=DROP["mass"] * rate**2, restitutionCoefficient=DROP["e"], impactModel=RESTITUTION))

    def slider_crank(self, method, at):
        mbs = exu.SystemContainer().AddSystem()
        ground = mbs.CreateGround()
        R = np.stack([AXIS, SQUARE, np.cross(AXIS, SQUARE)], axis=1)

        def body(place, v, omega, mass, moments, turned=np.eye(3)):
            return mbs.CreateRigidBody(referencePosition=list(place), referenceRotationMatrix=turned,
                                       initialVelocity=list(v), initialAngularVelocity=list(omega), gravity=[0, 0, -G],
                                       inertia=RigidBodyInertia(mass, np.diag(moments)))
        pin_rate = np.array([0, -0.48, 0])
        crank = body([0, 0.1, 0.16], pin_rate / 2, [6, 0, 0], 0.12, [1e-4, 1e-4, 1e-5])
        rod = body((PIN + END) / 2, pin_rate + np.cross(TURN, (END - PIN) / 2), TURN, 0.5, [4e-4, 4e-3, 4e-3], R)
        slider = body(END, [0.24, 0, 0], [0, 0, 0], 2, [1e-4, 1e-4, 1e-4])
        x = [1, 0, 0]
        mbs.CreateRevoluteJoint(itemNumbers=[ground, crank], position=[0, 0.1, 0.12], axis=x)
        mbs.CreateSphericalJoint(itemNumbers=[crank, rod], position=list(PIN))
        mbs.CreatePrismaticJoint(itemNumbers=[ground, slider], position=list(END), axis=x)
        # Hooke's joint: of the rotations only the first is locked, which keeps y of the first frame (the slider's x)
        # at right angles to z of the second (the rod's axis)
        hooke = np.stack([np.cross(x, SQUARE), x, SQUARE], axis=1)
        mbs.CreateGenericJoint(itemNumbers=[slider, rod], position=list(END), rotationMatrixAxes=hooke,
                               constrainedAxes=[1, 1, 1, 1, 0, 0])
        end, seconds = self.run(mbs, slider, method, at, DURATION["slider_crank"])
        return end[:1], seconds
