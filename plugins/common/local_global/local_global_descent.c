/* What the iteration minimises, g, and that it does not rise: corrections are replaced or halved. */
#include "plugins/common/local_global/local_global.h"

#include <float.h>
#include <string.h>

void hk_local_global_place(hk_local_global *m, const hk_system *s) {
  for (size_t e = 0; e < 3 * s->n; e++) m->next[e] = s->X[e] + m->d[e];
  hk_element_energy_evaluate(&m->elements, m->host, m->next);
}

/* The rounding error of g: that of a sum of 3n squares, and that of x, with the sensitivity `slope` of g to x. */
static double noise_of(const hk_local_global *m, size_t n, double g, double slope) {
  double far = 0;
  for (size_t e = 0; e < 3 * n; e++) far = fmax(far, fabs(m->next[e]));
  return DBL_EPSILON * ((16 + sqrt(3 * (double)n)) * g + slope * far);
}

double hk_local_global_objective(const hk_local_global *m, const hk_system *s, double h, double *noise) {
  const double *x = m->next;
  double inertia = 0, springs = 0, dampers = 0, pull = 0;
  *noise = 0;
  for (size_t i = 0; i < s->n; i++)
    for (size_t e = 3 * i; s->model->inverse_mass[i] > 0 && e < 3 * i + 3; e++)
      inertia += s->model->mass[i] * (m->d[e] - m->y[e]) * (m->d[e] - m->y[e]);
  for (size_t e = 0; e < m->edges.count; e++) {
    size_t i = 3 * (size_t)m->edges.pair[e][0], j = 3 * (size_t)m->edges.pair[e][1];
    double l2 = 0, l02 = 0, along = 0;
    for (size_t c = 0; c < 3; c++) {
      double d = x[j + c] - x[i + c], d0 = s->X[j + c] - s->X[i + c];
      l2 += d * d;
      l02 += d0 * d0;
      along += d0 * (d - d0);
    }
    double stretch = sqrt(l2) - m->edges.rest[e];
    springs += m->edges.stiffness[e] * stretch * stretch;
    pull += m->edges.stiffness[e] * fabs(stretch);
    if (l02 > 0) dampers += m->edges.damping[e] * along * along / l02;
  }
  double g = inertia / 2 + h * (h * springs + dampers) / 2;
  if (m->elements.tuples.count == 0) return g;
  double slope = 2 * h * h * pull;
  g += hk_element_energy_value(&m->elements, m->d, h, &slope);
  *noise = noise_of(m, s->n, g, slope);
  return g;
}

/* Moves to `from` + part dx; returns g there. */
static double try_part(hk_local_global *m, const hk_system *s, double h, double part, double *noise) {
  for (size_t e = 0; e < 3 * s->n; e++) m->d[e] = m->from[e] + part * m->dx[e];
  hk_local_global_place(m, s);
  return hk_local_global_objective(m, s, h, noise);
}

double hk_local_global_shorten(hk_local_global *m, const hk_system *s, double h, double g, double now, double *noise) {
  const double shortest = 0x1p-30;
  double kept = *noise;
  for (double part = 0.5; !(now <= g + kept + *noise); part /= 2) {
    now = try_part(m, s, h, part >= shortest ? part : 0, noise);
    m->soft |= part < 0.5;
    if (part < shortest) break;
  }
  return now;
}

void hk_local_global_safeguard(hk_local_global *m, const hk_system *s, double h, double *g) {
  bool elements = m->elements.tuples.count > 0;
  double noise, now = hk_local_global_objective(m, s, h, &noise);
  if (m->acceleration == HK_LOCAL_GLOBAL_ANDERSON && now > *g + noise) {
    memcpy(m->d, m->anderson.g_last, 3 * s->n * sizeof *m->d);
    hk_local_global_place(m, s);
    hk_anderson_clear(&m->anderson);
    now = hk_local_global_objective(m, s, h, &noise);
  }
  *g = elements && *g < INFINITY ? hk_local_global_shorten(m, s, h, *g, now, &noise) : now;
}

void hk_local_global_choose_start(hk_local_global *m, const hk_system *s, double h) {
  double noise, flight;
  hk_local_global_place(m, s);
  flight = hk_local_global_objective(m, s, h, &noise);
  for (size_t e = 0; e < 3 * s->n; e++)
    if (m->edges.pin[e / 3] != HK_PIN_PATH) m->d[e] = 0;
  hk_local_global_place(m, s);
  if (hk_local_global_objective(m, s, h, &noise) < flight) return;
  memcpy(m->d, m->y, 3 * s->n * sizeof *m->d);
}
