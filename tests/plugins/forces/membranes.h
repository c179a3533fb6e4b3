/* A material of each energy, and a sheet of it that is crumpled and moves: for the tests of the force membrane. */
#ifndef HK_TEST_MEMBRANES_H
#define HK_TEST_MEMBRANES_H

#include "tests/support/force_check.h"
#include "tests/support/sheets.h"

#include <stdlib.h>

/* A material of each energy: orthotropic where there is such a one. */
typedef struct material {
  const char *model;
  double stiffness, weft, shear, nu, damping; /* weft, shear 0: not given */
} material;

static const material MATERIAL[] = {
    {"baraff_witkin", 3, 1.5, 0.4, 0, 0.2}, {"stvk", 3, 1.5, 0.4, 0.35, 0.2}, {"stvk", 2, 0, 0, 0.25, 0},
    {"neo_hookean", 3, 0, 0, 0.5, 0.2},     {"neo_hookean", 3, 0, 0, 0.3, 0}, {"neo_hookean", 3, 0, 0, 0, 0.1}};
enum { MATERIALS = sizeof MATERIAL / sizeof *MATERIAL };

static inline void set(test_engine *e, hk_plugin_spec *spec, const material *m) {
  test_text(e, spec, "model", m->model);
  test_number(e, spec, "stiffness", m->stiffness);
  if (m->weft > 0) test_number(e, spec, "weft", m->weft);
  if (m->shear > 0) test_number(e, spec, "shear", m->shear);
  test_number(e, spec, "nu", m->nu);
  test_number(e, spec, "damping", m->damping);
}

static inline double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 9007199254740992.0 - 0.5;
}

/* A flat sheet at rest that is crumpled and moves. */
typedef struct crumpled {
  test_engine e;
  sheet s;
  hk_instance *force;
  hk_view view;
  double *x, *v;
} crumpled;

static inline crumpled *crumple(const material *m, size_t cells, double rough) {
  crumpled *c = calloc(1, sizeof *c);
  uint64_t seed = 5;
  c->s = sheet_make(SHEET_IRREGULAR, cells, (double[]){0, 0, 0});
  test_engine_open(&c->e);
  hk_plugin_spec *spec = sheet_add(&c->e, &c->s, "membrane");
  set(&c->e, spec, m);
  test_vector(&c->e, spec, "warp", 1, 0.4, 0.2);
  test_run(&c->e);
  c->force = test_instance(&c->e, spec);
  c->view = force_view(&c->e, c->force);
  size_t size = 3 * c->s.particles;
  c->x = malloc(size * sizeof *c->x), c->v = malloc(size * sizeof *c->v);
  for (size_t k = 0; k < size; k++) {
    c->x[k] = c->view.x[k] * (1 + 0.1 * (double)(k % 3)) + rough / (double)cells * noise(&seed);
    c->v[k] = noise(&seed);
  }
  c->view.x = c->x, c->view.v = c->v;
  return c;
}

static inline void smooth_out(crumpled *c) {
  free(c->x);
  free(c->v);
  sheet_free(&c->s);
  test_engine_close(&c->e);
  free(c);
}

#endif
