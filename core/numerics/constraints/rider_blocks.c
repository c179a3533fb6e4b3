/* Equations on riders: by the chain rule the gradient of g with respect to a carrier is the sum of w dg/dx over its
 * riders. The blocks that plugins name, `given`, may be of riders; those of J, which all else works with, are of their
 * carriers. A carrier that an equation names several times in a row, by riders or itself, has one block of it. In
 * scenes whose equations name no rider both are the same, and nothing of this is kept. */
#include "core/numerics/constraints/constraints.h"

#include <stdlib.h>
#include <string.h>

void hk_rider_blocks_free(hk_rider_blocks *s) {
  free(s->pair);
  free(s->first);
  free(s->J);
  free(s->term);
  *s = (hk_rider_blocks){0};
}

static bool names_riders(const hk_dynamics *d) {
  const hk_block_matrix *list = &d->constraints->list;
  bool any = false;
  for (size_t b = 0; b < list->named && !any && d->state->model.riders; b++)
    any = d->state->pin[list->pair[b][1]] == HK_PIN_RIDES;
  return any;
}

/* The block of the equation and the particle among those from `begin` on, or a new one. */
static uint32_t block_of(hk_block_matrix *list, size_t begin, uint32_t equation, uint32_t particle) {
  for (size_t b = list->named; b-- > begin && list->pair[b][0] == equation;)
    if (list->pair[b][1] == particle) return (uint32_t)b;
  list->naming.block(&list->naming, equation, particle);
  return (uint32_t)list->named - 1;
}

static void spread_block(hk_dynamics *d, hk_rider_blocks *s, uint32_t given, size_t begin) {
  hk_block_matrix *list = &d->constraints->list;
  uint32_t equation = s->pair[given][0], particle = s->pair[given][1];
  const hk_rider *r = hk_model_rider(&d->state->model, particle);
  for (uint32_t k = 0; k < (r ? r->carriers : 1) && !list->no_memory; k++) {
    hk_rider_term *term = &s->term[s->terms++];
    term->given = given;
    term->weight = r ? r->weight[k] : 1;
    term->block = block_of(list, begin, equation, r ? r->carrier[k] : particle);
  }
}

hk_status hk_rider_blocks_spread(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  hk_rider_blocks *s = &c->riding;
  size_t constraints = d->plugins->kind[HK_CONSTRAINT].count;
  if (!names_riders(d)) return HK_OK;
  s->given = c->list.named;
  s->pair = c->list.pair;
  c->list.pair = NULL;
  s->first = malloc((constraints + 1) * sizeof *s->first);
  s->J = calloc(s->given, sizeof *s->J);
  s->term = malloc(HK_CARRIERS * s->given * sizeof *s->term);
  if (!s->first || !s->J || !s->term) return HK_NO_MEMORY;
  memcpy(s->first, c->block_first, (constraints + 1) * sizeof *s->first);
  hk_block_matrix_begin(&c->list, c->equations, d->state->model.n);
  for (size_t k = 0; k < constraints; k++) {
    for (size_t b = s->first[k]; b < s->first[k + 1]; b++) spread_block(d, s, (uint32_t)b, c->block_first[k]);
    c->block_first[k + 1] = c->list.named;
  }
  c->blocks = c->list.named;
  return c->list.no_memory ? HK_NO_MEMORY : HK_OK;
}

void hk_rider_blocks_carry(const hk_constraints *c, double (*J)[3]) {
  const hk_rider_blocks *s = &c->riding;
  memset(J, 0, c->blocks * sizeof *J);
  for (size_t k = 0; k < s->terms; k++) {
    const hk_rider_term *term = &s->term[k];
    for (int a = 0; a < 3; a++) J[term->block][a] += term->weight * s->J[term->given][a];
  }
}
