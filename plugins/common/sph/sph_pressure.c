#include "plugins/common/sph/sph_pressure.h"

typedef double four __attribute__((vector_size(32), aligned(8), may_alias));

static const double relaxation = 0.5; /* of Jacobi's iteration, as in the paper */

/* Iterations, also where the last step's pressures would do: in short steps what is tolerated of a density is more than
 * weight does to it, and pressures that wait for it come in blows. */
static const size_t fewest = 2;

/* Steps in which a density that is off is made good where pressure pulls: particles that a vortex has stirred get what
 * they need of it as velocities, and in one step these are more than the flow's. With 4 to 64 a vortex of Re 200 keeps
 * the energy of theory to 1.5 % in a fifth of its life, with 1 it loses 23 %. */
static const double slowly = 8;

/* kg/m^3, of the liquid. */
static double mean_density(const hk_sph_pressure *p) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < p->view->n; i++) sum += p->list->density[i], count += p->list->density[i] > 0;
  return count > 0 ? sum / count : p->sph->density;
}

hk_status hk_sph_pressure_begin(hk_sph_pressure *p, const hk_view *view, const hk_correction *c) {
  p->view = view;
  p->near = (hk_sph_rows){.sph = p->sph, .box = view->model->box};
  hk_status status = hk_sph_begin(p->sph, view, &p->near.rows);
  if (status == HK_OK) status = hk_sph_list_make(p->list, &p->near, view);
  if (status == HK_OK) status = hk_sph_bodies_begin(p->bodies, p->sph, view, c);
  if (status != HK_OK) return status;
  hk_sph_bodies_couple(p->bodies, p->sph, p->list, p->near.box);
  p->density = p->pulls ? mean_density(p) : p->sph->density;
  return HK_OK;
}

/* ---- an iteration ---- */

/* d = x - the place of `other`, or of its nearest image. */
HK_INLINE void take_between(const hk_sph_pressure *p, const hk_periodic_box *box, const four *x, uint32_t other,
                            four *d) {
  *d = *x - *(const four *)p->sph->point[other];
  if (!box) return;
  double to[3] = {(*d)[0], (*d)[1], (*d)[2]};
  hk_nearest_image(box, to);
  *d = (four){to[0], to[1], to[2]};
}

/* push = sum of (a_i + a_j) s d, by four sums, so that additions do not wait for each other. */
HK_INLINE void find_push(const hk_sph_pressure *p, const hk_periodic_box *box, size_t i, four *push) {
  const uint32_t *other = p->list->other + p->list->start[i];
  const float *weight = p->list->weight + p->list->start[i];
  const double *a = p->a, own = a[i];
  four x = *(const four *)p->sph->point[i], sum[HK_SPH_FOUR] = {{0}}, d;
  for (size_t e = 0, count = p->list->count[i]; e < count; e += HK_SPH_FOUR)
    for (size_t q = 0; q < HK_SPH_FOUR; q++) {
      take_between(p, box, &x, other[e + q], &d);
      sum[q] += d * ((own + a[other[e + q]]) * (double)weight[e + q]);
    }
  *push = (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* sum of s d.(v_i - v_j) */
HK_INLINE double separation_rate(const hk_sph_pressure *p, const hk_periodic_box *box, size_t i) {
  const uint32_t *other = p->list->other + p->list->start[i];
  const float *weight = p->list->weight + p->list->start[i];
  four x = *(const four *)p->sph->point[i], v = *(const four *)p->v[i], sum[HK_SPH_FOUR] = {{0}}, d;
  for (size_t e = 0, count = p->list->count[i]; e < count; e += HK_SPH_FOUR)
    for (size_t q = 0; q < HK_SPH_FOUR; q++) {
      take_between(p, box, &x, other[e + q], &d);
      sum[q] += d * (v - *(const four *)p->v[other[e + q]]) * (double)weight[e + q];
    }
  four all = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  return (all[0] + all[1]) + all[2];
}

/* v = before - M^-1 (d rho/dx)^T a, of the liquid; of walls that move the impulse. */
HK_INLINE void add_impulses(const hk_sph_pressure *p, const hk_periodic_box *box, size_t first, size_t end) {
  double scale = hk_sph_list_scale(p->sph);
  for (size_t i = first; i < end; i++) {
    const double *v = p->before + 3 * i;
    bool moves = p->bodies->movers > 0 && p->bodies->mover_of[i];
    double by = (moves ? 1 : p->view->model->inverse_mass[i]) * scale;
    four push, start = {0};
    find_push(p, box, i, &push);
    push[3] = 0;
    if (!moves) start = (four){v[0], v[1], v[2], 0};
    *(four *)p->v[i] = start + by * push;
  }
}

/* kg/(m^3 s), by which the density of a particle rises too fast; negative: it could rise faster. */
HK_INLINE double excess_of(const hk_sph_pressure *p, double rate, size_t i) {
  double room = p->list->density[i] - p->density;
  if (p->h > 0) return rate + room / (fmax(p->h, p->longest) * (p->pulls ? slowly : 1));
  return room < 0 && !p->pulls ? -INFINITY : rate; /* where neighbours are missing nothing is held */
}

HK_INLINE double diagonal_of(const hk_sph_pressure *p, size_t i) {
  return p->list->diagonal[i] + (p->bodies->movers > 0 ? p->bodies->coupling[i] : 0);
}

/* Sum of what is off, also where a pressure holds apart what would not come together; and the number of particles
 * that a pressure acts on. */
HK_INLINE void relax(hk_sph_pressure *p, const hk_periodic_box *box, size_t first, size_t end, double sum[2]) {
  double scale = hk_sph_list_scale(p->sph);
  sum[0] = sum[1] = 0;
  for (size_t i = first; i < end; i++) {
    if (!(p->list->diagonal[i] > 0)) continue;
    double mass = p->sph->point[i][3], rate = -scale / mass * separation_rate(p, box, i), diagonal = diagonal_of(p, i);
    double change = excess_of(p, rate, i) / diagonal, before = p->a[i], to = fmax(0, before + change / mass);
    p->a[i] = before + relaxation * (to - before);
    sum[0] += fabs(to - before) * mass * diagonal;
    sum[1] += before > 0 || to > 0;
  }
}

/* Where it pulls: what is above, and the sum of it. */
HK_INLINE void find_excess(hk_sph_pressure *p, const hk_periodic_box *box, size_t first, size_t end, double sum[2]) {
  double scale = hk_sph_list_scale(p->sph);
  sum[0] = sum[1] = 0;
  for (size_t i = first; i < end; i++) {
    if (!(p->list->diagonal[i] > 0)) continue;
    p->excess[i] = excess_of(p, -scale / p->sph->point[i][3] * separation_rate(p, box, i), i);
    sum[0] += p->excess[i];
    sum[1]++;
  }
}

static void pull_chunk(void *context, size_t first, size_t end, size_t chunk) {
  hk_sph_pressure *p = context;
  double *sum = p->sph->sums + 2 * chunk;
  sum[0] = sum[1] = 0;
  for (size_t i = first; i < end; i++) {
    if (!(p->list->diagonal[i] > 0)) continue;
    double off = p->excess[i] - p->mean;
    p->a[i] += relaxation * off / (diagonal_of(p, i) * p->sph->point[i][3]);
    sum[0] += fabs(off);
    sum[1]++;
  }
}

/* In open space it is known to the compiler that there is no box. */
HK_VERSIONS(static void, impulses, (const hk_sph_pressure *p, size_t first, size_t end),
            p->near.box ? add_impulses(p, p->near.box, first, end) : add_impulses(p, NULL, first, end))
HK_VERSIONS(static void, relaxed, (hk_sph_pressure * p, size_t first, size_t end, double sum[2]),
            p->near.box ? relax(p, p->near.box, first, end, sum) : relax(p, NULL, first, end, sum))
HK_VERSIONS(static void, excesses, (hk_sph_pressure * p, size_t first, size_t end, double sum[2]),
            p->near.box ? find_excess(p, p->near.box, first, end, sum) : find_excess(p, NULL, first, end, sum))

static void impulse_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const hk_sph_pressure *p = context;
  (void)chunk;
  HK_WIDEST(p->view->host->lanes, impulses)(p, first, end);
}

static void relax_chunk(void *context, size_t first, size_t end, size_t chunk) {
  hk_sph_pressure *p = context;
  HK_WIDEST(p->view->host->lanes, relaxed)(p, first, end, p->sph->sums + 2 * chunk);
}

static void excess_chunk(void *context, size_t first, size_t end, size_t chunk) {
  hk_sph_pressure *p = context;
  HK_WIDEST(p->view->host->lanes, excesses)(p, first, end, p->sph->sums + 2 * chunk);
}

/* Mean of the chunks' sums: of what is under pressure, so that drops in the air do not dilute it. */
static double mean_of_sums(const hk_sph_pressure *p) {
  double sum = 0, count = 0;
  for (size_t k = 0; k * HK_SPH_GRAIN < p->view->n; k++) {
    sum += p->sph->sums[2 * k];
    count += p->sph->sums[2 * k + 1];
  }
  return count > 0 ? sum / count : 0;
}

static void take_over(hk_sph_pressure *p, double *v) {
  for (size_t i = 0; i < p->view->n; i++)
    for (size_t c = 0; c < 3; c++) {
      p->changed |= v[3 * i + c] != p->v[i][c];
      v[3 * i + c] = p->v[i][c];
    }
}

void hk_sph_pressure_solve(hk_sph_pressure *p, double *v, double scale, double tolerance, size_t most) {
  const hk_host *host = p->view->host;
  p->before = v;
  for (p->iterations = 0;; p->iterations++) {
    host->parallel_for(host, p->view->n, HK_SPH_GRAIN, impulse_chunk, p);
    hk_sph_bodies_answer(p->bodies, p->before, p->v);
    if (p->iterations == most) break;
    host->parallel_for(host, p->view->n, HK_SPH_GRAIN, p->pulls ? excess_chunk : relax_chunk, p);
    p->mean = mean_of_sums(p);
    if (p->pulls) host->parallel_for(host, p->view->n, HK_SPH_GRAIN, pull_chunk, p);
    p->off = scale * mean_of_sums(p) / p->sph->density; /* before the relaxation */
    if (p->off < tolerance && p->iterations >= fewest) break;
  }
  hk_sph_bodies_keep(p->bodies);
  take_over(p, v);
}
