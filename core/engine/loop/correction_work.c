/* See correction_work.h. A method that lets what bears a load fall in a step, and has it put back, makes its error
 * along that fall too, and the way back has none. So the work of a correction is what particles gain in kinetic energy
 * beyond the work of all forces along the straight way from the start of the step to the corrected end, by the mean of
 * both ends, less what the method strays from that by itself: the sum of m (v'.v' - v.v)/2 - (F + F').(x' - x)/2 in the
 * free step, with the forces at x and x' for the velocity (x' - x)/h; where forces are linear that is what it damps. Of
 * a particle that was corrected it counts across its change of velocity only: along this the motion is not the
 * method's. */
#include "core/engine/loop/correction_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct step {
  const hk_state *s;
  const double *before, *free, *now; /* states, the last corrected */
  double *a[2], *x, *v, *rates;      /* accelerations at both ends, n x 3; of an evaluation: where, and behind v in X */
} step;

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Across the unit vector n; 0: in all directions. */
static double across(const double *n, const double *a, const double *b) { return dot(a, b) - dot(a, n) * dot(b, n); }

/* J, of the free step and all free particles. */
static double strayed(const step *p) {
  double sum = 0;
  for (size_t i = 0, n = p->s->model.n; i < n; i++) {
    const double *v = p->before + 3 * (n + i), *v_to = p->free + 3 * (n + i), *v_now = p->now + 3 * (n + i);
    double along[3], mean[3], way[3];
    if (!(p->s->inverse_mass[i] > 0)) continue;
    for (size_t c = 0; c < 3; c++) {
      along[c] = v_now[c] - v_to[c];
      mean[c] = (p->a[0][3 * i + c] + p->a[1][3 * i + c]) / 2;
      way[c] = p->free[3 * i + c] - p->before[3 * i + c];
    }
    double change = sqrt(dot(along, along));
    for (int c = 0; c < 3 && change > 0; c++) along[c] /= change;
    sum += p->s->mass[i] * ((across(along, v_to, v_to) - across(along, v, v)) / 2 - across(along, mean, way));
  }
  return sum;
}

/* J, along the straight way from X_before to the state `to` at one speed: of all forces on free particles, and of pins
 * and forces without a potential. */
static hk_status work_along(hk_loop *loop, step *p, const double *to, double h, double *forces, double *rest) {
  size_t n = p->s->model.n;
  hk_status status = HK_OK;
  *forces = *rest = 0;
  for (int k = 0; k < 2 && status == HK_OK; k++) {
    const double *X = k ? to : p->before;
    memcpy(p->x, X, 3 * n * sizeof *X);
    for (size_t e = 0; e < 3 * n; e++) p->v[e] = (to[e] - p->before[e]) / h;
    status = loop->dynamics->system.accelerations(&loop->dynamics->system, p->s->t - (1 - k) * h, p->x, p->v, X + 6 * n,
                                                  p->a[k], p->rates);
    for (size_t i = 0; i < n; i++)
      if (p->s->inverse_mass[i] > 0) *forces += h / 2 * p->s->mass[i] * dot(p->a[k] + 3 * i, p->v + 3 * i);
    *rest += h / 2 * p->rates[p->s->size - 6 * n - 1];
  }
  return status;
}

hk_status hk_correction_work(hk_loop *loop, double h, hk_corrected *out) {
  const hk_state *s = loop->state;
  const hk_counts counted = loop->dynamics->count;
  size_t v = 3 * s->model.n, last = s->size - 1;
  double *room = malloc((2 * v + s->size) * sizeof *room), forces, rest;
  step p = {s, loop->X_before, loop->X_end, s->X, {room, room + v}, room + 2 * v, room + 3 * v, room + 4 * v};
  if (!room) return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the work of a correction");
  hk_status status = work_along(loop, &p, p.free, h, &forces, &rest);
  double own = status == HK_OK ? strayed(&p) : 0;
  if (status == HK_OK) status = work_along(loop, &p, p.now, h, &forces, &rest);
  out->correction = hk_state_kinetic(s, p.now) - hk_state_kinetic(s, p.before) - forces - own;
  out->work = status == HK_OK ? out->correction + rest - (p.free[last] - p.before[last]) : NAN;
  free(room);
  loop->dynamics->count = counted;
  if (status != HK_OK) hk_error_clear(loop->error);
  return HK_OK;
}
