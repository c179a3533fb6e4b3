#include "plugins/common/sph/sph_list.h"

#include "plugins/common/space/reserve.h"

static hk_status reserve(hk_sph_list *l, const hk_host *host, const hk_neighbour_rows *rows) {
  size_t n = rows->n, most = rows->row_start[n] + (HK_SPH_FOUR - 1) * n;
  hk_status status = hk_reserve(host, &l->point, &l->point_room, n, sizeof *l->point);
  if (status == HK_OK) status = hk_reserve(host, &l->density, &l->density_room, n, sizeof *l->density);
  if (status == HK_OK) status = hk_reserve(host, &l->diagonal, &l->diagonal_room, n, sizeof *l->diagonal);
  if (status == HK_OK) status = hk_reserve(host, &l->start, &l->start_room, n, sizeof *l->start);
  if (status == HK_OK) status = hk_reserve(host, &l->count, &l->count_room, n, sizeof *l->count);
  if (status == HK_OK) status = hk_reserve(host, &l->other, &l->other_room, most, sizeof *l->other);
  if (status == HK_OK) status = hk_reserve(host, &l->weight, &l->weight_room, most, sizeof *l->weight);
  return status;
}

/* What a row adds up to. */
typedef struct sums {
  double density, gradient[3], others; /* kg/m^3; kg/m^4; kg/m^8 over m */
} sums;

HK_INLINE void add_near(const hk_sph *s, const double *inverse_mass, double own, const hk_sph_near *near, float *weight,
                        sums *sum) {
  double part[HK_SPH_NEAR], fall[HK_SPH_NEAR], w0 = s->density * s->spacing * s->spacing * s->spacing;
  for (size_t k = 0; k < near->count; k++) {
    double t = hk_sph_part(&s->kernel, near->r2[k]), u = 1 - t, mass = near->mass[k];
    fall[k] = mass * (s->kernel.steepness * u * u * u);
    weight[k] = (float)(own * mass / (w0 * w0) * (u * u * u)); /* the same of both */
    part[k] = mass * (s->kernel.amplitude * (u * u) * (u * u) * (1 + 4 * t));
  }
  for (size_t k = 0; k < near->count; k++) {
    sum->density += part[k];
    for (int c = 0; c < 3; c++) sum->gradient[c] += fall[k] * near->d[c][k];
    sum->others += inverse_mass[near->other[k]] * fall[k] * fall[k] * near->r2[k];
  }
}

/* Returns where the next row begins. */
HK_INLINE size_t fill_row(hk_sph_list *l, const hk_sph_rows *t, const hk_periodic_box *box, const double *inverse_mass,
                          size_t i, size_t to, sums *sum) {
  const hk_sph *s = t->sph;
  hk_sph_near near;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(s, box, t->rows.other, end, i, &at, &near);
    add_near(s, inverse_mass, s->point[i][3], &near, l->weight + to, sum);
    memcpy(l->other + to, near.other, near.count * sizeof *near.other);
    to += near.count;
  }
  for (; (to - l->start[i]) % HK_SPH_FOUR; to++) l->other[to] = (uint32_t)i, l->weight[to] = 0;
  return to;
}

typedef struct filling {
  hk_sph_list *list;
  const hk_sph_rows *rows;
  const hk_view *view;
} filling;

/* Rows of a chunk follow each other in memory. */
HK_INLINE void fill_rows(const filling *f, const hk_periodic_box *box, size_t first, size_t end) {
  const hk_sph *s = f->rows->sph;
  hk_sph_list *l = f->list;
  const double *inverse_mass = f->view->model->inverse_mass;
  size_t to = f->rows->rows.row_start[first] + (HK_SPH_FOUR - 1) * first;
  for (size_t i = first; i < end; i++) {
    sums sum = {.density = s->point[i][3] * s->kernel.amplitude};
    l->start[i] = to;
    l->density[i] = l->diagonal[i] = 0;
    bool moves = s->role[i] == HK_SPH_WALL && hk_model_moves(f->view->model, i);
    if (s->role[i] == HK_SPH_LIQUID || moves) to = fill_row(l, f->rows, box, inverse_mass, i, to, &sum);
    if (s->role[i] == HK_SPH_LIQUID) {
      const double *g = sum.gradient;
      l->density[i] = sum.density;
      l->diagonal[i] = inverse_mass[i] * (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) + sum.others;
    }
    l->count[i] = (uint32_t)(to - l->start[i]);
  }
}

/* In open space it is known to the compiler that there is no box. */
HK_VERSIONS(static void, filled, (const filling *f, size_t first, size_t end),
            f->rows->box ? fill_rows(f, f->rows->box, first, end) : fill_rows(f, NULL, first, end))

static void fill_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const filling *f = context;
  (void)chunk;
  HK_WIDEST(f->view->host->lanes, filled)(f, first, end);
}

/* As numbers: pins may change the sign of a 0. */
static bool is_of(const hk_sph_list *l, const hk_sph *s, size_t n) {
  bool other = l->n != n;
  for (size_t i = 0; i < n && !other; i++)
    for (int c = 0; c < 4; c++) other |= l->point[i][c] != s->point[i][c];
  return !other;
}

hk_status hk_sph_list_make(hk_sph_list *l, const hk_sph_rows *rows, const hk_view *view) {
  filling f = {l, rows, view};
  size_t n = view->n;
  if (is_of(l, rows->sph, n)) return HK_OK;
  l->n = 0;
  hk_status status = reserve(l, view->host, &rows->rows);
  if (status != HK_OK) return status;
  view->host->parallel_for(view->host, n, HK_SPH_GRAIN, fill_chunk, &f);
  if (n > 0) memcpy(l->point, rows->sph->point, n * sizeof *l->point);
  l->n = n;
  return HK_OK;
}
