/* The work of a step that correctors end. What contact bears falls in each step by h^2 a/2 and is put back; a method
 * makes its error along that way, and the way back has none. So the work is counted along the way that is left, from
 * the state before the step to the corrected one: what moves on it is given the change of its kinetic energy, of which
 * the forces with a potential have done their mean at both ends times the way. That is exact where forces are linear,
 * and else of the third order in the way that is left. Particles that correctors left as they were, and with the
 * forces that they had, keep the error of the method: theirs is the work of all forces along the step.
 *
 * With K the kinetic energy, F of the forces with a potential and R by how much the kinetic energy of those particles
 * strayed from the work of all forces, W = K' - K - (F + F')/2 (x' - x) - R. It contains the work of pins, of dampers
 * and of all that has no potential, which is subtracted where that of the correctors is wanted, by its power in the
 * middle of the same way. */
#include "core/engine/contract/contract.h"
#include "core/numerics/corrections/corrections.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Room for a state, and for forces in it, or for three times forces; grown where particles are born. */
struct hk_corrections {
  double *X, *F; /* of the size of the state each */
  size_t room_X, room_F;
};

static bool reserve(hk_loop *loop) {
  hk_state *s = loop->state;
  hk_corrections *c = loop->corrections;
  return hk_state_copy(s, &c->X, &c->room_X, s->size) && hk_state_copy(s, &c->F, &c->room_F, s->size);
}

/* Adds to F the forces with a potential at the positions of X, without those of its velocities. */
static bool add_at_rest(hk_loop *loop, const double *X) {
  size_t v = 3 * loop->state->model.n;
  memcpy(loop->corrections->X, X, loop->state->size * sizeof *X);
  memset(loop->corrections->X + v, 0, v * sizeof *X);
  return hk_query_forces(loop->dynamics, loop->corrections->X, true, loop->corrections->F);
}

/* J, of the forces with a potential from the state before the step to the present one. NAN: a force failed. */
static double work_of_potential(hk_loop *loop) {
  const hk_state *s = loop->state;
  const double *F = loop->corrections->F;
  double sum = 0;
  memset(loop->corrections->F, 0, 3 * s->model.n * sizeof *F);
  if (!add_at_rest(loop, loop->X_before) || !add_at_rest(loop, s->X)) return NAN;
  for (size_t e = 0; e < 3 * s->model.n; e++) sum += F[e] * (s->X[e] - loop->X_before[e]);
  return sum / 2;
}

/* The part of a change of velocity, of particle i, that takes back what it has gained in the step: 1 of what bears a
 * load, next to none of what bounces. */
static double borne_part(const hk_loop *loop, size_t i) {
  size_t v = 3 * (loop->state->model.n + i);
  double gained = 0, square = 0;
  for (size_t k = v; k < v + 3; k++) {
    double change = loop->state->X[k] - loop->X_end[k];
    gained -= (loop->X_end[k] - loop->X_before[k]) * change;
    square += change * change;
  }
  if (!(gained > 0)) return 0;
  return gained < square ? gained * gained / (square * square) : 1;
}

/* N, of all forces: before the step, at its end, and as it is corrected. */
typedef struct forces {
  double *before, *end, *now; /* n x 3 */
} forces;

/* A particle of which neither the place nor a force was corrected. */
static bool is_left(const hk_loop *loop, const forces *F, size_t i) {
  bool left = hk_corrected_left(loop->state->X, loop->X_end, loop->state->model.n, i);
  for (size_t k = 3 * i; k < 3 * i + 3; k++) left &= F->end[k] == F->now[k];
  return left;
}

/* J, twice the R of a particle that was left. */
static double strayed_left(const hk_loop *loop, const forces *F, size_t i) {
  const double *from = loop->X_before, *to = loop->X_end;
  double sum = 0;
  for (size_t k = 3 * i, v = k + 3 * loop->state->model.n; k < 3 * i + 3; k++, v++)
    sum += loop->state->mass[i] * (to[v] * to[v] - from[v] * from[v]) - (F->before[k] + F->end[k]) * (to[k] - from[k]);
  return sum;
}

/* J, twice the change of h/2 F.v of another particle, without what is borne of F. */
static double lag_of_corrected(const hk_loop *loop, const forces *F, size_t i, double h) {
  const double *from = loop->X_before, *now = loop->state->X;
  double sum = 0;
  for (size_t k = 3 * i, v = k + 3 * loop->state->model.n; k < 3 * i + 3; k++, v++)
    sum += F->now[k] * now[v] - F->before[k] * from[v];
  return h * (1 - borne_part(loop, i)) * sum;
}

/* J, R of methods that do not say it. Those of order 1 have at the end of a step the velocity of its middle, v - h a/2,
 * so that the kinetic energy of all strays by the change of -h/2 F.v, also where something bounces. */
static double strayed_by_forces(hk_loop *loop, double h) {
  const hk_state *s = loop->state;
  size_t count = 3 * s->model.n;
  const forces F = {loop->corrections->F, loop->corrections->F + count, loop->corrections->X};
  double sum = 0;
  memset(loop->corrections->F, 0, 2 * count * sizeof *F.before);
  memset(loop->corrections->X, 0, count * sizeof *F.now);
  if (loop->dynamics->constrain || !hk_query_forces(loop->dynamics, loop->X_before, false, F.before) ||
      !hk_query_forces(loop->dynamics, loop->X_end, false, F.end) ||
      !hk_query_forces(loop->dynamics, s->X, false, F.now))
    return NAN;
  for (size_t i = 0; i < s->model.n; i++) {
    if (!(s->inverse_mass[i] > 0)) continue;
    if (is_left(loop, &F, i))
      sum += strayed_left(loop, &F, i);
    else if (loop->method->order == 1)
      sum -= lag_of_corrected(loop, &F, i, h);
  }
  return sum / 2;
}

static hk_status strayed(hk_loop *loop, double h, double *joule) {
  const hk_corrected_facet *facet = &hk_integrator_tables_of(loop->method)->corrected;
  hk_instance *instance = loop->integrator;
  *joule = NAN;
  if (!facet->account) {
    *joule = strayed_by_forces(loop, h);
    return HK_OK;
  }
  const hk_instance *outer = hk_enter(instance);
  hk_status status =
      facet->account(instance->self, loop->method->method, &loop->dynamics->system, loop->X_end, h, joule);
  return hk_leave_with(instance, outer, "account", status);
}

/* J, of pins and forces without a potential, by their power in the middle of the way; of the step where that is not
 * known. */
static double work_of_the_rest(hk_loop *loop, double h) {
  hk_state *s = loop->state;
  hk_system *system = &loop->dynamics->system;
  size_t v = 3 * s->model.n;
  double *x = loop->corrections->X, *middle = x + v, *y = x + 2 * v, *dy = loop->corrections->F + v;
  double of_step = loop->X_end[s->size - 1] - loop->X_before[s->size - 1];
  if (of_step == 0) return 0;
  memcpy(y, s->X + 2 * v, (s->size - 2 * v) * sizeof *y);
  for (size_t e = 0; e < v; e++) {
    x[e] = (loop->X_before[e] + s->X[e]) / 2;
    middle[e] = (s->X[e] - loop->X_before[e]) / h;
  }
  hk_status status = system->accelerations(system, s->t - h / 2, x, middle, y, loop->corrections->F, dy);
  if (status == HK_OK) return h * dy[s->size - 2 * v - 1];
  hk_error_clear(loop->error);
  return of_step;
}

static hk_status find_work(hk_loop *loop, double h, hk_work_of_step *out) {
  const hk_state *s = loop->state;
  double beyond = NAN;
  if (!reserve(loop)) return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the work of a correction");
  double potential = work_of_potential(loop), rest = work_of_the_rest(loop, h);
  hk_status status = strayed(loop, h, &beyond);
  out->all = hk_state_kinetic(s, s->X) - hk_state_kinetic(s, loop->X_before) - potential - beyond;
  out->corrections = out->all - rest;
  return status;
}

hk_status hk_corrections_open(hk_loop *loop) {
  loop->corrections = calloc(1, sizeof *loop->corrections);
  loop->work_of_step = find_work;
  return loop->corrections ? HK_OK : hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the work of corrections");
}

void hk_corrections_close(hk_corrections *c) {
  if (!c) return;
  free(c->X);
  free(c->F);
  free(c);
}
