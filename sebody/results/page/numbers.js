// The numbers of the page: arrays in one stretch of bytes, described by blocks of the header.
//
// A block of values has `shape` [rows, columns]; of the columns only those in `varying` are stored,
// as whole numbers k that stand for low + k * step. The others are equal to their `low`.

class Numbers {
  constructor(text) {
    const binary = atob(text.trim());
    this.bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; i++) this.bytes[i] = binary.charCodeAt(i);
  }

  // Values of a block, row after row.
  values(block) {
    const [rows, columns] = block.shape;
    const found = new Float32Array(rows * columns);
    const stored = this.stored(block, rows * block.varying.length);
    for (let column = 0; column < columns; column++) {
      const low = block.low[column];
      if (low !== 0) for (let row = 0; row < rows; row++) found[row * columns + column] = low;
    }
    const count = block.varying.length;
    for (let k = 0; k < count; k++) {
      const column = block.varying[k], low = block.low[column], step = block.step[k];
      for (let row = 0; row < rows; row++) {
        found[row * columns + column] = low + step * stored[row * count + k];
      }
    }
    return found;
  }

  // Numbers from 0 to 1 of a block, row after row, in steps of 1 / 255.
  colours(block) {
    return this.stored(block, block.shape[0] * block.shape[1]);
  }

  // Whole numbers of a block.
  indices(block) {
    return Uint32Array.from(this.stored(block, block.count));
  }

  stored(block, count) {
    const kind = { 1: Uint8Array, 2: Uint16Array, 4: Uint32Array }[block.bytes];
    return new kind(this.bytes.buffer, block.at, count);
  }
}
