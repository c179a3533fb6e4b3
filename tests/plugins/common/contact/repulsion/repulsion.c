/* The repulsion of pairs of surfaces against differences: points and triangles, edges, edges that are nearly parallel,
 * at random places, with damping and friction. Central differences over 1e-6 of the reach have errors of some 1e-8
 * where forces change by their own size over a hundredth of it, as friction does. */
#include "core/engine/base/base.h"
#include "plugins/common/contact/repulsion/repulsion.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double step = 1e-7, agreed = 1e-5;

static double uniform(uint64_t seed[4]) { return 2 * hk_random_uniform(seed) - 1; }

/* A pair of unit size, within reach; `tilt`: 0 for parallel edges. */
static void shape(hk_repelled *p, hk_pair_kind kind, double tilt, uint64_t seed[4]) {
  static const double points[12] = {0.2, 0.25, 0.15, 0, 0, 0, 1, 0, 0, 0, 1, 0},
                      edges[12] = {-0.5, 0, 0.15, 0.5, 0, 0.15, 0, -0.5, 0, 0, 0.5, 0};
  *p = (hk_repelled){.pair = {.kind = kind, .offset = 0.05}};
  memcpy(p->x, kind == HK_POINT_TRIANGLE ? points : edges, sizeof p->x);
  if (kind == HK_EDGE_EDGE && tilt < 1) {
    memcpy(p->x + 6, (double[]){-0.4, -0.5 * tilt, 0, 0.6, 0.5 * tilt, 0}, 6 * sizeof *p->x);
    p->mollified = 1e-3;
  }
  for (int k = 0; k < 12; k++) {
    if (tilt >= 1) p->x[k] += 0.05 * uniform(seed);
    p->v[k] = uniform(seed);
  }
}

static double largest(const double *a, int count) {
  double most = 0;
  for (int k = 0; k < count; k++) most = fmax(most, fabs(a[k]));
  return most;
}

static void assert_derivatives(const hk_repulsion *r, const hk_repelled *p) {
  double F[12], ahead[12], behind[12], K[144], D[144], power;
  assert_true(hk_repulsion_force(r, p, F, &power));
  assert_true(hk_repulsion_blocks(r, p, 0, K, D));
  double sizes[2] = {largest(K, 144), largest(D, 144)}, work = 0;
  for (int j = 0; j < 24; j++) {
    hk_repelled a = *p, b = *p;
    double *to = j < 12 ? a.x + j : a.v + j - 12, *from = j < 12 ? b.x + j : b.v + j - 12, *all = j < 12 ? K : D;
    *to += step, *from -= step;
    hk_repulsion_force(r, &a, ahead, &power);
    hk_repulsion_force(r, &b, behind, &power);
    for (int i = 0; i < 12; i++) {
      double off = all[12 * i + j % 12] + (ahead[i] - behind[i]) / (2 * step);
      if (!(fabs(off) < agreed * fmax(1, sizes[j / 12])))
        fail_msg("kind %d, %s row %d column %d: %g, off by %g", (int)p->pair.kind, j < 12 ? "K" : "D", i, j % 12,
                 all[12 * i + j % 12], off);
    }
    if (j < 12) work -= (hk_repulsion_energy(r, &a) - hk_repulsion_energy(r, &b)) / (2 * step) * p->v[j];
  }
  for (int i = 0; i < 12; i++) work -= F[i] * p->v[i];
  hk_repulsion_force(r, p, F, &power);
  assert_true(fabs(work + power) < agreed * fmax(1, largest(F, 12)));
}

static void blocks_are_the_derivatives(void **state) {
  (void)state;
  uint64_t seed[4];
  hk_random_seed(seed, 15);
  const hk_repulsion laws[] = {{0.2, 100, 0, 0, 0.01}, {0.2, 100, 0.3, 0, 0.01}, {0.2, 100, 0.3, 0.5, 0.1}};
  for (int k = 0; k < 600; k++) {
    hk_repelled p;
    double tilt = k % 4 < 2 ? 1 : k % 4 == 2 ? 0.02 : 0.03;
    shape(&p, k % 4 == 0 ? HK_POINT_TRIANGLE : HK_EDGE_EDGE, tilt, seed);
    assert_derivatives(&laws[k % 3], &p);
  }
}

/* Newton's third law, and no torque where there is no friction. */
static void pairs_keep_momentum(void **state) {
  (void)state;
  uint64_t seed[4];
  hk_random_seed(seed, 16);
  const hk_repulsion law = {0.2, 100, 0.3, 0, 0.01};
  for (int k = 0; k < 200; k++) {
    hk_repelled p;
    double F[12], power, sum[3] = {0}, moment[3] = {0};
    shape(&p, k % 2 ? HK_POINT_TRIANGLE : HK_EDGE_EDGE, k % 3 ? 1 : 0.01, seed);
    hk_repulsion_force(&law, &p, F, &power);
    for (int i = 0; i < 4; i++)
      for (int c = 0; c < 3; c++) {
        int a = (c + 1) % 3, b = (c + 2) % 3;
        sum[c] += F[3 * i + c];
        moment[c] += p.x[3 * i + a] * F[3 * i + b] - p.x[3 * i + b] * F[3 * i + a];
      }
    assert_true(largest(sum, 3) < 1e-13 && largest(moment, 3) < 1e-13); /* of forces of 1 N at 1 m */
    assert_true(power <= 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blocks_are_the_derivatives),
      cmocka_unit_test(pairs_keep_momentum),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
