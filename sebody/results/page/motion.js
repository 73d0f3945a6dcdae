// The model at any time: between two frames places, amplitudes and quaternions are interpolated.

class Motion {
  constructor(header, numbers) {
    this.t = numbers.values(header.t);
    this.bodies = header.bodies.map((body) => ({
      ...body,
      points: numbers.values(body.points), moves: numbers.values(body.moves),
      turns: body.turns && numbers.values(body.turns),
      stations: numbers.indices(body.stations),
      offsets: body.offsets && numbers.values(body.offsets),
      triangles: numbers.indices(body.triangles), edges: numbers.indices(body.edges),
      origin: numbers.values(body.origin), rotation: numbers.values(body.rotation),
      amplitudes: numbers.values(body.amplitudes),
      stress: body.stress && numbers.colours(body.stress),
    }));
    this.nodes = header.nodes.map((node) => ({
      ...node, position: numbers.values(node.position),
      rotation: node.rotation && numbers.values(node.rotation),
    }));
    this.frame = 0;
    this.part = 0;
  }

  get start() { return this.t[0]; }
  get end() { return this.t[this.t.length - 1]; }

  // Go to a time: the frame before it, and the part of the way to the next one.
  seek(time) {
    const t = this.t, last = t.length - 2;
    let low = 0, high = last;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (t[middle] <= time) low = middle; else high = middle - 1;
    }
    this.frame = low;
    this.part = Math.min(Math.max((time - t[low]) / (t[low + 1] - t[low]), 0), 1);
  }

  // A row of a history of `size` numbers a frame, now.
  now(history, size) {
    const first = size * this.frame, found = new Array(size);
    for (let k = 0; k < size; k++) {
      const a = history[first + k], b = history[first + size + k];
      found[k] = a + this.part * (b - a);
    }
    return found;
  }

  turned(history) {
    if (!history) return [0, 0, 0, 1];
    const first = 4 * this.frame;
    let inner = 0;
    for (let k = 0; k < 4; k++) inner += history[first + k] * history[first + 4 + k];
    const sign = inner < 0 ? -1 : 1, found = [0, 0, 0, 0];
    for (let k = 0; k < 4; k++) {
      found[k] = (1 - this.part) * history[first + k] + this.part * sign * history[first + 4 + k];
    }
    const size = Math.hypot(...found) || 1;
    return found.map((value) => value / size);
  }

  position(node) { return this.now(this.nodes[node].position, 3); }
  axes(node) { return columns(this.turned(this.nodes[node].rotation)); }
  placeOf(body) {
    return { origin: this.now(body.origin, 3), axes: columns(this.turned(body.rotation)) };
  }

  // Vertices of a body in its own axes, deformed `scale` times as much as it is; the length of the
  // true displacement, or the stress, goes to `colours`.
  deform(body, scale, vertices, colours, kind) {
    const modes = body.modes_count;
    const a = modes ? this.now(body.amplitudes, modes) : [];
    const count = body.points.length / 3;
    const u = new Float32Array(3 * count), theta = body.turns && new Float32Array(3 * count);
    for (let i = 0; i < 3 * count; i++) {
      let move = 0, turn = 0;
      const first = i * modes;
      for (let k = 0; k < modes; k++) move += a[k] * body.moves[first + k];
      u[i] = move;
      if (theta) {
        for (let k = 0; k < modes; k++) turn += a[k] * body.turns[first + k];
        theta[i] = scale * turn;
      }
    }
    const places = body.stations, p = body.points;
    for (let v = 0; v < places.length; v++) {
      const i = 3 * places[v];
      let x = p[i] + scale * u[i], y = p[i + 1] + scale * u[i + 1], z = p[i + 2] + scale * u[i + 2];
      if (body.offsets) {
        const turned = theta ? spun(theta, i, body.offsets, 3 * v) :
          body.offsets.subarray(3 * v, 3 * v + 3);
        x += turned[0]; y += turned[1]; z += turned[2];
      }
      vertices[3 * v] = x; vertices[3 * v + 1] = y; vertices[3 * v + 2] = z;
      if (kind === "displacement") colours[v] = Math.hypot(u[i], u[i + 1], u[i + 2]);
    }
    if (kind === "stress") this.stresses(body, colours);
    else if (kind === "none") colours.fill(-1);
  }

  // Stress of von Mises at the vertices, from 0 to 1; it is known in some of the frames.
  stresses(body, colours) {
    if (!body.stress) { colours.fill(-1); return; }
    const count = body.points.length / 3, rows = body.stress.length / count;
    const stride = Math.ceil((this.t.length) / rows);
    const at = Math.min((this.frame + this.part) / stride, rows - 1);
    const row = Math.min(Math.floor(at), Math.max(rows - 2, 0)), part = at - row;
    const next = rows > 1 ? count : 0;
    for (let v = 0; v < body.stations.length; v++) {
      const k = row * count + body.stations[v];
      colours[v] = ((1 - part) * body.stress[k] + part * body.stress[k + next]) / 255;
    }
  }
}

// An offset rotated by a rotation vector (Rodrigues).
function spun(theta, i, offsets, j) {
  const x = theta[i], y = theta[i + 1], z = theta[i + 2];
  const a = offsets[j], b = offsets[j + 1], c = offsets[j + 2];
  const angle = Math.hypot(x, y, z);
  const s = angle > 1e-6 ? Math.sin(angle) / angle : 1;
  const h = angle > 1e-6 ? (1 - Math.cos(angle)) / (angle * angle) : 0.5;
  const p = y * c - z * b, q = z * a - x * c, r = x * b - y * a;
  return [a + s * p + h * (y * r - z * q), b + s * q + h * (z * p - x * r),
          c + s * r + h * (x * q - y * p)];
}
