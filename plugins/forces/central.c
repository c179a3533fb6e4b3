/* A pull towards (or push away from) a point or a line: an attractor or repulser with any power of the distance,
 * softened, and with a range if wanted.
 *
 * With r the vector from the centre (or from the nearest point of the line), s = sqrt(r^2 + softening^2):
 *     F = -strength w s^(power - 1) W r,     w = m (per = "mass") or 1 (per = "particle")
 *     energy = strength w s^(power + 1) / (power + 1), or strength w ln s for power = -1
 * power 1 is a harmonic pull, -2 Kepler's with strength GM (softening as Plummer's). Without a range W = 1; with one,
 * W = (1 - s^2/e^2)^2 inside and 0 outside, e = sqrt(range^2 + softening^2), so that F ends with its slope; the energy
 * is then the integral of s^power W from s to e, and 0 outside. Where s is below 1e-100 m the force is zero: this is
 * the limit for powers above 0 and a convention for the others, since Kepler's force would exceed the range of doubles.
 */
#include "plugins/kit/parts/particle_sums.h"
#include "plugins/common/space/near_moves.h"

#include "core/plugin.h"
#include "core/plugin/widest.h"

typedef struct central {
  double center[3], axis[3], strength, power, softening, range;
  int per;

  double end2; /* m^2, e^2; INFINITY: no range */
} central;

static const hk_param params[] = {
    {"center", "m", "the point, or a point of the line", .vector = HK_AT(central, center), .flags = HK_TIMED},
    {"axis", "", "direction of the line; left out: a point", .vector = HK_AT(central, axis)},
    {"strength", "m^(1-p)/s^2", "acceleration at distance 1 (per mass) or force (per particle); positive attracts",
     .number = HK_AT(central, strength), .flags = HK_TIMED | HK_REQUIRED},
    {"power", "", "power p of the distance", .number = HK_AT(central, power), .initial = {1},
     .limits = HK_WITHIN(-20, 20)},
    {"softening", "m", "added to the distance in quadrature", .number = HK_AT(central, softening),
     .limits = HK_AT_LEAST(0)},
    {"range", "m", "distance at which the force has ended, smoothly; left out: it does not end",
     .number = HK_AT(central, range), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"per", "", "whether strength is per mass or per particle", .choice = HK_AT(central, per),
     .choices = "mass|particle"},
    {0},
};

static const double tiny = 1e-200; /* m^2 */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  (void)host, (void)view;
  central *p = self;
  double *a = p->axis, length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  p->end2 = isnan(p->range) ? INFINITY : p->range * p->range + p->softening * p->softening;
  for (int c = 0; c < 3 && length > 0; c++) a[c] /= length;
  return HK_OK;
}

/* The vector r and s^2 of one particle. */
static double offset(const central *p, const double *x, double r[3]) {
  hk_from_line(p->center, p->axis, x, r);
  return r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + p->softening * p->softening;
}

static double weight(const central *p, const hk_view *view, size_t i) {
  return p->strength * (p->per == 0 ? view->model->mass[i] : 1);
}

/* s^(power - 1) from s^2; the common powers without pow. */
static double power_of(const central *p, double s2) {
  if (p->power == 1) return 1;
  if (s2 < tiny) return 0;
  if (p->power == -2) return 1 / (s2 * sqrt(s2));
  return pow(s2, (p->power - 1) / 2);
}

/* 1 - s^2/e^2, at least 0: W is its square. Without a range it is 1 also where s^2 overflows: what diverges must not
 * become free. */
static double inside(const central *p, double s2) { return p->end2 < INFINITY ? fmax(0, 1 - s2 / p->end2) : 1; }

/* s^(power - 1) W. */
static double scale(const central *p, double s2) {
  double in = inside(p, s2);
  return in > 0 ? power_of(p, s2) * in * in : 0;
}

static double pull(const void *self, const hk_view *view, size_t begin, size_t end, double *F) {
  for (size_t k = begin; k < end; k++) {
    size_t i = hk_acting_particle(view, k);
    double r[3], s2 = offset(self, view->x + 3 * i, r), f = weight(self, view, i) * scale(self, s2);
    for (size_t c = 0; c < 3; c++) F[3 * i + c] -= f * r[c];
  }
  return 0; /* of the conservative force no power is counted */
}

static hk_status add(void *self, const hk_view *view, double *F) {
  hk_particle_sums_add(view, HK_ALL_PARTS, pull, self, F);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_particle_sums_add(view, part, pull, self, F);
}

/* The integral of s^q. */
static double integral(double s2, double q) { return q == -1 ? log(s2) / 2 : pow(s2, (q + 1) / 2) / (q + 1); }

/* The integral of s^power W. */
static double level(const central *p, double s2) {
  double sum = integral(s2, p->power);
  if (p->end2 < INFINITY)
    sum += integral(s2, p->power + 4) / (p->end2 * p->end2) - 2 * integral(s2, p->power + 2) / p->end2;
  return sum;
}

static double energy(void *self, const hk_view *view) {
  const central *p = self;
  double sum = 0, end = p->end2 < INFINITY ? level(p, p->end2) : 0;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    double r[3], s2 = offset(p, view->x + 3 * i, r);
    if (s2 < tiny && p->power <= -1) continue; /* no force acts there, so there is no energy either */
    if (s2 < p->end2) sum += weight(p, view, i) * (level(p, s2) - end);
  }
  return sum;
}

static void pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  (void)self;
  for (size_t k = 0; k < view->acting; k++) {
    uint32_t i = view->active ? view->active[k] : (uint32_t)k;
    pattern->block(pattern, i, i);
  }
}

/* -dF/dx of one particle, w (g (I - a a^T) + dg/ds r r^T/s), g = s^(p-1) W, at row a and column b: dg/ds = s^(p-2)
 * ((p-1) W - 4 (1 - W^(1/2)) W^(1/2)). */
typedef struct slope {
  const central *self;
  double along, second, unit[3];
} slope;

static slope slope_of(const central *p, const hk_view *view, size_t i) {
  double r[3], s2 = offset(p, view->x + 3 * i, r), root = s2 < tiny ? 1 : sqrt(s2);
  double all = weight(p, view, i) * power_of(p, s2), in = inside(p, s2), along = in > 0 ? all * in * in : 0;
  double second = in > 0 && s2 >= tiny ? (p->power - 1) * along - 4 * all * in * (1 - in) : 0;
  return (slope){p, along, second, {r[0] / root, r[1] / root, r[2] / root}};
}

static double entry(const slope *s, int a, int b) {
  return s->along * ((a == b) - s->self->axis[a] * s->self->axis[b]) + s->second * s->unit[a] * s->unit[b];
}

/* Each particle has its own pull, so the bound is its matrix. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  for (size_t k = 0; part != HK_DAMPING_WHOLE && k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k, at = 0;
    slope s = slope_of(self, view, i);
    for (int a = 0; a < 3; a++)
      for (int b = a; b < 3; b++) block[i][at++] += entry(&s, a, b);
  }
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const central *p = self;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    double *K = into->K + 9 * into->slot[k];
    slope s = slope_of(p, view, i);
    for (int q = 0; q < 9; q++) K[q] += entry(&s, q / 3, q % 3);
  }
  return HK_OK;
}

/* ---- transposed ---- */

enum { CENTER, AXIS, STRENGTH, POWER, SOFTENING, RANGE }; /* rows of the table */

/* Particles side by side, for a loop that compilers turn into vectors. With g = s^(power - 1) q^2, q = 1 - s^2/e^2 and
 * h = u.r, u.F = -w g h has the derivative by r of -w (g u + s dg/ds (h/s) r/s), s dg/ds = (power - 1) g - 4 s^(power -
 * 1) q (1 - q). */
enum { BLOCK = 64 };
typedef struct block {
  double d[3][BLOCK], w[3][BLOCK]; /* x - center; u */
  double each[BLOCK];              /* m, or 1 */
  double s2[BLOCK], power[BLOCK];  /* s^(power - 1) */
  double by_r[3][BLOCK], aw[BLOCK], to[3][BLOCK], ad[BLOCK];
  double gh[BLOCK];                  /* g h */
  double by_s[BLOCK], by_end[BLOCK]; /* w h times dg/ds over s, and times dg/de over e */
} block;

HK_INLINE void squares(const central *p, block *q) {
  for (int k = 0; k < BLOCK; k++) {
    const double *a = p->axis, x = q->d[0][k], y = q->d[1][k], z = q->d[2][k], ad = a[0] * x + a[1] * y + a[2] * z;
    double r[3] = {x - ad * a[0], y - ad * a[1], z - ad * a[2]};
    q->ad[k] = ad;
    q->s2[k] = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + p->softening * p->softening;
    if (p->power == 1) q->power[k] = 1;
    if (p->power == -2) q->power[k] = q->s2[k] < tiny ? 0 : 1 / (q->s2[k] * sqrt(q->s2[k]));
  }
}

HK_INLINE void turn_each(const central *p, block *q) {
  const double *a = p->axis, by_e2 = 1 / p->end2; /* 0: no range */
  for (int k = 0; k < BLOCK; k++) {
    double s2 = q->s2[k], some = s2 < tiny ? 0 : 1, by_root = 1 / sqrt(s2 < tiny ? 1 : s2), r[3], w[3], by_r[3];
    double out = by_e2 > 0 ? s2 * by_e2 : 0, in = out < 1 ? 1 - out : 0, power = out < 1 ? q->power[k] : 0;
    double g = power * in * in, end = 4 * power * in * (1 - in), fall = some * ((p->power - 1) * g - end);
    double all = p->strength * q->each[k];
    for (int c = 0; c < 3; c++) r[c] = q->d[c][k] - q->ad[k] * a[c], w[c] = q->w[c][k];
    double h = w[0] * r[0] + w[1] * r[1] + w[2] * r[2], part = all * fall * (h * by_root);
    for (int c = 0; c < 3; c++) by_r[c] = -(all * g * w[c] + part * (r[c] * by_root));
    double aw = a[0] * by_r[0] + a[1] * by_r[1] + a[2] * by_r[2];
    for (int c = 0; c < 3; c++) q->by_r[c][k] = by_r[c], q->to[c][k] = by_r[c] - aw * a[c];
    q->aw[k] = aw, q->gh[k] = g * h;
    q->by_s[k] = part * by_root, q->by_end[k] = all * end * h * by_e2;
  }
}

HK_VERSIONS(static void, squares_of, (const central *p, block *q), squares(p, q))
HK_VERSIONS(static void, turn_many, (const central *p, block *q), turn_each(p, q))

/* Lanes beyond get the first one's. */
static void take(const central *p, const hk_view *view, const double *u, size_t first, size_t count, block *q) {
  for (size_t k = 0; k < BLOCK; k++) {
    size_t i = hk_acting_particle(view, first + (k < count ? k : 0));
    for (size_t c = 0; c < 3; c++) q->d[c][k] = view->x[3 * i + c] - p->center[c], q->w[c][k] = u[3 * i + c];
    q->each[k] = p->per == 0 ? view->model->mass[i] : 1;
  }
}

/* By strength, power, softening and range, e^2 = range^2 + softening^2, and by center and axis: r = d - (d.a) a. */
static void add_slopes(const central *p, const hk_view *view, const block *q, size_t first, size_t count,
                       const hk_transposed *into) {
  double *const *row = into->parameter;
  bool ranged = p->end2 < INFINITY;
  for (size_t k = 0; k < count; k++) {
    if (p->per == 0) into->mass[hk_acting_particle(view, first + k)] -= p->strength * q->gh[k];
    row[STRENGTH][0] -= q->each[k] * q->gh[k];
    if (q->s2[k] >= tiny && q->gh[k] != 0) row[POWER][0] -= p->strength * q->each[k] * q->gh[k] * log(q->s2[k]) / 2;
    row[SOFTENING][0] -= (q->by_s[k] + q->by_end[k]) * p->softening;
    if (ranged) row[RANGE][0] -= q->by_end[k] * p->range;
    for (int c = 0; c < 3; c++) {
      row[CENTER][c] -= q->to[c][k];
      row[AXIS][c] -= q->ad[k] * q->by_r[c][k] + q->aw[k] * q->d[c][k];
    }
  }
}

/* s^2 and s^(power - 1). */
static void measure(const central *p, const hk_view *view, size_t count, block *q) {
  HK_WIDEST(view->host->lanes, squares_of)(p, q);
  for (size_t k = 0; k < count && p->power != 1 && p->power != -2; k++) q->power[k] = power_of(p, q->s2[k]);
  for (size_t k = count; k < BLOCK; k++) q->power[k] = 0;
}

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const central *p = self;
  block q;
  for (size_t first = 0; first < view->acting; first += BLOCK) {
    size_t count = view->acting - first < BLOCK ? view->acting - first : BLOCK;
    take(p, view, u, first, count, &q);
    measure(p, view, count, &q);
    HK_WIDEST(view->host->lanes, turn_many)(p, &q);
    for (size_t k = 0; k < count; k++) {
      double *to = into->x + 3 * hk_acting_particle(view, first + k);
      for (int c = 0; c < 3; c++) to[c] += q.to[c][k];
    }
    if (into->parameter) add_slopes(p, view, &q, first, count, into);
  }
  return HK_OK;
}

/* ---- along directions ---- */

/* How the parameters change; F = -all g r, r = d - (d.a) a. */
typedef struct changes {
  double center[3], axis[3], strength, power, s_ds, e_de; /* the last: of s^2/2 and e^2/2, by softening and range */
} changes;

static changes changes_of(const central *p, const double *const *row) {
  changes to = {0};
  for (int c = 0; c < 3 && row && row[CENTER]; c++) to.center[c] = row[CENTER][c];
  for (int c = 0; c < 3 && row && row[AXIS]; c++) to.axis[c] = row[AXIS][c];
  if (row && row[STRENGTH]) to.strength = row[STRENGTH][0];
  if (row && row[POWER]) to.power = row[POWER][0];
  if (row && row[SOFTENING]) to.s_ds = to.e_de = p->softening * row[SOFTENING][0];
  if (row && row[RANGE] && p->end2 < INFINITY) to.e_de += p->range * row[RANGE][0];
  return to;
}

/* q->w is the change of d, by_s that of the strength times what each has, and by_end ln s where the power changes. */
HK_INLINE void change_each(const central *p, const changes *by, block *q) {
  const double *a = p->axis, by_e2 = 1 / p->end2; /* 0: no range */
  for (int k = 0; k < BLOCK; k++) {
    double s2 = q->s2[k], some = s2 < tiny ? 0 : 1, by_root = 1 / sqrt(s2 < tiny ? 1 : s2), r[3], w[3], dr[3];
    double out = by_e2 > 0 ? s2 * by_e2 : 0, in = out < 1 ? 1 - out : 0, power = out < 1 ? q->power[k] : 0;
    double g = power * in * in, end = 4 * power * in * (1 - in), fall = some * ((p->power - 1) * g - end);
    for (int c = 0; c < 3; c++) r[c] = q->d[c][k] - q->ad[k] * a[c], w[c] = q->w[c][k];
    double aw = w[0] * a[0] + w[1] * a[1] + w[2] * a[2], turn = 0;
    for (int c = 0; c < 3; c++) turn += q->d[c][k] * by->axis[c];
    for (int c = 0; c < 3; c++) dr[c] = w[c] - (aw + turn) * a[c] - q->ad[k] * by->axis[c];
    double along = (r[0] * dr[0] + r[1] * dr[1] + r[2] * dr[2] + by->s_ds) * by_root, all = p->strength * q->each[k];
    double part = all * fall * along, rest = end * by->e_de * by_e2 + g * q->by_end[k] * by->power;
    double grow = q->by_s[k] * g + all * rest;
    for (int c = 0; c < 3; c++) q->to[c][k] = -(part * (r[c] * by_root) + grow * r[c] + all * g * dr[c]);
  }
}

HK_VERSIONS(static void, change_many, (const central *p, const changes *by, block *q), change_each(p, by, q))

static void take_change(const central *p, const hk_view *view, const hk_tangent *t, const changes *by, size_t first,
                        size_t count, block *q) {
  for (size_t k = 0; k < BLOCK; k++) {
    size_t i = hk_acting_particle(view, first + (k < count ? k : 0));
    for (size_t c = 0; c < 3; c++) q->w[c][k] = t->x[3 * i + c] - by->center[c];
    q->by_s[k] = by->strength * q->each[k] + (p->per == 0 && t->mass ? p->strength * t->mass[i] : 0);
    q->by_end[k] = by->power != 0 && q->s2[k] >= tiny ? log(q->s2[k]) / 2 : 0;
  }
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count_directions) {
  const central *p = self;
  block q;
  for (size_t first = 0; first < view->acting; first += BLOCK) {
    size_t count = view->acting - first < BLOCK ? view->acting - first : BLOCK;
    take(p, view, view->x, first, count, &q);
    measure(p, view, count, &q);
    for (const hk_tangent *t = directions; t < directions + count_directions; t++) {
      const changes by = changes_of(p, t->parameter);
      take_change(p, view, t, &by, first, count, &q);
      HK_WIDEST(view->host->lanes, change_many)(p, &by, &q);
      for (size_t k = 0; k < count; k++)
        for (size_t c = 0; c < 3; c++) t->force[3 * hk_acting_particle(view, first + k) + c] += q.to[c][k];
    }
  }
  return HK_OK;
}

/* The force on one particle as a function of r alone. */
typedef struct law {
  const central *self;
  double weight;
} law;

static void law_at(const void *self, const double r[3], double F[3]) {
  const law *l = self;
  const double soft = l->self->softening,
               f = l->weight * scale(l->self, r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + soft * soft);
  for (int c = 0; c < 3; c++) F[c] = -f * r[c];
}

typedef struct collection {
  const central *self;
  const hk_view *to;
  hk_encounters *into;
} collection;

/* Its range is s/(1 - power), with the fall of r/s, and of the end a quarter: half of W's fall. */
static void add_encounter(void *context, uint32_t i, const double r[3], const double dr[3]) {
  const collection *c = context;
  const central *p = c->self;
  double s2 = hk_nearest_square(r, dr) + p->softening * p->softening;
  hk_encounter way = {.i = i, .other = i, .r = {r[0], r[1], r[2]}, .dr = {dr[0], dr[1], dr[2]}};
  law l = {p, weight(p, c->to, i)};
  if (!(s2 < p->end2)) return;
  way.range = fmin(p->power < 0 ? sqrt(s2) / (1 - p->power) : INFINITY, sqrt(p->end2) / 4);
  c->into->add(c->into, &way, law_at, &l);
}

/* Only a force that falls with the distance, or ends, is stronger on the way than at its ends. At a distance R after a
 * move of length l the particle was never nearer than R - l, so that R >= l (1 + (1 - power)/4) leaves 4 ranges; R >= 2
 * l leaves the end behind, or l is within 4 quarters of it. */
static bool encounters(const void *self, const hk_view *to, const double *x_from, hk_encounters *into) {
  const central *p = self;
  double ways = fmax(p->power < 0 ? 1 + (1 - p->power) / 4 : 0, p->end2 < INFINITY ? 2 : 0);
  if (ways == 0) return false;
  collection c = {p, to, into};
  hk_near_moves moves = {p->center, p->axis, ways, to, x_from};
  hk_near_moves_visit(&moves, add_encounter, &c);
  return true;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_SYMMETRIC_JACOBIAN,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets =
        HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian, .transposed = transposed, .along = along),
                  HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_ENCOUNTERS_FACET(.find = encounters)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "central",
    .summary = "attractor or repulser: pull to a point or a line, F = -strength w s^(power-1) r, s^2 = r^2 + "
               "softening^2, with a range",
    .reference = "softening: Plummer 1911; power -2: Kepler",
    .instance_size = sizeof(central),
    .params = params,
    .create = create,
    .force = &force,
};
