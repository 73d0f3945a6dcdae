// Where displacements are measured from: the undeformed body that moves with a chosen node, or with
// the chord between two of them, which is a pair.
//
// Bodies that are welded together share a reference: seen from a body that does not have the node,
// it is carried from body to body by the nodes that they have in common.

class References {
  constructor(bodies, nodes) {
    this.bodies = bodies;
    this.nodes = nodes;
    this.given = bodies.map((body) => body.reference);
    this.choose("default");
  }

  // Measure from a node, from the floating frames ("frame"), or as the page was made ("default");
  // bodies that are not welded to the node keep what they were made with.
  choose(reference) {
    this.ways = this.bodies.map((body, k) => {
      if (body.rigid || reference === "frame") return null;
      const chosen = reference === "default" ? null : this.way(k, reference);
      return chosen || (this.given[k] === null ? null : this.way(k, this.given[k]));
    });
    this.order = this.ordered();
  }

  // How the motion of a node comes to a body: the body that has it, and shared nodes on the way.
  way(start, node) {
    if (Array.isArray(node)) {
      const [way, other] = node.map((one) => this.way(start, one));
      return way && other ? { ...way, other } : null;
    }
    const from = new Map([[start, null]]), queue = [start];
    for (const k of queue) {
      const own = this.bodies[k].held.find((held) => held.node === node);
      if (own && (own.full || k === start)) return this.steps(k, own, from);
      for (const held of this.bodies[k].held.filter((one) => one.full)) {
        this.bodies.forEach((other, j) => {
          const shared = !from.has(j) && !other.rigid && other.held.find(
            (one) => one.full && this.cluster(one) === this.cluster(held));
          if (shared) { from.set(j, { body: k, here: held, there: shared }); queue.push(j); }
        });
      }
    }
    return null;
  }

  cluster(held) { return this.nodes[held.node].cluster; }

  steps(owner, own, from) {
    const steps = [];
    for (let k = owner; from.get(k); k = from.get(k).body) steps.push({ ...from.get(k), other: k });
    return { owner, own, steps };
  }

  // The undeformed body of a reference now: `E X + shift` in the axes of the body; null for itself.
  still(k, amplitudes) {
    const way = this.ways[k];
    if (!way) return null;
    const found = this.carried(way, amplitudes);
    return way.other ? this.onChord(k, way, found, this.carried(way.other, amplitudes)) : found;
  }

  // The same on the chord from the node of one way to that of another, from those at both nodes.
  onChord(k, way, at, other) {
    const [first, second] = [way, way.other].map(({ owner, own }) => subtract(
      add(this.bodies[owner].start, own.point), this.bodies[k].start));
    const place = add(combine(at.E, first), at.shift);
    const chord = subtract(add(combine(other.E, second), other.shift), place);
    const a = unit(combine(at.E, subtract(second, first))), b = unit(chord), axis = cross(a, b);
    const turn = rotation(times(Math.atan2(length(axis), dot(a, b)), unit(axis)));
    const E = matrixTimes(turn, at.E);
    return { E, shift: subtract(place, combine(E, first)) };
  }

  // The undeformed body at the node of a way, in the axes of the body that the way leads to.
  carried(way, amplitudes) {
    const owner = this.bodies[way.owner], { place, E } = owner.at(way.own, amplitudes[way.owner]);
    let found = { E, shift: subtract(place, combine(E, way.own.point)) };
    for (const { body, other, here, there } of way.steps) {
      const b = this.bodies[body], c = this.bodies[other];
      const to = b.at(here, amplitudes[body]), at = c.at(there, amplitudes[other]);
      const turn = matrixTimes(to.E, transposed(at.E));
      const apart = subtract(b.start, c.start);
      const gap = subtract(add(c.start, there.point), add(b.start, here.point));
      const seen = subtract(add(combine(found.E, apart), found.shift), at.place);
      found = { E: matrixTimes(turn, found.E),
                shift: add(add(combine(turn, seen), combine(to.E, gap)), to.place) };
    }
    return found;
  }

  // Bodies in an order in which each comes after the one it hangs on: from fixed places onwards.
  ordered() {
    const known = new Set(this.nodes.filter((node) => node.fixed).map((node) => node.set));
    const left = new Set(this.bodies.keys()), order = [];
    const reference = (k) => {
      const way = this.ways[k];
      if (this.bodies[k].rigid) return this.nodes[this.bodies[k].held[0].node].set;
      return way ? this.nodes[way.own.node].set : null;
    };
    while (left.size) {
      const next = [...left].find((k) => known.has(reference(k))) ?? [...left][0];
      left.delete(next);
      order.push({ body: next, set: reference(next) });
      for (const held of this.bodies[next].held) known.add(this.nodes[held.node].set);
    }
    return order;
  }

  // By how much enlarged deformations move bodies and nodes, besides what they move themselves.
  shifts(motion, amplitudes, stills, scale) {
    const sets = new Map(this.nodes.filter((node) => node.fixed).map((n) => [n.set, [0, 0, 0]]));
    const bodies = new Array(this.bodies.length).fill([0, 0, 0]);
    for (const { body: k, set } of scale === 1 ? [] : this.order) {
      const body = this.bodies[k], own = sets.get(set) || [0, 0, 0];
      bodies[k] = own;
      const { axes } = motion.placeOf(body);
      for (const held of body.rigid ? [] : body.held) {
        const to = this.nodes[held.node].set;
        if (sets.has(to)) continue;
        const { place } = body.at(held, amplitudes[k]), still = stills[k];
        const rest = still ? add(combine(still.E, held.point), still.shift) : held.point;
        sets.set(to, add(own, times(scale - 1, combine(axes, subtract(place, rest)))));
      }
    }
    return { bodies, node: (k) => sets.get(this.nodes[k].set) || [0, 0, 0] };
  }
}
