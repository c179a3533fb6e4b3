/* The air of a straight vortex, which drags particles along: F = d (u - v), and around the axis, at the distance r,
 *     Rankine:     u = strength r / (2 pi core^2) for r < core, strength / (2 pi r) outside;
 *     Lamb-Oseen:  u = strength (1 - exp(-r^2/core^2)) / (2 pi r).
 * The strength is the circulation far outside. Rankine's air turns like a solid body inside, with a corner in u at the
 * core's edge; Lamb and Oseen's is what viscosity nu has made of a thin vortex after core^2/(4 nu) seconds, and smooth.
 * The air flows around right-handed, seen along the axis. Both are s(r^2) times axis x r, so the gradient needs s and
 * its slope alone. */
#include "plugins/common/flow/air_drag.h"
#include "plugins/common/space/near_moves.h"

#include "core/plugin.h"

#include <string.h>

enum { LAMB_OSEEN, RANKINE };

typedef struct vortex {
  double center[3], axis[3], strength, core;
  int profile;
  hk_air_drag drag;
  int lanes;
} vortex;

static const hk_param params[] = {
    {"strength", "m^2/s", "circulation; positive: right-handed about the axis", .number = HK_AT(vortex, strength),
     .flags = HK_TIMED | HK_REQUIRED},
    {"core", "m", "radius of the core", .number = HK_AT(vortex, core), .initial = {0.1}, .limits = HK_ABOVE(0)},
    {"profile", "", "speed over the distance from the axis", .choice = HK_AT(vortex, profile), .initial = {LAMB_OSEEN},
     .choices = "lamb_oseen|rankine"},
    {"center", "m", "a point of the axis", .vector = HK_AT(vortex, center), .flags = HK_TIMED},
    {"axis", "", "direction of the axis", .vector = HK_AT(vortex, axis), .initial = {0, 0, 1}},
    HK_AIR_DRAG_PARAMS(vortex, drag),
    {0},
};

static const double two_pi = 6.283185307179586;

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  vortex *p = self;
  double *a = p->axis, length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  (void)view;
  if (!(length > 0)) return host->fail(host, HK_BAD_PARAM, "axis: it has no direction");
  for (int c = 0; c < 3; c++) a[c] /= length;
  p->lanes = host->lanes;
  return hk_air_check(&p->drag, host);
}

/* ---- the air ---- */

HK_INLINE double polynomial(const double *c, int degree, double x) {
  double sum = c[degree];
  for (int k = degree - 1; k >= 0; k--) sum = sum * x + c[k];
  return sum;
}

/* exp(-q) for 0 <= q <= 40 to 3e-16, without a branch, so that loops use vectors: with the whole number n nearest to
 * q/ln 2, 2^-n exp(-(q - n ln 2)) by Taylor's series, whose next term is 4e-18. Adding 1.5 2^52 leaves 1023 - n in the
 * last bits, and a shift makes it the exponent. */
HK_INLINE double exp_minus(double q) {
  static const double c[] = {1.0,
                             -1.0,
                             0.5,
                             -0.16666666666666666,
                             0.041666666666666664,
                             -0.008333333333333333,
                             0.001388888888888889,
                             -0.0001984126984126984,
                             2.48015873015873e-05,
                             -2.7557319223985893e-06,
                             2.755731922398589e-07,
                             -2.505210838544172e-08,
                             2.08767569878681e-09,
                             -1.6059043836821613e-10};
  const double round = 0x1.8p52, n = (q * 1.4426950408889634 + round) - round;
  const double rest = (q - n * 0x1.62e42fefap-1) - n * 0x1.cf79abc9e3b39p-40, power = (1023 - n) + round;
  uint64_t bits;
  double two_to_minus_n;
  memcpy(&bits, &power, sizeof bits);
  bits <<= 52;
  memcpy(&two_to_minus_n, &bits, sizeof bits);
  return two_to_minus_n * polynomial(c, 13, rest);
}

/* (1 - exp(-q))/q for q = (r/core)^2; below 1/2 by its series, whose next term is 5e-17, beyond 40 without exp. */
HK_INLINE double lamb_oseen(double q) {
  static const double c[] = {1.0,
                             -0.5,
                             0.16666666666666666,
                             -0.041666666666666664,
                             0.008333333333333333,
                             -0.001388888888888889,
                             0.0001984126984126984,
                             -2.48015873015873e-05,
                             2.7557319223985893e-06,
                             -2.755731922398589e-07,
                             2.505210838544172e-08,
                             -2.08767569878681e-09,
                             1.6059043836821613e-10,
                             -1.1470745597729725e-11};
  const double far = q > 0.5 ? q : 0.5, near = q < 0.5 ? q : 0.5, most = far < 40 ? far : 40;
  const double by_exp = (1 - exp_minus(most)) / far, by_series = polynomial(c, 13, near);
  return q < 0.5 ? by_series : by_exp;
}

/* Near 0 by its series, whose next term is below 2e-16. */
static double lamb_oseen_slope(double q) {
  if (q < 1e-2) return -0.5 + q * (1. / 3 - q * (1. / 8 - q * (1. / 30 - q * (1. / 144 - q / 840))));
  return (exp_minus(fmin(q, 40)) - lamb_oseen(q)) / q;
}

static double profile(const vortex *p, double q) { return p->profile == LAMB_OSEEN ? lamb_oseen(q) : 1 / fmax(1, q); }

static double profile_slope(const vortex *p, double q) {
  return p->profile == LAMB_OSEEN ? lamb_oseen_slope(q) : q < 1 ? 0 : -1 / (q * q);
}

static void turn(const double axis[3], const double r[3], double speed, double u[3]) {
  for (int c = 0; c < 3; c++) u[c] = speed * (axis[(c + 1) % 3] * r[(c + 2) % 3] - axis[(c + 2) % 3] * r[(c + 1) % 3]);
}

static void velocity_at(const vortex *p, const double r[3], double u[3]) {
  const double a2 = p->core * p->core, q = (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) / a2;
  turn(p->axis, r, p->strength / (two_pi * a2) * profile(p, q), u);
}

/* As velocity_at for `count` places, the components apart. */
HK_INLINE void turn_all(const vortex *p, double r[3][HK_AIR_BLOCK], bool smooth) {
  const double a2 = p->core * p->core, unit = p->strength / (two_pi * a2), *a = p->axis;
  for (size_t i = 0; i < HK_AIR_BLOCK; i++) {
    const double x = r[0][i], y = r[1][i], z = r[2][i], q = (x * x + y * y + z * z) / a2;
    const double s = unit * (smooth ? lamb_oseen(q) : 1 / (q > 1 ? q : 1));
    r[0][i] = s * (a[1] * z - a[2] * y);
    r[1][i] = s * (a[2] * x - a[0] * z);
    r[2][i] = s * (a[0] * y - a[1] * x);
  }
}

HK_INLINE void turn_by_profile(const vortex *p, double r[3][HK_AIR_BLOCK]) {
  if (p->profile == LAMB_OSEEN)
    turn_all(p, r, true);
  else
    turn_all(p, r, false);
}

HK_VERSIONS(static void, turn_block, (const vortex *p, double r[3][HK_AIR_BLOCK]), turn_by_profile(p, r))

static void velocity(const void *self, double t, const double *x, size_t count, double *u) {
  const vortex *p = self;
  double parts[3][HK_AIR_BLOCK] = {{0}};
  (void)t;
  for (size_t i = 0; i < count; i++) {
    double r[3];
    hk_from_line(p->center, p->axis, x + 3 * i, r);
    for (int c = 0; c < 3; c++) parts[c][i] = r[c];
  }
  HK_WIDEST(p->lanes, turn_block)(p, parts);
  for (size_t e = 0; e < 3 * count; e++) u[e] = parts[e % 3][e / 3];
}

/* u = s(q) A r with A the cross product by the axis, so du/dx = s A + s' (A r) (2 r/core^2)^T: A's rows are already
 * across the axis. */
static void gradient(const void *self, double t, const double x[3], double G[9]) {
  const vortex *p = self;
  const double a2 = p->core * p->core, unit = p->strength / (two_pi * a2);
  double r[3], across[3];
  (void)t;
  hk_from_line(p->center, p->axis, x, r);
  double q = (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) / a2, s = unit * profile(p, q);
  turn(p->axis, r, unit * profile_slope(p, q) * 2 / a2, across);
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    for (int c = 0; c < 3; c++) G[3 * i + c] = across[i] * r[c];
    G[3 * i + k] += s * p->axis[j];
    G[3 * i + j] -= s * p->axis[k];
  }
}

static hk_air air_of(const vortex *p) { return (hk_air){&p->drag, p, velocity, gradient}; }

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

/* ---- a core that steps pass by: outside it u falls as 1/r ---- */

typedef struct collection {
  const vortex *self;
  const hk_view *to;
  hk_encounters *into;
} collection;

/* The drag of the air's velocity on one particle. */
typedef struct law {
  const vortex *self;
  double d;
} law;

static void law_at(const void *self, const double r[3], double F[3]) {
  const law *l = self;
  velocity_at(l->self, r, F);
  for (int c = 0; c < 3; c++) F[c] *= l->d;
}

static void add_encounter(void *context, uint32_t i, const double r[3], const double dr[3]) {
  const collection *c = context;
  const vortex *p = c->self;
  hk_encounter way = {.i = i, .other = i, .r = {r[0], r[1], r[2]}, .dr = {dr[0], dr[1], dr[2]}};
  law l = {p, hk_air_coefficient(&p->drag, c->to, i)};
  way.range = sqrt(hk_nearest_square(r, dr) + p->core * p->core) / 2;
  c->into->add(c->into, &way, law_at, &l);
}

/* At a distance R after a move of length l the particle was never nearer than R - l: R >= 3/2 l leaves 4 ranges. */
static bool encounters(const void *self, const hk_view *to, const double *x_from, hk_encounters *into) {
  const vortex *p = self;
  collection c = {p, to, into};
  hk_near_moves moves = {p->center, p->axis, 1.5, to, x_from};
  hk_near_moves_visit(&moves, add_encounter, &c);
  return true;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_POWER,
    .add = add,
    .add_part = add_part,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_ENCOUNTERS_FACET(.find = encounters), HK_PICTURES_FACET(.flow = flow)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "vortex",
    .summary =
        "drag by the air of a straight vortex, F = d (u - v), u = strength/(2 pi r) outside a core around an axis",
    .reference = "Rankine 1858; Oseen 1912; Saffman, Vortex Dynamics (1992), 2.1 and 13.1",
    .instance_size = sizeof(vortex),
    .params = params,
    .create = create,
    .force = &force,
};
