/* See impact.h. A gap that is closed at the start of a step, as where surfaces start nearer than their thickness, opens
 * by half of what is missing in each step, without a velocity. */
#include "plugins/common/contact/impulses/impact.h"

#include "plugins/kit/vector3.h"

static void weigh(double out[3], const hk_impact *k, const double *y) {
  for (int c = 0; c < 3; c++) out[c] = 0;
  for (int i = 0; i < 4; i++) hk_add_scaled(out, k->frame.w[i], y + 3 * (size_t)k->pair.vertex[i]);
}

/* The part of the step at which the gap closes: the root of c + b s + (c_1 - c - b) s^2 in (0, 1], of which there is
 * one where c > 0 > c_1. */
static double closing_time(double c, double b, double c_1) {
  if (!(c > 0)) return 0;
  double a = c_1 - c - b, root = sqrt(fmax(0, b * b - 4 * a * c));
  double s = b < 0 ? 2 * c / (root - b) : -(b + root) / (2 * a);
  return s < 1 ? s : 1;
}

void hk_impact_set(hk_impact *k, const hk_step_move *m, double restitution, bool again) {
  double from[3], to[3], v_from[3], v_to[3], offset = k->pair.offset;
  const double *n = k->frame.n, *w = k->frame.w;
  k->place = k->speed = (hk_impact_level){.target = 0};
  k->part = 1;
  k->plastic = 0;
  k->speed_then = 0;
  k->mobility = 0;
  for (int i = 0; i < 4; i++) k->mobility += w[i] * w[i] * m->inverse_mass[k->pair.vertex[i]];
  weigh(from, k, m->x_from);
  weigh(to, k, m->x);
  weigh(v_from, k, m->v_from);
  weigh(v_to, k, m->v);
  k->motion = hk_length(v_from);
  k->rested = false;
  double c_0 = hk_dot(n, from) - offset, c_1 = hk_dot(n, to) - offset;
  double u_0 = hk_dot(n, v_from), u_1 = hk_dot(n, v_to);
  double s = c_1 < 0 ? closing_time(c_0, m->h * u_0, c_1) : 1, gap = fmin(0, k->pair.gap) / 2;
  if (c_1 < 0 && !again) {
    double u = fmin(0, u_0 + s * (u_1 - u_0)), turned = (1 + restitution) * u;
    gap = fmax(gap, c_1 - turned * (1 - s) * m->h);
    k->speed.target = fmax(0, u_1 - turned);
    k->plastic = fmax(0, u_1 - u);
    k->part = s;
    k->speed_then = u < -fabs(u_1 - u_0) ? u : 0;
    if (c_0 > offset) k->speed_then = fmin(u, (c_1 - c_0) / m->h); /* however much a body's turn changes it */
  }
  for (int c = 0; c < 3; c++) k->place.origin[c] = from[c] + s * (to[c] - from[c]);
  k->place.target = offset - hk_dot(n, k->place.origin) + gap;
}

bool hk_impact_last(hk_impact *k, const hk_step_move *m, double near) {
  const double *n = k->frame.n;
  double from[3], to[3], offset = k->pair.offset;
  weigh(from, k, m->x_from);
  weigh(to, k, m->x);
  bool closes = -k->speed_then * m->h > near;
  if (closes || hk_dot(n, from) - offset > near || hk_dot(n, to) - offset > near) return false;
  k->place.target += hk_dot(n, k->place.origin) - hk_dot(n, from);
  hk_copy(k->place.origin, from);
  return true;
}

void hk_impact_add_forces(const hk_impact *impact, size_t count, double h, double *F) {
  for (const hk_impact *k = impact; k < impact + count; k++)
    for (int i = 0; i < 4; i++)
      for (size_t c = 0; c < 3 && k->frame.w[i] != 0; c++)
        F[3 * k->pair.vertex[i] + c] += k->frame.w[i] / h * (k->speed.push * k->frame.n[c] + k->speed.slide[c]);
}
