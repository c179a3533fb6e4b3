/* Families on bonds: ropes, ringing pairs, light particles, wells, networks. */
#include "tests/adversary/build.h"

#include <math.h>

static void random_point(uint64_t *seed, double size, double x[3]) {
  for (int c = 0; c < 3; c++) x[c] = adv_uniform(seed, -size, size);
}

static void beside(uint64_t *seed, const double from[3], double distance, double x[3]) {
  double unit[3];
  adv_direction(seed, unit);
  for (int c = 0; c < 3; c++) x[c] = from[c] + distance * unit[c];
}

/* Masses fall or fly with slack ropes that snap taut, once or again and again. */
void adv_make_rope(adv_scene *s, uint64_t *seed) {
  double at[3] = {0}, x[3], v[3], k = adv_log(seed, 30, 1e6), light = 1;
  int links = 1 + adv_below(seed, 3);
  adv_add_particle(s, adv_log(seed, 0.1, 1e3), at, NULL);
  for (int i = 1; i <= links; i++) {
    double mass = adv_log(seed, 0.1, 10);
    light = fmin(light, mass);
    beside(seed, s->x[i - 1], adv_uniform(seed, 0.2, 0.9), x);
    random_point(seed, 3, v);
    adv_add_particle(s, mass, x, v);
  }
  if (adv_chance(seed, 0.7)) adv_add_pin(s, 0, ADV_FIXED);
  double damping = adv_chance(seed, 0.5) ? 0 : adv_log(seed, 0.003, 1) * 2 * sqrt(k * light);
  adv_force *f = adv_add_force(s, ADV_ROPES);
  f->k = k, f->damping = damping;
  for (int i = 1; i <= links; i++) adv_add_edge(s, f, i - 1, i, adv_uniform(seed, 0.01, 0.6));
  if (adv_chance(seed, 0.7)) adv_add_gravity(s, 0, 0, -9.81);
  adv_set_end(s, seed, adv_uniform(seed, 0.3, 1.5));
  adv_set_step(s, seed, sqrt(light / k) * 3);
}

/* A light pair rings on its own or fixed to a part that does work: a brake, a parachute, a pin that moves. */
void adv_make_ringing(adv_scene *s, uint64_t *seed) {
  double heavy = adv_log(seed, 1, 1e3), light = adv_log(seed, 1e-4, 1e-1), w = adv_log(seed, 30, 5000), at[3] = {0};
  double k = light * w * w, end = adv_uniform(seed, 0.2, 1), amplitude = adv_log(seed, 1e-4, 0.2), x[3], v[3];
  double damping = adv_chance(seed, 0.5) ? 0 : adv_log(seed, 1e-3, 1.5) * 2 * sqrt(k * light);
  random_point(seed, 10, v);
  int work = adv_below(seed, 4), body = adv_add_particle(s, heavy, at, v);
  beside(seed, at, adv_uniform(seed, 1, 2), x);
  int ringer = adv_add_particle(s, light, x, v), partner = body;
  if (adv_chance(seed, 0.5)) {
    beside(seed, x, 1, at);
    partner = adv_add_particle(s, light, at, v);
  }
  adv_add_spring(s, ADV_SPRINGS, ringer, partner, k, damping, amplitude);
  adv_force *brake = work < 2 ? adv_add_force(s, ADV_DRAG) : NULL;
  if (brake) brake->per_mass = true, brake->amount = adv_log(seed, 0.1, 30), brake->only = 1u << body;
  if (work == 1) brake->from = adv_uniform(seed, 0.1, 0.9) * end;
  if (work == 2) {
    adv_pin *p = adv_add_pin(s, body, ADV_PATH);
    adv_direction(seed, p->path.along);
    p->path.wave = (adv_wave){ADV_SINE, adv_log(seed, 0.01, 1), 0, adv_log(seed, 1, 50), 0, 0};
  }
  if (adv_chance(seed, 0.5)) adv_add_gravity(s, 0, 0, -9.81);
  adv_set_end(s, seed, end);
  adv_set_step(s, seed, 1 / w);
}

/* Mass ratios of 1e6 to 1e12. */
void adv_make_light(adv_scene *s, uint64_t *seed) {
  double ratio = adv_log(seed, 1e6, 1e12), heavy = adv_log(seed, 0.1, 100), light = heavy / ratio, at[3] = {0}, x[3],
         v[3];
  double w = adv_log(seed, 20, 2e4), k = light * w * w, end = fmin(2, adv_log(seed, 100, 5000) / w);
  random_point(seed, 2, v);
  adv_add_particle(s, heavy, at, v);
  beside(seed, at, adv_uniform(seed, 0.5, 2), x);
  if (adv_chance(seed, 0.4)) random_point(seed, 5, v);
  adv_add_particle(s, light, x, v);
  adv_add_spring(s, ADV_SPRINGS, 0, 1, k, adv_chance(seed, 0.5) ? 0 : adv_log(seed, 1e-4, 1) * 2 * sqrt(k * light),
                 adv_chance(seed, 0.5) ? 0 : adv_log(seed, 1e-6, 0.2));
  if (adv_chance(seed, 0.5)) { /* the bead has a second heavy partner */
    beside(seed, x, adv_uniform(seed, 0.5, 2), at);
    random_point(seed, 2, v);
    adv_add_particle(s, heavy * adv_log(seed, 0.1, 10), at, v);
    adv_add_edge(s, &s->force[0], 1, 2, 0);
  }
  if (adv_chance(seed, 0.4)) adv_add_gravity(s, 0, 0, -9.81);
  if (adv_chance(seed, 0.3)) s->force[0].to = adv_uniform(seed, 0.1, 0.9) * end; /* lets go */
  if (adv_chance(seed, 0.2)) adv_add_pin(s, 0, ADV_FIXED)->release = adv_uniform(seed, 0.1, 0.9) * end;
  adv_set_end(s, seed, end);
  adv_set_step(s, seed, 1 / w);
}

/* A spinning pair: where it ends is a matter of its phase. */
static void make_spinner(adv_scene *s, uint64_t *seed) {
  double w = adv_log(seed, 10, 300), k = adv_log(seed, 2, 100) * w * w, end = adv_uniform(seed, 1, 60) / w;
  double x[3] = {-0.5}, v[3] = {0, -w / 2, 0};
  for (int i = 0; i < 2; i++, x[0] = -x[0], v[1] = -v[1]) adv_add_particle(s, 1, x, v);
  double damping = adv_chance(seed, 0.5) ? 0 : adv_log(seed, 1e-3, 1) * sqrt(k);
  adv_add_spring(s, ADV_SPRINGS, 0, 1, k, damping, adv_chance(seed, 0.5) ? -w * w / 2 / k : 0);
  adv_set_end(s, seed, adv_chance(seed, 0.5) ? ceil(end * w / 6.283185307179586) * 6.283185307179586 / w : end);
  adv_set_step(s, seed, 1 / sqrt(2 * k));
}

/* A mass between two anchors that are too near for its springs: it settles on one side, or on the other. */
static void make_well(adv_scene *s, uint64_t *seed) {
  double k = adv_log(seed, 20, 2000), x[3] = {-1, 0, 0}, v[3], at[3];
  adv_law law = adv_chance(seed, 0.3) ? ADV_CUBIC : ADV_SPRINGS;
  adv_add_particle(s, 1, x, NULL);
  x[0] = 1;
  adv_add_particle(s, 1, x, NULL);
  random_point(seed, 0.1, at), random_point(seed, 5, v);
  if (adv_chance(seed, 0.5)) at[2] = 0, v[2] = 0;
  int mass = adv_add_particle(s, adv_log(seed, 0.1, 2), at, v);
  adv_add_pin(s, 0, ADV_FIXED), adv_add_pin(s, 1, ADV_FIXED);
  adv_force *f = adv_add_spring(s, law, 0, mass, k, 0, adv_uniform(seed, 0.05, 0.6));
  adv_add_edge(s, f, 1, mass, adv_uniform(seed, 0.05, 0.6));
  if (adv_chance(seed, 0.5)) adv_add_gravity(s, 0, 0, adv_uniform(seed, -3, 3));
  adv_add_drag(s, adv_log(seed, 0.1, 5));
  adv_set_end(s, seed, adv_uniform(seed, 1, 6));
  adv_set_step(s, seed, sqrt(s->mass[mass] / k));
}

void adv_make_wells(adv_scene *s, uint64_t *seed) { (adv_chance(seed, 0.35) ? make_spinner : make_well)(s, seed); }

/* Two masses on springs under a pin, or three about each other: within seconds the start is forgotten. */
void adv_make_tumbling(adv_scene *s, uint64_t *seed) {
  double k = adv_log(seed, 100, 5000), x[3] = {0}, v[3];
  bool hangs = adv_chance(seed, 0.6);
  for (int i = 0; i < 3; i++) {
    random_point(seed, 2, v);
    adv_add_particle(s, adv_log(seed, 0.3, 3), x, v);
    beside(seed, s->x[i], adv_uniform(seed, 0.5, 1.5), x);
  }
  adv_force *f = adv_add_spring(s, ADV_SPRINGS, 0, 1, k, 0, 0);
  adv_add_edge(s, f, 1, 2, 0);
  if (hangs)
    adv_add_pin(s, 0, ADV_FIXED), adv_add_gravity(s, 0, 0, -9.81);
  else
    adv_add_edge(s, f, 2, 0, 0);
  if (adv_chance(seed, 0.3)) adv_add_drag(s, adv_log(seed, 0.01, 1));
  adv_set_end(s, seed, adv_log(seed, 2, 30));
  adv_set_step(s, seed, sqrt(0.3 / k));
}

/* ---- Networks ---- */

static void add_bonds(adv_scene *s, uint64_t *seed) {
  static const adv_law laws[] = {ADV_SPRINGS, ADV_SPRINGS, ADV_ROPES, ADV_CUBIC};
  adv_force *f = adv_add_force(s, laws[adv_below(seed, 4)]);
  f->k = adv_log(seed, 10, 1e5);
  f->damping = adv_chance(seed, 0.5) || f->law == ADV_CUBIC ? 0 : adv_log(seed, 0.01, 1) * sqrt(f->k);
  for (int i = 1; i < s->n; i++) {
    int j = adv_below(seed, i);
    if (adv_chance(seed, 0.8)) adv_add_edge(s, f, j, i, adv_chance(seed, 0.5) ? 0 : adv_uniform(seed, -0.2, 0.2));
  }
  if (f->edges == 0) adv_add_edge(s, f, 0, 1, 0.01);
}

static void random_wave(adv_wave *f, uint64_t *seed, double size, double end) {
  f->shape = adv_chance(seed, 0.5) ? ADV_SINE : ADV_RAMP;
  f->a = adv_log(seed, 0.01, 1) * size;
  f->w = adv_log(seed, 1, 100);
  f->t0 = adv_uniform(seed, 0, end), f->t1 = f->t0 + adv_uniform(seed, 0, 0.3);
}

static void add_event(adv_scene *s, uint64_t *seed, double end) {
  double size = adv_log(seed, 0.1, 10);
  adv_force *f = adv_add_force(s, adv_below(seed, 3) == 0 ? ADV_DRAG : ADV_GRAVITY);
  f->only = adv_chance(seed, 0.5) ? 0 : 1u << adv_below(seed, s->n);
  f->per_mass = true, f->amount = size;
  adv_direction(seed, f->vector.along);
  random_wave(&f->vector.wave, seed, 3 * size, end);
  if (adv_chance(seed, 0.6)) f->from = adv_uniform(seed, 0, end);
  if (adv_chance(seed, 0.4)) f->to = f->from + adv_log(seed, 1e-3, 1) * end;
}

static void add_holds(adv_scene *s, uint64_t *seed, double end) {
  int holds = adv_below(seed, 3);
  for (int k = 0; k < holds && k < s->n - 1; k++) {
    adv_hold hold = (adv_hold)adv_below(seed, 4);
    adv_pin *p = adv_add_pin(s, k, hold);
    if (adv_chance(seed, 0.3)) p->release = adv_uniform(seed, 0, end);
    if (hold != ADV_PATH) continue;
    adv_direction(seed, p->path.along);
    random_wave(&p->path.wave, seed, 0.3, end);
    p->tells_velocity = p->path.wave.shape == ADV_RAMP || adv_chance(seed, 0.5);
  }
}

void adv_make_network(adv_scene *s, uint64_t *seed) {
  int n = 2 + adv_below(seed, 5), bonds = 1 + adv_below(seed, 2), events = adv_below(seed, 3);
  double end = adv_uniform(seed, 0.2, 1.5), x[3], v[3], stiffest = 0;
  for (int i = 0; i < n; i++) {
    random_point(seed, 1, x), random_point(seed, 2, v);
    adv_add_particle(s, adv_log(seed, 0.01, 10), x, v);
  }
  for (int k = 0; k < bonds; k++) add_bonds(s, seed), stiffest = fmax(stiffest, s->force[s->forces - 1].k);
  add_holds(s, seed, end);
  if (adv_chance(seed, 0.6)) adv_add_gravity(s, 0, 0, -9.81);
  if (adv_chance(seed, 0.5)) adv_add_drag(s, adv_log(seed, 0.01, 30));
  for (int k = 0; k < events; k++) add_event(s, seed, end);
  adv_set_end(s, seed, end);
  adv_set_step(s, seed, sqrt(0.1 / stiffest));
}
