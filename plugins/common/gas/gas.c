/* The memory of a gas, the walk over its grid, and what is read from it. */
#include "plugins/common/gas/gas.h"

enum { ARRAYS = 3 * HK_GAS_FIELDS /* now, before, work */ + 2 /* impulses */ + 3 /* rate */ };

double hk_gas_bytes(const double cells[3]) {
  return hk_liquid_bytes(cells) + 8.0 * ARRAYS * (cells[0] + 2) * (cells[1] + 2) * (cells[2] + 2);
}

hk_status hk_gas_open_fields(hk_gas *s, const hk_host *host) {
  hk_liquid_grid *g = &s->flow.grid;
  s->host = host;
  bool all = (s->impulse_before = host->allocate(host, g->size * sizeof(double))) != NULL;
  for (int f = 0; f < HK_GAS_FIELDS; f++) {
    double **own = f < 3 ? &s->rate[f] : &s->before[f];
    all &= (*own = host->allocate(host, g->size * sizeof(double))) != NULL;
    all &= (s->work[f] = host->allocate(host, g->size * sizeof(double))) != NULL;
  }
  if (!all)
    return host->fail(host, HK_NO_MEMORY, "no memory for a gas on %zu x %zu x %zu cells: take larger ones", g->cells[0],
                      g->cells[1], g->cells[2]);
  for (int f = 0; f < HK_GAS_FIELDS; f++) s->from[f] = f < 3 ? g->push[f] : s->before[f];
  for (int c = 0; c < 3; c++) s->along[c] = g->before[c];
  for (size_t i = 0; i < g->size; i++) {
    g->distance[i] = 1;                              /* beyond open sides there is air */
    for (int c = 0; c < 3; c++) g->weight[c][i] = 1; /* no face lacks a velocity */
  }
  return HK_OK;
}

void hk_gas_close(hk_gas *s) {
  if (!s->host) return;
  for (int f = 0; f < HK_GAS_FIELDS; f++) {
    s->host->release(s->host, f < 3 ? s->rate[f] : s->before[f]);
    s->host->release(s->host, s->work[f]);
  }
  s->host->release(s->host, s->impulse_before);
  hk_liquid_close(&s->flow);
  s->host = NULL;
}

typedef struct walk {
  const hk_gas_task *task;
  hk_gas_body body;
} walk;

static void walk_rows(void *context, size_t begin, size_t end, size_t piece) {
  const walk *w = context;
  const hk_liquid_grid *g = &w->task->gas->flow.grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 1);
    for (size_t i = row.first; i <= row.first + g->cells[hk_liquid_inner(g)]; i++) w->body(w->task, &row, i);
  }
}

void hk_gas_each(const hk_gas_task *t, hk_gas_body body) {
  walk w = {t, body};
  t->gas->host->parallel_for(t->gas->host, hk_liquid_rows(&t->gas->flow.grid, 1), 16, walk_rows, &w);
}

double hk_gas_value(const hk_gas *s, const double *field, int f, const double x[3]) {
  hk_liquid_place at;
  hk_liquid_locate(&s->flow.grid, x, &at);
  return hk_liquid_value(&s->flow.grid, field, &at, f < 3 ? f : 3);
}

double hk_gas_courant(const hk_gas *s, double *const velocity[3], double h) {
  const hk_liquid_grid *g = &s->flow.grid;
  double most = 0;
  for (int c = 0; c < 3; c++)
    for (size_t i = 0; i < g->size && !g->flat[c]; i++) most = fmax(most, fabs(velocity[c][i]) * h / g->spacing[c]);
  return most;
}
