/* A scene in other units, and far from the origin. Units are powers of two, so that no number is rounded. */
#include "tests/adversary/adversary.h"

#include <math.h>

void adv_round_to_units(adv_scene *s) {
  for (int i = 0; i < s->n; i++)
    for (int c = 0; c < 3; c++) {
      volatile double moved = s->x[i][c] + s->units.offset[c];
      s->x[i][c] = moved - s->units.offset[c];
    }
}

/* A function of time of values of a unit; a ramp's rate and a pulse's height are told by what a means. */
static void scale_wave(adv_wave *f, double value, double time) {
  bool ramp = f->shape == ADV_RAMP, phase = f->shape == ADV_SINE;
  f->a *= ramp ? value / time : value, f->b *= value;
  f->w *= f->shape == ADV_SINE ? 1 / time : time;
  f->t0 *= time, f->t1 *= phase ? 1 : time;
}

static void scale_vector(adv_vector *v, double value, double time) {
  for (int c = 0; c < 3; c++) v->base[c] *= value;
  scale_wave(&v->wave, value, time); /* along has no unit */
}

static void scale_force(adv_force *f, const adv_units *u) {
  double acceleration = u->length / (u->time * u->time), force = f->per_mass ? 1 : u->mass;
  f->from *= u->time, f->to *= u->time;
  for (int e = 0; e < f->edges; e++) f->rest[e] *= u->length;
  f->k *= u->mass / (u->time * u->time) / (f->law == ADV_CUBIC ? u->length * u->length : 1);
  f->damping *= u->mass / u->time;
  f->softening *= u->length;
  scale_wave(&f->strength, force * acceleration * pow(u->length, -f->power), u->time);
  if (f->law == ADV_GRAVITY) scale_vector(&f->vector, acceleration, u->time);
  if (f->law == ADV_CENTRAL) scale_vector(&f->vector, u->length, u->time);
  if (f->law == ADV_MAGNETIC) scale_vector(&f->vector, force / u->time, u->time);
  if (f->law == ADV_DRAG) f->amount *= force / u->time;
  for (int c = 0; c < 3 && f->law == ADV_CENTRAL; c++) f->vector.base[c] += u->offset[c] * u->length;
}

void adv_scene_in_units(const adv_scene *from, adv_scene *s) {
  const adv_units *u = &from->units;
  *s = *from;
  s->units = (adv_units){1, 1, 1, {0}};
  s->fps /= u->time, s->dt *= u->time;
  for (int i = 0; i < s->n; i++) {
    s->mass[i] *= u->mass;
    for (int c = 0; c < 3; c++) {
      s->x[i][c] = (s->x[i][c] + u->offset[c]) * u->length;
      s->v[i][c] *= u->length / u->time;
    }
  }
  for (int k = 0; k < s->forces; k++) scale_force(&s->force[k], u);
  for (int k = 0; k < s->pins; k++) scale_vector(&s->pin[k].path, u->length, u->time), s->pin[k].release *= u->time;
}
