/* Differences of order 4 of a function of the script: first ones have the error d^4/30 of the fifth derivative and the
 * rounding eps/d, second ones d^4/90 of the sixth and 5 eps/d^2. Over 1e-3 and 6e-3 of `length` they are right to some
 * 1e-12 and 1e-10 where the function changes over that length. Second ones are taken along (1, v), in time and space at
 * once. How fast a function changes with time is not known, so their steps shrink until two agree. */
#include "plugins/common/implicit/script_equation.h"
#include "plugins/kit/vector3.h"

static const double first = 1e-3, second = 6e-3, /* of the length */
    instant = 2e-5,                              /* s, of first differences in time */
    longest = 1e-2, shortest = 1e-6,             /* s, of second ones */
    agreed = 1e-4,                               /* of second ones: the shorter has 1/256 of the longer one's error */
    rounding = 1e-14;                            /* of a sum of some products */

static hk_status call(const hk_script_equation *e, const hk_function *f, const hk_event *p, double *out, size_t count) {
  const double in[] = {p->t, p->x[0], p->x[1], p->x[2], p->id};
  return e->host->call(e->host, f, in, 5, out, count);
}

static hk_event moved(const hk_event *p, double in_time, double s, const double v[3]) {
  hk_event there = *p;
  there.t += in_time;
  hk_add_scaled(there.x, s, v);
  return there;
}

/* g on both sides, at x + s v and t + s `in_time`, and at -s. */
static hk_status both_sides(const hk_script_equation *e, const hk_event *p, double in_time, const double v[3], double s,
                            double g[2]) {
  hk_event ahead = moved(p, s * in_time, s, v), behind = moved(p, -s * in_time, -s, v);
  hk_status status = call(e, e->g, &ahead, &g[0], 1);
  return status == HK_OK ? call(e, e->g, &behind, &g[1], 1) : status;
}

/* dg/ds by steps of h, (8 (g(h) - g(-h)) - (g(2h) - g(-2h)))/(12 h): exactly 0 where g does not change. */
static hk_status slope_along(const hk_script_equation *e, const hk_event *p, double in_time, const double v[3],
                             double h, double *result) {
  double near[2] = {0}, far[2] = {0};
  hk_status status = both_sides(e, p, in_time, v, h, near);
  if (status == HK_OK) status = both_sides(e, p, in_time, v, 2 * h, far);
  *result = (8 * (near[0] - near[1]) - (far[0] - far[1])) / (12 * h);
  return status;
}

/* d^2 g/ds^2 at x + s v, t + s, (16 (g(h) + g(-h)) - (g(2h) + g(-2h)) - 30 g(0))/(12 h^2); `here` is g(0). */
static hk_status bend_along(const hk_script_equation *e, const hk_event *p, const double v[3], double here, double h,
                            double *result) {
  double near[2] = {0}, far[2] = {0};
  hk_status status = both_sides(e, p, 1, v, h, near);
  if (status == HK_OK) status = both_sides(e, p, 1, v, 2 * h, far);
  *result = (16 * (near[0] + near[1]) - (far[0] + far[1]) - 30 * here) / (12 * h * h);
  return status;
}

hk_status hk_script_value(const hk_script_equation *e, const hk_event *p, double *g) { return call(e, e->g, p, g, 1); }

hk_status hk_script_differences(const hk_script_equation *e, const hk_event *p, double n[3]) {
  static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  hk_status status = HK_OK;
  for (int c = 0; c < 3 && status == HK_OK; c++) status = slope_along(e, p, 0, axes[c], first * e->length, &n[c]);
  return status;
}

hk_status hk_script_gradient(const hk_script_equation *e, const hk_event *p, double n[3]) {
  return e->gradient ? call(e, e->gradient, p, n, 3) : hk_script_differences(e, p, n);
}

hk_status hk_script_speed(const hk_script_equation *e, const hk_event *p, double *gt) {
  static const double still[3];
  return slope_along(e, p, 1, still, instant, gt);
}

hk_status hk_script_curvature(const hk_script_equation *e, const hk_event *p, const double v[3], double size,
                              double *c) {
  double here, last, speed = hk_length(v), h = longest;
  if (h * speed > second * e->length) h = second * e->length / speed;
  hk_status status = call(e, e->g, p, &here, 1);
  if (status == HK_OK) status = bend_along(e, p, v, here, h, c);
  for (bool settled = false; !settled && h > shortest && status == HK_OK;) {
    h /= 4;
    last = *c;
    status = bend_along(e, p, v, here, h, c);
    settled = fabs(*c - last) <= agreed * fabs(*c) + rounding * size / (h * h);
  }
  return status;
}
