// Vectors are arrays of three numbers, rotations three columns, quaternions have the real part
// last; matrices of 16 numbers are of four columns, as WebGL takes them.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (s, a) => [s * a[0], s * a[1], s * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => times(1 / (length(a) || 1), a);
const IDENTITY = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

// Some direction across another one.
function across(a) {
  const least = a.map(Math.abs).indexOf(Math.min(...a.map(Math.abs)));
  return unit(cross(a, IDENTITY[least]));
}

// Columns of the rotation matrix of a quaternion.
function columns([x, y, z, w]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]];
}

// Columns of the matrix of a rotation vector.
function rotation(vector) {
  const angle = length(vector);
  const s = angle > 1e-6 ? Math.sin(angle / 2) / angle : 0.5;
  return columns([...times(s, vector), Math.cos(angle / 2)]);
}

// Rotation vector of a matrix, of an angle below pi.
function vectorOf([a, b, c]) {
  const twice = [b[2] - c[1], c[0] - a[2], a[1] - b[0]];
  const sine = length(twice) / 2, angle = Math.atan2(sine, (a[0] + b[1] + c[2] - 1) / 2);
  return times(sine > 1e-9 ? angle / (2 * sine) : 0.5, twice);
}

const combine = (axes, a) => add(add(times(a[0], axes[0]), times(a[1], axes[1])),
                                 times(a[2], axes[2]));
const matrixTimes = (A, B) => B.map((column) => combine(A, column));
const transposed = (A) => [0, 1, 2].map((k) => [A[0][k], A[1][k], A[2][k]]);

// Matrix that takes the axes to `axes`, of any length, and the origin to `origin`.
function placed(axes, origin) {
  return new Float32Array([...axes[0], 0, ...axes[1], 0, ...axes[2], 0, ...origin, 1]);
}

function product(a, b) {
  const found = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      found[4 * column + row] = sum;
    }
  }
  return found;
}

function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
                           0, 0, 2 * far * near / (near - far), 0]);
}

function looking(eye, target, up) {
  const z = unit(subtract(eye, target)), x = unit(cross(up, z)), y = cross(z, x);
  return new Float32Array([x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0,
                           -dot(x, eye), -dot(y, eye), -dot(z, eye), 1]);
}
