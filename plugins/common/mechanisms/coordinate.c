#include "plugins/common/mechanisms/coordinate.h"
#include "plugins/common/mechanisms/way.h"
#include "plugins/common/shells/hinge.h"
#include "plugins/common/shells/hinge_lane.h"
#include "plugins/kit/vector3.h"

static const double alike = 1e-9; /* relative */

/* Whether two points are apart and two others beside their line, by more than rounding: those of a slider's frame are
 * on one line. */
static bool has_angle(const double *x, const uint32_t point[4]) {
  double d[3][3], normal[2][3], size = 0;
  for (int m = 0; m < 3; m++) {
    hk_subtract(d[m], x + 3 * (size_t)point[m + 1], x + 3 * (size_t)point[0]);
    size = fmax(size, hk_length(d[m]));
  }
  for (int m = 0; m < 2; m++) hk_cross(normal[m], d[0], d[m + 1]);
  double least = alike * size * hk_length(d[0]);
  return hk_length(d[0]) > alike * size && hk_length(normal[0]) > least && hk_length(normal[1]) > least;
}

static hk_status check_turn(const hk_coordinate *q, const hk_view *view, size_t k) {
  const uint32_t *point = hk_tuple(&q->points, k);
  const uint32_t *id = view->model->id;
  if (has_angle(view->x, point)) return HK_OK;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "points: of tuple %zu, particles %u, %u, %u and %u, the first two are in one place, or "
                          "another one is on their line: angles need two points on the axis and two beside it, as "
                          "joint:frame() of a hinge has them; that of a slider has a way: of = \"way\" takes it",
                          k + 1, (unsigned)id[point[0]], (unsigned)id[point[1]], (unsigned)id[point[2]],
                          (unsigned)id[point[3]]);
}

/* The frame of a hinge has two points on its axis and two across it. */
static hk_status check_way(const hk_coordinate *q, const hk_view *view, size_t k) {
  const uint32_t *point = hk_tuple(&q->points, k);
  double apart[3], size;
  hk_subtract(apart, view->x + 3 * (size_t)point[1], view->x + 3 * (size_t)point[0]);
  size = hk_length(apart);
  if (fabs(size - hk_tuple_value(&q->length, k) / 2) > alike * size ||
      fabs(hk_way(view->x, point, hk_tuple_value(&q->length, k))) > alike * size)
    return HK_OK;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "points: tuple %zu is the frame of a hinge, which has an angle and no way: of = \"turn\" "
                          "takes it",
                          k + 1);
}

hk_status hk_coordinate_start(hk_coordinate *q, const hk_view *view) {
  hk_status status = HK_OK;
  bool way = q->kind == HK_COORDINATE_WAY;
  if (way) status = hk_way_lengths(view, &q->points, &q->length);
  for (size_t k = 0; k < q->points.count && status == HK_OK; k++)
    status = way ? check_way(q, view, k) : check_turn(q, view, k);
  return status;
}

double hk_coordinate_value(const hk_coordinate *q, const double *x, size_t k, double near, double (*gradient)[3]) {
  const uint32_t *point = hk_tuple(&q->points, k);
  double angle;
  if (q->kind == HK_COORDINATE_WAY) {
    double l = hk_tuple_value(&q->length, k);
    if (gradient) hk_way_gradient(x, point, l, gradient);
    return hk_way(x, point, l);
  }
  hk_hinge_angle(x, point, &angle, gradient);
  return isnan(near) ? angle : hk_hinge_unwrap(angle, near);
}

void hk_coordinate_hessian(const hk_coordinate *q, const double *x, size_t k, double *H) {
  if (q->kind == HK_COORDINATE_WAY)
    hk_way_hessian(hk_tuple_value(&q->length, k), H);
  else
    hk_hinge_hessian(x, hk_tuple(&q->points, k), H);
}

double hk_coordinate_rate(const hk_coordinate *q, const double *v, size_t k, double (*gradient)[3]) {
  const uint32_t *point = hk_tuple(&q->points, k);
  double sum = 0;
  for (int m = 0; m < 4; m++) sum += hk_dot(gradient[m], v + 3 * (size_t)point[m]);
  return sum;
}

double hk_coordinate_bend(const hk_coordinate *q, const double *x, const double *v, size_t k) {
  const uint32_t *point = hk_tuple(&q->points, k);
  double H[144], sum = 0;
  if (q->kind == HK_COORDINATE_WAY) return hk_way_bend(v, point, hk_tuple_value(&q->length, k));
  hk_hinge_hessian(x, point, H);
  for (size_t r = 0; r < 12; r++)
    for (size_t s = 0; s < 12; s++)
      sum += v[3 * (size_t)point[r / 3] + r % 3] * H[12 * r + s] * v[3 * (size_t)point[s / 3] + s % 3];
  return sum;
}
