/* The end of a step, and particles of the liquid that would pass a triangle in it. Both move on straight lines. A
 * particle passes where its distance to the plane through the corners changes sign, by the plane of the start and that
 * of the end, and meets it within the triangle. */
#include "plugins/common/thin_walls/thin_walls.h"
#include "plugins/kit/vector3.h"

#include <string.h>

enum { AGAIN = 4 /* a particle that one triangle sends back may meet another */ };

static const double hair = 1e-3;  /* of a triangle: none passes between two that share an edge */
static const double apart = 0.01; /* of a cell: from the triangle that sends a particle back */

/* Numbers of the cells, along axis a, that triangle k may be reached from. */
static void cells_near(const hk_thin_walls *s, const hk_liquid_grid *g, size_t k, int a, int reach, size_t range[2]) {
  double low = INFINITY, high = -INFINITY, most = (double)g->cells[a];
  for (int c = 0; c < 3; c++) {
    const hk_thin_vertex *v = &s->vertex[s->triangle[k][c]];
    low = fmin(low, fmin(v->x[a], v->to[a]));
    high = fmax(high, fmax(v->x[a], v->to[a]));
  }
  range[0] = range[1] = 1;
  if (g->flat[a]) return;
  range[0] = (size_t)fmax(1, fmin(most + 1, floor((low - g->low[a]) / g->spacing[a]) + 1 - reach));
  range[1] = (size_t)fmax(0, fmin(most, floor((high - g->low[a]) / g->spacing[a]) + 1 + reach));
}

/* Counts the triangles near each cell, or enters them. */
static void walk_bins(hk_thin_walls *s, const hk_liquid_grid *g, int reach, bool enter) {
  for (size_t k = 0; k < s->triangles; k++) {
    size_t r[3][2];
    for (int a = 0; a < 3; a++) cells_near(s, g, k, a, reach, r[a]);
    for (size_t i = r[0][0]; i <= r[0][1]; i++)
      for (size_t j = r[1][0]; j <= r[1][1]; j++)
        for (size_t l = r[2][0]; l <= r[2][1]; l++) {
          size_t cell = i * g->stride[0] + j * g->stride[1] + l * g->stride[2];
          if (enter)
            s->near[s->bin[cell]++] = (uint32_t)k;
          else
            s->bin[cell + 1]++;
        }
  }
}

static hk_status fill_bins(hk_thin_walls *s, const hk_liquid_grid *g, int reach) {
  memset(s->bin, 0, (g->size + 1) * sizeof *s->bin);
  walk_bins(s, g, reach, false);
  for (size_t i = 0; i < g->size; i++) s->bin[i + 1] += s->bin[i];
  size_t all = s->bin[g->size];
  if (all > s->near_room) {
    s->host->release(s->host, s->near);
    s->near_room = all + all / 2;
    s->near = s->host->allocate(s->host, s->near_room * sizeof *s->near);
    if (!s->near) s->near_room = 0;
    if (!s->near) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu triangles near cells", all);
  }
  walk_bins(s, g, reach, true);
  memmove(s->bin + 1, s->bin, g->size * sizeof *s->bin);
  s->bin[0] = 0;
  return HK_OK;
}

hk_status hk_thin_walls_end(hk_thin_walls *s, const hk_liquid_grid *g, hk_correction *step, int reach, bool *moved) {
  for (size_t k = 0; k < s->vertices; k++) {
    hk_thin_vertex *v = &s->vertex[k];
    double *x = step->x + 3 * (size_t)v->particle, change[3];
    hk_subtract(change, v->v, v->came);
    *moved |= change[0] != 0 || change[1] != 0 || change[2] != 0;
    hk_add_scaled(x, step->h, change);
    hk_add_scaled(step->v + 3 * (size_t)v->particle, 1, change);
    hk_copy(v->to, x);
  }
  return s->triangles ? fill_bins(s, g, reach) : HK_OK;
}

/* The triangle's normal, of length 1; false: it has none. */
static bool normal_of(const double *const corner[3], double n[3]) {
  double p[3], q[3];
  hk_subtract(p, corner[1], corner[0]);
  hk_subtract(q, corner[2], corner[0]);
  hk_cross(n, p, q);
  double size = hk_length(n);
  for (int c = 0; c < 3 && size > 0; c++) n[c] /= size;
  return size > 0;
}

static double height_over(const double *const corner[3], const double n[3], const double x[3]) {
  double r[3];
  hk_subtract(r, x, corner[0]);
  return hk_dot(r, n);
}

/* Barycentric coordinates of x, by the triangle with these corners and normal; false: it is beside it. */
static bool is_within(const double *const corner[3], const double n[3], const double x[3], double weight[3]) {
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    double p[3], q[3], across[3];
    hk_subtract(p, corner[(k + 1) % 3], x);
    hk_subtract(q, corner[(k + 2) % 3], x);
    hk_cross(across, p, q);
    sum += weight[k] = hk_dot(across, n);
  }
  for (int k = 0; k < 3; k++)
    if (!((weight[k] /= sum) >= -hair)) return false;
  return true;
}

/* Whether the ways of the particle and of triangle k are apart along an axis. */
static bool are_apart(const hk_thin_walls *s, size_t k, const double from[3], const double x[3]) {
  const hk_thin_vertex *p = &s->vertex[s->triangle[k][0]], *q = &s->vertex[s->triangle[k][1]],
                       *r = &s->vertex[s->triangle[k][2]];
  for (int a = 0; a < 3; a++) {
    double low = fmin(fmin(fmin(p->x[a], p->to[a]), fmin(q->x[a], q->to[a])), fmin(r->x[a], r->to[a]));
    double high = fmax(fmax(fmax(p->x[a], p->to[a]), fmax(q->x[a], q->to[a])), fmax(r->x[a], r->to[a]));
    double more = hair * (high - low);
    if (fmax(from[a], x[a]) < low - more || fmin(from[a], x[a]) > high + more) return true;
  }
  return false;
}

/* A particle that passes triangle k between `from` and x goes back to its side. */
static bool send_back(const hk_thin_walls *s, size_t k, const double from[3], double gap, double x[3]) {
  const double *start[3], *end[3], *between[3];
  double n0[3], n1[3], n[3], mid[3][3], at[3], weight[3];
  if (are_apart(s, k, from, x)) return false;
  for (int c = 0; c < 3; c++) start[c] = s->vertex[s->triangle[k][c]].x, end[c] = s->vertex[s->triangle[k][c]].to;
  if (!normal_of(start, n0) || !normal_of(end, n1)) return false;
  double before = height_over(start, n0, from), after = height_over(end, n1, x);
  if ((before >= 0) == (after >= 0)) return false;
  double part = before / (before - after);
  for (int c = 0; c < 3; c++) {
    for (int a = 0; a < 3; a++) mid[c][a] = (1 - part) * start[c][a] + part * end[c][a];
    between[c] = mid[c];
    at[c] = (1 - part) * from[c] + part * x[c];
  }
  if (!normal_of(between, n) || !is_within(between, n, at, weight)) return false;
  x[0] = x[1] = x[2] = 0;
  for (int c = 0; c < 3; c++) hk_add_scaled(x, weight[c], end[c]);
  hk_add_scaled(x, before >= 0 ? gap : -gap, n1);
  return true;
}

void hk_thin_walls_keep(const hk_thin_walls *s, const hk_liquid_grid *g, size_t cell, const double from[3],
                        double x[3]) {
  double gap = INFINITY;
  bool again = true;
  for (int c = 0; c < 3; c++) gap = fmin(gap, apart * g->spacing[c]);
  for (int round = 0; again && round < AGAIN; round++) {
    again = false;
    for (uint32_t i = s->bin[cell]; i < s->bin[cell + 1]; i++) again |= send_back(s, s->near[i], from, gap, x);
  }
}
