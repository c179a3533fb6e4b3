/* The linear system of an implicit step in a scene with constraints,
 *     | A   B^T    | |  x |   |  b  |
 *     | B  -eps I  | | -l | = | B u |,     B = S J, with the pins applied,
 * as one sparse matrix of numbers, symmetric where A is but never definite, which is given to a solver for indefinite
 * matrices. The rows of B are scaled by S so that B diag(A)^-1 B^T has a unit diagonal: so eps is relative to the Schur
 * complement B A^-1 B^T, whatever the units of an equation. eps is far below the eigenvalues of that matrix and far
 * above rounding; its effect is removed by iterative refinement, so that equations which depend on each other in some
 * state are solved with multipliers of minimal norm. Equations that rest have the row of the identity.
 *
 * The forces J^T lambda change with x as well: a bar under tension T and of length L has a transverse stiffness T/L,
 * which must be part of A, because Newton's iteration otherwise does not converge where g^2 T/(m L) is above 1. Their
 * derivative is computed by forward differences of J, for all particles that share no equation at once: a few
 * evaluations of J, whatever the number of particles (Curtis, Powell and Reid 1974). Where more than MOST_COLOURS
 * groups of particles are needed it is omitted.
 *
 * Invariant: the factors are those of the last factorization, but B is that of the last evaluation: refinement
 * converges to the solution for the present B, which Newton's iteration with older factors needs as well. Benzi, Golub
 * and Liesen 2005, Numerical solution of saddle point problems, sections 3 and 5. */

#include "core/numerics/implicit/implicit.h"

#include <stdlib.h>
#include <string.h>

enum { REFINEMENTS = 6, MOST_COLOURS = 16 };

static const double eps = 1e-10, enough = 1e-12, difference = 1.5e-8; /* difference: sqrt(rounding) of the extent */

struct hk_saddle_point {
  hk_linear_system linear;
  hk_plugin_spec *spec;       /* spec of the solver; NULL: it is the scene's */
  uint64_t pattern, revision; /* pattern of A and revision of the constraints for which `matrix` was built */
  size_t rows, equations;     /* 3n, and the number of constraint equations */
  size_t of_A;                /* number of values in A */
  hk_block_matrix matrix;     /* slots: A, then B^T and B block by block, then the diagonal of the equations */
  double *value;
  double (*B)[3];                                 /* blocks: S J with the pins applied */
  double *scale;                                  /* equations: S; 0: the equation rests */
  double *diagonal;                               /* 3n: diagonal of A */
  double *rhs, *solution, *residual, *correction; /* rows + equations */
  /* Data for the stiffness of constraint forces. */
  unsigned colours;   /* number of colours; 0: the stiffness is omitted */
  uint8_t *colour;    /* particles: their colour */
  size_t *start;      /* equations + 1: blocks of equation k are order[start[k]..start[k + 1]] */
  uint32_t *order;    /* blocks */
  double *x, (*J)[3]; /* perturbed positions, and J there */
};

hk_status hk_saddle_point_open(hk_dynamics *d) {
  d->saddle = calloc(1, sizeof *d->saddle);
  if (!d->saddle) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the constraints of implicit steps");
  hk_linear_system *linear = &d->saddle->linear;
  hk_status status = hk_solver_indefinite(d, &linear->any, &d->saddle->spec);
  linear->solver = linear->any;
  return status;
}

static void drop(hk_saddle_point *s) {
  void *arrays[] = {s->value, s->B, s->scale, s->diagonal, s->rhs, s->solution, s->residual, s->correction};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  hk_block_matrix_free(&s->matrix);
  hk_saddle_point kept = {.linear = s->linear, .spec = s->spec, .colours = s->colours, .colour = s->colour};
  kept.start = s->start;
  kept.order = s->order;
  kept.x = s->x;
  kept.J = s->J;
  *s = kept;
}

static void drop_groups(hk_saddle_point *s) {
  void *arrays[] = {s->colour, s->start, s->order, s->x, s->J};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  s->colours = 0;
  s->colour = NULL;
  s->start = NULL;
  s->order = NULL;
  s->x = NULL;
  s->J = NULL;
}

void hk_saddle_point_close(hk_dynamics *d) {
  if (!d->saddle) return;
  drop_groups(d->saddle);
  drop(d->saddle);
  hk_instance_destroy(d->saddle->linear.solver);
  hk_spec_destroy(d->saddle->spec);
  free(d->saddle);
  d->saddle = NULL;
}

const hk_instance *hk_saddle_point_solver(const hk_dynamics *d) {
  return d->saddle && d->saddle->spec ? d->saddle->linear.solver : NULL;
}

unsigned hk_saddle_point_flags(const hk_dynamics *d) { return d->saddle->linear.solver->plugin->solver->flags; }

/* ---- the matrix ---- */

static void name(hk_saddle_point *s, size_t row, size_t column) {
  s->matrix.naming.block(&s->matrix.naming, (uint32_t)row, (uint32_t)column);
}

static void name_all(hk_saddle_point *s, const hk_constraints *c, const hk_matrix *A) {
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      for (size_t p = 0; p < 9; p++) name(s, 3 * r + p / 3, 3 * (size_t)A->column[e] + p % 3);
  s->of_A = s->matrix.named;
  for (size_t b = 0; b < c->blocks; b++)
    for (size_t a = 0; a < 3; a++) {
      size_t equation = s->rows + c->list.pair[b][0], row = 3 * (size_t)c->list.pair[b][1] + a;
      name(s, row, equation);
      name(s, equation, row);
    }
  for (size_t k = 0; k < s->equations; k++) name(s, s->rows + k, s->rows + k);
}

static hk_status build(hk_dynamics *d, const hk_matrix *A) {
  hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  drop(s);
  s->rows = 3 * A->rows;
  s->equations = c->equations;
  size_t all = s->rows + s->equations;
  hk_block_matrix_begin(&s->matrix, all, all);
  name_all(s, c, A);
  hk_status status = hk_block_matrix_build(&s->matrix);
  s->value = status == HK_OK ? malloc((s->matrix.row_start[all] + 1) * sizeof *s->value) : NULL;
  s->B = malloc((c->blocks + 1) * sizeof *s->B);
  s->scale = malloc((s->equations + 1) * sizeof *s->scale);
  double **vectors[] = {&s->diagonal, &s->rhs, &s->solution, &s->residual, &s->correction};
  bool fine = s->value && s->B && s->scale;
  for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) {
    *vectors[k] = calloc(all + 1, sizeof **vectors[k]);
    fine &= *vectors[k] != NULL;
  }
  if (!fine) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the matrix of %zu constraints", s->equations);
  s->pattern = A->pattern;
  s->revision = c->revision;
  return HK_OK;
}

/* Computes S and B from the last evaluation; directions that pins hold do not contribute. */
static void take_jacobian(hk_dynamics *d) {
  hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  memset(s->scale, 0, s->equations * sizeof *s->scale);
  for (size_t b = 0; b < c->blocks; b++) {
    uint32_t i = c->list.pair[b][1], k = c->list.pair[b][0];
    double mass = d->state->inverse_mass[i] > 0 ? d->state->mass[i] : 0;
    for (size_t a = 0; a < 3; a++) {
      s->B[b][a] = mass * c->WJ[b][a];
      s->scale[k] += mass > 0 ? s->B[b][a] * s->B[b][a] / s->diagonal[3 * i + a] : 0;
    }
  }
  for (size_t k = 0; k < s->equations; k++) s->scale[k] = c->scale[k] > 0 ? 1 / sqrt(s->scale[k]) : 0;
  for (size_t b = 0; b < c->blocks; b++)
    for (size_t a = 0; a < 3; a++) s->B[b][a] *= s->scale[c->list.pair[b][0]];
}

static void take_matrix(hk_saddle_point *s, const hk_matrix *A) {
  memset(s->value, 0, s->matrix.row_start[s->rows + s->equations] * sizeof *s->value);
  for (size_t e = 0; e < s->of_A; e++) s->value[s->matrix.slot[e]] = A->value[e];
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      for (size_t a = 0; A->column[e] == r && a < 3; a++) s->diagonal[3 * r + a] = fabs(A->value[9 * e + 4 * a]);
  for (size_t k = 0; k < s->rows; k++)
    if (!(s->diagonal[k] > 0)) s->diagonal[k] = 1;
}

hk_status hk_saddle_point_factorize(hk_dynamics *d, const hk_matrix *A) {
  hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  hk_status status = s->value && s->pattern == A->pattern && s->revision == c->revision ? HK_OK : build(d, A);
  if (status != HK_OK) return status;
  take_matrix(s, A);
  take_jacobian(d);
  const size_t *slot = s->matrix.slot + s->of_A;
  for (size_t b = 0; b < c->blocks; b++)
    for (size_t a = 0; a < 3; a++, slot += 2) {
      s->value[slot[0]] += s->B[b][a];
      s->value[slot[1]] += s->B[b][a];
    }
  for (size_t k = 0; k < s->equations; k++) s->value[slot[k]] = s->scale[k] > 0 ? -eps : 1;
  hk_matrix whole = {s->rows + s->equations, 1, s->matrix.row_start, s->matrix.column, s->value, A->symmetric,
                     s->matrix.number};
  return hk_linear_system_factorize(d, &s->linear, &whole);
}

/* ---- its solution ---- */

/* residual = rhs - (matrix with the present B, without eps) solution; returns the largest residual of B x = B u
 * relative to its terms. */
static double find_residual(hk_dynamics *d) {
  hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  const double *x = s->solution, *l = x + s->rows;
  double worst = 0, *left = s->residual + s->rows, *size = s->correction + s->rows;
  for (size_t r = 0; r < s->rows; r++) {
    double sum = s->rhs[r];
    for (size_t e = s->matrix.row_start[r]; e < s->matrix.row_start[r + 1] && s->matrix.column[e] < s->rows; e++)
      sum -= s->value[e] * x[s->matrix.column[e]];
    s->residual[r] = sum;
  }
  for (size_t k = 0; k < s->equations; k++) {
    left[k] = s->scale[k] > 0 ? s->rhs[s->rows + k] : 0;
    size[k] = fabs(left[k]);
  }
  for (size_t b = 0; b < c->blocks; b++) {
    size_t k = c->list.pair[b][0], row = 3 * (size_t)c->list.pair[b][1];
    for (size_t a = 0; a < 3; a++) {
      s->residual[row + a] -= s->B[b][a] * l[k];
      left[k] -= s->B[b][a] * x[row + a];
      size[k] += fabs(s->B[b][a] * x[row + a]);
    }
  }
  for (size_t k = 0; k < s->equations; k++)
    if (size[k] > 0) worst = fmax(worst, fabs(left[k]) / size[k]);
  return worst;
}

static void set_right_hand_side(hk_dynamics *d, const double *b, const double *u) {
  hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  double *g = s->rhs + s->rows;
  memcpy(s->rhs, b, s->rows * sizeof *b);
  memset(g, 0, s->equations * sizeof *g);
  for (size_t k = 0; k < c->blocks; k++) {
    uint32_t i = c->list.pair[k][1];
    const double *from = u ? u + 3 * (size_t)i : b + 3 * (size_t)i;
    double w = u ? 1 : d->state->inverse_mass[i];
    for (size_t a = 0; a < 3; a++) g[c->list.pair[k][0]] += w * s->B[k][a] * from[a];
  }
}

hk_status hk_saddle_point_solve(hk_dynamics *d, const double *b, const double *u, double *x, hk_solve_info *info) {
  hk_saddle_point *s = d->saddle;
  if (!s->linear.analyzed || !s->value || s->revision != d->constraints->revision)
    return hk_error_set(d->error, HK_FAILED, "a system was solved before its factorization");
  take_jacobian(d);
  set_right_hand_side(d, b, u);
  hk_solve_info own = {0, NAN, info ? info->tolerance : 0};
  hk_status status = hk_linear_system_solve(d, &s->linear, s->rhs, s->solution, &own);
  double last = INFINITY;
  for (int round = 0; round < REFINEMENTS && status == HK_OK; round++) {
    double left = find_residual(d);
    if (!(left > enough) || left > 0.5 * last) break;
    last = left;
    status = hk_linear_system_solve(d, &s->linear, s->residual, s->correction, NULL);
    for (size_t k = 0; k < s->rows + s->equations && status == HK_OK; k++) s->solution[k] += s->correction[k];
  }
  if (status == HK_OK) memcpy(x, s->solution, s->rows * sizeof *x);
  if (info) *info = own;
  return status;
}

/* ---- the stiffness of constraint forces ---- */

/* Sorts blocks by a key: side 0 is their equation, side 1 their particle. On entry `start` is keys + 2 zeros. */
static void group(const hk_constraints *c, int side, size_t keys, size_t *start, uint32_t *order) {
  for (size_t b = 0; b < c->blocks; b++) start[c->list.pair[b][side] + 2]++;
  for (size_t k = 0; k < keys; k++) start[k + 2] += start[k + 1];
  for (size_t b = 0; b < c->blocks; b++) order[start[c->list.pair[b][side] + 1]++] = (uint32_t)b;
}

/* Gives each particle the lowest colour that no particle sharing an equation with it has. */
static void paint(hk_saddle_point *s, const hk_constraints *c, size_t n, const size_t *start, const uint32_t *order) {
  for (size_t i = 0; i < n; i++) {
    uint64_t used = 0;
    unsigned colour = 0;
    s->colour[i] = MOST_COLOURS;
    for (size_t p = start[i]; p < start[i + 1]; p++) {
      uint32_t k = c->list.pair[order[p]][0];
      for (size_t q = s->start[k]; q < s->start[k + 1]; q++)
        used |= (uint64_t)1 << s->colour[c->list.pair[s->order[q]][1]];
    }
    while (used >> colour & 1 && colour < MOST_COLOURS) colour++;
    s->colour[i] = (uint8_t)colour;
    if (start[i + 1] > start[i] && colour + 1 > s->colours) s->colours = colour + 1;
  }
}

static hk_status find_groups(hk_dynamics *d) {
  hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  size_t n = d->state->model.n, *start = calloc(n + 2, sizeof *start);
  uint32_t *order = malloc((c->blocks + 1) * sizeof *order);
  drop_groups(s);
  s->colour = malloc(n + 1);
  s->start = calloc(c->equations + 2, sizeof *s->start);
  s->order = malloc((c->blocks + 1) * sizeof *s->order);
  s->x = malloc((3 * n + 1) * sizeof *s->x);
  s->J = malloc((c->blocks + 1) * sizeof *s->J);
  bool fine = start && order && s->colour && s->start && s->order && s->x && s->J;
  if (fine) {
    memset(s->colour, MOST_COLOURS + 1, n);
    group(c, 0, c->equations, s->start, s->order);
    group(c, 1, n, start, order);
    paint(s, c, n, start, order);
    if (s->colours > MOST_COLOURS) s->colours = 0;
  }
  free(start);
  free(order);
  return fine ? HK_OK
              : hk_error_set(d->error, HK_NO_MEMORY, "no memory for the stiffness of %zu constraints", c->equations);
}

hk_status hk_saddle_point_name(hk_dynamics *d, hk_pattern *pattern) {
  hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  hk_status status = find_groups(d);
  if (status != HK_OK || s->colours == 0) return status;
  for (size_t k = 0; k < c->equations; k++)
    for (size_t p = s->start[k]; p < s->start[k + 1]; p++)
      for (size_t q = s->start[k]; q < s->start[k + 1]; q++)
        pattern->block(pattern, c->list.pair[s->order[p]][1], c->list.pair[s->order[q]][1]);
  return HK_OK;
}

/* K -= lambda dJ/dx for displacements along `axis` of the particles of one colour. */
static void add_difference(const hk_dynamics *d, unsigned colour, int axis, double by, const size_t *slot, double *K) {
  const hk_saddle_point *s = d->saddle;
  const hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) {
    size_t first = s->start[k], count = s->start[k + 1] - first;
    for (size_t q = 0; q < count; q++) {
      if (s->colour[c->list.pair[s->order[first + q]][1]] != colour) continue;
      for (size_t p = 0; p < count; p++) {
        uint32_t b = s->order[first + p];
        double *block = K + 9 * slot[p * count + q];
        for (int a = 0; a < 3; a++) block[3 * a + axis] -= c->lambda[k] * (s->J[b][a] - c->J[b][a]) / by;
      }
      break; /* one perturbed particle suffices: if it is named twice in an equation, both its blocks are in J */
    }
    slot += count * count;
  }
}

hk_status hk_saddle_point_stiffness(hk_dynamics *d, double t, const double *x, const double *v, const size_t *slot,
                                    double *K) {
  hk_saddle_point *s = d->saddle;
  size_t n = d->state->model.n;
  double extent = 0;
  if (s->colours == 0) return HK_OK;
  for (size_t e = 0; e < 3 * n; e++) extent = fmax(extent, fabs(x[e]));
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  memcpy(s->x, x, 3 * n * sizeof *x);
  for (unsigned step = 0; step < 3 * s->colours && status == HK_OK; step++) {
    unsigned colour = step / 3, axis = step % 3;
    double by = difference * (extent > 0 ? extent : 1);
    for (size_t i = 0; i < n; i++)
      if (s->colour[i] == colour) s->x[3 * i + axis] += by;
    hk_riders_follow(&d->state->model, s->x);
    status = hk_constraint_jacobian(d, t, s->x, v, s->J);
    if (status == HK_OK) add_difference(d, colour, (int)axis, by, slot, K);
    for (size_t i = 0; i < n; i++)
      if (s->colour[i] == colour) s->x[3 * i + axis] = x[3 * i + axis];
  }
  return status;
}
