#include "plugins/common/mechanisms/way.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* q - p of rows of x. */
static void between(const double *x, uint32_t p, uint32_t q, double to[3]) {
  hk_subtract(to, x + 3 * (size_t)q, x + 3 * (size_t)p);
}

double hk_way(const double *x, const uint32_t point[4], double l) {
  double far[3], along[3];
  between(x, point[0], point[1], far);
  between(x, point[2], point[3], along);
  return hk_dot(far, along) / l;
}

double hk_way_rate(const double *x, const double *v, const uint32_t point[4], double l) {
  double far[3], along[3], speed[3], turn[3];
  between(x, point[0], point[1], far);
  between(x, point[2], point[3], along);
  between(v, point[0], point[1], speed);
  between(v, point[2], point[3], turn);
  return (hk_dot(speed, along) + hk_dot(far, turn)) / l;
}

double hk_way_bend(const double *v, const uint32_t point[4], double l) { return 2 * hk_way(v, point, l); }

void hk_way_gradient(const double *x, const uint32_t point[4], double l, double gradient[4][3]) {
  double far[3], along[3];
  between(x, point[0], point[1], far);
  between(x, point[2], point[3], along);
  for (int c = 0; c < 3; c++) {
    gradient[1][c] = along[c] / l, gradient[0][c] = -gradient[1][c];
    gradient[3][c] = far[c] / l, gradient[2][c] = -gradient[3][c];
  }
}

void hk_way_hessian(double l, double *H) {
  static const double sign[4] = {-1, 1, -1, 1};
  memset(H, 0, 144 * sizeof *H);
  for (size_t p = 0; p < 2; p++)
    for (size_t q = 2; q < 4; q++)
      for (size_t c = 0; c < 3; c++)
        H[12 * (3 * p + c) + 3 * q + c] = H[12 * (3 * q + c) + 3 * p + c] = sign[p] * sign[q] / l;
}

hk_status hk_way_lengths(const hk_view *view, const hk_tuples *points, hk_per_tuple *l) {
  const hk_host *host = view->host;
  if (l->count) return HK_OK;
  double *start = host->allocate(host, (points->count + 1) * sizeof *start);
  if (!start) return host->fail(host, HK_NO_MEMORY, "no memory for %zu ways", points->count);
  for (size_t k = 0; k < points->count; k++) {
    double along[3];
    const uint32_t *point = hk_tuple(points, k);
    between(view->x, point[2], point[3], along);
    start[k] = hk_length(along);
    if (!(start[k] > 0))
      return host->fail(host, HK_BAD_PARAM,
                        "points: the third and fourth of tuple %zu, particles %u and %u, start in one place: their "
                        "way has no direction, name two points apart",
                        k + 1, (unsigned)view->model->id[point[2]], (unsigned)view->model->id[point[3]]);
  }
  *l = (hk_per_tuple){points->count, start};
  return HK_OK;
}
