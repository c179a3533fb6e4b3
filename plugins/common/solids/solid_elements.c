/* The solid as elements, for methods that work element by element. The elastic energy is mu/2 sum of C^2 per volume, up
 * to a constant, with ten numbers C: nine along F, and the change of volume (neo_hookean.c). The viscosity has numbers
 * of its own: six of the strain, whose rates lose 2 mu |dE/dt|^2, and its trace, which loses lambda (tr dE/dt)^2. */
#include "plugins/common/solids/solid.h"

#include "plugins/kit/vector3.h"

enum { MOST = HK_NEO_HOOKEAN_VALUES };

/* Derivatives with respect to the members from those with respect to F. */
static void spread(const hk_tetrahedron *shape, int values, const double *by_F, double (*dC)[3]) {
  for (int q = 0; q < values; q++)
    for (int m = 0; m < 4; m++)
      for (int r = 0; r < 3; r++) dC[4 * q + m][r] = hk_dot(by_F + 9 * q + 3 * r, shape->slope[m]);
}

static void evaluate_elastic(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const hk_solid *s = self;
  double F[9], by_F[9 * MOST];
  for (size_t k = begin; k < end; k++, C += HK_NEO_HOOKEAN_VALUES, dC += 4 * HK_NEO_HOOKEAN_VALUES) {
    const hk_solid_part *p = hk_solid_part_of(s, k);
    hk_tetrahedron_gradient(&p->shape, x, hk_tuple(&s->tuples.acting, k), F);
    hk_neo_hookean_values(p->elastic, F, C, by_F);
    spread(&p->shape, HK_NEO_HOOKEAN_VALUES, by_F, dC);
  }
}

static void evaluate_strain(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const hk_solid *s = self;
  double F[9], by_F[9 * HK_STRAIN_VALUES];
  for (size_t k = begin; k < end; k++, C += HK_STRAIN_VALUES, dC += 4 * HK_STRAIN_VALUES) {
    const hk_solid_part *p = hk_solid_part_of(s, k);
    hk_tetrahedron_gradient(&p->shape, x, hk_tuple(&s->tuples.acting, k), F);
    hk_strain_values(F, C, by_F);
    spread(&p->shape, HK_STRAIN_VALUES, by_F, dC);
  }
}

static void evaluate_trace(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const hk_solid *s = self;
  double F[9], by_F[9];
  for (size_t k = begin; k < end; k++, C++, dC += 4) {
    const hk_solid_part *p = hk_solid_part_of(s, k);
    hk_tetrahedron_gradient(&p->shape, x, hk_tuple(&s->tuples.acting, k), F);
    hk_strain_trace(F, C, by_F);
    spread(&p->shape, 1, by_F, dC);
  }
}

void hk_solid_elements(const hk_solid *s, hk_elements out[HK_SOLID_LISTS]) {
  static double none[1] = {0}, one[1] = {1};
  const hk_per_tuple zero = {1, none};
  size_t count = s->tuples.acting.count;
  hk_elements like = {.node = s->tuples.acting, .stiffness = zero, .self = s};
  for (int l = 0; l < HK_SOLID_LISTS; l++) out[l] = like;
  out[0].stiffness = (hk_per_tuple){count, s->weight[0]};
  out[0].values = HK_NEO_HOOKEAN_VALUES;
  out[0].evaluate = evaluate_elastic;
  out[1].damping = (hk_per_tuple){count, s->weight[1]};
  out[1].values = HK_STRAIN_VALUES;
  out[1].rest = (hk_per_tuple){1, one}; /* it is the strain itself */
  out[1].evaluate = evaluate_strain;
  out[2].damping = (hk_per_tuple){count, s->weight[2]};
  out[2].values = 1;
  out[2].evaluate = evaluate_trace;
}
