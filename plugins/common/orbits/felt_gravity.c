#include "plugins/common/orbits/felt_gravity.h"
#include "plugins/kit/vector3.h"

#include <stdlib.h>

enum { LOOKED_AT = 256 };

typedef struct ranked {
  double distance;
  uint32_t index;
} ranked;

static int nearer(const void *first, const void *second) {
  const ranked *a = first, *b = second;
  if (a->distance != b->distance) return a->distance < b->distance ? -1 : 1;
  return (a->index > b->index) - (a->index < b->index);
}

static size_t gather(const hk_model *model, ranked *body, hk_felt_gravity *f) {
  size_t heaviest = 0;
  double sum = 0;
  f->bodies = 0;
  for (size_t i = 0; i < model->n; i++) {
    if (model->pin[i] != HK_FREE || !(model->mass[i] > 0)) continue;
    if (f->bodies == 0 || model->mass[i] > model->mass[heaviest]) heaviest = i;
    sum += model->mass[i];
    body[f->bodies++].index = (uint32_t)i;
  }
  f->others = f->bodies ? sum / model->mass[heaviest] - 1 : 0;
  return heaviest;
}

static void sort(const double *x, ranked *body, size_t count, size_t heaviest, uint32_t *order) {
  for (size_t k = 0; k < count; k++) {
    double d[3];
    hk_subtract(d, x + 3 * (size_t)body[k].index, x + 3 * heaviest);
    body[k].distance = body[k].index == heaviest ? -1 : hk_length(d);
  }
  qsort(body, count, sizeof *body, nearer);
  for (size_t k = 0; k < count; k++) order[k] = body[k].index;
}

/* The acceleration of body i for G = 1. */
static void pull(const hk_model *model, const double *x, const uint32_t *order, size_t count, uint32_t i, double a[3]) {
  a[0] = a[1] = a[2] = 0;
  for (size_t k = 0; k < count; k++) {
    double d[3];
    hk_subtract(d, x + 3 * (size_t)order[k], x + 3 * (size_t)i);
    double square = hk_dot(d, d);
    if (order[k] != i) hk_add_scaled(a, model->mass[order[k]] / (square * sqrt(square)), d);
  }
}

/* The mean of a.n/n^2 over bodies beside the heaviest, whose accelerations both are relative to, n for G = 1: that of
 * least squares, relative to n. */
static void fit(const hk_model *model, const double *x, const double *a, const uint32_t *order, hk_felt_gravity *f) {
  size_t stride = (f->bodies + LOOKED_AT - 1) / LOOKED_AT, looked = 0;
  const double *centre = a + 3 * (size_t)order[0];
  double along = 0, whole = 0, own[3];
  pull(model, x, order, f->bodies, order[0], own);
  for (size_t k = 1; k < f->bodies; k += stride, looked++) {
    double n[3], felt[3];
    pull(model, x, order, f->bodies, order[k], n);
    hk_subtract(n, n, own);
    hk_subtract(felt, a + 3 * (size_t)order[k], centre);
    along += hk_dot(felt, n) / hk_dot(n, n);
    whole += hk_dot(felt, felt) / hk_dot(n, n);
  }
  f->G = along / (double)looked;
  f->off = f->G > 0 ? sqrt(fmax(0, whole / (double)looked / (f->G * f->G) - 1)) : 1;
}

bool hk_felt_gravity_find(const hk_host *host, const hk_model *model, const double *x, const double *a, uint32_t *order,
                          hk_felt_gravity *f) {
  ranked *body = host->allocate(host, (model->n + 1) * sizeof *body);
  if (!body) return false;
  size_t heaviest = gather(model, body, f);
  sort(x, body, f->bodies, heaviest, order);
  host->release(host, body);
  f->G = 0, f->off = 1;
  if (f->bodies > 1) fit(model, x, a, order, f);
  return true;
}
