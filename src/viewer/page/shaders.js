// WebGL 2 programs.  Lengths in space are units: the longest side of the box of all pieces is 2.

// The position of a corner: on the grid, then where its piece is.
const PLACE = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
layout(location = 0) in vec3 a_position;
layout(location = 1) in uint a_piece;
layout(location = 2) in vec2 a_normal;
layout(location = 3) in uint a_neighbor;
layout(location = 4) in vec2 a_texcoord;
layout(location = 5) in vec4 a_color;
uniform sampler2D u_offsets;  // of pieces: x, y, z; w: 1 hidden
uniform mat3 u_upright;
uniform vec4 u_grid;          // center on the grid, units per step
uniform mat4 u_matrix;
ivec2 texel(uint piece) { return ivec2(piece & 255u, piece >> 8); }
vec4 offsetOf(uint piece) { return texelFetch(u_offsets, texel(piece), 0); }
vec3 placed(vec4 offset) { return u_upright * ((a_position - u_grid.xyz) * u_grid.w) + offset.xyz; }
vec4 hidden() { return vec4(2.0, 2.0, 2.0, 1.0); }
vec3 normalOf(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return normalize(u_upright * n);
}
`;

const SHADED = [`${PLACE}
uniform mat3 u_turn;         // to the view's axes
uniform mat4 u_view;
uniform sampler2D u_colors;  // of pieces: linear color; a: how much it is faded
uniform int u_mode;          // 0 piece, 1 neighbor, 2 side, 3 source
uniform vec4 u_texcoords;    // origin, step
uniform vec3 u_outside, u_inside;
out vec3 v_normal, v_seen, v_color;
out vec2 v_texcoord;
flat out float v_inside, v_faded;
vec4 colorOf(uint piece) { return texelFetch(u_colors, texel(piece), 0); }
vec3 linear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }
void main() {
  vec4 offset = offsetOf(a_piece), own = colorOf(a_piece);
  vec3 position = placed(offset);
  gl_Position = offset.w == 1.0 ? hidden() : u_matrix * vec4(position, 1.0);
  v_normal = u_turn * normalOf(a_normal);
  v_seen = (u_view * vec4(position, 1.0)).xyz;
  v_inside = a_neighbor > 0u ? 1.0 : 0.0;
  v_faded = own.a;
  v_texcoord = u_texcoords.xy + a_texcoord * u_texcoords.zw;
  if (u_mode == 0) v_color = a_neighbor > 0u ? mix(own.rgb, vec3(0.86, 0.80, 0.71), 0.45) : own.rgb;
  else if (u_mode == 1) v_color = a_neighbor > 65534u ? vec3(0.4) : a_neighbor > 0u ? colorOf(a_neighbor - 1u).rgb : vec3(0.60);
  else if (u_mode == 2) v_color = a_neighbor > 0u ? u_inside : u_outside;
  else v_color = linear(a_color.rgb);
}`, `#version 300 es
precision highp float;
precision highp int;
in vec3 v_normal, v_seen, v_color;
in vec2 v_texcoord;
flat in float v_inside, v_faded;
uniform int u_mode;
uniform sampler2D u_texture;
uniform bool u_hasTexture;
uniform vec3 u_material, u_above, u_paper;
uniform float u_ghost;
out vec4 o_color;
vec3 encoded(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
void main() {
  vec3 n = normalize(v_normal), eye = normalize(-v_seen);
  if (!gl_FrontFacing) n = -n;
  float facing = clamp(dot(n, eye), 0.0, 1.0);
  if (u_ghost > 0.0) {
    float edge = pow(1.0 - facing, 2.0), alpha = u_ghost * (0.11 + 0.55 * edge);
    o_color = vec4(u_paper * alpha, alpha);
    return;
  }
  vec3 color = v_color;
  if (u_mode == 3) {
    color *= u_material;
    if (u_hasTexture) color *= texture(u_texture, vec2(v_texcoord.x, 1.0 - v_texcoord.y)).rgb;
  }
  const vec3 key = normalize(vec3(-0.46, 0.66, 0.60)), fill = normalize(vec3(0.80, 0.05, 0.42));
  float sky = 0.5 + 0.5 * dot(n, u_above);
  float lit = max(dot(n, key), 0.0);
  vec3 light = mix(vec3(0.20, 0.185, 0.175), vec3(0.50, 0.53, 0.57), sky)  // from the ground and the sky
             + vec3(0.82, 0.79, 0.74) * lit + vec3(0.15, 0.165, 0.19) * max(dot(n, fill), 0.0);
  float shine = pow(max(dot(n, normalize(key + eye)), 0.0), 38.0) * 0.10 + pow(1.0 - facing, 4.0) * 0.10 * sky;
  color = color * light + shine * (v_inside > 0.5 ? 0.35 : 1.0);
  color = mix(color, vec3(1.0) - exp(-1.35 * color), 0.55);
  vec3 srgb = encoded(color);
  o_color = vec4(mix(srgb, mix(vec3(dot(srgb, vec3(0.3, 0.59, 0.11))), u_paper, 0.55), v_faded), 1.0);
}`];

// One color: lines, outlines.
const PLAIN = [`${PLACE}
uniform vec2 u_shift;  // in the image
uniform float u_nearer;
void main() {
  vec4 offset = offsetOf(a_piece);
  gl_Position = offset.w == 1.0 ? hidden() : u_matrix * vec4(placed(offset), 1.0);
  gl_Position.xy += u_shift * gl_Position.w;
  gl_Position.z -= u_nearer * gl_Position.w;
}`, `#version 300 es
precision highp float;
uniform vec4 u_color;
out vec4 o_color;
void main() { o_color = u_color; }`];

// The piece's index plus 1, as a color.
const PICKED = [`${PLACE}
flat out uint v_piece;
void main() {
  vec4 offset = offsetOf(a_piece);
  gl_Position = offset.w == 1.0 ? hidden() : u_matrix * vec4(placed(offset), 1.0);
  v_piece = a_piece + 1u;
}`, `#version 300 es
precision highp float;
flat in uint v_piece;
out vec4 o_color;
void main() { o_color = vec4(float(v_piece & 255u), float((v_piece >> 8) & 255u), 0.0, 255.0) / 255.0; }`];

const WHOLE = `#version 300 es
precision highp float;
out vec2 v_at;
void main() {
  v_at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(2.0 * v_at - 1.0, 0.0, 1.0);
}`;

// A shadow's softness: a Gaussian along one axis.
const BLURRED = [WHOLE, `#version 300 es
precision highp float;
in vec2 v_at;
uniform sampler2D u_image;
uniform vec2 u_along;
out vec4 o_color;
void main() {
  float sum = 0.0, all = 0.0;
  for (int i = -12; i <= 12; ++i) {
    float weight = exp(-float(i * i) / 60.0);
    sum += weight * texture(u_image, v_at + float(i) * u_along).a;
    all += weight;
  }
  o_color = vec4(sum / all);
}`];

const GROUND = [`#version 300 es
precision highp float;
out vec2 v_at;
uniform mat4 u_matrix;
uniform vec4 u_square;  // lowest x, z, side, y
void main() {
  v_at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec2 at = u_square.xy + v_at * u_square.z;
  gl_Position = u_matrix * vec4(at.x, u_square.w, at.y, 1.0);
}`, `#version 300 es
precision highp float;
in vec2 v_at;
uniform sampler2D u_image;
uniform float u_strength;
out vec4 o_color;
void main() { o_color = vec4(0.0, 0.0, 0.0, u_strength * texture(u_image, v_at).a); }`];
