// The page: what its controls do.

const element = (name) => document.getElementById(name);
const SPEEDS = [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20];
const DISPLAYED_SCALES = 20;        // steps of the slider for each factor of ten

function fill(select, options, chosen) {
  select.replaceChildren(...options.map(([value, text]) => new Option(text, value)));
  select.value = String(chosen);
}

class Page {
  constructor() {
    this.header = JSON.parse(element("header").textContent);
    const numbers = new Numbers(element("numbers").textContent);
    this.motion = new Motion(this.header, numbers);
    this.renderer = new Renderer(element("view"));
    this.scene = new Scene(this.header, this.motion, this.renderer, element("labels"));
    this.camera = new Camera(this.header.view);
    this.plot = new Plot(element("plot"), this.header, numbers, this.motion,
                         (time) => { this.pause(); this.go(time); });
    this.time = this.motion.start;
    this.playing = false;
    this.last = null;
    this.waiting = false;
    element("about").textContent = this.header.about;
    element("cautions").hidden = !this.header.cautions.length;
    element("cautions").lastElementChild.replaceChildren(...this.header.cautions.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }));
    this.choices();
    this.ticks();
    this.transport();
    this.camera.listen(element("view"), () => this.redraw());
    new ResizeObserver(() => this.redraw()).observe(document.body);
    this.redraw();
  }

  choices() {
    const { header, scene } = this;
    const colours = [["none", "body"], ["displacement", "displacement"]];
    if (header.largest.stress) colours.push(["stress", "von Mises"]);
    fill(element("colour"), header.largest.displacement ? colours : colours.slice(0, 1),
         header.largest.displacement ? "displacement" : "none");
    element("colour").addEventListener("change", () => this.colour());
    this.colour();
    element("scale").disabled = !header.largest.displacement;
    element("scale").addEventListener("input", () => this.scale());
    this.scale();
    const named = header.nodes.map((node, k) => [k, node.name]).filter(
      ([k]) => !header.nodes[k].ground);
    fill(element("trace"), [["", "none"], ...named, ["all", "all nodes"]], header.trace ?? "");
    element("trace").addEventListener("change", () => this.trace());
    this.trace();
    fill(element("quantity"), header.plots.map((plot, k) => [k, plot.title]), 0);
    element("quantity").addEventListener("change", () => {
      this.plot.choose(Number(element("quantity").value));
      this.redraw();
    });
    element("reset").addEventListener("click", () => { this.camera.reset(); this.redraw(); });
    scene.shown.trace = this.traced();
  }

  colour() {
    const kind = element("colour").value, most = this.header.largest[kind];
    this.scene.shown.colour = kind;
    element("legend").hidden = !most;
    if (most) {
      const unit = this.header.unit_names[kind];
      element("legend-name").textContent = (kind === "stress" ? "von Mises stress" : kind)
        + (unit ? ` [${unit}]` : "");
      element("legend-bar").style.background = `linear-gradient(90deg, ${MAP.join(", ")})`;
      const [low, high] = element("legend-ends").children;
      low.textContent = "0";
      high.textContent = short(Number((most * this.header.units[kind]).toPrecision(3)));
    }
    this.redraw();
  }

  scale() {
    const factor = 10 ** (Number(element("scale").value) / DISPLAYED_SCALES);
    this.scene.shown.scale = factor;
    element("scale-value").textContent = `\u00d7 ${Number(factor.toPrecision(2))}`;
    this.redraw();
  }

  traced() {
    const value = element("trace").value;
    if (value === "all") {
      return this.header.nodes.map((_, k) => k).filter((k) => !this.header.nodes[k].ground);
    }
    return value === "" ? [] : [Number(value)];
  }

  trace() {
    this.scene.shown.trace = this.traced();
    this.redraw();
  }

  ticks() {
    for (const name of ["joints", "nodes", "names", "frames", "mesh", "ground"]) {
      element(name).addEventListener("change", () => {
        this.scene.shown[name] = element(name).checked;
        this.redraw();
      });
    }
  }

  transport() {
    const { motion } = this, duration = motion.end - motion.start;
    element("play").addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    element("time").addEventListener("input", () => {
      this.pause();
      this.go(motion.start + Number(element("time").value) / 1e5 * duration);
    });
    fill(element("speed"), SPEEDS.map((factor) => [
      factor, `${short(Number((factor * this.header.speed).toPrecision(3)))} / s`]), 1);
    document.addEventListener("keydown", (event) => {
      if (["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
      if (event.key === " ") { if (this.playing) this.pause(); else this.play(); }
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (step) { this.pause(); this.go(this.time + step * duration / (motion.t.length - 1)); }
      if (step || event.key === " ") event.preventDefault();
    });
  }

  play() {
    if (this.time >= this.motion.end) this.time = this.motion.start;
    this.playing = true;
    this.last = null;
    element("play").textContent = "pause";
    this.redraw();
  }

  pause() {
    this.playing = false;
    element("play").textContent = "play";
  }

  go(time) {
    this.time = Math.min(Math.max(time, this.motion.start), this.motion.end);
    this.redraw();
  }

  redraw() {
    if (this.waiting || !this.scene) return;
    this.waiting = true;
    requestAnimationFrame((now) => this.draw(now));
  }

  draw(now) {
    this.waiting = false;
    const { motion } = this;
    if (this.playing) {
      const passed = this.last === null ? 0 : Math.min((now - this.last) / 1000, 0.25);
      this.last = now;
      this.time += passed * Number(element("speed").value) * this.header.speed;
      if (this.time > motion.end) this.time = motion.start;
    }
    motion.seek(this.time);
    this.scene.draw(this.camera);
    this.plot.draw(this.time);
    const part = (this.time - motion.start) / (motion.end - motion.start);
    element("time").value = Math.round(1e5 * part);
    element("now").textContent = `t = ${short(Number(this.time.toPrecision(5)))}`;
    document.body.dataset.drawn = String(Number(document.body.dataset.drawn || 0) + 1);
    if (this.playing) this.redraw();
  }
}

try {
  const page = new Page();
  if (window.top === window.self) page.play();        // not inside a report
} catch (error) {
  console.error(error);
  const failure = element("failure");
  failure.textContent = `The animation cannot be shown: ${error.message}.`;
  failure.hidden = false;
}
