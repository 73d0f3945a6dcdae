// Bodies: surfaces whose stations move by amplitudes, and what they are coloured by.
//
// The undeformed body that displacements are measured from is at `E X + shift` in the axes of the
// body, see references.js.

const NOTHING = -1e30;          // value of a vertex without one

class Body {
  constructor(described, numbers, size) {
    Object.assign(this, described);
    this.length = 1 / size;                     // unit of length, of which amplitudes are
    for (const name of ["points", "moves", "turns", "weights", "offsets", "origin", "rotation",
                        "amplitudes", "stress"]) {
      if (this[name]) this[name] = numbers.values(this[name]);
    }
    for (const name of ["starts", "stations", "triangles", "edges", "features", "labels"]) {
      if (this[name]) this[name] = numbers.indices(this[name]);
    }
    this.count = this.points.length / 3;        // of stations
    this.size = this.starts.length - 1;         // vertices
    this.vertices = new Float32Array(3 * this.size);
    this.normals = new Float32Array(3 * this.size);
    this.values = new Float32Array(this.size).fill(NOTHING);
  }

  // Displacements of the stations in the axes of the body, all x before all y before all z.
  moved(a) { return this.combined(this.moves, a); }

  combined(shapes, a) {
    const found = new Float64Array(3 * this.count), modes = this.modes;
    for (let i = 0; i < found.length; i++) {
      let sum = 0;
      for (let k = 0, at = i * modes; k < modes; k++) sum += a[k] * shapes[at + k];
      found[i] = sum;
    }
    return found;
  }

  // Where a node is in the axes of the body, and the rotation of the body there.
  at(node, a) {
    const of = (column) => (column < 0 ? 0 : a[column]);
    return { place: add(node.point, times(this.length, node.position.map(of))),
             E: rotation(node.rotation.map(of)) };
  }

  // Displacements of the stations from the undeformed body, of those in the axes of the body.
  relative(moved, still) {
    if (!still) return moved;
    const u = moved.slice(), n = this.count, x = this.points;
    const [c0, c1, c2] = still.E;
    for (let i = 0; i < n; i++) {
      const px = x[i], py = x[n + i], pz = x[2 * n + i];
      u[i] += px - (c0[0] * px + c1[0] * py + c2[0] * pz + still.shift[0]);
      u[n + i] += py - (c0[1] * px + c1[1] * py + c2[1] * pz + still.shift[1]);
      u[2 * n + i] += pz - (c0[2] * px + c1[2] * py + c2[2] * pz + still.shift[2]);
    }
    return u;
  }

  // Set the vertices in the axes of the body, deformed `scale` times as much as it is; values are
  // the lengths of displacements with kind "displacement".
  deform(a, scale, still, kind) {
    const n = this.count, base = this.moved(a), u = this.relative(base, still);
    const place = new Float64Array(3 * n);
    // x + moved = undeformed + relative
    for (let i = 0; i < 3 * n; i++) place[i] = this.points[i] + base[i] + (scale - 1) * u[i];
    const turn = this.turns && this.turned(a, scale, still);
    const { starts, stations, weights, vertices, values, offsets, size } = this;
    for (let v = 0; v < size; v++) {
      let x = 0, y = 0, z = 0, ux = 0, uy = 0, uz = 0;
      for (let k = starts[v]; k < starts[v + 1]; k++) {
        const i = stations[k], w = weights[k];
        x += w * place[i]; y += w * place[n + i]; z += w * place[2 * n + i];
        ux += w * u[i]; uy += w * u[n + i]; uz += w * u[2 * n + i];
      }
      if (offsets) {
        const own = [offsets[v], offsets[size + v], offsets[2 * size + v]];
        const [p, q, r] = turn ? turn(stations[starts[v]], own) : own;
        x += p; y += q; z += r;
      }
      vertices[3 * v] = x; vertices[3 * v + 1] = y; vertices[3 * v + 2] = z;
      if (kind === "displacement") values[v] = Math.hypot(ux, uy, uz);
    }
    this.turnNormals();
  }

  // Normals of the vertices: means over the triangles around them by area.
  turnNormals() {
    const { vertices: p, triangles, normals } = this;
    normals.fill(0);
    for (let k = 0; k < triangles.length; k += 3) {
      const a = 3 * triangles[k], b = 3 * triangles[k + 1], c = 3 * triangles[k + 2];
      const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      for (const at of [a, b, c]) {
        normals[at] += x; normals[at + 1] += y; normals[at + 2] += z;
      }
    }
  }

  // Function that turns an offset with a station, by `scale` times the rotation in the body.
  turned(a, scale, still) {
    const n = this.count, theta = this.combined(this.turns, a), known = new Array(n);
    const E = still ? still.E : IDENTITY, back = transposed(E);
    const axes = (i) => {
      const whole = rotation([theta[i], theta[n + i], theta[2 * n + i]]);
      if (scale === 1) return whole;
      return matrixTimes(E, rotation(times(scale, vectorOf(matrixTimes(back, whole)))));
    };
    return (i, offset) => combine(known[i] || (known[i] = axes(i)), offset);
  }

  // Set the values to stresses of a frame, in parts of the largest; they are known in some frames.
  stresses(frame) {
    const row = Math.min(Math.round(frame / this.stride), this.stress.length / this.count - 1);
    const first = row * this.count;
    for (let v = 0; v < this.size; v++) {
      let sum = 0;
      for (let k = this.starts[v]; k < this.starts[v + 1]; k++) {
        sum += this.weights[k] * this.stress[first + this.stations[k]];
      }
      this.values[v] = Math.max(sum, 0);
    }
  }

  // Label of the FE node at a vertex or next to it; 0 between two nodes.
  label(vertex) {
    if (!this.labels) return 0;
    let best = this.starts[vertex];
    for (let k = best; k < this.starts[vertex + 1]; k++) {
      if (this.weights[k] > this.weights[best]) best = k;
    }
    return this.labels[this.stations[best]];
  }
}
