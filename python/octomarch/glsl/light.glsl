// How a shader marches, and how it lights what it meets, by the formulas of docs/semantics.md. shader.py writes constants, in
// capitals, and field(), surface() and sky() before it; march(), slope() and lit() as they are needed. A block ends at a
// blank line.

struct Hit {
  int status;
  float t;
};

// Least part of the hit epsilon, and what it grows by with t
vec2 tolerance_from(vec3 o, float least, float slope) {
  vec3 q = abs(o);
  return vec2(max(least, ROUNDING * max(max(q.x, q.y), q.z)), max(ROUNDING, slope));
}

float epsilon_at(vec2 tolerance, float t) {
  return max(tolerance.x, tolerance.y * t);
}

float free_radius(vec3 p) {
  return field(p) / LIPSCHITZ;
}

// How far beyond the empty sphere the next sample may be. before: radius at the last one, stride: the way from there.
float beyond_sphere(float r, float before, float stride) {
  if (stride <= 0.0) return 0.0;
  float growth = min(r - before, 0.9375 * stride);
  return 0.88 * r * (stride + growth) / (stride - growth);
}

// The root of the secant through the last two samples, and through that and the last one
float finished(vec3 o, vec3 d, float t, float r, float before, float stride, float t_max, vec2 tolerance) {
  if (!FINISH || !(r < before)) return t;
  float e = min(t + min(r * stride / (before - r), 32.0 * max(r, 0.0)), t_max);
  float left = free_radius(o + e * d);
  if (abs(left) > epsilon_at(tolerance, e) / 16.0) return t;
  return abs(left) < abs(r - left) ? min(e + left * (e - t) / (r - left), t_max) : e;
}

// Halves the last step, whose ends lie on either side of the surface
float halved(vec3 o, vec3 d, float outside, float inside) {
  for (int i = 0; i < 10; i++) {
    float middle = 0.5 * (outside + inside);
    if (free_radius(o + middle * d) <= 0.0) inside = middle;
    else outside = middle;
  }
  return outside;
}

Hit march_by_spheres(vec3 o, vec3 d, float t_min, vec2 tolerance) {
  float t = t_min;
  float before = 0.0;
  float stride = 0.0;
  float boldness = 0.6;
  for (int i = 0; i < MAX_STEPS; i++) {
    if (t > T_MAX) return Hit(MISS, t);
    float r = free_radius(o + t * d);
    if (isnan(r)) return Hit(NOTHING, t);
    if (LONG_STEPS && stride > before + abs(r)) {
      t += before - stride;
      stride = before;
      boldness = 0.0;
      continue;
    }
    if (r <= epsilon_at(tolerance, t)) {
      if (i == 0) return Hit(NOTHING, t);
      return Hit(HIT, finished(o, d, t, r, before, stride, T_MAX, tolerance));
    }
    float beyond = RELAXED ? boldness * r : LONG_STEPS ? beyond_sphere(r, before, stride) : 0.0;
    float step_size = LONG_STEPS ? max(min(r + beyond, T_MAX - t), r) : max(0.5 * r, r - BIAS);
    before = r;
    stride = step_size;
    t += step_size;
  }
  return Hit(CANDIDATE, min(t, t - stride + before));
}

Hit march_by_steps(vec3 o, vec3 d, float t_min, vec2 tolerance) {
  float t = t_min;
  float before = t_min;
  for (int i = 0; i < MAX_STEPS; i++) {
    if (t > T_MAX) return Hit(MISS, t);
    float r = free_radius(o + t * d);
    if (isnan(r)) return Hit(NOTHING, t);
    if (r <= 0.0) {
      if (i == 0) return Hit(NOTHING, t);
      float outside = max(before, t - max(STEP, epsilon_at(tolerance, before)));
      return Hit(HIT, FINISH ? halved(o, d, outside, t) : t);
    }
    before = t;
    t += max(max(STEP, epsilon_at(tolerance, t)), r - BIAS);
  }
  return Hit(CANDIDATE, t);
}

// How much of a light passes: the least of SHADOW_K r / t, 0 where something is met
float shadow(vec3 o, vec3 d, float t_max) {
  vec2 tolerance = tolerance_from(o, EPSILON, 0.0);
  float t = 0.0;
  float before = 0.0;
  float stride = 0.0;
  float seen = 1.0;
  for (int i = 0; i < MAX_STEPS; i++) {
    if (t > t_max) break;
    float r = free_radius(o + t * d);
    if (SOFT_SHADOWS && t > 0.0) seen = min(seen, SHADOW_K * r / t);
    if (LONG_STEPS && !FIXED_STEPS && stride > before + abs(r)) {
      t += before - stride;
      stride = before;
      continue;
    }
    float epsilon = epsilon_at(tolerance, t);
    if (r <= (FIXED_STEPS ? 0.0 : epsilon)) return 0.0;
    float beyond = !SOFT_SHADOWS || SHADOW_K * r >= 2.0 * t ? beyond_sphere(r, before, stride) : 0.0;
    float step_size = FIXED_STEPS ? max(max(STEP, epsilon), r - BIAS)
                                  : LONG_STEPS ? max(min(r + beyond, t_max - t), r) : max(0.5 * r, r - BIAS);
    before = r;
    stride = step_size;
    t += step_size;
  }
  return clamp(seen, 0.0, 1.0);
}

// Of a solid, of which no distances are known: where its neighbours in a lattice are inside
vec3 away_from_neighbours(vec3 p) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 729; i++) {
    vec3 k = (vec3(i % 9, (i / 9) % 9, i / 81) - 4.0) / 4.0;
    float far = dot(k, k);
    if (far > 0.0 && far <= 1.0 && field(p + NORMAL_STEP * k) < 0.0) sum -= k;
  }
  return sum;
}

vec3 slope_by_tetrahedron(vec3 p) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; i++) {  // a loop, so that field() is compiled once
    vec3 k = 2.0 * vec3(i == 0 || i == 3, i >= 2, i == 1 || i == 3) - 1.0;
    sum += k * field(p + NORMAL_STEP * k);
  }
  return sum;
}

vec3 slope_by_differences(vec3 p) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 6; i++) {
    vec3 k = vec3(i / 2 == 0, i / 2 == 1, i / 2 == 2) * (i % 2 == 0 ? 1.0 : -1.0);
    sum += k * field(p + NORMAL_STEP * k);
  }
  return sum;
}

vec3 normal_at(vec3 p, vec3 d) {
  vec3 g = slope(p);
  float far = length(g);
  return far > 0.0 ? g / far : -d;
}

// Normals that look away are turned square to the ray.
vec3 facing(vec3 n, vec3 d) {
  float away = max(dot(n, d), 0.0);
  if (away == 0.0) return n;
  vec3 sideways = n - away * d;
  float far = length(sideways);
  return far > 0.0 ? sideways / far : -d;
}

// How much of the surroundings is free, by samples along the normal
float ambient_visibility(vec3 o, vec3 n) {
  float sum = 0.0;
  float most = 0.0;
  float weight = 1.0;
  for (int i = 1; i <= OCCLUSION_SAMPLES; i++) {
    weight *= 0.5;
    float share = float(i) / float(OCCLUSION_SAMPLES);
    float height = OCCLUSION_DISTANCE * share * share;
    most += weight * height;
    sum += weight * clamp(height - field(o + height * n), 0.0, height);
  }
  return most > 0.0 ? clamp(1.0 - sum / most, 0.0, 1.0) : 1.0;
}

// Lambert and Phong
vec3 reflected(vec3 irradiance, vec3 toward, float t_max, vec3 o, vec3 n, vec3 d, Material m) {
  float cosine = dot(n, toward);
  if (cosine <= 0.0 || irradiance == vec3(0.0)) return vec3(0.0);
  float seen = SHADOWS ? shadow(o, toward, t_max) : 1.0;
  float alpha = m.roughness * m.roughness;
  float exponent = clamp(2.0 / max(alpha * alpha, 1e-20) - 2.0, 1.0, 8192.0);
  float aligned = clamp(-dot(2.0 * cosine * n - toward, d), 0.0, 1.0);
  float lobe = aligned > 0.0 ? pow(aligned, exponent) : 0.0;
  vec3 highlight = mix(vec3(m.specular), m.color, m.metallic) * lobe;
  return seen * irradiance * ((1.0 - m.metallic) * cosine * m.color + highlight);
}

vec3 directional_light(vec3 toward, vec3 color, vec3 o, vec3 n, vec3 d, Material m) {
  return reflected(color, toward, T_MAX, o, n, d, m);
}

vec3 point_light(vec3 position, vec3 color, int decay, vec3 o, vec3 n, vec3 d, Material m) {
  vec3 way = position - o;
  float far = length(way);
  float strength = decay == 0 ? 1.0 : decay == 1 ? 1.0 / far : 1.0 / (far * far);
  return reflected(strength * color, way / far, far, o, n, d, m);
}

vec3 spot_light(vec3 position, vec3 color, int decay, vec3 axis, float outer, float inner, vec3 o, vec3 n, vec3 d,
                Material m) {
  float x = clamp((dot(normalize(o - position), axis) - outer) / (inner - outer), 0.0, 1.0);
  return point_light(position, x * x * (3.0 - 2.0 * x) * color, decay, o, n, d, m);
}

// What a ray sees, and what mirrors on its way do
vec3 radiance(vec3 o, vec3 d, float t_min, vec2 tolerance) {
  vec3 color = vec3(0.0);
  float share = 1.0;
  for (int bounce = 0; bounce <= BOUNCES; bounce++) {
    Hit hit = march(o, d, t_min, tolerance);
    if (hit.status == NOTHING) break;
    if (hit.status == MISS) return color + share * max(sky(d), 0.0);
    vec3 p = o + hit.t * d;
    vec3 n = normal_at(p, d);
    if (hit.status == CANDIDATE && dot(n, d) >= 0.0) return color + share * max(sky(d), 0.0);
    Material m = surface(p, n);
    n = facing(n, d);
    float away = 2.0 * epsilon_at(tolerance, hit.t);
    vec3 light = lit(p + away * n, n, d, m);
    float mirrored = share * m.reflectivity;
    bool goes_on = bounce < BOUNCES && mirrored > 0.0 && mirrored >= REFLECTION_CUTOFF;
    color += (goes_on ? share - mirrored : share) * light;
    if (!goes_on) break;
    share = mirrored;
    o = p + max(REFLECTION_OFFSET, away) * n;
    d = reflect(d, n);
    t_min = 0.0;
    tolerance = tolerance_from(o, EPSILON, 0.0);
  }
  return color;
}
