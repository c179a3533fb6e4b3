/* The lists in which it is noted what one-sided equations do within a step (release.c), for the equations that there
 * are. */
#include "core/numerics/constraints/constraints.h"

#include <stdlib.h>

hk_status hk_releases_open(hk_dynamics *d) {
  hk_releases *r = &d->constraints->releases;
  size_t m = d->constraints->equations + 1;
  bool **sets[] = {&r->acts, &r->freed, &r->rests};
  double **lists[] = {&r->before, &r->most, &r->after, &r->scale, &r->slope};
  bool fine = true;
  for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) fine &= (*sets[k] = calloc(m, sizeof **sets[k])) != NULL;
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
    fine &= (*lists[k] = calloc(m + d->state->size, sizeof **lists[k])) != NULL;
  return fine ? HK_OK : hk_error_set(d->error, HK_NO_MEMORY, "no memory for the constraints");
}

static void forget_releases(hk_constraints *c) {
  hk_releases *r = &c->releases;
  for (size_t k = 0; k < c->equations; k++) {
    r->acts[k] = r->freed[k] = false;
    r->before[k] = r->most[k] = 0;
  }
  r->equation = r->cuts = 0;
  r->begin = r->end = r->left = r->until = 0;
}

void hk_constraints_forget(hk_dynamics *d) {
  if (!d->constraints) return;
  d->constraints->kept = false;
  forget_releases(d->constraints);
}

void hk_releases_close(hk_releases *r) {
  void *lists[] = {r->acts, r->freed, r->rests, r->before, r->most, r->after, r->scale, r->slope};
  for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) free(lists[k]);
}
