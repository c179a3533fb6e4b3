/* Cubic Hermite interpolation. The velocity at a row is that of the parabola through it and its two neighbours, as in
 * Catmull, Rom 1974 for rows at any times; at the first and the last it is 0, so that the camera sets off and comes to
 * rest without a jerk. */
#include "plugins/common/camera/keyframes.h"

#include <string.h>

enum { ROW = HK_KEYFRAME };

hk_status hk_keyframes_check(const hk_host *host, const char *name, const hk_numbers *rows) {
  if (rows->count % ROW != 0)
    return host->fail(host, HK_BAD_PARAM,
                      "%s: expected t, x, y, z of the camera and x, y, z of what it looks at for each", name);
  for (size_t k = 0; k < rows->count / ROW; k++) {
    const double *row = rows->value + ROW * k;
    if (k > 0 && !(row[0] > row[-ROW]))
      return host->fail(host, HK_BAD_PARAM, "%s: t = %g s of row %zu is not after %g s", name, row[0], k + 1,
                        row[-ROW]);
    if (memcmp(row + 1, row + 4, 3 * sizeof *row) == 0)
      return host->fail(host, HK_BAD_PARAM, "%s: in row %zu the camera stands where it looks at", name, k + 1);
  }
  return HK_OK;
}

/* Of number c at row k. */
static double velocity(const hk_numbers *rows, size_t k, size_t c) {
  const double *at = rows->value + ROW * k;
  if (k == 0 || k + 1 == rows->count / ROW) return 0;
  double before = at[0] - at[-ROW], after = at[ROW] - at[0];
  double left = (at[c] - at[(ptrdiff_t)c - ROW]) / before, right = (at[ROW + c] - at[c]) / after;
  return (after * left + before * right) / (before + after);
}

static double between(const hk_numbers *rows, size_t k, size_t c, double t) {
  const double *a = rows->value + ROW * k, *b = a + ROW;
  double h = b[0] - a[0], s = (t - a[0]) / h, r = 1 - s;
  return r * r * (1 + 2 * s) * a[c] + s * s * (1 + 2 * r) * b[c] +
         h * s * r * (r * velocity(rows, k, c) - s * velocity(rows, k + 1, c));
}

void hk_keyframes_at(const hk_numbers *rows, double t, double from[3], double look_at[3]) {
  size_t last = rows->count / ROW - 1, k = 0;
  while (k < last && rows->value[ROW * (k + 1)] <= t) k++;
  for (size_t c = 0; c < 6; c++) {
    bool rests = k == last || t <= rows->value[0];
    double at = rests ? rows->value[ROW * k + 1 + c] : between(rows, k, 1 + c, t);
    (c < 3 ? from : look_at)[c % 3] = at;
  }
}
