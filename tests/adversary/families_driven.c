/* Families that are driven: orbits and flybys, pins on paths, functions of time, late onsets, channels, and plain
 * scenes that are not to be called wrong. */
#include "tests/adversary/build.h"

#include <math.h>

static const double pi = 3.14159265358979324;

/* Two unit vectors across each other. */
static void plane(uint64_t *seed, double a[3], double b[3]) {
  double c[3], along = 0, square = 0;
  adv_direction(seed, a), adv_direction(seed, c);
  for (int k = 0; k < 3; k++) along += a[k] * c[k];
  for (int k = 0; k < 3; k++) b[k] = c[k] - along * a[k], square += b[k] * b[k];
  for (int k = 0; k < 3; k++) b[k] /= sqrt(square);
}

static adv_force *add_pull(adv_scene *s, double strength, double power, double softening) {
  adv_force *f = adv_add_force(s, ADV_CENTRAL);
  f->strength.b = strength, f->power = power, f->softening = softening, f->per_mass = true;
  return f;
}

/* Orbits of eccentricity 0.5 to 0.99 from either end. */
void adv_make_kepler(adv_scene *s, uint64_t *seed) {
  double e = 1 - adv_log(seed, 0.01, 0.5), size = adv_log(seed, 0.3, 3), period = adv_log(seed, 0.3, 10), a[3], b[3];
  double gm = 4 * pi * pi * size * size * size / (period * period), sign = adv_chance(seed, 0.5) ? 1 : -1;
  double r = size * (1 + sign * e), speed = sqrt(gm * (2 / r - 1 / size)), x[3], v[3];
  plane(seed, a, b);
  for (int c = 0; c < 3; c++) x[c] = r * a[c], v[c] = speed * b[c];
  adv_add_particle(s, adv_log(seed, 0.1, 10), x, v);
  add_pull(s, gm, -2, 0);
  adv_set_end(s, seed, period * adv_uniform(seed, 0.3, 2.2));
  adv_set_step(s, seed, period * pow(1 - e, adv_uniform(seed, 0, 1.5)) / 6);
}

/* A centre that pulls only nearby, passed at speed. */
void adv_make_flyby(adv_scene *s, uint64_t *seed) {
  double soft = adv_log(seed, 1e-4, 0.1), speed = adv_log(seed, 0.5, 30), way = adv_uniform(seed, 0.5, 2), a[3], b[3],
         x[3], v[3];
  double miss = soft * adv_log(seed, 0.03, 30), power = adv_chance(seed, 0.5) ? -2 : -1 - adv_below(seed, 6);
  plane(seed, a, b);
  for (int c = 0; c < 3; c++) x[c] = -way * a[c] + miss * b[c], v[c] = speed * a[c];
  int passer = adv_add_particle(s, adv_log(seed, 0.1, 10), x, v);
  /* Of the scale of the kinetic energy where the pull is strongest. */
  double strength = speed * speed * pow(soft, -power - 1) * adv_log(seed, 0.01, 3) * (adv_chance(seed, 0.8) ? 1 : -1);
  adv_force *f = add_pull(s, strength, power, soft);
  f->only = 1u << passer;
  if (adv_chance(seed, 0.3)) adv_add_gravity(s, 0, 0, -adv_uniform(seed, 0, 1));
  if (adv_chance(seed, 0.3)) { /* a companion that does not pass */
    double far[3] = {5, 5, 5};
    adv_add_particle(s, 1, far, NULL);
  }
  adv_set_end(s, seed, way / speed * adv_uniform(seed, 0.8, 2.5));
  adv_set_step(s, seed, fmax(soft, miss) / speed * adv_log(seed, 0.1, 100));
}

/* ---- Pins on paths ---- */

/* Shaking, also aliased with frames and late in its phase; ramps; jumps; bumps. */
static void random_path(adv_pin *p, uint64_t *seed, const adv_scene *s) {
  double end = adv_scene_end(s), a = adv_log(seed, 1e-3, 0.5), w = adv_log(seed, 5, 3000),
         t0 = adv_uniform(seed, 0, end);
  double late = adv_chance(seed, 0.4) ? adv_log(seed, 1, 1e6 / w) : 0, phase = adv_uniform(seed, 0, 6);
  if (adv_chance(seed, 0.3)) w = 2 * pi * s->fps * (1 + adv_below(seed, 6));
  adv_direction(seed, p->path.along);
  switch (adv_below(seed, 6)) {
  default:
    p->path.wave = (adv_wave){ADV_SINE, a, -a * sin(w * late + phase), w, late, phase};
    break;
  case 3:
    p->path.wave = (adv_wave){ADV_RAMP, adv_log(seed, 0.1, 30), 0, 0, t0, t0 + adv_log(seed, 1e-3, 1) * end};
    break;
  case 4:
    p->path.wave = (adv_wave){ADV_JUMP, a, 0, 0, t0, 0};
    break;
  case 5:
    p->path.wave = (adv_wave){ADV_BUMP, a, 0, adv_log(seed, 1e-3, 1) * end, t0, 0};
    break;
  }
  p->tells_velocity = p->path.wave.shape == ADV_JUMP || p->path.wave.shape == ADV_RAMP || adv_chance(seed, 0.7);
}

void adv_make_shaking(adv_scene *s, uint64_t *seed) {
  double at[3] = {0}, x[3], v[3] = {0}, w = adv_log(seed, 2, 500), mass = adv_log(seed, 0.1, 10), rest;
  adv_add_particle(s, 1, at, NULL);
  adv_direction(seed, x);
  rest = adv_chance(seed, 0.3) ? -2 : 0; /* a spring without a rest length, or one that is relaxed */
  adv_add_particle(s, mass, x, v);
  adv_add_spring(s, ADV_SPRINGS, 0, 1, mass * w * w, 0, rest);
  adv_set_end(s, seed, adv_uniform(seed, 0.2, 1.5));
  adv_pin *p = adv_add_pin(s, 0, ADV_PATH);
  random_path(p, seed, s);
  bool jumps = p->path.wave.shape == ADV_JUMP;
  if (!jumps && adv_chance(seed, 0.3)) s->force[0].damping = adv_log(seed, 0.01, 1) * 2 * mass * w;
  if (adv_chance(seed, 0.3)) adv_add_drag(s, adv_log(seed, 0.1, 10));
  if (adv_chance(seed, 0.3)) adv_add_gravity(s, 0, 0, -9.81);
  if (!jumps && adv_chance(seed, 0.2)) p->release = adv_uniform(seed, 0, adv_scene_end(s));
  adv_set_step(s, seed, fmin(1 / w, p->path.wave.w > 0 ? 1 / p->path.wave.w : 1));
}

/* ---- Functions of time ---- */

/* Pulses of any width, trains and hums that agree with frames or nearly so. */
static adv_wave random_push(uint64_t *seed, const adv_scene *s, double impulse) {
  double end = adv_scene_end(s), width = adv_log(seed, 1e-5, 0.5) * end, t0 = adv_uniform(seed, 0, end - width);
  double rate = s->fps * (adv_chance(seed, 0.5) ? 1 + adv_below(seed, 12) : adv_log(seed, 0.3, 12)), w = 2 * pi * rate;
  double part = adv_uniform(seed, 0.05, 0.9) / rate;
  switch (adv_below(seed, 4)) {
  case 0:
    return (adv_wave){ADV_PULSE, impulse / width, 0, 0, t0, t0 + width};
  case 1:
    return (adv_wave){ADV_TRAIN, impulse / end, 0, 1 / rate, adv_uniform(seed, 0, 1) / rate, part};
  case 2:
    return (adv_wave){ADV_SINE, impulse * w / 3, 0, w, 0, adv_chance(seed, 0.5) ? 0 : adv_uniform(seed, 0, 6)};
  default:
    return (adv_wave){ADV_BUMP, impulse / width, 0, width, t0, 0};
  }
}

void adv_make_pulses(adv_scene *s, uint64_t *seed) {
  double x[3] = {0}, v[3], at[3], impulse = adv_log(seed, 1e-3, 5), w = adv_log(seed, 1, 100);
  int bound = adv_below(seed, 3);
  adv_direction(seed, v);
  adv_add_particle(s, adv_log(seed, 0.1, 10), x, adv_chance(seed, 0.5) ? v : NULL);
  adv_set_end(s, seed, adv_uniform(seed, 0.2, 1.5));
  if (bound) {
    adv_direction(seed, at);
    adv_add_particle(s, 1, at, NULL);
    adv_add_spring(s, ADV_SPRINGS, 0, 1, w * w, bound == 2 ? 0.1 * w : 0, adv_uniform(seed, -0.1, 0.1));
  }
  int kind = adv_below(seed, 5);
  adv_force *f = adv_add_force(s, kind == 3 ? ADV_CENTRAL : kind == 4 ? ADV_MAGNETIC : ADV_GRAVITY);
  adv_wave push = random_push(seed, s, kind == 4 ? 3 : impulse);
  f->power = 1, f->softening = 0, f->per_mass = true, f->amount = 1;
  adv_direction(seed, kind == 3 ? f->vector.base : f->vector.along);
  *(kind == 3 ? &f->strength : &f->vector.wave) = push;
  if (adv_chance(seed, 0.3)) adv_add_drag(s, adv_log(seed, 0.1, 10));
  adv_set_step(s, seed, push.shape == ADV_SINE ? 1 / push.w : bound ? 1 / w : 0.1);
}

/* Loads, springs, brakes that set in late; springs that harden. */
void adv_make_late(adv_scene *s, uint64_t *seed) {
  double at[3] = {0}, x[3], v[3], w = adv_log(seed, 5, 2000), end = fmin(1.5, adv_log(seed, 5, 500) / w * 2);
  adv_direction(seed, x), adv_direction(seed, v);
  adv_add_particle(s, adv_log(seed, 0.1, 100), at, NULL);
  double mass = adv_log(seed, 0.1, 10), speed = adv_uniform(seed, 0, 5);
  for (int c = 0; c < 3; c++) v[c] *= speed;
  adv_add_particle(s, mass, x, v);
  if (adv_chance(seed, 0.6)) adv_add_pin(s, 0, ADV_FIXED);
  double onset = adv_uniform(seed, 0.2, 0.98) * end;
  adv_law laws[] = {ADV_SPRINGS, ADV_CUBIC, ADV_ROPES};
  adv_law law = laws[adv_below(seed, 3)];
  adv_force *f =
      adv_add_spring(s, law, 0, 1, mass * w * w, 0, adv_chance(seed, 0.5) ? 0 : adv_uniform(seed, -0.2, 0.2));
  if (law == ADV_CUBIC) f->k = mass * w * w / adv_log(seed, 1e-3, 0.1);
  if (law != ADV_CUBIC && adv_chance(seed, 0.4)) f->damping = adv_log(seed, 0.01, 1) * mass * w;
  if (adv_chance(seed, 0.6)) f->from = onset;
  adv_force *load = adv_add_force(s, ADV_GRAVITY);
  adv_set_constant(&load->vector, 0, 0, -adv_log(seed, 1, 1000));
  load->from = adv_uniform(seed, 0.1, 0.98) * end;
  if (adv_chance(seed, 0.3)) load->to = load->from + adv_log(seed, 1e-4, 1) * end;
  if (adv_chance(seed, 0.3))
    adv_add_drag(s, adv_log(seed, 1, 300)), s->force[s->forces - 1].from = adv_uniform(seed, 0, end);
  adv_set_end(s, seed, end);
  adv_set_step(s, seed, 1 / w);
}

/* Stiff rates on a particle that flies by itself. */
void adv_make_channels(adv_scene *s, uint64_t *seed) {
  double x[3] = {0}, v[3], fast = adv_log(seed, 1, 3e4);
  adv_direction(seed, v);
  adv_add_particle(s, 1, x, v);
  if (adv_chance(seed, 0.5)) adv_add_gravity(s, 0, 0, -9.81);
  s->kinetics = (adv_kinetics)(ADV_DECAY + adv_below(seed, 4));
  s->rate[0] = fast, s->initial[0] = 1, s->size = 1;
  if (s->kinetics == ADV_RELAXATION) s->rate[1] = adv_log(seed, 1, 100), s->initial[0] = adv_uniform(seed, 0, 2);
  if (s->kinetics == ADV_ROBERTSON) s->size = 3, s->rate[0] = 0.04, s->rate[1] = 30 * fast, s->rate[2] = fast;
  if (s->kinetics == ADV_VAN_DER_POL)
    s->size = 2, s->rate[0] = adv_log(seed, 1, 100), s->rate[1] = adv_log(seed, 1, 100), s->initial[0] = 2;
  adv_set_end(s, seed, adv_uniform(seed, 0.1, 1));
  adv_set_step(s, seed, 1 / fast);
}

/* ---- Plain scenes ---- */

static void make_projectile(adv_scene *s, uint64_t *seed) {
  double x[3] = {0}, v[3];
  for (int c = 0; c < 3; c++) v[c] = adv_uniform(seed, -10, 10);
  adv_add_particle(s, adv_log(seed, 0.1, 10), x, v);
  adv_add_gravity(s, 0, 0, -9.81);
  if (adv_chance(seed, 0.6)) adv_add_drag(s, adv_log(seed, 0.1, 300));
  adv_set_end(s, seed, adv_uniform(seed, 0.3, 2));
  adv_set_step(s, seed, 0.1);
}

static void make_gyration(adv_scene *s, uint64_t *seed) {
  double x[3] = {0}, v[3], w = adv_log(seed, 1, 100);
  adv_direction(seed, v);
  adv_add_particle(s, 1, x, v);
  adv_force *f = adv_add_force(s, ADV_MAGNETIC);
  f->per_mass = true, f->amount = 1;
  adv_set_constant(&f->vector, 0, 0, w);
  if (adv_chance(seed, 0.3)) adv_add_gravity(s, 1, 0, 0);
  adv_set_end(s, seed, adv_uniform(seed, 1, 20) / w);
  adv_set_step(s, seed, 1 / w);
}

static void make_overdamped(adv_scene *s, uint64_t *seed) {
  double at[3] = {0}, x[3], w = adv_log(seed, 5, 200);
  adv_direction(seed, x);
  adv_add_particle(s, 1, at, NULL);
  adv_add_particle(s, 1, x, NULL);
  adv_add_pin(s, 0, ADV_FIXED);
  adv_add_spring(s, ADV_SPRINGS, 0, 1, w * w, adv_log(seed, 1, 30) * 2 * w, adv_uniform(seed, -0.3, 0.3));
  adv_add_drag(s, adv_log(seed, 0.1, 10) * w);
  adv_set_end(s, seed, adv_uniform(seed, 0.3, 2));
  adv_set_step(s, seed, 1 / w);
}

/* An upright spring pendulum, a little off: it falls. */
static void make_inverted(adv_scene *s, uint64_t *seed) {
  double at[3] = {0}, x[3] = {adv_log(seed, 1e-5, 0.1), 0, 1}, w = adv_log(seed, 10, 200);
  adv_add_particle(s, 1, at, NULL);
  adv_add_particle(s, 1, x, NULL);
  adv_add_pin(s, 0, ADV_FIXED);
  adv_add_spring(s, ADV_SPRINGS, 0, 1, w * w, adv_uniform(seed, 0, w), 9.81 / (w * w));
  adv_add_gravity(s, 0, 0, -9.81);
  adv_set_end(s, seed, adv_uniform(seed, 0.3, 2));
  adv_set_step(s, seed, 1 / w);
}

/* A chain that hangs straight, at rest or let down a little. */
static void make_hanging(adv_scene *s, uint64_t *seed) {
  int links = 1 + adv_below(seed, 5);
  double w = adv_log(seed, 20, 500), drop = adv_chance(seed, 0.5) ? 0 : adv_log(seed, 1e-4, 0.1), x[3] = {0};
  for (int i = 0; i <= links; i++, x[2] -= 0.2) adv_add_particle(s, 1, x, NULL);
  adv_add_pin(s, 0, ADV_FIXED);
  adv_force *f = adv_add_force(s, ADV_SPRINGS);
  f->k = w * w, f->damping = adv_chance(seed, 0.5) ? 0 : 0.3 * w;
  for (int i = 1; i <= links; i++) adv_add_edge(s, f, i - 1, i, -9.81 * (links - i + 1) / (w * w) - drop);
  adv_add_gravity(s, 0, 0, -9.81);
  adv_set_end(s, seed, adv_uniform(seed, 0.3, 1));
  adv_set_step(s, seed, 1 / w);
}

static void make_jumping(adv_scene *s, uint64_t *seed) {
  double at[3] = {0}, x[3], w = adv_log(seed, 3, 60);
  adv_direction(seed, x);
  adv_add_particle(s, 1, at, NULL);
  adv_add_particle(s, 1, x, NULL);
  adv_add_spring(s, ADV_SPRINGS, 0, 1, w * w, 0, 0);
  adv_set_end(s, seed, adv_uniform(seed, 0.3, 1.5));
  adv_pin *p = adv_add_pin(s, 0, ADV_PATH);
  adv_direction(seed, p->path.along);
  p->path.wave = (adv_wave){ADV_JUMP, adv_log(seed, 0.01, 0.5), 0, 0, adv_uniform(seed, 0, 1) * adv_scene_end(s), 0};
  adv_set_step(s, seed, 1 / w);
}

void adv_make_plain(adv_scene *s, uint64_t *seed) {
  static void (*const makes[])(adv_scene *, uint64_t *) = {make_projectile, make_gyration, make_overdamped,
                                                           make_inverted,   make_hanging,  make_jumping};
  makes[adv_below(seed, 6)](s, seed);
}
