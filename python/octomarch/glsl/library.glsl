// What shaders are put together from: fields, operators and light, by the formulas of docs/semantics.md. library.py takes
// from here what a shader needs: a block ends at a blank line, and needs those whose names stand in it.

float infinity() {
  return uintBitsToFloat(0x7F800000u);
}

float no_number() {
  return uintBitsToFloat(0x7FC00000u);
}

float box_distance(vec2 q) {
  return length(max(q, 0.0)) + min(max(q.x, q.y), 0.0);
}

float sphere(vec3 p, float radius) {
  return length(p) - radius;
}

float box(vec3 p, vec3 half_edges) {
  vec3 q = abs(p) - half_edges;
  return length(max(q, 0.0)) + min(max(max(q.x, q.y), q.z), 0.0);
}

float box_exterior(vec3 p, vec3 half_edges) {
  return length(max(abs(p) - half_edges, 0.0));
}

float box_maximum(vec3 p, vec3 half_edges) {
  vec3 q = abs(p) - half_edges;
  return max(max(q.x, q.y), q.z);
}

// p counts across, along and across the axis
float capped_cylinder(vec3 p, float radius, float half_height) {
  return box_distance(vec2(length(p.xz) - radius, abs(p.y) - half_height));
}

// p counts across, along and across the axis
float torus(vec3 p, float radius, float tube_radius) {
  return length(vec2(length(p.xz) - radius, p.y)) - tube_radius;
}

float capsule(vec3 p, vec3 a, vec3 b, float radius) {
  vec3 along = b - a;
  float square = dot(along, along);
  float t = square > 0.0 ? clamp(dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return length(p - a - t * along) - radius;
}

float segment_distance(vec2 p, vec2 a, vec2 b) {
  vec2 along = b - a;
  float square = dot(along, along);
  float t = square > 0.0 ? clamp(dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return length(p - a - t * along);
}

// Does a ray from p to +x cross the edge from a to b?
bool crosses(vec2 p, vec2 a, vec2 b) {
  if ((a.y > p.y) == (b.y > p.y)) return false;
  float side = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
  return b.y > a.y ? side > 0.0 : side < 0.0;
}

float capped_cone(vec3 p, float radius_bottom, float radius_top, float half_height) {
  vec2 q = vec2(length(p.xz), p.y);
  vec2 bottom = vec2(radius_bottom, -half_height);
  vec2 top = vec2(radius_top, half_height);
  float d = segment_distance(q, vec2(0.0, bottom.y), bottom);
  d = min(d, segment_distance(q, bottom, top));
  d = min(d, segment_distance(q, top, vec2(0.0, top.y)));
  return crosses(q, bottom, top) ? -d : d;
}

float octahedron(vec3 p, float radius) {
  p = abs(p);
  float excess = p.x + p.y + p.z - radius;
  vec3 q = p.zxy;
  if (3.0 * p.x < excess) q = p;
  else if (3.0 * p.y < excess) q = p.yzx;
  else if (3.0 * p.z >= excess) return excess * 0.57735027;
  float along = clamp(0.5 * (q.z - q.y + radius), 0.0, radius);
  return length(vec3(q.x, q.y - radius + along, q.z - along));
}

float pyramid(vec3 p, float edge, float half_height) {
  float height = 2.0 * half_height;
  float up = p.y + half_height;
  vec2 q = abs(p.xz);
  q = q.x < q.y ? q.yx : q;
  float slope = length(vec2(edge, height));
  vec2 climb = slope > 0.0 ? vec2(edge, height) / slope : vec2(0.0);
  float beside = q.x - edge;
  float over_side = beside * climb.y + up * climb.x;
  float climbed = up * climb.y - beside * climb.x;
  float inside = max(over_side, -up);
  if (inside < 0.0) return inside;
  float below = beside <= 0.0 ? abs(up) : length(vec3(beside, up, max(q.y - edge, 0.0)));
  vec3 ridge = vec3(-edge, height, -edge);
  vec3 from_corner = vec3(q.x - edge, up, q.y - edge);
  float square = dot(ridge, ridge);
  float walked = square > 0.0 ? clamp(dot(from_corner, ridge) / square, 0.0, 1.0) : 0.0;
  bool on_side = slope > 0.0 && climbed >= 0.0 && climbed <= slope && q.y * slope <= edge * (slope - climbed);
  return min(on_side ? abs(over_side) : length(from_corner - walked * ridge), below);
}

float rectangle(vec2 p, vec2 half_edges) {
  return box_distance(abs(p) - half_edges);
}

// No distance: only its sign counts.
float solid(float condition) {
  return condition != 0.0 ? -8.6736174e-19 : 8.6736174e-19;
}

float overlap(float gap, float k) {
  float h = max(k - abs(gap), 0.0);
  return h * (h * (0.25 / k));
}

float smooth_union(float a, float b, float k) {
  return min(a, b) - overlap(a - b, k);
}

float smooth_intersection(float a, float b, float k) {
  return max(a, b) + overlap(a - b, k);
}

float smooth_difference(float a, float b, float k) {
  return max(a, -b) + overlap(a + b, k);
}

float log_of_one_plus(float x) {
  float u = 1.0 + x;
  return u == 1.0 ? x : log(u) * (x / (u - 1.0));
}

float metaballs(float a, float b, float k) {
  return min(a, b) - k * log_of_one_plus(exp(-abs(a - b) / k));
}

float extrusion(float flat_distance, float z, float half_height) {
  return box_distance(vec2(flat_distance, abs(z) - half_height));
}

// Number of the cell nearest to x: whole, or half more where the count is even.
float cell(float x, float period, float shift, float limit) {
  return clamp(floor(x / period + shift) + (0.5 - shift), -limit, limit);
}

float repeated(float x, float period, float shift, float limit) {
  return x - period * cell(x, period, shift, limit);
}

// The same from the next cell on the side where x lies.
float repeated_beside(float x, float period, float shift, float limit) {
  float own = cell(x, period, shift, limit);
  float side = x - own * period < 0.0 ? -1.0 : 1.0;
  return x - period * clamp(own + side, -limit, limit);
}

vec2 turned(vec2 p, float angle) {
  float c = cos(angle);
  float s = sin(angle);
  return vec2(c * p.x - s * p.y, s * p.x + c * p.y);
}

// p drawn to the axis until it lies within the radius
vec2 drawn_in(vec2 p, float radius) {
  float far = length(p);
  return far > radius ? p * (radius / far) : p;
}

float power(float x, float y) {
  if (y == 0.0) return 1.0;
  if (x == 0.0) return y > 0.0 ? 0.0 : infinity();
  float size = pow(abs(x), y);
  if (x > 0.0) return size;
  if (y != floor(y)) return no_number();
  return mod(y, 2.0) == 0.0 ? size : -size;
}

float angle_of(float y, float x) {
  return x == 0.0 && y == 0.0 ? 0.0 : atan(y, x);
}

float permuted(float n) {
  n -= 289.0 * floor((n + 0.5) / 289.0);
  float m = (34.0 * n + 1.0) * n;
  return m - 289.0 * floor((m + 0.5) / 289.0);
}

float along_gradient(float hash, vec3 p) {
  float index = hash - 12.0 * floor((hash + 0.5) / 12.0);
  float plane = floor(index * 0.25);
  float signs = index - 4.0 * plane;
  float first = plane == 2.0 ? p.y : p.x;
  float second = plane == 0.0 ? p.y : p.z;
  return (signs >= 2.0 ? -first : first) + (signs == 1.0 || signs == 3.0 ? -second : second);
}

// K. Perlin, "Improving noise", 2002; hashed as S. Gustavson and I. McEwan do it, "Efficient computational noise in GLSL", 2012
float gradient_noise(float x, float y, float z, float seed) {
  vec3 low = floor(vec3(x, y, z));
  vec3 p = vec3(x, y, z) - low;
  vec3 fade = p * p * p * (p * (p * 6.0 - 15.0) + 10.0);
  float sum = 0.0;
  for (int i = 0; i < 8; i++) {
    vec3 corner = vec3(i & 1, (i >> 1) & 1, i >> 2);
    vec3 at = low + corner;
    vec3 share = mix(1.0 - fade, fade, corner);
    float hash = permuted(permuted(permuted(at.z + seed) + at.y) + at.x);
    sum += share.x * share.y * share.z * along_gradient(hash, p - corner);
  }
  return sum;
}

// wrap 1: repeated to all sides; 2: repeated across, its edge held above and below; 0: edges held
ivec2 wrapped(vec2 at, vec2 size, int wrap) {
  if (wrap != 0) at.x -= size.x * floor(at.x / size.x);
  if (wrap == 1) at.y -= size.y * floor(at.y / size.y);
  return ivec2(clamp(at, vec2(0.0), size - 1.0));
}

struct Material {
  vec3 color;
  float roughness;
  float specular;
  float metallic;
  float reflectivity;
};

// A distance, and what shows there
struct Part {
  float distance;
  Material material;
};

Material chosen(bool first, Material a, Material b) {
  if (first) return a;
  return b;
}

// The share of b
Material mixed(Material a, Material b, float share) {
  if (share <= 0.0) return a;
  if (share >= 1.0) return b;
  return Material(mix(a.color, b.color, share), mix(a.roughness, b.roughness, share),
                  mix(a.specular, b.specular, share), mix(a.metallic, b.metallic, share),
                  mix(a.reflectivity, b.reflectivity, share));
}

// Of the operand that a smooth operator takes, and of the other
Material blended(bool first, float gap, float k, Material a, Material b) {
  float share = max(k - abs(gap), 0.0) * (0.5 / k);
  if (first) return mixed(a, b, share);
  return mixed(b, a, share);
}

Material of_metaballs(float a, float b, float k, Material of_a, Material of_b) {
  return mixed(of_a, of_b, 1.0 / (1.0 + exp((b - a) / k)));
}

Material within_ranges(Material m) {
  return Material(max(m.color, 0.0), clamp(m.roughness, 0.0, 1.0), clamp(m.specular, 0.0, 1.0),
                  clamp(m.metallic, 0.0, 1.0), clamp(m.reflectivity, 0.0, 1.0));
}

vec3 srgb(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308))));
}
