// The numbers of the page: arrays in one stretch of bytes, described by blocks of the header.
//
// A block of values has `shape` [rows, columns]; of the columns only those in `varying` are stored,
// as whole numbers k that stand for low + k * step. The others are equal to their `low`. The whole
// numbers of a column are stored as differences, all low bytes of a block before the higher ones.

class Numbers {
  constructor(bytes) { this.bytes = bytes; }

  // From compressed bytes in base 64.
  static async read(text) {
    if (!window.DecompressionStream) throw new Error("this browser is too old to unpack the data");
    const packed = Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Numbers(new Uint8Array(await new Response(stream).arrayBuffer()));
  }

  // Values of a block, row after row.
  values(block) {
    const [rows, columns] = block.shape, found = new Float32Array(rows * columns);
    for (let column = 0; column < columns; column++) {
      const low = block.low[column];
      if (low !== 0) for (let row = 0; row < rows; row++) found[row * columns + column] = low;
    }
    this.each(block, rows, block.varying.length, (row, k, whole) => {
      const column = block.varying[k];
      found[row * columns + column] = block.low[column] + block.step[k] * whole;
    });
    return found;
  }

  // Whole numbers of a block.
  indices(block) {
    const found = new Uint32Array(block.count);
    this.each(block, block.count, 1, (row, _, whole) => { found[row] = whole; });
    return found;
  }

  each(block, rows, columns, take) {
    const { bytes } = this, count = rows * columns, width = block.bytes;
    for (let column = 0; column < columns; column++) {
      let whole = 0;
      for (let row = 0; row < rows; row++) {
        let step = 0;
        for (let k = width - 1; k >= 0; k--) {
          step = (step << 8) | bytes[block.at + k * count + column * rows + row];
        }
        whole += (step >>> 1) ^ -(step & 1);
        whole = width === 2 ? whole & 0xffff : whole >>> 0;
        take(row, column, whole);
      }
    }
  }
}
