/* The longest step of a liquid. */
#include "plugins/common/liquid/liquid_pace.h"

static const double evened_in = 0.5; /* cells that are passed while a quarter of the density is evened */
static const double soon_off = 0.5;  /* of what the volume may be off: a quarter is evened in a step, however short */
static const double pi = 3.14159265358979323846;

/* m, of the axes that it moves along. */
static double least_spacing(const hk_liquid_grid *g) {
  double least = INFINITY;
  for (int c = 0; c < 3; c++)
    if (!g->flat[c]) least = fmin(least, g->spacing[c]);
  return least;
}

double hk_liquid_courant(const hk_liquid *l, const hk_liquid_particles *p, double h) {
  const hk_liquid_grid *g = &l->grid;
  double most = 0;
  for (size_t k = 0; k < p->count; k++)
    for (size_t c = 0; c < 3; c++)
      if (!g->flat[c]) most = fmax(most, fabs(p->v[3 * (size_t)p->index[k] + c]) * h / g->spacing[c]);
  return most;
}

void hk_liquid_pull(hk_liquid_pace *pace, const hk_liquid_particles *p, const double *acceleration) {
  double sum[3] = {0};
  for (size_t k = 0; k < p->count; k++)
    for (size_t c = 0; c < 3; c++) sum[c] += acceleration[3 * (size_t)p->index[k] + c];
  for (int c = 0; c < 3; c++) pace->pull[c] = p->count ? sum[c] / (double)p->count : 0;
}

void hk_liquid_pull_between(hk_liquid_pace *pace, const hk_liquid_particles *p, const double *before, double h) {
  double sum[3] = {0}, *pull = pace->pull;
  if (pull[0] != 0 || pull[1] != 0 || pull[2] != 0) return;
  for (size_t k = 0; k < p->count; k++)
    for (size_t c = 0; c < 3; c++) {
      size_t i = 3 * (size_t)p->index[k] + c;
      sum[c] += p->v[i] - before[i];
    }
  for (int c = 0; c < 3; c++) pull[c] = p->count ? sum[c] / ((double)p->count * h) : 0;
}

/* m, from the lowest to the highest particle along the pull. */
static double depth_along(const double pull[3], double size, const hk_liquid_particles *p) {
  double low = INFINITY, high = -INFINITY;
  for (size_t k = 0; k < p->count; k++) {
    const double *x = p->x + 3 * (size_t)p->index[k];
    double at = (x[0] * pull[0] + x[1] * pull[1] + x[2] * pull[2]) / size;
    low = fmin(low, at);
    high = fmax(high, at);
  }
  return p->count ? high - low : 0;
}

double hk_liquid_longest_step(const hk_liquid *l, const hk_liquid_pace *pace, const hk_liquid_particles *p,
                              double courant, double tension) {
  const double *a = pace->pull;
  double size = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]), cell = least_spacing(&l->grid);
  double way = courant * cell, speed = hk_liquid_courant(l, p, cell);
  double falling = speed + sqrt(speed * speed + 4 * size * way); /* speed h + size h^2 = way */
  double h = falling > 0 ? 2 * way / falling : INFINITY;
  if (size > 0) h = fmin(h, way / sqrt(size * depth_along(a, size, p)));
  if (tension > 0) h = fmin(h, sqrt(l->density * cell * cell * cell / (4 * pi * tension)));
  return h;
}

double hk_liquid_part_to_even(const hk_liquid *l, const hk_liquid_pace *pace, const hk_liquid_particles *p, double h,
                              double off) {
  double by_time = h / hk_liquid_longest_step(l, pace, p, evened_in, 0);
  return fmin(1, isnan(off) ? by_time : fmax(by_time, fabs(off) / soon_off));
}
