// Meshes of unit size along the first axis, for links and signs: vertices with their normals.

function lathe(profile, around) {
  // `profile`: rows [x, radius, normal along x, normal outwards]
  const vertices = [], normals = [], triangles = [];
  for (const [x, radius, along, out] of profile) {
    for (let k = 0; k <= around; k++) {
      const c = Math.cos(2 * Math.PI * k / around), s = Math.sin(2 * Math.PI * k / around);
      vertices.push(x, radius * c, radius * s);
      normals.push(along, out * c, out * s);
    }
  }
  for (let row = 0; row + 1 < profile.length; row++) {
    for (let k = 0; k < around; k++) {
      const a = row * (around + 1) + k, b = a + around + 1;
      triangles.push(a, a + 1, b, a + 1, b + 1, b);
    }
  }
  return { vertices, normals, triangles };
}

const cylinder = () => lathe([[-1, 0, -1, 0], [-1, 1, -1, 0], [-1, 1, 0, 1], [1, 1, 0, 1],
                              [1, 1, 1, 0], [1, 0, 1, 0]], 24);
const cone = () => lathe([[-1, 0, -1, 0], [-1, 1, -1, 0], [-1, 1, 0.45, 0.89],
                          [1, 0, 0.45, 0.89]], 24);

function sphere() {
  const profile = [];
  for (let k = 0; k <= 12; k++) {
    const angle = Math.PI * (k / 12 - 0.5);
    profile.push([Math.sin(angle), Math.cos(angle), Math.sin(angle), Math.cos(angle)]);
  }
  return lathe(profile, 24);
}

function ring() {
  const profile = [];
  for (let k = 0; k <= 12; k++) {
    const angle = 2 * Math.PI * k / 12;
    profile.push([0.3 * Math.sin(angle), 1 + 0.3 * Math.cos(angle), Math.sin(angle),
                  Math.cos(angle)]);
  }
  return lathe(profile, 32);
}

function cube() {
  const found = { vertices: [], normals: [], triangles: [] };
  for (let axis = 0; axis < 3; axis++) {
    for (const side of [-1, 1]) {
      const first = found.vertices.length / 3;
      for (const [p, q] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const corner = [0, 0, 0], normal = [0, 0, 0];
        corner[axis] = normal[axis] = side;
        corner[(axis + 1) % 3] = p;
        corner[(axis + 2) % 3] = q;
        found.vertices.push(...corner);
        found.normals.push(...normal);
      }
      found.triangles.push(first, first + 1, first + 2, first, first + 2, first + 3);
    }
  }
  return found;
}

// Three quarters of a ring about the first axis, with the head of an arrow.
function turn() {
  const steps = 36, around = 10, end = 1.5 * Math.PI, thick = 0.075;
  const found = { vertices: [], normals: [], triangles: [] };
  const row = (angle, radius, lean) => {
    const c = Math.cos(angle), s = Math.sin(angle);
    for (let k = 0; k <= around; k++) {
      const p = Math.cos(2 * Math.PI * k / around), q = Math.sin(2 * Math.PI * k / around);
      found.vertices.push(radius * q, c * (1 + radius * p), s * (1 + radius * p));
      found.normals.push(q, c * p - lean * s, s * p + lean * c);
    }
  };
  for (let k = 0; k <= steps; k++) row(end * k / steps, thick, 0);
  row(end, 3.4 * thick, -1);
  row(end, 3.4 * thick, 0.4);
  row(end + 0.5, 0, 0.4);
  for (let r = 0; r < steps + 3; r++) {
    for (let k = 0; k < around; k++) {
      const a = r * (around + 1) + k, b = a + around + 1;
      found.triangles.push(a, a + 1, b, a + 1, b + 1, b);
    }
  }
  return found;
}

const SHAPES = { cylinder, cone, sphere, ring, cube, turn };

// What a sign is made of: rows [shape, [half length, half widths], direction of its first axis].
const SIGNS = {
  revolute: [["cylinder", [1.5, 0.55, 0.55], 0]],
  cylindrical: [["cylinder", [2.6, 0.35, 0.35], 0], ["cylinder", [1.0, 0.65, 0.65], 0]],
  prismatic: [["cube", [1.7, 0.6, 0.6], 0]],
  slider: [["cube", [1.3, 0.6, 0.6], 0]],
  path: [["sphere", [0.9, 0.9, 0.9], 0]],
  universal: [["cylinder", [1.3, 0.3, 0.3], 0], ["cylinder", [1.3, 0.3, 0.3], 1],
              ["sphere", [0.6, 0.6, 0.6], 0]],
  spherical: [["sphere", [0.8, 0.8, 0.8], 0]],
  planar: [["cylinder", [0.12, 1.8, 1.8], 0]],
  coupling: [["ring", [0.8, 0.8, 0.8], 0], ["ring", [0.8, 0.8, 0.8], 1]],
  weld: [["cube", [0.6, 0.6, 0.6], 0]],
  drive: [["ring", [1.1, 1.1, 1.1], 0]],
  mass: [["sphere", [1.1, 1.1, 1.1], 0]],
  ground: [["cone", [-1.1, 1.3, 1.3], "up"]],
};
