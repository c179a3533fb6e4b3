/* Particles on a surface or a curve: the equations g(t, x) = 0, one for a surface and two, which hold together, for a
 * curve. A shape is made of two kinds of them, with d = x - position, n along `axis` and P = I - n n^T:
 *     plane   n.d                    gradient n           v.H v = 0
 *     radial  |d| - R or |P d| - R   gradient e = d/|d|   v.H v = (u.u - (e.u)^2)/|d|, u = v or P v
 * (sphere: radial; cylinder: radial about the axis; circle: that and the plane; line: two planes through it). Or the
 * script states g, and for a curve h as well, in any unit, with or without their gradients.
 *
 * What the script does not state are differences (plugins/common/implicit). What is wrong in second ones changes the
 * force along the gradient alone, which the projection after a step takes back. At the start
 * they are compared with finer ones, and so is a stated gradient.
 *
 * Functions are divided by the length of their gradient at the particle's start, so that equations are in metres there
 * and a multiplier is the force in N towards growing g. A surface has no direction where the gradient vanishes (the
 * middle of a sphere, the tip of a cone): that is an error. Particles that start off the surface are moved onto it, as
 * by all constraints, and hooke says so. To keep particles on one side of a shape is the corrector `obstacle`'s task.
 */
#include "plugins/common/implicit/script_equation.h"
#include "plugins/kit/vector3.h"
#include "core/plugin.h"

enum { SPHERE, PLANE, CYLINDER, CIRCLE, LINE };
enum { MOST = 2 }; /* equations of a particle */

typedef struct surface {
  hk_tuples particles;
  int shape;
  double position[3], axis[3], radius;
  const hk_function *g[MOST], *gradient[MOST];
  double length;
  unsigned equations; /* of a particle */
  double *scale;      /* n x MOST, 1/|gradient| at the start */
  double n[3][3];     /* the axis, and two directions across it */
  const hk_host *host;
} surface;

static const hk_param params[] = {
    {"particles", "", "those that stay on it", .particles = HK_AT(surface, particles), .flags = HK_REQUIRED},
    {"shape", "", "of the surface or curve, unless g states it", .choice = HK_AT(surface, shape), .initial = {SPHERE},
     .choices = "sphere|plane|cylinder|circle|line"},
    {"position", "m", "middle of the shape; of a plane and a line: a point of it", .vector = HK_AT(surface, position)},
    {"axis", "", "normal of a plane and a circle, axis of a cylinder, direction of a line",
     .vector = HK_AT(surface, axis), .initial = {0, 0, 1}},
    {"radius", "m", "of a sphere, a cylinder, a circle", .number = HK_AT(surface, radius), .initial = {1},
     .limits = HK_ABOVE(0)},
    {"g", "", "instead of a shape: what is 0 on the surface, in any unit", .function = HK_AT(surface, g[0]),
     .signature = "function(t, x, y, z, id) -> g"},
    {"g_gradient", "", "dg/dx, dg/dy, dg/dz; left out: differences, which take 12 calls of g",
     .function = HK_AT(surface, gradient[0]), .signature = "function(t, x, y, z, id) -> gx, gy, gz"},
    {"h", "", "what is 0 as well: a curve is where two surfaces meet", .function = HK_AT(surface, g[1]),
     .signature = "function(t, x, y, z, id) -> h"},
    {"h_gradient", "", "dh/dx, dh/dy, dh/dz", .function = HK_AT(surface, gradient[1]),
     .signature = "function(t, x, y, z, id) -> hx, hy, hz"},
    {"length", "m", "over which g and h change, for their differences", .number = HK_AT(surface, length),
     .initial = {1}, .limits = HK_ABOVE(0)},
    {0},
};

static const hk_field fields[] = {
    {"scale", .per_particle = HK_AT(surface, scale), .width = MOST},
    {0},
};

static const double vanishes = 1e-9, /* a gradient, relative to that at the start: far above rounding */
    differs = 1e-3;                  /* relative, from finer differences: a wrong formula or length, no rounding */

/* ---- one equation at one place ---- */

typedef struct place {
  const surface *self;
  unsigned equation;
  hk_event at;
} place;

static place place_of(const surface *s, const hk_view *view, size_t k, unsigned equation) {
  uint32_t i = s->particles.index[k];
  const double *x = view->x + 3 * (size_t)i;
  return (place){s, equation, {view->t, {x[0], x[1], x[2]}, view->model->id[i]}};
}

/* What the script states of the equation; its g is NULL where it is that of a shape. */
static hk_script_equation script_of(const place *p) {
  const surface *s = p->self;
  return (hk_script_equation){s->host, s->g[p->equation], s->gradient[p->equation], s->length};
}

/* ---- shapes ---- */

/* The normal of the plane that the equation is; NULL: it is radial. */
static const double *plane_of(const place *p) {
  const surface *s = p->self;
  if (s->shape == PLANE) return s->n[0];
  if (s->shape == CIRCLE) return p->equation ? s->n[0] : NULL;
  return s->shape == LINE ? s->n[1 + p->equation] : NULL;
}

/* u without its part along the axis, unless the shape is a sphere. */
static void across(const surface *s, double u[3]) {
  if (s->shape != SPHERE) hk_add_scaled(u, -hk_dot(u, s->n[0]), s->n[0]);
}

/* |d|, and the direction of d. */
static double radial(const place *p, double e[3]) {
  hk_subtract(e, p->at.x, p->self->position);
  across(p->self, e);
  double r = hk_length(e);
  for (int c = 0; c < 3; c++) e[c] = r > 0 ? e[c] / r : 0;
  return r;
}

static double value_of_shape(const place *p) {
  const double *plane = plane_of(p);
  double d[3];
  if (!plane) return radial(p, d) - p->self->radius;
  hk_subtract(d, p->at.x, p->self->position);
  return hk_dot(plane, d);
}

static void gradient_of_shape(const place *p, double n[3]) {
  const double *plane = plane_of(p);
  if (plane)
    hk_copy(n, plane);
  else
    radial(p, n);
}

static double bend_of_shape(const place *p, const double v[3]) {
  double e[3], u[3];
  if (plane_of(p)) return 0;
  double r = radial(p, e);
  hk_copy(u, v);
  across(p->self, u);
  double along = hk_dot(e, u);
  return r > 0 ? (hk_dot(u, u) - along * along) / r : 0;
}

/* ---- either of them ---- */

static hk_status value_at(const place *p, double *g) {
  hk_script_equation e = script_of(p);
  if (e.g) return hk_script_value(&e, &p->at, g);
  *g = value_of_shape(p);
  return HK_OK;
}

static hk_status gradient_at(const place *p, double n[3]) {
  hk_script_equation e = script_of(p);
  if (e.g) return hk_script_gradient(&e, &p->at, n);
  gradient_of_shape(p, n);
  return HK_OK;
}

static hk_status bend_at(const place *p, const double v[3], double scale, double *c) {
  hk_script_equation e = script_of(p);
  if (e.g) return hk_script_curvature(&e, &p->at, v, hk_length(p->at.x) / scale, c);
  *c = bend_of_shape(p, v);
  return HK_OK;
}

static hk_status no_direction(const place *p, hk_status status) {
  const surface *s = p->self;
  const double *x = p->at.x;
  const char *what = s->g[0]              ? (p->equation ? "the gradient of h vanishes" : "the gradient of g vanishes")
                     : s->shape == SPHERE ? "this is the middle of the sphere"
                                          : "this is on the axis";
  return s->host->fail(s->host, status, "particle %.0f at (%.9g, %.9g, %.9g) m, t = %.9g s: %s, so it has no direction",
                       p->at.id, x[0], x[1], x[2], p->at.t, what);
}

/* ---- the start ---- */

static hk_status directions(surface *s) {
  double length = hk_length(s->axis);
  int least = 0;
  if (!(length > 0)) return s->host->fail(s->host, HK_BAD_PARAM, "axis: it has no length, so no direction");
  for (int c = 0; c < 3; c++) {
    s->n[0][c] = s->axis[c] / length;
    if (fabs(s->axis[c]) < fabs(s->axis[least])) least = c;
  }
  s->n[1][least] = 1;
  hk_cross(s->n[1], s->n[0], s->n[1]);
  length = hk_length(s->n[1]);
  for (int c = 0; c < 3; c++) s->n[1][c] /= length;
  hk_cross(s->n[2], s->n[0], s->n[1]);
  return HK_OK;
}

/* Compares a gradient with differences over an eighth of the length: those that it is, or what the script states. */
static hk_status check_gradient(const place *p, const double n[3]) {
  const surface *s = p->self;
  hk_script_equation e = script_of(p);
  double known[3], off[3];
  e.length /= 8;
  hk_status status = hk_script_differences(&e, &p->at, known);
  hk_subtract(off, n, known);
  if (status != HK_OK || hk_length(off) <= differs * hk_length(known)) return status;
  char name = "gh"[p->equation];
  if (!e.gradient)
    return s->host->fail(
        s->host, HK_BAD_PARAM,
        "%c: differences at the start of particle %.0f are (%.6g, %.6g, %.6g), and finer ones (%.6g, %.6g, "
        "%.6g): it changes within less than length = %g m, give that, or %c_gradient",
        name, p->at.id, n[0], n[1], n[2], known[0], known[1], known[2], s->length, name);
  return s->host->fail(
      s->host, HK_BAD_PARAM,
      "%c_gradient: at the start of particle %.0f it is (%.6g, %.6g, %.6g), and differences of %c give "
      "(%.6g, %.6g, %.6g): one of them is wrong, or %c changes within less than length = %g m",
      name, p->at.id, n[0], n[1], n[2], name, known[0], known[1], known[2], name, s->length);
}

static hk_status measure_scale(surface *s, const hk_view *view, size_t k, unsigned e) {
  place p = place_of(s, view, k, e);
  double n[3];
  hk_status status = gradient_at(&p, n);
  if (status == HK_OK && s->g[e]) status = check_gradient(&p, n);
  double length = status == HK_OK ? hk_length(n) : 1;
  if (!(length > 0)) return no_direction(&p, HK_BAD_PARAM);
  s->scale[MOST * s->particles.index[k] + e] = 1 / length;
  return status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  surface *s = self;
  s->host = host;
  if (s->g[1] && !s->g[0]) return host->fail(host, HK_BAD_PARAM, "h is for a curve, which g and h state together");
  for (int e = 0; e < MOST; e++)
    if (s->gradient[e] && !s->g[e])
      return host->fail(host, HK_BAD_PARAM, "%c_gradient needs %c, whose gradient it is", "gh"[e], "gh"[e]);
  s->equations = s->g[0] ? 1 + (s->g[1] != NULL) : 1 + (s->shape == CIRCLE || s->shape == LINE);
  hk_status status = directions(s);
  for (size_t k = 0; k < s->particles.count; k++)
    for (unsigned e = 0; e < s->equations && status == HK_OK; e++) status = measure_scale(s, view, k, e);
  return status;
}

/* ---- the equations: those of a particle stand together ---- */

static size_t count(void *self) {
  const surface *s = self;
  return s->particles.count * s->equations;
}

static void pattern(void *self, hk_pattern *into) {
  const surface *s = self;
  for (size_t k = 0; k < count(self); k++) into->block(into, (uint32_t)k, s->particles.index[k / s->equations]);
}

static place place_of_row(const surface *s, const hk_view *view, size_t row, double *scale) {
  unsigned e = (unsigned)(row % s->equations);
  *scale = s->scale[MOST * s->particles.index[row / s->equations] + e];
  return place_of(s, view, row / s->equations, e);
}

static hk_status value(void *self, const hk_view *view, double *g) {
  hk_status status = HK_OK;
  for (size_t row = 0; row < count(self) && status == HK_OK; row++) {
    double scale;
    place p = place_of_row(self, view, row, &scale);
    status = value_at(&p, &g[row]);
    g[row] *= scale;
  }
  return status;
}

static hk_status jacobian(void *self, const hk_view *view, double (*J)[3]) {
  hk_status status = HK_OK;
  for (size_t row = 0; row < count(self) && status == HK_OK; row++) {
    double scale;
    place p = place_of_row(self, view, row, &scale);
    status = gradient_at(&p, J[row]);
    for (int c = 0; c < 3; c++) J[row][c] *= scale;
    if (status == HK_OK && !(hk_length(J[row]) > vanishes)) status = no_direction(&p, HK_FAILED);
  }
  return status;
}

static hk_status curvature(void *self, const hk_view *view, double *c) {
  const surface *s = self;
  hk_status status = HK_OK;
  for (size_t row = 0; row < count(self) && status == HK_OK; row++) {
    double scale;
    place p = place_of_row(s, view, row, &scale);
    status = bend_at(&p, view->v + 3 * (size_t)s->particles.index[row / s->equations], scale, &c[row]);
    c[row] *= scale;
  }
  return status;
}

static hk_status speed(void *self, const hk_view *view, double *gt) {
  hk_status status = HK_OK;
  for (size_t row = 0; row < count(self) && status == HK_OK; row++) {
    double scale;
    place p = place_of_row(self, view, row, &scale);
    hk_script_equation e = script_of(&p);
    gt[row] = 0;
    if (e.g) status = hk_script_speed(&e, &p.at, &gt[row]);
    gt[row] *= scale;
  }
  return status;
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .count = count,
                                         .pattern = pattern,
                                         .value = value,
                                         .jacobian = jacobian,
                                         .curvature = curvature,
                                         .speed = speed};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "surface",
    .summary = "particles on a surface g(t, x) = 0, or on a curve, g = h = 0: a shape, or functions in Lua",
    .reference = "Hairer and Wanner, Solving Ordinary Differential Equations II, VII.1; Witkin, Physically Based "
                 "Modeling: Constrained Dynamics (SIGGRAPH course notes)",
    .instance_size = sizeof(surface),
    .params = params,
    .fields = fields,
    .create = create,
    .constraint = &constraint,
};
