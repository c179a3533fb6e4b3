/* Families of textbooks: springs of timed stiffness, struts that buckle, pendulums of bars, many turns; and every other
 * family in other units and far from the origin. */
#include "tests/adversary/build.h"

#include <math.h>

static const double pi = 3.14159265358979324;

static void across(uint64_t *seed, const double along[3], double out[3]) {
  double unit[3], part = 0, square = 0;
  adv_direction(seed, unit);
  for (int c = 0; c < 3; c++) part += unit[c] * along[c];
  for (int c = 0; c < 3; c++) out[c] = unit[c] - part * along[c], square += out[c] * out[c];
  for (int c = 0; c < 3; c++) out[c] /= sqrt(square);
}

/* Hill's equation x'' = -w^2 (1 + depth f(t)) x, f a sine (Mathieu) or on and off (Meissner), in and beside the tongues
 * of resonance 2 w/k; damped, or stopped by a spring that hardens. */
void adv_make_parametric(adv_scene *s, uint64_t *seed) {
  double w = adv_log(seed, 1, 100), depth = adv_log(seed, 0.01, 1.5), turns = adv_log(seed, 2, 60), x[3], v[3],
         at[3] = {0};
  double drive = 2 * w / (1 + adv_below(seed, 3)) * (adv_chance(seed, 0.5) ? 1 : adv_uniform(seed, 0.6, 1.5));
  adv_direction(seed, x), adv_direction(seed, v);
  for (int c = 0; c < 3; c++) x[c] *= adv_chance(seed, 0.1) ? 0 : 0.1, v[c] *= 0.1 * w;
  int mass = adv_add_particle(s, adv_log(seed, 0.01, 10), x, v);
  adv_force *f = adv_add_force(s, ADV_CENTRAL);
  f->per_mass = true, f->power = 1;
  f->strength = (adv_wave){ADV_SINE, depth * w * w, w * w, drive, 0, adv_uniform(seed, 0, 6)};
  if (adv_chance(seed, 0.35)) {
    double period = 2 * pi / drive;
    f->strength = (adv_wave){ADV_TRAIN,
                             depth * w * w,
                             w * w * (1 - depth / 2),
                             period,
                             adv_uniform(seed, 0, 1) * period,
                             adv_uniform(seed, 0.2, 0.8) * period};
  }
  if (adv_chance(seed, 0.4)) adv_add_drag(s, adv_log(seed, 0.001, 0.5) * w);
  if (adv_chance(seed, 0.4)) {
    int anchor = adv_add_particle(s, 1, at, NULL);
    adv_add_pin(s, anchor, ADV_FIXED);
    adv_add_spring(s, ADV_CUBIC, anchor, mass, s->mass[mass] * w * w * adv_log(seed, 0.1, 10), 0, -2);
  }
  adv_set_end(s, seed, turns * 2 * pi / w);
  adv_set_step(s, seed, 1 / w);
}

/* A strut of links under a load that comes at once, slowly or has been there, straight or nearly so; springs over two
 * links are its bending stiffness. */
void adv_make_buckling(adv_scene *s, uint64_t *seed) {
  int n = 3 + adv_below(seed, 5), axis = adv_below(seed, 3);
  double mass = adv_log(seed, 0.01, 1), k = mass * pow(adv_log(seed, 10, 300), 2), load = k * adv_log(seed, 0.003, 0.3);
  double imperfection = adv_chance(seed, 0.4) ? 0 : adv_log(seed, 1e-15, 1e-2),
         end = adv_log(seed, 3, 100) * sqrt(mass / k);
  double along[3] = {axis == 0, axis == 1, axis == 2}, side[3];
  across(seed, along, side);
  for (int i = 0; i < n; i++) {
    double x[3], off = i == 0 || i == n - 1 ? 0 : imperfection * sin(pi * i / (n - 1));
    for (int c = 0; c < 3; c++) x[c] = i * along[c] + off * side[c];
    adv_add_particle(s, mass * (i == n - 1 ? adv_log(seed, 1, 30) : 1), x, NULL);
  }
  adv_add_pin(s, 0, ADV_FIXED);
  adv_pin *slide = adv_add_pin(s, n - 1, ADV_LINE);
  slide->axis = axis;
  adv_force *links = adv_add_force(s, ADV_SPRINGS), *bending = NULL;
  links->k = k, links->damping = adv_chance(seed, 0.5) ? 0 : adv_log(seed, 0.01, 1) * sqrt(k * mass);
  for (int i = 1; i < n; i++) adv_add_edge(s, links, i - 1, i, 0);
  if (adv_chance(seed, 0.6)) bending = adv_add_force(s, ADV_SPRINGS), bending->k = k * adv_log(seed, 0.01, 1);
  for (int i = 2; bending && i < n; i++) adv_add_edge(s, bending, i - 2, i, 0);
  adv_force *push = adv_add_force(s, ADV_GRAVITY);
  push->only = 1u << (n - 1);
  for (int c = 0; c < 3; c++) push->vector.along[c] = -along[c];
  double g = load / s->mass[n - 1];
  push->vector.wave = (adv_wave){ADV_RAMP, g / end, 0, 0, 0, end};
  if (adv_chance(seed, 0.6)) push->vector.wave = (adv_wave){ADV_CONSTANT, 0, g, 0, 0, 0};
  if (adv_chance(seed, 0.5)) adv_add_drag(s, adv_log(seed, 0.01, 1) * sqrt(k / mass));
  adv_set_end(s, seed, end);
  adv_set_step(s, seed, sqrt(0.2 * mass / k));
}

/* A chain of bars under a pin or in free flight, turning as one body at first, with a spring across or none. */
void adv_make_bars(adv_scene *s, uint64_t *seed) {
  int n = 2 + adv_below(seed, 3);
  bool hangs = adv_chance(seed, 0.7), flat = adv_chance(seed, 0.4);
  double spin[3], at[3] = {0}, v[3], rate = adv_log(seed, 0.1, 10), length = adv_log(seed, 0.2, 2);
  adv_direction(seed, spin);
  for (int c = 0; c < 3 && flat; c++) spin[c] = c == 1;
  for (int i = 0; i < n; i++) {
    double unit[3];
    for (int c = 0; c < 3; c++)
      v[c] = rate * (spin[(c + 1) % 3] * at[(c + 2) % 3] - spin[(c + 2) % 3] * at[(c + 1) % 3]);
    adv_add_particle(s, adv_log(seed, 0.03, 30), at, v);
    adv_direction(seed, unit);
    if (flat) unit[0] = cos(rate + i), unit[1] = 0, unit[2] = sin(rate + i);
    double part = length * adv_uniform(seed, 0.3, 1);
    for (int c = 0; c < 3; c++) at[c] += part * unit[c];
  }
  adv_force *bars = adv_add_force(s, ADV_BARS);
  for (int i = 1; i < n; i++) adv_add_edge(s, bars, i - 1, i, 0);
  if (hangs) adv_add_pin(s, 0, ADV_FIXED);
  if (hangs || adv_chance(seed, 0.5)) adv_add_gravity(s, 0, 0, -9.81);
  if (n > 2 && adv_chance(seed, 0.3)) adv_add_spring(s, ADV_SPRINGS, 0, n - 1, adv_log(seed, 1, 1000), 0, 0.1);
  if (adv_chance(seed, 0.3)) adv_add_drag(s, adv_log(seed, 0.01, 3));
  double time = fmin(sqrt(length / 9.81), 1 / rate);
  adv_set_end(s, seed, time * adv_log(seed, 2, 60));
  adv_set_step(s, seed, time / 4);
}

/* Hundreds to thousands of turns: an oscillator, a circle about a star, a gyration. What counts is the phase. */
void adv_make_turns(adv_scene *s, uint64_t *seed) {
  double w = adv_log(seed, 0.01, 1000), turns = adv_log(seed, 100, 1500), x[3], v[3], speed = w, none[3] = {0};
  int kind = adv_below(seed, 3);
  adv_direction(seed, x), across(seed, x, v);
  if (adv_chance(seed, 0.3)) speed *= adv_uniform(seed, 0.8, 1.2);
  for (int c = 0; c < 3; c++) v[c] *= kind == 0 && adv_chance(seed, 0.2) ? 0 : speed;
  adv_add_particle(s, adv_log(seed, 0.1, 10), kind == 2 ? none : x, v);
  adv_force *f = adv_add_force(s, kind == 2 ? ADV_MAGNETIC : ADV_CENTRAL);
  f->per_mass = true, f->power = kind ? -2 : 1, f->strength.b = w * w, f->amount = 1;
  if (kind == 2) f->strength.b = 0, adv_set_constant(&f->vector, w * x[0], w * x[1], w * x[2]);
  double end = turns * 2 * pi / w;
  s->frames = 8 + adv_below(seed, 60), s->fps = s->frames / end;
  if (adv_chance(seed, 0.5)) s->dt = adv_log(seed, 0.003, 0.5) / w;
}

/* Another family with lengths of nanometres to parsecs, masses of 1e-9 to 1e9, or far from the origin. */
void adv_make_units(adv_scene *s, uint64_t *seed) {
  static const int channels = 9;
  int family = adv_below(seed, adv_families_count - 2);
  bool far = adv_chance(seed, 0.4), scaled = !far || adv_chance(seed, 0.3);
  adv_families[family + (family >= channels)].make(s, seed);
  if (scaled) {
    s->units.length = exp2(round(log2(adv_log(seed, 1e-9, 3e16))));
    s->units.mass = exp2(round(log2(adv_log(seed, 1e-9, 1e9))));
    s->units.time = exp2(round(log2(adv_log(seed, 1e-6, 1e6))));
  }
  for (int c = 0; c < 3 && far; c++) s->units.offset[c] = exp2(round(log2(adv_log(seed, 1, 1e8))));
  adv_round_to_units(s);
}
