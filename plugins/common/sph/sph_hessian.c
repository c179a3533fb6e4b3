#include "plugins/common/sph/sph_hessian.h"

#include "plugins/common/space/reserve.h"
#include "plugins/common/sph/sph_pairs.h"

#include <stdlib.h>

/* ---- which blocks ---- */

static bool counts(const hk_sph *s, size_t i) { return s->point[i][3] > 0; }

static size_t add_column(hk_sph_ring *r, size_t row, uint32_t k, uint32_t *into, size_t count) {
  if (r->mark[k] == row + 1) return count;
  r->mark[k] = (uint32_t)row + 1;
  if (into) into[count] = k;
  return count + 1;
}

/* Neighbours of neighbours of `row`, and all of those themselves; `into` NULL: counts them. */
static size_t list_row(hk_sph_ring *r, const hk_sph *s, const hk_neighbour_rows *rows, size_t row, uint32_t *into) {
  size_t count = counts(s, row) ? add_column(r, row, (uint32_t)row, into, 0) : 0;
  for (size_t e = rows->row_start[row]; count && e < rows->row_start[row + 1]; e++) {
    size_t i = rows->other[e];
    if (!counts(s, i)) continue;
    count = add_column(r, row, (uint32_t)i, into, count);
    for (size_t f = rows->row_start[i]; f < rows->row_start[i + 1]; f++)
      if (counts(s, rows->other[f])) count = add_column(r, row, rows->other[f], into, count);
  }
  return count;
}

static int by_number(const void *a, const void *b) {
  uint32_t first = *(const uint32_t *)a, second = *(const uint32_t *)b;
  return (first > second) - (first < second);
}

static hk_status list_all(hk_sph_ring *r, const hk_sph *s, const hk_neighbour_rows *rows) {
  hk_status status = hk_reserve(s->host, &r->row_start, &r->rows_room, rows->n + 1, sizeof *r->row_start);
  if (status == HK_OK) status = hk_reserve(s->host, &r->mark, &r->mark_room, rows->n, sizeof *r->mark);
  if (status != HK_OK) return status;
  memset(r->mark, 0, rows->n * sizeof *r->mark);
  r->row_start[0] = 0;
  for (size_t i = 0; i < rows->n; i++) r->row_start[i + 1] = r->row_start[i] + list_row(r, s, rows, i, NULL);
  status = hk_reserve(s->host, &r->column, &r->room, r->row_start[rows->n], sizeof *r->column);
  if (status != HK_OK) return status;
  memset(r->mark, 0, rows->n * sizeof *r->mark);
  for (size_t i = 0; i < rows->n; i++) {
    uint32_t *row = r->column + r->row_start[i];
    qsort(row, list_row(r, s, rows, i, row), sizeof *row, by_number);
  }
  return HK_OK;
}

void hk_sph_ring_name(hk_sph_ring *r, hk_sph *s, const hk_view *view, hk_pattern *into) {
  hk_neighbour_rows rows;
  r->number = 0;
  r->failed = hk_sph_begin(s, view, &rows);
  if (r->failed == HK_OK) r->failed = list_all(r, s, &rows);
  if (r->failed != HK_OK) return;
  r->number = rows.number;
  for (size_t i = 0; i < rows.n; i++)
    for (size_t e = r->row_start[i]; e < r->row_start[i + 1]; e++) into->block(into, (uint32_t)i, r->column[e]);
}

/* ---- the blocks ---- */

typedef struct task {
  const hk_sph_ring *ring;
  const hk_sph_rows *near;
  const hk_sph_bends *bends;
  const hk_view *view;
  const hk_blocks *into;
} task;

/* The blocks of a row, found in rising order. */
typedef struct finder {
  const task *t;
  size_t at, end;
} finder;

static finder find_from_start(const task *t, size_t row) {
  return (finder){t, t->ring->row_start[row], t->ring->row_start[row + 1]};
}

static double *find(finder *f, uint32_t column) {
  const uint32_t *columns = f->t->ring->column;
  while (f->at < f->end && columns[f->at] < column) f->at++;
  return f->t->into->K + 9 * f->t->into->slot[f->at];
}

/* d rho_i/dx_j of a neighbour within the kernel, kg/m^4, or none. */
static bool gradient(const task *t, size_t i, size_t j, double g[3]) {
  const hk_sph *s = t->near->sph;
  double d[3], r2 = hk_sph_between(t->view, i, j, d), by = s->point[j][3] * hk_sph_slope(&s->kernel, r2);
  for (int c = 0; c < 3; c++) g[c] = by * d[c];
  return r2 < s->kernel.radius2 && by > 0;
}

static void add_product(double *block, double by, const double a[3], const double b[3]) {
  for (int q = 0; q < 9; q++) block[q] += by * a[q / 3] * b[q % 3];
}

/* b_i g_ij g_i^T, of the particle i whose density has the gradient g = g_ij at the row's place; its gradient at its own
 * place is minus the sum of the others. */
static void add_square(const task *t, size_t row, size_t i, const double g[3]) {
  const hk_neighbour_rows *rows = &t->near->rows;
  double by = t->bends->bend[i], own[3] = {0}, of[3];
  finder others = find_from_start(t, row), self = others;
  for (size_t e = rows->row_start[i]; e < rows->row_start[i + 1]; e++) {
    if (!gradient(t, i, rows->other[e], of)) continue;
    add_product(find(&others, rows->other[e]), by, g, of);
    for (int c = 0; c < 3; c++) own[c] -= of[c];
  }
  add_product(find(&self, (uint32_t)i), by, g, own);
}

/* The pairs' part of the row, (a_i w_j + a_j w_i) d2W/dx2. */
static void add_bends(const task *t, size_t i) {
  const hk_sph *s = t->near->sph;
  const hk_neighbour_rows *rows = &t->near->rows;
  const double *a = t->bends->slope;
  double H[9], d[3];
  finder others = find_from_start(t, i), self = others;
  double *own = find(&self, (uint32_t)i);
  for (size_t e = rows->row_start[i]; e < rows->row_start[i + 1]; e++) {
    uint32_t j = rows->other[e];
    double r2 = hk_sph_between(t->view, i, j, d), by = a[i] * s->point[j][3] + a[j] * s->point[i][3];
    if (!(r2 < s->kernel.radius2) || by == 0) continue;
    double along = by * hk_sph_curvature(&s->kernel, r2), across = -by * hk_sph_slope(&s->kernel, r2);
    if (t->bends->definite) along = fmax(0, along), across = fmax(0, across);
    hk_sph_pair_hessian(along, across, d, r2, H);
    double *other = find(&others, j);
    for (int q = 0; q < 9; q++) own[q] += H[q], other[q] -= H[q];
  }
}

static void add_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const hk_neighbour_rows *rows = &t->near->rows;
  double g[3], own[3];
  (void)chunk;
  for (size_t i = first; i < end; i++) {
    if (!counts(t->near->sph, i)) continue;
    memset(own, 0, sizeof own);
    for (size_t e = rows->row_start[i]; e < rows->row_start[i + 1]; e++) {
      size_t other = rows->other[e];
      if (gradient(t, i, other, g))
        for (int c = 0; c < 3; c++) own[c] -= g[c];
      if (t->bends->bend[other] != 0 && gradient(t, other, i, g)) add_square(t, i, other, g);
    }
    if (t->bends->bend[i] != 0) add_square(t, i, i, own);
    add_bends(t, i);
  }
}

hk_status hk_sph_ring_add(const hk_sph_ring *r, const hk_sph_rows *near, const hk_sph_bends *bends, const hk_view *view,
                          const hk_blocks *into) {
  task t = {r, near, bends, view, into};
  if (r->failed == HK_OK) view->host->parallel_for(view->host, view->n, HK_SPH_GRAIN / 16, add_chunk, &t);
  return r->failed;
}

/* ---- bounds ---- */

/* (g_i.u)^2 <= G_i sum_j w_j |W'| (n.(u_i - u_j))^2 by Cauchy and Schwarz, G_i = sum_j w_j |W'|, and (n.(u_i - u_j))^2
 * is at most twice (n.u_i)^2 + (n.u_j)^2; H_i is of pairs already. This is what a pair of i has, once for each end. */
typedef struct pair_bound {
  double along, across;
} pair_bound;

static double steepness_around(const hk_sph_rows *t, size_t i, hk_sph_near *near) {
  double sum = 0;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(t->sph, t->box, t->rows.other, end, i, &at, near);
    for (size_t k = 0; k < near->count; k++)
      sum += near->mass[k] * hk_sph_slope(&t->sph->kernel, near->r2[k]) * sqrt(near->r2[k]);
  }
  return sum;
}

static void add_bound(double *block, const pair_bound *b, const hk_sph_near *near, size_t k) {
  double inverse = near->r2[k] > 0 ? 1 / near->r2[k] : 0;
  for (int a = 0, at = 0; a < 3; a++)
    for (int c = a; c < 3; c++, at++)
      block[at] += b->across * (a == c) + (b->along - b->across) * near->d[a][k] * near->d[c][k] * inverse;
}

/* Serial: it adds to the blocks of both ends. */
void hk_sph_bound_pairs(const hk_sph_rows *t, const hk_sph_bends *bends, const hk_view *view, double (*block)[6]) {
  const hk_sph_kernel *kernel = &t->sph->kernel;
  hk_sph_near near;
  for (size_t m = 0; m < view->acting; m++) {
    size_t i = hk_sph_acting(view, m);
    double slope = bends->slope[i], bend = bends->bend[i];
    if (slope == 0 && bend == 0) continue;
    double steep = steepness_around(t, i, &near);
    for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
      hk_sph_gather(t->sph, t->box, t->rows.other, end, i, &at, &near);
      for (size_t k = 0; k < near.count; k++) {
        double r2 = near.r2[k], fall = hk_sph_slope(kernel, r2), twice = 2 * near.mass[k];
        pair_bound b = {twice * (bend * steep * fall * sqrt(r2) + fmax(0, slope * hk_sph_curvature(kernel, r2))),
                        twice * fmax(0, -slope * fall)};
        add_bound(block[i], &b, &near, k);
        add_bound(block[near.other[k]], &b, &near, k);
      }
    }
  }
}
