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

double hk_sph_pressure_mean(const hk_sph_pressure *p) {
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
  p->density = p->pulls ? hk_sph_pressure_mean(p) : p->sph->density;
  return HK_OK;
}

void hk_sph_pressure_pull(hk_sph_pressure *p) {
  p->pulls = true;
  p->density = hk_sph_pressure_mean(p);
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

/* Where it pulls: what is above. */
HK_INLINE void find_excess(const hk_sph_pressure *p, const hk_periodic_box *box, size_t first, size_t end) {
  double scale = hk_sph_list_scale(p->sph);
  for (size_t i = first; i < end; i++)
    if (p->list->diagonal[i] > 0)
      p->excess[i] = excess_of(p, -scale / p->sph->point[i][3] * separation_rate(p, box, i), i);
}

/* In open space it is known to the compiler that there is no box. */
HK_VERSIONS(static void, impulses, (const hk_sph_pressure *p, size_t first, size_t end),
            p->near.box ? add_impulses(p, p->near.box, first, end) : add_impulses(p, NULL, first, end))
HK_VERSIONS(static void, relaxed, (hk_sph_pressure * p, size_t first, size_t end, double sum[2]),
            p->near.box ? relax(p, p->near.box, first, end, sum) : relax(p, NULL, first, end, sum))
HK_VERSIONS(static void, excesses, (const hk_sph_pressure *p, size_t first, size_t end),
            p->near.box ? find_excess(p, p->near.box, first, end) : find_excess(p, NULL, first, end))

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
  const hk_sph_pressure *p = context;
  (void)chunk;
  HK_WIDEST(p->view->host->lanes, excesses)(p, first, end);
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

static void find_velocities(hk_sph_pressure *p) {
  p->view->host->parallel_for(p->view->host, p->view->n, HK_SPH_GRAIN, impulse_chunk, p);
  hk_sph_bodies_answer(p->bodies, p->before, p->v);
}

static void push(hk_sph_pressure *p, double scale, double tolerance, size_t most) {
  const hk_host *host = p->view->host;
  for (;; p->iterations++) {
    find_velocities(p);
    if (p->iterations == most) break;
    host->parallel_for(host, p->view->n, HK_SPH_GRAIN, relax_chunk, p);
    p->off = scale * mean_of_sums(p) / p->sph->density; /* before the relaxation */
    if (p->off < tolerance && p->iterations >= fewest) break;
  }
}

/* ---- where it pulls ---- */

static bool is_solved(const hk_sph_pressure *p, size_t i) { return p->list->diagonal[i] > 0; }

/* Takes from y what it has of the direction of the masses. */
static void project(const hk_sph_pressure *p, double *y) {
  double sum = 0, square = 0;
  for (size_t i = 0; i < p->view->n; i++) {
    double mass = is_solved(p, i) ? p->sph->point[i][3] : 0;
    sum += mass * y[i];
    square += mass * mass;
  }
  for (size_t i = 0; i < p->view->n && square > 0; i++)
    y[i] = is_solved(p, i) ? y[i] - p->sph->point[i][3] * (sum / square) : 0;
}

/* kg^2/(m^3 s): r, by the mass what densities rise too fast with the multipliers as they are. */
static void find_residual(hk_sph_pressure *p, double *r) {
  find_velocities(p);
  p->view->host->parallel_for(p->view->host, p->view->n, HK_SPH_GRAIN, excess_chunk, p);
  for (size_t i = 0; i < p->view->n; i++) r[i] = is_solved(p, i) ? p->sph->point[i][3] * p->excess[i] : 0;
  project(p, r);
}

/* kg/(m^3 s), the mean size. */
static double mean_residual(const hk_sph_pressure *p) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < p->view->n; i++) {
    if (!is_solved(p, i)) continue;
    sum += fabs(p->residual[i]) / p->sph->point[i][3];
    count++;
  }
  return count > 0 ? sum / count : 0;
}

/* The next direction from the residual, by Jacobi's preconditioner in the plane that `project` leaves; last: the
 * residual's square before, 0: there was none. Returns it. */
static double turn_direction(hk_sph_pressure *p, double last) {
  double square = 0, *z = p->excess;
  for (size_t i = 0; i < p->view->n; i++) {
    double mass = p->sph->point[i][3];
    z[i] = is_solved(p, i) ? p->residual[i] / (diagonal_of(p, i) * mass * mass) : 0;
  }
  project(p, z);
  for (size_t i = 0; i < p->view->n; i++) square += p->residual[i] * z[i];
  for (size_t i = 0; i < p->view->n; i++) p->direction[i] = z[i] + (last > 0 ? square / last * p->direction[i] : 0);
  return square;
}

/* Goes the best way along the direction, of which a trial of its whole length tells what it changes. False: nothing is
 * changed. */
static bool go_along(hk_sph_pressure *p, double square) {
  double *a = p->a, *d = p->direction, *r = p->residual, bend = 0;
  for (size_t i = 0; i < p->view->n; i++) a[i] += d[i];
  find_residual(p, p->trial);
  for (size_t i = 0; i < p->view->n; i++) bend += d[i] * (r[i] - p->trial[i]);
  double way = bend > 0 ? square / bend : 0;
  for (size_t i = 0; i < p->view->n; i++) {
    a[i] += (way - 1) * d[i];
    r[i] += way * (p->trial[i] - r[i]);
  }
  return bend > 0;
}

/* Without the condition that pressures only push the multipliers solve linear equations with a symmetric, semidefinite
 * matrix: conjugate gradients (Hestenes and Stiefel 1952) end where Jacobi's iteration, with particles crowded and
 * thin by turns, grows without bound. */
static void pull(hk_sph_pressure *p, double scale, double tolerance, size_t most) {
  double square = 0;
  find_residual(p, p->residual);
  for (;; p->iterations++) {
    p->off = scale * mean_residual(p) / p->sph->density;
    if (p->iterations == most || (p->off < tolerance && p->iterations >= fewest)) break;
    square = turn_direction(p, square);
    if (!(square > 0) || !go_along(p, square)) break;
  }
  find_velocities(p);
}

void hk_sph_pressure_solve(hk_sph_pressure *p, double *v, double scale, double tolerance, size_t most) {
  p->before = v;
  p->iterations = 0;
  if (p->pulls)
    pull(p, scale, tolerance, most);
  else
    push(p, scale, tolerance, most);
  hk_sph_bodies_keep(p->bodies);
  take_over(p, v);
}
