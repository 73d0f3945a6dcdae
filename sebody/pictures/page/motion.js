// The model at any time: between two frames places, amplitudes and quaternions are interpolated.

class Motion {
  constructor(header, numbers) {
    this.t = numbers.values(header.t);
    this.nodes = header.nodes.map((node) => ({
      ...node, position: numbers.values(node.position),
      rotation: node.rotation && numbers.values(node.rotation),
    }));
    this.frame = 0;
    this.part = 0;
  }

  get start() { return this.t[0]; }
  get end() { return this.t[this.t.length - 1]; }

  // Go to a time: the frame before it, and the part of the way to the next one.
  seek(time) { [this.frame, this.part] = between(this.t, time); }

  // A row of a history of `size` numbers a frame, now.
  now(history, size) {
    const first = size * this.frame, found = new Array(size);
    for (let k = 0; k < size; k++) {
      const a = history[first + k], b = history[first + size + k];
      found[k] = a + this.part * (b - a);
    }
    return found;
  }

  turned(history) {
    if (!history) return [0, 0, 0, 1];
    const first = 4 * this.frame;
    let inner = 0;
    for (let k = 0; k < 4; k++) inner += history[first + k] * history[first + 4 + k];
    const sign = inner < 0 ? -1 : 1, found = [0, 0, 0, 0];
    for (let k = 0; k < 4; k++) {
      found[k] = (1 - this.part) * history[first + k] + this.part * sign * history[first + 4 + k];
    }
    const size = Math.hypot(...found) || 1;
    return found.map((value) => value / size);
  }

  position(node) { return this.now(this.nodes[node].position, 3); }
  axes(node) { return columns(this.turned(this.nodes[node].rotation)); }
  placeOf(body) {
    return { origin: this.now(body.origin, 3), axes: columns(this.turned(body.rotation)) };
  }
}

// The entry of ascending times before a time, and the part of the way to the next one.
function between(t, time) {
  let low = 0, high = t.length - 2;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (t[middle] <= time) low = middle; else high = middle - 1;
  }
  return [low, Math.min(Math.max((time - t[low]) / (t[low + 1] - t[low]), 0), 1)];
}
