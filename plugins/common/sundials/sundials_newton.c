/* Newton's matrix of SUNDIALS' implicit methods through the scene's solver.
 *
 * The system (I - gamma J) z = r with J of (x, v), dx/dt = v, M dv/dt = F, is reduced to the velocities:
 *     (M + gamma D + gamma^2 K) z_v = M r_v - gamma K r_x,    z_x = r_x + gamma z_v
 * with K = -dF/dx and D = -dF/dv, so that one matrix of n blocks is factorised instead of 6n equations; pinned
 * components are filtered on both sides. Channels have the blocks of each particle (channels.h), the work takes part as
 * in functional iteration, z = r. With constraints M dv/dt = F + J^T lambda, and the reduced system is that of the
 * saddle point with J z_v = J r_v; how J and lambda change with X is left out of the matrix, not of the residual. The
 * sum M z_v keeps the momentum of r, whatever the iteration's tolerance.
 */
#include "plugins/common/linear/block_product.h"
#include "plugins/common/sundials/sundials.h"

#include <string.h>
#include <sunlinsol/sunlinsol_spgmr.h>

enum { KRYLOV_VECTORS = 20 };

static hk_status evaluate(hk_sundials *m, double t, N_Vector X, unsigned want) {
  hk_system *s = m->system;
  return s->linear->jacobian(s, t, NV_DATA_S(X), want, &m->K, &m->D);
}

static hk_status choose_blocks(hk_sundials *m, unsigned *want) {
  unsigned flags = 0;
  hk_status status = m->system->linear->solver_flags(m->system, &flags);
  *want = flags & HK_SOLVES_UNSYMMETRIC ? 0 : HK_WANT_SYMMETRIC;
  return status;
}

static hk_status combine(hk_sundials *m, double gamma) {
  m->gamma = gamma;
  return m->system->linear->combine(m->system, 1, gamma, gamma * gamma, &m->A);
}

static hk_status combine_and_factorize(hk_sundials *m, double gamma) {
  hk_status status = combine(m, gamma);
  return status == HK_OK ? m->system->linear->factorize(m->system, &m->A) : status;
}

static hk_status factorize_channels(hk_sundials *m, double t, N_Vector X, N_Vector f, bool reuse, double gamma) {
  hk_status status = HK_OK;
  if (!reuse || !m->rates.known)
    status = hk_channels_differentiate(&m->rates, m->system, t, NV_DATA_S(X), NV_DATA_S(f) + 6 * m->system->n);
  if (status == HK_OK) hk_channels_factorize(&m->rates, gamma);
  return status;
}

/* A matrix that is not positive definite is assembled again with the block of every element projected to positive
 * semi-definite. */
int hk_sundials_factorize(hk_sundials *m, double t, N_Vector X, N_Vector f, bool reuse, int *current, double gamma) {
  unsigned want = 0;
  hk_status status = choose_blocks(m, &want);
  if (status == HK_OK) status = factorize_channels(m, t, X, f, reuse, gamma);
  *current = !reuse;
  if (status == HK_OK && !reuse) status = evaluate(m, t, X, want);
  if (status == HK_OK) status = combine_and_factorize(m, gamma);
  if (status != HK_NOT_CONVERGED) return hk_sundials_code(m, status);
  *current = 1;
  status = evaluate(m, t, X, HK_WANT_SYMMETRIC | HK_WANT_DEFINITE);
  if (status == HK_OK) status = combine_and_factorize(m, gamma);
  return hk_sundials_code(m, status);
}

/* The inverse of a 3x3 block by its cofactors; of a singular one the identity. */
static void invert(const double a[9], double out[9]) {
  double c[9] = {a[4] * a[8] - a[5] * a[7], a[2] * a[7] - a[1] * a[8], a[1] * a[5] - a[2] * a[4],
                 a[5] * a[6] - a[3] * a[8], a[0] * a[8] - a[2] * a[6], a[2] * a[3] - a[0] * a[5],
                 a[3] * a[7] - a[4] * a[6], a[1] * a[6] - a[0] * a[7], a[0] * a[4] - a[1] * a[3]};
  double determinant = a[0] * c[0] + a[1] * c[3] + a[2] * c[6];
  for (int k = 0; k < 9; k++) out[k] = determinant != 0 ? c[k] / determinant : k % 4 == 0;
}

static void invert_diagonal(hk_sundials *m) {
  const hk_matrix *A = &m->A;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      if (A->column[e] == r) invert(A->value + 9 * e, m->inverse + 9 * r);
}

int hk_sundials_precondition(double t, N_Vector X, N_Vector f, int reuse, int *current, double gamma, void *self) {
  hk_sundials *m = self;
  if (m->preconditioner == HK_PRECONDITION_FACTOR) return hk_sundials_factorize(m, t, X, f, reuse, current, gamma);
  *current = !reuse;
  hk_status status = factorize_channels(m, t, X, f, reuse, gamma);
  if (status == HK_OK && !reuse) status = evaluate(m, t, X, HK_WANT_SYMMETRIC | HK_WANT_DEFINITE);
  if (status == HK_OK) status = combine(m, gamma);
  if (status == HK_OK) invert_diagonal(m);
  return hk_sundials_code(m, status);
}

/* x = z_v; with constraints, J z_v = J r_v. */
static hk_status solve_blocks(hk_sundials *m, const double *b, const double *r_v, double *x) {
  hk_system *s = m->system;
  if (!m->inverse)
    return hk_system_equations(s) ? s->linear->solve_along(s, b, r_v, x, NULL) : s->linear->solve(s, b, x, NULL);
  for (size_t r = 0; r < 3 * m->A.rows; r++) {
    const double *row = m->inverse + 3 * r, *from = b + r / 3 * 3;
    x[r] = row[0] * from[0] + row[1] * from[1] + row[2] * from[2];
  }
  return HK_OK;
}

/* Computes z from r by the reduction above; pinned components are z = r. */
static hk_status reduce_and_solve(hk_sundials *m, const double *r, double *z) {
  hk_system *s = m->system;
  size_t v = 3 * s->n;
  double *free_x = m->work, *b = m->work + v, *dv = m->work + s->size, *free_v = dv + v;
  memcpy(free_x, r, v * sizeof *r);
  memcpy(free_v, r + v, v * sizeof *r);
  s->filter(s, free_x);
  s->filter(s, free_v);
  hk_block_product(m->host, &m->K, free_x, b);
  for (size_t e = 0; e < v; e++) b[e] = s->model->mass[e / 3] * free_v[e] - m->gamma * b[e];
  s->filter(s, b);
  hk_status status = solve_blocks(m, b, free_v, dv);
  if (status != HK_OK) return status;
  s->filter(s, dv);
  for (size_t e = 0; e < v; e++) {
    double held = r[v + e] - free_v[e];
    z[e] = r[e] + m->gamma * dv[e];
    z[v + e] = dv[e] + held;
  }
  hk_channels_solve(&m->rates, r + 2 * v, z + 2 * v);
  z[s->size - 1] = r[s->size - 1];
  return HK_OK;
}

int hk_sundials_preconditioned(double t, N_Vector X, N_Vector f, N_Vector b, N_Vector z, double gamma, double delta,
                               int side, void *self) {
  (void)t, (void)X, (void)f, (void)gamma, (void)delta, (void)side;
  return hk_sundials_code(self, reduce_and_solve(self, NV_DATA_S(b), NV_DATA_S(z)));
}

/* ---- SUNDIALS' linear solvers ---- */

static SUNLinearSolver_Type solver_type(SUNLinearSolver solver) {
  (void)solver;
  return SUNLINEARSOLVER_DIRECT;
}

static int do_nothing(SUNLinearSolver solver, SUNMatrix A) { /* factorised when the matrix was made */
  (void)solver, (void)A;
  return 0;
}

static int solve(SUNLinearSolver solver, SUNMatrix A, N_Vector z, N_Vector r, sunrealtype tolerance) {
  (void)A, (void)tolerance;
  hk_status status = reduce_and_solve(solver->content, NV_DATA_S(r), NV_DATA_S(z));
  return hk_sundials_code(solver->content, status) == 0 ? 0 : SUNLS_PACKAGE_FAIL_REC;
}

static int free_solver(SUNLinearSolver solver) {
  SUNLinSolFreeEmpty(solver);
  return 0;
}

static SUNMatrix_ID matrix_id(SUNMatrix A) {
  (void)A;
  return SUNMATRIX_CUSTOM;
}

static void free_matrix(SUNMatrix A) { SUNMatFreeEmpty(A); }

static hk_status no_memory(const hk_sundials *m) {
  return m->host->fail(m->host, HK_NO_MEMORY, "no memory for SUNDIALS' linear solver");
}

hk_status hk_sundials_direct(hk_sundials *m) {
  m->matrix = SUNMatNewEmpty(m->context);
  m->linear = SUNLinSolNewEmpty(m->context);
  if (!m->matrix || !m->linear) return no_memory(m);
  m->matrix->ops->getid = matrix_id;
  m->matrix->ops->destroy = free_matrix;
  m->linear->content = m;
  m->linear->ops->gettype = solver_type;
  m->linear->ops->setup = do_nothing;
  m->linear->ops->solve = solve;
  m->linear->ops->free = free_solver;
  return HK_OK;
}

hk_status hk_sundials_krylov(hk_sundials *m) {
  int side = m->preconditioner == HK_PRECONDITION_NONE ? SUN_PREC_NONE : SUN_PREC_LEFT;
  m->linear = SUNLinSol_SPGMR(m->X, side, KRYLOV_VECTORS, m->context);
  return m->linear ? HK_OK : no_memory(m);
}
