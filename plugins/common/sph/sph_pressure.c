#include "plugins/common/sph/sph_pressure.h"

static const double relaxation = 0.5; /* of Jacobi's iteration, as in the paper */

static bool is_liquid(const hk_sph_pressure *p, size_t i) { return p->sph->role[i] == HK_SPH_LIQUID; }

/* |sum w_j grad W|^2/m_i + sum over the liquid of w_j^2 |grad W|^2/m_j. */
static double diagonal_of(const hk_sph_pressure *p, size_t i) {
  const hk_sph *s = p->sph;
  double sum[3] = {0}, others = 0;
  hk_sph_near near;
  for (size_t at = p->near.rows.row_start[i], end = p->near.rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(s, p->near.box, p->near.rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) {
      double fall = near.mass[k] * hk_sph_slope(&s->kernel, near.r2[k]);
      for (int c = 0; c < 3; c++) sum[c] += fall * near.d[c][k];
      others += p->view->model->inverse_mass[near.other[k]] * fall * fall * near.r2[k];
    }
  }
  double inverse = p->view->model->inverse_mass[i];
  return inverse * (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) + others;
}

static void measure_chunk(void *context, size_t first, size_t end, size_t chunk) {
  hk_sph_pressure *p = context;
  (void)chunk;
  for (size_t i = first; i < end; i++) {
    p->density[i] = is_liquid(p, i) ? hk_sph_density(&p->near, p->near.box, i) : 0;
    p->diagonal[i] = is_liquid(p, i) ? diagonal_of(p, i) : 0;
  }
}

hk_status hk_sph_pressure_begin(hk_sph_pressure *p, const hk_view *view) {
  p->view = view;
  p->near = (hk_sph_rows){.sph = p->sph, .box = view->model->box};
  hk_status status = hk_sph_begin(p->sph, view, &p->near.rows);
  if (status != HK_OK) return status;
  view->host->parallel_for(view->host, view->n, HK_SPH_GRAIN, measure_chunk, p);
  return HK_OK;
}

/* ---- an iteration ---- */

/* v = velocity - M^-1 (d rho/dx)^T a */
HK_INLINE void add_impulses(const hk_sph_pressure *p, const hk_periodic_box *box, size_t first, size_t end) {
  for (size_t i = first; i < end; i++) {
    double sum[3] = {0}, inverse = p->view->model->inverse_mass[i];
    if (is_liquid(p, i)) hk_sph_push(&p->near, box, i, p->a, sum);
    for (size_t c = 0; c < 3; c++) p->v[3 * i + c] = p->velocity[3 * i + c] + inverse * sum[c];
  }
}

/* kg/(m^3 s), by which the density of a particle rises too fast; negative: it could rise faster. */
HK_INLINE double excess_of(const hk_sph_pressure *p, const hk_periodic_box *box, size_t i) {
  double rate = hk_sph_density_rate(&p->near, box, i, p->v), room = p->density[i] - p->sph->density;
  if (p->h > 0) return rate + room / fmax(p->h, p->longest);
  return room < 0 ? -INFINITY : rate; /* where neighbours are missing nothing is held */
}

/* Returns the sum of what is off, also where a pressure holds apart what would not come together. */
HK_INLINE double relax(hk_sph_pressure *p, const hk_periodic_box *box, size_t first, size_t end) {
  double sum = 0;
  for (size_t i = first; i < end; i++) {
    if (!is_liquid(p, i) || !(p->diagonal[i] > 0)) continue;
    double before = p->a[i], to = fmax(0, before + excess_of(p, box, i) / p->diagonal[i]);
    p->a[i] = before + relaxation * (to - before);
    sum += fabs(to - before) * p->diagonal[i];
  }
  return sum;
}

/* In open space it is known to the compiler that there is no box. */
HK_VERSIONS(static void, impulses, (const hk_sph_pressure *p, size_t first, size_t end),
            p->near.box ? add_impulses(p, p->near.box, first, end) : add_impulses(p, NULL, first, end))
HK_VERSIONS(static double, relaxed, (hk_sph_pressure * p, size_t first, size_t end),
            return p->near.box ? relax(p, p->near.box, first, end) : relax(p, NULL, first, end))

static void impulse_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const hk_sph_pressure *p = context;
  (void)chunk;
  HK_WIDEST(p->view->host->lanes, impulses)(p, first, end);
}

static void relax_chunk(void *context, size_t first, size_t end, size_t chunk) {
  hk_sph_pressure *p = context;
  p->sph->sums[chunk] = HK_WIDEST(p->view->host->lanes, relaxed)(p, first, end);
}

/* Of the last relaxation, before it. */
static double mean_excess(const hk_sph_pressure *p) {
  double sum = 0, count = 0;
  for (size_t k = 0; k * HK_SPH_GRAIN < p->view->n; k++) sum += p->sph->sums[k];
  for (size_t i = 0; i < p->view->n; i++) count += is_liquid(p, i);
  return count > 0 ? sum / count / p->sph->density : 0;
}

void hk_sph_pressure_solve(hk_sph_pressure *p, double *v, double scale, double tolerance, size_t most) {
  const hk_host *host = p->view->host;
  memcpy(p->velocity, v, 3 * p->view->n * sizeof *v);
  for (p->iterations = 0;; p->iterations++) {
    host->parallel_for(host, p->view->n, HK_SPH_GRAIN, impulse_chunk, p);
    if (p->iterations == most) break;
    host->parallel_for(host, p->view->n, HK_SPH_GRAIN, relax_chunk, p);
    p->off = scale * mean_excess(p);
    if (p->off < tolerance) break;
  }
  p->changed |= memcmp(v, p->v, 3 * p->view->n * sizeof *v) != 0;
  memcpy(v, p->v, 3 * p->view->n * sizeof *v);
}
