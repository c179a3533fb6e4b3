#include "plugins/common/sph/sph_spread.h"

static const double together = 0.5; /* of the spacing */
/* Of the kernel's sum of slopes, by its radius: 1.5 at a flat surface, in a plane, and 0 below the kernel's radius. */
static const double within = 0.3;
static const double apart = 0.2; /* of the shift, as in the paper, by what keeps pairs from forming */

typedef struct task {
  const hk_sph_rows *rows;
  const hk_sph *sph;
  const hk_sph_list *list;
  const hk_view *view;
  double (*way)[3];
  double beside; /* 1/m^3, W(dx) */
  double within; /* slopes below are those of particles that are looked at */
} task;

/* Within the liquid: at a surface neighbours come together to make up for those that are missing. */
static bool has_partner(const task *t, size_t i) {
  const hk_sph_rows *rows = t->rows;
  const hk_sph *s = rows->sph;
  double most2 = together * together * s->spacing * s->spacing, slope[3] = {0};
  bool found = false;
  hk_sph_near near;
  for (size_t at = rows->rows.row_start[i], end = rows->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(s, rows->box, rows->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) {
      double by = near.mass[k] / s->density * s->kernel.radius * hk_sph_slope(&s->kernel, near.r2[k]);
      for (int c = 0; c < 3; c++) slope[c] += by * near.d[c][k];
      found |= near.r2[k] < most2 && near.mass[k] > 0 && s->role[near.other[k]] == HK_SPH_LIQUID;
    }
  }
  return found && slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2] < t->within * t->within;
}

static void pair_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const hk_sph *s = t->rows->sph;
  double *sum = s->sums + 2 * chunk;
  sum[0] = sum[1] = 0;
  for (size_t i = first; i < end; i++) {
    if (s->role[i] != HK_SPH_LIQUID || !(s->point[i][3] > 0)) continue;
    sum[0] += has_partner(t, i);
    sum[1]++;
  }
}

double hk_sph_paired(const hk_sph_rows *rows, const hk_view *view, bool full) {
  task t = {.rows = rows, .within = full ? INFINITY : within};
  double sum = 0, count = 0;
  view->host->parallel_for(view->host, view->n, HK_SPH_GRAIN, pair_chunk, &t);
  for (size_t k = 0; k * HK_SPH_GRAIN < view->n; k++) {
    sum += rows->sph->sums[2 * k];
    count += rows->sph->sums[2 * k + 1];
  }
  return count > 0 ? sum / count : 0;
}

static void add_way(const task *t, size_t i, double way[3]) {
  const hk_sph *s = t->sph;
  const hk_sph_list *l = t->list;
  for (size_t e = l->start[i]; e < l->start[i] + l->count[i]; e++) {
    const double *x = s->point[i], *y = s->point[l->other[e]];
    double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    if (t->view->model->box) hk_nearest_image(t->view->model->box, d);
    double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], near = hk_sph_value(&s->kernel, r2) / t->beside;
    double by = y[3] / s->density * s->kernel.radius * hk_sph_slope(&s->kernel, r2);
    by *= 1 + apart * (near * near) * (near * near);
    for (int c = 0; c < 3; c++) way[c] += by * d[c];
  }
}

static void way_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t i = first; i < end; i++) {
    memset(t->way[i], 0, sizeof t->way[i]);
    if (t->list->diagonal[i] > 0) add_way(t, i, t->way[i]);
  }
}

void hk_sph_way_apart(const hk_sph *s, const hk_sph_list *list, const hk_view *view, double (*way)[3]) {
  task t = {.sph = s, .list = list, .view = view, .way = way};
  t.beside = hk_sph_value(&s->kernel, s->spacing * s->spacing);
  view->host->parallel_for(view->host, view->n, HK_SPH_GRAIN, way_chunk, &t);
}
