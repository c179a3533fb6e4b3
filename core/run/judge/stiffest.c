/* The force that swings fastest at the present state: the largest frequency of each alone, by power iteration on
 * M^-1 K, with differences of the force for K. The iteration stops short of the last digits: it is for a name in a
 * message. */
#include "core/run/judge/judge.h"

#include <stdlib.h>
#include <string.h>

enum { ITERATIONS = 12 };
static const double apart = 1e-6; /* of the extent: displacements of the differences */

typedef struct probe {
  hk_loop *loop;
  size_t n;
  double *X, *rest, *F, *y; /* the displaced state, F there and at rest, the direction; one allocation, at X */
} probe;

/* Sets *F to the force number k at the present state displaced by `scale` y. */
static bool force_at(const probe *p, size_t k, double scale, double *F) {
  memcpy(p->X, p->loop->state->X, p->loop->state->size * sizeof *p->X);
  for (size_t e = 0; e < 3 * p->n; e++) p->X[e] += scale * p->y[e];
  return hk_query_force(p->loop->dynamics, k, p->X, p->n, F);
}

/* y = -M^-1 dF, of which pinned particles have none; the norm of y by masses before. */
static double next_direction(const probe *p, double scale) {
  const hk_state *s = p->loop->state;
  double sum = 0;
  for (size_t e = 0; e < 3 * p->n; e++) {
    double w = s->inverse_mass[e / 3];
    p->y[e] = w * (p->rest[e] - p->F[e]) / scale;
    if (w > 0) sum += p->y[e] * p->y[e] / w;
  }
  double norm = sqrt(sum);
  for (size_t e = 0; e < 3 * p->n && norm > 0; e++) p->y[e] /= norm;
  return norm;
}

/* 1/s; 0: it does not swing, or nothing is known of it. */
static double frequency(const probe *p, size_t k) {
  const hk_state *s = p->loop->state;
  uint64_t random[4];
  double found = 0, largest = 0;
  hk_random_seed(random, k + 1);
  for (size_t e = 0; e < 3 * p->n; e++)
    p->y[e] = s->inverse_mass[e / 3] > 0 ? sqrt(s->inverse_mass[e / 3]) * (hk_random_uniform(random) - 0.5) : 0;
  if (!force_at(p, k, 0, p->rest)) return 0;
  for (int i = 0; i < ITERATIONS; i++) {
    largest = 0;
    for (size_t e = 0; e < 3 * p->n; e++) largest = fmax(largest, fabs(p->y[e]));
    if (!(largest > 0)) return 0;
    double scale = apart * hk_state_extent(s) / largest;
    if (!(scale > 0) || !force_at(p, k, scale, p->F)) return 0;
    double norm = next_direction(p, scale);
    if (i > 0) found = norm; /* the first direction has another norm */
  }
  return isfinite(found) ? sqrt(found) : 0;
}

const char *hk_stiffest_force(hk_loop *loop, double *w) {
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  size_t n = loop->state->model.n, size = loop->state->size;
  probe p = {.loop = loop, .n = n, .X = malloc((size + 9 * n + 3) * sizeof(double))};
  const char *label = NULL;
  *w = 0;
  if (!p.X) return NULL;
  p.rest = p.X + size;
  p.F = p.rest + 3 * n + 1;
  p.y = p.F + 3 * n + 1;
  for (size_t k = 0; k < forces->count; k++) {
    bool acts = loop->dynamics->force_acts[k] && forces->item[k]->plugin->force->flags & HK_DEPENDS_ON_X;
    double found = acts ? frequency(&p, k) : 0;
    if (!(found > *w)) continue;
    *w = found;
    label = forces->item[k]->label;
  }
  free(p.X);
  return label;
}
