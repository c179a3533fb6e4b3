/* The curvature of a liquid's surface, and what its tension does to velocities. */
#include "plugins/common/liquid/tension.h"

enum { SMOOTHINGS = 3, LAYERS = 2 /* of cells beyond those about the surface that get its curvature */ };

static const double least_part = 1e-3, farthest = 2.2; /* of logarithms: parts of 0.1 to 0.9, some 1.7 cells away */

typedef struct task {
  hk_liquid *l;
  hk_tension *t;
  const double *from;
  double *to;
  int axis;
  double factor;
} task;

typedef void (*cell_body)(const task *t, const hk_liquid_row *row, size_t i);

/* Numbers of the cells before and behind one along an axis; at the box the cell itself, whose mirror image is there. */
typedef struct sides {
  size_t prior, next;
} sides;

static sides beside(const hk_liquid_grid *g, const hk_liquid_row *row, size_t i, int c) {
  size_t at = row->cell[c] + (c == hk_liquid_inner(g) ? i - row->first : 0);
  return (sides){at == 1 ? i : i - g->stride[c], at == g->cells[c] ? i : i + g->stride[c]};
}

static void each_cell(const task *t, size_t begin, size_t end, cell_body body) {
  const hk_liquid_grid *g = &t->l->grid;
  for (size_t k = begin; k < end; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 0);
    for (size_t i = row.first; i < row.first + g->cells[hk_liquid_inner(g)]; i++) body(t, &row, i);
  }
}

#define ROWS_OF(name)                                                                                                  \
  static void name##_rows(void *context, size_t begin, size_t end, size_t piece) {                                     \
    (void)piece;                                                                                                       \
    each_cell(context, begin, end, name);                                                                              \
  }

/* ---- the curvature ---- */

static void copy(const task *t, const hk_liquid_row *row, size_t i) {
  (void)row;
  t->to[i] = fmax(0, fmin(1, t->from[i]));
}

/* 1/4, 1/2, 1/4 along an axis. */
static void smooth(const task *t, const hk_liquid_row *row, size_t i) {
  const sides s = beside(&t->l->grid, row, i, t->axis);
  t->to[i] = 0.5 * t->from[i] + 0.25 * (t->from[s.prior] + t->from[s.next]);
}

/* The logarithm of the empty part by the filled one, nearly proportional to the distance, as the smoothed parts fall
 * off nearly as the normal distribution does: differences of it are good where those of the parts are not. */
static void straighten(const task *t, const hk_liquid_row *row, size_t i) {
  double part = fmax(least_part, fmin(1 - least_part, t->from[i]));
  (void)row;
  t->to[i] = log((1 - part) / part);
}

ROWS_OF(copy)
ROWS_OF(smooth)
ROWS_OF(straighten)

/* 1/m */
static double slope(const hk_liquid_grid *g, const hk_liquid_row *row, const double *f, size_t i, int c) {
  const sides s = beside(g, row, i, c);
  return g->flat[c] ? 0 : (f[s.next] - f[s.prior]) / (2 * g->spacing[c]);
}

/* 1/m^2: d^2 f/(da db). */
static double second_slope(const hk_liquid_grid *g, const hk_liquid_row *row, const double *f, size_t i, int a, int b) {
  const sides s = beside(g, row, i, a), r = beside(g, row, i, b);
  if (g->flat[a] || g->flat[b]) return 0;
  if (a == b) return (f[s.next] - 2 * f[i] + f[s.prior]) / (g->spacing[a] * g->spacing[a]);
  size_t up = r.next - i, down = i - r.prior;
  return (f[s.next + up] - f[s.next - down] - f[s.prior + up] + f[s.prior - down]) /
         (4 * g->spacing[a] * g->spacing[b]);
}

/* div (grad f / |grad f|), 1/m, of the surface through the cell's centre. */
static double curvature(const hk_liquid_grid *g, const hk_liquid_row *row, const double *f, size_t i, double size,
                        const double n[3]) {
  double trace = 0, along = 0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      double second = second_slope(g, row, f, i, a, b);
      if (a == b) trace += second;
      along += n[a] * n[b] * second;
    }
  return (trace - along) / size;
}

/* Of parallel surfaces at a distance d the curvature k/m of each of m directions is that of k / (1 - k d/m). */
static void bend(const task *t, const hk_liquid_row *row, size_t i) {
  const hk_liquid_grid *g = &t->l->grid;
  const double *f = t->t->part;
  double n[3], size = 0, cell = 0;
  int ways = -1;
  for (int c = 0; c < 3; c++) {
    n[c] = slope(g, row, f, i, c);
    size += n[c] * n[c];
    ways += !g->flat[c];
    cell = fmax(cell, g->flat[c] ? 0 : g->spacing[c]);
  }
  size = sqrt(size);
  t->t->known[i] = fabs(f[i]) < farthest && size > 0;
  t->t->bend[i] = 0;
  if (!t->t->known[i]) return;
  for (int c = 0; c < 3; c++) n[c] /= size;
  double k = curvature(g, row, f, i, size, n) / ways, d = f[i] / size, most = 1 / cell;
  k = k / fmax(0.25, 1 - k * d);
  t->t->bend[i] = ways * fmax(-most, fmin(most, k));
}

ROWS_OF(bend)

/* The mean of the neighbours that know theirs. t->to gets it, and is then what is known. */
static void spread(const task *t, const hk_liquid_row *row, size_t i) {
  double sum = 0, count = 0;
  t->to[i] = NAN;
  if (t->t->known[i]) return;
  for (int c = 0; c < 3; c++) {
    const sides s = beside(&t->l->grid, row, i, c);
    if (t->t->known[s.prior]) sum += t->t->bend[s.prior], count++;
    if (t->t->known[s.next]) sum += t->t->bend[s.next], count++;
  }
  if (count > 0) t->to[i] = sum / count;
}

static void settle(const task *t, const hk_liquid_row *row, size_t i) {
  (void)row;
  if (isnan(t->to[i])) return;
  t->t->bend[i] = t->to[i];
  t->t->known[i] = true;
}

ROWS_OF(spread)
ROWS_OF(settle)

/* ---- what it does ---- */

static void push(const task *t, const hk_liquid_row *row, size_t i) {
  hk_liquid_grid *g = &t->l->grid;
  (void)row;
  for (int c = 0; c < 3; c++) {
    if (g->flat[c] || !(g->open[c][i] > 0)) continue;
    g->u[c][i] -= t->factor * (t->t->bend[i] - t->t->bend[i - g->stride[c]]) / g->spacing[c];
  }
}

ROWS_OF(push)

static hk_status make_room(hk_tension *t, const hk_liquid *l) {
  const hk_host *host = l->host;
  if (t->part) return HK_OK;
  t->part = host->allocate(host, l->grid.size * sizeof *t->part);
  t->other = host->allocate(host, l->grid.size * sizeof *t->other);
  t->bend = host->allocate(host, l->grid.size * sizeof *t->bend);
  t->known = host->allocate(host, l->grid.size);
  if (t->part && t->other && t->bend && t->known) return HK_OK;
  hk_tension_close(t, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for the tension of %zu cells: take larger ones", l->grid.size);
}

hk_status hk_liquid_draw_in(hk_liquid *l, hk_tension *t, double h) {
  const size_t rows = hk_liquid_rows(&l->grid, 0);
  hk_status status = make_room(t, l);
  if (status != HK_OK) return status;
  task k = {.l = l, .t = t, .from = l->grid.filled, .to = t->part, .factor = h * t->tension / l->density};
  l->host->parallel_for(l->host, rows, 16, copy_rows, &k);
  for (int n = 0; n < SMOOTHINGS; n++)
    for (k.axis = 0; k.axis < 3; k.axis++) {
      if (l->grid.flat[k.axis]) continue;
      double *smoothed = t->other;
      k.from = t->part;
      k.to = smoothed;
      l->host->parallel_for(l->host, rows, 16, smooth_rows, &k);
      t->other = t->part;
      t->part = smoothed;
    }
  k.from = k.to = t->part;
  l->host->parallel_for(l->host, rows, 16, straighten_rows, &k);
  l->host->parallel_for(l->host, rows, 16, bend_rows, &k);
  k.to = t->other;
  for (int n = 0; n < LAYERS; n++) {
    l->host->parallel_for(l->host, rows, 16, spread_rows, &k);
    l->host->parallel_for(l->host, rows, 16, settle_rows, &k);
  }
  l->host->parallel_for(l->host, rows, 16, push_rows, &k);
  return HK_OK;
}

void hk_tension_close(hk_tension *t, const hk_host *host) {
  host->release(host, t->part);
  host->release(host, t->other);
  host->release(host, t->bend);
  host->release(host, t->known);
  t->part = t->other = t->bend = NULL;
  t->known = NULL;
}
