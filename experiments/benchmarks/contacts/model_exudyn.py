"""EXUDYN: bodies with all coordinates (Euler parameters), joints as constraints, implicit integrators.

It has no contact of two boxes, and of spheres among many only by springs and dampers: here the chain alone.
"""
import time

import exudyn as exu
import numpy as np
from exudyn.rigidBodyUtilities import RigidBodyInertia

from achieved import Pose
from scenes import G

SOLVERS = {"generalized-alpha": exu.DynamicSolverType.GeneralizedAlpha,
           "trapezoidal-index-2": exu.DynamicSolverType.TrapezoidalIndex2}


class Model:
    @staticmethod
    def settings(scene):
        if scene != "chain":
            raise RuntimeError("no contact of rigid boxes; of spheres by springs alone")
        return list(SOLVERS)

    def run(self, scene, setting, h):
        mbs = exu.SystemContainer().AddSystem()
        ground = mbs.CreateGround()
        bodies = [mbs.CreateRigidBody(referencePosition=list(b.place), initialVelocity=list(b.velocity),
                                      initialAngularVelocity=list(b.omega), gravity=[0, 0, -G],
                                      nodeType=exu.NodeType.RotationEulerParameters,
                                      inertia=RigidBodyInertia(b.mass, np.diag(b.moments))) for b in scene.bodies]
        for a, b, point in scene.joints:
            mbs.CreateSphericalJoint(itemNumbers=[bodies[a] if a >= 0 else ground, bodies[b]], position=list(point))
        mbs.Assemble()
        settings = exu.SimulationSettings()
        settings.solution.file.write = False
        run = settings.timeIntegration
        run.endTime, run.numberOfSteps = scene.duration, round(scene.duration / h)
        run.verboseMode = run.stepInformation = 0
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
        begin = time.thread_time()
        if not mbs.SolveDynamic(settings, solverType=SOLVERS[setting], updateInitialValues=True, showHints=False,
                                showCausingItems=False):
            raise RuntimeError("the solver does not converge")
        seconds = time.thread_time() - begin
        read = lambda variable: np.array([mbs.GetObjectOutputBody(b, variable) for b in bodies])
        kind = exu.OutputVariableType
        after = Pose(read(kind.Position), read(kind.RotationMatrix).reshape(-1, 3, 3), read(kind.Velocity),
                     read(kind.AngularVelocity))
        return {"h": h, "seconds": seconds, "steps": run.numberOfSteps, "before": after, "after": after}
