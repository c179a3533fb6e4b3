/* The spectrum of a scene in which no two particles are coupled, under drag, say, and pulls to fixed places.
 * The operators K and D are then 3x3 blocks, one for each particle, whose eigenvalues are known, and no vector has to
 * be iterated: with a million particles that saves 200 MB and minutes of one processor.
 *
 * The blocks are those that forces give for implicit methods. Every CHECKED-th part of the particles is displaced at
 * random, and where F does not change as the blocks say, they are not believed. */
#include "core/numerics/stability/uncoupled.h"
#include "core/numerics/stability/lanczos.h"
#include "core/numerics/stability/stiffness.h"

#include <stdlib.h>
#include <string.h>

enum { PART = 256, CHECKED = 16, COST = 7 }; /* COST: once through all particles, in evaluations that take as long */

static const double inflate = 1 + 1e-8,              /* as in spectrum.c */
    asymmetric = 1e-4, strong = 0.2,                 /* likewise */
    move = 1e-6,                                     /* of the scene's coordinates and speeds, or 1 */
    believed = 1e-3, rounding = 64 * 2.2e-16 / move; /* relative to the change of F; of F */

typedef struct uncoupled {
  hk_system *system;
  double *x, *v, *F[2];  /* n x 3: displaced, of which only the parts that are checked are used */
  double u[2][3 * PART]; /* directions of x and v */
  double K[PART][9], D[PART][9];
  double length, speed;    /* m, m/s: by which they are displaced */
  double w2, g, b2, alpha; /* of all particles so far, 1/s^2, 1/s, 1/s^2, 1/s */
  double norm, skew;       /* of K: largest entries */
  double slope, offset;    /* see hk_spectrum; slope 0: not asked for */
} uncoupled;

static double largest(const double *x, size_t count) {
  double most = 0;
  for (size_t c = 0; c < count; c++) most = fabs(x[c]) > most ? fabs(x[c]) : most;
  return most;
}

/* ---- one particle ---- */

static void symmetric(const double A[9], double w, double out[6]) {
  static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
  for (int q = 0; q < 6; q++) out[q] = w * (A[3 * row[q] + column[q]] + A[3 * column[q] + row[q]]) / 2;
}

static double skew_of(const double A[9]) {
  double a = (A[7] - A[5]) / 2, b = (A[2] - A[6]) / 2, c = (A[3] - A[1]) / 2;
  return a * a + b * b + c * c;
}

/* No eigenvalue of a 3x3 matrix is further from the mean than sqrt(2/3) of the norm of the rest: most blocks need no
 * more. */
static void widen(const double a[6], double *least, double *most) {
  double mean = (a[0] + a[3] + a[5]) / 3, x = a[0] - mean, y = a[3] - mean, z = a[5] - mean, value[3];
  double reach = sqrt(2. / 3 * (x * x + y * y + z * z + 2 * (a[1] * a[1] + a[2] * a[2] + a[4] * a[4])));
  if (mean - reach >= *least && mean + reach <= *most) return;
  hk_symmetric_eigenvalues(a, value);
  *least = fmin(*least, value[0]);
  *most = fmax(*most, value[2]);
}

static void take(uncoupled *l, const double K[9], const double D[9], double w) {
  double k[6], d[6], any = -INFINITY;
  symmetric(K, w, k);
  symmetric(D, w, d);
  if (l->slope > 0) {
    for (int q = 0; q < 6; q++) d[q] -= l->slope * k[q];
    widen(d, &any, &l->offset);
    return;
  }
  widen(k, &any, &l->w2);
  widen(d, &l->alpha, &l->g);
  l->b2 = fmax(l->b2, w * w * skew_of(D));
  l->norm = fmax(l->norm, w * largest(K, 9));
  l->skew = fmax(l->skew, w * sqrt(skew_of(K)));
}

/* ---- parts ---- */

/* Whether F changes by -K dx - D dv; all numbers are those of some particles from `begin` on. */
static bool changes_as_blocks_say(uncoupled *l, size_t begin, size_t end) {
  hk_system *s = l->system;
  double unused[2][PART][9], off = 0, all = 0, size = 0;
  for (int side = 0; side < 2; side++) {
    for (size_t c = 3 * begin; c < 3 * end; c++) {
      l->x[c] = s->X[c] + (side ? l->length : -l->length) * l->u[0][c - 3 * begin];
      l->v[c] = s->X[3 * s->n + c] + (side ? l->speed : -l->speed) * l->u[1][c - 3 * begin];
    }
    if (!s->queries->uncoupled(s, l->x, l->v, begin, end, l->F[side], unused[0], unused[1])) return false;
  }
  for (size_t c = 0; c < 3 * (end - begin); c++) {
    double change = l->F[1][3 * begin + c] - l->F[0][3 * begin + c], expected = 0;
    for (size_t q = 0; q < 3; q++)
      expected -= 2 * l->length * l->K[c / 3][3 * (c % 3) + q] * l->u[0][c - c % 3 + q] +
                  2 * l->speed * l->D[c / 3][3 * (c % 3) + q] * l->u[1][c - c % 3 + q];
    if (!isfinite(change)) return false; /* fmax would pass over it */
    off = fmax(off, fabs(change - expected));
    all = fmax(all, fabs(expected));
    size = fmax(size, fabs(l->F[0][3 * begin + c]));
  }
  return off <= believed * all + rounding * move * size;
}

static bool are_finite(double (*block)[9], size_t count) {
  double zero = 0;
  for (size_t k = 0; k < count; k++)
    for (int q = 0; q < 9; q++) zero += 0 * block[k][q];
  return zero == 0;
}

static bool take_part(uncoupled *l, size_t begin, size_t end) {
  hk_system *s = l->system;
  if (!s->queries->uncoupled(s, s->X, s->X + 3 * s->n, begin, end, NULL, l->K, l->D)) return false;
  if (!are_finite(l->K, end - begin) || !are_finite(l->D, end - begin)) return false;
  if (l->slope == 0 && begin / PART % CHECKED == 0 && !changes_as_blocks_say(l, begin, end)) return false;
  for (size_t i = begin; i < end; i++)
    if (s->model->inverse_mass[i] > 0) take(l, l->K[i - begin], l->D[i - begin], s->model->inverse_mass[i]);
  return true;
}

static bool take_all(uncoupled *l) {
  size_t n = l->system->n;
  bool fine = true;
  for (size_t begin = 0; begin < n && fine; begin += PART)
    fine = take_part(l, begin, begin + PART < n ? begin + PART : n);
  return fine;
}

/* ---- the scene ---- */

static bool is_simple(const hk_system *s) {
  if (!s->queries->uncoupled || s->n == 0 || s->contact || s->model->channels || s->model->element_lists) return false;
  for (size_t i = 0; i < s->n; i++)
    if (s->model->pin[i] == HK_PIN_LINE || s->model->pin[i] == HK_PIN_PLANE) return false;
  for (size_t k = 0; k < s->split->forces; k++)
    if (s->split->force[k].flags & HK_STIFFENS || !s->split->takes[k]) return false;
  return true;
}

static hk_spectrum spectrum_of(const uncoupled *l) {
  hk_spectrum b = {.alpha = isfinite(l->alpha) ? fmax(0, l->alpha / inflate) : 0,
                   .evaluations = l->slope > 0 ? 2 * COST : COST};
  b.w_max = sqrt(l->w2 * inflate);
  b.w_reached = sqrt(l->w2);
  b.g_max = l->g * inflate;
  b.b_max = sqrt(l->b2) * inflate;
  b.damping_slope = l->slope;
  b.damping_offset = l->slope > 0 ? l->offset + 1e-6 * b.g_max : 0;
  b.rigorous = l->skew <= asymmetric * l->norm;
  return b;
}

static bool find(uncoupled *l, hk_spectrum *spectrum) {
  hk_system *s = l->system;
  double length = largest(s->X, 3 * s->n), speed = largest(s->X + 3 * s->n, 3 * s->n);
  l->length = move * (length > 0 ? length : 1), l->speed = move * (speed > 0 ? speed : 1);
  hk_lanczos_random(l->u[0], 3 * PART);
  for (size_t c = 0; c < 3 * PART; c++) l->u[1][c] = l->u[0][(7 * c + 4) % (3 * PART)];
  s->impose(s, s->t, s->X, s->X + 3 * s->n);
  if (!take_all(l) || !isfinite(l->w2 + l->g + l->b2)) return false;
  if (l->w2 > 0 && l->g > strong * sqrt(l->w2)) { /* see the pencil in spectrum.c */
    l->slope = l->g / l->w2;
    if (!take_all(l)) return false;
  }
  *spectrum = spectrum_of(l);
  return true;
}

bool hk_uncoupled_spectrum(hk_system *s, hk_spectrum *spectrum) {
  if (!is_simple(s)) return false;
  uncoupled *l = malloc(sizeof *l);
  double *memory = calloc(12 * s->n + 1, sizeof *memory); /* pages that are not used cost nothing */
  bool found = false;
  if (l && memory) {
    *l = (uncoupled){.system = s, .x = memory, .v = memory + 3 * s->n, .alpha = INFINITY};
    l->F[0] = memory + 6 * s->n, l->F[1] = memory + 9 * s->n;
    found = find(l, spectrum);
  }
  free(memory);
  free(l);
  return found;
}
