/* Particles are sorted by cells of a grid whose diagonal is the least thickness: all in one cell touch each other. */
#include "plugins/common/surfaces/surface_crowd.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 100 /* particles in a cell; spheres that do not overlap have room for their middles only */ };

typedef struct place {
  double cell[3];
  uint32_t particle;
} place;

static int in_order(const void *left, const void *right) {
  const place *a = left, *b = right;
  for (int c = 0; c < 3; c++)
    if (a->cell[c] != b->cell[c]) return a->cell[c] < b->cell[c] ? -1 : 1;
  return (a->particle > b->particle) - (a->particle < b->particle);
}

static bool can_meet(const hk_surface_mesh *m, const hk_view *view, uint32_t i) {
  return view->model->inverse_mass[i] > 0 && m->radius[i] > 0;
}

/* 0: no particle can meet another. */
static double least_thickness(const hk_surface_mesh *m, const hk_view *view) {
  double least = INFINITY;
  for (size_t k = 0; k < m->points; k++)
    if (can_meet(m, view, m->point[k])) least = fmin(least, 2 * m->radius[m->point[k]]);
  return isfinite(least) ? least : 0;
}

static size_t put(place *to, const hk_surface_mesh *m, const hk_view *view, double side) {
  size_t count = 0;
  for (size_t k = 0; k < m->points; k++) {
    uint32_t i = m->point[k];
    if (!can_meet(m, view, i)) continue;
    to[count] = (place){.particle = i};
    for (int c = 0; c < 3; c++) to[count].cell[c] = floor(view->x[3 * (size_t)i + (size_t)c] / side);
    count++;
  }
  qsort(to, count, sizeof *to, in_order);
  return count;
}

static hk_status refuse_heaps(const place *p, size_t count, const hk_view *view, double thickness) {
  const uint32_t *id = view->model->id;
  for (size_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && memcmp(p[end].cell, p[begin].cell, sizeof p->cell) == 0;) end++;
    if (end - begin > MOST)
      return view->host->fail(view->host, HK_BAD_PARAM,
                              "%zu particles, among them %u and %u, start within %.3g m of each other, all of them "
                              "nearer than their thickness: start them apart, or make thickness or radius smaller",
                              end - begin, id[p[begin].particle], id[p[begin + 1].particle], thickness);
  }
  return HK_OK;
}

hk_status hk_surface_crowd_check(const hk_surface_mesh *m, const hk_view *view) {
  double thickness = least_thickness(m, view);
  if (!(thickness > 0)) return HK_OK;
  place *p = view->host->allocate(view->host, m->points * sizeof *p);
  if (!p) return view->host->fail(view->host, HK_NO_MEMORY, "no memory for %zu particles", m->points);
  size_t count = put(p, m, view, thickness / sqrt(3));
  hk_status status = refuse_heaps(p, count, view, thickness);
  view->host->release(view->host, p);
  return status;
}
