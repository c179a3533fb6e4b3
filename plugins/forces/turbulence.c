/* Turbulent air, which drags particles along: F = d (u - v) with a sum of random waves,
 *     u(x, t) = sum_m e_m cos(2 pi (k_m.(x - drift t) + n_m t + p_m)),  e_m across k_m,
 * which is free of divergence wave by wave. The wave numbers 1/largest ... 1/smallest are spread evenly over the
 * logarithm, with the energies k^(-2/3) of Kolmogorov's spectrum k^(-5/3) and random directions. A wave changes as fast
 * as eddies of its size turn over, n ~ evolution speed/largest (k largest)^(2/3). The mean square of u over all of
 * space is speed^2.
 *
 * All waves follow from the seed when the plugin is created, so u is a fixed function of x and t, band-limited in both:
 * nothing changes within less than half the smallest length, and no step lets a particle move further than a quarter of
 * it through the air. */
#include "plugins/common/flow/air_drag.h"

#include "core/plugin.h"

enum { MOST_WAVES = 256 };

typedef struct wave {
  double k[3], e[3]; /* 1/m, m/s */
  double n, p;       /* 1/s, of drift and evolution together; turns */
} wave;

typedef struct turbulence {
  double speed, largest, smallest, evolution, drift[3];
  int64_t waves, seed;
  hk_air_drag drag;
  int lanes;
  wave wave[MOST_WAVES];
} turbulence;

static const hk_param params[] = {
    {"speed", "m/s", "RMS of the air's velocity", .number = HK_AT(turbulence, speed), .initial = {1},
     .limits = HK_AT_LEAST(0)},
    {"largest", "m", "longest wavelength", .number = HK_AT(turbulence, largest), .initial = {1}, .limits = HK_ABOVE(0)},
    {"smallest", "m", "shortest wavelength", .number = HK_AT(turbulence, smallest), .initial = {0.1},
     .limits = HK_ABOVE(0)},
    {"evolution", "", "how fast eddies change, in turnovers of their own; 0: frozen",
     .number = HK_AT(turbulence, evolution), .initial = {1}, .limits = HK_AT_LEAST(0)},
    {"drift", "m/s", "velocity with which the wind carries the pattern", .vector = HK_AT(turbulence, drift)},
    {"waves", "", "number of waves; the cost is proportional to it", .integer = HK_AT(turbulence, waves),
     .initial = {48}, .limits = HK_WITHIN(1, MOST_WAVES)},
    {"seed", "", "another number, another turbulence", .integer = HK_AT(turbulence, seed), .initial = {1}},
    HK_AIR_DRAG_PARAMS(turbulence, drag),
    {0},
};

/* ---- the waves ---- */

/* splitmix64 (Steele, Lea and Flood 2014), in [0, 1): a stream that depends on the seed alone. */
static double uniform(uint64_t *state) {
  uint64_t z = *state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static const double two_pi = 6.283185307179586;

/* A unit vector of any direction, and one across it. */
static void directions(uint64_t *state, double along[3], double across[3]) {
  double z = 2 * uniform(state) - 1, turn = two_pi * uniform(state), s = sqrt(1 - z * z),
         roll = two_pi * uniform(state);
  along[0] = s * cos(turn), along[1] = s * sin(turn), along[2] = z;
  const double east[3] = {-sin(turn), cos(turn), 0}, north[3] = {-z * cos(turn), -z * sin(turn), s};
  for (int c = 0; c < 3; c++) across[c] = cos(roll) * east[c] + sin(roll) * north[c];
}

/* One wave in each of equal parts of the logarithm of k. */
static void make_waves(turbulence *p) {
  uint64_t state = (uint64_t)p->seed;
  double count = (double)p->waves, span = log(p->largest / p->smallest), energy = 0;
  for (int64_t m = 0; m < p->waves; m++) {
    wave *w = &p->wave[m];
    double ratio = exp(span * ((double)m + uniform(&state)) / count), along[3]; /* k largest */
    double turnover = p->evolution * p->speed / p->largest * pow(ratio, 2. / 3), size = pow(ratio, -1. / 3);
    directions(&state, along, w->e);
    w->n = (2 * uniform(&state) - 1) * turnover;
    w->p = uniform(&state);
    for (int c = 0; c < 3; c++) {
      w->k[c] = ratio / p->largest * along[c];
      w->n -= w->k[c] * p->drift[c];
      w->e[c] *= size;
    }
    energy += size * size / 2;
  }
  for (int64_t m = 0; m < p->waves; m++)
    for (int c = 0; c < 3; c++) p->wave[m].e[c] *= p->speed / sqrt(energy);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  turbulence *p = self;
  (void)view;
  if (p->smallest > p->largest)
    return host->fail(host, HK_BAD_PARAM, "smallest: %g m is longer than largest, %g m", p->smallest, p->largest);
  hk_status status = hk_air_check(&p->drag, host);
  p->lanes = host->lanes;
  if (status == HK_OK) make_waves(p);
  return status;
}

/* ---- the air ---- */

/* cos(2 pi r) to 2e-16 without a branch, so that the loop uses vectors: r is brought to [-1/2, 1/2] by the rounding of
 * a large number, and |r| to s = 1/4 - |r|; then the Taylor series of sin(2 pi s), whose next term is 2.6e-16. */
HK_INLINE double cosine(double r) {
  static const double c[] = {6.283185307179586,   -41.341702240399755,  81.60524927607504,  -76.70585975306136,
                             42.058693944897634,  -15.094642576822984,  3.8199525848482803, -0.7181223017785001,
                             0.10422916220813978, -0.012031585942120619};
  const double round = 0x1.8p52, whole = (r + round) - round, s = 0.25 - fabs(r - whole), q = s * s;
  double sum = c[9];
  for (int k = 8; k >= 0; k--) sum = sum * q + c[k];
  return sum * s;
}

/* The waves at `count` places, with the components of x and u apart. */
HK_INLINE void add_waves(const turbulence *p, double t, double x[3][HK_AIR_BLOCK], double u[3][HK_AIR_BLOCK]) {
  for (int64_t m = 0; m < p->waves; m++) {
    const wave w = p->wave[m];
    const double at = w.n * t + w.p, start = at - floor(at);
    for (size_t i = 0; i < HK_AIR_BLOCK; i++) {
      double f = cosine(w.k[0] * x[0][i] + w.k[1] * x[1][i] + w.k[2] * x[2][i] + start);
      for (size_t c = 0; c < 3; c++) u[c][i] += w.e[c] * f;
    }
  }
}

HK_VERSIONS(static void, add_all, (const turbulence *p, double t, double x[3][HK_AIR_BLOCK], double u[3][HK_AIR_BLOCK]),
            add_waves(p, t, x, u))

static void velocity(const void *self, double t, const double *x, size_t count, double *u) {
  const turbulence *p = self;
  double places[3][HK_AIR_BLOCK] = {{0}}, sums[3][HK_AIR_BLOCK] = {{0}};
  for (size_t e = 0; e < 3 * count; e++) places[e % 3][e / 3] = x[e];
  HK_WIDEST(p->lanes, add_all)(p, t, places, sums);
  for (size_t e = 0; e < 3 * count; e++) u[e] = sums[e % 3][e / 3];
}

/* d cos(2 pi r)/dr = -2 pi sin(2 pi r) = 2 pi cos(2 pi (r + 1/4)). */
static void gradient(const void *self, double t, const double x[3], double G[9]) {
  const turbulence *p = self;
  for (int q = 0; q < 9; q++) G[q] = 0;
  for (int64_t m = 0; m < p->waves; m++) {
    const wave *w = &p->wave[m];
    const double at = w->n * t + w->p, phase = w->k[0] * x[0] + w->k[1] * x[1] + w->k[2] * x[2] + (at - floor(at));
    const double slope = two_pi * cosine(phase + 0.25);
    for (int q = 0; q < 9; q++) G[q] += slope * w->e[q / 3] * w->k[q % 3];
  }
}

static hk_air air_of(const turbulence *p) { return (hk_air){&p->drag, p, velocity, gradient}; }

/* ---- the force ---- */

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  hk_air air = air_of(self);
  hk_air_add(&air, view, part, F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  add_part(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

static void flow(const void *self, const hk_view *view, const double *x, size_t count, double *u) {
  hk_air air = air_of(self);
  hk_air_flow(&air, view->t, x, count, u);
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)self;
  hk_air_pattern(view, p);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  hk_air air = air_of(self);
  return hk_air_jacobian(&air, view, into);
}

/* A quarter of the smallest wavelength at the largest speed through the pattern. */
static double longest_step(void *self, const hk_view *view) {
  const turbulence *p = self;
  double most = 0;
  for (size_t k = 0; k < view->acting; k++) {
    const double *v = view->v + 3 * (view->active ? view->active[k] : k);
    const double u[3] = {v[0] - p->drift[0], v[1] - p->drift[1], v[2] - p->drift[2]};
    double square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    most = square > most ? square : most;
  }
  return most > 0 ? p->smallest / 4 / sqrt(most) : INFINITY;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_POWER,
    .add = add,
    .add_part = add_part,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.longest_step = longest_step), HK_PICTURES_FACET(.flow = flow)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "turbulence",
    .summary = "drag by turbulent air, F = d (u - v), u a sum of random waves without divergence",
    .reference = "Kraichnan, Diffusion by a random velocity field, Phys. Fluids 13 (1970); spectrum: Kolmogorov 1941",
    .instance_size = sizeof(turbulence),
    .params = params,
    .create = create,
    .force = &force,
};
