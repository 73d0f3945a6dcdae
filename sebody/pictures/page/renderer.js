// Drawing with WebGL 2: lit meshes, and lines of some pixels' width.

const LIT_VERTEX = `#version 300 es
in vec3 position; in vec3 normal; in float value;
uniform mat4 model, camera;
out vec3 place; out vec3 facing; out float shade;
void main() {
  vec4 at = model * vec4(position, 1.0);
  place = at.xyz;
  facing = mat3(model) * normal;
  shade = value;
  gl_Position = camera * at;
}`;
const LIT_FRAGMENT = `#version 300 es
precision highp float;
in vec3 place; in vec3 facing; in float shade;
uniform vec3 eye, colour, light; uniform vec3 map[9]; uniform float alpha; uniform vec2 range;
out vec4 seen;
void main() {
  vec3 n = normalize(facing);
  vec3 v = normalize(eye - place);
  if (dot(n, v) < 0.0) n = -n;
  vec3 base = colour;
  if (shade > -1e29) {
    float s = clamp((shade - range.x) / (range.y - range.x), 0.0, 1.0) * 8.0;
    int k = int(min(floor(s), 7.0));
    base = mix(map[k], map[k + 1], s - float(k));
  }
  float front = max(dot(n, normalize(light + 0.6 * v)), 0.0);
  float glint = pow(max(dot(n, normalize(normalize(light) + v)), 0.0), 40.0);
  seen = vec4(base * (0.42 + 0.62 * front) + 0.12 * glint, 1.0) * alpha;
}`;
const LINE_VERTEX = `#version 300 es
in vec3 from, to; in vec2 corner;
uniform mat4 camera, model; uniform vec2 screen; uniform float width, lift;
void main() {
  vec4 a = camera * (model * vec4(from, 1.0)), b = camera * (model * vec4(to, 1.0));
  vec2 way = (b.xy / b.w - a.xy / a.w) * screen;
  vec2 along = length(way) > 1e-6 ? normalize(way) : vec2(1.0, 0.0);
  vec4 at = corner.x < 0.5 ? a : b;
  vec2 aside = vec2(-along.y, along.x) * corner.y + along * (corner.x - 0.5) * 0.5;
  at.xy += aside * width / screen * at.w;
  at.z -= lift * at.w;
  gl_Position = at;
}`;
const LINE_FRAGMENT = `#version 300 es
precision highp float;
uniform vec4 tint; out vec4 seen;
void main() { seen = vec4(tint.rgb, 1.0) * tint.a; }`;

const UNMOVED = placed(IDENTITY, [0, 0, 0]);

class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true });
    if (!gl) throw new Error("this browser offers no WebGL 2, which draws the model");
    this.gl = gl;
    this.canvas = canvas;
    this.lit = this.program(LIT_VERTEX, LIT_FRAGMENT);
    this.line = this.program(LINE_VERTEX, LINE_FRAGMENT);
    this.corners = this.filled(new Float32Array([0, -0.5, 1, -0.5, 1, 0.5, 0, 0.5]));
    this.lineArray = gl.createVertexArray();
    this.scratch = gl.createBuffer();
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.clearColor(0, 0, 0, 0);
  }

  program(vertex, fragment) {
    const gl = this.gl, found = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(found, shader);
    }
    gl.bindAttribLocation(found, 0, "position");
    gl.linkProgram(found);
    if (!gl.getProgramParameter(found, gl.LINK_STATUS)) {
      throw new Error(gl.getProgramInfoLog(found) || "a shader could not be linked");
    }
    const uniforms = {};
    const count = gl.getProgramParameter(found, gl.ACTIVE_UNIFORMS);
    for (let k = 0; k < count; k++) {
      const name = gl.getActiveUniform(found, k).name;
      uniforms[name.replace("[0]", "")] = gl.getUniformLocation(found, name);
    }
    return { program: found, uniforms };
  }

  filled(values, target = this.gl.ARRAY_BUFFER) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(target, buffer);
    this.gl.bufferData(target, values, this.gl.STATIC_DRAW);
    return buffer;
  }

  // A mesh of vertices with normals; of a deforming one they, and values, are updated.
  mesh(shape) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const vertices = this.filled(new Float32Array(shape.vertices));
    this.attribute("position", 3);
    const normals = this.filled(new Float32Array(shape.normals));
    this.attribute("normal", 3);
    let values = null;
    if (shape.values) {
      values = this.filled(new Float32Array(shape.values));
      this.attribute("value", 1);
    }
    this.filled(new Uint32Array(shape.triangles), gl.ELEMENT_ARRAY_BUFFER);
    gl.bindVertexArray(null);
    return { array, vertices, normals, values, count: shape.triangles.length };
  }

  attribute(name, size) {
    const at = this.gl.getAttribLocation(this.lit.program, name);
    if (at < 0) return;
    this.gl.enableVertexAttribArray(at);
    this.gl.vertexAttribPointer(at, size, this.gl.FLOAT, false, 0, 0);
  }

  update(mesh, body) {
    const gl = this.gl;
    for (const name of ["vertices", "normals", "values"]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh[name]);
      gl.bufferData(gl.ARRAY_BUFFER, body[name], gl.DYNAMIC_DRAW);
    }
  }

  begin(camera, map, range) {
    const gl = this.gl, ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    this.ratio = ratio;
    this.camera = camera.matrix(width / height);
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.lit.program);
    const u = this.lit.uniforms;
    gl.uniformMatrix4fv(u.camera, false, this.camera);
    gl.uniform3fv(u.eye, camera.eye());
    gl.uniform3fv(u.light, camera.light());
    gl.uniform3fv(u.map, map);
    gl.uniform2fv(u.range, range);
  }

  // A mesh; with an alpha below 1 what is behind it shines through, so draw these last.
  draw(mesh, matrix, colour, alpha = 1) {
    const gl = this.gl, u = this.lit.uniforms;
    gl.useProgram(this.lit.program);
    gl.uniformMatrix4fv(u.model, false, matrix);
    gl.uniform3fv(u.colour, colour);
    gl.uniform1f(u.alpha, alpha);
    gl.bindVertexArray(mesh.array);
    if (!mesh.values) gl.vertexAttrib1f(gl.getAttribLocation(this.lit.program, "value"), NOTHING);
    if (alpha < 1) { gl.enable(gl.BLEND); gl.enable(gl.CULL_FACE); gl.depthMask(false); }
    gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);
    gl.disable(gl.CULL_FACE);
    gl.depthMask(true);
    gl.bindVertexArray(null);
  }

  // What is drawn by `act` shows faintly where it is behind something.
  behind(act) {
    const gl = this.gl;
    gl.depthFunc(gl.GREATER);
    act();
    gl.depthFunc(gl.LESS);
  }

  // Separate lines between pairs of points, or one through all of them.
  lines(points, { tint, width = 1.5, joined = false, lift = 0, matrix = UNMOVED }) {
    const gl = this.gl, u = this.line.uniforms, count = points.length / 3;
    const segments = joined ? count - 1 : count / 2;
    if (segments < 1) return;
    gl.useProgram(this.line.program);
    gl.bindVertexArray(this.lineArray);
    const place = (name) => gl.getAttribLocation(this.line.program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.enableVertexAttribArray(place("corner"));
    gl.vertexAttribPointer(place("corner"), 2, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.scratch);
    gl.bufferData(gl.ARRAY_BUFFER, points, gl.STREAM_DRAW);
    for (const [name, first] of [["from", 0], ["to", 12]]) {
      gl.enableVertexAttribArray(place(name));
      gl.vertexAttribPointer(place(name), 3, gl.FLOAT, false, joined ? 12 : 24, first);
      gl.vertexAttribDivisor(place(name), 1);
    }
    gl.uniformMatrix4fv(u.camera, false, this.camera);
    gl.uniformMatrix4fv(u.model, false, matrix);
    gl.uniform2f(u.screen, this.canvas.width / 2, this.canvas.height / 2);
    gl.uniform1f(u.width, width * this.ratio);
    gl.uniform1f(u.lift, lift);
    gl.uniform4fv(u.tint, tint);
    gl.enable(gl.BLEND);
    gl.drawArraysInstanced(gl.TRIANGLE_FAN, 0, 4, segments);
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
  }

  // Pixels of the page at which a point is seen; null behind the eye.
  pixel(point) {
    const m = this.camera, clip = [0, 1, 3].map((row) => m[row] * point[0] + m[4 + row] * point[1]
                                                + m[8 + row] * point[2] + m[12 + row]);
    if (clip[2] <= 0) return null;
    return [(clip[0] / clip[2] + 1) / 2 * this.canvas.clientWidth,
            (1 - clip[1] / clip[2]) / 2 * this.canvas.clientHeight];
  }
}
