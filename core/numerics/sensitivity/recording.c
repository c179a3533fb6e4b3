/* The record of a run's steps, and the steps taken again. */
#include "core/engine/contract/contract.h"
#include "core/numerics/sensitivity/implicit_stage.h"
#include "core/numerics/sensitivity/linearised/linearised.h"
#include "core/numerics/sensitivity/projection.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Such a part of the scene's extent and of its speeds, the end of the steps taken again may be off: rounding, which
 * motion without order makes larger. */
static const double tolerance = 1e-6;

/* ---- what cannot be differentiated ---- */

static hk_status refuse_method(const hk_loop *loop, hk_error *error) {
  if (hk_integrator_tables_of(loop->method)->stages.count > 0) return HK_OK;
  return hk_error_set(
      error, HK_FAILED,
      "integrator '%s' does not state its step as stages (%s), by which steps are differentiated: choose "
      "one that does, with --integrator",
      loop->integrator->plugin->name, HK_STAGES_ID);
}

static hk_status refuse_kinds(const hk_loop *loop, hk_error *error) {
  static const hk_kind kinds[] = {HK_CORRECTOR, HK_SOURCE};
  for (int k = 0; k < 2; k++)
    if (loop->plugins->kind[kinds[k]].count)
      return hk_error_set(error, HK_FAILED,
                          "%s '%s' acts on the steps, and is not differentiated: leave it out (--without), or take "
                          "forces in its place, stiff ones with an implicit integrator",
                          hk_kind_name(kinds[k]), loop->plugins->kind[kinds[k]].item[0]->label);
  if (loop->state->width)
    return hk_error_set(error, HK_FAILED, "the scene has channels, which are not differentiated: leave them out");
  return HK_OK;
}

static bool begins_or_ends(const hk_plugin_spec *spec, double t) { return spec->from > t || isfinite(spec->to); }

static hk_status refuse_force(const hk_instance *force, double t, hk_error *error) {
  const hk_force_tables *f = hk_force_of(force->plugin);
  if (begins_or_ends(force->spec, t))
    return hk_error_set(
        error, HK_FAILED,
        "force '%s' begins or ends at a time, which is not differentiated: give it a smooth function of "
        "t",
        force->label);
  if (f->steps.update)
    return hk_error_set(
        error, HK_FAILED,
        "force '%s' is contact, whose begin and end are not differentiated: leave it out (--without), or "
        "compare whole runs (hooke sweep)",
        force->label);
  if ((f->steps.accepted && !f->steps.keeps_branch) || f->internal.evolve)
    return hk_error_set(error, HK_FAILED,
                        "force '%s' remembers what happened, which is not differentiated: compare whole runs (hooke "
                        "sweep)",
                        force->label);
  return HK_OK;
}

static hk_status refuse(const hk_loop *loop, hk_error *error) {
  hk_status status = refuse_method(loop, error);
  if (status == HK_OK) status = refuse_kinds(loop, error);
  if (status == HK_OK) status = hk_projection_refuse(loop, error);
  if (status == HK_OK && hk_integrator_tables_of(loop->method)->stages.linear)
    status = hk_linearised_refuse(loop, error);
  for (size_t k = 0; k < loop->plugins->kind[HK_FORCE].count && status == HK_OK; k++)
    status = refuse_force(loop->plugins->kind[HK_FORCE].item[k], loop->state->t, error);
  for (size_t k = 0; k < loop->pins->count && status == HK_OK; k++)
    if (isfinite(loop->pins->item[k].spec->release))
      status = hk_error_set(error, HK_FAILED,
                            "a pin is released at t = %g s, which is not differentiated: begin the scene there",
                            loop->pins->item[k].spec->release);
  return status;
}

/* ---- the record ---- */

/* The size of the motion. Its end alone may have none: one particle that comes to rest is a point without speed. */
static void note_size(hk_sensitivity *s) {
  const double *X = s->loop->state->X;
  for (size_t e = 0; e < 3 * s->n; e++) {
    s->extent = fmax(s->extent, fabs(X[e] - s->start[e % 3]));
    s->speed = fmax(s->speed, fabs(X[3 * s->n + e]));
  }
}

static void note_step(void *context, double h) {
  hk_sensitivity *s = context;
  void *list = s->step;
  if (hk_array_reserve(&list, &s->room, s->steps + 1, sizeof *s->step) != 0) s->no_memory = true;
  s->step = list;
  if (s->no_memory) return;
  const hk_taken_step *last = s->steps ? &s->step[s->steps - 1] : NULL;
  hk_taken_step taken = {.t = s->reached, .h = h, .fresh = !last || last->h != h};
  if (s->linearised) {
    hk_linear_step how = s->method->linear(s->loop->integrator->self);
    taken.linear = how == HK_STEP_LINEAR && last; /* of a run from a checkpoint the end is found to be elsewhere */
    taken.fresh = how == HK_STEP_AFRESH || !last;
  }
  s->step[s->steps] = taken;
  s->steps++;
  s->reached = s->loop->state->t;
  note_size(s);
}

/* The other hooks of the run, with their own context. */
static hk_status frame(void *context) {
  const hk_loop_hooks *h = &((hk_sensitivity *)context)->hooks;
  return h->frame ? h->frame(h->context) : HK_OK;
}

static hk_status framed(void *context) {
  const hk_loop_hooks *h = &((hk_sensitivity *)context)->hooks;
  return h->framed ? h->framed(h->context) : HK_OK;
}

static void now_and_then(void *context) {
  const hk_loop_hooks *h = &((hk_sensitivity *)context)->hooks;
  if (h->now_and_then) h->now_and_then(h->context);
}

static void find_exact(hk_sensitivity *s) {
  const hk_instances *forces = &s->loop->plugins->kind[HK_FORCE];
  s->all_exact = true;
  for (size_t k = 0; k < forces->count; k++) {
    const hk_force_tables *f = hk_force_of(forces->item[k]->plugin);
    bool constant = !(f->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V));
    s->exact[k] = constant || (f->implicit.jacobian && !(f->own.flags & HK_STIFFER_BLOCKS));
    if (s->exact[k]) continue;
    s->all_exact = false;
    s->inexact = forces->item[k]->label;
  }
}

static bool has_implicit(const hk_stages_facet *m) {
  bool any = false;
  for (size_t k = 0; k < m->count; k++) any |= hk_implicit_stage_is(m, k);
  return any;
}

static hk_status reserve(hk_sensitivity *s) {
  size_t v = 3 * s->n, stages = s->stages;
  s->exact = calloc(s->loop->plugins->kind[HK_FORCE].count + 1, sizeof *s->exact);
  s->start = malloc((2 * v + 1) * sizeof *s->start);
  if (hk_projection_open(s) != HK_OK) return HK_NO_MEMORY;
  s->each = 3 * v * stages + hk_projection_taped(s);
  s->scratch = malloc((5 * v + s->each + 1) * sizeof *s->scratch);
  bool implicit = has_implicit(s->method) || (s->method->start && has_implicit(s->method->start));
  if (implicit) s->implicit = hk_implicit_stage_create(s->n);
  if (!s->exact || !s->start || !s->scratch || (implicit && !s->implicit)) return HK_NO_MEMORY;
  if (s->method->linear && s->method->start && hk_linearised_open(s) != HK_OK) return HK_NO_MEMORY;
  hk_sensitivity_untape(s);
  memcpy(s->start, s->loop->state->X, 2 * v * sizeof *s->start);
  return HK_OK;
}

hk_status hk_sensitivity_open(hk_loop *loop, hk_sensitivity **made, hk_error *error) {
  hk_status status = refuse(loop, error);
  hk_sensitivity *s = status == HK_OK ? calloc(1, sizeof *s) : NULL;
  *made = s;
  if (status != HK_OK) return status;
  if (!s) return hk_error_set(error, HK_NO_MEMORY, "no memory for the record of steps");
  s->loop = loop;
  s->dynamics = loop->dynamics;
  s->method = &hk_integrator_tables_of(loop->method)->stages;
  s->n = loop->state->model.n;
  s->stages = s->method->count;
  if (s->method->start && s->method->start->count > s->stages) s->stages = s->method->start->count;
  s->wide = (s->method->linear ? 18 : s->method->back != 0 ? 15 : 9) * s->n;
  s->reached = loop->state->t;
  if (reserve(s) != HK_OK) return hk_error_set(error, HK_NO_MEMORY, "no memory for the record of steps");
  find_exact(s);
  if (s->implicit && !s->all_exact)
    return hk_error_set(error, HK_FAILED,
                        "force '%s' states no exact Jacobian, by which steps of the implicit method '%s' are "
                        "differentiated: choose an explicit one, with --integrator",
                        s->inexact, loop->integrator->plugin->name);
  s->hooks = loop->hooks;
  loop->hooks =
      (hk_loop_hooks){.context = s, .frame = frame, .framed = framed, .moved = note_step, .now_and_then = now_and_then};
  return HK_OK;
}

/* ---- the steps taken again ---- */

/* As many steps as the tape takes at least, and sqrt N: so memory grows no faster. */
static size_t stride_of(size_t steps, size_t each) {
  double room = HK_TAPE_MOST / ((double)each * sizeof(double) + 1);
  double stride = fmin(fmax(floor(room), ceil(sqrt((double)steps))), (double)steps);
  return stride > 1 ? (size_t)stride : 1;
}

static double bytes_by(double stride, size_t steps, size_t each, size_t wide) {
  double kept = ceil((double)steps / stride);
  return (kept * (double)wide + stride * (double)each) * sizeof(double);
}

double hk_sensitivity_bytes(size_t steps, size_t each, size_t wide) {
  return bytes_by((double)stride_of(steps, each), steps, each, wide);
}

double hk_sensitivity_kept_bytes(const hk_sensitivity *s) {
  return s->stride ? bytes_by((double)s->stride, s->steps, s->each, s->wide)
                   : hk_sensitivity_bytes(s->steps, s->each, s->wide);
}

/* The largest difference of places or of speeds at the end, relative to their size on the way; of speeds, which may be
 * rounding in a scene at rest, at least to that which crosses the scene in the time. */
static double off_by(const hk_sensitivity *s, const double *X, double time) {
  const double *Y = s->loop->state->X;
  const double size[2] = {s->extent, fmax(s->speed, time > 0 ? s->extent / time : 0)};
  double worst = 0;
  for (size_t half = 0; half < 2; half++) {
    double most = 0;
    for (size_t e = 3 * s->n * half; e < 3 * s->n * (half + 1); e++) {
      if (!isfinite(X[e] - Y[e])) return INFINITY;
      most = fmax(most, fabs(X[e] - Y[e]));
    }
    worst = fmax(worst, most / (size[half] > 0 ? size[half] : 1));
  }
  return worst;
}

static double processor_seconds(void) {
  struct timespec t = {0};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static hk_status reserve_tape(hk_sensitivity *s, size_t stride) {
  free(s->kept);
  free(s->tape);
  s->stride = stride;
  s->kept = malloc(((s->steps / stride + 1) * s->wide + 1) * sizeof *s->kept);
  s->tape = malloc((stride * s->each + 1) * sizeof *s->tape);
  return s->kept && s->tape ? HK_OK : HK_NO_MEMORY;
}

/* Whether a step, taken with its points on new memory, costs more than to keep these in memory: about 0.5 ns a byte
 * where it is new, which is in the seconds, and as much as that and some once more to write and to fetch them beyond
 * the cache. What it decides changes no result. */
static bool is_dear(const hk_sensitivity *s, double seconds) {
  size_t carried = s->method->carries ? 9 * s->n : 0; /* a first stage whose points are not written */
  double all = (double)s->steps * (double)s->each * sizeof(double);
  return all <= HK_TAPE_WHOLE && seconds > 1.2e-9 * (double)(s->each - carried) * sizeof(double);
}

/* From the first step on; where steps of the first segment are found to be dear, once more, and all points are kept. */
static hk_status take_again(hk_sensitivity *s, hk_carried *Z) {
  size_t size = s->wide;
  hk_status status = HK_OK;
  memset(Z, 0, size * sizeof *Z);
  memcpy(Z, s->start, 6 * s->n * sizeof *Z);
  for (size_t k = 0; k < s->steps && status == HK_OK; k += s->stride) {
    size_t end = k + s->stride < s->steps ? k + s->stride : s->steps;
    double begun = processor_seconds();
    memcpy(s->kept + k / s->stride * size, Z, size * sizeof *Z);
    status = hk_sensitivity_record(s, k, end, Z);
    double each = (processor_seconds() - begun) / (double)(end - k);
    if (status != HK_OK || k > 0 || end == s->steps || !is_dear(s, each)) continue;
    status = reserve_tape(s, s->steps);
    if (status == HK_OK) return take_again(s, Z);
    hk_error_set(s->dynamics->error, status, "no memory for the points of %zu steps", s->steps);
  }
  return status;
}

hk_status hk_sensitivity_finish(hk_sensitivity *s, hk_error *error) {
  s->loop->hooks = s->hooks;
  hk_status status = s->no_memory ? HK_NO_MEMORY : reserve_tape(s, stride_of(s->steps, s->each));
  hk_carried *Z = malloc((s->wide + 1) * sizeof *Z);
  if (!Z) status = HK_NO_MEMORY;
  if (status != HK_OK) hk_error_set(error, status, "no memory for the states of %zu steps", s->steps);
  if (status == HK_OK && (status = take_again(s, Z)) != HK_OK)
    hk_error_set(error, status, "%s", s->dynamics->error->text);
  if (status == HK_OK) s->off = off_by(s, Z, s->steps ? s->reached - s->step[0].t : 0);
  free(Z);
  if (!(s->off > tolerance)) return status;
  return hk_error_set(error, HK_FAILED,
                      "the steps, taken again, end elsewhere, by %.2g of the scene's size: its motion makes rounding "
                      "that large, or something acts beside the forces; shorten the run (--at)%s",
                      s->off, s->implicit ? ", or give the integrator a smaller tolerance" : "");
}

void hk_sensitivity_close(hk_sensitivity *s) {
  if (!s) return;
  if (s->loop && s->loop->hooks.context == s) s->loop->hooks = s->hooks;
  free(s->step);
  free(s->start);
  free(s->kept);
  free(s->tape);
  free(s->shared);
  free(s->exact);
  hk_implicit_stage_free(s->implicit);
  hk_linearised_close(s);
  hk_projection_close(s);
  free(s->scratch);
  free(s);
}
