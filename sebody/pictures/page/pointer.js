// What is under the pointer: a node with what acts there, or a body with its value.

const NEAR = 8;             // pixels from a node

class Pointer {
  constructor(canvas, scene, camera, legend) {
    Object.assign(this, { canvas, scene, camera, legend });
    this.at = null;
    canvas.addEventListener("pointermove", (event) => {
      this.at = event.buttons ? null : [event.offsetX, event.offsetY];
      this.show();
    });
    canvas.addEventListener("pointerleave", () => { this.at = null; this.show(); });
  }

  show() {
    const found = this.at && (this.node() || this.surface()), tip = element("tip");
    tip.hidden = !found;
    if (!found) return;
    const [name, ...rest] = found, title = document.createElement("b");
    title.textContent = name;
    tip.replaceChildren(title, ...rest.map((line) => {
      const row = document.createElement("div");
      row.textContent = line;
      return row;
    }));
    const { clientWidth, clientHeight } = this.canvas;
    tip.style.left = `${Math.min(this.at[0] + 14, clientWidth - tip.offsetWidth - 6)}px`;
    tip.style.top = `${Math.min(this.at[1] + 14, clientHeight - tip.offsetHeight - 6)}px`;
  }

  // Name, place, joints and loads of a node that is near.
  node() {
    const { scene } = this, { header, motion } = scene;
    let best = null, least = NEAR;
    motion.nodes.forEach((node, k) => {
      const at = scene.shown.nodes && !node.ground && scene.renderer.pixel(scene.place(k));
      const far = at ? Math.hypot(at[0] - this.at[0], at[1] - this.at[1]) : Infinity;
      if (far < least) { least = far; best = k; }
    });
    if (best === null) return null;
    const place = header.nodes[best].set, there = (node) => header.nodes[node].set === place;
    const joints = header.signs.filter((sign) => there(sign.node) && sign.kind !== "ground");
    const loads = scene.marks.arrows.filter((arrow) => arrow.node === best);
    return [motion.nodes[best].name, this.place(motion.position(best)),
            ...joints.map((sign) => `${sign.kind}: ${sign.name}`),
            ...loads.map((arrow) => `${arrow.kind}: ${arrow.name}, ${digits(
              arrow.largest * length(motion.now(arrow.values, 3)))}`)];
  }

  // Body, value and place of the nearest surface.
  surface() {
    const { scene, canvas } = this, { field, motion } = scene;
    const ray = this.camera.ray(this.at, canvas.clientWidth, canvas.clientHeight);
    let best = null;
    scene.eachBody((body, entry, k) => {
      const found = hit(body, scene.places[k], ray);
      if (found && !(best && best.far < found.far)) best = { ...found, body, entry };
    });
    if (!best) return null;
    const { body, entry, corners, parts } = best, { values } = body;
    const names = [entry.name, body.name].filter((name, k, all) => all.indexOf(name) === k);
    const lines = [names.join(", ")];
    if (field && values[corners[0]] > NOTHING) {
      const value = corners.reduce((sum, v, k) => sum + parts[k] * values[v], 0);
      lines.push(`${field.title} ${digits(value)}`);
    }
    if (!body.rigid) {
      const label = body.label(corners[parts.indexOf(Math.max(...parts))]);
      if (label) lines.push(`near node ${label - 1}`);
    }
    if (scene.shown.scale === 1) {
      lines.push(this.place(add(ray.from, times(best.far, ray.way))));
    }
    return lines;
  }

  place(point) {
    const { header } = this.scene;
    return point.map((value, k) => digits(header.size * value + header.middle[k]))
      .slice(0, header.planar ? 2 : 3).join(", ");
  }
}

// The first triangle of a body that a ray meets: its corners and their parts in the point.
function hit(body, { origin, axes }, ray) {
  const back = transposed(axes), from = combine(back, subtract(ray.from, origin));
  const way = combine(back, ray.way), { vertices: p, triangles } = body;
  let found = null, least = Infinity;
  for (let k = 0; k < triangles.length; k += 3) {
    const a = 3 * triangles[k], b = 3 * triangles[k + 1], c = 3 * triangles[k + 2];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
    const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
    const hx = way[1] * vz - way[2] * vy, hy = way[2] * vx - way[0] * vz,
          hz = way[0] * vy - way[1] * vx;
    const size = ux * hx + uy * hy + uz * hz;
    if (size === 0) continue;
    const sx = from[0] - p[a], sy = from[1] - p[a + 1], sz = from[2] - p[a + 2];
    const u = (sx * hx + sy * hy + sz * hz) / size;
    if (u < 0 || u > 1) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const v = (way[0] * qx + way[1] * qy + way[2] * qz) / size;
    const far = (vx * qx + vy * qy + vz * qz) / size;
    if (v < 0 || u + v > 1 || far <= 0 || far >= least) continue;
    least = far;
    found = { far, corners: [triangles[k], triangles[k + 1], triangles[k + 2]],
              parts: [1 - u - v, u, v] };
  }
  return found;
}
