#include "plugins/common/obstacles/parabola.h"
#include "plugins/kit/vector3.h"

#include <float.h>

enum { STEPS = 200, HALVINGS = 100 };

/* What is thinner than this part of a shape that is not convex may be passed. */
static const double thinnest = 1e-4;

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
  double radius, tolerance, fastest; /* m, m, m/s */
  double w[3], n[3];                 /* at the point looked at last */
} search;

static double gap_at(search *s, double t) {
  double p[3];
  hk_parabola_at(s->path, t, p, s->w);
  return hk_shape_distance(s->shape, p, s->n) - s->radius;
}

/* Between a time before the surface and one behind it. */
static double crossing(search *s, double before, double behind) {
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

/* The end of the first piece of the way from `a` to `b` that ends inside, with the gaps there; INFINITY: none. A
 * distance does not change by more than the way, so a piece whose gaps are larger together is clear; others are halved.
 */
static double first_inside(search *s, double a, double gap_a, double b, double gap_b) {
  double way = s->fastest * (b - a);
  if (gap_a + gap_b > way) return INFINITY;
  if (way < thinnest * hk_shape_size(s->shape)) return gap_b < -s->tolerance ? b : INFINITY;
  double middle = a + (b - a) / 2, gap = gap_at(s, middle), first = first_inside(s, a, gap_a, middle, gap);
  return first < INFINITY ? first : gap < -s->tolerance ? middle : first_inside(s, middle, gap, b, gap_b);
}

static double contact_by_halving(search *s, double gap) {
  double span = s->path->span, inside = first_inside(s, 0, gap, span, gap_at(s, span));
  if (!(inside < INFINITY)) return INFINITY;
  double a = fmax(0, inside - thinnest * hk_shape_size(s->shape) / s->fastest);
  if (!(gap_at(s, a) > s->tolerance)) a = outside_after(s, a, (inside - a) / 2);
  return crossing(s, a, inside);
}

static double contact_by_tangents(search *s, double gap) {
  const hk_parabola *path = s->path;
  double t = 0;
  for (int k = 0; k < STEPS; k++) {
    if (k && gap <= s->tolerance && hk_parabola_closes(path, s->w, s->n)) return t;
    double slope = hk_dot(s->w, s->n), bend = hk_dot(path->a, s->n) / 2;
    double step = first_root(fmax(gap, 0), gap > s->tolerance ? slope : fabs(slope), bend);
    double next = fmin(t + step, path->span);
    if (!(next > t)) return t + step <= path->span ? t : INFINITY;
    gap = gap_at(s, next);
    if (next == path->span) return gap <= s->tolerance && hk_parabola_closes(path, s->w, s->n) ? next : INFINITY;
    t = next;
  }
  return t;
}

static double fastest(const hk_parabola *path) { return hk_length(path->w) + hk_length(path->a) * path->span; }

double hk_parabola_contact(const hk_parabola *path, const hk_shape *shape, double radius, double tolerance) {
  search s = {path, shape, radius, tolerance, fastest(path), {0}, {0}};
  double gap = gap_at(&s, 0);
  if (gap <= tolerance && hk_parabola_closes(path, s.w, s.n)) return 0;
  return hk_shape_is_convex(shape) ? contact_by_tangents(&s, gap) : contact_by_halving(&s, gap);
}
