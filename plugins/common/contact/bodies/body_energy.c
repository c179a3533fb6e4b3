/* Newton's restitution with Coulomb's friction may give energy to a body whose tangential speed turns round in the
 * impact (Kane and Levinson 1985, Dynamics, theory and applications, section 5.11), and without friction where one
 * impact of a body stops what leaves by another. Of the solutions with the given restitution and with none, both keep
 * the equations and their impulses lie in Coulomb's cone; so do all mixtures of them, as both are convex. Without
 * restitution energy is never made (Moreau 1988), so there is a mixture that keeps it: impacts with the largest part of
 * the restitution for which the kinetic energy does not grow. */
#include "plugins/common/contact/bodies/body_energy.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* Of the kinetic energy; `left` by solutions of what keeps it, without friction and with e = 1. */
static const double rounding = 1e-13, left = 1e-9;

/* J: a . M b / 2 of two sets of velocities. */
static double product(const hk_body_impacts *s, const hk_step_move *m, const double *a, const double *b) {
  double sum = 0;
  for (size_t i = 0; i < s->n; i++)
    if (m->inverse_mass[i] > 0) sum += hk_dot(a + 3 * i, b + 3 * i) / (2 * m->inverse_mass[i]);
  return sum;
}

bool hk_body_energy_grew(const hk_body_impacts *s, const hk_contact_solver *solver, const hk_step_move *m) {
  bool rubs = false, bounces = false;
  for (size_t e = 0; e < s->contacts && s->keeps_energy; e++) {
    const hk_impact *k = &solver->impact[e];
    if (!(k->speed.push > 0)) continue;
    rubs |= hk_body_friction(s, solver, e) > 0;
    bounces |= k->speed.target > k->plastic;
  }
  if (!bounces) return false;
  double was = product(s, m, s->before, s->before);
  return product(s, m, m->v, m->v) > (1 + (rubs ? rounding : left)) * was;
}

void hk_body_energy_restart(hk_body_impacts *s, hk_contact_solver *solver, hk_step_move *m) {
  memcpy(s->before + 3 * s->n, m->v, 3 * s->n * sizeof *m->v);
  memcpy(m->v, s->before, 3 * s->n * sizeof *m->v);
  for (size_t e = 0; e < solver->count; e++) {
    hk_impact *k = &solver->impact[e];
    if (e < s->contacts) k->speed.target = k->plastic;
    k->speed.push = 0;
    if (hk_body_moments_of(s, e)) memset(s->moments[e].moment[true], 0, sizeof s->moments[e].moment[true]);
    memset(k->speed.slide, 0, sizeof k->speed.slide);
    k->speed.solved = 0;
  }
}

/* The root in [0, 1] of the energy of v + part d, less the energy before: a quadratic that is not above 0 at 0 and
 * above 0 at 1. */
void hk_body_energy_blend(hk_body_impacts *s, hk_step_move *m) {
  double *d = s->before + 3 * s->n;
  for (size_t c = 0; c < 3 * s->n; c++) d[c] -= m->v[c];
  double c = product(s, m, m->v, m->v) - product(s, m, s->before, s->before), b = 2 * product(s, m, m->v, d),
         a = product(s, m, d, d), root = sqrt(fmax(0, b * b - 4 * a * c));
  double part = b > 0 ? -2 * c / (b + root) : (root - b) / (2 * a);
  part = part > 0 ? fmin(part, 1) : 0;
  for (size_t i = 0; i < 3 * s->n; i++) m->v[i] += part * d[i];
}
