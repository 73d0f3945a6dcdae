// The model as it is drawn at a time.

const COLOURS = ["#4c78a8", "#e4873f", "#5a9e6f", "#b65d7c", "#8a6fb0", "#c8a23c", "#4aa3a8",
                 "#9c755f"];
const SIGN_COLOURS = { ground: "#5b6478", drive: "#c8452d", mass: "#39455f" };
const JOINT = "#39455f", ROD = "#8d97aa", SPRING = "#2a7f62", TRACE = "#c8452d", TO_COME = "#e6b3a6";
const AXES = ["#c8452d", "#2a7f62", "#3566b8"];
const MAP = ["#5b7db8", "#5f9fc6", "#6dbfb8", "#8fd0a0", "#bfd987", "#ecd06f", "#f2a65a", "#e6704a",
             "#c8352d"];            // from small to large values
const COILS = 7;

const rgb = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16) / 255);

class Scene {
  constructor(header, motion, renderer, labels) {
    this.header = header;
    this.motion = motion;
    this.renderer = renderer;
    this.labels = labels;
    this.map = new Float32Array(MAP.flatMap(rgb));
    this.shapes = {};
    for (const name of Object.keys(SHAPES)) this.shapes[name] = renderer.mesh(SHAPES[name]());
    this.drawn = motion.bodies.map((body, k) => this.surface(body, k));
    this.up = unit(header.view.up);
    this.grid = gridLines(header.view.floor);
    this.shown = { scale: 1, colour: "none", trace: [], joints: true, nodes: true, names: false,
                   frames: false, mesh: false, ground: true };
  }

  surface(body, number) {
    const count = body.stations.length;
    const vertices = new Float32Array(3 * count), values = new Float32Array(count).fill(-1);
    return { body, vertices, values, colour: rgb(COLOURS[number % COLOURS.length]),
             mesh: this.renderer.mesh({ vertices, values, triangles: body.triangles }),
             deformed: "" };
  }

  draw(camera) {
    const { renderer, shown, motion } = this;
    renderer.begin(camera, this.map);
    if (shown.ground) {
      renderer.lines(this.grid, { tint: [...rgb("#9aa5b8"), 0.45], width: 1 });
    }
    const places = motion.bodies.map((body) => motion.placeOf(body));
    this.drawn.forEach((one, k) => this.drawBody(one, places[k]));
    for (const link of this.header.links) this.drawLink(link);
    if (shown.joints) for (const sign of this.header.signs) this.drawSign(sign);
    if (shown.nodes) this.drawNodes();
    if (shown.frames) this.drawFrames(places);
    for (const node of shown.trace) this.drawTrace(node);
    this.drawNames();
  }

  drawBody(one, place) {
    const { renderer, shown, motion } = this, { body } = one;
    const kind = body.modes_count ? shown.colour : "none";
    const wanted = body.modes_count ? `${motion.frame} ${motion.part} ${shown.scale} ${kind}`
                                    : "rigid";
    if (one.deformed !== wanted) {
      motion.deform(body, shown.scale, one.vertices, one.values, kind);
      const most = kind === "displacement" && this.header.largest.displacement;
      if (most) for (let k = 0; k < one.values.length; k++) one.values[k] /= most;
      renderer.update(one.mesh, one.vertices, one.values);
      one.deformed = wanted;
    }
    renderer.draw(one.mesh, placed(place.axes, place.origin), one.colour);
    if (shown.mesh) this.drawMesh(one, place);
  }

  drawMesh(one, place) {
    const edges = one.body.edges.length ? one.body.edges : trianglesEdges(one.body.triangles);
    const points = new Float32Array(3 * edges.length);
    edges.forEach((vertex, k) => {
      const local = one.vertices.subarray(3 * vertex, 3 * vertex + 3);
      points.set(add(place.origin, combine(place.axes, local)), 3 * k);
    });
    this.renderer.lines(points, { tint: [...rgb("#1f2a44"), 0.55], width: 1, lift: 2e-5 });
  }

  drawLink(link) {
    const a = this.motion.position(link.ends[0]), b = this.motion.position(link.ends[1]);
    if (link.kind === "spring") {
      this.renderer.lines(coil(a, b, this.header.sign), { tint: [...rgb(SPRING), 1], width: 2,
                                                          joined: true });
      return;
    }
    const half = times(0.5, subtract(b, a)), size = length(half);
    if (!(size > 0)) return;
    const side = across(half), width = this.header.sign * (link.kind === "distance" ? 0.2 : 0.38);
    const axes = [half, times(width, side), times(width, unit(cross(half, side)))];
    const colour = link.kind === "body" ? COLOURS[0] : ROD;
    this.renderer.draw(this.shapes.cylinder, placed(axes, add(a, half)), rgb(colour));
  }

  drawSign(sign) {
    const origin = this.motion.position(sign.node), own = this.motion.axes(sign.carrier);
    const axes = sign.axes.map((column) => combine(own, column));
    const colour = rgb(SIGN_COLOURS[sign.kind] || JOINT);
    for (const [shape, sizes, first] of SIGNS[sign.kind] || []) {
      let columns = axes, at = origin;
      if (first === "up") {
        const side = across(this.up);
        columns = [times(-1, this.up), side, cross(side, this.up)];
        at = add(origin, times(-1.1 * this.header.sign, this.up));
      } else if (first === 1) {
        columns = [axes[1], axes[2], axes[0]];
      }
      const scaled = columns.map((column, k) => times(this.header.sign * sizes[k], column));
      this.renderer.draw(this.shapes[shape], placed(scaled, at), colour);
    }
  }

  drawNodes() {
    const size = 0.42 * this.header.sign, axes = [[size, 0, 0], [0, size, 0], [0, 0, size]];
    this.motion.nodes.forEach((node, k) => {
      if (node.ground) return;
      this.renderer.draw(this.shapes.sphere, placed(axes, this.motion.position(k)), rgb("#1f2a44"));
    });
  }

  drawFrames(places) {
    const all = places.filter((_, k) => this.motion.bodies[k].modes_count);
    this.motion.nodes.forEach((node, k) => {
      if (node.rotation) {
        all.push({ origin: this.motion.position(k), axes: this.motion.axes(k) });
      }
    });
    for (let axis = 0; axis < 3; axis++) {
      const points = all.flatMap(({ origin, axes }) => [
        ...origin, ...add(origin, times(5 * this.header.sign, axes[axis]))]);
      this.renderer.lines(new Float32Array(points), { tint: [...rgb(AXES[axis]), 1], width: 2.5 });
    }
  }

  drawTrace(node) {
    const path = this.motion.nodes[node].position, now = this.motion.position(node);
    this.renderer.lines(path, { tint: [...rgb(TO_COME), 1], width: 1.2, joined: true });
    const passed = new Float32Array(3 * (this.motion.frame + 2));
    passed.set(path.subarray(0, 3 * (this.motion.frame + 1)));
    passed.set(now, passed.length - 3);
    this.renderer.lines(passed, { tint: [...rgb(TRACE), 1], width: 2, joined: true,
                                   lift: 1e-4 });
  }

  drawNames() {
    const canvas = this.labels, ratio = this.renderer.ratio;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    const brush = canvas.getContext("2d");
    brush.scale(ratio, ratio);
    if (!this.shown.names) return;
    brush.font = "13px system-ui, sans-serif";
    brush.lineWidth = 3;
    brush.strokeStyle = "rgba(255, 255, 255, 0.85)";
    brush.fillStyle = "#1f2a44";
    const taken = [];
    this.motion.nodes.forEach((node, k) => {
      const at = node.ground ? null : this.renderer.pixel(this.motion.position(k));
      if (!at || taken.some((other) => Math.abs(other[0] - at[0]) < 70
                                       && Math.abs(other[1] - at[1]) < 15)) return;
      taken.push(at);
      brush.strokeText(node.name, at[0] + 9, at[1] - 7);
      brush.fillText(node.name, at[0] + 9, at[1] - 7);
    });
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

function coil(a, b, size) {
  const way = subtract(b, a), side = across(way), other = unit(cross(way, side));
  const points = [...a], steps = 16 * COILS;
  for (let k = 0; k <= steps; k++) {
    const angle = 2 * Math.PI * k / 16, part = 0.12 + 0.76 * k / steps;
    points.push(...add(add(a, times(part, way)),
                       add(times(0.9 * size * Math.cos(angle), side),
                           times(0.9 * size * Math.sin(angle), other))));
  }
  points.push(...b);
  return new Float32Array(points);
}

function trianglesEdges(triangles) {
  const found = [];
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = [triangles[k], triangles[k + 1], triangles[k + 2]];
    found.push(a, b, b, c, c, a);
  }
  return found;
}
