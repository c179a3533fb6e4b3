/* The bounds of a crowd against crowds: the twelve around a sphere, and random ones that keep apart. */
#include "plugins/common/grains/crowd.h"
#include "core/engine/base/base.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

/* The largest value of the sum of (n.u)^2 over u, by power iteration from an axis; a lower bound of the eigenvalue. */
static double along(const double (*n)[3], int count) {
  double u[3] = {0.6, 0.5, 0.62}, size = 0;
  for (int k = 0; k < 200; k++) {
    double v[3] = {0};
    for (int i = 0; i < count; i++)
      for (int c = 0; c < 3; c++) v[c] += n[i][c] * (n[i][0] * u[0] + n[i][1] * u[1] + n[i][2] * u[2]);
    size = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int c = 0; c < 3; c++) u[c] = v[c] / size;
  }
  return size;
}

static void random_crowds_stay_below_the_bounds(void **state) {
  (void)state;
  enum { MOST = 200 };
  uint64_t seed[4];
  hk_random_seed(seed, 6);
  for (int round = 0; round < 300; round++) {
    double n[MOST][3], R = 0.5 + 2 * hk_random_uniform(seed), r = 1, near = cos(2 * asin(r / (R + r)));
    double flat = hk_random_uniform(seed); /* crowds around the poles */
    int count = 0;
    for (int tries = 0; tries < 3000 && count < MOST; tries++) {
      double z = 1 - flat * hk_random_uniform(seed), turn = 6.283185307179586 * hk_random_uniform(seed);
      double side = sqrt(1 - z * z), m[3] = {side * cos(turn), side * sin(turn), tries % 2 ? z : -z};
      int apart = 1;
      for (int i = 0; i < count && apart; i++) apart = n[i][0] * m[0] + n[i][1] * m[1] + n[i][2] * m[2] <= near;
      for (int c = 0; c < 3 && apart; c++) n[count][c] = m[c];
      count += apart;
    }
    hk_crowd bound = hk_crowd_of(R, r);
    assert_true(count <= bound.number && along((const double(*)[3])n, count) <= bound.along);
  }
}

/* 4 pi/(pi (2 - sqrt 3)) caps, and an icosahedron's sum is 4 in every direction. */
static void equal_spheres_by_hand(void **state) {
  (void)state;
  hk_crowd twelve = hk_crowd_of(1, 1);
  assert_true(fabs(twelve.number - 4 / (2 - sqrt(3))) < 1e-12);
  assert_true(twelve.along > 4 && twelve.along < 5.2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_crowds_stay_below_the_bounds),
      cmocka_unit_test(equal_spheres_by_hand),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
