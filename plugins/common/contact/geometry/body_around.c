/* See body_around.h. A point is inside where the winding number, the sum of solid angles by 4 pi, is 1 (Jacobson, Kavan
 * and Sorkine-Hornung 2013, "Robust inside-outside segmentation using generalized winding numbers", ACM Trans. Graph.
 * 32, equation 5). */
#include "plugins/common/contact/geometry/body_around.h"
#include "plugins/common/contact/geometry/distance.h"
#include "plugins/common/contact/geometry/solid_angle.h"

static const double inside = 0.75; /* of a winding number: on a face it is a half */

/* The first carrier of the body to which a triangle belongs; UINT32_MAX: to none. */
static uint32_t body_of(const hk_model *m, const uint32_t t[3]) {
  const hk_rider *r = m->pin[t[0]] == HK_PIN_RIDES ? hk_model_rider(m, t[0]) : NULL;
  return r ? r->carrier[0] : UINT32_MAX;
}

/* m, from a point to a triangle. */
static double distance_to(const double *x, const uint32_t t[3], const double p[3]) {
  double pair[12];
  hk_copy(pair, p);
  for (int c = 0; c < 3; c++) hk_copy(pair + 3 + 3 * c, x + 3 * (size_t)t[c]);
  return sqrt(hk_nearest_of_pair(HK_POINT_TRIANGLE, pair).squared);
}

/* angle: of each body at its first carrier, 0 before. */
static void add_angles(const hk_view *view, const double p[3], double *angle) {
  const hk_tuples *triangles = &view->model->triangles;
  for (size_t k = 0; k < triangles->count; k++) {
    const uint32_t *t = hk_tuple(triangles, k), body = body_of(view->model, t);
    if (body != UINT32_MAX) angle[body] += hk_solid_angle(view->x, t, p);
  }
}

/* of: of each body in which p is, at its first carrier. */
static void find_depths(const hk_view *view, const double p[3], const double *angle, hk_body_around *of) {
  const hk_tuples *triangles = &view->model->triangles;
  for (size_t k = 0; k < triangles->count; k++) {
    const uint32_t *t = hk_tuple(triangles, k), body = body_of(view->model, t);
    if (body == UINT32_MAX || !(angle[body] > inside * HK_WHOLE_SOLID_ANGLE)) continue;
    double depth = distance_to(view->x, t, p);
    if (!of[body].found || depth < of[body].depth) of[body] = (hk_body_around){true, t[0], depth};
  }
}

hk_status hk_body_around_find(const hk_view *view, const hk_host *host, const double p[3], hk_body_around *out) {
  double *angle = host->allocate(host, (view->n + 1) * sizeof *angle);
  hk_body_around *of = host->allocate(host, (view->n + 1) * sizeof *of);
  bool room = angle && of;
  *out = (hk_body_around){0};
  if (room) {
    for (size_t i = 0; i < view->n; i++) angle[i] = 0, of[i] = (hk_body_around){0};
    add_angles(view, p, angle);
    find_depths(view, p, angle, of);
    for (size_t i = 0; i < view->n; i++)
      if (of[i].found && of[i].depth > out->depth) *out = of[i];
  }
  host->release(host, angle);
  host->release(host, of);
  return room ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for the bodies round a point");
}
