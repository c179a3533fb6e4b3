/* What friction depends on of a contact, against differences: over a face, an edge and a corner of a triangle, and of
 * edges that cross, are nearly parallel or end. */
#include "plugins/common/contact/friction/friction.h"
#include "plugins/kit/vector3.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const hk_barrier_law law = {.stiffness = 2e3, .distance = 0.1};

static double draw(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 9007199254740992.0 - 0.5;
}

static const struct {
  hk_pair_kind kind;
  double at[12];
} places[] = {
    {HK_POINT_TRIANGLE, {0, 0, 0.06, -1, -1, 0, 1, -1, 0, 0, 2, 0}},       /* face */
    {HK_POINT_TRIANGLE, {0, -1.04, 0.05, -1, -1, 0, 1, -1, 0, 0, 2, 0}},   /* edge of it */
    {HK_POINT_TRIANGLE, {0.01, 2.04, 0.05, -1, -1, 0, 1, -1, 0, 0, 2, 0}}, /* corner */
    {HK_EDGE_EDGE, {-1, 0, 0.06, 1, 0, 0.06, 0, -1, 0, 0.1, 1, 0}},        /* crossing */
    {HK_EDGE_EDGE, {-1, 0, 0.06, 1, 0, 0.06, -1, 0.02, 0, 1, -0.025, 0}},  /* nearly parallel */
    {HK_EDGE_EDGE, {-1, 0, 0.06, 1, 0, 0.06, 1.02, -1, 0, 1.04, 1, 0}},    /* the end of the first */
};
enum { PLACES = sizeof places / sizeof *places, QUANTITIES = 8 };

/* w, u and l at x. */
static void at_place(const hk_barrier_pair *p, const double x[12], const double slip[3], const double way[12],
                     double out[QUANTITIES]) {
  hk_barrier_value value;
  assert_true(hk_barrier_evaluate(p, &law, x, &value));
  hk_pair_frame f = hk_pair_frame_of(&value.nearest);
  double u[3];
  hk_copy(u, slip);
  for (int i = 0; i < 4; i++) hk_add_scaled(u, f.w[i], way + 3 * i);
  hk_add_scaled(u, -hk_dot(u, f.n), f.n);
  memcpy(out, f.w, sizeof f.w);
  memcpy(out + 4, u, sizeof u);
  out[7] = hk_barrier_load(&value);
}

/* Steps of 1e-6 where quantities turn over 0.05: 1e-9 by curvature, and rounding of 1e-16/1e-6. */
static void they_are_those_of_differences(void **state) {
  (void)state;
  uint64_t seed = 5;
  double worst = 0, step = 1e-6;
  for (int k = 0; k < 50 * PLACES; k++) {
    hk_barrier_pair p = {.pair = {.vertex = {0, 1, 2, 3}, .kind = places[k % PLACES].kind, .offset = k % 2 ? 0.03 : 0}};
    hk_barrier_value value;
    hk_friction_slopes s;
    double x[12], way[12], slip[3], up[QUANTITIES], down[QUANTITIES];
    for (int e = 0; e < 12; e++) x[e] = places[k % PLACES].at[e] + 0.004 * draw(&seed), way[e] = draw(&seed);
    for (int r = 0; r < 3; r++) slip[r] = draw(&seed);
    p.area = 0.3;
    p.limit = p.pair.kind == HK_EDGE_EDGE ? 1e-3 * 16 : 0;
    assert_true(hk_barrier_evaluate(&p, &law, x, &value));
    hk_friction_slopes_of(&p, &value, x, slip, way, &s);
    double size[3] = {1, 1, 0};
    for (int j = 0; j < 12; j++) {
      for (int i = 0; i < 4; i++) size[0] = fmax(size[0], fabs(s.w[i][j]));
      for (int r = 0; r < 3; r++) size[1] = fmax(size[1], fabs(s.u[r][j]));
      size[2] = fmax(size[2], fabs(s.load[j]));
    }
    for (int j = 0; j < 12; j++) {
      double kept = x[j];
      x[j] = kept + step;
      at_place(&p, x, slip, way, up);
      x[j] = kept - step;
      at_place(&p, x, slip, way, down);
      x[j] = kept;
      for (int q = 0; q < QUANTITIES; q++) {
        double slope = (up[q] - down[q]) / (2 * step);
        double off = q < 4   ? fabs(slope - s.w[q][j]) / size[0]
                     : q < 7 ? fabs(slope - s.u[q - 4][j]) / size[1]
                             : fabs(slope - s.load[j]) / size[2];
        worst = fmax(worst, off);
      }
    }
  }
  print_message("off by %.1e\n", worst);
  assert_true(worst < 1e-6);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(they_are_those_of_differences)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
