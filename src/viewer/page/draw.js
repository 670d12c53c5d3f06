// Draws the pieces with WebGL 2: one draw for each material, whatever the number of pieces.

const SHADOW = 256;  // pixels along a side of the shadow's image
const SLOW = 40, FAST = 18;  // milliseconds of a frame: while the view moves, the image gets coarser or finer

const MANY_FACES = 300000;  // for a processor, which takes twice as long for smooth edges

// Whether there is no graphics card.
function isDrawnByProcessor() {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl) return true;
  const unmasked = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(unmasked ? unmasked.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

class Drawing {
  constructor(canvas, scene) {
    const faces = scene.pieces.reduce((sum, piece) => sum + piece.faces, 0);
    const gl = canvas.getContext('webgl2', {antialias: faces < MANY_FACES || !isDrawnByProcessor(), alpha: true, stencil: true, preserveDrawingBuffer: true});
    if (!gl) throw new Error('no WebGL 2');
    this.gl = gl;
    this.canvas = canvas;
    this.scene = scene;
    this.programs = new Map();
    this.coarseness = 1;
    this.frames = 0;
    const longest = Math.max(...scene.size, scene.step);
    this.unit = longest / 2;  // world units of a unit
    this.center = scene.size.map(x => x / 2);
    this.upright = {x: [0, 1, 0, -1, 0, 0, 0, 0, 1], y: [1, 0, 0, 0, 1, 0, 0, 0, 1], z: [1, 0, 0, 0, 0, -1, 0, 1, 0]}[scene.up];
  }

  // World coordinates to units.
  unitOf(world) {
    const p = world.map((x, i) => (x - this.scene.origin[i] - this.center[i]) / this.unit), m = this.upright;
    return [0, 1, 2].map(row => m[row] * p[0] + m[3 + row] * p[1] + m[6 + row] * p[2]);
  }

  // ---- Resources

  load(arrays, images) {
    const gl = this.gl;
    Object.assign(this, {groups: arrays.groups, ranges: arrays.ranges, lineRanges: arrays.lineRanges, lineCount: arrays.lines.length});
    this.faces = this.vertexArray(arrays, arrays.indices);
    this.edges = this.vertexArray(arrays, arrays.lines);
    this.textures = images.map(image => image && this.imageTexture(image));
    this.blank = this.dataTexture(gl.RGBA8, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array([255, 255, 255, 255]));
    this.rows = Math.ceil(this.scene.pieces.length / 256);
    this.offsetData = new Float32Array(4 * 256 * this.rows);
    this.colorData = new Float32Array(4 * 256 * this.rows);
    this.offsets = this.dataTexture(gl.RGBA32F, 256, this.rows, gl.RGBA, gl.FLOAT, this.offsetData);
    this.colors = this.dataTexture(gl.RGBA32F, 256, this.rows, gl.RGBA, gl.FLOAT, this.colorData);
    this.picking = this.target(1, gl.NEAREST, true);
    this.shadows = [this.target(SHADOW, gl.LINEAR), this.target(SHADOW, gl.LINEAR)];
    this.shadowIsOld = true;
    gl.clearColor(0, 0, 0, 0);
  }

  vertexArray(arrays, indices) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.buffers ??= [arrays.corners, arrays.shades, arrays.texcoords, arrays.colors].map(data => {
      if (!data) return null;
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      return buffer;
    });
    const use = (buffer, ...attributes) => {
      if (!buffer) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      for (const set of attributes) set();
    };
    const floats = (at, count, type, normalized, stride, offset) => () => {
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, count, type, normalized, stride, offset);
    };
    const whole = (at, offset) => () => {
      gl.enableVertexAttribArray(at);
      gl.vertexAttribIPointer(at, 1, gl.UNSIGNED_SHORT, 8, offset);
    };
    use(this.buffers[0], floats(0, 3, gl.UNSIGNED_SHORT, false, 8, 0), whole(1, 6));
    use(this.buffers[1], floats(2, 2, gl.SHORT, true, 8, 0), whole(3, 4));
    use(this.buffers[2], floats(4, 2, gl.UNSIGNED_SHORT, false, 4, 0));
    use(this.buffers[3], floats(5, 4, gl.UNSIGNED_BYTE, true, 4, 0));
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return array;
  }

  dataTexture(format, width, height, layout, type, data) {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, layout, type, data);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    return texture;
  }

  imageTexture(image) {
    const gl = this.gl, texture = gl.createTexture(), most = Math.min(8192, gl.getParameter(gl.MAX_TEXTURE_SIZE));
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.SRGB8_ALPHA8, gl.RGBA, gl.UNSIGNED_BYTE, fitted(image, most));
    gl.generateMipmap(gl.TEXTURE_2D);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    const anisotropy = gl.getExtension('EXT_texture_filter_anisotropic');
    if (anisotropy) gl.texParameteri(gl.TEXTURE_2D, anisotropy.TEXTURE_MAX_ANISOTROPY_EXT, 4);
    return texture;
  }

  // An image to draw into.
  target(side, filter, hasDepth = false) {
    const gl = this.gl, frame = gl.createFramebuffer();
    const image = this.dataTexture(gl.RGBA8, side, side, gl.RGBA, gl.UNSIGNED_BYTE, null);
    for (const f of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, f, filter);
    for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, image, 0);
    if (hasDepth) {
      const depth = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT16, side, side);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return {frame, image};
  }

  // Compiles a program when it is first used, and returns its uniforms' setters by name.
  use([vertex, fragment]) {
    const gl = this.gl, key = vertex + fragment;
    if (!this.programs.has(key)) {
      const program = gl.createProgram();
      for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      }
      gl.linkProgram(program);
      if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
      const at = {};
      for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
        const {name} = gl.getActiveUniform(program, i);
        at[name] = gl.getUniformLocation(program, name);
      }
      this.programs.set(key, {program, at});
    }
    const {program, at} = this.programs.get(key);
    gl.useProgram(program);
    return at;
  }

  // Uniforms that all programs with PLACE have.
  place(at, matrix) {
    const gl = this.gl, units = this.scene.step / this.unit;
    gl.uniformMatrix4fv(at.u_matrix, false, matrix);
    gl.uniformMatrix3fv(at.u_upright, false, this.upright);
    gl.uniform4f(at.u_grid, ...this.center.map(x => x / this.scene.step), units);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.offsets);
    gl.uniform1i(at.u_offsets, 0);
  }

  // ---- State

  // state: [pieces] {offset, hidden, color (linear), faded}
  update(state) {
    const gl = this.gl;
    state.forEach((own, i) => {
      this.offsetData.set(own.offset, 4 * i);
      this.offsetData[4 * i + 3] = own.hidden ? 1 : 0;
      this.colorData.set(own.color, 4 * i);
      this.colorData[4 * i + 3] = own.faded;
    });
    for (const [texture, data] of [[this.offsets, this.offsetData], [this.colors, this.colorData]]) {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, this.rows, gl.RGBA, gl.FLOAT, data);
    }
    this.shadowIsOld = true;
  }

  // size: of a picture for paper; else that of the canvas in the page
  resize(isMoving, size) {
    if (size) {
      Object.assign(this.canvas, {width: size[0], height: size[1]});
      this.pixel = size[1] / this.canvas.clientHeight;
      return;
    }
    const ratio = Math.min(window.devicePixelRatio || 1, 2) * (isMoving ? this.coarseness : 1);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, {width, height});
    this.pixel = ratio;
  }

  // ---- Images

  triangles(group) {
    this.gl.drawElements(this.gl.TRIANGLES, group.count, this.gl.UNSIGNED_INT, 4 * group.first);
  }

  // Triangles of one piece, without their shades.
  pieceTriangles(index) {
    const ranges = this.ranges[index];
    for (let i = 0; i < ranges.length; i += 2) this.triangles({first: ranges[i], count: ranges[i + 1]});
  }

  // look: {camera, radius, rise, mode, showLines, showGhosts, selected, isDark, accent, lowest}
  draw(look, isMoving, size) {
    const gl = this.gl, camera = look.camera;
    this.resize(isMoving, size);
    if (this.shadowIsOld && !(isMoving && this.isLarge())) this.drawShadow(look);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    const view = camera.view(), matrix = multiply(camera.projection(this.canvas.width / this.canvas.height, look.radius, look.rise), view);
    gl.enable(gl.DEPTH_TEST);
    this.drawGround(look, matrix);
    gl.bindVertexArray(this.faces);
    gl.enable(gl.CULL_FACE);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    const at = this.shade(look, view, matrix);
    for (const group of this.groups) {
      if (group.material === null) continue;
      this.material(at, group.material);
      this.triangles(group);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.disable(gl.CULL_FACE);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    if (look.showLines && this.lineCount > 0) this.drawLines(look, matrix);
    if (look.showGhosts) this.drawGhosts(look, view, matrix);
    if (look.selected >= 0) this.drawOutline(look, matrix);
    gl.disable(gl.BLEND);
    gl.bindVertexArray(null);
    ++this.frames;
  }

  isLarge() { return this.groups.reduce((sum, group) => sum + group.count, 0) > 1e6; }

  shade(look, view, matrix) {
    const gl = this.gl, at = this.use(SHADED), t = this.scene.texcoords;
    this.place(at, matrix);
    gl.uniformMatrix4fv(at.u_view, false, view);
    gl.uniformMatrix3fv(at.u_turn, false, [0, 1, 2, 4, 5, 6, 8, 9, 10].map(i => view[i]));
    gl.uniform3f(at.u_above, view[4], view[5], view[6]);
    gl.uniform1i(at.u_mode, look.mode);
    gl.uniform4f(at.u_texcoords, ...(t ? [...t.origin, ...t.step] : [0, 0, 0, 0]));
    gl.uniform3fv(at.u_outside, look.sides[0]);
    gl.uniform3fv(at.u_inside, look.sides[1]);
    gl.uniform3fv(at.u_paper, look.isDark ? [0.17, 0.19, 0.22] : [0.90, 0.91, 0.93]);
    gl.uniform1f(at.u_ghost, 0);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.colors);
    gl.uniform1i(at.u_colors, 1);
    gl.uniform1i(at.u_texture, 2);
    if (!this.buffers[3]) gl.vertexAttrib4f(5, 1, 1, 1, 1);
    return at;
  }

  material(at, number) {
    const gl = this.gl, own = this.scene.materials[number], texture = own && this.textures[own.texture];
    const color = own && !(own.inside && this.scene.colors) ? own.color : [255, 255, 255];
    gl.uniform3fv(at.u_material, color.map(linearFromByte));
    gl.uniform1i(at.u_hasTexture, texture ? 1 : 0);
    gl.activeTexture(gl.TEXTURE2);
    gl.bindTexture(gl.TEXTURE_2D, texture || this.blank);
  }

  drawLines(look, matrix) {
    const gl = this.gl, at = this.use(PLAIN);
    this.place(at, matrix);
    gl.uniform2f(at.u_shift, 0, 0);
    gl.uniform1f(at.u_nearer, 2e-5);
    gl.uniform4fv(at.u_color, look.isDark ? [0, 0, 0, 0.55] : [0.0, 0.0, 0.0, 0.42]);
    gl.bindVertexArray(this.edges);
    gl.drawElements(gl.LINES, this.lineCount, gl.UNSIGNED_INT, 0);
  }

  drawGhosts(look, view, matrix) {
    const gl = this.gl, ghosts = this.groups.find(group => group.material === null);
    if (!ghosts) return;
    gl.bindVertexArray(this.faces);
    const at = this.shade(look, view, matrix);
    gl.uniform1f(at.u_ghost, 1);
    gl.uniform3fv(at.u_paper, look.isDark ? [0.72, 0.80, 0.95] : [0.27, 0.36, 0.52]);
    gl.depthMask(false);
    this.triangles(ghosts);
    gl.depthMask(true);
  }

  // A line around a piece, also where others cover it: its shape, moved to eight sides, without itself.
  drawOutline(look, matrix) {
    const gl = this.gl, at = this.use(PLAIN), width = Math.max(1, 1.6 * this.pixel);
    this.place(at, matrix);
    gl.bindVertexArray(this.faces);
    gl.uniform1f(at.u_nearer, 0);
    gl.uniform4fv(at.u_color, look.accent);
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.ALWAYS, 1, 1);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.REPLACE);
    gl.colorMask(false, false, false, false);
    gl.uniform2f(at.u_shift, 0, 0);
    this.pieceTriangles(look.selected);
    gl.colorMask(true, true, true, true);
    gl.stencilFunc(gl.EQUAL, 0, 1);
    for (let i = 0; i < 8; ++i) {
      const [x, y] = [Math.cos(i * Math.PI / 4), Math.sin(i * Math.PI / 4)];
      gl.uniform2f(at.u_shift, 2 * width * x / this.canvas.width, 2 * width * y / this.canvas.height);
      this.pieceTriangles(look.selected);
    }
    gl.disable(gl.STENCIL_TEST);
    gl.enable(gl.DEPTH_TEST);
  }

  // The shadow on the ground below all pieces, as seen from above.
  drawShadow(look) {
    const gl = this.gl, [a, b] = this.shadows, reach = look.radius * 1.6;
    this.square = [-reach, -reach, 2 * reach, look.lowest];
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    gl.viewport(0, 0, SHADOW, SHADOW);
    gl.bindFramebuffer(gl.FRAMEBUFFER, a.frame);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.bindVertexArray(this.faces);
    const at = this.use(PLAIN);
    // Columns: x to the right, z upwards, as u_square has them.
    const down = new Float32Array([1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1]);
    this.place(at, multiply(orthographic(-reach, reach, -reach, reach, -9 * reach, 9 * reach), down));
    gl.uniform2f(at.u_shift, 0, 0);
    gl.uniform1f(at.u_nearer, 0);
    gl.uniform4f(at.u_color, 0, 0, 0, 1);
    for (const group of this.groups) if (group.material !== null) this.triangles(group);
    gl.bindVertexArray(null);
    for (let pass = 0; pass < 4; ++pass) {
      const [from, to] = pass % 2 === 0 ? [a, b] : [b, a], along = 1.25 / SHADOW;
      gl.bindFramebuffer(gl.FRAMEBUFFER, to.frame);
      const blur = this.use(BLURRED);
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, from.image);
      gl.uniform1i(blur.u_image, 0);
      gl.uniform2f(blur.u_along, pass % 2 === 0 ? along : 0, pass % 2 === 0 ? 0 : along);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
    this.shadowIsOld = false;
  }

  drawGround(look, matrix) {
    const gl = this.gl;
    if (!this.square || look.camera.eye()[1] < this.square[3]) return;
    const at = this.use(GROUND);
    gl.bindVertexArray(null);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    gl.uniformMatrix4fv(at.u_matrix, false, matrix);
    gl.uniform4fv(at.u_square, this.square);
    gl.uniform1f(at.u_strength, look.isDark ? 0.55 : 0.26);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.shadows[0].image);
    gl.uniform1i(at.u_image, 0);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  // Returns the index of the piece at a point of the canvas, CSS pixels; -1: none.
  pick(look, x, y) {
    const gl = this.gl, [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight], camera = look.camera;
    // One pixel of the view, enlarged to the whole of a tiny image.
    const zoom = new Float32Array([width, 0, 0, 0, 0, height, 0, 0, 0, 0, 1, 0,
                                   width - 2 * (x + 0.5), 2 * (y + 0.5) - height, 0, 1]);
    const matrix = multiply(zoom, multiply(camera.projection(width / height, look.radius, look.rise), camera.view()));
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.picking.frame);
    gl.viewport(0, 0, 1, 1);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const at = this.use(PICKED);
    this.place(at, matrix);
    gl.bindVertexArray(this.faces);
    for (const group of this.groups) if (group.material !== null || look.showGhosts) this.triangles(group);
    const pixel = new Uint8Array(4);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.bindVertexArray(null);
    return pixel[3] === 0 ? -1 : pixel[0] + 256 * pixel[1] - 1;
  }
}

const linearFromByte = byte => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);

// The image, or a smaller one where the graphics card has no texture of its size.
function fitted(image, most) {
  const longest = Math.max(image.width, image.height);
  if (longest <= most) return image;
  const canvas = document.createElement('canvas');
  canvas.width = Math.max(1, Math.floor(image.width * most / longest));
  canvas.height = Math.max(1, Math.floor(image.height * most / longest));
  canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas;
}
