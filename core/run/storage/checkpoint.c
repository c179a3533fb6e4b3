/* Checkpoints: time, state, who is in it, plugin fields and random streams, and what verdict and choice of the step
 * rest on, so that a run goes on bit by bit as if it had not stopped and is judged as a whole. The walk that writes is
 * the walk that reads. It is taken in memory; checkpoint_file.c writes it as a whole, and reads it. */
#include "core/numerics/population/population.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/storage/walk.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

typedef struct header {
  uint64_t record_bytes, n, width, channels, samples, warnings, measures, moments, numbers, room, cells;
  double t, last_h;
  hk_piece piece;
  uint32_t next_id, emitted;
} header;

/* Of a frame: its figures, which all stand ahead of the names of its units. */
enum { FRAME_BYTES = offsetof(hk_frame, measure_unit) };

/* What the step was chosen by, and what else counts on. */
typedef struct progress {
  hk_spectrum spectrum;
  hk_watch watch;
  hk_counts count;
  double dt, dt_suggested, dt_estimated, dt_limit, limit_now, growth_rate, lightest;
  uint64_t estimate_cost, estimates_cost, estimated_at, births_cost, turnover, chosen, growth_expected;
} progress;

static bool move_instance(hk_walk *w, hk_instance *instance, const hk_state *s) {
  char label[128] = "";
  strncpy(label, instance->label, sizeof label - 1);
  if (!w->move(w, label, sizeof label) || strncmp(label, instance->label, sizeof label - 1) != 0) return false;
  return w->move(w, instance->random, sizeof instance->random) &&
         hk_fields_visit(instance, s->model.n, s->size, w->move, w);
}

/* Writes or reads the fields of all instances but solvers, whose data are recomputed. */
static bool move_instances(hk_walk *w, const hk_loop *loop) {
  static const hk_kind order[] = {HK_INTEGRATOR, HK_SERVICE, HK_SOURCE, HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR};
  bool fine = true;
  for (size_t o = 0; o < sizeof order / sizeof *order; o++)
    for (size_t k = 0; k < loop->plugins->kind[order[o]].count && fine; k++)
      fine = move_instance(w, loop->plugins->kind[order[o]].item[k], loop->state);
  return fine;
}

/* ---- writing ---- */

static header header_of(const hk_loop *loop, const hk_judgement *j) {
  const hk_evaluations *e = &loop->dynamics->evaluations;
  header h = {.record_bytes = sizeof *loop->record, .n = loop->state->model.n, .width = loop->state->width};
  h.channels = loop->state->model.channels;
  h.samples = j->samples;
  h.warnings = loop->warnings->count;
  h.measures = j->last_frame.measures;
  h.moments = j->trajectory.moments;
  h.numbers = j->trajectory.size;
  h.room = j->trajectory.stride;
  h.cells = e->distance ? HK_CELLS : 0;
  h.t = loop->state->t;
  h.last_h = loop->last_h;
  h.piece = loop->piece;
  h.next_id = loop->state->next_id;
  h.emitted = loop->emitted;
  return h;
}

static progress progress_of(const hk_loop *loop) {
  const hk_step_choice *c = hk_step_choice_of(loop);
  return (progress){.spectrum = c->spectrum,
                    .watch = c->watch,
                    .count = loop->dynamics->count,
                    .dt = c->length.dt,
                    .dt_suggested = c->dt_suggested,
                    .dt_estimated = c->dt_estimated,
                    .dt_limit = c->dt_limit,
                    .limit_now = c->length.limit_now,
                    .growth_rate = c->growth_rate,
                    .estimate_cost = c->estimate_cost,
                    .estimates_cost = c->estimates_cost,
                    .estimated_at = c->estimated_at,
                    .lightest = c->lightest,
                    .births_cost = c->births_cost,
                    .turnover = c->turnover,
                    .chosen = c->chosen,
                    .growth_expected = c->growth_expected};
}

static bool write_warnings(hk_walk *w, const hk_warnings *warnings) {
  bool fine = true;
  for (size_t k = 0; k < warnings->count && fine; k++)
    fine = hk_checkpoint_put_text(w, warnings->text[k], strlen(warnings->text[k]));
  return fine;
}

/* The positions at the frames, and when functions of time were evaluated: what comparisons with other runs rest on. */
static bool write_history(hk_walk *w, const hk_loop *loop, const hk_judgement *j) {
  const hk_evaluations *e = &loop->dynamics->evaluations;
  const hk_trajectory *a = &j->trajectory;
  hk_evaluations state = *e;
  state.distance = NULL; /* an address */
  if (!hk_walk_put(w, a->moment, hk_trajectory_bytes(a)) || !hk_walk_put(w, a->value, a->size * sizeof *a->value))
    return false;
  return !e->distance ||
         (hk_walk_put(w, e->distance, HK_CELLS * sizeof *e->distance) && hk_walk_put(w, &state, sizeof state));
}

static bool write_record(hk_walk *w, const hk_loop *loop, const hk_judgement *j, const header *h) {
  progress p = progress_of(loop);
  hk_frame frame = j->last_frame; /* addresses mean nothing to another process */
  frame.measure_name = frame.force_name = NULL, frame.measure = NULL, frame.force = NULL, frame.run = NULL;
  frame.scene = frame.origin = NULL, frame.flow = NULL, frame.contact_points = NULL, frame.bar_forces = NULL;
  return hk_walk_put(w, loop->record, sizeof *loop->record) && hk_walk_put(w, &p, sizeof p) &&
         hk_walk_put(w, &frame, FRAME_BYTES) && hk_walk_put(w, j->measure, h->measures * sizeof(double)) &&
         hk_walk_put(w, j->unresolved, h->samples * sizeof(double)) && write_warnings(w, loop->warnings);
}

hk_status hk_checkpoint_take(hk_checkpoint *c, hk_loop *loop, const hk_judgement *j, const char *origin,
                             const char *words, hk_error *error) {
  const hk_state *s = loop->state;
  header h = header_of(loop, j);
  hk_walk w = hk_walk_write(c);
  c->count = 0;
  bool fine = hk_checkpoint_begin(&w, words, origin) && hk_walk_put(&w, &h, sizeof h) &&
              write_record(&w, loop, j, &h) && write_history(&w, loop, j) &&
              hk_walk_put(&w, s->id, h.n * sizeof *s->id) && hk_walk_put(&w, s->group, h.n * sizeof *s->group) &&
              hk_walk_put(&w, s->mass, h.n * sizeof *s->mass) && hk_walk_put(&w, s->X, s->size * sizeof *s->X) &&
              move_instances(&w, loop) && hk_walk_seal(c, strlen(hk_checkpoint_magic));
  if (fine) return HK_OK;
  c->count = 0;
  return hk_error_set(error, HK_NO_MEMORY, "no memory for a checkpoint of %zu particles", (size_t)h.n);
}

/* ---- reading ---- */

static bool read_warnings(hk_walk *w, hk_warnings *warnings, uint64_t count) {
  char text[1024];
  bool silent = warnings->silent;
  warnings->silent = true; /* these warnings were printed in the first run */
  bool fine = true;
  for (uint64_t k = 0; k < count && fine; k++) {
    uint64_t length = 0;
    fine = hk_walk_get(w, &length, sizeof length) && length < sizeof text && hk_walk_get(w, text, length);
    text[fine ? length : 0] = 0;
    if (fine) hk_warn(warnings, "%s", text);
  }
  warnings->silent = silent;
  return fine;
}

/* Values of measures are taken where the scene has as many; the next frame measures anew. */
static bool read_frame(hk_walk *w, hk_judgement *j, uint64_t measures) {
  hk_frame then, *frame = &j->last_frame;
  bool known = measures == frame->measures;
  if (measures > w->left / sizeof(double) || !hk_walk_get(w, &then, FRAME_BYTES)) return false;
  frame->index = then.index, frame->steps = then.steps, frame->fps = then.fps; /* its figures, and no address */
  frame->kinetic = then.kinetic, frame->potential = then.potential, frame->work = then.work;
  memcpy(frame->momentum, then.momentum, sizeof frame->momentum);
  memcpy(frame->angular_momentum, then.angular_momentum, sizeof frame->angular_momentum);
  frame->step = then.step, frame->error = then.error;
  return known ? hk_walk_get(w, j->measure, measures * sizeof(double)) : hk_walk_skip(w, measures * sizeof(double));
}

static void restore_progress(hk_loop *loop, const progress *p) {
  hk_step_choice *c = hk_step_choice_of(loop);
  loop->dynamics->count = p->count;
  c->spectrum = p->spectrum;
  c->watch = p->watch;
  c->length.dt = p->dt;
  c->length.watch_at = 0; /* it looks for itself whether to measure */
  c->dt_suggested = p->dt_suggested;
  c->dt_estimated = p->dt_estimated;
  c->dt_limit = p->dt_limit;
  c->length.limit_now = p->limit_now;
  c->growth_rate = p->growth_rate;
  c->estimate_cost = (size_t)p->estimate_cost;
  c->estimates_cost = (size_t)p->estimates_cost;
  c->estimated_at = (size_t)p->estimated_at;
  c->lightest = p->lightest;
  c->births_cost = (size_t)p->births_cost;
  c->turnover = (size_t)p->turnover;
  c->chosen = p->chosen;
  c->growth_expected = p->growth_expected;
}

/* Times that are not finite, or of cells that are not, would be looked for without end. The last evaluation may be
 * later than the state: where a step takes very many, those of attempts that were given up count as well. */
static bool plausible_times(const hk_evaluations *e, double t) {
  bool last = isnan(e->last) || (isfinite(e->last) && e->last <= fmax(t + e->cell, HK_CELLS * e->cell));
  bool fine = e->pending <= HK_PENDING && e->cell > 0 && isfinite(e->cell) && last;
  for (size_t k = 0; k < e->pending && fine; k++) fine = isfinite(e->time[k]);
  return fine;
}

/* Kept where the run is to be compared with others. */
static bool read_history(hk_walk *w, hk_loop *loop, hk_judgement *j, const header *h) {
  hk_evaluations *e = &loop->dynamics->evaluations, then;
  hk_trajectory stated = {.moments = (size_t)h->moments,
                          .size = (size_t)h->numbers,
                          .width = 4 + loop->state->width,
                          .stride = (size_t)h->room};
  if (!hk_trajectory_restore(&j->trajectory, j->keeps_trajectory, &stated, h->next_id, w, hk_walk_get)) return false;
  if (h->cells == 0) return true;
  if (h->cells != HK_CELLS) return false;
  if (!e->distance) return hk_walk_skip(w, HK_CELLS * sizeof *e->distance + sizeof *e);
  if (!hk_walk_get(w, e->distance, HK_CELLS * sizeof *e->distance) || !hk_walk_get(w, &then, sizeof then) ||
      !plausible_times(&then, h->t))
    return false;
  then.distance = e->distance;
  *e = then;
  return true;
}

/* Of bytes that are to be read as truth values, any but 0 and 1 are undefined. */
static bool are_truths(const void *data, const size_t *at, size_t count) {
  const unsigned char *byte = data;
  bool fine = true;
  for (size_t k = 0; k < count; k++) fine = fine && byte[at[k]] <= 1;
  return fine;
}

static bool read_figures(hk_record *r, hk_walk *w, size_t forces) {
  static const size_t truths[] = {offsetof(hk_record, moved),           offsetof(hk_record, corrected),
                                  offsetof(hk_record, sourced),         offsetof(hk_record, by_hand),
                                  offsetof(hk_record, growth_expected), offsetof(hk_record, contact.repairs)};
  if (!hk_walk_get(w, r, sizeof *r) || !are_truths(r, truths, sizeof truths / sizeof *truths)) return false;
  if (!memchr(r->contact.first, 0, sizeof r->contact.first)) return false; /* it is printed */
  bool none_passed = r->passed[0] == 0 && r->passed[1] == 0 && r->passed[2] == 0;
  return r->passed_force < forces || (forces == 0 && none_passed);
}

static bool read_progress(progress *p, hk_walk *w) {
  static const size_t truths[] = {
      offsetof(progress, spectrum.rigorous),     offsetof(progress, spectrum.covered),
      offsetof(progress, watch.allowed.covered), offsetof(progress, watch.last.covered),
      offsetof(progress, watch.seen.covered),    offsetof(progress, watch.expected.covered)};
  return hk_walk_get(w, p, sizeof *p) && p->dt > 0 && are_truths(p, truths, sizeof truths / sizeof *truths);
}

static bool read_record(hk_loop *loop, hk_judgement *j, hk_walk *w, const header *h, progress *p) {
  size_t forces = loop->plugins->kind[HK_FORCE].count;
  if (h->record_bytes != sizeof *loop->record || !read_figures(loop->record, w, forces) || !read_progress(p, w) ||
      !read_frame(w, j, h->measures) || h->samples > w->left / sizeof(double))
    return false;
  double *samples = malloc((size_t)(h->samples + 1) * sizeof *samples);
  bool fine =
      samples && hk_walk_get(w, samples, h->samples * sizeof *samples) && read_warnings(w, loop->warnings, h->warnings);
  free(j->unresolved);
  j->unresolved = samples;
  j->samples = fine ? (size_t)h->samples : 0;
  return fine && read_history(w, loop, j, h);
}

static bool read_particles(hk_walk *w, const header *h, hk_particle_set *set) {
  uint64_t each = sizeof *set->id + sizeof *set->group + (7 + h->width) * sizeof *set->X;
  if (h->n >= UINT32_MAX || h->n > w->left / each || !hk_particle_set_allocate(set, h->n, h->width)) return false;
  return hk_walk_get(w, set->id, h->n * sizeof *set->id) && hk_walk_get(w, set->group, h->n * sizeof *set->group) &&
         hk_walk_get(w, set->mass, h->n * sizeof *set->mass) &&
         hk_walk_get(w, set->X, ((6 + h->width) * h->n + 1) * sizeof *set->X);
}

static bool plausible_piece(const hk_piece *p) {
  return p->n == 0 || (p->i > 0 && p->i <= p->n && p->h > 0 && isfinite(p->begin) && isfinite(p->stop) && p->dt > 0);
}

/* Whether the numbers read as indices, lengths and steps are valid. The next frame is still to come: the loop would
 * wait for one that has passed for ever. */
static bool plausible(const hk_loop *loop, const header *h, const hk_particle_set *set) {
  bool fine =
      h->t >= 0 && h->t < (double)loop->record->frames / loop->fps && h->last_h >= 0 && plausible_piece(&h->piece);
  for (size_t i = 0; i < set->n && fine; i++)
    fine = set->group[i] < loop->state->model.groups && set->id[i] > 0 && set->id[i] < h->next_id &&
           set->mass[i] >= 0 && isfinite(set->mass[i]);
  return fine;
}

static hk_status other_scene(hk_loop *loop, const char *path, const char *what) {
  return hk_error_set(loop->error, HK_BAD_PARAM, "%s does not fit this scene: %s", path, what);
}

/* Takes over who is there, at that time; what was let go by then stays so. */
static hk_status adopt(hk_loop *loop, const header *h, hk_particle_set *set) {
  hk_state *s = loop->state;
  s->t = h->t;
  hk_status status = hk_install(loop, set);
  if (status != HK_OK) return status;
  if (hk_pins_release_at(loop->pins, s->t)) hk_pins_release(loop->pins, s);
  s->next_id = h->next_id;
  loop->last_h = h->last_h;
  loop->piece = h->piece;
  loop->emitted = h->emitted;
  return HK_OK;
}

/* With other parameters the scene may have other particles; those of a run under way stay. Where particles are born and
 * die, the ones that both have are compared. */
static hk_status check_particles(hk_loop *loop, const hk_particle_set *set, const char *path, const char *said) {
  const hk_state *s = loop->state;
  bool vary = loop->plugins->kind[HK_SOURCE].count > 0;
  uint32_t at;
  if (!vary && s->model.n != set->n)
    return hk_error_set(
        loop->error, HK_BAD_PARAM,
        "%s cannot be gone on from: %s, with which there are %zu particles in place of %zu: that takes a "
        "run from the start",
        path, said, s->model.n, set->n);
  for (size_t i = 0; i < set->n; i++) {
    bool known = hk_state_index(s, set->id[i], &at);
    if (known ? s->mass[at] == set->mass[i] && s->group[at] == set->group[i] : vary) continue;
    return hk_error_set(loop->error, HK_BAD_PARAM,
                        "%s cannot be gone on from: %s, with which particle %u has another mass or group: these stay "
                        "while a run goes on, so that it takes a run from the start",
                        path, said, set->id[i]);
  }
  return HK_OK;
}

static hk_status read(hk_loop *loop, hk_judgement *j, hk_walk *w, const char *path, const char *changed) {
  header h;
  progress p;
  hk_particle_set set = {0};
  if (!hk_walk_get(w, &h, sizeof h)) return hk_checkpoint_damaged(loop->error, path);
  if (h.width != loop->state->width || h.channels != loop->state->model.channels)
    return other_scene(loop, path, "its channels differ");
  if (!read_record(loop, j, w, &h, &p)) return hk_checkpoint_damaged(loop->error, path);
  if (j->last_frame.fps != loop->fps) return other_scene(loop, path, "its frames per second differ");
  if (!read_particles(w, &h, &set) || !plausible(loop, &h, &set)) {
    hk_particle_set_free(&set);
    return hk_checkpoint_damaged(loop->error, path);
  }
  hk_status status = changed ? check_particles(loop, &set, path, changed) : HK_OK;
  if (status != HK_OK) hk_particle_set_free(&set);
  if (status == HK_OK) status = adopt(loop, &h, &set);
  if (status != HK_OK) return status;
  if (!move_instances(w, loop) || w->left > 0)
    return other_scene(loop, path, "its plugins, their labels or what they keep differ");
  restore_progress(loop, &p);
  return hk_snapshot_take(&j->last_good, loop->state, loop->error);
}

hk_status hk_checkpoint_read(hk_loop *loop, hk_judgement *j, const char *path, const char *origin,
                             hk_origin_changes *changes) {
  hk_checkpoint c = {0};
  hk_walk w;
  const char *words = NULL, *then = NULL;
  char what[1200];
  hk_status status = hk_checkpoint_open(&c, &w, path, &words, &then, loop->error);
  if (status == HK_OK && origin && !hk_origin_same(then, origin, changes, what, sizeof what))
    status = hk_error_set(loop->error, HK_BAD_PARAM,
                          "%s cannot be gone on from: %s; %s, and scene:start{file=} takes it for another run", path,
                          what, "--change NAME=VALUE goes on with another value of a parameter");
  bool other = status == HK_OK && origin && changes && *changes->said;
  if (status == HK_OK) status = read(loop, j, &w, path, other ? changes->said : NULL);
  hk_checkpoint_free(&c);
  return status;
}
