// The eye: it turns about a target, with one direction up.

const VIEW_ANGLE = 0.5;

class Camera {
  constructor(view) {
    this.up = unit(view.up);
    this.first = across(this.up);
    this.second = cross(this.up, this.first);
    this.view = view;
    this.reset();
  }

  reset() {
    const towards = unit(this.view.towards);
    this.target = [...this.view.target];
    this.azimuth = Math.atan2(dot(towards, this.second), dot(towards, this.first));
    this.elevation = Math.asin(Math.min(Math.max(dot(towards, this.up), -1), 1));
    this.distance = this.view.radius / Math.sin(VIEW_ANGLE / 2);
  }

  direction() {
    const c = Math.cos(this.elevation);
    return add(times(Math.sin(this.elevation), this.up),
               add(times(c * Math.cos(this.azimuth), this.first),
                   times(c * Math.sin(this.azimuth), this.second)));
  }

  eye() { return add(this.target, times(this.distance, this.direction())); }

  // Over the left shoulder.
  light() {
    const back = this.direction(), right = unit(cross(this.up, back));
    return unit(add(add(back, times(0.9, cross(back, right))), times(-0.5, right)));
  }

  // Angle of view from bottom to top: what fits into a wide picture fits into a narrow one.
  angle(aspect) {
    return aspect < 1 ? 2 * Math.atan(Math.tan(VIEW_ANGLE / 2) / aspect) : VIEW_ANGLE;
  }

  // Pixels of a unit of length at the target.
  pixels({ clientWidth, clientHeight }) {
    const angle = this.angle(clientWidth / clientHeight);
    return clientHeight / (2 * this.distance * Math.tan(angle / 2));
  }

  // What is seen at a pixel lies on a line from the eye.
  ray([x, y], width, height) {
    const back = this.direction(), right = unit(cross(this.up, back)), above = cross(back, right);
    const size = Math.tan(this.angle(width / height) / 2);
    const aside = add(times((2 * x - width) / height * size, right),
                      times((1 - 2 * y / height) * size, above));
    return { from: this.eye(), way: unit(subtract(aside, back)) };
  }

  matrix(aspect) {
    const near = this.distance / 50, far = this.distance * 50;
    return product(perspective(this.angle(aspect), aspect, near, far),
                   looking(this.eye(), this.target, this.up));
  }

  // Pixels of dragging: about the target, or with `shift` along the screen.
  drag(dx, dy, height, shift) {
    if (shift) {
      const back = this.direction(), right = unit(cross(this.up, back)), up = cross(back, right);
      const size = 2 * this.distance * Math.tan(VIEW_ANGLE / 2) / height;
      this.target = add(this.target, add(times(-dx * size, right), times(dy * size, up)));
    } else {
      this.azimuth -= 3.2 * dx / height;
      this.elevation = Math.min(Math.max(this.elevation + 3.2 * dy / height, -1.55), 1.55);
    }
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 0.02 * this.view.radius),
                             60 * this.view.radius);
  }

  listen(canvas, changed) {
    const held = new Map();
    let apart = 0;
    const spread = () => {
      const [a, b] = [...held.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (held.size === 2) apart = spread();
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = held.get(event.pointerId);
      if (!before) return;
      held.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (held.size === 2) {
        this.zoom(apart / Math.max(spread(), 1));
        apart = spread();
      } else {
        this.drag(event.clientX - before.x, event.clientY - before.y, canvas.clientHeight,
                  event.shiftKey || (event.buttons & 6) !== 0);
      }
      changed();
    });
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (event) => held.delete(event.pointerId));
    }
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.0012));
      changed();
    }, { passive: false });
  }
}
