// The plot below the model: histories of a quantity, with a line at the time that is shown.

const MARGIN = { left: 62, right: 12, top: 20, bottom: 20 };

// Round steps that divide a range into about so many parts.
function ticks(low, high, parts) {
  const rough = (high - low) / parts, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((one) => one >= rough * 0.999);
  const found = [];
  const first = Math.ceil(low / step - 1e-9);
  for (let k = 0; k <= 2 * parts && (first + k) * step <= high + 1e-9 * step; k++) {
    found.push((first + k) * step);
  }
  return found;
}

function short(value) {
  if (Math.abs(value) < 1e-300) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(2).replace(/\.?0+e/, "e")
                                    : String(Number(value.toPrecision(5)));
}

// With four digits.
const digits = (value) => short(Number(value.toPrecision(4)));

class Plot {
  constructor(canvas, header, numbers, motion, go) {
    this.canvas = canvas;
    this.motion = motion;
    this.numbers = numbers;
    this.colours = header.palette.curves;
    this.panels = header.plots.all;
    this.t = Array.from(numbers.indices(header.plots.frames), (frame) => motion.t[frame]);
    this.choose(0);
    const seek = (event) => {
      const box = canvas.getBoundingClientRect();
      const width = box.width - MARGIN.left - MARGIN.right;
      const part = (event.clientX - box.left - MARGIN.left) / width;
      go(motion.start + Math.min(Math.max(part, 0), 1) * (motion.end - motion.start));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      seek(event);
    });
    canvas.addEventListener("pointermove", (event) => { if (event.buttons & 1) seek(event); });
  }

  choose(number) {
    this.panel = this.panels[number];
    if (this.panel) this.values = this.numbers.values(this.panel.values);
  }

  draw(time) {
    const { canvas, motion } = this, ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const brush = canvas.getContext("2d");
    brush.scale(ratio, ratio);
    brush.font = "12px system-ui, sans-serif";
    const { panel, values, t: times } = this;
    if (!panel) return;
    const count = panel.labels.length;
    let [low, high] = panel.range;
    if (!(high > low)) { low -= 1; high += 1; }
    const pad = 0.06 * (high - low);
    low -= pad; high += pad;
    const x = (t) => MARGIN.left + (t - motion.start) / (motion.end - motion.start)
      * (width - MARGIN.left - MARGIN.right);
    const y = (v) => height - MARGIN.bottom - (v - low) / (high - low)
      * (height - MARGIN.top - MARGIN.bottom);
    this.axes(brush, x, y, low, high, width, height);
    this.unit(brush, panel, width);
    brush.lineWidth = 1.4;
    for (let k = 0; k < count; k++) {
      brush.strokeStyle = this.colours[k % this.colours.length];
      brush.beginPath();
      times.forEach((t, row) => brush.lineTo(x(t), y(values[row * count + k])));
      brush.stroke();
    }
    this.cursor(brush, panel, time, x, y, width, height);
  }

  axes(brush, x, y, low, high, width, height) {
    brush.fillStyle = "#66718a";
    brush.strokeStyle = "#e6e9ef";
    brush.textAlign = "right";
    brush.textBaseline = "middle";
    for (const value of ticks(low, high, Math.max(2, height / 28))) {
      brush.fillText(short(value), MARGIN.left - 8, y(value));
      brush.beginPath();
      brush.moveTo(MARGIN.left, y(value));
      brush.lineTo(width - MARGIN.right, y(value));
      brush.stroke();
    }
    brush.textAlign = "center";
    brush.textBaseline = "top";
    for (const value of ticks(this.motion.start, this.motion.end, width / 95)) {
      brush.fillText(short(value), x(value), height - MARGIN.bottom + 5);
    }
  }

  // The unit at the right, over the curves.
  unit(brush, panel, width) {
    if (!panel.unit || width < 720) return;
    brush.fillStyle = "#66718a";
    brush.textAlign = "right";
    brush.textBaseline = "top";
    brush.fillText(`[${panel.unit}]`, width - MARGIN.right, 2);
  }

  cursor(brush, panel, time, x, y, width, height) {
    const [row, part] = between(this.t, time), count = panel.labels.length;
    const now = panel.labels.map((_, k) => (1 - part) * this.values[row * count + k]
                                           + part * this.values[(row + 1) * count + k]);
    brush.strokeStyle = "#66718a";
    brush.beginPath();
    brush.moveTo(x(time), MARGIN.top - 4);
    brush.lineTo(x(time), height - MARGIN.bottom);
    brush.stroke();
    brush.textBaseline = "top";
    brush.textAlign = "left";
    let at = MARGIN.left;
    const noise = 2e-5 * Math.max(...panel.range.map(Math.abs));
    now.slice(0, this.colours.length).forEach((value, k) => {
      brush.fillStyle = this.colours[k];
      brush.beginPath();
      brush.arc(x(time), y(value), 3.2, 0, 2 * Math.PI);
      brush.fill();
      const text = `${panel.labels[k]} ${digits(Math.abs(value) < noise ? 0 : value)}`.trim();
      brush.fillText(text, at, 2);
      at += Math.max(brush.measureText(text).width, 74) + 14;
    });
  }
}
