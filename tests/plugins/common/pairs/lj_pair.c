/* The pair of Lennard and Jones with a shifted force: zero energy and force at the cut-off, the minimum of the bare
 * pair near 2^(1/6) sigma, energy, push and curvature that are derivatives of each other, also on the parabola of close
 * pairs, and a Hessian that is the force's, of which the definite part has no negative direction. */
#include "plugins/common/pairs/lj_pair.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static hk_lj_pair made(double cutoff) {
  hk_lj_pair p = {.epsilon = 1.5, .sigma = 0.3, .cutoff = cutoff};
  hk_lj_pair_prepare(&p);
  return p;
}

static double energy(const hk_lj_pair *p, double r) { return hk_lj_pair_at(p, r * r).energy; }

/* Rounding of sums of the bare pair at the cut-off. */
static void energy_and_force_vanish_at_the_cut_off(void **state) {
  (void)state;
  hk_lj_pair p = made(0.75);
  hk_pair_law end = hk_lj_pair_at(&p, p.cutoff * p.cutoff);
  assert_true(fabs(end.energy) < 1e-15 && fabs(end.push * p.cutoff) < 1e-13);
}

/* With a cut-off at 100 sigma what is shifted is below 1e-11: depth epsilon, without force. */
static void the_minimum_is_that_of_the_bare_pair(void **state) {
  (void)state;
  hk_lj_pair p = made(30);
  double r = p.sigma * pow(2, 1 / 6.0);
  hk_pair_law u = hk_lj_pair_at(&p, r * r);
  assert_true(fabs(u.energy + p.epsilon) < 1e-9 && fabs(u.push) < 1e-8);
  assert_true(fabs(u.curvature - 72 * p.epsilon / (r * r)) < 1e-6 * u.curvature);
}

/* Central differences with a relative step of 1e-5: off by 1e-10 times derivatives that rise by r^-1 each, 14 at most,
 * and by the rounding of the energies, 1e-16 / 1e-5. */
static void push_and_curvature_are_derivatives_of_the_energy(void **state) {
  (void)state;
  hk_lj_pair p = made(0.75);
  const double at[] = {0.2 * p.sigma, 0.7 * p.sigma, 1.1 * p.sigma, 1.9 * p.sigma, 0.5e-4 * p.sigma, 0.9e-4 * p.sigma};
  for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
    double r = at[k], h = 1e-5 * r;
    hk_pair_law u = hk_lj_pair_at(&p, r * r), more = hk_lj_pair_at(&p, (r + h) * (r + h)),
                less = hk_lj_pair_at(&p, (r - h) * (r - h));
    double slope = (energy(&p, r + h) - energy(&p, r - h)) / (2 * h);
    double bend = -(more.push * (r + h) - less.push * (r - h)) / (2 * h);
    double size = fabs(u.energy) / r;
    assert_true(fabs(slope + u.push * r) < 1e-7 * (fabs(u.push * r) + size));
    assert_true(fabs(bend - u.curvature) < 1e-7 * (fabs(u.curvature) + fabs(u.push)));
  }
}

static void force(const hk_lj_pair *p, const double d[3], double F[3]) { /* grad U */
  double push = hk_lj_pair_at(p, d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).push;
  for (int c = 0; c < 3; c++) F[c] = -push * d[c];
}

static void the_hessian_is_that_of_the_energy(void **state) {
  (void)state;
  hk_lj_pair p = made(0.75);
  static const int place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const double d[3] = {0.2, -0.18, 0.21}, h = 1e-6;
  double H[6];
  hk_lj_pair_hessian(&p, d, d[0] * d[0] + d[1] * d[1] + d[2] * d[2], false, H);
  for (int b = 0; b < 3; b++) {
    double more[3] = {d[0], d[1], d[2]}, less[3] = {d[0], d[1], d[2]}, F[2][3];
    more[b] += h, less[b] -= h;
    force(&p, more, F[0]), force(&p, less, F[1]);
    for (int a = 0; a < 3; a++) assert_true(fabs((F[0][a] - F[1][a]) / (2 * h) - H[place[a][b]]) < 1e-6 * 100);
  }
}

/* x H x is the sum over the direction of the pair and across it, of which the negative part is left out. */
static void the_definite_part_has_no_negative_direction(void **state) {
  (void)state;
  hk_lj_pair p = made(0.75);
  for (double r = 0.25; r < 0.75; r += 0.05) {
    double H[6], d[3] = {r, 0, 0};
    hk_pair_law u = hk_lj_pair_at(&p, r * r);
    hk_lj_pair_hessian(&p, d, r * r, true, H);
    assert_true(fabs(H[0] - fmax(u.curvature, 0)) < 1e-14 * (fabs(u.curvature) + fabs(u.push))); /* of the sum */
    assert_true(H[3] == fmax(-u.push, 0) && H[5] == H[3]);
    assert_true(H[1] == 0 && H[2] == 0 && H[4] == 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy_and_force_vanish_at_the_cut_off),
      cmocka_unit_test(the_minimum_is_that_of_the_bare_pair),
      cmocka_unit_test(push_and_curvature_are_derivatives_of_the_energy),
      cmocka_unit_test(the_hessian_is_that_of_the_energy),
      cmocka_unit_test(the_definite_part_has_no_negative_direction),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
