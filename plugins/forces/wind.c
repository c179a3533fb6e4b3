/* Wind on the scene's triangles, or on its particles (on = "particles": linear drag, F = d (u - v), in
 * common/flow/air_drag.h). With u the air's velocity, v_T the mean velocity of the corners, r = u - v_T the
 * relative wind, n the unit normal, A the area and alpha the angle of attack (sin alpha = |r.n|/|r|), a triangle feels
 *     drag 1/2 rho A |r|^2 (drag sin^2 alpha + friction cos^2 alpha) along r,
 *     lift 1/2 rho A |r|^2 lift sin 2 alpha, perpendicular to r in the plane of r and n, and
 *     linear A (r.n) n,
 * a third on each corner. The first two are the translational forces on a plate of Andersen, Pesavento and Wang, J.
 * Fluid Mech. 541 (2005): a drag coefficient A - B cos 2 alpha (drag = A + B, friction = A - B) and a circulation that
 * makes the lift coefficient proportional to sin 2 alpha. drag = 2 lift and friction = 0 give a force along the normal
 * only. The third is the fluid force of Provot, Graphics Interface 1995, per area instead of per particle.
 *
 * In N = 2 A n and q = N.r all of this is polynomial but for 1/|N| and 1/|r|:
 *     F = rho/4 (friction |N| |r| + b q^2 / (|N| |r|)) r + (rho/2 lift |r| + linear/2) q / |N| N,
 * b = drag - friction - 2 lift. Invariants: F does not depend on the orientation of a triangle; F is continuously
 * differentiable in r everywhere, and in N except at N = 0, where F is 0 and the Jacobian, which has no limit, is set
 * to 0. */
#include "plugins/common/flow/air_drag.h"
#include "plugins/kit/parts/part_sums.h"

#include "core/plugin.h"

#include <string.h>

enum { LANES = 16, ROWS = 256 }; /* ROWS: grain of a Jacobian */

static const double TINY = 1e-150; /* m^2, m/s */

enum { TRIANGLES, PARTICLES };

typedef struct wind {
  double velocity[3], density, drag, lift, friction, linear;
  int on;
  hk_air_drag point; /* of a particle */

  const hk_host *host;
  size_t count;            /* acting triangles */
  uint32_t (*triangle)[3]; /* count */
  hk_part_sums sums;
  size_t *first;    /* n + 2: the corners at particle i are corner[first[i]] ... corner[first[i + 1] - 1] */
  uint32_t *corner; /* 3 count: 3 t + r, increasing for each particle */
} wind;

static const hk_param params[] = {
    {"velocity", "m/s", "of the air", .vector = HK_AT(wind, velocity), .initial = {5, 0, 0}, .flags = HK_TIMED},
    {"density", "kg/m^3", "of the air", .number = HK_AT(wind, density), .initial = {1.2}, .limits = HK_AT_LEAST(0)},
    {"drag", "", "drag coefficient of a triangle that faces the wind", .number = HK_AT(wind, drag), .initial = {1.2},
     .limits = HK_AT_LEAST(0)},
    {"lift", "", "lift coefficient at 45 degrees, where it is largest", .number = HK_AT(wind, lift), .initial = {0.6},
     .limits = HK_AT_LEAST(0)},
    {"friction", "", "drag coefficient of a triangle edge-on to the wind", .number = HK_AT(wind, friction),
     .limits = HK_AT_LEAST(0)},
    {"linear", "N s/m^3", "drag in proportion to the normal wind, per area", .number = HK_AT(wind, linear),
     .limits = HK_AT_LEAST(0)},
    {"on", "", "what it blows on; particles take d or rate, triangles the other numbers", .choice = HK_AT(wind, on),
     .initial = {TRIANGLES}, .choices = "triangles|particles"},
    HK_AIR_DRAG_PARAMS(wind, point),
    {0},
};

/* ---- The triangles that act, and the corners at each particle ---------------------------------------------------- */

static bool acts(const hk_view *view, const uint32_t corner[3]) {
  const bool *is = view->is_active;
  return !is || (is[corner[0]] && is[corner[1]] && is[corner[2]]);
}

static hk_tuples triangles_of(const wind *w) { return (hk_tuples){w->count, 3, w->triangle ? w->triangle[0] : NULL}; }

static void release(wind *w) {
  void *const memory[] = {w->triangle, w->first, w->corner};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) w->host->release(w->host, memory[k]);
  w->triangle = NULL, w->first = NULL, w->corner = NULL;
  w->count = 0;
}

static void fill(wind *w, const hk_view *view) {
  const hk_model *m = view->model;
  for (size_t k = 0, t = 0; k < m->triangles.count; k++)
    if (acts(view, hk_tuple(&m->triangles, k)))
      memcpy(w->triangle[t++], hk_tuple(&m->triangles, k), sizeof *w->triangle);
  for (size_t k = 0; k < 3 * w->count; k++) w->first[w->triangle[k / 3][k % 3] + 2]++;
  for (size_t i = 2; i < view->n + 2; i++) w->first[i] += w->first[i - 1];
  for (size_t k = 0; k < 3 * w->count; k++) w->corner[w->first[w->triangle[k / 3][k % 3] + 1]++] = (uint32_t)k;
}

static hk_status topology(void *self, const hk_view *view) {
  wind *w = self;
  const hk_host *host = w->host;
  size_t count = 0;
  if (w->on == PARTICLES) return HK_OK;
  release(w);
  for (size_t k = 0; k < view->model->triangles.count; k++) count += acts(view, hk_tuple(&view->model->triangles, k));
  w->triangle = host->allocate(host, (count + 1) * sizeof *w->triangle);
  w->first = host->allocate(host, (view->n + 2) * sizeof *w->first);
  w->corner = host->allocate(host, (3 * count + 1) * sizeof *w->corner);
  if (!w->triangle || !w->first || !w->corner)
    return host->fail(host, HK_NO_MEMORY, "no memory for %zu triangles", count);
  w->count = count;
  fill(w, view);
  const hk_tuples all = triangles_of(w);
  return hk_part_sums_sort(&w->sums, view, &all, NULL);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  wind *w = self;
  w->host = host;
  if (w->on == PARTICLES) return hk_air_check(&w->point, host);
  if (!isnan(w->point.d) || !isnan(w->point.rate))
    return host->fail(host, HK_BAD_PARAM, "%s is for particles: add on = \"particles\"",
                      isnan(w->point.d) ? "rate" : "d");
  hk_status status = topology(self, view);
  if (status == HK_OK && w->count == 0)
    return host->fail(
        host, HK_BAD_PARAM,
        view->model->triangles.count
            ? "no triangle has all its corners among `only` or `group`: nothing to blow on"
            : "the scene has no triangles to blow on: scene:grid and scene:mesh make some; on = \"particles\" "
              "blows on particles");
  return status;
}

/* ---- One triangle ------------------------------------------------------------------------------------------------ */

static inline double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

typedef struct flow {
  double N[3], r[3];          /* m^2, m/s */
  double area, speed;         /* |N|, |r| */
  double per_area, per_speed; /* their inverses, or 0 */
  double q;                   /* N.r */
} flow;

static inline double inverse(double length) { return length > TINY ? 1 / length : 0; }

static inline void measure(const wind *w, const hk_view *view, const uint32_t corner[3], flow *f) {
  const double *a = view->x + 3 * (size_t)corner[0], *b = view->x + 3 * (size_t)corner[1];
  const double *c = view->x + 3 * (size_t)corner[2], *va = view->v + 3 * (size_t)corner[0];
  const double *vb = view->v + 3 * (size_t)corner[1], *vc = view->v + 3 * (size_t)corner[2];
  double ab[3], ac[3];
  for (int k = 0; k < 3; k++) {
    ab[k] = b[k] - a[k];
    ac[k] = c[k] - a[k];
    f->r[k] = w->velocity[k] - (va[k] + vb[k] + vc[k]) / 3;
  }
  cross(ab, ac, f->N);
  f->area = sqrt(dot(f->N, f->N));
  f->speed = sqrt(dot(f->r, f->r));
  f->per_area = inverse(f->area);
  f->per_speed = inverse(f->speed);
  f->q = dot(f->N, f->r);
}

/* G = dF/dN and H = dF/dr. With m = N/|N|, e = r/|r|, p = m.r, s = |r|, L = rho/2 lift and c = L s + linear/2:
 *   G = rho/4 (friction s r m^T + b e (2 p r - p^2 m)^T) + c (m r^T + p (I - m m^T)),
 *   H = |N| (rho/4 (friction (s I + r e^T) + b (2 p e m^T + p^2 (I - e e^T)/s)) + L p m e^T + c m m^T). */
static void slopes(const wind *w, const flow *f, double G[9], double H[9]) {
  double rho = w->density / 4, a = rho * w->friction, b = rho * (w->drag - w->friction - 2 * w->lift);
  double L = 2 * rho * w->lift, c = L * f->speed + w->linear / 2, p = f->q * f->per_area, m[3], e[3];
  double bent = b * p * p * f->per_speed; /* factor of b p^2 de/dr */
  for (int k = 0; k < 3; k++) m[k] = f->N[k] * f->per_area, e[k] = f->r[k] * f->per_speed;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double one = i == j;
      G[3 * i + j] = a * f->speed * f->r[i] * m[j] + b * e[i] * p * (2 * f->r[j] - p * m[j]) +
                     c * (m[i] * f->r[j] + p * (one - m[i] * m[j]));
      H[3 * i + j] = f->area * (a * (f->speed * one + f->r[i] * e[j]) + 2 * b * p * e[i] * m[j] +
                                bent * (one - e[i] * e[j]) + L * p * m[i] * e[j] + c * m[i] * m[j]);
    }
}

/* ---- Many triangles ---------------------------------------------------------------------------------------------- */

/* LANES triangles at a time, so that square roots and divisions use vectors. */
typedef struct batch {
  double ab[3][LANES], ac[3][LANES], v[3][LANES]; /* v: three times v_T */
  double load[3][LANES], power[LANES];
} batch;

static inline void gather(const wind *w, const hk_view *view, const uint32_t *item, size_t count, batch *q) {
  for (size_t t = 0; t < count; t++) {
    const uint32_t *corner = w->triangle[item[t]];
    size_t a = 3 * (size_t)corner[0], b = 3 * (size_t)corner[1], c = 3 * (size_t)corner[2];
    for (size_t k = 0; k < 3; k++) {
      q->ab[k][t] = view->x[b + k] - view->x[a + k];
      q->ac[k][t] = view->x[c + k] - view->x[a + k];
      q->v[k][t] = view->v[a + k] + view->v[b + k] + view->v[c + k];
    }
  }
}

/* Computes a third of each triangle's F, and its power. */
static void batch_loads(const wind *w, batch *q) {
  double rho = w->density / 4, b = rho * (w->drag - w->friction - 2 * w->lift), friction = rho * w->friction;
  double lift = 2 * rho * w->lift, linear = w->linear / 2;
  double wx = w->velocity[0], wy = w->velocity[1], wz = w->velocity[2];
  for (int t = 0; t < LANES; t++) {
    double nx = q->ab[1][t] * q->ac[2][t] - q->ab[2][t] * q->ac[1][t];
    double ny = q->ab[2][t] * q->ac[0][t] - q->ab[0][t] * q->ac[2][t];
    double nz = q->ab[0][t] * q->ac[1][t] - q->ab[1][t] * q->ac[0][t];
    double vx = q->v[0][t] / 3, vy = q->v[1][t] / 3, vz = q->v[2][t] / 3;
    double rx = wx - vx, ry = wy - vy, rz = wz - vz, flux = nx * rx + ny * ry + nz * rz;
    double area = sqrt(nx * nx + ny * ny + nz * nz), speed = sqrt(rx * rx + ry * ry + rz * rz);
    double p = flux * (1 / (area > TINY ? area : INFINITY));
    double along = (friction * area * speed + b * p * flux * (1 / (speed > TINY ? speed : INFINITY))) / 3;
    double across = (lift * speed + linear) * p / 3;
    q->load[0][t] = along * rx + across * nx;
    q->load[1][t] = along * ry + across * ny;
    q->load[2][t] = along * rz + across * nz;
    q->power[t] = 3 * (q->load[0][t] * vx + q->load[1][t] * vy + q->load[2][t] * vz);
  }
}

static double push(const void *self, const hk_view *view, const uint32_t *item, size_t number, double *F) {
  const wind *w = self;
  double power = 0;
  batch q = {0};
  for (size_t k = 0; k < number; k += LANES) {
    size_t count = number - k < LANES ? number - k : LANES;
    gather(w, view, item + k, count, &q);
    batch_loads(w, &q);
    for (size_t t = 0; t < count; t++) {
      for (size_t m = 0; m < 9; m++) F[3 * (size_t)w->triangle[item[k + t]][m / 3] + m % 3] += q.load[m % 3][t];
      power += q.power[t];
    }
  }
  return power;
}

/* ---- On particles --------------------------------------------------------------------------------------------------
 */

static void uniform(const void *self, double t, const double *x, size_t count, double *u) {
  const wind *w = self;
  (void)t, (void)x;
  for (size_t e = 0; e < 3 * count; e++) u[e] = w->velocity[e % 3];
}

static hk_air air_of(const wind *w) { return (hk_air){&w->point, w, uniform, NULL}; }

/* ---- The force -----------------------------------------------------------------------------------------------------
 */

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  const wind *w = self;
  hk_air air = air_of(w);
  if (w->on == PARTICLES)
    hk_air_add(&air, view, part, F);
  else
    hk_part_sums_add(&w->sums, view, part, push, w, F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  add_part(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

/* On particles there are no elements, and each has its own block. */
static void parts(void *self, const hk_view *view, const hk_part_use *use) {
  const wind *w = self;
  const hk_tuples all = triangles_of(w);
  (void)view;
  hk_part_lists_touch(&w->sums.lists, &all, use);
}

static void flow_at(const void *self, const hk_view *view, const double *x, size_t count, double *u) {
  uniform(self, view->t, x, count, u);
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  const wind *w = self;
  if (w->on == PARTICLES) hk_air_pattern(view, p);
  for (size_t t = 0; t < w->count; t++)
    for (int b = 0; b < 9; b++) p->block(p, w->triangle[t][b / 3], w->triangle[t][b % 3]);
}

/* A displacement dx of corner c changes N by dx x side_c, side_c = x_(c+1) - x_(c+2), so a row g of G gives the row
 * side_c x g of dF/dx_c. */
static void add_row(const wind *w, const hk_view *view, const hk_blocks *into, uint32_t corner) {
  const uint32_t *at = w->triangle[corner / 3];
  const size_t *slot = into->slot + 3 * (size_t)corner;
  flow f;
  double G[9], H[9], side[3], row[3];
  measure(w, view, at, &f);
  slopes(w, &f, G, H);
  for (int c = 0; c < 3; c++) {
    const double *next = view->x + 3 * (size_t)at[(c + 1) % 3], *last = view->x + 3 * (size_t)at[(c + 2) % 3];
    double *K = into->K + 9 * slot[c], *D = into->D + 9 * slot[c];
    for (int k = 0; k < 3; k++) side[k] = next[k] - last[k];
    for (int r = 0; r < 3; r++) {
      cross(side, G + 3 * r, row);
      for (int k = 0; k < 3; k++) K[3 * r + k] -= row[k] / 3, D[3 * r + k] += H[3 * r + k] / 9;
    }
  }
}

typedef struct task {
  const wind *self;
  const hk_view *view;
  const hk_blocks *into;
} task;

/* Computes block rows, one per particle: a triangle is evaluated three times, which costs less than storing G and H. */
static void row_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  const task *t = context;
  for (size_t k = t->self->first[begin]; k < t->self->first[end]; k++)
    add_row(t->self, t->view, t->into, t->self->corner[k]);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const hk_air air = air_of(self);
  task t = {self, view, into};
  if (((const wind *)self)->on == PARTICLES) return hk_air_jacobian(&air, view, into);
  view->host->parallel_for(view->host, view->n, ROWS, row_chunk, &t);
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_POWER | HK_PERIODIC,
    .add = add,
    .add_part = add_part,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian), HK_PARTS_FACET(.touch = parts),
                        HK_PICTURES_FACET(.flow = flow_at)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "wind",
    .summary =
        "drag and lift of moving air on triangles, 1/2 rho A |u - v|^2 (drag sin^2 a + friction cos^2 a, lift sin 2a), "
        "or drag on particles, F = d (u - v); u: velocity of the air",
    .reference = "Andersen, Pesavento and Wang, J. Fluid Mech. 541 (2005), translational forces; linear: Provot 1995",
    .instance_size = sizeof(wind),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
