/* SUNDIALS' serial vectors with their own arithmetic, compiled as hooke is: distributions compile the library's
 * arithmetic without optimisation, where the sums over stages and past steps cost more than a cloth's forces. Vectors
 * cloned from one inherit its functions. Sums over a vector use lanes in a fixed order; sums of several vectors run
 * over chunks that fit the first-level cache. The other functions are SUNDIALS' own.
 *
 * SUNDIALS 6 writes to a clone without looking whether there is one. So a clone for which there is no memory is a spare
 * vector, made beforehand: SUNDIALS goes on, and whoever set it up asks hk_sundials_vector_failed and gives up. */
#include "plugins/common/sundials/sundials_vector.h"

#include <math.h>
#include <stdlib.h>

enum { LANES = 8, CHUNK = 512 };

static size_t length_of(N_Vector x) { return (size_t)NV_LENGTH_S(x); }

static void linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z) {
  const double *p = NV_DATA_S(x), *q = NV_DATA_S(y);
  double *to = NV_DATA_S(z);
  size_t n = length_of(x);
  if (a == 1 && b == 1)
    for (size_t e = 0; e < n; e++) to[e] = p[e] + q[e];
  else if (a == 1 && b == -1)
    for (size_t e = 0; e < n; e++) to[e] = p[e] - q[e];
  else
    for (size_t e = 0; e < n; e++) to[e] = a * p[e] + b * q[e];
}

static void set(sunrealtype c, N_Vector z) {
  double *to = NV_DATA_S(z);
  for (size_t e = 0, n = length_of(z); e < n; e++) to[e] = c;
}

static void product(N_Vector x, N_Vector y, N_Vector z) {
  const double *p = NV_DATA_S(x), *q = NV_DATA_S(y);
  double *to = NV_DATA_S(z);
  for (size_t e = 0, n = length_of(x); e < n; e++) to[e] = p[e] * q[e];
}

static void scale(sunrealtype c, N_Vector x, N_Vector z) {
  const double *p = NV_DATA_S(x);
  double *to = NV_DATA_S(z);
  if (c == 1 && p == to) return;
  for (size_t e = 0, n = length_of(x); e < n; e++) to[e] = c * p[e];
}

static double sum_lanes(const double lane[LANES]) {
  double total = 0;
  for (int l = 0; l < LANES; l++) total += lane[l];
  return total;
}

static sunrealtype dot(N_Vector x, N_Vector y) {
  const double *p = NV_DATA_S(x), *q = NV_DATA_S(y);
  double sum[LANES] = {0};
  size_t n = length_of(x), e = 0;
  for (; e + LANES <= n; e += LANES)
    for (size_t l = 0; l < LANES; l++) sum[l] += p[e + l] * q[e + l];
  for (; e < n; e++) sum[0] += p[e] * q[e];
  return sum_lanes(sum);
}

/* In place of SUNDIALS' mean over all numbers the largest counts; NAN if one is. */
static sunrealtype weighted_norm(N_Vector x, N_Vector w) {
  const double *p = NV_DATA_S(x), *q = NV_DATA_S(w);
  double most[LANES] = {0}, worst = 0, bad = 0;
  size_t n = length_of(x), e = 0;
  for (; e + LANES <= n; e += LANES)
    for (size_t l = 0; l < LANES; l++) {
      double r = fabs(p[e + l] * q[e + l]);
      most[l] = r > most[l] ? r : most[l];
      bad += r * 0;
    }
  for (; e < n; e++) {
    double r = fabs(p[e] * q[e]);
    most[0] = r > most[0] ? r : most[0];
    bad += r * 0;
  }
  for (size_t l = 0; l < LANES; l++) worst = most[l] > worst ? most[l] : worst;
  return bad == 0 ? worst : NAN;
}

static void add(double *restrict to, const double *restrict p, size_t count, double c) {
  for (size_t e = 0; e < count; e++) to[e] += c * p[e];
}

/* z = sum c_k X_k; z may be X_0, but no other X_k. */
static int combine(int count, sunrealtype *c, N_Vector *X, N_Vector z) {
  double *to = NV_DATA_S(z);
  const double *first = NV_DATA_S(X[0]);
  size_t n = length_of(z);
  for (size_t begin = 0; begin < n; begin += CHUNK) {
    size_t chunk = n - begin < CHUNK ? n - begin : CHUNK;
    for (size_t e = begin; e < begin + chunk; e++) to[e] = c[0] * first[e];
    for (int k = 1; k < count; k++)
      if (c[k] != 0) add(to + begin, NV_DATA_S(X[k]) + begin, chunk, c[k]);
  }
  return 0;
}

/* Z_k = a_k x + Y_k; Z_k may be Y_k. */
static int scale_add(int count, sunrealtype *a, N_Vector x, N_Vector *Y, N_Vector *Z) {
  for (int k = 0; k < count; k++)
    if (Y[k] == Z[k])
      add(NV_DATA_S(Z[k]), NV_DATA_S(x), length_of(x), a[k]);
    else
      linear_sum(a[k], x, 1, Y[k], Z[k]);
  return 0;
}

static int scale_each(int count, sunrealtype *c, N_Vector *X, N_Vector *Z) {
  for (int k = 0; k < count; k++) scale(c[k], X[k], Z[k]);
  return 0;
}

/* ---- life ---- */

/* What the vectors of one family have in common. */
typedef struct family {
  N_Vector spare;
  bool failed;
} family;

typedef struct content {
  struct _N_VectorContent_Serial serial; /* first member: SUNDIALS' macros see it */
  family *family;
  bool owns; /* the family */
} content;

static content *content_of(N_Vector x) { return x->content; }

static void release(N_Vector x) {
  content *c = content_of(x);
  if (c && c->serial.own_data) free(c->serial.data);
  free(c);
  x->content = NULL;
  N_VFreeEmpty(x);
}

static void destroy(N_Vector x) {
  family *f = content_of(x)->family;
  bool owns = content_of(x)->owns;
  if (x == f->spare) return; /* it may have been handed out several times */
  release(x);
  if (!owns) return;
  if (f->spare) release(f->spare);
  free(f);
}

/* Aligned as the state is, for forces in vectors of eight numbers; for free(). */
static double *numbers(size_t count) {
  enum { LINE = 64 };
  return aligned_alloc(LINE, (count * sizeof(double) / LINE + 1) * LINE);
}

/* A vector over `data`, or over memory of its own; NULL: no memory. */
static N_Vector make(sunindextype length, double *data, SUNContext context, family *f) {
  N_Vector x = N_VNewEmpty(context);
  if (!x) return NULL;
  content *c = x->content = calloc(1, sizeof *c);
  if (c) *c = (content){.serial = {.length = length, .data = data, .own_data = !data}, .family = f};
  if (c && !data) c->serial.data = numbers((size_t)length);
  if (c && c->serial.data) return x;
  release(x);
  return NULL;
}

static N_Vector clone(N_Vector x) {
  family *f = content_of(x)->family;
  N_Vector made = make(NV_LENGTH_S(x), NULL, x->sunctx, f);
  if (made && N_VCopyOps(x, made) == 0) return made;
  if (made) release(made);
  f->failed = true;
  return f->spare;
}

static void set_operations(N_Vector x) {
  x->ops->nvclone = clone;
  x->ops->nvcloneempty = clone;
  x->ops->nvdestroy = destroy;
  x->ops->nvlinearsum = linear_sum;
  x->ops->nvconst = set;
  x->ops->nvprod = product;
  x->ops->nvscale = scale;
  x->ops->nvdotprod = dot;
  x->ops->nvwrmsnorm = weighted_norm;
  x->ops->nvlinearcombination = combine;
  x->ops->nvscaleaddmulti = scale_add;
  x->ops->nvscalevectorarray = scale_each;
}

bool hk_sundials_vector_failed(N_Vector x) { return content_of(x)->family->failed; }

N_Vector hk_sundials_vector(size_t size, double *data, SUNContext context) {
  N_Vector model = N_VNewEmpty_Serial((sunindextype)size, context), x = NULL; /* SUNDIALS' own functions */
  family *f = calloc(1, sizeof *f);
  if (model && f) {
    f->spare = make((sunindextype)size, NULL, context, f);
    x = f->spare ? make((sunindextype)size, data, context, f) : NULL;
  }
  bool fine = x && N_VCopyOps(model, x) == 0 && N_VCopyOps(model, f->spare) == 0;
  if (model) N_VDestroy(model);
  if (fine) {
    content_of(x)->owns = true;
    set_operations(x);
    set_operations(f->spare);
    return x;
  }
  if (x) release(x);
  if (f && f->spare) release(f->spare);
  free(f);
  return NULL;
}
