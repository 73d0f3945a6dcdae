// The model as it is drawn at a time: where everything is, and in which colours.

const TRACE = "#c8452d", TO_COME = "#e6b3a6", INK = "#1f2a44";
const THICK = 14;               // pixels, from which the edges of beams are drawn in full
const CLEAR = 0.55;             // of rigid bodies, so that joints show through them

const rgb = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);

class Scene {
  constructor(header, numbers, renderer) {
    this.header = header;
    this.numbers = numbers;
    this.motion = new Motion(header, numbers);
    this.renderer = renderer;
    const { palette } = header;
    this.map = new Float32Array(palette.map.flatMap(rgb));
    this.paint = Object.fromEntries(Object.entries(palette).filter(
      ([, colour]) => typeof colour === "string").map(([name, colour]) => [name, rgb(colour)]));
    this.bodies = header.bodies.map((body) => new Body(body, numbers, header.size));
    this.references = new References(this.bodies, header.nodes);
    this.entries = header.entries.map((entry) => ({ ...entry, paint: rgb(entry.colour),
                                                    visible: true }));
    this.meshes = this.bodies.map((body) => renderer.mesh(body));
    this.deformed = this.bodies.map(() => "");
    this.up = unit(header.view.up);
    this.grid = gridLines(header.view.floor);
    this.marks = new Marks(header, this);
    this.contacts = new Contacts(header, this);
    this.field = null;                          // quantity that colours bodies
    this.range = [0, 1];
    this.shown = { scale: 1, trace: [], joints: true, loads: true, nodes: true, contacts: true,
                   features: true, mesh: false, grid: true, frames: false };
  }

  // Colour by a field of the header; by bodies without one.
  colour(field) {
    this.field = field;
    this.stale();
  }

  // Surfaces are to be computed again.
  stale() { this.deformed.fill(""); }

  // Everything at the time of the motion.
  update() {
    const { motion, bodies, references, shown } = this;
    this.amplitudes = bodies.map((body) => motion.now(body.amplitudes, body.modes));
    this.stills = bodies.map((body, k) => references.still(k, this.amplitudes));
    this.shifts = references.shifts(motion, this.amplitudes, this.stills, shown.scale);
    this.places = bodies.map((body) => motion.placeOf(body));
    this.places.forEach((place, k) => {
      place.origin = add(place.origin, this.shifts.bodies[k]);
    });
    for (const entry of this.entries) {
      for (const k of entry.bodies) {
        this.places[k].visible = entry.visible;
        if (entry.visible) this.surface(k);
      }
    }
  }

  surface(k) {
    const body = this.bodies[k], { motion, shown, field } = this;
    const kind = body.rigid || !field ? "none" : field.name;
    const wanted = body.rigid ? "rigid" : `${motion.frame} ${motion.part} ${shown.scale} ${kind}`;
    if (this.deformed[k] === wanted) return;
    this.deformed[k] = wanted;
    body.values.fill(NOTHING);
    body.deform(this.amplitudes[k], shown.scale, this.stills[k], kind);
    if (kind === "von_mises" && body.stress) body.stresses(motion.frame + motion.part);
    const unit = kind === "displacement" ? this.header.size : kind === "none" ? 1 : field.largest;
    if (body.values[0] > NOTHING) for (let v = 0; v < body.size; v++) body.values[v] *= unit;
    this.renderer.update(this.meshes[k], body);
  }

  // Where a node is drawn.
  place(node) { return add(this.motion.position(node), this.shifts.node(node)); }

  // Where a body is drawn.
  origin(body) { return this.places[body].origin; }

  // Where the name of a body is written: the mean of its parts.
  middle(entry) {
    const points = entry.bodies.map((k) => {
      const { points: x, count: n } = this.bodies[k], { axes, origin } = this.places[k];
      const mean = [0, 1, 2].map((c) => x.subarray(c * n, (c + 1) * n).reduce((a, b) => a + b) / n);
      return add(origin, combine(axes, mean));
    });
    for (const k of entry.links) {
      points.push(...this.header.links[k].ends.map((node) => this.place(node)));
    }
    return times(1 / points.length, points.reduce(add));
  }

  // A vertex of a body in space, as it is drawn.
  vertex(k, v) {
    const { axes, origin } = this.places[k], { vertices } = this.bodies[k];
    return add(origin, combine(axes, vertices.subarray(3 * v, 3 * v + 3)));
  }

  draw(camera) {
    const { renderer, shown, marks } = this;
    renderer.begin(camera, this.map, this.range);
    this.pixels = camera.pixels(renderer.canvas);
    if (shown.grid) renderer.lines(this.grid, { tint: [...rgb("#9aa5b8"), 0.45], width: 1 });
    this.eachBody((body, entry, k) => { if (!body.rigid) this.body(k, entry, 1); });
    for (const link of this.header.links) {
      if (link.kind !== "body") marks.link(link, this.paint.link);
    }
    for (const entry of this.entries.filter((one) => one.visible)) {
      for (const k of entry.links) marks.link(this.header.links[k], entry.paint);
    }
    marks.ropes.forEach((rope) => marks.rope(rope));
    for (const node of shown.trace) this.trace(node);
    if (shown.nodes) this.nodes();
    if (shown.joints) marks.signs();
    if (shown.loads) marks.loads();
    if (shown.frames) marks.frames(this.places);
    this.eachBody((body, entry, k) => { if (body.rigid) this.body(k, entry, CLEAR); });
    if (shown.contacts) this.contacts.draw();
  }

  eachBody(act) {
    for (const entry of this.entries.filter((one) => one.visible)) {
      for (const k of entry.bodies) act(this.bodies[k], entry, k);
    }
  }

  body(k, entry, alpha) {
    const { axes, origin } = this.places[k], matrix = placed(axes, origin);
    const body = this.bodies[k], plain = this.field ? this.paint.without_value : entry.paint;
    this.renderer.draw(this.meshes[k], matrix, plain, alpha);
    const lines = (edges, tint, width) => this.renderer.lines(
      this.along(body, edges), { tint: [...rgb(INK), tint], width, lift: 2e-5, matrix });
    if (this.shown.mesh) lines(body.edges, 0.4, 1);
    // on thin bodies edges would be all that is seen
    const seen = body.thickness ? Math.min(body.thickness * this.pixels / THICK, 1) : 1;
    if (this.shown.features) lines(body.features, 0.75 * seen, 1.2);
  }

  along(body, edges) {
    const points = new Float32Array(3 * edges.length);
    edges.forEach((v, k) => points.set(body.vertices.subarray(3 * v, 3 * v + 3), 3 * k));
    return points;
  }

  nodes() {
    const size = 0.36 * this.header.sign, axes = IDENTITY.map((axis) => times(size, axis));
    const draw = (alpha) => this.motion.nodes.forEach((node, k) => {
      if (node.ground) return;
      const matrix = placed(axes, this.place(k));
      this.renderer.draw(this.marks.shapes.sphere, matrix, rgb(INK), alpha);
    });
    draw(1);
    this.renderer.behind(() => draw(0.5));
  }

  trace(node) {
    const { motion } = this, path = motion.nodes[node].position, now = motion.position(node);
    this.renderer.lines(path, { tint: [...rgb(TO_COME), 1], width: 1.2, joined: true });
    const passed = new Float32Array(3 * (motion.frame + 2));
    passed.set(path.subarray(0, 3 * (motion.frame + 1)));
    passed.set(now, passed.length - 3);
    this.renderer.lines(passed, { tint: [...rgb(TRACE), 1], width: 1.8, joined: true,
                                  lift: 1e-4 });
  }
}

function gridLines({ middle, normal, half, spacing }) {
  const first = across(normal), second = cross(normal, first), points = [];
  const count = Math.round(half / spacing);
  for (let k = -count; k <= count; k++) {
    for (const [one, other] of [[first, second], [second, first]]) {
      const at = add(middle, times(k * spacing, one)), way = times(count * spacing, other);
      points.push(...subtract(at, way), ...add(at, way));
    }
  }
  return new Float32Array(points);
}
