/* Attitude and motion of a body from its particles. Its principal axes are d_k = sum m_i q_ik (x_i - c) / (m a_k^2),
 * unit vectors across each other as long as the distances hold; the spin is I^-1 L, with the angular momentum L of the
 * particles about the centre, so that spin, energy and momenta agree. */
#include "core/scene/rigid/rigid.h"

#include <math.h>

static void cross(const double a[3], const double b[3], double to[3]) {
  to[0] = a[1] * b[2] - a[2] * b[1];
  to[1] = a[2] * b[0] - a[0] * b[2];
  to[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* d[1] and d[2] of a rod: `axes`, the principal axes at the start, turned the shortest way from axes[0] to d[0]. */
static void complete_rod(double axes[3][3], double d[3][3]) {
  double w[3], s = 1 + dot(axes[0], d[0]);
  cross(axes[0], d[0], w);
  for (int k = 1; k < 3; k++) {
    double turned[3], again[3];
    cross(w, axes[k], turned);
    cross(w, turned, again);
    /* exp of the turn, with (1 - cos)/sin^2 = 1/(1 + cos); the other way round, about axes[1] */
    for (int c = 0; c < 3; c++)
      d[k][c] = s > 1e-12 ? axes[k][c] + turned[c] + again[c] / s : (k == 1 ? 1 : -1) * axes[k][c];
  }
}

static void find_directions(const hk_rigid_body *b, const double *x, const double center[3], double d[3][3]) {
  for (int k = 0; k < 3; k++)
    for (size_t c = 0; c < 3; c++) {
      d[k][c] = 0;
      for (size_t i = 0; i < b->count && k < b->dimensions; i++)
        d[k][c] += b->q[i][k] * (x[3 * i + c] - center[c]) / ((double)b->count * b->a[k] * b->a[k]);
    }
  if (b->dimensions == 2) cross(d[0], d[1], d[2]);
  if (b->dimensions != 1) return;
  double axes[3][3];
  for (int p = 0; p < 9; p++) axes[p % 3][p / 3] = b->axes[p];
  complete_rod(axes, d);
}

static void find_momenta(const hk_rigid_body *b, const double *x, const double *v, hk_rigid_motion *m) {
  double each = b->mass / (double)b->count;
  for (size_t i = 0; i < b->count; i++) {
    double r[3], u[3], l[3];
    for (size_t c = 0; c < 3; c++) r[c] = x[3 * i + c] - m->center[c], u[c] = v[3 * i + c] - m->velocity[c];
    cross(r, u, l);
    for (int c = 0; c < 3; c++) m->angular_momentum[c] += each * l[c];
    m->energy += each / 2 * dot(v + 3 * i, v + 3 * i);
  }
  for (int c = 0; c < 3; c++) m->momentum[c] = b->mass * m->velocity[c];
}

hk_rigid_motion hk_rigid_motion_of(const hk_rigid_body *b, const double *x, const double *v) {
  hk_rigid_motion m = {0};
  double d[3][3];
  for (size_t i = 0; i < b->count; i++)
    for (size_t c = 0; c < 3; c++) {
      m.center[c] += x[3 * i + c] / (double)b->count;
      m.velocity[c] += v[3 * i + c] / (double)b->count;
    }
  find_directions(b, x, m.center, d);
  find_momenta(b, x, v, &m);
  for (int k = 0; k < 3; k++) {
    double inertia = hk_rigid_body_inertia(b, k), along = inertia > 0 ? dot(d[k], m.angular_momentum) / inertia : 0;
    for (int c = 0; c < 3; c++) {
      m.spin[c] += along * d[k][c];
      for (int e = 0; e < 3; e++) m.attitude[3 * c + e] += d[k][c] * b->axes[3 * e + k];
    }
  }
  return m;
}
