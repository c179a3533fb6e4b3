/* The list of families, and what they build scenes with. A new family goes to the end: its place is part of the seed.
 */
#include "tests/adversary/build.h"

#include <math.h>
#include <string.h>

const adv_family adv_families[] = {
    {"rope", adv_make_rope},         {"kepler", adv_make_kepler},         {"ringing", adv_make_ringing},
    {"light", adv_make_light},       {"shaking", adv_make_shaking},       {"pulses", adv_make_pulses},
    {"flyby", adv_make_flyby},       {"wells", adv_make_wells},           {"late", adv_make_late},
    {"channels", adv_make_channels}, {"plain", adv_make_plain},           {"network", adv_make_network},
    {"tumbling", adv_make_tumbling}, {"parametric", adv_make_parametric}, {"buckling", adv_make_buckling},
    {"bars", adv_make_bars},         {"turns", adv_make_turns},           {"units", adv_make_units},
};
const int adv_families_count = sizeof adv_families / sizeof *adv_families;

void adv_scene_make(adv_scene *s, int family, uint64_t seed) {
  uint64_t state = seed + (uint64_t)family * 0x632be59bd9b4e019u;
  memset(s, 0, sizeof *s);
  s->family = family, s->seed = seed, s->dt = NAN, s->tol = NAN;
  s->units = (adv_units){1, 1, 1, {0}};
  adv_families[family].make(s, &state);
  if (adv_chance(&state, 0.4)) s->tol = adv_log(&state, 1e-10, 1e-2);
}

int adv_add_particle(adv_scene *s, double mass, const double x[3], const double v[3]) {
  s->mass[s->n] = mass;
  for (int c = 0; c < 3; c++) s->x[s->n][c] = x[c], s->v[s->n][c] = v ? v[c] : 0;
  return s->n++;
}

adv_force *adv_add_force(adv_scene *s, adv_law law) {
  adv_force *f = &s->force[s->forces++];
  f->law = law, f->from = 0, f->to = INFINITY;
  return f;
}

void adv_add_edge(const adv_scene *s, adv_force *f, int i, int j, double slack) {
  double square = 0;
  for (int c = 0; c < 3; c++) square += (s->x[i][c] - s->x[j][c]) * (s->x[i][c] - s->x[j][c]);
  f->edge[f->edges][0] = i, f->edge[f->edges][1] = j;
  f->rest[f->edges++] = fmax(0, sqrt(square) + slack);
}

adv_pin *adv_add_pin(adv_scene *s, int particle, adv_hold hold) {
  adv_pin *p = &s->pin[s->pins++];
  *p = (adv_pin){.particle = particle, .hold = hold, .release = INFINITY, .tells_velocity = true};
  for (int c = 0; c < 3; c++) /* hooke takes velocities away that a pin forbids */
    if (!((hold == ADV_LINE && c == p->axis) || (hold == ADV_PLANE && c != p->axis))) s->v[particle][c] = 0;
  return p;
}

void adv_set_constant(adv_vector *v, double x, double y, double z) {
  double base[3] = {x, y, z};
  *v = (adv_vector){{0}, {0}, {0}};
  memcpy(v->base, base, sizeof base);
}

void adv_add_gravity(adv_scene *s, double x, double y, double z) {
  adv_set_constant(&adv_add_force(s, ADV_GRAVITY)->vector, x, y, z);
}

void adv_add_drag(adv_scene *s, double rate) {
  adv_force *f = adv_add_force(s, ADV_DRAG);
  f->per_mass = true, f->amount = rate;
}

adv_force *adv_add_spring(adv_scene *s, adv_law law, int i, int j, double k, double damping, double slack) {
  adv_force *f = adv_add_force(s, law);
  f->k = k, f->damping = damping;
  adv_add_edge(s, f, i, j, slack);
  return f;
}

void adv_set_end(adv_scene *s, uint64_t *seed, double end) {
  static const double usual[] = {24, 25, 30, 50, 60, 100, 120, 240, 500, 1000};
  double wanted = adv_log(seed, 8, 120) / end, best = usual[0];
  for (int k = 0; k < 10; k++)
    if (fabs(log(usual[k] / wanted)) < fabs(log(best / wanted))) best = usual[k];
  bool far = best > 4 * wanted || best < wanted / 4;
  s->fps = far || adv_chance(seed, 0.2) ? wanted : best;
  s->frames = (int)fmax(2, round(end * s->fps));
}

void adv_set_step(adv_scene *s, uint64_t *seed, double time) {
  double dt = time * adv_log(seed, 0.001, 2);
  if (adv_chance(seed, 0.5)) return;
  s->dt = fmax(dt, adv_scene_end(s) / 20000); /* milliseconds for every method */
}
