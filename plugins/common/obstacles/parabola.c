#include "plugins/common/obstacles/parabola.h"
#include "plugins/common/space/vector3.h"

#include <float.h>

enum { STEPS = 200, HALVINGS = 100 };

/* Inside a hollow shape the nearest wall does not tell of the others: no step is longer than this part of its size. */
static const double farthest_look = 0.125;

void hk_parabola_at(const hk_parabola *path, double t, double p[3], double w[3]) {
  for (int c = 0; c < 3; c++) {
    p[c] = path->p[c] + t * (path->w[c] + t / 2 * path->a[c]);
    w[c] = path->w[c] + t * path->a[c];
  }
}

/* Rounding of speeds is no motion: some units in the last place of the largest speed on the way. */
bool hk_parabola_closes(const hk_parabola *path, const double w[3], const double n[3]) {
  double pull = hk_length(path->a), least = 16 * DBL_EPSILON * (hk_length(path->w) + pull * path->span);
  double closing = hk_dot(w, n);
  return closing < -least || (closing <= least && hk_dot(path->a, n) < -1e-9 * pull);
}

/* The smallest t > 0 with g + b t + c t^2 = 0 for g >= 0, in the form that loses no digits; INFINITY: none. */
static double first_root(double g, double b, double c) {
  double square = b * b - 4 * c * g;
  if (!(square >= 0)) return INFINITY;
  double root = sqrt(square);
  if (b > 0) return c < 0 ? (b + root) / (-2 * c) : INFINITY;
  return root - b > 0 ? 2 * g / (root - b) : INFINITY;
}

typedef struct search {
  const hk_parabola *path;
  const hk_shape *shape;
  double radius, tolerance;
  double w[3], n[3]; /* at the point looked at last */
} search;

static double gap_at(search *s, double t) {
  double p[3];
  hk_parabola_at(s->path, t, p, s->w);
  return hk_shape_distance(s->shape, p, s->n) - s->radius;
}

/* Between a time before the surface and one behind it. */
static double meeting(search *s, double before, double behind) {
  for (int k = 0; k < HALVINGS; k++) {
    double middle = before + (behind - before) / 2;
    if (!(middle > before && middle < behind)) break;
    double gap = gap_at(s, middle);
    if (gap > s->tolerance)
      before = middle;
    else
      behind = middle;
    if (fabs(gap) <= s->tolerance) break;
  }
  gap_at(s, behind);
  return behind;
}

/* After leaving the surface at t: the largest part of the step that ends outside, so that a root can be told from the
 * start. */
static double outside_after(search *s, double t, double step) {
  for (int k = 0; k < HALVINGS && step > 0; k++, step /= 2)
    if (gap_at(s, t + step) > s->tolerance) return t + step;
  return t;
}

static double fastest(const hk_parabola *path) { return hk_length(path->w) + hk_length(path->a) * path->span; }

double hk_parabola_contact(const hk_parabola *path, const hk_shape *shape, double radius, double tolerance) {
  search s = {path, shape, radius, tolerance, {0}, {0}};
  double t = 0, gap = gap_at(&s, 0);
  for (int k = 0; k < STEPS; k++) {
    if (gap <= tolerance && hk_parabola_closes(path, s.w, s.n)) return t;
    double slope = hk_dot(s.w, s.n),
           step = first_root(fmax(gap, 0), gap > tolerance ? slope : fabs(slope), hk_dot(path->a, s.n) / 2);
    if (!hk_shape_is_convex(shape)) step = fmin(step, farthest_look * hk_shape_size(shape) / fastest(path));
    double next = fmin(t + step, path->span);
    if (!(next > t)) return t + step <= path->span ? t : INFINITY;
    double there = gap_at(&s, next);
    if (there < -tolerance) {
      double from = gap > tolerance ? t : outside_after(&s, t, (next - t) / 2);
      return meeting(&s, from, next);
    }
    if (next == path->span) return there <= tolerance && hk_parabola_closes(path, s.w, s.n) ? next : INFINITY;
    t = next;
    gap = there;
  }
  return t;
}
