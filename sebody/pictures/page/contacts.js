// Contact surfaces, balls that touch them, and limits of stops: lines, and skins that hide nothing.

const SKIN = 0.14, OUTLINE = 0.8, OUTLINE_BEHIND = 0.2;     // opacities

class Contacts {
  constructor(header, scene) {
    const { numbers, renderer } = scene;
    this.scene = scene;
    this.all = header.contacts.map((one) => {
      const points = numbers.values(one.points), triangles = numbers.indices(one.triangles);
      const lines = new Float32Array(Array.from(numbers.indices(one.lines)).flatMap(
        (k) => [...points.subarray(3 * k, 3 * k + 3)]));
      return { ...one, points, lines, mesh: triangles.length ? renderer.mesh(
        { vertices: points, normals: normalsOf(points, triangles), triangles }) : null };
    });
  }

  // Axes and origin of a surface; those of the ground are in space.
  placeOf({ node }) {
    return node === null ? { axes: IDENTITY, origin: [0, 0, 0] }
      : { axes: this.scene.motion.axes(node), origin: this.scene.place(node) };
  }

  draw() {
    const { renderer, paint } = this.scene;
    const outlines = (alpha) => {
      for (const one of this.all) {
        const { axes, origin } = this.placeOf(one);
        renderer.lines(one.lines, { tint: [...paint.contact, alpha], lift: 1e-5,
                                    width: one.kind === "pointer" ? 2.5 : 1.4,
                                    matrix: placed(axes, origin) });
      }
    };
    outlines(OUTLINE);
    renderer.behind(() => outlines(OUTLINE_BEHIND));
    for (const one of this.all.filter(({ mesh }) => mesh)) {
      const { axes, origin } = this.placeOf(one);
      renderer.draw(one.mesh, placed(axes, origin), paint.contact, SKIN);
    }
  }
}

// A normal at each point, that of a triangle there; light takes no account of its side.
function normalsOf(points, triangles) {
  const found = new Float32Array(points.length), at = (k) => points.subarray(3 * k, 3 * k + 3);
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = triangles.subarray(k, k + 3);
    const normal = cross(subtract(at(b), at(a)), subtract(at(c), at(a)));
    if (length(normal) > 0) for (const v of [a, b, c]) found.set(unit(normal), 3 * v);
  }
  return found;
}
