/* Gusts: a mean and a sum of waves of random phases (Shinozuka and Deodatis 1991), whose frequencies lie one in each of
 * equal parts of the logarithm between 1/longest and 1/shortest, with the energies of Kolmogorov's spectrum f^(-5/3).
 * All follows from the seed when the gust is made; then it is a fixed function of t, smooth, the same however it is
 * asked, and without a part faster than its shortest period. */
#include "core/numerics/functions/functions.h"

static const double two_pi = 6.283185307179586;

static void make_column(struct hk_gust_wave *wave, double amplitude, double shortest, double longest,
                        uint64_t random[4]) {
  double energy = 0, span = log(longest / shortest);
  for (int k = 0; k < HK_GUST_WAVES; k++) {
    double ratio = exp(span * (k + hk_random_uniform(random)) / HK_GUST_WAVES);
    wave[k].frequency = fmin(ratio / longest, 1 / shortest);
    wave[k].size = pow(ratio, -1.0 / 3); /* per part of the logarithm f^(-2/3) of energy */
    wave[k].phase = hk_random_uniform(random);
    energy += wave[k].size * wave[k].size / 2;
  }
  for (int k = 0; k < HK_GUST_WAVES; k++) wave[k].size *= amplitude / sqrt(energy);
}

void hk_gust_make(hk_gust *g, size_t columns, const double mean[HK_COLUMNS], const double amplitude[HK_COLUMNS],
                  double shortest, double longest, uint64_t seed) {
  uint64_t random[4];
  hk_random_seed(random, seed);
  *g = (hk_gust){.columns = columns, .fastest = shortest / 2};
  for (size_t c = 0; c < columns; c++) {
    g->mean[c] = mean[c];
    make_column(g->wave[c], amplitude[c], shortest, longest, random);
  }
}

void hk_gust_at(const hk_gust *g, double t, double out[HK_COLUMNS]) {
  for (size_t c = 0; c < g->columns; c++) {
    out[c] = g->mean[c];
    for (int k = 0; k < HK_GUST_WAVES; k++) {
      const struct hk_gust_wave *w = &g->wave[c][k];
      double turns = w->frequency * t + w->phase;
      out[c] += w->size * cos(two_pi * (turns - floor(turns)));
    }
  }
}
