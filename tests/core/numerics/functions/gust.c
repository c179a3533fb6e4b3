/* Gusts: the mean and RMS that are asked for, nothing faster than the shortest period and nothing slower than the
 * longest, equal for equal seeds in any order of queries. */
#include "core/numerics/functions/functions.h"

#include <complex.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.141592653589793, shortest = 0.5, longest = 10;

static hk_gust made(uint64_t seed) {
  hk_gust g;
  hk_gust_make(&g, 3, (const double[]){5, 0, -2}, (const double[]){1, 2, 0}, shortest, longest, seed);
  return g;
}

/* Over 4,000 s, 400 of the longest periods: waves that differ by more than 1/4000 Hz are independent to a few percent
 * of their products; the closest pairs of 32 may be nearer, so that 5 % of the variance is allowed. */
static void mean_and_rms_are_those_asked_for(void **state) {
  (void)state;
  enum { SAMPLES = 80000 };
  hk_gust g = made(1);
  double sum[3] = {0}, square[3] = {0}, out[3];
  const double mean[3] = {5, 0, -2}, rms[3] = {1, 2, 0};
  for (size_t k = 0; k < SAMPLES; k++) {
    hk_gust_at(&g, 0.05 * (double)k, out);
    for (int c = 0; c < 3; c++) sum[c] += (out[c] - mean[c]) / SAMPLES, square[c] += pow(out[c] - mean[c], 2) / SAMPLES;
  }
  for (int c = 0; c < 3; c++) {
    assert_true(fabs(sum[c]) < 0.02 * rms[c] + 1e-12);
    assert_true(fabs(square[c] - rms[c] * rms[c]) <= 0.05 * rms[c] * rms[c]);
  }
  assert_true(g.fastest == shortest / 2);
}

/* The part of the energy at q/T for the times T k/SAMPLES, with the window of Blackman and Harris (side lobes below -92
 * dB, a main lobe of 4/T to either side). */
static double energy_at(const double *values, size_t samples, size_t q) {
  double complex sum = 0;
  for (size_t k = 0; k < samples; k++) {
    double w = 2 * pi * (double)k / (double)samples,
           window = 0.35875 - 0.48829 * cos(w) + 0.14128 * cos(2 * w) - 0.01168 * cos(3 * w);
    sum += window * values[k] * cexp(-I * w * (double)q);
  }
  return creal(sum * conj(sum));
}

static void spectrum_is_limited_to_the_band(void **state) {
  (void)state;
  enum { SAMPLES = 4096 };
  const double T = 200; /* s: 0.005 Hz a line, the band is from line 20 to line 400, and 4 further on either side */
  static double values[SAMPLES];
  for (uint64_t seed = 1; seed <= 3; seed++) {
    hk_gust g = made(seed);
    double inside = 0, outside = 0, out[3], low = 0, high = 0;
    for (size_t k = 0; k < SAMPLES; k++) {
      hk_gust_at(&g, T * (double)k / SAMPLES, out);
      values[k] = out[1]; /* its mean is 0 */
    }
    for (size_t q = 0; q < SAMPLES / 2; q += q < 480 ? 4 : 16) {
      double energy = energy_at(values, SAMPLES, q);
      *(q >= 16 && q <= 404 ? &inside : &outside) += energy;
      if (q >= 20 && q <= 89) low += energy; /* the lower half of the band's logarithm */
      if (q > 89 && q <= 400) high += energy;
    }
    if (!(outside < 1e-8 * inside)) fail_msg("%g of the energy is outside of the band", outside / inside);
    /* Kolmogorov's: (1 - 20^(-1/3)) to (20^(-1/3) - 20^(-2/3)), 2.7, of 16 waves each. */
    assert_true(low > 1.5 * high && low < 5 * high);
  }
}

static void equal_seeds_are_equal_in_any_order(void **state) {
  (void)state;
  enum { TIMES = 500 };
  hk_gust a = made(7), b = made(7), other = made(8);
  double forward[TIMES][3], out[3];
  for (size_t k = 0; k < TIMES; k++) hk_gust_at(&a, 0.37 * (double)k, forward[k]);
  for (size_t k = TIMES; k-- > 0;) {
    hk_gust_at(&b, 0.37 * (double)k, out);
    assert_memory_equal(out, forward[k], sizeof out);
    hk_gust_at(&other, 0.37 * (double)k, out);
    assert_true(out[0] != forward[k][0] && out[2] == -2);
  }
}

/* No slope is above that of all waves together: 2 pi f a summed. */
static void it_changes_no_faster_than_its_band_allows(void **state) {
  (void)state;
  hk_gust g = made(2);
  double most = 0, out[2][3];
  for (int k = 0; k < HK_GUST_WAVES; k++) {
    assert_true(g.wave[1][k].frequency <= 1 / shortest && g.wave[1][k].frequency >= 1 / longest);
    most += 2 * pi * g.wave[1][k].frequency * fabs(g.wave[1][k].size);
  }
  for (int k = 0; k < 20000; k++) {
    hk_gust_at(&g, 0.01 * k, out[0]);
    hk_gust_at(&g, 0.01 * k + 1e-4, out[1]);
    assert_true(fabs(out[1][1] - out[0][1]) <= 1e-4 * most * (1 + 1e-9));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(mean_and_rms_are_those_asked_for),
      cmocka_unit_test(spectrum_is_limited_to_the_band),
      cmocka_unit_test(equal_seeds_are_equal_in_any_order),
      cmocka_unit_test(it_changes_no_faster_than_its_band_allows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
