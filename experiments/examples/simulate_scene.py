"""A ball dropped on a rough floor with spin: where does it go?"""

import orthant

scene = orthant.Scene(gravity=[0, -9.81], duration=2.0, step=1e-3)
scene.add("body", name="ball", mass=1, inertia=0.004, position=[0, 1], omega=-20)
scene.add("contact", name="floor", type="disc-wall", body="ball", radius=0.1, wall={"normal": [0, 1]}, e_n=0.5, mu=0.3)

run = orthant.simulate(scene, integrator="adaptive:rtol=1e-8")
print(run.status, "in", run.summary["seconds"], "s")
print(run.frame()[["ball.x", "ball.y", "ball.omega", "floor.impulse_n"]].iloc[::400])
