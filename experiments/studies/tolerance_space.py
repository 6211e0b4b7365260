"""Random scenes in space for experiments/studies/tolerance.py: balls, solids, mechanisms, as TOML.

balls: three spheres fall onto a floor that slopes, and onto each other. solids: a box, a cylinder or an ellipsoid is
thrown onto such a floor. sliders: a corner of a spinning body, a ball and a box slide on a slope until they stop, stick
or roll.
pendulums: two arms on a ball joint and a hinge, a ball at the end that strikes a wall, or in a socket with clearance.
"""
import math


def number(x):
    return repr(round(x, 12))


def vector(*x):
    return "[" + ", ".join(number(value) for value in x) + "]"


def table(element, **keys):
    words = {"kind": "type"}
    return f"[[{element}]]\n" + "".join(f"{words.get(key, key)} = {value}\n" for key, value in keys.items()) + "\n"


def head(gravity, duration):
    return (f"dimension = 3\ngravity = {vector(*gravity)}\nduration = {number(duration)}\n"
            f"step = {number(duration / 20)}\n\n")


def law_of(draw):
    return {"mu": number(draw.choice([0, draw.uniform(0, 0.8)])), "e_n": number(draw.choice([0, draw.uniform(0, 0.9)]))}


def direction(draw):
    while True:
        x = [draw.uniform(-1, 1) for _ in range(3)]
        length = math.sqrt(sum(value * value for value in x))
        if 0.1 < length < 1:
            return [value / length for value in x]


def vector_of(draw, size):
    return [size * draw.uniform(0, 1) * value for value in direction(draw)]


def orientation(draw):
    angle = draw.uniform(0, math.pi)
    return vector(math.cos(angle / 2), *(math.sin(angle / 2) * value for value in direction(draw)))


def sloping(draw, most):
    """Gravity in the frame of a slope, whose normal is z."""
    tilt, turn = draw.uniform(0, most), draw.uniform(0, 2 * math.pi)
    return 9.81 * math.sin(tilt) * math.cos(turn), 9.81 * math.sin(tilt) * math.sin(turn), -9.81 * math.cos(tilt)


FLOOR = '{body = "ground", point = [0, 0, 0], normal = [0, 0, 1]}'


def balls(draw):
    law, count = law_of(draw), 3
    text, contacts, placed = head(sloping(draw, 0.3), 1.0), "", []
    for i in range(count):
        radius, mass = draw.uniform(0.05, 0.15), draw.uniform(0.3, 2)
        place = [draw.uniform(-0.1, 0.1), draw.uniform(-0.1, 0.1), 0.2 + 0.35 * i + draw.uniform(0, 0.1)]
        placed.append(radius)
        text += table("body", name=f'"ball{i}"', mass=number(mass), solid=f"{{sphere = {number(radius)}}}",
                      position=vector(*place), velocity=vector(*vector_of(draw, 1)), omega=vector(*vector_of(draw, 20)))
        contacts += table("contact", kind='"sphere-wall"', name=f'"floor{i}"', body=f'"ball{i}"', radius=number(radius),
                          wall=FLOOR, **law)
        for j in range(i):
            contacts += table("contact", kind='"sphere-sphere"', name=f'"pair{j}{i}"', bodies=f'["ball{j}", "ball{i}"]',
                              radius_a=number(placed[j]), radius_b=number(radius), **law)
    return text + contacts


def solids(draw):
    law, kind = law_of(draw), draw.choice(["box", "cylinder", "ellipsoid"])
    text = head(sloping(draw, 0.4), 0.8)
    sizes = [draw.uniform(0.05, 0.25) for _ in range(3)]
    if kind == "box":
        solid, contact = f"{{box = {vector(*sizes)}}}", {"kind": '"box-wall"', "size": vector(*sizes)}
    elif kind == "cylinder":
        solid = f"{{cylinder = {vector(*sizes[:2])}}}"
        contact = {"kind": '"cylinder-wall"', "radius": number(sizes[0]), "height": number(sizes[1]),
                   "centre": "[0, 0, 0]", "axis": "[0, 0, 1]"}
    else:
        solid, contact = f"{{ellipsoid = {vector(*sizes)}}}", {"kind": '"ellipsoid-wall"', "semi_axes": vector(*sizes)}
    height = draw.uniform(0.35, 0.5)
    text += table("body", name='"solid"', mass=number(draw.uniform(0.3, 2)), solid=solid, position=vector(0, 0, height),
                  orientation=orientation(draw), velocity=vector(*vector_of(draw, 2)),
                  omega=vector(*vector_of(draw, 10)))
    return text + table("contact", name='"floor"', body='"solid"', wall=FLOOR, **contact, **law)


def sliders(draw):
    kind = draw.choice(["ball", "box", "puck"])
    mu, radius = draw.uniform(0.05, 0.8), draw.uniform(0.03, 0.2)
    text = head(sloping(draw, 0.5), 1.0)
    speed, turn = draw.uniform(0.2, 3), draw.uniform(0, 2 * math.pi)
    velocity = vector(speed * math.cos(turn), speed * math.sin(turn), 0)
    law = {"mu": number(mu), "e_n": "0.0"}
    if kind == "ball":
        text += table("body", name='"ball"', mass="1.0", solid=f"{{sphere = {number(radius)}}}",
                      position=vector(0, 0, radius), velocity=velocity, omega=vector(*vector_of(draw, 40)))
        return text + table("contact", kind='"sphere-wall"', name='"floor"', body='"ball"', radius=number(radius),
                            wall=FLOOR, **law)
    if kind == "box":
        size = [draw.uniform(0.1, 0.3), draw.uniform(0.1, 0.3), draw.uniform(0.02, 0.05)]
        text += table("body", name='"box"', mass="1.0", solid=f"{{box = {vector(*size)}}}",
                      position=vector(0, 0, size[2] / 2), velocity=velocity)
        return text + table("contact", kind='"box-wall"', name='"floor"', body='"box"', size=vector(*size), wall=FLOOR,
                            **law)
    text += table("body", name='"puck"', mass="1.0", inertia=number(0.01), position="[0, 0, 0]", velocity=velocity,
                  omega=vector(0, 0, draw.uniform(-5, 5)))
    return text + table("contact", kind='"corner-wall"', name='"floor"', body='"puck"', point="[0, 0, 0]", wall=FLOOR,
                        **law)


def pendulums(draw):
    law = law_of(draw)
    first, second, radius = draw.uniform(0.2, 0.5), draw.uniform(0.15, 0.4), 0.03
    text = head((0, 0, -9.81), 1.0)
    masses = [draw.uniform(0.3, 1.5) for _ in range(2)]
    for i, (length, middle) in enumerate(((first, first / 2), (second, first + second / 2))):
        moments = [masses[i] * length**2 / 12, masses[i] * length**2 / 12, masses[i] * length**2 / 60]
        spin = draw.uniform(-3, 3)
        text += table("body", name=f'"arm{i}"', mass=number(masses[i]),
                      inertia=vector(moments[2], moments[0], moments[1]), position=vector(middle, 0, 0),
                      omega=vector(spin if i == 0 else 0,
                                   draw.uniform(-3, 3) if i == 0 else 0, 0))
    text += table("joint", kind='"spherical"', name='"shoulder"', bodies='["ground", "arm0"]', point_a=vector(0, 0, 0),
                  point_b=vector(-first / 2, 0, 0))
    if draw.random() < 0.5:
        clearance = radius * 10 ** draw.uniform(-2, -0.5)
        text += table("contact", kind='"socket"', name='"elbow"', bodies='["arm0", "arm1"]',
                      centre_a=vector(first / 2, 0, 0), centre_b=vector(-second / 2, 0, 0), radius_a=number(radius),
                      radius_b=number(radius + clearance), **law)
        return text
    text += table("joint", kind='"revolute"', name='"elbow"', bodies='["arm0", "arm1"]',
                  point_a=vector(first / 2, 0, 0), point_b=vector(-second / 2, 0, 0), axis=vector(*direction(draw)))
    depth = draw.uniform(0.3, 0.9) * (first + second)
    wall = f'{{body = "ground", point = {vector(0, 0, -depth)}, normal = [0, 0, 1]}}'
    return text + table("contact", kind='"sphere-wall"', name='"wall"', body='"arm1"', centre=vector(second / 2, 0, 0),
                        radius=number(radius), wall=wall, **law)


KINDS = {"balls": balls, "solids": solids, "sliders": sliders, "pendulums": pendulums}
