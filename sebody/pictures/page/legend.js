// The legend: what colours stand for, in which range, and where the largest value is.

const FRAMES_AT_MOST = 3e7;         // products of numbers that a search for the largest value takes

class Legend {
  constructor(header, scene, changed) {
    this.header = header;
    this.scene = scene;
    this.changed = changed;
    this.peaks = new Map(header.fields.map((field) => [field.name, field.peak]));
    for (const name of ["low", "high"]) {
      element(name).addEventListener("change", () => this.given());
    }
    element("auto").addEventListener("click", () => { this.reset(); this.changed(); });
    element("legend-bar").style.background =
      `linear-gradient(90deg, ${header.palette.map.join(", ")})`;
  }

  // Colour by a field of this name; by bodies if there is none.
  choose(name) {
    this.field = this.header.fields.find((field) => field.name === name) || null;
    this.scene.colour(this.field);
    element("legend").hidden = !this.field;
    if (!this.field) return;
    element("legend-name").textContent = this.field.title;
    element("legend-unit").textContent = this.field.unit && `[${this.field.unit}]`;
    this.reset();
  }

  // Displacements are measured from elsewhere.
  measured(isDefault) {
    const field = this.header.fields.find((one) => one.name === "displacement");
    if (!field) return;
    this.peaks.set("displacement", isDefault ? field.peak : this.search());
    if (this.field === field) this.reset();
  }

  peak() { return this.peaks.get(this.field.name); }

  reset() { this.set(0, this.peak().value); }

  given() {
    const [low, high] = ["low", "high"].map((name) => Number(element(name).value));
    if (Number.isFinite(low) && Number.isFinite(high) && high > low) this.set(low, high);
    else this.set(...this.scene.range);
    this.changed();
  }

  set(low, high) {
    if (!(high > low)) high = low + 1;
    this.scene.range = [low, high];
    element("low").value = short(Number(low.toPrecision(4)));
    element("high").value = short(Number(high.toPrecision(4)));
    const marks = ticks(low, high, 4).map((value) => {
      const mark = document.createElement("span");
      mark.textContent = short(value);
      mark.style.left = `${100 * (value - low) / (high - low)}%`;
      return mark;
    });
    element("legend-ticks").replaceChildren(...marks);
    const { value, frame, body, station } = this.peak();
    element("peak").textContent = `largest ${digits(value)} at t = `
      + `${digits(this.scene.motion.t[frame])}, ${this.where(body, station)}`;
  }

  // The largest value that is seen now: its body and vertex.
  now() {
    if (!this.field) return null;
    let found = null, most = 0;
    this.scene.eachBody((body, entry, k) => {
      const { values } = body;
      for (let v = 0; v < values.length; v++) {
        if (values[v] > most) { most = values[v]; found = { body: k, vertex: v }; }
      }
    });
    element("now-largest").textContent = found
      ? `now ${digits(most)}, ${this.where(found.body, null, found.vertex)}` : "";
    return found && { ...found, text: digits(most) };
  }

  where(k, station, vertex) {
    const body = this.scene.bodies[k];
    const label = station === null ? body.label(vertex) : body.labels[station];
    return label ? `node ${label - 1} of ${body.name}` : body.name;
  }

  // The largest displacement in some frames.
  search() {
    const { bodies, references, motion } = this.scene, kept = [motion.frame, motion.part];
    const products = bodies.reduce((sum, body) => sum + 3 * body.count * body.modes, 0);
    const frames = motion.t.length;
    const stride = Math.max(1, Math.ceil(frames * products / FRAMES_AT_MOST));
    let found = { value: 0, frame: 0, body: 0, station: 0 };
    for (let frame = 0; frame < frames; frame += stride) {
      [motion.frame, motion.part] = frame < frames - 1 ? [frame, 0] : [frame - 1, 1];
      const amplitudes = bodies.map((body) => motion.now(body.amplitudes, body.modes));
      bodies.forEach((body, k) => {
        if (body.rigid) return;
        const u = body.relative(body.moved(amplitudes[k]), references.still(k, amplitudes));
        for (let i = 0, n = body.count; i < n; i++) {
          const value = this.header.size * Math.hypot(u[i], u[n + i], u[2 * n + i]);
          if (value > found.value) found = { value, frame, body: k, station: i };
        }
      });
    }
    [motion.frame, motion.part] = kept;
    return found;
  }
}
