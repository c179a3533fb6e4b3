/* Drives of joints: springs, dampers, motors and friction in joints. Of the coordinate q of a joint, the angle of a
 * hinge or the way of a slider (plugins/common/mechanisms/coordinate.h), and its rate u, the generalised force is Q =
 * -k (q - rest(t)) - damping (u - speed(t)), within -most and most,    and beside it -friction tanh(u/slip), so that a
 * motor is a force with a bound (a controller of proportion and rate), not an equation. It acts as Q grad q, on the
 * bodies a pure torque about the axis, or a force along it, without momentum. Without a bound the spring has the energy
 * 1/2 k (q - rest)^2; what is bounded has none, and all its power is counted as work. Coulomb's friction is
 * regularised: below the speed `slip` it is nearly viscous, friction u/slip, so that what should stick creeps; its step
 * is that of the damping friction/slip.
 *
 * Invariant: `turned` has the angle at the last accepted step, counted on through whole turns; an angle of a state is
 * the one nearest to it. */
#include "plugins/common/mechanisms/coordinate.h"
#include "plugins/common/mechanisms/positive.h"
#include "plugins/kit/vector3.h"

typedef struct drives {
  hk_coordinate q;
  double k, damping, rest, speed, most, friction, slip;
  double *turned; /* per tuple, rad or m */
} drives;

static const hk_param params[] = {
    {"points", "", "tuples of four, as joint:frame() of a hinge or a slider returns",
     .tetrahedra = HK_AT(drives, q.points), .flags = HK_REQUIRED},
    {"of", "", "turn: of hinges, in rad and N m; way: of sliders, in m and N", .choice = HK_AT(drives, q.kind),
     .initial = {HK_COORDINATE_TURN}, .choices = HK_COORDINATE_CHOICES},
    {"k", "N m/rad or N/m", "stiffness towards rest", .number = HK_AT(drives, k), .limits = HK_AT_LEAST(0)},
    {"rest", "rad or m", "angle or way at rest, 0 where the joint starts", .number = HK_AT(drives, rest),
     .flags = HK_TIMED},
    {"damping", "N m s/rad or N s/m", "resistance to other speeds", .number = HK_AT(drives, damping),
     .limits = HK_AT_LEAST(0)},
    {"speed", "rad/s or m/s", "that the damping drives to", .number = HK_AT(drives, speed), .flags = HK_TIMED},
    {"most", "N m or N", "bound of what spring and damping do; left out: none", .number = HK_AT(drives, most),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"friction", "N m or N", "Coulomb's, against the motion", .number = HK_AT(drives, friction),
     .limits = HK_AT_LEAST(0)},
    {"slip", "rad/s or m/s", "above some of it friction is whole: it is tanh(u/slip) of it",
     .number = HK_AT(drives, slip), .initial = {1e-2}, .limits = HK_ABOVE(0)},
    {0},
};

static const hk_field fields[] = {
    {"turned", .per_tuple = HK_AT(drives, turned), .width = 1, .list = "points"},
    {0},
};

/* ---- one joint ---- */

typedef struct drive {
  double off, u;        /* q - rest; dq/dt */
  double Q, by_q, by_u; /* the force, and its derivatives, by q and by u; all without friction's part in `by_q` */
  double lost;          /* the part of Q without an energy */
  double g[4][3];
} drive;

static bool bounded(const drives *s) { return !isnan(s->most); }

static void evaluate(const drives *s, const hk_view *view, size_t k, drive *d) {
  d->off = hk_coordinate_value(&s->q, view->x, k, s->turned[k], d->g) - s->rest;
  d->u = hk_coordinate_rate(&s->q, view->v, k, d->g);
  double spring = -s->k * d->off, damping = -s->damping * (d->u - s->speed), soft = tanh(d->u / s->slip);
  d->Q = spring + damping, d->by_q = -s->k, d->by_u = -s->damping;
  if (bounded(s) && fabs(d->Q) > s->most) d->Q = copysign(s->most, d->Q), d->by_q = d->by_u = 0;
  d->Q -= s->friction * soft;
  d->by_u -= s->friction / s->slip * (1 - soft * soft);
  d->lost = bounded(s) ? d->Q : d->Q - spring;
}

static bool acts(const drives *s, const hk_view *view, size_t k) {
  bool all = true;
  for (int m = 0; m < 4 && view->is_active; m++) all &= view->is_active[hk_tuple(&s->q.points, k)[m]];
  return all;
}

/* ---- the force ---- */

static hk_status check(const drives *s, const hk_host *host) {
  if (s->speed != 0 && s->damping == 0)
    return host->fail(host, HK_BAD_PARAM,
                      "speed: nothing drives to %g, since damping is 0: give a damping, the torque or force for a "
                      "difference of speed",
                      s->speed);
  if (s->rest != 0 && s->k == 0)
    return host->fail(host, HK_BAD_PARAM, "rest: nothing pulls to %g, since k is 0: give a stiffness", s->rest);
  if (bounded(s) && s->k == 0 && s->damping == 0)
    return host->fail(host, HK_BAD_PARAM, "most: there is nothing to bound, since k and damping are 0: give one");
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  drives *s = self;
  hk_status status = check(s, host);
  if (status == HK_OK) status = hk_coordinate_start(&s->q, view);
  for (size_t k = 0; k < s->q.points.count && status == HK_OK; k++)
    s->turned[k] = hk_coordinate_value(&s->q, view->x, k, NAN, NULL);
  return status;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  const drives *s = self;
  drive d;
  for (size_t k = 0; k < s->q.points.count; k++) {
    if (!acts(s, view, k)) continue;
    evaluate(s, view, k, &d);
    for (int m = 0; m < 4; m++) hk_add_scaled(F + 3 * (size_t)hk_tuple(&s->q.points, k)[m], d.Q, d.g[m]);
    if (view->power) *view->power += d.lost * d.u;
  }
  return HK_OK;
}

static double energy(void *self, const hk_view *view) {
  const drives *s = self;
  double sum = 0;
  drive d;
  for (size_t k = 0; k < s->q.points.count && !bounded(s); k++) {
    if (!acts(s, view, k)) continue;
    evaluate(s, view, k, &d);
    sum += s->k * d.off * d.off / 2;
  }
  return sum;
}

static void pattern(void *self, const hk_view *view, hk_pattern *into) {
  const drives *s = self;
  for (size_t k = 0; k < s->q.points.count; k++)
    for (int b = 0; b < 16 && acts(s, view, k); b++) {
      const uint32_t *point = hk_tuple(&s->q.points, k);
      into->block(into, point[b / 4], point[b % 4]);
    }
}

/* K = -(Q_q g g^T + Q_u g (H v)^T + Q H), D = -Q_u g g^T. */
static void add_blocks(const drives *s, const hk_view *view, size_t k, const hk_blocks *into, const size_t *slot) {
  const uint32_t *point = hk_tuple(&s->q.points, k);
  double H[144], Hv[12] = {0};
  drive d;
  evaluate(s, view, k, &d);
  hk_coordinate_hessian(&s->q, view->x, k, H);
  const double *g = d.g[0];
  for (size_t r = 0; r < 12 && !(into->want & (HK_WANT_SYMMETRIC | HK_WANT_DEFINITE)); r++)
    for (size_t c = 0; c < 12; c++) Hv[r] += H[12 * r + c] * view->v[3 * (size_t)point[c / 3] + c % 3];
  for (size_t e = 0; e < 144; e++) H[e] = -d.by_q * g[e / 12] * g[e % 12] - d.Q * H[e];
  if (into->want & HK_WANT_DEFINITE) hk_without_negative(H);
  for (size_t r = 0; r < 12; r++)
    for (size_t c = 0; c < 12; c++) {
      size_t at = 9 * slot[4 * (r / 3) + c / 3] + 3 * (r % 3) + c % 3;
      into->K[at] += H[12 * r + c] - d.by_u * g[r] * Hv[c];
      into->D[at] -= d.by_u * g[r] * g[c];
    }
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const drives *s = self;
  const size_t *slot = into->slot;
  for (size_t k = 0; k < s->q.points.count; k++) {
    if (!acts(s, view, k)) continue;
    add_blocks(s, view, k, into, slot);
    slot += 16;
  }
  return HK_OK;
}

/* (sum g_i.u_i)^2 <= sum_j |g_j| sum_i (g_i.u_i)^2/|g_i|, and u.H u <= sum_i |u_i|^2 sum_j |H_ij| by Frobenius' norms.
 */
static void bound(double (*g)[3], double c, const double *H, double z, const uint32_t *point, double (*block)[6]) {
  static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
  double all = 0;
  for (int m = 0; m < 4; m++) all += hk_length(g[m]);
  for (size_t m = 0; m < 4; m++) {
    double length = hk_length(g[m]), by = length > 0 ? c * all / length : 0, norm = 0;
    for (size_t n = 0; n < 4; n++) {
      double square = 0;
      for (size_t e = 0; e < 9; e++) {
        double h = H[12 * (3 * m + e / 3) + 3 * n + e % 3];
        square += h * h;
      }
      norm += sqrt(square);
    }
    for (int e = 0; e < 6; e++)
      block[point[m]][e] += by * g[m][row[e]] * g[m][column[e]] + (row[e] == column[e] ? fabs(z) * norm : 0);
  }
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const drives *s = self;
  double H[144];
  drive d;
  for (size_t k = 0; k < s->q.points.count; k++) {
    if (!acts(s, view, k)) continue;
    evaluate(s, view, k, &d);
    hk_coordinate_hessian(&s->q, view->x, k, H);
    bool damping = part == HK_DAMPING_WHOLE;
    bound(d.g, damping ? s->damping + s->friction / s->slip : s->k, H, damping ? 0 : d.Q, hk_tuple(&s->q.points, k),
          block);
  }
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  drives *s = self;
  (void)h;
  for (size_t k = 0; k < s->q.points.count; k++)
    s->turned[k] = hk_coordinate_value(&s->q, view->x, k, s->turned[k], NULL);
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_STEPS_FACET(.accepted = accepted)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "joint_drives",
    .summary = "springs, dampers, motors with a bound and friction in hinges and sliders",
    .reference =
        "Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems I (1989), chapter 11; Tamstorf and "
        "Grinspun 2013, Discrete bending forces and their Jacobians",
    .instance_size = sizeof(drives),
    .params = params,
    .fields = fields,
    .create = create,
    .force = &force,
};
