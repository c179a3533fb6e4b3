/* A sliding pin couples the three coordinates of its particle, while the factors are those of an n x n matrix A that is
 * the same for each coordinate. With N the directions that the pins forbid, the constrained solution is exactly dx =
 * A^-1 (r - N lambda), N^T A^-1 N lambda = N^T A^-1 r. It costs one more solve and a dense matrix with one row per
 * direction, assembled and factorized once per factorization of A. The matrix entry for the directions a and b is
 * (n_a.n_b) (A^-1)_ij, i and j being their particles, so one solve per three particles computes it. It is positive
 * definite because A is. The filter removes the components along the normals that rounding leaves. This is a
 * range-space (Schur complement) method: Nocedal and Wright, Numerical Optimization, section 16.2. */
#include "plugins/common/integrate/slide_pins.h"

#include <string.h>

/* Two unit vectors that complete u to an orthonormal basis. */
static void complete(const double u[3], double p[3], double q[3]) {
  int least = fabs(u[0]) < fabs(u[1]) ? 0 : 1;
  if (fabs(u[2]) < fabs(u[least])) least = 2;
  double length = 0;
  for (int c = 0; c < 3; c++) p[c] = (c == least) - u[least] * u[c];
  for (int c = 0; c < 3; c++) length += p[c] * p[c];
  for (int c = 0; c < 3; c++) p[c] /= sqrt(length);
  for (int c = 0; c < 3; c++) q[c] = u[(c + 1) % 3] * p[(c + 2) % 3] - u[(c + 2) % 3] * p[(c + 1) % 3];
}

/* Sets u to the longest column of P = u u^T, normalised. */
static void axis_of(const double P[9], double u[3]) {
  int longest = 0;
  for (int c = 1; c < 3; c++)
    if (P[4 * c] > P[4 * longest]) longest = c;
  for (int c = 0; c < 3; c++) u[c] = P[3 * c + longest] / sqrt(P[4 * longest]);
}

static void add_normals(hk_slide_pins *l, uint32_t particle, hk_pin pin, const double S[9]) {
  double P[9], u[3], p[3], q[3];
  for (int k = 0; k < 9; k++) P[k] = pin == HK_PIN_LINE ? S[k] : (k % 4 == 0) - S[k];
  axis_of(P, u);
  complete(u, p, q);
  for (int k = 0; k < (pin == HK_PIN_LINE ? 2 : 1); k++) {
    l->particle[l->count] = particle;
    memcpy(l->normal[l->count++], pin == HK_PIN_PLANE ? u : k ? q : p, sizeof u);
  }
}

hk_status hk_slide_pins_build(hk_slide_pins *l, const hk_host *host, const hk_element_edges *edges) {
  hk_slide_pins_release(l, host);
  size_t most = 2 * edges->slides;
  if (most == 0) return HK_OK;
  l->particle = host->allocate(host, most * sizeof *l->particle);
  l->normal = host->allocate(host, most * sizeof *l->normal);
  l->lambda = host->allocate(host, most * sizeof *l->lambda);
  if (l->particle && l->normal && l->lambda) {
    for (size_t i = 0; i < edges->n; i++)
      if (edges->slide[i] != HK_NO_SLIDE)
        add_normals(l, (uint32_t)i, (hk_pin)edges->pin[i], edges->projector[edges->slide[i]]);
    l->L = host->allocate(host, l->count * l->count * sizeof *l->L);
  }
  if (l->L) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for a dense matrix of %zu directions of sliding particles", most);
}

void hk_slide_pins_release(hk_slide_pins *l, const hk_host *host) {
  host->release(host, l->particle);
  host->release(host, l->normal);
  host->release(host, l->lambda);
  host->release(host, l->L);
  *l = (hk_slide_pins){0};
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Computes the rows of N^T A^-1 N for the directions of up to three particles from `begin` on; sets *next to the first
 * direction after them. */
static hk_status rows_from(hk_slide_pins *l, hk_system *s, double *b, double *x, size_t begin, size_t *next) {
  size_t end = begin, columns = 0;
  memset(b, 0, 3 * s->n * sizeof *b);
  for (; end < l->count; end++) {
    bool another = end == begin || l->particle[end] != l->particle[end - 1];
    if (another && columns == 3) break;
    if (another) b[3 * (size_t)l->particle[end] + columns++] = 1;
  }
  hk_status status = s->linear->solve_columns(s, b, x, 3);
  size_t column = 0;
  for (size_t a = begin; a < end; a++) {
    if (a > begin && l->particle[a] != l->particle[a - 1]) column++;
    for (size_t c = a; c < l->count; c++)
      l->L[l->count * c + a] = dot(l->normal[a], l->normal[c]) * x[3 * (size_t)l->particle[c] + column];
  }
  *next = end;
  return status;
}

hk_status hk_slide_pins_factorize(hk_slide_pins *l, hk_system *s, double *b, double *x) {
  size_t n = l->count;
  hk_status status = HK_OK;
  for (size_t begin = 0; begin < n && status == HK_OK;) status = rows_from(l, s, b, x, begin, &begin);
  for (size_t i = 0; i < n && status == HK_OK; i++) {
    double *row = l->L + n * i;
    for (size_t j = 0; j <= i; j++) {
      double sum = row[j];
      for (size_t k = 0; k < j; k++) sum -= row[k] * l->L[n * j + k];
      if (i == j && !(sum > 0))
        return s->host->fail(s->host, HK_NOT_CONVERGED,
                             "the directions that slides do not allow depend on each other, seen at particle %u",
                             s->model->id[l->particle[i]]);
      row[j] = i == j ? sqrt(sum) : sum / l->L[n * j + j];
    }
  }
  return status;
}

hk_status hk_slide_pins_correct(hk_slide_pins *l, hk_system *s, double *dx, double *b, double *x) {
  size_t n = l->count;
  double *y = l->lambda;
  if (n == 0) return HK_OK;
  for (size_t i = 0; i < n; i++) {
    double sum = dot(l->normal[i], dx + 3 * (size_t)l->particle[i]);
    for (size_t k = 0; k < i; k++) sum -= l->L[n * i + k] * y[k];
    y[i] = sum / l->L[n * i + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++) y[i] -= l->L[n * k + i] * y[k];
    y[i] /= l->L[n * i + i];
  }
  memset(b, 0, 3 * s->n * sizeof *b);
  for (size_t i = 0; i < n; i++)
    for (size_t c = 0; c < 3; c++) b[3 * (size_t)l->particle[i] + c] += y[i] * l->normal[i][c];
  hk_status status = s->linear->solve_columns(s, b, x, 3);
  for (size_t e = 0; e < 3 * s->n && status == HK_OK; e++) dx[e] -= x[e];
  s->filter(s, dx);
  return status;
}
