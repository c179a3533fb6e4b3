/* Linear systems of plugins that are no methods, the host's service "solvers/1". Each has solver instances of its own,
 * which come into being when a pattern wants them, so that nothing is shared with the method's or with another
 * plugin's.
 *
 * What comes back is tried, since a matrix without an inverse may well have factors up to rounding: A is kept, and the
 * residual of a solution is compared with its right-hand side in the largest norm. A backward stable solution has
 * |A x - b| <= c eps |A| |x| (Higham 2002, Accuracy and Stability of Numerical Algorithms, sections 9.3 and 10.1),
 * which exceeds 1e-6 |b| where x is above 1e10 |b| / |A|. A random b has a part in every direction, also in the null
 * space. */
#include "core/numerics/matrix/matrix.h"

#include <stdlib.h>
#include <string.h>

enum { LARGE = 300000 };                 /* unknowns, above which factors take too much memory: see linear_system.c */
static const double largest_left = 1e-6; /* of b; inverses of matrices with a condition of some 1e10 keep below it */

/* The solvers that a system may have: for patterns of a kind, for any, for very many unknowns. */
enum { SPECIAL, DIRECT, ITERATIVE, CHOICES };

struct hk_linear {
  hk_linear *next;
  struct hk_asked_solver *owner;
  const hk_instance *asker;
  const hk_plugin_spec *named; /* the scene's or one by name: no choice is left; or NULL */
  hk_plugin_spec *spec[CHOICES];
  hk_instance *solver[CHOICES]; /* NULL: no pattern has wanted it yet; of a named one DIRECT alone */
  hk_plugin_spec *own;          /* the one by name */
  unsigned needs;
  hk_linear_system system;
  bool stale; /* the next pattern is to be analysed even if it is the last one */
  hk_matrix A;
  size_t *row_start;
  uint32_t *column;
  double *value, *b, *x; /* b, x: rows x block, for the trial */
};

struct hk_asked_solver {
  hk_solvers table;
  hk_dynamics *dynamics;
  const hk_plugin_spec *scene;
  hk_linear *first;
};

/* ---- errors ---- */

/* The message says who asked; what the solver said, if anything, comes after it. */
static hk_status explain(const hk_linear *l, hk_status status, const char *why) {
  hk_error *error = l->owner->dynamics->error, before = *error;
  *error = (hk_error){0};
  return hk_error_set(error, status, "%s%s%s: its linear system of %zu unknowns: %s%s%.500s", l->asker->where,
                      *l->asker->where ? ": " : "", l->asker->label, l->A.rows * l->A.block, why,
                      *why && *before.text ? ": " : "", before.text);
}

static hk_status no_memory(const hk_linear *l) { return explain(l, HK_NO_MEMORY, "there is no memory for it"); }

/* ---- which solver ---- */

static bool has(const hk_plugin *plugin, unsigned needs) { return (plugin->solver->flags & needs) == needs; }

static bool special_suits(const hk_plugin *plugin, const void *context) {
  return plugin->solver->fits && has(plugin, *(const unsigned *)context);
}

static bool direct_suits(const hk_plugin *plugin, const void *context) {
  return !plugin->solver->fits && !(plugin->solver->flags & HK_ITERATIVE) && has(plugin, *(const unsigned *)context);
}

static bool iterative_suits(const hk_plugin *plugin, const void *context) {
  return !plugin->solver->fits && plugin->solver->flags & HK_ITERATIVE && has(plugin, *(const unsigned *)context);
}

/* HK_FAILED: none is installed. */
static hk_status make(hk_linear *l, int which) {
  static bool (*const suits[CHOICES])(const hk_plugin *, const void *) = {special_suits, direct_suits, iterative_suits};
  hk_dynamics *d = l->owner->dynamics;
  const hk_plugin *plugin = NULL;
  if (l->solver[which]) return HK_OK;
  if (!l->named && !l->spec[which]) {
    hk_error none = {0};
    hk_status status = hk_registry_prefer(d->shared->registry, HK_SOLVER, suits[which], &l->needs, &plugin, &none);
    if (status != HK_OK) return status;
    l->spec[which] = hk_spec_create(plugin, plugin->name, "", d->error);
    if (!l->spec[which]) return HK_NO_MEMORY;
  }
  hk_instance *made = hk_instance_create(l->named ? l->named : l->spec[which], d->shared, d->error);
  if (!made) return HK_NO_MEMORY;
  hk_view view = hk_instance_view(made, &d->state->view);
  hk_status status = hk_instance_set_time(made, d->state->t, d->error);
  if (status == HK_OK) status = hk_instance_start(made, &view, d->state->size, d->error);
  if (status == HK_OK)
    l->solver[which] = made;
  else
    hk_instance_destroy(made);
  return status;
}

static bool fits(hk_linear *l) {
  hk_instance *solver = l->solver[SPECIAL];
  const hk_instance *outer = hk_enter(solver);
  bool fine = solver->plugin->solver->fits(solver->self, &l->A);
  hk_leave(solver, outer);
  return fine;
}

/* The solver in use becomes the one for the pattern of A. */
static hk_status choose(hk_linear *l) {
  int which = DIRECT;
  hk_status status = l->named ? HK_FAILED : make(l, SPECIAL);
  if (status == HK_OK && fits(l)) {
    which = SPECIAL;
  } else if (status == HK_OK || status == HK_FAILED) {
    bool large = !l->named && l->A.rows * l->A.block > LARGE && make(l, ITERATIVE) == HK_OK;
    which = large ? ITERATIVE : DIRECT;
    status = make(l, which);
  }
  l->system.solver = l->solver[which];
  return status == HK_OK ? HK_OK : explain(l, status, "no solver can be had for it");
}

static hk_status choose_named(hk_linear *l, const char *name) {
  hk_dynamics *d = l->owner->dynamics;
  const hk_plugin_spec *scene = l->owner->scene;
  const hk_plugin *plugin = NULL;
  if (!name) {
    l->named = scene && has(scene->plugin, l->needs) ? scene : NULL;
    return HK_OK;
  }
  hk_status status = hk_registry_find(d->shared->registry, HK_SOLVER, name, false, &plugin, d->error);
  if (status != HK_OK) return explain(l, HK_BAD_PARAM, "");
  if (!has(plugin, l->needs))
    return hk_error_set(d->error, HK_BAD_PARAM,
                        "%s%s%s: the solver '%s' takes no %s matrices, as the plugin's are: name another one",
                        l->asker->where, *l->asker->where ? ": " : "", l->asker->label, name,
                        l->needs & ~plugin->solver->flags & HK_SOLVES_UNSYMMETRIC ? "unsymmetric" : "indefinite");
  if (scene && scene->plugin == plugin)
    l->named = scene; /* with the scene's parameters */
  else
    l->named = l->own = hk_spec_create(plugin, plugin->name, "", d->error);
  return l->named ? HK_OK : HK_NO_MEMORY;
}

/* ---- the matrix ---- */

/* What is wrong with the rows of A; NULL: nothing. */
static const char *wrong_pattern(const hk_matrix *A) {
  if (A->rows == 0 || A->rows > UINT32_MAX) return "the matrix has no rows, or too many";
  if (A->block != 1 && A->block != 3) return "its blocks have neither 1 nor 3 rows";
  if (A->row_start[0] != 0) return "its first row does not begin at 0";
  for (size_t r = 0; r < A->rows; r++) {
    if (A->row_start[r + 1] < A->row_start[r]) return "a row ends before it begins";
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
      if (A->column[e] >= A->rows) return "a column lies outside of the matrix";
      if (e > A->row_start[r] && A->column[e] <= A->column[e - 1]) return "the columns of a row do not rise";
    }
  }
  return NULL;
}

static void forget_matrix(hk_linear *l) {
  free(l->row_start);
  free(l->column);
  free(l->value);
  free(l->b);
  l->row_start = NULL, l->column = NULL, l->value = NULL, l->b = NULL, l->x = NULL;
  l->system.analyzed = false;
}

static hk_status take_pattern(hk_linear *l, const hk_matrix *A, uint64_t number) {
  size_t count = A->row_start[A->rows], unknowns = A->rows * A->block;
  forget_matrix(l);
  l->row_start = malloc((A->rows + 1) * sizeof *l->row_start);
  l->column = malloc((count + 1) * sizeof *l->column);
  l->value = malloc((A->block * A->block * count + 1) * sizeof *l->value);
  l->b = malloc(2 * unknowns * sizeof *l->b);
  if (!l->row_start || !l->column || !l->value || !l->b) return no_memory(l);
  l->x = l->b + unknowns;
  memcpy(l->row_start, A->row_start, (A->rows + 1) * sizeof *l->row_start);
  memcpy(l->column, A->column, count * sizeof *l->column);
  l->A = (hk_matrix){A->rows, A->block, l->row_start, l->column, l->value, false, number};
  return choose(l);
}

static hk_status take_values(hk_linear *l, const hk_matrix *A) {
  size_t bb = A->block * A->block;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = bb * A->row_start[r]; e < bb * A->row_start[r + 1]; e++) {
      if (isfinite(A->value[e])) continue;
      char why[80];
      snprintf(why, sizeof why, "row %zu of the matrix has the number %g", r, A->value[e]);
      return explain(l, HK_NOT_FINITE, why);
    }
  memcpy(l->value, A->value, bb * A->row_start[A->rows] * sizeof *l->value);
  bool any = l->system.solver->plugin->solver->flags & HK_SOLVES_UNSYMMETRIC;
  double off = hk_matrix_asymmetry(&l->A);
  l->A.symmetric = !(off > hk_asymmetry_limit);
  if (any || l->A.symmetric) return HK_OK;
  char why[240];
  snprintf(why, sizeof why,
           "its solver '%s' takes symmetric matrices only, and this one differs from its transpose by %.2g of its "
           "largest number: the plugin has to ask for HK_SOLVES_UNSYMMETRIC",
           l->system.solver->label, off);
  return explain(l, HK_FAILED, why);
}

/* ---- solutions ---- */

/* |A x - b| and |b|, their largest numbers; INFINITY where x is not finite. */
static double left_over(const hk_matrix *A, const double *x, const double *b, double *size) {
  double most = 0;
  *size = 0;
  for (size_t r = 0; r < A->rows * A->block; r++) {
    size_t row = r / A->block;
    double sum = -b[r];
    for (size_t e = A->row_start[row]; e < A->row_start[row + 1]; e++)
      for (size_t c = 0; c < A->block; c++)
        sum += A->value[A->block * (A->block * e + r % A->block) + c] * x[A->block * A->column[e] + c];
    if (!isfinite(sum) || !isfinite(x[r])) return INFINITY;
    most = fmax(most, fabs(sum));
    *size = fmax(*size, fabs(b[r]));
  }
  return most;
}

static hk_status try_factors(hk_linear *l) {
  double size, left;
  if (l->system.solver->plugin->solver->flags & HK_ITERATIVE) return HK_OK;
  uint64_t state[4];
  hk_random_seed(state, 1);
  for (size_t r = 0; r < l->A.rows * l->A.block; r++) l->b[r] = 2 * hk_random_uniform(state) - 1;
  hk_status status = hk_linear_system_solve(l->owner->dynamics, &l->system, l->b, l->x, NULL);
  if (status != HK_OK) return explain(l, status, "");
  left = left_over(&l->A, l->x, l->b, &size);
  if (left <= largest_left * size) return HK_OK;
  return explain(l, HK_FAILED,
                 "the matrix is singular up to rounding, so that it has no single solution: hold a place of each part "
                 "that is not joined to the others");
}

static hk_status asked_factorize(hk_linear *l, const hk_matrix *A) {
  const char *wrong = wrong_pattern(A);
  if (wrong) return explain(l, HK_FAILED, wrong);
  uint64_t number = hk_pattern_number(A->rows, A->block, A->row_start, A->column);
  bool known = l->system.analyzed && !l->stale && number == l->system.pattern;
  hk_status status = known ? HK_OK : take_pattern(l, A, number);
  if (status == HK_OK) status = take_values(l, A);
  if (status != HK_OK) return status;
  l->stale = false;
  status = hk_linear_system_factors(l->owner->dynamics, &l->system, &l->A, number);
  status = status == HK_OK ? try_factors(l) : explain(l, status, "");
  if (status != HK_OK) l->system.analyzed = false;
  return status;
}

static hk_status asked_solve(hk_linear *l, const double *b, double *x, hk_solve_info *info) {
  double size, left;
  if (!l->system.analyzed) return explain(l, HK_FAILED, "it is solved before it was factorized");
  hk_status status = hk_linear_system_solve(l->owner->dynamics, &l->system, b, x, info);
  if (status != HK_OK) return explain(l, status, "");
  left = left_over(&l->A, x, b, &size);
  if (left <= fmax(largest_left, info ? 2 * info->tolerance : 0) * size) return HK_OK;
  char why[120];
  snprintf(why, sizeof why, "|A x - b| is %.2g of |b|: the matrix is singular, or nearly so", left / size);
  return explain(l, HK_NOT_CONVERGED, why);
}

/* ---- the table ---- */

static void free_linear(hk_linear *l) {
  forget_matrix(l);
  for (int k = 0; k < CHOICES; k++) {
    hk_instance_destroy(l->solver[k]);
    hk_spec_destroy(l->spec[k]);
  }
  hk_spec_destroy(l->own);
  free(l);
}

static hk_status asked_open(void *self, const hk_host *host, const char *name, unsigned needs, hk_linear **made) {
  struct hk_asked_solver *all = self;
  hk_linear *l = calloc(1, sizeof *l);
  if (!l) return hk_error_set(all->dynamics->error, HK_NO_MEMORY, "no memory for a linear system");
  l->owner = all;
  l->asker = (const hk_instance *)(const void *)host; /* its first member */
  l->needs = needs & (HK_SOLVES_UNSYMMETRIC | HK_SOLVES_INDEFINITE);
  hk_status status = choose_named(l, name);
  if (status != HK_OK) {
    free_linear(l);
    return status;
  }
  l->next = all->first;
  all->first = *made = l;
  return HK_OK;
}

const hk_solvers *hk_asked_solvers(hk_dynamics *d, const hk_plugin_spec *scene) {
  if (!d->asked) d->asked = calloc(1, sizeof *d->asked);
  if (!d->asked) return NULL;
  d->asked->table = (hk_solvers){d->asked, asked_open, asked_factorize, asked_solve};
  d->asked->dynamics = d;
  d->asked->scene = scene;
  return &d->asked->table;
}

void hk_asked_solvers_forget(hk_dynamics *d) {
  for (hk_linear *l = d->asked ? d->asked->first : NULL; l; l = l->next) l->stale = true;
}

void hk_asked_solvers_close(hk_dynamics *d) {
  for (hk_linear *l = d->asked ? d->asked->first : NULL, *next; l; l = next) {
    next = l->next;
    free_linear(l);
  }
  free(d->asked);
  d->asked = NULL;
}
