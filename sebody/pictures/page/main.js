// The page: time, and one picture after the other.

const SPEEDS = [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20];

class Page {
  constructor(header, numbers) {
    this.header = header;
    this.scene = new Scene(header, numbers, new Renderer(element("view")));
    this.motion = this.scene.motion;
    this.time = this.motion.start;
    this.playing = false;
    this.last = null;
    this.waiting = true;                // no picture before everything is set up
    this.camera = new Camera(header.view);
    this.labels = new Labels(element("labels"), this.scene);
    this.legend = new Legend(header, this.scene, () => this.redraw());
    this.pointer = new Pointer(element("view"), this.scene, this.camera, this.legend);
    this.plot = new Plot(element("plot"), header, numbers, this.motion,
                         (time) => { this.pause(); this.go(time); });
    element("about").textContent = header.about;
    this.controls = new Controls(this);
    this.transport();
    this.camera.listen(element("view"), () => this.redraw());
    new ResizeObserver(() => this.redraw()).observe(document.body);
    this.waiting = false;
    this.redraw();
  }

  transport() {
    const { motion } = this, duration = motion.end - motion.start;
    element("play").addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    element("time").addEventListener("input", () => {
      this.pause();
      this.go(motion.start + Number(element("time").value) / 1e5 * duration);
    });
    element("peak").addEventListener("click", () => {
      this.pause();
      this.go(motion.t[this.legend.peak().frame]);
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
    if (this.waiting) return;
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
    this.scene.update();
    this.scene.draw(this.camera);
    this.labels.draw(this.camera, this.legend.now());
    this.pointer.show();
    this.plot.draw(this.time);
    const part = (this.time - motion.start) / (motion.end - motion.start);
    element("time").value = Math.round(1e5 * part);
    element("now").textContent = `t = ${short(Number(this.time.toPrecision(5)))} ${this.header.time_unit}`.trimEnd();
    document.body.dataset.drawn = String(Number(document.body.dataset.drawn || 0) + 1);
    if (this.playing) this.redraw();
  }
}

let page = null;

async function start() {
  try {
    const header = JSON.parse(element("header").textContent);
    page = new Page(header, await Numbers.read(element("numbers").textContent));
    if (window.top === window.self) page.play();        // not inside a report
  } catch (error) {
    console.error(error);
    const failure = element("failure");
    failure.textContent = `The animation cannot be shown: ${error.message}.`;
    failure.hidden = false;
  }
}

start();
