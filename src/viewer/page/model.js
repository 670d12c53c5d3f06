// The scene in the page's <script> elements, as arrays for WebGL.  docs/viewer.md describes the bytes.

const pause = () => new Promise(go => setTimeout(go));

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

function readScene() {
  const element = document.querySelector('script.scene');
  const scene = JSON.parse(element.textContent);
  element.remove();
  scene.indexOfId = new Map(scene.pieces.map((piece, i) => [piece.id, i]));
  scene.present = scene.pieces.filter(piece => !piece.missing).length;
  scene.hasShape = scene.pieces.some(piece => piece.faces > 0);
  for (const piece of scene.pieces) {
    piece.color = pieceColor(piece.id - 1);
    piece.contacts.sort((a, b) => b[1] - a[1] || a[0] - b[0]);
  }
  return scene;
}

async function readBytes(scene, report) {
  const all = new Uint8Array(scene.bytes);
  const parts = [...document.querySelectorAll('script.meshes')];
  let at = 0;
  for (const part of parts) {
    const bytes = bytesOf(part.textContent);
    all.set(bytes, at);
    at += bytes.length;
    part.remove();
    report(at / scene.bytes);
    await pause();
  }
  return all;
}

async function readTextures(scene) {
  const images = [];
  for (const [i, part] of [...document.querySelectorAll('script.texture')].entries()) {
    try {
      images.push(await createImageBitmap(new Blob([bytesOf(part.textContent)], {type: scene.textures[i]})));
    } catch {
      images.push(null);  // a damaged image: its materials keep their color
    }
    part.remove();
  }
  return images;
}

// Reads numbers of a type from bytes of any alignment.
class Reader {
  constructor(bytes) { this.bytes = bytes; this.at = 0; }
  take(type, count) {
    const size = type.BYTES_PER_ELEMENT * count;
    const own = this.bytes.slice(this.at, this.at + size);
    this.at += size;
    return new type(own.buffer);
  }
}

// Which group of draws a triangle is in: ghosts last, else by material.
const groupOf = (piece, material, materials) => piece.missing ? materials + 1 : material + 1;

// Returns the arrays of all pieces.
//   corners    Uint16Array [n][4]: position on the grid, index of the piece
//   shades     Uint16Array [n][4]: octahedral normal as two Int16, index of the neighbor plus 1 or 0, unused
//   texcoords  Uint16Array [n][2], or null
//   colors     Uint8Array [n][4], or null
//   indices    Uint32Array [3 * faces], in groups
//   groups     [{first, count, material}], material -1: none, null: ghosts
//   ranges     [pieces] [first, count, first, count...] of their indices
//   lines      Uint32Array [2 * lines], and lineRanges likewise
function meshArrays(scene, bytes) {
  const total = {vertices: 0, lines: 0};
  const materials = scene.materials.length, size = new Array(materials + 2).fill(0);
  for (const piece of scene.pieces) {
    total.vertices += piece.vertices;
    total.lines += piece.lines;
    for (const [, material, triangles] of piece.runs) size[groupOf(piece, material, materials)] += 3 * triangles;
  }
  const next = [];
  let sum = 0;
  for (const count of size) {
    next.push(sum);
    sum += count;
  }
  const out = {
    corners: new Uint16Array(4 * total.vertices), shades: new Uint16Array(4 * total.vertices),
    texcoords: scene.texcoords ? new Uint16Array(2 * total.vertices) : null,
    colors: scene.colors ? new Uint8Array(4 * total.vertices) : null,
    indices: new Uint32Array(sum), lines: new Uint32Array(2 * total.lines), ranges: [], lineRanges: [],
    groups: size.map((count, g) => ({first: next[g], count, material: g > materials ? null : g - 1})).filter(g => g.count > 0),
  };
  const reader = new Reader(bytes), at = {vertex: 0, line: 0};
  scene.pieces.forEach((piece, i) => readPiece(scene, piece, i, reader, out, next, at));
  return out;
}

function readPiece(scene, piece, index, reader, out, next, at) {
  const n = piece.vertices, base = at.vertex, {corners, shades} = out;
  const positions = reader.take(Uint16Array, 3 * n), normals = reader.take(Uint16Array, 2 * n);
  for (let v = 0; v < n; ++v) {
    const to = 4 * (base + v);
    for (let axis = 0; axis < 3; ++axis) corners[to + axis] = positions[3 * v + axis];
    corners[to + 3] = index;
    shades[to] = normals[2 * v];
    shades[to + 1] = normals[2 * v + 1];
  }
  if (out.texcoords) out.texcoords.set(reader.take(Uint16Array, 2 * n), 2 * base);
  if (out.colors) {
    const colors = reader.take(Uint8Array, 3 * n);
    for (let v = 0; v < n; ++v) {
      for (let k = 0; k < 3; ++k) out.colors[4 * (base + v) + k] = colors[3 * v + k];
      out.colors[4 * (base + v) + 3] = 255;
    }
  }
  const type = n > 65536 ? Uint32Array : Uint16Array, ranges = [];
  for (const [neighbor, material, triangles] of piece.runs) {
    const faces = reader.take(type, 3 * triangles), group = groupOf(piece, material, scene.materials.length);
    const other = neighbor === 0 ? 0 : (scene.indexOfId.get(neighbor) ?? 65534) + 1;
    ranges.push(next[group], faces.length);
    for (const corner of faces) {
      shades[4 * (base + corner) + 2] = other;
      out.indices[next[group]++] = base + corner;
    }
  }
  out.ranges.push(ranges);
  const lines = reader.take(type, 2 * piece.lines);
  out.lineRanges.push(at.line, lines.length);
  for (const corner of lines) out.lines[at.line++] = base + corner;
  at.vertex += n;
}

// [pieces] the splits above each piece, from the first to the last; empty without splits.
function splitPaths(scene) {
  return scene.pieces.map(piece => {
    const path = [];
    for (let split = piece.split ?? 0; split > 0; split = scene.splits[split - 1]) path.unshift(split);
    return path;
  });
}
