// A mechanism in space, drawn by three.js: solids, joints, contact forces with their friction cones, paths of the bodies.
// A frame: t, then x, y, z and quaternion w, x, y, z of each body, then gap and impulses n, t1, t2 of each contact.
// All is drawn in units of the motion's size, about its middle. Drag turns, the wheel zooms, the right button moves.
"use strict";

const kArrow = 0.42; // length of the arrow of the strongest impulse
const kMark = 0.028; // radius of a joint's mark
const kLookFrom = [1.5, -2.2, 1.3];

/** A unit vector at right angles to n, as contact_rows.h has it: the axis least along n, less its part along n. */
function perpendicular(n) {
  const sizes = n.toArray().map(Math.abs);
  const k = sizes.indexOf(Math.min(...sizes));
  const e = new THREE.Vector3().setComponent(k, 1);
  return e.addScaledVector(n, -n.getComponent(k)).normalize();
}

const vector = (p) => new THREE.Vector3(...p);

class SpaceFilm extends Shots {
  constructor(element, film, animation) {
    super(element, film, animation);
    this.strongest = Math.max(
      1e-12,
      ...film.frames.map((frame) => Math.max(0, ...this.scene.contacts.map((_, i) => this.force(frame, i).size))),
    );
    this.canvas.className = "space";
    this.toolbar();
    this.bounds();
    try {
      this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    } catch {
      this.canvas.hidden = true;
      this.bar.replaceChildren("This browser shows no WebGL: there is no animation in space. Plots and events are below.");
      return;
    }
    this.build();
    this.paint();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.paint();
      this.render();
    });
  }

  /** What is shown, and from where. */
  toolbar() {
    this.bar = Object.assign(document.createElement("div"), { className: "controls" });
    this.options = {};
    for (const [key, words, on] of [
      ["forces", "contact forces", true],
      ["cones", "friction cones", true],
      ["joints", "joints", true],
      ["paths", "paths", false],
      ["shadows", "shadows", false],
    ]) {
      const label = document.createElement("label");
      this.options[key] = Object.assign(document.createElement("input"), { type: "checkbox", checked: on });
      this.options[key].onchange = () => this.render();
      label.append(this.options[key], ` ${words}`);
      this.bar.append(label);
    }
    for (const [words, from] of [
      ["whole", kLookFrom],
      ["along x", [3, 0, 0]],
      ["along y", [0, -3, 0]],
      ["along z", [0, 0, 3]],
    ]) {
      const button = Object.assign(document.createElement("button"), { type: "button", textContent: words });
      button.onclick = () => this.look(from);
      this.bar.append(button);
    }
    this.label = Object.assign(document.createElement("span"), { className: "facts" });
    this.bar.append(this.label);
    this.strip.before(this.bar);
  }

  impulse(frame, i) {
    return frame[2 + 7 * this.bodies + 4 * i];
  }
  /** Normal and tangential impulses of a contact, and the size of their sum. */
  force(frame, i) {
    const at = 2 + 7 * this.bodies + 4 * i;
    const [n, t1, t2] = [frame[at] ?? 0, frame[at + 1] ?? 0, frame[at + 2] ?? 0];
    return { n, t1, t2, size: Math.hypot(n, t1, t2) };
  }

  position(frame, body) {
    return body < 0 ? new THREE.Vector3() : new THREE.Vector3(...frame.slice(1 + 7 * body, 4 + 7 * body));
  }
  turn(frame, body) {
    if (body < 0) return new THREE.Quaternion();
    const [w, x, y, z] = frame.slice(4 + 7 * body, 8 + 7 * body);
    return new THREE.Quaternion(x, y, z, w);
  }
  place(frame, body, point) {
    return vector(point).applyQuaternion(this.turn(frame, body)).add(this.position(frame, body));
  }

  /** Middle and size of all that the frames show, planes left out. */
  bounds() {
    const low = new THREE.Vector3(Infinity, Infinity, Infinity),
      high = low.clone().negate();
    const take = (p, radius = 0) => {
      low.min(p.clone().addScalar(-radius));
      high.max(p.clone().addScalar(radius));
    };
    const points = []; // body, point, radius
    for (const s of this.scene.solids) {
      if (s.kind === "sphere" || s.kind === "socket") points.push([s.body, s.centre, s.radius]);
      if (s.kind === "capsule") points.push([s.body, s.from, s.radius], [s.body, s.to, s.radius]);
      if (s.kind === "polytope") for (const p of s.points) points.push([s.body, p, 0]);
    }
    for (const joint of this.scene.joints) points.push([joint.a, joint.point_a, 0]);
    const all = this.film.frames;
    const stride = Math.max(1, Math.ceil(((points.length + 1) * all.length) / 1e5));
    all.forEach((frame, k) => {
      this.scene.bodies.forEach((_, i) => take(this.position(frame, i)));
      if (k % stride === 0 || k === all.length - 1) for (const [body, p, r] of points) take(this.place(frame, body, p), r);
    });
    this.middle = low.clone().add(high).multiplyScalar(0.5);
    this.size = Math.max(high.distanceTo(low) / 2, 1e-9); // radius of a ball about the middle
  }

  build() {
    this.stage = new THREE.Scene();
    this.world = new THREE.Group(); // in metres
    this.world.scale.setScalar(1 / this.size);
    this.world.position.copy(this.middle).multiplyScalar(-1 / this.size);
    this.marks = new THREE.Group(); // in units of the size
    this.stage.add(this.world, this.marks, new THREE.AmbientLight(0xffffff, 1.3));
    this.sun = new THREE.DirectionalLight(0xffffff, 2.2);
    this.sun.position.set(1.2, -1.8, 3);
    this.sun.shadow.mapSize.set(2048, 2048);
    Object.assign(this.sun.shadow.camera, { left: -1.6, right: 1.6, top: 1.6, bottom: -1.6, near: 0.5, far: 8 });
    this.sun.shadow.normalBias = 0.01;
    this.stage.add(this.sun);
    this.camera = new THREE.PerspectiveCamera(35, 1.6, 0.02, 60);
    this.camera.up.set(0, 0, 1);
    this.orbit = new THREE.OrbitControls(this.camera, this.canvas);
    this.orbit.addEventListener("change", () => this.render());
    this.planes = [];
    this.painted = []; // [material, name of its colour, what it is mixed with]
    this.movers = this.scene.bodies.map(() => new THREE.Group());
    this.ground = new THREE.Group();
    this.world.add(this.ground, ...this.movers);
    for (const solid of this.scene.solids) (solid.body < 0 ? this.ground : this.movers[solid.body])?.add(this.solid(solid));
    this.scene.bodies.forEach((_, i) => {
      if (!this.scene.solids.some((solid) => solid.body === i)) // at least a point
        this.movers[i].add(this.solid({ body: i, kind: "sphere", centre: [0, 0, 0], radius: 0.03 * this.size }));
    });
    this.joints = this.scene.joints.map((joint) => this.jointMark(joint));
    this.arrows = this.scene.contacts.map((contact) => this.arrow(contact));
    this.paths = this.scene.bodies.map((_, i) => {
      const points = this.film.frames.map((frame) => this.position(frame, i));
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial());
      line.frustumCulled = false;
      this.painted.push([line.material, `--c${i % 9}`]);
      this.world.add(line);
      return line;
    });
    this.look(kLookFrom);
  }

  material(body, options = {}) {
    const material = new THREE.MeshLambertMaterial(options);
    this.painted.push([material, body < 0 ? "--faint" : `--c${body % 9}`]);
    return material;
  }

  solid(s) {
    if (s.kind === "plane") return this.plane(s);
    const group = new THREE.Group();
    const add = (geometry, options) => {
      const mesh = new THREE.Mesh(geometry, this.material(s.body, options));
      mesh.castShadow = mesh.receiveShadow = s.kind !== "socket";
      group.add(mesh);
      return mesh;
    };
    if (s.kind === "sphere") add(octants(new THREE.SphereGeometry(s.radius, ...(this.scene.solids.length > 100 ? [16, 8] : [48, 24]))), { vertexColors: true });
    if (s.kind === "socket")
      add(new THREE.SphereGeometry(s.radius, 32, 16), { transparent: true, opacity: 0.22, depthWrite: false, side: THREE.DoubleSide });
    if (s.centre) group.position.set(...s.centre);
    if (s.kind === "capsule") {
      const [from, to] = [vector(s.from), vector(s.to)];
      const along = to.clone().sub(from);
      const rod = add(new THREE.CylinderGeometry(s.radius, s.radius, along.length(), 20, 1, true));
      rod.position.copy(from).addScaledVector(along, 0.5);
      rod.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
      for (const end of [from, to]) add(new THREE.SphereGeometry(s.radius, 20, 12)).position.copy(end);
    }
    if (s.kind === "polytope") {
      const corners = s.faces.flatMap((face) => face.slice(2).flatMap((_, i) => [face[0], face[i + 1], face[i + 2]]));
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners.flatMap((i) => s.points[i]), 3));
      geometry.computeVertexNormals(); // of each triangle, for it shares no corner
      add(geometry, { side: s.faces.length === 1 ? THREE.DoubleSide : 0 });
      const edges = new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 5), new THREE.LineBasicMaterial());
      this.painted.push([edges.material, "--ink"]);
      group.add(edges);
    }
    return group;
  }

  /** A square with a grid, seen from its free side; of the ground about the middle of the motion. */
  plane(s) {
    const group = new THREE.Group();
    const n = vector(s.normal),
      at = vector(s.point),
      half = s.body < 0 ? 1.5 * this.size : Math.min(s.half, 1.5 * this.size);
    if (s.body < 0) at.copy(this.middle).addScaledVector(n, -n.dot(this.middle.clone().sub(vector(s.point))));
    const sheet = new THREE.Mesh(
      new THREE.PlaneGeometry(2 * half, 2 * half),
      this.material(-1, { transparent: true, opacity: 0.3, depthWrite: false }),
    );
    sheet.receiveShadow = true;
    const grid = new THREE.GridHelper(2 * half, 12);
    grid.rotation.x = Math.PI / 2; // three.js has it in x, z
    Object.assign(grid.material, { vertexColors: false, transparent: true, opacity: 0.35 });
    this.painted.push([grid.material, "--faint"]);
    group.add(sheet, grid);
    group.position.copy(at).addScaledVector(n, -1e-4 * this.size);
    group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), n);
    this.planes.push({ group, grid });
    return group;
  }

  /** Seen through all else. By kind: a pin along its axis, a ball, a slide's block, a plane's disc, a strut. */
  jointMark({ kind }) {
    const r = kMark;
    const geometry =
      kind === "revolute" || kind === "cylindrical" || kind === "universal"
        ? new THREE.CylinderGeometry(0.45 * r, 0.45 * r, (kind === "revolute" ? 3.2 : 5) * r, 16)
        : kind === "prismatic" || kind === "point-on-line"
          ? new THREE.BoxGeometry(r, 4 * r, r)
          : kind === "planar" || kind === "point-in-plane"
            ? new THREE.CylinderGeometry(1.8 * r, 1.8 * r, 0.25 * r, 24)
            : kind === "fixed"
              ? new THREE.BoxGeometry(1.5 * r, 1.5 * r, 1.5 * r)
              : kind === "distance"
                ? new THREE.CylinderGeometry(0.2 * r, 0.2 * r, 1, 8)
                : new THREE.SphereGeometry(0.8 * r, 20, 12);
    const material = new THREE.MeshLambertMaterial({ transparent: true, opacity: 0.85, depthTest: false });
    this.painted.push([material, "--ink"]);
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = 2;
    this.marks.add(mesh);
    return mesh;
  }

  /** The force on a contact's first body as an arrow of unit length, and the cone that friction keeps it in. */
  arrow(contact) {
    const group = new THREE.Group();
    const material = new THREE.MeshLambertMaterial({ transparent: true, depthTest: false });
    const [shaft, head] = [new THREE.CylinderGeometry(0.009, 0.009, 1, 12), new THREE.ConeGeometry(0.026, 0.07, 20)].map(
      (geometry) => new THREE.Mesh(geometry, material),
    );
    shaft.renderOrder = head.renderOrder = 3;
    const cone = new THREE.Group();
    if (contact.mu > 0) {
      const shell = new THREE.Mesh(
        new THREE.ConeGeometry(contact.mu, 1, 48, 1, true).translate(0, -0.5, 0).rotateX(Math.PI), // its tip at the origin
        new THREE.MeshLambertMaterial({ transparent: true, opacity: 0.28, depthWrite: false, side: THREE.DoubleSide }),
      );
      const rim = new THREE.Line(
        new THREE.BufferGeometry().setFromPoints(
          Array.from({ length: 65 }, (_, i) => new THREE.Vector3(contact.mu * Math.cos((i * Math.PI) / 32), 1, contact.mu * Math.sin((i * Math.PI) / 32))),
        ),
        new THREE.LineBasicMaterial(),
      );
      this.painted.push([shell.material, "--c4"], [rim.material, "--c4"]);
      shell.renderOrder = rim.renderOrder = 1;
      cone.add(shell, rim);
    }
    this.painted.push([material, "--c1"]);
    group.add(shaft, head);
    this.marks.add(group, cone);
    return { group, shaft, head, cone, material };
  }

  paint() {
    for (const [material, name] of this.painted) material.color.set(colour(name));
  }

  /** All from a direction. */
  look(from) {
    this.orbit.target.set(0, 0, 0);
    const narrow = Math.min(1, this.camera.aspect);
    this.camera.position.copy(vector(from).normalize()).multiplyScalar(3 / narrow);
    if (from[0] === 0 && from[1] === 0) this.camera.position.y = -1e-3; // z is up: not along it exactly
    this.orbit.update();
    this.render();
  }

  /** Where a contact acts and its normal, towards the first body, where the drawing knows it. */
  contactAt(frame, contact) {
    if (contact.centres) {
      const { a, point_a, radius_a, b, point_b, inside } = contact.centres;
      const pa = this.place(frame, a, point_a);
      const n = pa.clone().sub(this.place(frame, b, point_b)).normalize();
      if (inside) n.negate();
      return n.lengthSq() > 0 ? { point: pa.addScaledVector(n, -radius_a), n } : null;
    }
    if (contact.body === undefined) return null;
    const n = vector(contact.normal).applyQuaternion(this.turn(frame, contact.on));
    return { point: this.place(frame, contact.body, contact.point).addScaledVector(n, -contact.radius), n };
  }

  /** Into the units of drawing. */
  inside(point) {
    return point.clone().sub(this.middle).divideScalar(this.size);
  }

  moveMarks(k) {
    const frames = this.film.frames,
      frame = frames[k],
      up = new THREE.Vector3(0, 1, 0);
    this.scene.joints.forEach((joint, i) => {
      const mark = this.joints[i];
      mark.visible = this.options.joints.checked;
      const [pa, pb] = [this.place(frame, joint.a, joint.point_a), this.place(frame, joint.body, joint.point)].map((p) => this.inside(p));
      mark.position.copy(pb);
      if (joint.axis) mark.quaternion.setFromUnitVectors(up, vector(joint.axis).applyQuaternion(this.turn(frame, joint.a)));
      if (joint.kind !== "distance") return;
      const along = pb.clone().sub(pa);
      mark.position.copy(pa).addScaledVector(along, 0.5);
      mark.scale.y = Math.max(along.length(), 1e-9);
      mark.quaternion.setFromUnitVectors(up, along.normalize());
    });
    const back = Math.max(1, Math.round(kFade * frames.length));
    this.scene.contacts.forEach((contact, i) => {
      const { group, shaft, head, cone, material } = this.arrows[i];
      group.visible = cone.visible = false;
      let j = k; // the last that pushed, of those that have not faded
      while (j > Math.max(0, k - back + 1) && !(this.force(frames[j], i).size > 1e-9 * this.strongest)) --j;
      const { n, t1, t2, size } = this.force(frames[j], i);
      const at = size > 1e-9 * this.strongest && this.contactAt(frame, contact);
      if (!at) return;
      const first = perpendicular(at.n);
      const second = at.n.clone().cross(first);
      const along = at.n.clone().multiplyScalar(n).addScaledVector(first, t1).addScaledVector(second, t2).normalize();
      const length = Math.max(0.09, kArrow * Math.sqrt(size / this.strongest));
      group.visible = this.options.forces.checked;
      group.position.copy(this.inside(at.point));
      group.quaternion.setFromUnitVectors(up, along);
      shaft.scale.y = length - 0.06;
      shaft.position.y = shaft.scale.y / 2;
      head.position.y = length - 0.035;
      material.opacity = 1 - (k - j) / back;
      cone.visible = this.options.cones.checked && contact.mu > 0;
      cone.position.copy(group.position);
      cone.quaternion.setFromUnitVectors(up, at.n);
      cone.scale.setScalar(Math.max(1e-6, length * (n / size))); // the arrow ends in the plane of its rim
    });
  }

  show(t) {
    this.shown = this.frameAt(t);
    this.label.textContent = `t = ${Number(this.film.frames[this.shown][0].toPrecision(5))} s`;
    this.render();
    this.modes(this.shown);
  }

  render() {
    if (!this.renderer || this.shown === undefined) return;
    const frame = this.film.frames[this.shown];
    const width = this.canvas.clientWidth,
      height = Math.round(Math.min(0.62 * width, 560)) || 1;
    if (this.width !== width || this.dots !== devicePixelRatio) {
      Object.assign(this, { width, dots: devicePixelRatio });
      this.renderer.setPixelRatio(devicePixelRatio);
      this.renderer.setSize(width, height, false);
      this.canvas.style.height = `${height}px`;
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    }
    this.movers.forEach((mover, i) => {
      mover.position.copy(this.position(frame, i));
      mover.quaternion.copy(this.turn(frame, i));
    });
    this.moveMarks(this.shown);
    for (const path of this.paths) {
      path.visible = this.options.paths.checked;
      path.geometry.setDrawRange(0, this.shown + 1);
    }
    this.stage.updateMatrixWorld();
    for (const { group, grid } of this.planes) grid.visible = group.worldToLocal(this.camera.position.clone()).z > 0;
    const shadows = this.options.shadows.checked;
    if (this.renderer.shadowMap.enabled !== shadows) {
      this.renderer.shadowMap.enabled = this.sun.castShadow = shadows;
      for (const [material] of this.painted) material.needsUpdate = true;
    }
    this.renderer.render(this.stage, this.camera);
  }
}

/** A sphere of which every second octant is darker, so that its turning is seen. */
function octants(sphere) {
  const geometry = sphere.toNonIndexed();
  const places = geometry.getAttribute("position");
  const shades = [];
  for (let i = 0; i < places.count; i += 3) {
    const sum = [0, 1, 2].map((c) => places.getComponent(i, c) + places.getComponent(i + 1, c) + places.getComponent(i + 2, c));
    const shade = sum[0] * sum[1] * sum[2] > 0 ? 0.55 : 1;
    for (let c = 0; c < 9; ++c) shades.push(shade);
  }
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(shades, 3));
  return geometry;
}
