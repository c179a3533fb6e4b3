/* One contact with Coulomb's friction by its own 3 x 3 matrix G, in which normal and tangential impulses act on each
 * other's speeds: the normal one first, then friction, and so on until neither changes. Friction is what stops the
 * sliding where the cone allows that; else the fixed point of s <- projection of s - r_t/q on the disc of radius mu p,
 * with q at least G's largest tangential eigenvalue, which is s = -mu p r_t/|r_t| (De Saxce and Feng 1998, The
 * bipotential method, section 5). */
#include "plugins/common/contact/bodies/body_contact_law.h"
#include "plugins/kit/vector3.h"

#include <float.h>

enum { ROUNDS = 20 };

static void multiply(double out[3], const double G[9], const double p[3]) {
  for (int c = 0; c < 3; c++) out[c] = hk_dot(G + 3 * c, p);
}

void hk_vectors_across(const double n[3], double a[3], double b[3]) {
  int least = 0;
  for (int c = 1; c < 3; c++)
    if (fabs(n[c]) < fabs(n[least])) least = c;
  double e[3] = {0, 0, 0};
  e[least] = 1;
  hk_cross(a, n, e);
  double length = hk_length(a);
  for (int c = 0; c < 3; c++) a[c] /= length;
  hk_cross(b, n, a);
}

hk_contact_tangent hk_contact_tangent_of(const double G[9], const double n[3]) {
  hk_contact_tangent t;
  double column[3];
  hk_vectors_across(n, t.a, t.b);
  multiply(column, G, t.a);
  t.g[0] = hk_dot(t.a, column);
  t.g[1] = hk_dot(t.b, column);
  multiply(column, G, t.b);
  t.g[2] = hk_dot(t.b, column);
  double middle = (t.g[0] + t.g[2]) / 2, half = (t.g[0] - t.g[2]) / 2;
  t.most = middle + sqrt(half * half + t.g[1] * t.g[1]);
  return t;
}

/* The impulse across n after this round: `slide` before it, r the distance or speed now. */
static void next_slide(const hk_contact_tangent *t, const double slide[3], const double r[3], double limit,
                       double next[3]) {
  double s[2] = {hk_dot(slide, t->a), hk_dot(slide, t->b)}, q[2] = {hk_dot(r, t->a), hk_dot(r, t->b)};
  double det = t->g[0] * t->g[2] - t->g[1] * t->g[1], to[2];
  bool solvable = det > 1e-12 * t->most * t->most;
  if (solvable) {
    to[0] = s[0] - (t->g[2] * q[0] - t->g[1] * q[1]) / det;
    to[1] = s[1] - (t->g[0] * q[1] - t->g[1] * q[0]) / det;
  }
  if (!solvable || !(sqrt(to[0] * to[0] + to[1] * to[1]) <= limit)) {
    for (int k = 0; k < 2; k++) to[k] = s[k] - q[k] / t->most;
    double size = sqrt(to[0] * to[0] + to[1] * to[1]), part = size > limit ? limit / size : 1;
    for (int k = 0; k < 2; k++) to[k] *= part;
  }
  for (int c = 0; c < 3; c++) next[c] = to[0] * t->a[c] + to[1] * t->b[c];
}

void hk_body_contact_solve(const hk_impact *k, hk_impact_level *level, const double G[9], const hk_contact_tangent *t,
                           double mu, const double r[3], double change[3]) {
  const double *n = k->frame.n;
  double now[3], moved[3], step[3], slide[3];
  bool rubs = mu > 0 && t->most > 0;
  hk_copy(now, r);
  for (int round = 0; round < ROUNDS; round++) {
    double push = fmax(0, level->push + (level->target - hk_dot(now, n)) / k->mobility),
           most = fabs(push - level->push);
    for (int c = 0; c < 3; c++) step[c] = (push - level->push) * n[c];
    level->push = push;
    multiply(moved, G, step);
    hk_add_scaled(now, 1, moved);
    hk_add_scaled(change, 1, step);
    if (!rubs) return;
    next_slide(t, level->slide, now, mu * push, slide);
    hk_subtract(step, slide, level->slide);
    hk_copy(level->slide, slide);
    multiply(moved, G, step);
    hk_add_scaled(now, 1, moved);
    hk_add_scaled(change, 1, step);
    most = fmax(most, hk_length(step));
    if (most <= 4 * DBL_EPSILON * (push + hk_length(slide))) return;
  }
}
