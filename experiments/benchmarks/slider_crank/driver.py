"""What the slider-cranks in Python share: parameters, contact parameters from a restitution, the protocol of
driver.h."""
import math
import sys
import time

L1, L2, A, B, CLEARANCE = 0.153, 0.306, 0.05, 0.025, 0.001
M1, M2, M3, J1, J2, J3 = 0.038, 0.038, 0.076, 7.4e-5, 5.9e-4, 2.7e-6
G, OMEGA1, OMEGA2, DURATION = 9.81, 150.0, -75.0, 0.2
WALL = B + CLEARANCE
FIRST_IMPACT = 0.84  # [m/s] the slider's speed at the first impact of the exact motion


def bisect(f, low, high):
    """Where the falling f is 0."""
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if f(middle) > 0 else (low, middle)
    return low


def damping_ratio(e):
    """Of a linear spring and damper that only push and return the part e of the speed; at least 0.014."""
    def restitution(zeta):
        if zeta < 1:  # leaves when the force is 0, before the spring is relaxed
            root = math.sqrt(1 - zeta * zeta)
            return math.exp(-zeta / root * math.atan2(2 * zeta * root, 2 * zeta * zeta - 1)) if zeta > 0 else 1.0
        root = math.sqrt(zeta * zeta - 1 + 1e-12)
        return math.exp(-zeta / root * math.log((zeta + root) / (zeta - root)))
    return bisect(lambda zeta: restitution(zeta) - e, 0.0, 4.0)


def hunt_crossley(e, speed=FIRST_IMPACT):
    """Dissipation d [s/m] of the force k x (1 + d x') that returns the part e of that speed (only of that one)."""
    def excess(x):  # x = d speed;  x (1 + e) = ln((1 + x)/(1 - e x)) where e fits
        return math.log1p(x) - math.log1p(-e * x) - x * (1 + e)
    if e <= 0:
        return 100 / speed
    return bisect(lambda x: -excess(x), 1e-9, (1 - 1e-12) / e) / speed


def drive(methods):
    """methods: name → (what its setting is, build(mu, e, setting) → run() → (theta1, steps))."""
    if len(sys.argv) == 1:
        print(*(f"{name} {setting}" for name, (setting, _) in methods.items()), sep="\n")
        return
    name, *numbers = sys.argv[1:]
    run = methods[name][1](*map(float, numbers))
    begin = time.process_time()
    theta1, steps = run()
    seconds = time.process_time() - begin
    if not math.isfinite(theta1):
        sys.exit("not finite")
    print(f"{theta1:.17g} {seconds:.9g} {steps}")
