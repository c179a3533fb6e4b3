/* The service "bodies/1": particles that equations join, how they respond to impulses, and their projection. */
#include "core/numerics/constraints/body_response.h"

#include <stdlib.h>
#include <string.h>

static hk_status count(void *self, size_t *bodies) {
  hk_body_list *s = self;
  hk_status status = hk_body_list_update(s);
  *bodies = status == HK_OK ? s->count : 0;
  return status;
}

static uint32_t of(void *self, uint32_t particle) {
  const hk_body_list *s = self;
  return particle < s->particles ? s->of[particle] : UINT32_MAX;
}

static size_t members(void *self, uint32_t body, const uint32_t **particle) {
  const hk_body_list *s = self;
  *particle = s->member + s->member_start[body];
  return s->member_start[body + 1] - s->member_start[body];
}

static size_t edges(void *self, const uint32_t (**pair)[2]) {
  const hk_body_list *s = self;
  *pair = (const uint32_t(*)[2])s->edge;
  return s->edges;
}

static size_t one_sided(void *self, const hk_one_sided **list) {
  const hk_body_list *s = self;
  *list = s->pair;
  return s->one_sided;
}

/* What impacts of one-sided equations take, hk_constraints_project enters into the account of the state. Whoever calls
 * this measures the energy of the whole correction, so it is taken out. */
static hk_status settle(void *self, double t, double *x, double *v) {
  hk_body_list *s = self;
  hk_state *state = s->dynamics->state;
  double work = state->X[state->size - 1];
  s->whole_factored = false;
  if (s->count) memset(s->factored, 0, s->count * sizeof *s->factored);
  if (!s->dynamics->constraints) return HK_OK;
  hk_status status = hk_constraints_project(s->dynamics, t, x, v);
  state->X[state->size - 1] = work;
  return status;
}

const hk_body_service *hk_bodies_table(hk_dynamics *d) {
  if (!d->bodies) d->bodies = calloc(1, sizeof *d->bodies);
  if (!d->bodies) return NULL;
  d->bodies->dynamics = d;
  d->bodies->table = (hk_body_service){.self = d->bodies,
                                       .count = count,
                                       .of = of,
                                       .members = members,
                                       .edges = edges,
                                       .linearise = hk_body_linearise,
                                       .one_sided = one_sided,
                                       .respond = hk_body_respond,
                                       .mobility = hk_body_mobility,
                                       .push = hk_body_push,
                                       .settle = settle};
  return &d->bodies->table;
}

void hk_bodies_close(hk_dynamics *d) {
  if (d->bodies) hk_body_list_free(d->bodies);
  free(d->bodies);
  d->bodies = NULL;
}
