/* K = -dF/dx and D = -dF/dv of all forces together, in 3x3 blocks with one pattern, and the scene's solver.
 *
 * Once per topology every force names its blocks; after the whole diagonal they are merged into one pattern, and each
 * force keeps the slots of what it named. An evaluation zeroes the two value arrays and lets every acting force add.
 * The pattern holds all forces, acting or not, so that a force that sets in later costs no new analysis. Invariant:
 * slot[first[k] + e] is where the e-th block of force k goes. */
#include "core/block_matrix.h"
#include "core/linear.h"

#include <stdlib.h>
#include <string.h>

struct hk_assembly {
  hk_block_matrix matrix;
  size_t *first; /* one per force: position in matrix.slot */
  double *K, *D; /* blocks x 9; NULL: the pattern is void */
  bool symmetric;
  hk_linear linear;
};

static hk_run *run_of(hk_system *s) { return (hk_run *)(void *)s; }

static hk_assembly *assembly_of(hk_run *run) {
  if (!run->assembly) run->assembly = calloc(1, sizeof *run->assembly);
  if (!run->assembly) hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the Jacobian");
  return run->assembly;
}

static hk_status name_blocks(hk_run *run, hk_assembly *s) {
  size_t n = run->model.n;
  hk_block_matrix_begin(&s->matrix, n, n);
  s->symmetric = true;
  for (size_t i = 0; i < n; i++) s->matrix.naming.block(&s->matrix.naming, (uint32_t)i, (uint32_t)i);
  for (size_t k = 0; k < run->scene->force.count; k++) {
    hk_instance *force = run->scene->force.item[k];
    const hk_force *functions = force->plugin->force;
    s->first[k] = s->matrix.named;
    if (!functions->jacobian && functions->flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V))
      return hk_error_set(&run->error, HK_FAILED, "force '%s' offers no Jacobian, which %s needs", force->label,
                          run->scene->integrator->plugin->name);
    if (!functions->jacobian) continue;
    if (functions->pattern) functions->pattern(force->self, &run->force_view[k], &s->matrix.naming);
    if (s->matrix.out_of_range)
      return hk_error_set(&run->error, HK_FAILED, "force '%s' names a block of a particle that is not there",
                          force->label);
    s->symmetric = s->symmetric && functions->flags & HK_SYMMETRIC_JACOBIAN;
  }
  return HK_OK;
}

static void drop(hk_assembly *s) {
  hk_block_matrix_free(&s->matrix);
  free(s->first);
  free(s->K);
  free(s->D);
  s->first = NULL;
  s->K = s->D = NULL;
}

static hk_status build(hk_run *run, hk_assembly *s) {
  drop(s);
  s->first = calloc(run->scene->force.count + 1, sizeof *s->first);
  hk_status status = s->first ? name_blocks(run, s) : HK_NO_MEMORY;
  if (status == HK_OK) status = hk_block_matrix_build(&s->matrix);
  if (status == HK_OK) {
    size_t blocks = s->matrix.row_start[s->matrix.rows];
    s->K = malloc((9 * blocks + 1) * sizeof *s->K);
    s->D = malloc((9 * blocks + 1) * sizeof *s->D);
  }
  if (s->K && s->D) return HK_OK;
  if (status == HK_OK) status = HK_NO_MEMORY;
  hk_error_set(&run->error, status, "no memory for the Jacobian of %zu particles", run->model.n);
  return status;
}

static hk_status fill(hk_run *run, hk_assembly *s, double t, const double *X) {
  size_t n = run->model.n, numbers = 9 * s->matrix.row_start[n];
  memset(s->K, 0, numbers * sizeof *s->K);
  memset(s->D, 0, numbers * sizeof *s->D);
  hk_status status = HK_OK;
  for (size_t k = 0; k < run->scene->force.count && status == HK_OK; k++) {
    const hk_instance *force = run->scene->force.item[k];
    if (!run->force_acts[k] || !force->plugin->force->jacobian) continue;
    hk_view view = run->force_view[k];
    view.t = t;
    view.x = X;
    view.v = X + 3 * n;
    view.y = run->width ? X + 6 * n : NULL;
    view.power = NULL;
    hk_blocks into = {s->matrix.slot + s->first[k], s->K, s->D};
    status = force->plugin->force->jacobian(force->self, &view, &into);
  }
  return status;
}

hk_status hk_jacobian_assemble(hk_system *system, double t, double *X, hk_matrix *K, hk_matrix *D) {
  hk_run *run = run_of(system);
  hk_assembly *s = assembly_of(run);
  hk_status status = s ? hk_pins_impose(run, t, X, X + 3 * run->model.n) : HK_NO_MEMORY;
  if (status == HK_OK && (!s->K || !s->D)) status = build(run, s);
  if (status == HK_OK) status = fill(run, s, t, X);
  if (status != HK_OK) return status;
  *K = (hk_matrix){s->matrix.rows, 3, s->matrix.row_start, s->matrix.column, s->K, s->symmetric};
  *D = *K;
  D->value = s->D;
  run->jacobians++;
  return HK_OK;
}

hk_status hk_solver_get(hk_run *run, hk_instance **solver) {
  hk_scene *scene = run->scene;
  hk_status status = HK_OK;
  if (!scene->solver) {
    status = hk_scene_add_plugin(scene, HK_SOLVER, "cholmod", NULL, "", &scene->solver, &run->error);
    if (status == HK_OK) status = hk_instance_check(scene->solver, &run->error);
    if (status != HK_OK) return status;
  }
  if (!scene->solver->started) {
    hk_view view = run->view;
    view.host = &scene->solver->host;
    status = hk_instance_start(scene->solver, &view, run->system.size, &run->error);
  }
  *solver = scene->solver;
  return status;
}

hk_status hk_jacobian_factorize(hk_system *system, const hk_matrix *A) {
  hk_run *run = run_of(system);
  hk_assembly *s = assembly_of(run);
  hk_status status = s ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK && !s->linear.solver) status = hk_solver_get(run, &s->linear.solver);
  return status == HK_OK ? hk_linear_factorize(run, &s->linear, A) : status;
}

hk_status hk_jacobian_solve(hk_system *system, const double *b, double *x, hk_solve_info *info) {
  hk_run *run = run_of(system);
  hk_assembly *s = run->assembly;
  if (!s || !s->linear.analyzed)
    return hk_error_set(&run->error, HK_FAILED, "a system was solved before its factorization");
  return hk_linear_solve(run, &s->linear, b, x, info);
}

void hk_jacobian_topology(hk_run *run) {
  if (!run->assembly) return;
  drop(run->assembly);
  run->assembly->linear.analyzed = false;
}

void hk_jacobian_close(hk_run *run) {
  hk_assembly *s = run->assembly;
  if (!s) return;
  drop(s);
  free(s);
  run->assembly = NULL;
}
