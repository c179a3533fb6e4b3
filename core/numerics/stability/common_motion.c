/* Damping and turning of particles that all have the same velocity: elements between them then exert no damping force,
 * and what remains is a 3x3 block for each particle. Its symmetric part is what drag does to it, its skew part turns
 * its velocity (v x B, Coriolis).
 *
 * The skew part of D is that of these blocks where nothing else turns velocities. Two random vectors tell: p.Dq - q.Dp
 * = 2 p.Aq. The drag and lift of air on triangles, say, couple a triangle's corners. */
#include "core/numerics/stability/common_motion.h"
#include "core/numerics/stability/lanczos.h"
#include "core/numerics/stability/stiffness.h"

/* Largest skew part of D besides that of single particles, relative to it. */
static const double unexplained = 0.05;

double hk_common_damping(const hk_model *model, double *const column[3]) {
  double least = INFINITY, value[3];
  for (size_t i = 0; i < model->n; i++) {
    double w = model->inverse_mass[i];
    const double *p = column[0] + 3 * i, *q = column[1] + 3 * i, *r = column[2] + 3 * i;
    if (!(w > 0)) continue;
    double a[6] = {p[0], (p[1] + q[0]) / 2, (p[2] + r[0]) / 2, q[1], (q[2] + r[1]) / 2, r[2]};
    hk_symmetric_eigenvalues(a, value);
    /* The eigenvalue of a direction that a pin forbids is 0. */
    int blocked = model->pin[i] == HK_PIN_LINE ? 2 : model->pin[i] == HK_PIN_PLANE ? 1 : 0;
    least = fmin(least, sqrt(w) * value[blocked]);
  }
  return isfinite(least) ? fmax(0, least) : 0;
}

double hk_common_turning(const hk_model *model, double *const column[3], double *turn) {
  double most = 0;
  for (size_t i = 0; i < model->n; i++) {
    double f = sqrt(model->inverse_mass[i]) / 2, t[3];
    for (size_t c = 0; c < 3; c++) {
      size_t d = (c + 1) % 3, e = (c + 2) % 3;
      t[c] = f * (column[d][3 * i + e] - column[e][3 * i + d]);
    }
    for (size_t c = 0; turn && c < 3; c++) turn[3 * i + c] = t[c];
    most = fmax(most, sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
  }
  return most;
}

void hk_turning_pair(hk_system *system, double *p, double *q) {
  size_t size = 3 * system->n;
  hk_lanczos_random(p, size);
  /* The second one is the first moved on by four numbers. */
  for (size_t c = 0; c < size; c++) q[c] = p[(c + 4) % size];
  for (size_t i = 0; i < system->n; i++)
    for (size_t c = 3 * i; c < 3 * i + 3 && !(system->model->inverse_mass[i] > 0); c++) p[c] = q[c] = 0;
  system->filter(system, p);
  system->filter(system, q);
}

bool hk_turning_is_whole(size_t n, const double *turn, const double *p, const double *q, const double *Dp,
                         const double *Dq) {
  double rest = 0, square = 0;
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < 3; c++) {
      size_t at = 3 * i + c, d = 3 * i + (c + 1) % 3, e = 3 * i + (c + 2) % 3;
      double turned = 2 * p[at] * (turn[d] * q[e] - turn[e] * q[d]);
      rest += p[at] * Dq[at] - q[at] * Dp[at] - turned;
      square += turned * turned;
    }
  return fabs(rest) <= unexplained * sqrt(square);
}
