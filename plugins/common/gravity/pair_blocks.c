/* The blocks of a Jacobian pair by pair. */
#include "plugins/common/gravity/pair_blocks.h"

#include <string.h>

/* The pairs in their order: calls `visit` with the number of pairs before. */
static void each_pair(const hk_gravity_bodies *g, void (*visit)(void *, size_t, uint32_t, uint32_t), void *context) {
  size_t pair = 0;
  for (size_t j = 0; j < g->sources; j++)
    for (size_t k = g->mutual ? j + 1 : g->sources; k < g->count; k++) visit(context, pair++, g->order[j], g->order[k]);
}

static void name_pair(void *context, size_t pair, uint32_t i, uint32_t j) {
  hk_pattern *pattern = context;
  (void)pair;
  pattern->block(pattern, i, i);
  pattern->block(pattern, j, j);
  pattern->block(pattern, i, j);
  pattern->block(pattern, j, i);
}

void hk_pair_pattern(const hk_gravity_bodies *g, hk_pattern *pattern) { each_pair(g, name_pair, pattern); }

typedef struct task {
  const hk_view *view;
  double G, softening;
  const hk_blocks *into;
} task;

/* Across d the force pulls back, 1/s^3; along it it gives way, 1/s^3 - 3 d^2/s^5, but within the softening. The latter
 * is what a definite block leaves out. */
static void pair_block(const task *t, uint32_t i, uint32_t j, double K[9]) {
  const double *x = t->view->x, *mass = t->view->model->mass;
  double d[3], d2 = 0;
  for (size_t c = 0; c < 3; c++) d[c] = x[3 * (size_t)j + c] - x[3 * (size_t)i + c], d2 += d[c] * d[c];
  double s2 = d2 + t->softening * t->softening, across = t->G * mass[i] * mass[j] / (s2 * sqrt(s2));
  double along = across * (1 - 3 * d2 / s2);
  if (t->into->want & HK_WANT_DEFINITE) along = fmax(0, along);
  for (int q = 0; q < 9; q++) K[q] = across * (q % 4 == 0) + (d2 > 0 ? (along - across) / d2 * d[q / 3] * d[q % 3] : 0);
}

static void add_pair(void *context, size_t pair, uint32_t i, uint32_t j) {
  const task *t = context;
  double K[9];
  pair_block(t, i, j, K);
  for (size_t b = 0; b < 4; b++) {
    double *into = t->into->K + 9 * t->into->slot[4 * pair + b];
    for (int q = 0; q < 9; q++) into[q] += b < 2 ? K[q] : -K[q];
  }
}

void hk_pair_jacobian(const hk_gravity_bodies *g, const hk_view *view, double G, double softening,
                      const hk_blocks *into) {
  task t = {view, G, softening, into};
  each_pair(g, add_pair, &t);
}
