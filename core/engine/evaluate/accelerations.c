/* f(X, t): the sum of forces, divided by the masses, with pins and constraints, as integrators see it.
 *
 * One evaluation: timed parameters and the places of pins are those of the time t; forces without parts add to F in the
 * scene's order; blocks/ adds the parts of the others, block by block, imposes the pins on each block, divides by the
 * masses and checks that F is finite, while the data are in the cache; then constraint forces are added. Several
 * evaluations of steps that follow each other are a tile (hk_evaluate_several). Results do not depend on the number of
 * threads: what is summed where depends on counts alone. Wall time by plugin is sampled at one evaluation in 64. */
#include "core/engine/evaluate/evaluate.h"

#include <stdlib.h>
#include <string.h>

static hk_dynamics *dynamics_of(hk_system *s) { return (hk_dynamics *)(void *)s; }

/* One evaluation in SAMPLE is timed. The steps of a tile are taken at once where DEPTH of them can be under way. */
enum { SAMPLE = 64, DEPTH = 4 };

/* s, of the evaluations of a tile whose steps follow each other: so soon the run can be interrupted. */
static const double patience = 0.2;

static bool is_sampled(const hk_dynamics *d) { return d->count.evaluations % SAMPLE == 0; }

/* ---- channels ---- */

hk_status hk_evaluate_rate(hk_dynamics *d, size_t k, double t, const double *y, double *dy, size_t first) {
  const hk_channel_spec *spec = &d->state->start->channel[k];
  size_t n = d->state->model.n, size = spec->size, begin = d->state->channel[k].offset * n;
  if (!isnan(spec->decay)) {
    for (size_t e = begin + size * first; e < begin + size * n; e++) dy[e] += spec->decay * y[e];
    return HK_OK;
  }
  double in[18] = {t}, out[16];
  for (size_t i = first; spec->rate.call && i < n; i++) {
    size_t got = 0;
    in[1] = d->state->id[i];
    memcpy(in + 2, y + begin + size * i, size * sizeof *in);
    hk_status status = spec->rate.call(&spec->rate, NULL, in, 2 + size, out, 16, &got, d->error);
    if (status != HK_OK) return status;
    if (got != size)
      return hk_error_set(d->error, HK_SCRIPT, "channel '%s': rate gave %zu numbers, expected %zu", spec->name, got,
                          size);
    for (size_t c = 0; c < size; c++) dy[begin + size * i + c] += out[c];
  }
  return HK_OK;
}

/* ---- the time ---- */

static hk_status set_timed(hk_dynamics *d, double t) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT};
  hk_status status = HK_OK;
  for (int j = 0; j < 2; j++)
    for (size_t k = 0; k < d->plugins->kind[kinds[j]].count && status == HK_OK; k++)
      status = hk_instance_set_time(d->plugins->kind[kinds[j]].item[k], t, d->error);
  d->timed_at = status == HK_OK ? t : NAN;
  return status;
}

hk_status hk_dynamics_set_time(hk_dynamics *d, double t) {
  if (d->evaluations.distance) hk_evaluations_note(&d->evaluations, t);
  hk_status status = d->pins->has_paths ? hk_pins_find(d->pins, t, d->error) : HK_OK;
  return status == HK_OK && d->has_timed && t != d->timed_at ? set_timed(d, t) : status;
}

static void put_riders(const hk_dynamics *d, double *x, double *v) {
  if (d->state->model.riders == 0) return;
  hk_riders_follow(&d->state->model, x);
  hk_riders_follow(&d->state->model, v);
}

hk_status hk_dynamics_impose(hk_dynamics *d, double t, double *x, double *v) {
  hk_status status = hk_dynamics_set_time(d, t);
  if (status == HK_OK && (d->pins->has_paths || d->pins->has_slides))
    hk_pins_impose(d->pins, 0, d->state->model.n, x, v);
  if (status == HK_OK) put_riders(d, x, v);
  return status;
}

/* ---- forces ---- */

static void prepare_view(hk_dynamics *d, size_t k, const hk_step_in_tile *w, double *power) {
  hk_view *view = &d->force_view[k];
  view->t = w->t;
  view->x = w->x;
  view->v = w->v;
  view->y = w->y;
  view->power = power;
}

static hk_status add_force(hk_dynamics *d, size_t k, double *F, double *dy) {
  hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
  const hk_force *functions = force->plugin->force;
  bool sample = is_sampled(d);
  double begin = sample ? hk_clock() : 0;
  const hk_instance *outer = hk_enter(force);
  hk_status status = hk_force_add(force, &d->force_view[k], F);
  if (status == HK_OK && functions->rates) status = functions->rates(force->self, &d->force_view[k], dy);
  status = hk_leave_with(force, outer, "add", status);
  force->calls++;
  if (sample) {
    force->seconds += hk_clock() - begin;
    force->sampled++;
  }
  return status;
}

/* `first`: F is zero so far, otherwise the force is summed apart. */
static hk_status add_with_work(hk_dynamics *d, size_t k, double *F, double *dy, const double *v, bool first,
                               double *power) {
  size_t count = 3 * d->state->model.n;
  double *alone = first ? F : d->unaccounted;
  if (!first) memset(alone, 0, count * sizeof *alone);
  hk_status status = add_force(d, k, alone, dy);
  *power += hk_step_power(alone, v, 0, count);
  for (size_t e = 0; e < count && !first; e++) F[e] += alone[e];
  return status;
}

static bool is_whole(const hk_dynamics *d, size_t k) { return d->force_acts[k] && d->takes[k] && !d->tiles.chosen[k]; }

static bool has_whole(const hk_dynamics *d) {
  bool any = false;
  for (size_t k = 0; k < d->split.forces; k++) any |= is_whole(d, k);
  return any;
}

bool hk_evaluate_is_apart(const hk_dynamics *d, size_t k) {
  return is_whole(d, k) && d->tiles.front.partition.blocks > 1;
}

/* Whether the only force without parts is one whose work is F.v: it is then counted block by block. */
static bool counts_by_blocks(const hk_dynamics *d) {
  size_t whole = 0, counted = 0;
  for (size_t k = 0; k < d->split.forces; k++)
    if (is_whole(d, k)) whole++, counted += hk_work_unaccounted(d->plugins->kind[HK_FORCE].item[k]);
  return whole == 1 && counted == 1;
}

/* Adds the forces without parts to F. */
static hk_status sum_whole(hk_dynamics *d, const hk_step_in_tile *w, double *dy, double *power) {
  hk_status status = HK_OK;
  bool first = true;
  for (size_t k = 0; k < d->split.forces && status == HK_OK; k++) {
    if (!is_whole(d, k)) continue;
    bool whole = hk_work_unaccounted(d->plugins->kind[HK_FORCE].item[k]);
    prepare_view(d, k, w, whole ? NULL : power);
    status = whole && !w->counts ? add_with_work(d, k, w->a, dy, w->v, first, power) : add_force(d, k, w->a, dy);
    first = false;
  }
  return status;
}

static hk_status sum_forces(hk_dynamics *d, const hk_step_in_tile *w, const double *y, double *dy, double *power) {
  hk_status status = HK_OK;
  if (w->prepared) {
    hk_tiles_prepare(&d->tiles, w);
    put_riders(d, w->x, w->v);
    status = sum_whole(d, w, dy, power);
  }
  for (size_t k = 0; d->split.takes_channels && k < d->state->start->channels && status == HK_OK; k++)
    status = hk_evaluate_rate(d, k, w->t, y, dy, 0);
  if (status != HK_OK) return status;
  status = hk_tile_evaluate(&d->tiles, w, power);
  return status == HK_OK ? HK_OK : hk_error_set(d->error, status, "the forces are not finite");
}

/* ---- evaluations ---- */

void hk_dynamics_take_all(hk_dynamics *d) {
  d->split.takes_channels = true;
  if (d->system.constraint) d->system.constraint->takes_constraints = true;
  for (size_t k = 0; k < d->split.forces; k++) d->takes[k] = true;
}

hk_status hk_evaluate_fused(hk_system *s, double t, double *x, double *v, const double *y, double *a, double *dy,
                            const hk_fused *fused) {
  hk_dynamics *d = dynamics_of(s);
  size_t tail = s->size - 6 * s->n - 1;
  bool constrained = s->constraint && s->constraint->takes_constraints, carries = s->model->riders > 0;
  const hk_step_in_tile w = {.t = t,
                             .x = x,
                             .v = v,
                             .y = tail ? y : NULL,
                             .a = a,
                             .fused = fused,
                             .prepared = has_whole(d) || carries,
                             .counts = counts_by_blocks(d),
                             .unfinished = constrained || carries,
                             .sampled = is_sampled(d)};
  hk_status status = hk_dynamics_set_time(d, t);
  if (status != HK_OK) return status;
  if (tail) memset(dy, 0, tail * sizeof *dy);
  dy[tail] = 0;
  status = sum_forces(d, &w, y, dy, dy + tail);
  d->count.evaluations++;
  if (status == HK_OK && constrained) status = d->constrain->accelerate(d, t, x, v, a, dy + tail);
  if (status != HK_OK || !w.unfinished) return status;
  hk_riders_follow(s->model, a);
  hk_tiles_finish(&d->tiles, &w);
  return HK_OK;
}

void hk_evaluate_exchange(hk_system *s) {
  hk_state *state = dynamics_of(s)->state;
  hk_state_exchange(state);
  s->X = state->X;
  s->spare = state->spare;
}

hk_status hk_evaluate_accelerations(hk_system *s, double t, double *x, double *v, const double *y, double *a,
                                    double *dy) {
  return hk_evaluate_fused(s, t, x, v, y, a, dy, NULL);
}

/* Rates of channels of its own are asked for with F. */
static bool whole_has_rates(const hk_dynamics *d) {
  bool any = false;
  for (size_t k = 0; k < d->split.forces; k++)
    any |= is_whole(d, k) && d->plugins->kind[HK_FORCE].item[k]->plugin->force->rates;
  return any;
}

/* Whether the first block is complete in the first half of a step: of elements between any particles, as good as all
 * blocks are complete at its end, when nothing of them is in the cache. */
static bool completes_early(const hk_tile_order *o) { return o->items > 0 && o->item[0].after < o->items / 2; }

bool hk_evaluate_takes_several(const hk_dynamics *d) {
  const hk_system *s = &d->system;
  if (d->constrain || s->contact || s->model->riders || d->listens || d->demands || s->size > 6 * s->n + 1)
    return false;
  if (d->queries.flags & HK_DEPENDS_ON_T || d->pins->has_slides) return false;
  if (has_whole(d)) return d->tiles.front.partition.blocks > 1 && !whole_has_rates(d);
  return completes_early(&d->tiles.order);
}

/* Whether the steps of a tile are under way at once. */
static bool has_strips(const hk_dynamics *d) { return !has_whole(d) && d->tiles.order.depth >= DEPTH; }

size_t hk_evaluate_several_most(const hk_dynamics *d) {
  double seconds = 0;
  if (has_strips(d)) return HK_TILE_STEPS;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_instance *force = d->plugins->kind[HK_FORCE].item[k];
    if (force->sampled) seconds += force->seconds / (double)force->sampled;
  }
  return HK_TILE_STEPS * seconds > patience ? (size_t)(patience / seconds) + 1 : HK_TILE_STEPS;
}

/* Where forces have no parts, or too few steps can be under way at once, the steps follow each other, but a block is
 * begun for the next step when it is finished: with the sum of forces without parts, the particles are gone through
 * twice a step. All sums are those of single steps. */
static hk_status one_after_another(hk_dynamics *d, hk_step_in_tile *step, size_t count, double *power) {
  const bool counts = counts_by_blocks(d);
  hk_status status = HK_OK;
  hk_tiles_prepare(&d->tiles, step);
  step[0].prepared = true;
  for (size_t k = 0; k < count && status == HK_OK; k++, d->count.evaluations++) {
    step[k].counts = counts;
    status = sum_whole(d, &step[k], NULL, &power[k]);
    if (status == HK_OK) status = hk_tile_evaluate(&d->tiles, &step[k], &power[k]);
  }
  return status;
}

hk_status hk_evaluate_several(hk_system *s, hk_tile_step *of, size_t count) {
  hk_dynamics *d = dynamics_of(s);
  hk_step_in_tile step[HK_TILE_STEPS] = {{0}};
  double power[HK_TILE_STEPS] = {0};
  const size_t before = d->count.evaluations;
  for (size_t k = 0; k < count; k++, d->count.evaluations++)
    step[k] = (hk_step_in_tile){.t = of[k].t,
                                .x = of[k].x,
                                .v = of[k].v,
                                .a = of[k].a,
                                .fused = &of[k].fused,
                                .prepared = k > 0,
                                .sampled = is_sampled(d),
                                .next = k + 1 < count ? &step[k + 1] : NULL};
  const bool strips = has_strips(d);
  if (!strips) d->count.evaluations = before;
  hk_status status =
      strips ? hk_tile_evaluate_several(&d->tiles, step, count, power) : one_after_another(d, step, count, power);
  for (size_t k = 0; k < count; k++) of[k].power = power[k];
  if (status == HK_NOT_FINITE) return hk_error_set(d->error, status, "the forces are not finite");
  return status;
}

hk_status hk_evaluate_resize(hk_dynamics *d) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  size_t n = d->state->model.n;
  bool account = false;
  for (size_t k = 0; k < forces->count; k++) account |= hk_work_unaccounted(forces->item[k]);
  free(d->unaccounted);
  d->unaccounted = account ? calloc(3 * n + 1, sizeof *d->unaccounted) : NULL;
  free(d->predicted);
  d->predicted = d->system.contact ? calloc(3 * n + 1, sizeof *d->predicted) : NULL;
  if ((!account || d->unaccounted) && (!d->system.contact || d->predicted)) return HK_OK;
  return hk_error_set(d->error, HK_NO_MEMORY, "no memory for %zu particles", n);
}
