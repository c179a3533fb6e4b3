/* Conjugate gradients preconditioned by the Cholesky factor of an earlier matrix.
 *
 * The matrices of successive steps differ by little, and a factor of one of them, used as the preconditioner of the
 * others, gives a solution in a few iterations, each of which costs two substitutions and a product; a factorization
 * costs some of these. `factorize` therefore only takes the values. The factor is in floats, which halves its time and
 * its memory, until one fails for want of digits, and in doubles from there on. It is renewed
 *   - before a matrix, when the last one cost more than all since the last factorization did on average, that
 *     factorization included: from there on the average would rise (the minimum of (F + c_1 + .. + c_n)/n);
 *   - within a solution, when its iterations have cost as much as a factorization. Where that happens with the factor
 * of the matrix just before, the next matrices are factorized at once: one, three, seven and so on, up to 31. Costs are
 * operations, those of an iteration counted SLOW times, since it is bound by the memory and a factorization is not: so
 * results do not depend on the machine's load, and are the same for any number of threads.
 *
 * What stops is |r| together with its norm by the factor, in which soft modes count beside stiff ones; |b - A x| is
 * computed anew at the end, so that nothing wrong is returned. Vectors are summed in one fixed order. Hestenes and
 * Stiefel 1952, J. Res. NBS 49; Golub and Van Loan, Matrix Computations, 11.3 and 11.5; factors of earlier matrices:
 * Knoll and Keyes 2004, J. Comput. Phys. 193, section 3.2. Invariant: `upper` has the values of the matrix taken last,
 * `factor` those of it or of one before with the same pattern. */
#include "plugins/common/cholesky/block_order.h"
#include "plugins/common/linear/upper_matrix.h"
#include "plugins/common/supernodal/supernodal.h"

#include <string.h>

enum { SPARE = 8, LANES = 8, TRIES = 10, LIMIT = 1000, LONGEST = 5 };

/* Measured, in floats: substitutions 6, factorizations 80 Gflop/s (cloth of 64 x 64), 7 and 145 (256 x 256). */
static const double slow = 12;

typedef struct gradients {
  double tolerance;
  const hk_host *host;
  hk_supernodal factor;
  hk_upper upper;
  hk_matrix matrix; /* the one taken last, for a factor that is made later, with values of its own */
  size_t unknowns;
  bool analyzed, taken, fresh; /* fresh: the factor is that of the matrix taken last */
  bool due;                    /* a new factor is to be made of the next matrix */
  double spent, now;           /* operations since the last factorization, with it; of the present matrix */
  double matrices;             /* since the last factorization */
  int failures, wait;          /* old factors that failed in a row; matrices that are to be factorized at once */
  double *vectors;             /* x, r, z, p, q, each of `unknowns` doubles and some padding */
  double *x, *r, *z, *p, *q;
} gradients;

static const hk_param params[] = {
    {"tolerance",
     "",
     "residual that will do, relative to the right-hand side, where the integrator asks for none",
     HK_NUMBER,
     {1e-8},
     0,
     1,
     offsetof(gradients, tolerance),
     HK_ABOVE_MIN,
     NULL},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  gradients *s = self;
  (void)view;
  s->host = host;
  return hk_supernodal_open(&s->factor, host, true);
}

static void forget(gradients *s) {
  hk_upper_free(&s->upper, s->host);
  s->host->release(s->host, s->vectors);
  s->host->release(s->host, s->matrix.value);
  s->vectors = s->matrix.value = NULL;
  s->analyzed = s->taken = false;
}

static void destroy(void *self, const hk_host *host) {
  gradients *s = self;
  s->host = host;
  if (!s->factor.started) return;
  forget(s);
  hk_supernodal_close(&s->factor);
}

static size_t numbers_of(const hk_matrix *A) { return A->row_start[A->rows] * A->block * A->block; }

static hk_status analyze(void *self, const hk_matrix *A) {
  gradients *s = self;
  const hk_host *host = s->host;
  size_t n = A->rows * A->block, stride = n + SPARE;
  forget(s);
  if (A->row_start[A->rows] >= UINT32_MAX)
    return host->fail(host, HK_FAILED, "%zu blocks are more than 32-bit numbers can count", A->row_start[A->rows]);
  s->unknowns = n;
  hk_status status = hk_upper_analyze(&s->upper, host, A);
  if (status == HK_OK) s->vectors = host->allocate(host, 5 * stride * sizeof *s->vectors);
  if (s->vectors) s->matrix.value = host->allocate(host, (numbers_of(A) + 1) * sizeof *A->value);
  if (!s->matrix.value) return host->fail(host, HK_NO_MEMORY, "no memory to store a matrix of %zu rows", n);
  s->x = s->vectors, s->r = s->x + stride, s->z = s->r + stride, s->p = s->z + stride, s->q = s->p + stride;
  status = hk_supernodal_analyze(&s->factor, A, HK_ORDER_BEST);
  s->analyzed = status == HK_OK;
  return status;
}

/* From now on in doubles. */
static hk_status widen(gradients *s) {
  hk_supernodal_close(&s->factor);
  hk_status status = hk_supernodal_open(&s->factor, s->host, false);
  return status == HK_OK ? hk_supernodal_analyze(&s->factor, &s->matrix, HK_ORDER_BEST) : status;
}

/* Makes a factor of the matrix taken last. */
static hk_status renew(gradients *s) {
  hk_status status = hk_supernodal_factorize(&s->factor, &s->matrix);
  if (status == HK_NOT_CONVERGED && hk_supernodal_is_single(&s->factor)) {
    status = widen(s);
    if (status == HK_OK) status = hk_supernodal_factorize(&s->factor, &s->matrix);
  }
  if (status != HK_OK) return status;
  s->fresh = true;
  s->due = false;
  s->spent = s->factor.nodes.flops;
  s->matrices = 0;
  s->now = 0;
  return HK_OK;
}

/* Counts what the last matrix cost. */
static void account(gradients *s) {
  if (!s->taken || !s->factor.ready) return;
  s->matrices++;
  s->spent += s->now;
  s->due = s->now > s->spent / s->matrices || s->wait > 0;
  if (s->wait > 0) s->wait--;
  s->now = 0;
}

static hk_status factorize(void *self, const hk_matrix *A) {
  gradients *s = self;
  if (!s->analyzed) return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  account(s);
  s->taken = s->fresh = false;
  double *own = s->matrix.value;
  s->matrix = *A;
  s->matrix.value = memcpy(own, A->value, numbers_of(A) * sizeof *own);
  hk_status status = HK_OK;
  hk_upper_fill(&s->upper, s->host, A);
  if (!s->factor.ready || s->due) status = renew(s);
  s->taken = status == HK_OK;
  return status;
}

static double dot(const double *a, const double *b, size_t count) {
  double sum[LANES] = {0}, total = 0;
  size_t e = 0;
  for (; e + LANES <= count; e += LANES)
    for (size_t l = 0; l < LANES; l++) sum[l] += a[e + l] * b[e + l];
  for (; e < count; e++) sum[0] += a[e] * b[e];
  for (size_t l = 0; l < LANES; l++) total += sum[l];
  return total;
}

static hk_status stopped(gradients *s, double left, double tolerance, int iterations) {
  if (!isfinite(left))
    return s->host->fail(s->host, HK_NOT_FINITE, "the linear system's numbers are not finite, seen after %d iterations",
                         iterations);
  return s->host->fail(
      s->host, HK_NOT_CONVERGED,
      "the residual is %.3g of the right-hand side after %d iterations, asked for was %.3g: the matrix "
      "is singular, or rounding allows no less",
      left, iterations, tolerance);
}

static hk_status bad_curvature(gradients *s, double curvature, int iterations) {
  if (isnan(curvature)) return stopped(s, NAN, 0, iterations);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen after %d iterations: p.(A p) = %.3g; the step is too "
                       "long for a force that pushes apart, or the matrix is singular",
                       iterations, curvature);
}

/* Whether old factors serve: one that failed was that of the matrix just before, or older. */
static void judge(gradients *s) {
  bool at_once = s->matrices <= 1;
  s->failures = !at_once ? 0 : s->failures < LONGEST ? s->failures + 1 : LONGEST;
  s->wait = (1 << s->failures) - 1;
}

typedef struct goal {
  double whole, part; /* |b|, and what |r| is to reach of it */
  double first;       /* sqrt(r.M^-1 r) at the start, of which the same part is to be reached */
  double most;        /* operations that may be spent */
} goal;

/* Iterates from x = s->x with its residual s->r. *reached: both norms of the residual are small enough. */
static hk_status iterate(gradients *s, goal *g, int *iterations, bool *reached) {
  size_t n = s->unknowns;
  double rz = 0, cost = slow * (4 * s->factor.nodes.entries + 2 * (double)numbers_of(&s->matrix)), spent = 0;
  *reached = false;
  for (bool first = true;; first = false) {
    hk_supernodal_solve(&s->factor, s->r, s->z);
    s->now += cost, spent += cost;
    double next = dot(s->r, s->z, n), size = sqrt(dot(s->r, s->r, n));
    if (!(g->first > 0)) g->first = sqrt(next);
    *reached = size <= g->part * g->whole && sqrt(next) <= g->part * g->first;
    if (*reached || !(next > 0) || spent > g->most || *iterations >= LIMIT) return HK_OK;
    double beta = first ? 0 : next / rz;
    for (size_t e = 0; e < n; e++) s->p[e] = s->z[e] + beta * s->p[e];
    double curvature = hk_upper_product(&s->upper, s->host, s->p, s->q);
    if (!(curvature > 0)) return bad_curvature(s, curvature, *iterations);
    ++*iterations;
    rz = next;
    double alpha = rz / curvature;
    for (size_t e = 0; e < n; e++) {
      s->x[e] += alpha * s->p[e];
      s->r[e] -= alpha * s->q[e];
    }
  }
}

/* r = b - A x; returns |r|. */
static double residual(gradients *s, const double *b) {
  hk_upper_product(&s->upper, s->host, s->x, s->q);
  for (size_t e = 0; e < s->unknowns; e++) s->r[e] = b[e] - s->q[e];
  return sqrt(dot(s->r, s->r, s->unknowns));
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  gradients *s = self;
  if (!s->taken) return s->host->fail(s->host, HK_FAILED, "there is no matrix to solve with");
  size_t n = s->unknowns;
  int iterations = 0;
  bool reached = false;
  goal g = {.part = info && info->tolerance > 0 ? info->tolerance : s->tolerance};
  memset(s->vectors, 0, 5 * (n + SPARE) * sizeof *s->vectors);
  double left = residual(s, b);
  g.whole = left;
  for (int tries = 0; left > 0 && !reached && isfinite(left) && tries < TRIES; tries++) {
    g.most = s->fresh ? INFINITY : s->factor.nodes.flops;
    hk_status status = iterate(s, &g, &iterations, &reached);
    if (status != HK_OK) return status;
    double last = left;
    left = residual(s, b);
    reached = reached && left <= 1.1 * g.part * g.whole;
    if (reached) break;
    if (s->fresh && !(left < last / 4)) break;
    if (!s->fresh) {
      judge(s);
      status = renew(s);
    }
    if (status != HK_OK) return status;
    if (!(left <= g.whole)) memset(s->x, 0, n * sizeof *s->x), left = residual(s, b);
  }
  if (left > 0 && !reached) return stopped(s, left / g.whole, g.part, iterations);
  if (!isfinite(left)) return stopped(s, left, g.part, iterations);
  memcpy(x, s->x, n * sizeof *x);
  if (info) *info = (hk_solve_info){iterations, g.whole > 0 ? left / g.whole : 0, info->tolerance};
  return HK_OK;
}

static const hk_solver solver = {
    .size = sizeof(hk_solver), .flags = HK_ITERATIVE, .analyze = analyze, .factorize = factorize, .solve = solve};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOLVER,
    .name = "stale_cholesky",
    .summary = "conjugate gradients preconditioned by the Cholesky factor of an earlier matrix, for symmetric matrices "
               "that change little from step to step",
    .reference =
        "Hestenes and Stiefel 1952; Knoll and Keyes 2004, J. Comput. Phys. 193, section 3.2; Duff and Reid 1983",
    .instance_size = sizeof(gradients),
    .params = params,
    .create = create,
    .destroy = destroy,
    .solver = &solver,
};
