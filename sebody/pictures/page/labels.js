// What is written over the picture: names, the axes of space with gravity, the largest value.

const HALO = "rgba(255, 255, 255, 0.85)", PALE = "#66718a", FONT = "system-ui, sans-serif";

class Labels {
  constructor(canvas, scene) {
    this.canvas = canvas;
    this.scene = scene;
    this.shown = { nodes: false, bodies: false, axes: true };
  }

  draw(camera, peak) {
    const { canvas } = this, ratio = this.scene.renderer.ratio;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    const brush = this.brush = canvas.getContext("2d");
    brush.scale(ratio, ratio);
    brush.lineJoin = "round";
    this.taken = [];
    if (peak) this.peak(peak);
    if (this.shown.bodies) this.bodies();
    if (this.shown.nodes) this.nodes();
    if (this.shown.axes) this.triad(camera);
  }

  // A text beside a pixel, unless another one is there.
  text(at, words, { font = `13px ${FONT}`, colour = INK, right = 9, down = -7 } = {}) {
    const { brush } = this;
    brush.font = font;
    const width = brush.measureText(words).width, y = at[1] + down;
    const x = Math.min(at[0] + right, this.canvas.clientWidth - width - 4);
    const free = this.taken.every((box) => x > box[1] || x + width < box[0] || y > box[3]
                                           || y - 14 < box[2]);
    if (!free) return;
    this.taken.push([x, x + width, y - 14, y]);
    brush.lineWidth = 3;
    brush.strokeStyle = HALO;
    brush.fillStyle = colour;
    brush.strokeText(words, x, y);
    brush.fillText(words, x, y);
  }

  nodes() {
    this.scene.motion.nodes.forEach((node, k) => {
      const at = node.ground ? null : this.scene.renderer.pixel(this.scene.place(k));
      if (at) this.text(at, node.name);
    });
  }

  bodies() {
    for (const entry of this.scene.entries.filter((one) => one.visible)) {
      const at = this.scene.renderer.pixel(this.scene.middle(entry));
      if (at) this.text(at, entry.name, { font: `600 13px ${FONT}`, colour: PALE, right: 0 });
    }
  }

  // A ring at the largest value, with this value.
  peak({ body, vertex, text }) {
    const at = this.scene.renderer.pixel(this.scene.vertex(body, vertex)), { brush } = this;
    if (!at) return;
    for (const [colour, width] of [[HALO, 4], [INK, 1.6]]) {
      brush.strokeStyle = colour;
      brush.lineWidth = width;
      brush.beginPath();
      brush.arc(at[0], at[1], 5, 0, 2 * Math.PI);
      brush.stroke();
    }
    this.text(at, text, { font: `600 12px ${FONT}`, right: 10, down: 14 });
  }

  // Axes of space in the corner, and the direction of gravity.
  triad(camera) {
    const { canvas, brush } = this, size = canvas.clientWidth < 720 ? 26 : 34;
    const middle = [canvas.clientWidth - size - 26, canvas.clientHeight - size - 22];
    const back = camera.direction(), right = unit(cross(camera.up, back));
    const above = cross(back, right), { gravity, planar, palette } = this.scene.header;
    const arrows = IDENTITY.map((axis, k) => ({ axis, name: "xyz"[k], colour: palette.axes[k] }));
    if (planar) arrows.pop();
    if (gravity) arrows.push({ axis: gravity, name: "g", colour: palette.load });
    arrows.sort((a, b) => dot(a.axis, back) - dot(b.axis, back));
    for (const { axis, name, colour } of arrows) {
      const way = [dot(axis, right), -dot(axis, above)], seen = Math.hypot(...way);
      const tip = middle.map((value, k) => value + size * way[k]);
      brush.strokeStyle = brush.fillStyle = colour;
      brush.lineWidth = 2;
      brush.setLineDash(name === "g" ? [3, 3] : []);
      brush.beginPath();
      brush.moveTo(...middle);
      brush.lineTo(...tip);
      brush.stroke();
      brush.setLineDash([]);
      if (seen > 0.2) this.head(tip, way.map((value) => value / seen));
      brush.font = `600 12px ${FONT}`;
      brush.textAlign = "center";
      brush.textBaseline = "middle";
      const out = seen > 0.2 ? way.map((value) => 11 * value / seen) : [10, -10];
      brush.fillText(name, tip[0] + out[0], tip[1] + out[1]);
      brush.textAlign = "left";
      brush.textBaseline = "alphabetic";
    }
  }

  head(tip, way) {
    const { brush } = this;
    brush.beginPath();
    brush.moveTo(tip[0] + 3 * way[0], tip[1] + 3 * way[1]);
    for (const side of [-1, 1]) {
      brush.lineTo(tip[0] - 5 * way[0] + 3.2 * side * way[1],
                   tip[1] - 5 * way[1] - 3.2 * side * way[0]);
    }
    brush.fill();
  }
}
