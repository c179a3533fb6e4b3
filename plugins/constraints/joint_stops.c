/* Stops: the angle of a hinge or the way of a slider stays between `lower` and `upper`. With q the coordinate
 * (plugins/common/mechanisms/coordinate.h) each bound is a one-sided equation, g = r (q - lower) >= 0 and g = r (upper
 * - q) >= 0, with r = 1 of ways and, of angles, the distance of the fourth point from the axis at the start: a
 * multiplier times r is the torque. The step is cut where a stop is met (core/numerics/constraints/impact.c); what
 * closes at the speed u leaves at bounce u (Newton's law of impact), and rests on the stop where u is below `still`.
 *
 * An angle is counted from the middle of its bounds, half a turn either way, so that both are needed, less than a turn
 * apart. A stop that no bound is given for is where the joint starts. */
#include "plugins/common/mechanisms/coordinate.h"
#include "plugins/kit/vector3.h"

static const double whole = 6.283185307179586; /* turn, rad */

typedef struct stops {
  hk_coordinate q;
  hk_per_tuple lower, upper; /* count 0: none */
  double bounce, still;
  hk_per_tuple arm; /* r, m, or 1 */
  unsigned bounds;  /* of a tuple: 1 or 2 */
} stops;

static const hk_param params[] = {
    {"points", "", "tuples of four, as joint:frame() of a hinge or a slider returns",
     .tetrahedra = HK_AT(stops, q.points), .flags = HK_REQUIRED},
    {"of", "", "turn: of hinges, in rad; way: of sliders, in m", .choice = HK_AT(stops, q.kind),
     .initial = {HK_COORDINATE_TURN}, .choices = HK_COORDINATE_CHOICES},
    {"lower", "rad or m", "least angle or way, 0 where joint:frame() was made; left out with upper: as it starts",
     .per_tuple = HK_AT(stops, lower), .flags = HK_OPTIONAL},
    {"upper", "rad or m", "largest angle or way", .per_tuple = HK_AT(stops, upper), .flags = HK_OPTIONAL},
    {"bounce", "", "coefficient of restitution: speed after an impact in parts of that before",
     .number = HK_AT(stops, bounce), .limits = HK_WITHIN(0, 1)},
    {"still", "rad/s or m/s", "what meets a stop more slowly does not bounce", .number = HK_AT(stops, still),
     .initial = {1e-3}, .limits = HK_ABOVE(0)},
    {"arm", "m",
     "of angles, the length by which an equation is one of lengths; left out: the fourth point's distance "
     "from the axis",
     .per_tuple = HK_AT(stops, arm), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {0},
};

/* ---- one coordinate ---- */

static double lower_of(const stops *s, size_t k) { return s->lower.count ? hk_tuple_value(&s->lower, k) : -INFINITY; }

static double upper_of(const stops *s, size_t k) { return s->upper.count ? hk_tuple_value(&s->upper, k) : INFINITY; }

/* Of an angle, near which it is counted; NAN: ways are not. */
static double middle(const stops *s, size_t k) {
  double lower = lower_of(s, k);
  return s->q.kind == HK_COORDINATE_TURN ? lower + (upper_of(s, k) - lower) / 2 : NAN;
}

static bool is_upper(const stops *s, size_t row) { return s->bounds == 2 ? row % 2 : s->upper.count > 0; }

static double arm_of(const stops *s, size_t k) { return hk_tuple_value(&s->arm, k); }

/* ---- the start ---- */

/* Where nothing is given: as it starts, and half a turn from there. */
static hk_status choose(stops *s, const hk_view *view) {
  const hk_host *host = view->host;
  size_t count = s->q.points.count;
  bool turn = s->q.kind == HK_COORDINATE_TURN;
  double *lower = host->allocate(host, (count + 1) * sizeof *lower),
         *upper = host->allocate(host, (count + 1) * sizeof *upper);
  if (!lower || !upper) return host->fail(host, HK_NO_MEMORY, "no memory for %zu stops", count);
  for (size_t k = 0; k < count; k++) {
    lower[k] = hk_coordinate_value(&s->q, view->x, k, NAN, NULL);
    upper[k] = lower[k] + whole / 2;
  }
  s->lower = (hk_per_tuple){count, lower};
  if (turn) s->upper = (hk_per_tuple){count, upper};
  return HK_OK;
}

static hk_status check(const stops *s, const hk_host *host, size_t k) {
  double lower = lower_of(s, k), upper = upper_of(s, k);
  if (!(lower < upper)) return host->fail(host, HK_BAD_PARAM, "lower, %g, has to be below upper, %g", lower, upper);
  if (s->q.kind == HK_COORDINATE_TURN && !(upper - lower < whole))
    return host->fail(host, HK_BAD_PARAM,
                      "an angle needs both lower and upper, less than a whole turn apart, since a turn more looks the "
                      "same");
  return HK_OK;
}

static double distance_from_axis(const double *x, const uint32_t *point) {
  double axis[3], far[3];
  hk_subtract(axis, x + 3 * (size_t)point[1], x + 3 * (size_t)point[0]);
  hk_subtract(far, x + 3 * (size_t)point[3], x + 3 * (size_t)point[0]);
  hk_add_scaled(far, -hk_dot(far, axis) / hk_dot(axis, axis), axis);
  return hk_length(far);
}

static hk_status find_arms(stops *s, const hk_view *view) {
  const hk_host *host = view->host;
  double *arm = host->allocate(host, (s->q.points.count + 1) * sizeof *arm);
  if (!arm) return host->fail(host, HK_NO_MEMORY, "no memory for %zu stops", s->q.points.count);
  for (size_t k = 0; k < s->q.points.count; k++)
    arm[k] = s->q.kind == HK_COORDINATE_WAY ? 1 : distance_from_axis(view->x, hk_tuple(&s->q.points, k));
  s->arm = (hk_per_tuple){s->q.points.count, arm};
  return HK_OK;
}

static hk_status check_start(const stops *s, const hk_view *view, size_t k) {
  bool turn = s->q.kind == HK_COORDINATE_TURN;
  double q = hk_coordinate_value(&s->q, view->x, k, middle(s, k), NULL), lower = lower_of(s, k);
  double by = fmax(lower - q, q - upper_of(s, k));
  if (!(by > 1e-9)) return HK_OK;
  return view->host->fail(
      view->host, HK_BAD_PARAM,
      "joint %zu starts at %.6g %s, outside of its stops by %.3g: start it between them, or move %s", k + 1, q,
      turn ? "rad" : "m", by, q < lower ? "lower" : "upper");
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  stops *s = self;
  hk_status status = hk_coordinate_start(&s->q, view);
  if (status == HK_OK && s->lower.count == 0 && s->upper.count == 0) status = choose(s, view);
  s->bounds = (s->lower.count > 0) + (s->upper.count > 0);
  for (size_t k = 0; k < s->q.points.count && status == HK_OK; k++) status = check(s, host, k);
  if (status == HK_OK && s->arm.count == 0) status = find_arms(s, view);
  for (size_t k = 0; k < s->q.points.count && status == HK_OK; k++) status = check_start(s, view, k);
  return status;
}

/* ---- the equations: those of a joint stand together ---- */

static size_t count(void *self) { return ((const stops *)self)->q.points.count * ((const stops *)self)->bounds; }

static void pattern(void *self, hk_pattern *into) {
  const stops *s = self;
  for (size_t row = 0; row < count(self); row++)
    for (int m = 0; m < 4; m++) into->block(into, (uint32_t)row, hk_tuple(&s->q.points, row / s->bounds)[m]);
}

static hk_status value(void *self, const hk_view *view, double *g) {
  const stops *s = self;
  for (size_t row = 0; row < count(self); row++) {
    size_t k = row / s->bounds;
    double q = hk_coordinate_value(&s->q, view->x, k, middle(s, k), NULL);
    g[row] = arm_of(s, k) * (is_upper(s, row) ? upper_of(s, k) - q : q - lower_of(s, k));
  }
  return HK_OK;
}

static hk_status jacobian(void *self, const hk_view *view, double (*J)[3]) {
  const stops *s = self;
  for (size_t row = 0; row < count(self); row++) {
    size_t k = row / s->bounds;
    double sign = is_upper(s, row) ? -arm_of(s, k) : arm_of(s, k);
    hk_coordinate_value(&s->q, view->x, k, NAN, J + 4 * row);
    for (size_t e = 0; e < 12; e++) J[4 * row + e / 3][e % 3] *= sign;
  }
  return HK_OK;
}

static hk_status curvature(void *self, const hk_view *view, double *c) {
  const stops *s = self;
  for (size_t row = 0; row < count(self); row++) {
    size_t k = row / s->bounds;
    double sign = is_upper(s, row) ? -arm_of(s, k) : arm_of(s, k);
    c[row] = sign * hk_coordinate_bend(&s->q, view->x, view->v, k);
  }
  return HK_OK;
}

static void restitution(void *self, double *part, double *least) {
  const stops *s = self;
  for (size_t row = 0; row < count(self); row++)
    part[row] = s->bounce, least[row] = s->still * arm_of(s, row / s->bounds);
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .flags = HK_ONE_SIDED,
                                         .count = count,
                                         .pattern = pattern,
                                         .value = value,
                                         .jacobian = jacobian,
                                         .curvature = curvature,
                                         .restitution = restitution};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "joint_stops",
    .summary = "hinges and sliders that stop at limits of their angle or way, and bounce",
    .reference = "Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics",
    .instance_size = sizeof(stops),
    .params = params,
    .create = create,
    .constraint = &constraint,
};
