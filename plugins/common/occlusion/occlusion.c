#include "plugins/common/occlusion/occlusion.h"

#include <math.h>

enum { MOST_TESTS = 1 << 20 }; /* lines times triangles of one thing: some 10 ms */

void hk_sight_add(hk_sight *s, const float x[3]) {
  if (s->points == HK_SIGHT_POINTS || !isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2])) return;
  for (int c = 0; c < 3; c++) s->point[s->points][c] = x[c];
  s->hidden[s->points++] = false;
}

static void subtract(const float a[3], const float b[3], float out[3]) {
  for (int c = 0; c < 3; c++) out[c] = a[c] - b[c];
}

static void cross(const float a[3], const float b[3], float out[3]) {
  for (int c = 0; c < 3; c++) out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Whether the segment meets the triangle from its front; not in its last thousandth, where what lies on the triangle
 * is. */
static bool meets(const float from[3], const float way[3], const float a[3], const float b[3], const float c[3]) {
  float u[3], v[3], p[3], q[3], t[3];
  subtract(b, a, u), subtract(c, a, v);
  cross(way, v, p);
  float det = dot(u, p); /* above 0: the way enters by the front */
  if (!(det > 0)) return false;
  subtract(from, a, t);
  float first = dot(t, p);
  if (first < 0 || first > det) return false;
  cross(t, u, q);
  float second = dot(way, q), along = dot(v, q);
  return second >= 0 && first + second <= det && along > 0 && along < 0.999f * det;
}

static const float *corner(const void *vertex, size_t stride, uint32_t k) {
  return (const float *)((const char *)vertex + stride * k);
}

static bool is_hidden(const hk_sight *s, const float point[3], const void *vertex, size_t stride,
                      const uint32_t (*triangle)[3], size_t triangles) {
  float way[3];
  subtract(point, s->eye, way);
  for (size_t k = 0; k < triangles; k++) {
    const uint32_t *t = triangle[k];
    if (meets(s->eye, way, corner(vertex, stride, t[0]), corner(vertex, stride, t[1]), corner(vertex, stride, t[2])))
      return true;
  }
  return false;
}

double hk_sight_hidden_by(hk_sight *s, const void *vertex, size_t stride, const uint32_t (*triangle)[3],
                          size_t triangles) {
  size_t every = 1, tried = 0, hidden = 0;
  while (s->points / every * triangles > MOST_TESTS && s->points / every > 16) every++;
  for (size_t i = 0; i < s->points; i += every) {
    bool is = is_hidden(s, s->point[i], vertex, stride, triangle, triangles);
    tried++, hidden += is;
    for (size_t k = i; is && k < i + every && k < s->points; k++) s->hidden[k] = true;
  }
  return tried ? (double)hidden / (double)tried : 0;
}

bool hk_sight_may_meet(const hk_sight *s, const double middle[3], double radius) {
  for (size_t i = 0; i < s->points; i++) {
    double way[3], from[3], square = 0, along = 0, off = 0;
    for (int c = 0; c < 3; c++) {
      way[c] = (double)(s->point[i][c] - s->eye[c]), from[c] = middle[c] - (double)s->eye[c];
      square += way[c] * way[c], along += way[c] * from[c];
    }
    double at = square > 0 ? fmin(fmax(along / square, 0), 1) : 0;
    for (int c = 0; c < 3; c++) off += pow(from[c] - at * way[c], 2);
    if (off <= radius * radius) return true;
  }
  return false;
}

static double smooth(double from, double to, double x) {
  double t = fmin(fmax((x - from) / (to - from), 0), 1);
  return t * t * (3 - 2 * t);
}

double hk_sight_opacity(const hk_sight *s, double share) {
  size_t hidden = 0;
  for (size_t i = 0; i < s->points; i++) hidden += s->hidden[i];
  double all = s->points ? (double)hidden / (double)s->points : 0;
  return 1 - 0.82 * smooth(0.5, 0.75, all) * fmin(share / 0.1, 1);
}
