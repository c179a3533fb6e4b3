/* The longest step of a liquid. */
#include "plugins/common/liquid/liquid_pace.h"
#include "plugins/kit/vector3.h"

#include <string.h>

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

void hk_liquid_gain(hk_liquid_pace *pace, const hk_liquid_particles *p, const double *before, double h) {
  double most = 0;
  for (size_t k = 0; k < p->count; k++)
    for (size_t c = 0; c < 3; c++) {
      size_t i = 3 * (size_t)p->index[k] + c;
      most = fmax(most, fabs(p->v[i] - before[i]));
    }
  pace->gain = most / h;
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

size_t hk_liquid_columns(const hk_liquid_grid *g) {
  size_t least = SIZE_MAX;
  for (int c = 0; c < 3; c++) least = g->cells[c] < least ? g->cells[c] : least;
  return g->size / (least + 2);
}

/* Of the wave's speed, squared, what a viscosity leaves: nu, m^2/s; g, m/s^2; depth, m. */
static double part_of_wave(double g, double depth, double nu) {
  return fmin(1, g * depth * depth * depth / (4 * nu * nu));
}

hk_status hk_liquid_pace_open(hk_liquid_pace *pace, const hk_host *host, const hk_liquid_grid *g) {
  pace->column = host->allocate(host, 2 * hk_liquid_columns(g) * sizeof *pace->column);
  return pace->column ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for the viscosity of %zu cells", g->size);
}

/* The column of a particle along the axis. */
static size_t column_of(const hk_liquid_grid *g, int axis, const double x[3]) {
  hk_liquid_place at;
  hk_liquid_locate(g, x, &at);
  int b = (axis + 1) % 3, c = (axis + 2) % 3;
  return at.face[b] * (g->cells[c] + 2) + at.face[c];
}

/* m^2/s^2: the largest sum of g d over a column, with viscosities of each particle. */
static double fastest_column(const hk_liquid *l, const hk_liquid_pace *pace, const hk_liquid_particles *p,
                             const double *viscosity) {
  const hk_liquid_grid *g = &l->grid;
  size_t columns = hk_liquid_columns(g);
  int axis = 0;
  for (int c = 1; c < 3; c++) axis = fabs(pace->pull[c]) > fabs(pace->pull[axis]) ? c : axis;
  double pull = fabs(pace->pull[axis]), most = 0, *depth = pace->column, *sum = depth + columns;
  double unit = g->spacing[axis] / (l->density * hk_liquid_cell_volume(g)); /* m/kg */
  memset(depth, 0, 2 * columns * sizeof *depth);
  for (size_t k = 0; k < p->count; k++)
    depth[column_of(g, axis, p->x + 3 * (size_t)p->index[k])] += unit * p->mass[p->index[k]];
  for (size_t k = 0; k < p->count; k++) {
    size_t i = p->index[k], at = column_of(g, axis, p->x + 3 * i);
    double nu = viscosity[i] / l->density;
    sum[at] += pull * unit * p->mass[i] * (nu > 0 ? part_of_wave(pull, depth[at], nu) : 1);
    most = fmax(most, sum[at]);
  }
  return most;
}

double hk_liquid_wave(const hk_liquid *l, const hk_liquid_pace *pace, const hk_liquid_particles *p,
                      hk_liquid_thickness thickness) {
  const double *a = pace->pull, size = hk_length(a);
  if (!(size > 0)) return 0;
  double depth = depth_along(a, size, p), squared = size * depth;
  if (thickness.each)
    squared = fmin(squared, fastest_column(l, pace, p, thickness.each));
  else if (thickness.all > 0)
    squared *= part_of_wave(size, depth, thickness.all / l->density);
  return sqrt(squared);
}

double hk_liquid_longest_step(const hk_liquid *l, const hk_liquid_pace *pace, const hk_liquid_particles *p,
                              double courant, double tension, double wave, bool viscous) {
  double size = hk_length(pace->pull), cell = least_spacing(&l->grid), fall = viscous ? fmin(size, pace->gain) : size;
  double way = courant * cell, speed = hk_liquid_courant(l, p, cell);
  double falling = speed + sqrt(speed * speed + 4 * fall * way); /* speed h + fall h^2 = way */
  double h = falling > 0 ? 2 * way / falling : INFINITY;
  if (wave > 0) h = fmin(h, way / wave);
  if (tension > 0) h = fmin(h, sqrt(l->density * cell * cell * cell / (4 * pi * tension)));
  return h;
}

void hk_liquid_note_wave(const hk_liquid *l, hk_liquid_pace *pace, double h) {
  pace->waved = fmax(pace->waved, h * pace->wave / least_spacing(&l->grid));
}

double hk_liquid_part_to_even(const hk_liquid *l, const hk_liquid_pace *pace, const hk_liquid_particles *p, double h,
                              double off) {
  double wave = hk_liquid_wave(l, pace, p, (hk_liquid_thickness){0});
  double by_time = h / hk_liquid_longest_step(l, pace, p, evened_in, 0, wave, false);
  return fmin(1, isnan(off) ? by_time : fmax(by_time, fabs(off) / soon_off));
}

static const double seldom = 16; /* steps, from one look at what is thin to the next */

void hk_liquid_note_thin(const hk_liquid *l, hk_liquid_pace *p) {
  if (fmod(p->steps++, seldom) == 0) p->thin += hk_liquid_thin_part(l);
}

double hk_liquid_mean_thin(const hk_liquid_pace *p) { return p->steps > 0 ? p->thin / ceil(p->steps / seldom) : 0; }
