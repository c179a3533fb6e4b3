/* NAME: a floor that particles bounce from, with restitution e. Describe here the correction and its source. */
#include "core/plugin.h"

typedef struct NAME {
  double height; /* m */
  double e;
} NAME;

static const hk_param params[] = {
    {"height", "m", "of the floor", .number = HK_AT(NAME, height), .flags = HK_TIMED},
    {"e", "", "speed after a bounce by that before", .number = HK_AT(NAME, e), .initial = {0.5},
     .limits = HK_WITHIN(0, 1)},
    {0},
};

/* Called after every step. What lies below the floor is mirrored at it, and comes back e times as fast. */
static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  const NAME *p = self;
  for (size_t i = 0; i < view->n; i++) {
    double *z = c->x + 3 * i + 2, *v = c->v + 3 * i + 2;
    if (*z >= p->height || view->model->inverse_mass[i] == 0) continue;
    *z = p->height + p->e * (p->height - *z);
    if (*v < 0) *v = -p->e * *v;
    c->changed = true;
  }
  return HK_OK;
}

/* m: how deep the deepest particle is below the floor. */
static double violation(void *self, const hk_view *view) {
  const NAME *p = self;
  double most = 0;
  for (size_t i = 0; i < view->n; i++)
    if (view->model->inverse_mass[i] > 0) most = fmax(most, p->height - view->x[3 * i + 2]);
  return most;
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector), .correct = correct, .violation = violation};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "NAME",
    .summary = "a floor that particles bounce from, v' = -e v",
    .reference = "",
    .instance_size = sizeof(NAME),
    .params = params,
    .corrector = &corrector,
};
