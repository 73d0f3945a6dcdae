// What stands for links, joints, supports, loads and the axes of nodes.

const COILS = 7;
const LONGEST = 14;             // of an arrow, of the size of signs

class Marks {
  constructor(header, scene) {
    this.header = header;
    this.scene = scene;
    this.renderer = scene.renderer;
    this.shapes = {};
    for (const name of Object.keys(SHAPES)) this.shapes[name] = this.renderer.mesh(SHAPES[name]());
    this.arrows = header.arrows.map((arrow) => ({
      ...arrow, values: scene.numbers.values(arrow.values) }));
    this.ropes = header.ropes.map((rope) => ({
      ...rope, points: scene.numbers.values(rope.points),
      slack: scene.numbers.values(rope.slack) }));
  }

  link(link, colour) {
    const [a, b] = link.ends.map((node) => this.scene.place(node)), { sign } = this.header;
    if (link.kind === "spring") {
      this.renderer.lines(coil(a, b, sign), { tint: [...this.scene.paint.spring, 1], width: 2,
                                              joined: true });
      return;
    }
    this.rod(a, b, sign * (link.kind === "distance" ? 0.2 : 0.38), colour);
  }

  rod(a, b, width, colour, alpha = 1) {
    const half = times(0.5, subtract(b, a));
    if (!(length(half) > 0)) return;
    const side = across(half);
    const axes = [half, times(width, side), times(width, unit(cross(half, side)))];
    this.renderer.draw(this.shapes.cylinder, placed(axes, add(a, half)), colour, alpha);
  }

  // Ropes by their points, each shifted as the node that it is at; slack ones are pale.
  rope({ nodes, points, slack }) {
    const { motion, paint, shifts } = this.scene, now = motion.now(points, 3 * nodes.length);
    const places = nodes.flatMap((node, k) => add(now.slice(3 * k, 3 * k + 3), shifts.node(node)));
    const colour = motion.now(slack, 1)[0] > 0.5 ? paint.slack : paint.rope;
    this.renderer.lines(new Float32Array(places), { tint: [...colour, 1], width: 2.2,
                                                    joined: true });
  }

  // Signs of joints and supports; faintly also where they are behind something.
  signs() {
    const draw = (alpha) => { for (const sign of this.header.signs) this.sign(sign, alpha); };
    draw(1);
    this.renderer.behind(() => draw(0.3));
  }

  sign(sign, alpha) {
    const origin = this.scene.place(sign.node), own = this.scene.motion.axes(sign.carrier);
    const axes = sign.axes.map((column) => combine(own, column)), size = this.header.sign;
    const { paint, up } = this.scene, colour = paint[sign.kind] || paint.joint;
    for (const [shape, sizes, first] of SIGNS[sign.kind] || []) {
      let columns = axes, at = origin;
      if (first === "up") {
        const side = across(up);
        columns = [times(-1, up), side, cross(side, up)];
        at = add(origin, times(-1.1 * size, up));
      } else if (first === 1) {
        columns = [axes[1], axes[2], axes[0]];
      }
      const scaled = columns.map((column, k) => times(size * sizes[k], column));
      this.renderer.draw(this.shapes[shape], placed(scaled, at), colour, alpha);
    }
  }

  // Arrows of the loads, as long as they are large; torques turn about their axis.
  loads() {
    const draw = (alpha) => {
      for (const arrow of this.arrows) {
        const value = this.scene.motion.now(arrow.values, 3), size = length(value);
        if (size < 0.01) continue;
        const act = arrow.kind === "force" ? this.force : this.torque;
        act.call(this, this.root(arrow), unit(value), size, alpha);
      }
    };
    draw(1);
    this.renderer.behind(() => draw(0.3));
  }

  root(arrow) {
    return arrow.node === null ? this.scene.origin(arrow.body) : this.scene.place(arrow.node);
  }

  force(at, way, size, alpha) {
    const { sign } = this.header, whole = LONGEST * sign * (0.15 + 0.85 * size);
    const head = Math.min(2.2 * sign, 0.5 * whole), side = across(way), other = cross(way, side);
    const colour = this.scene.paint.load;
    this.rod(at, add(at, times(whole - head, way)), 0.28 * sign, colour, alpha);
    const axes = [times(head / 2, way), times(0.34 * head, side), times(0.34 * head, other)];
    this.renderer.draw(this.shapes.cone, placed(axes, add(at, times(whole - head / 2, way))),
                       colour, alpha);
  }

  torque(at, way, size, alpha) {
    const { sign } = this.header, radius = sign * (1.8 + 3.2 * size), side = across(way);
    const axes = [times(radius, way), times(radius, side), times(radius, cross(way, side))];
    this.renderer.draw(this.shapes.turn, placed(axes, at), this.scene.paint.load, alpha);
  }

  // Axes of bodies and nodes.
  frames(places) {
    const { motion, shown } = this.scene, all = places.filter((one) => one.visible);
    motion.nodes.forEach((node, k) => {
      if (node.rotation) all.push({ origin: this.scene.place(k), axes: motion.axes(k) });
    });
    for (let axis = 0; axis < 3 && shown.frames; axis++) {
      const points = all.flatMap(({ origin, axes }) => [
        ...origin, ...add(origin, times(5 * this.header.sign, axes[axis]))]);
      this.renderer.lines(new Float32Array(points), { tint: [...rgb(this.header.palette.axes[axis]), 1], width: 2.5 });
    }
  }
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
