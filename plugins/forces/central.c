/* A pull towards (or push away from) a point or a line, with any power of the distance, softened.
 *
 * With r the vector from the centre (or from the nearest point of the line), s = sqrt(r^2 + softening^2):
 *     F = -strength w s^(power - 1) r,     w = m (per = "mass") or 1 (per = "particle")
 *     energy = strength w s^(power + 1) / (power + 1), or strength w ln s for power = -1
 * power 1 is a harmonic pull, -2 Kepler's with strength GM (softening as Plummer's). Where s is below 1e-100 m the
 * force is zero: this is the limit for powers above 0 and a convention for the others, since Kepler's force would
 * exceed the range of doubles. */
#include "core/plugin.h"

typedef struct central {
  double center[3], axis[3], strength, power, softening;
  int per;
} central;

static const hk_param params[] = {
    {"center",
     "m",
     "the point, or a point of the line",
     HK_VECTOR,
     {0, 0, 0},
     0,
     0,
     offsetof(central, center),
     HK_TIMED,
     NULL},
    {"axis",
     "",
     "direction of the line; left out: a point",
     HK_VECTOR,
     {0, 0, 0},
     0,
     0,
     offsetof(central, axis),
     0,
     NULL},
    {"strength",
     "m^(1-p)/s^2",
     "acceleration at distance 1 (per mass) or force (per particle); positive attracts",
     HK_NUMBER,
     {0},
     0,
     0,
     offsetof(central, strength),
     HK_TIMED | HK_REQUIRED,
     NULL},
    {"power", "", "power p of the distance", HK_NUMBER, {1}, -20, 20, offsetof(central, power), 0, NULL},
    {"softening",
     "m",
     "added to the distance in quadrature",
     HK_NUMBER,
     {0},
     0,
     INFINITY,
     offsetof(central, softening),
     0,
     NULL},
    {"per",
     "",
     "whether strength is per mass or per particle",
     HK_CHOICE,
     {0},
     0,
     0,
     offsetof(central, per),
     0,
     "mass|particle"},
    {0},
};

static const double tiny = 1e-200; /* m^2 */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  (void)host, (void)view;
  double *a = ((central *)self)->axis, length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  for (int c = 0; c < 3 && length > 0; c++) a[c] /= length;
  return HK_OK;
}

/* The vector r and s^2 of one particle. */
static double offset(const central *p, const double *x, double r[3]) {
  double along = 0;
  for (int c = 0; c < 3; c++) r[c] = x[c] - p->center[c];
  for (int c = 0; c < 3; c++) along += p->axis[c] * r[c];
  for (int c = 0; c < 3; c++) r[c] -= along * p->axis[c];
  return r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + p->softening * p->softening;
}

static double weight(const central *p, const hk_view *view, size_t i) {
  return p->strength * (p->per == 0 ? view->model->mass[i] : 1);
}

/* s^(power - 1) from s^2; the common powers without pow. */
static double scale(const central *p, double s2) {
  if (p->power == 1) return 1;
  if (s2 < tiny) return 0;
  if (p->power == -2) return 1 / (s2 * sqrt(s2));
  return pow(s2, (p->power - 1) / 2);
}

typedef struct task {
  const central *self;
  const hk_view *view;
  double *F;
} task;

static void add_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  const task *t = context;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->view->active ? t->view->active[k] : k;
    double r[3], s2 = offset(t->self, t->view->x + 3 * i, r), f = weight(t->self, t->view, i) * scale(t->self, s2);
    for (int c = 0; c < 3; c++) t->F[3 * i + c] -= f * r[c];
  }
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t = {self, view, F};
  view->host->parallel_for(view->host, view->acting, 1024, add_chunk, &t);
  return HK_OK;
}

static double energy(void *self, const hk_view *view) {
  const central *p = self;
  double sum = 0;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = view->active ? view->active[k] : k;
    double r[3], s2 = offset(p, view->x + 3 * i, r);
    if (s2 < tiny && p->power <= -1) continue; /* no force acts there, so there is no energy either */
    sum += weight(p, view, i) * (p->power == -1 ? log(s2) / 2 : pow(s2, (p->power + 1) / 2) / (p->power + 1));
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

/* -dF/dx of one particle, w (s^(p-1) (I - a a^T) + (p-1) s^(p-3) r r^T), at row a and column b. */
typedef struct slope {
  const central *self;
  double along, second, unit[3];
} slope;

static slope slope_of(const central *p, const hk_view *view, size_t i) {
  double r[3], s2 = offset(p, view->x + 3 * i, r), root = s2 < tiny ? 1 : sqrt(s2);
  double along = weight(p, view, i) * scale(p, s2);
  return (slope){p, along, s2 < tiny ? 0 : (p->power - 1) * along, {r[0] / root, r[1] / root, r[2] / root}};
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

/* Only a force that falls with the distance is stronger on the way than at its ends; its range is s/(1 - power), with
 * the fall of r/s. */
static void add_passage(const central *p, const hk_view *to, const double *x_from, size_t i, hk_passages *into) {
  hk_passage way = {.i = (uint32_t)i, .other = (uint32_t)i};
  double end[3];
  offset(p, x_from + 3 * i, way.r);
  offset(p, to->x + 3 * i, end);
  for (int c = 0; c < 3; c++) way.dr[c] = end[c] - way.r[c];
  double nearest = hk_nearest_square(way.r, way.dr);
  if (!(nearest < INFINITY)) return;
  law l = {p, weight(p, to, i)};
  way.range = sqrt(nearest + p->softening * p->softening) / (1 - p->power);
  into->add(into, &way, law_at, &l);
}

enum { SIEVES = 64 }; /* parts that are looked through by several threads */

typedef struct sieve {
  const central *self;
  const hk_view *to;
  const double *x_from;
  double ways2; /* a particle this many of its moves away (squared) has no passage */
  bool near[SIEVES];
} sieve;

/* Whether a particle of the part may have a passage. */
static void sift(void *context, size_t begin, size_t end, size_t part) {
  sieve *s = context;
  const double *axis = s->self->axis, *center = s->self->center;
  bool near = false, line = axis[0] != 0 || axis[1] != 0 || axis[2] != 0;
  for (size_t k = begin; k < end; k++) {
    size_t i = s->to->active ? s->to->active[k] : k;
    const double *x = s->to->x + 3 * i, *from = s->x_from + 3 * i;
    double dx = x[0] - from[0], dy = x[1] - from[1], dz = x[2] - from[2];
    double rx = x[0] - center[0], ry = x[1] - center[1], rz = x[2] - center[2];
    double along = line ? axis[0] * rx + axis[1] * ry + axis[2] * rz : 0;
    near |= s->ways2 * (dx * dx + dy * dy + dz * dz) > rx * rx + ry * ry + rz * rz - along * along;
  }
  s->near[part] = near;
}

/* At a distance R after a move of length l it was never nearer than R - l, so that R >= l (1 + (1 - power)/4) leaves 4
 * ranges. */
static bool passages(const void *self, const hk_view *to, const double *x_from, hk_passages *into) {
  const central *p = self;
  if (p->power >= 0) return false;
  sieve s = {.self = p, .to = to, .x_from = x_from, .ways2 = pow(1 + (1 - p->power) / 4, 2)};
  size_t grain = to->acting / SIEVES < 1024 ? 1024 : to->acting / SIEVES + 1;
  to->host->parallel_for(to->host, to->acting, grain, sift, &s);
  for (size_t part = 0; part * grain < to->acting; part++)
    for (size_t k = part * grain; s.near[part] && k < to->acting && k < (part + 1) * grain; k++)
      add_passage(p, to, x_from, to->active ? to->active[k] : k, into);
  return true;
}

static const hk_force force = {.size = sizeof(hk_force),
                               .flags = HK_DEPENDS_ON_X | HK_SYMMETRIC_JACOBIAN,
                               .add = add,
                               .energy = energy,
                               .pattern = pattern,
                               .jacobian = jacobian,
                               .stiffness_bound = stiffness_bound,
                               .passages = passages};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "central",
    .summary = "pull to a point or a line, F = -strength w s^(power-1) r, s^2 = r^2 + softening^2",
    .reference = "softening: Plummer 1911; power -2: Kepler",
    .instance_size = sizeof(central),
    .params = params,
    .create = create,
    .force = &force,
};
