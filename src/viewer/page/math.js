// Vectors as arrays of three numbers, matrices as 16 by columns, colors.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = a => Math.hypot(a[0], a[1], a[2]);
const unit = a => scale(a, 1 / (length(a) || 1));
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

function multiply(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; ++column) {
    for (let row = 0; row < 4; ++row) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

// A view from `eye` to `target`; `right` and `up` are unit, `back` points from target to eye.
function lookFrom(eye, right, up, back) {
  return new Float32Array([
    right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1]);
}

// fov: of the height, radians.
function perspective(fov, aspect, near, far) {
  const f = 1 / Math.tan(fov / 2);
  return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1,
                           0, 0, 2 * far * near / (near - far), 0]);
}

function orthographic(left, right, bottom, top, near, far) {
  return new Float32Array([2 / (right - left), 0, 0, 0, 0, 2 / (top - bottom), 0, 0, 0, 0, 2 / (near - far), 0,
                           (left + right) / (left - right), (bottom + top) / (bottom - top), (near + far) / (near - far), 1]);
}

function transformed(m, p) {
  const out = [0, 0, 0, 0];
  for (let row = 0; row < 4; ++row) out[row] = m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row];
  return out;
}

// Björn Ottosson's Oklab; chroma is reduced until sRGB has the color.  Returns linear values.
function linearFromOklch(lightness, chroma, hue) {
  for (;; chroma *= 0.95) {
    const a = chroma * Math.cos(hue), b = chroma * Math.sin(hue);
    const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3;
    const rgb = [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                 -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                 -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s];
    if ((Math.min(...rgb) >= 0 && Math.max(...rgb) <= 1) || chroma < 1e-3) return rgb.map(x => clamp(x, 0, 1));
  }
}

const byteFromLinear = x => Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));

// The color of piece n, from 0: that of the preview and of `sherd render`, as sRGB bytes.
function pieceColor(n) {
  const hue = (0.70 + 2.39996323 * n) % (2 * Math.PI);
  return linearFromOklch([0.69, 0.75, 0.63][n % 3], 0.098, hue).map(byteFromLinear);
}

const cssColor = rgb => `rgb(${rgb.join(' ')})`;
