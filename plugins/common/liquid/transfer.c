/* From particles to faces and back. Particles are sorted by cells; blocks of layers of cells, every second one at a
 * time, then add to faces without meeting, in an order that threads do not change. */
#include "plugins/common/liquid/liquid.h"

#include "core/plugin/widest.h"

#include <string.h>

enum { LAYERS = 4 /* of a block: its faces reach one layer beyond it on either side */, GRAIN = 4096 };

typedef struct task {
  hk_liquid *l;
  const hk_liquid_particles *p;
  size_t colour;
  double *affine, *full;
} task;

static void cell_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  const hk_liquid_grid *g = &t->l->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    hk_liquid_place at;
    hk_liquid_locate(g, t->p->x + 3 * (size_t)t->p->index[k], &at);
    size_t cell = 0;
    for (int c = 0; c < 3; c++) cell += at.face[c] * g->stride[c];
    t->l->cell[k] = (uint32_t)cell;
  }
}

void hk_liquid_sort(hk_liquid *l, const hk_liquid_particles *p) {
  task t = {.l = l, .p = p};
  l->host->parallel_for(l->host, p->count, GRAIN, cell_piece, &t);
  size_t cells = l->grid.size;
  memset(l->start, 0, (cells + 1) * sizeof *l->start);
  for (size_t k = 0; k < p->count; k++) l->start[l->cell[k] + 1]++;
  for (size_t c = 0; c < cells; c++) l->start[c + 1] += l->start[c];
  for (size_t k = 0; k < p->count; k++) l->sorted[l->start[l->cell[k]]++] = (uint32_t)k;
  memmove(l->start + 1, l->start, cells * sizeof *l->start);
  l->start[0] = 0;
}

/* One component's faces about the particle, or the filled parts with a = 3. `slope`: of the velocity to the next one
 * along each axis, m/s. */
HK_INLINE void add(const hk_liquid_grid *g, size_t at, const double f[3], double amount, double v,
                   const double slope[3], double *weight, double *momentum) {
  const size_t *s = g->stride;
  double v0 = v - f[0] * slope[0] - f[1] * slope[1] - f[2] * slope[2];
  for (int b = 0; b < 4; b++) {
    bool j = b & 1, k = b >> 1;
    size_t to = at + (j ? s[1] : 0) + (k ? s[2] : 0), next = to + s[0];
    double w = amount * (j ? f[1] : 1 - f[1]) * (k ? f[2] : 1 - f[2]), w1 = w * f[0], w0 = w - w1;
    weight[to] += w0;
    weight[next] += w1;
    if (!momentum) continue;
    double u = v0 + (j ? slope[1] : 0) + (k ? slope[2] : 0);
    momentum[to] += w0 * u;
    momentum[next] += w1 * (u + slope[0]);
  }
}

/* m/s, by which component a differs on the plane of the first centres, by the particle's gradient. In a corner the
 * velocity is s y z: its mixed derivative s is that of the gradient by the distances y, z. */
static double carry_from_wall(const hk_liquid *l, const hk_liquid_place *at, const double x[3], const double *gradient,
                              int a) {
  const hk_liquid_grid *g = &l->grid;
  double sum = 0, both = 1, rise = 0, far = 0;
  int walls = 0;
  for (int c = 0; c < 3; c++) {
    if (c == a || g->flat[c] || !at->at_wall[c]) continue;
    double low = x[c] - g->low[c], high = g->high[c] - x[c], away = fmin(low, high);
    double way = g->spacing[c] / 2 - away, slope = low < high ? gradient[3 * a + c] : -gradient[3 * a + c];
    sum += slope * way;
    both *= way;
    rise += slope;
    far += away;
    walls++;
  }
  return walls == 2 && far > 0 ? sum + rise / far * both : sum;
}

static void scatter_one(const hk_liquid *l, const hk_liquid_particles *p, size_t i) {
  const hk_liquid_grid *g = &l->grid;
  hk_liquid_place at;
  hk_liquid_locate(g, p->x + 3 * i, &at);
  double f[3], m = p->mass[i];
  for (int a = 0; a < 3; a++) {
    if (g->flat[a]) continue;
    double slope[3] = {0};
    for (int c = 0; c < 3 && p->affine; c++)
      if (c == a || !at.at_wall[c]) slope[c] = p->affine[p->apart * i + 3 * (size_t)a + (size_t)c] * g->spacing[c];
    size_t corner = hk_liquid_corner(g, &at, a, f);
    double v = p->v[3 * i + (size_t)a];
    if (l->sticks && p->affine) v += carry_from_wall(l, &at, p->x + 3 * i, p->affine + p->apart * i, a);
    add(g, corner, f, m, v, slope, g->weight[a], g->u[a]);
  }
  size_t corner = hk_liquid_corner(g, &at, 3, f);
  static const double none[3];
  add(g, corner, f, m / (l->density * hk_liquid_cell_volume(g)), 0, none, g->filled, NULL);
}

static void scatter_block(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  const hk_liquid *l = t->l;
  size_t layer = l->grid.stride[l->grid.slab], layers = l->grid.cells[l->grid.slab] + 2;
  (void)piece;
  for (size_t b = begin; b < end; b++) {
    size_t from = LAYERS * (2 * b + t->colour), to = from + LAYERS < layers ? from + LAYERS : layers;
    for (size_t k = l->start[from * layer]; k < l->start[to * layer]; k++)
      scatter_one(l, t->p, t->p->index[l->sorted[k]]);
  }
}

/* Velocities from momenta, in one row's length of memory. */
static void divide_piece(void *context, size_t begin, size_t end, size_t piece) {
  const hk_liquid_grid *g = &((const task *)context)->l->grid;
  (void)piece;
  for (int a = 0; a < 3; a++)
    for (size_t k = begin; k < end; k++) {
      if (g->weight[a][k] > 0) g->u[a][k] /= g->weight[a][k];
      g->before[a][k] = g->u[a][k];
    }
}

void hk_liquid_scatter(hk_liquid *l, const hk_liquid_particles *p) {
  hk_liquid_grid *g = &l->grid;
  for (int a = 0; a < 3; a++) {
    memset(g->u[a], 0, g->size * sizeof(double));
    memset(g->weight[a], 0, g->size * sizeof(double));
  }
  memset(g->filled, 0, g->size * sizeof(double));
  size_t layers = g->cells[g->slab] + 2;
  for (size_t colour = 0; colour < 2; colour++) {
    task t = {.l = l, .p = p, .colour = colour};
    size_t before = LAYERS * colour;
    if (layers > before)
      l->host->parallel_for(l->host, (layers - before + 2 * LAYERS - 1) / (2 * LAYERS), 1, scatter_block, &t);
  }
  task t = {.l = l};
  l->host->parallel_for(l->host, g->size, GRAIN, divide_piece, &t);
}

/* The value of a component at the place, and its gradient, 1/s. */
HK_INLINE double value_and_slope(const hk_liquid_grid *g, const hk_liquid_place *at, int a, double slope[3]) {
  double f[3];
  const size_t *s = g->stride;
  const double *v = g->u[a] + hk_liquid_corner(g, at, a, f);
  double v000 = v[0], v100 = v[s[0]], v010 = v[s[1]], v110 = v[s[0] + s[1]];
  v += s[2];
  double v001 = v[0], v101 = v[s[0]], v011 = v[s[1]], v111 = v[s[0] + s[1]];
  double d00 = v100 - v000, d10 = v110 - v010, d01 = v101 - v001, d11 = v111 - v011;
  double v00 = v000 + f[0] * d00, v10 = v010 + f[0] * d10, v01 = v001 + f[0] * d01, v11 = v011 + f[0] * d11;
  double v0 = v00 + f[1] * (v10 - v00), v1 = v01 + f[1] * (v11 - v01);
  double d0 = d00 + f[1] * (d10 - d00), d1 = d01 + f[1] * (d11 - d01);
  slope[0] = (d0 + f[2] * (d1 - d0)) / g->spacing[0];
  slope[1] = (v10 - v00 + f[2] * ((v11 - v01) - (v10 - v00))) / g->spacing[1];
  slope[2] = (v1 - v0) / g->spacing[2];
  for (int c = 0; c < 3; c++)
    if (c != a && at->at_wall[c]) slope[c] = 0;
  return v0 + f[2] * (v1 - v0);
}

/* m/s, component a at x, which is u on the plane of the first centres and falls linearly to none at the box: so the
 * particles' momentum and energy are those of a flow that sticks. They move with u, which takes through a section what
 * its faces let through. slope, 1/s: the gradient on that plane, of which what is along walls stays, as it is needed
 * there, and what is across them becomes that at x. */
static double stick(const hk_liquid *l, const hk_liquid_place *at, const double x[3], int a, double u,
                    double slope[3]) {
  const hk_liquid_grid *g = &l->grid;
  for (int c = 0; c < 3; c++) {
    if (c == a || g->flat[c] || !at->at_wall[c]) continue;
    double low = x[c] - g->low[c], high = g->high[c] - x[c], rise = 2 * u / g->spacing[c];
    double part = fmax(0, fmin(1, 2 * fmin(low, high) / g->spacing[c]));
    for (int b = 0; b < 3; b++) slope[b] *= b != a && at->at_wall[b] ? part : 1;
    slope[c] = low < high ? rise : -rise;
    u *= part;
  }
  return u;
}

static void gather_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  const hk_liquid *l = t->l;
  const hk_liquid_grid *g = &l->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->p->index[l->sorted[k]];
    hk_liquid_place at;
    hk_liquid_locate(g, t->p->x + 3 * i, &at);
    for (int a = 0; a < 3; a++) {
      double slope[3] = {0}, *v = &t->p->v[3 * i + (size_t)a];
      if (g->flat[a]) {
        *v = 0;
        continue;
      }
      double u = value_and_slope(g, &at, a, slope);
      if (l->sticks) u = stick(l, &at, t->p->x + 3 * i, a, u, slope);
      if (l->transfer == HK_LIQUID_FLIP) u += l->flip * (*v - hk_liquid_value(g, g->before[a], &at, a));
      *v = u;
      bool keeps = l->transfer == HK_LIQUID_APIC;
      for (size_t c = 0; c < 3; c++) t->affine[t->p->apart * i + 3 * (size_t)a + c] = keeps ? slope[c] : 0;
    }
    if (t->full) t->full[i] = hk_liquid_value(g, g->filled, &at, 3);
  }
}

void hk_liquid_gather(hk_liquid *l, const hk_liquid_particles *p, double *affine, double *full) {
  task t = {.l = l, .p = p, .affine = affine, .full = full};
  l->host->parallel_for(l->host, p->count, GRAIN, gather_piece, &t);
}
