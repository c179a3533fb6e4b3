/* Forces of short range that steps pass by. A particle that goes by such a force between two evaluations misses its
 * impulse, and with half the step it does so, too, as long as that is many ranges: two runs agree, both wrong. The
 * force names the moves that come near (hk_encounters_facet), and what they miss is computed on the straight line
 * through the move and as much before and after it: the integral of F, less what the four ends of these three steps
 * make of it by the trapezoidal rule. The errors of neighbouring steps cancel where the steps resolve the force (on a
 * long line to e^(-2 pi b/L) for a distance b and steps L), so a resolved encounter misses next to nothing. The nodes
 * of the integral lie at range sinh(theta) from the nearest point: as dense as the range there, and few however long
 * the move.
 *
 * An encounter counts where it misses more than a fifth of the integral of the size of a part of F, along or across; a
 * method of high order may be far better than the trapezoidal rule below that, and half the step shows the error. The
 * change of velocity dv that was missed becomes dv (T - t) by a later time T, for particles that nothing holds. The
 * record has the moments in t of dv^2, from which the sum over all encounters, taken for independent of each other,
 * follows for every T. */
#include "core/engine/contract/contract.h"
#include "core/run/judge/judge.h"

#include <float.h>
#include <stdio.h>

static const double few_ranges = 4, /* where F = r^-p no shorter move misses a fifth, for p from 1 to 20 */
    spacing = 0.25,                 /* of theta; an error below 1e-3 of the integral for p up to 20 */
    fifth = 0.2;                    /* F = r^-2: moves above 2.1 b; r^-12: above 0.9 b */
enum { LEAST_INTERVALS = 8 };

typedef struct collector {
  hk_encounters encounters; /* first member: the table that forces get */
  hk_loop *loop;
  uint32_t force;
  double h;
  double enough; /* s, a step of a few ranges on the present encounter */
} collector;

typedef void force_at(const void *self, const double r[3], double F[3]);

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void at(const hk_encounter *p, double u, force_at *force, const void *self, double F[3]) {
  double r[3];
  for (int c = 0; c < 3; c++) r[c] = p->r[c] + u * p->dr[c];
  force(self, r, F);
}

/* Parts of F along the move and across it, on opposite sides of the nearest point of opposite and of equal sign: what
 * is missed of one says nothing of the other. */
typedef struct parts {
  double along, across[3];
} parts;

static parts split(const double F[3], const double *dr, double length) {
  parts p = {dot(F, dr) / length, {0}};
  for (int c = 0; c < 3; c++) p.across[c] = F[c] - p.along * dr[c] / length;
  return p;
}

static double across(const parts *p) { return sqrt(dot(p->across, p->across)); }

static void add_parts(parts *sum, const parts *p, double weight) {
  sum->along += weight * p->along;
  for (int c = 0; c < 3; c++) sum->across[c] += weight * p->across[c];
}

/* N: adds the integral of F over u from -1 to 2 to `sum`, and those of the sizes of its parts to `size`. u = nearest +
 * width sinh(theta). */
static void integrate(const hk_encounter *p, double length, force_at *force, const void *self, parts *sum,
                      double size[2]) {
  double nearest = -dot(p->r, p->dr) / (length * length), width = p->range / length;
  double first = asinh((-1 - nearest) / width), last = asinh((2 - nearest) / width);
  int count = (int)fmax(LEAST_INTERVALS, ceil((last - first) / spacing));
  double step = (last - first) / count;
  for (int k = 0; k <= count; k++) {
    double theta = first + k * step, F[3], weight = width * cosh(theta) * step * (k == 0 || k == count ? 0.5 : 1);
    at(p, nearest + width * sinh(theta), force, self, F);
    parts here = split(F, p->dr, length);
    add_parts(sum, &here, weight);
    size[0] += weight * fabs(here.along);
    size[1] += weight * across(&here);
  }
}

/* N, over the time of one step, what the ends of the steps do not show of F; 0 where that is less than a fifth. */
static double unseen(const hk_encounter *p, double length, force_at *force, const void *self) {
  parts missed = {0};
  double size[2] = {0};
  integrate(p, length, force, self, &missed, size);
  for (int u = -1; u <= 2; u++) {
    double F[3], weight = u == -1 || u == 2 ? 0.5 : 1;
    at(p, u, force, self, F);
    parts here = split(F, p->dr, length);
    add_parts(&missed, &here, -weight);
  }
  double along = fabs(missed.along) > fifth * size[0] ? missed.along : 0,
         sideways = across(&missed) > fifth * size[1] ? across(&missed) : 0,
         most = sqrt(along * along + sideways * sideways);
  return isfinite(most) ? most : 0;
}

static void note(const collector *w, uint32_t i, double dv) {
  hk_record *r = w->loop->record;
  double t = w->loop->state->t;
  r->passed[0] += dv * dv;
  r->passed[1] += dv * dv * t;
  r->passed[2] += dv * dv * t * t;
  if (!(dv > r->passed_most)) return;
  r->passed_most = dv;
  r->passed_at = t;
  r->passed_dt = w->enough;
  r->passed_id = w->loop->state->id[i];
  r->passed_force = w->force;
}

/* No encounter does more than turn the motion back: the impulse along the straight line would, where the particle is
 * deflected strongly. What goes straight through a point where F is infinite has no straight line to judge by. */
static void add(hk_encounters *encounters, const hk_encounter *p, force_at *force, const void *self) {
  collector *w = (collector *)(void *)encounters;
  const double *inverse_mass = w->loop->state->inverse_mass;
  double length = sqrt(dot(p->dr, p->dr)), of_i = inverse_mass[p->i],
         of_other = p->other == p->i ? 0 : inverse_mass[p->other];
  if (!(length > few_ranges * p->range) || !(p->range > DBL_MIN * length) || !(of_i + of_other > 0)) return;
  double most = 2 * length / w->h, dv = fmin(w->h * unseen(p, length, force, self) * (of_i + of_other), most);
  if (!(dv > 0)) return;
  w->enough = w->h * few_ranges * p->range / length;
  note(w, p->i, dv * of_i / (of_i + of_other));
  if (p->other != p->i) note(w, p->other, dv * of_other / (of_i + of_other));
}

static bool has_encounters(const hk_instance *force) { return hk_force_of(force->plugin)->encounters.find != NULL; }

bool hk_missed_encounters_asks(const hk_loop *loop) {
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  for (size_t k = 0; k < forces->count; k++)
    if (has_encounters(forces->item[k])) return true;
  return false;
}

/* With the parameters of the present time; an error of theirs is dropped, because the next evaluation reports it. */
static bool set_time(hk_loop *loop, hk_instance *force) {
  hk_error kept = *loop->error;
  if (force->spec->timed_count == 0) return true;
  loop->dynamics->timed_at = NAN;
  bool set = hk_instance_set_time(force, loop->state->t, loop->error) == HK_OK;
  *loop->error = kept;
  return set;
}

void hk_missed_encounters_note(hk_loop *loop, double h) {
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  collector w = {.encounters.add = add, .loop = loop, .h = h};
  bool more = false;
  for (size_t k = 0; k < forces->count; k++) {
    hk_instance *force = forces->item[k];
    if (!has_encounters(force)) continue;
    if (!loop->dynamics->force_acts[k] || !set_time(loop, force)) {
      more = true;
      continue;
    }
    hk_view view = hk_force_view_at(loop->dynamics, k, loop->state->t, loop->state->X, loop->state->model.n);
    w.force = (uint32_t)k;
    const hk_instance *outer = hk_enter(force);
    more |= hk_force_of(force->plugin)->encounters.find(force->self, &view, loop->X_before, &w.encounters);
    hk_leave(force, outer);
  }
  if (!more) loop->hooks.moved = NULL;
}

double hk_missed_encounters_error(const hk_loop *loop) {
  const double *sum = loop->record->passed;
  double t = loop->state->t, square = t * t * sum[0] - 2 * t * sum[1] + sum[2];
  return loop->state->model.n ? sqrt(fmax(0, square) / (double)loop->state->model.n) : 0;
}
