// GLSL of the map: a face is one instance of a square, with eight bytes of its own (faces.js).

export const FACE_VERTEX = `
precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 modelViewMatrix;
uniform float resolution_m;
in vec3 position;   // corner of the unit square
in vec4 voxel;      // x, y, z in the group; direction
in vec4 seen;       // stamp, low and high byte; shade of the corners
out vec2 corner;
flat out float stamp;
flat out int direction;
flat out vec4 shades;
void main() {
  direction = int(voxel.w + 0.5);
  int axis = direction >> 1;
  bool isUpper = (direction & 1) == 1;
  corner = vec2(isUpper ? position.x : 1.0 - position.x, position.y);
  vec3 at;
  at[axis] = isUpper ? 1.0 : 0.0;
  at[(axis + 1) % 3] = corner.x;
  at[(axis + 2) % 3] = corner.y;
  stamp = seen.x + 256.0 * seen.y;
  int packed_shades = int(seen.z + 0.5);
  shades = vec4(packed_shades & 3, (packed_shades >> 2) & 3, (packed_shades >> 4) & 3, packed_shades >> 6);
  gl_Position = projectionMatrix * modelViewMatrix * vec4((voxel.xyz + at) * resolution_m, 1.0);
}`;

export const FACE_FRAGMENT = `
precision highp float;
uniform float clock_s;
uniform float staleStamp;
uniform float ageMax_s;
uniform vec3 fresh[4];
uniform vec3 old[4];
uniform vec3 background;
in vec2 corner;
flat in float stamp;
flat in int direction;
flat in vec4 shades;
out vec4 colour;
const float LIGHT[6] = float[6](0.80, 0.86, 0.74, 0.92, 0.62, 1.0);
void main() {
  int kind = int(mod(stamp, 4.0) + 0.5);
  float age = clamp((clock_s - floor(stamp / 4.0)) / ageMax_s, 0.0, 1.0);
  bool isStale = stamp < staleStamp || stamp <= 4.0;
  vec3 base = mix(fresh[kind], old[kind], isStale ? 1.0 : age * 0.85);
  float shade = mix(mix(shades.x, shades.y, corner.x), mix(shades.z, shades.w, corner.x), corner.y);
  vec2 width = fwidth(corner);
  vec2 inside = smoothstep(vec2(0.0), max(width * 1.2, vec2(0.03)), min(corner, 1.0 - corner));
  float visible = 1.0 - smoothstep(0.15, 0.45, max(width.x, width.y));
  float line = 1.0 - 0.22 * visible * (1.0 - min(inside.x, inside.y));
  // Stale voxels have stripes, so that they differ without colour.
  float stripe = isStale ? 1.0 - 0.18 * visible * step(0.5, fract((corner.x + corner.y) * 2.0)) : 1.0;
  colour = vec4(base * LIGHT[direction] * (1.0 - 0.17 * shade) * line * stripe, 1.0);
}`;

export const HAZE_FRAGMENT = `
precision highp float;
uniform vec3 tint;
uniform float opacity;
in vec2 corner;
flat in float stamp;
flat in int direction;
flat in vec4 shades;
out vec4 colour;
void main() { colour = vec4(tint, opacity); }`;

export const POINT_VERTEX = `
precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 modelViewMatrix;
uniform float resolution_m;
uniform float pointScale;
in vec4 voxel;
void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4((voxel.xyz + 0.5) * resolution_m, 1.0);
  gl_PointSize = clamp(0.16 * resolution_m * pointScale / gl_Position.w, 1.0, 8.0);
}`;

export const POINT_FRAGMENT = `
precision highp float;
uniform vec3 tint;
out vec4 colour;
void main() { colour = vec4(tint, 0.7); }`;
