/* A copy of the state, which later steps do not change. */
#include "core/run/judge/judge.h"

#include <stdlib.h>
#include <string.h>

void hk_snapshot_free(hk_snapshot *s) {
  free(s->X);
  free(s->id);
  free(s->mass);
  *s = (hk_snapshot){0};
}

hk_status hk_snapshot_take(hk_snapshot *s, const hk_state *state, hk_error *error) {
  size_t n = state->model.n, size = state->size;
  if (size > s->capacity) {
    hk_snapshot_free(s);
    s->X = malloc(size * sizeof *s->X);
    s->id = malloc((n + 1) * sizeof *s->id);
    s->mass = malloc((n + 1) * sizeof *s->mass);
    if (!s->X || !s->id || !s->mass) return hk_error_set(error, HK_NO_MEMORY, "no memory to keep a good state");
    s->capacity = size;
  }
  s->t = state->t;
  s->n = n;
  s->size = size;
  memcpy(s->X, state->X, size * sizeof *s->X);
  memcpy(s->id, state->id, n * sizeof *s->id);
  memcpy(s->mass, state->mass, n * sizeof *s->mass);
  return HK_OK;
}
