/* Checkpoints: time, state, who is in it, plugin fields and random streams, and what verdict and choice of the step
 * rest on, so that a run goes on bit by bit as if it had not stopped and is judged as a whole. The walk that writes is
 * the walk that reads. A checksum (FNV-1a, 64 bits) ends the file: what is damaged is not gone on from. */
#include "core/storage/files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char hk_checkpoint_magic[] = "hooke checkpoint 4\n";

typedef struct header {
  uint64_t record_bytes, n, width, channels, samples, warnings, measures;
  double t, last_h;
  uint32_t next_id, emitted;
} header;

/* What the step was chosen by, and what else counts on. */
typedef struct progress {
  hk_spectrum spectrum;
  hk_watch watch;
  hk_counts count;
  double dt, dt_suggested, dt_estimated, dt_limit, limit_now, growth_rate;
  uint64_t estimate_cost, estimates_cost, estimated_at, chosen, growth_expected;
} progress;

/* A file under way. */
typedef struct stream {
  FILE *file;
  uint64_t hash;
  uint64_t left; /* bytes that may still be read */
} stream;

typedef struct walk {
  stream *stream;
  bool (*move)(void *stream, void *data, size_t bytes);
} walk;

static const uint64_t hash_start = 1469598103934665603u;

static uint64_t hash_of(uint64_t hash, const void *data, size_t bytes) {
  for (const unsigned char *c = data, *end = c + bytes; c < end; c++) hash = (hash ^ *c) * 1099511628211u;
  return hash;
}

static bool put(void *to, void *data, size_t bytes) {
  stream *s = to;
  if (bytes) s->hash = hash_of(s->hash, data, bytes);
  return bytes == 0 || fwrite(data, 1, bytes, s->file) == bytes;
}

/* `data` NULL: whether there are so many. */
static bool get(void *from, void *data, size_t bytes) {
  stream *s = from;
  if (bytes > s->left) return false;
  if (!data || bytes == 0) return true;
  s->left -= bytes;
  return fread(data, 1, bytes, s->file) == bytes;
}

static bool move_instance(const walk *w, hk_instance *instance, const hk_state *s) {
  char label[128] = "";
  strncpy(label, instance->label, sizeof label - 1);
  if (!w->move(w->stream, label, sizeof label) || strncmp(label, instance->label, sizeof label - 1) != 0) return false;
  return w->move(w->stream, instance->random, sizeof instance->random) &&
         hk_fields_visit(instance, s->model.n, s->size, w->move, w->stream);
}

/* Writes or reads the fields of all instances but solvers, whose data are recomputed. */
static bool move_instances(const walk *w, const hk_loop *loop) {
  static const hk_kind order[] = {HK_INTEGRATOR, HK_SERVICE,   HK_SOURCE, HK_FORCE,
                                  HK_CONSTRAINT, HK_CORRECTOR, HK_OUTPUT};
  bool fine = true;
  for (size_t o = 0; o < sizeof order / sizeof *order; o++)
    for (size_t k = 0; k < loop->plugins->kind[order[o]].count && fine; k++)
      fine = move_instance(w, loop->plugins->kind[order[o]].item[k], loop->state);
  return fine;
}

/* ---- writing ---- */

typedef struct subject {
  hk_loop *loop;
  hk_judgement *judgement;
} subject;

static header header_of(const subject *of) {
  const hk_loop *loop = of->loop;
  header h = {.record_bytes = sizeof *loop->record, .n = loop->state->model.n, .width = loop->state->width};
  h.channels = loop->state->model.channels;
  h.samples = of->judgement->samples;
  h.warnings = loop->warnings->count;
  h.measures = of->judgement->last_frame.measures;
  h.t = loop->state->t;
  h.last_h = loop->last_h;
  h.next_id = loop->state->next_id;
  h.emitted = loop->emitted;
  return h;
}

static progress progress_of(const hk_loop *loop) {
  const hk_step_choice *c = loop->step;
  return (progress){.spectrum = c->spectrum,
                    .watch = c->watch,
                    .count = loop->dynamics->count,
                    .dt = c->dt,
                    .dt_suggested = c->dt_suggested,
                    .dt_estimated = c->dt_estimated,
                    .dt_limit = c->dt_limit,
                    .limit_now = c->limit_now,
                    .growth_rate = c->growth_rate,
                    .estimate_cost = c->estimate_cost,
                    .estimates_cost = c->estimates_cost,
                    .estimated_at = c->estimated_at,
                    .chosen = c->chosen,
                    .growth_expected = c->growth_expected};
}

static bool write_warnings(stream *s, const hk_warnings *warnings) {
  bool fine = true;
  for (size_t k = 0; k < warnings->count && fine; k++) {
    uint64_t length = strlen(warnings->text[k]);
    fine = put(s, &length, sizeof length) && put(s, warnings->text[k], length);
  }
  return fine;
}

static bool write_record(stream *s, const subject *of, const header *h) {
  const hk_judgement *j = of->judgement;
  progress p = progress_of(of->loop);
  hk_frame frame = j->last_frame;
  frame.measure_name = NULL; /* addresses mean nothing to another process */
  frame.measure = NULL;
  return put(s, of->loop->record, sizeof *of->loop->record) && put(s, &p, sizeof p) && put(s, &frame, sizeof frame) &&
         put(s, j->measure, h->measures * sizeof(double)) && put(s, j->unresolved, h->samples * sizeof(double)) &&
         write_warnings(s, of->loop->warnings);
}

static bool body(FILE *file, const void *what) {
  const subject *of = what;
  const hk_state *s = of->loop->state;
  stream to = {.file = file, .hash = hash_start};
  header h = header_of(of);
  walk w = {&to, put};
  bool fine = fputs(hk_checkpoint_magic, file) >= 0 && put(&to, &h, sizeof h) && write_record(&to, of, &h) &&
              put(&to, s->id, h.n * sizeof *s->id) && put(&to, s->group, h.n * sizeof *s->group) &&
              put(&to, s->mass, h.n * sizeof *s->mass) && put(&to, s->X, s->size * sizeof *s->X) &&
              move_instances(&w, of->loop);
  uint64_t hash = to.hash;
  return fine && put(&to, &hash, sizeof hash);
}

hk_status hk_checkpoint_write(hk_loop *loop, hk_judgement *judgement, const char *path, hk_error *error) {
  subject of = {loop, judgement};
  return hk_write_file(path, body, &of, error);
}

/* ---- reading ---- */

/* Whether the file is whole; then it stands behind the first line again, with the bytes up to the checksum to read. */
static bool check_sum(stream *s) {
  char block[1 << 14];
  uint64_t hash = hash_start, stated;
  long begin = ftell(s->file);
  if (begin < 0 || fseek(s->file, 0, SEEK_END) != 0) return false;
  long end = ftell(s->file);
  if (end - begin < (long)sizeof stated || fseek(s->file, begin, SEEK_SET) != 0) return false;
  s->left = (uint64_t)(end - begin) - sizeof stated;
  for (uint64_t left = s->left, got; left > 0; left -= got) {
    got = fread(block, 1, left < sizeof block ? left : sizeof block, s->file);
    if (got == 0) return false;
    hash = hash_of(hash, block, got);
  }
  bool fine = fread(&stated, sizeof stated, 1, s->file) == 1 && stated == hash;
  return fseek(s->file, begin, SEEK_SET) == 0 && fine;
}

static bool read_warnings(stream *s, hk_warnings *warnings, uint64_t count) {
  char text[1024];
  bool silent = warnings->silent;
  warnings->silent = true; /* these warnings were printed in the first run */
  bool fine = true;
  for (uint64_t k = 0; k < count && fine; k++) {
    uint64_t length = 0;
    fine = get(s, &length, sizeof length) && length < sizeof text && get(s, text, length);
    text[fine ? length : 0] = 0;
    if (fine) hk_warn(warnings, "%s", text);
  }
  warnings->silent = silent;
  return fine;
}

/* Values of measures are taken where the scene has as many; the next frame measures anew. */
static bool read_frame(stream *s, hk_judgement *j, uint64_t measures) {
  hk_frame frame;
  bool known = measures == j->last_frame.measures;
  if (!get(s, NULL, measures * sizeof(double)) || !get(s, &frame, sizeof frame)) return false;
  frame.measures = j->last_frame.measures;
  frame.measure_name = j->last_frame.measure_name;
  frame.measure = j->last_frame.measure;
  j->last_frame = frame;
  double other;
  for (uint64_t k = 0; k < measures; k++)
    if (!get(s, known ? &j->measure[k] : &other, sizeof other)) return false;
  return true;
}

static void restore_progress(hk_loop *loop, const progress *p) {
  hk_step_choice *c = loop->step;
  loop->dynamics->count = p->count;
  c->spectrum = p->spectrum;
  c->watch = p->watch;
  c->dt = p->dt;
  c->dt_suggested = p->dt_suggested;
  c->dt_estimated = p->dt_estimated;
  c->dt_limit = p->dt_limit;
  c->limit_now = p->limit_now;
  c->growth_rate = p->growth_rate;
  c->estimate_cost = (size_t)p->estimate_cost;
  c->estimates_cost = (size_t)p->estimates_cost;
  c->estimated_at = (size_t)p->estimated_at;
  c->chosen = p->chosen;
  c->growth_expected = p->growth_expected;
}

/* Of bytes that are to be read as truth values, any but 0 and 1 are undefined. */
static bool are_truths(const void *data, const size_t *at, size_t count) {
  const unsigned char *byte = data;
  bool fine = true;
  for (size_t k = 0; k < count; k++) fine = fine && byte[at[k]] <= 1;
  return fine;
}

static bool read_figures(hk_record *r, stream *s, size_t forces) {
  static const size_t truths[] = {offsetof(hk_record, moved), offsetof(hk_record, corrected),
                                  offsetof(hk_record, sourced), offsetof(hk_record, growth_expected)};
  if (!get(s, r, sizeof *r) || !are_truths(r, truths, sizeof truths / sizeof *truths)) return false;
  bool none_passed = r->passed[0] == 0 && r->passed[1] == 0 && r->passed[2] == 0;
  return r->passed_force < forces || (forces == 0 && none_passed);
}

static bool read_progress(progress *p, stream *s) {
  static const size_t truths[] = {offsetof(progress, spectrum.rigorous),     offsetof(progress, spectrum.covered),
                                  offsetof(progress, watch.allowed.covered), offsetof(progress, watch.last.covered),
                                  offsetof(progress, watch.seen.covered),    offsetof(progress, watch.ahead.covered)};
  return get(s, p, sizeof *p) && p->dt > 0 && are_truths(p, truths, sizeof truths / sizeof *truths);
}

static bool read_record(hk_loop *loop, hk_judgement *j, stream *s, const header *h, progress *p) {
  size_t forces = loop->plugins->kind[HK_FORCE].count;
  if (h->record_bytes != sizeof *loop->record || !read_figures(loop->record, s, forces) || !read_progress(p, s) ||
      !read_frame(s, j, h->measures) || h->samples > s->left / sizeof(double))
    return false;
  double *samples = malloc((size_t)(h->samples + 1) * sizeof *samples);
  bool fine = samples && get(s, samples, h->samples * sizeof *samples) && read_warnings(s, loop->warnings, h->warnings);
  free(j->unresolved);
  j->unresolved = samples;
  j->samples = fine ? (size_t)h->samples : 0;
  return fine;
}

static bool read_particles(stream *s, const header *h, hk_particle_set *set) {
  uint64_t each = sizeof *set->id + sizeof *set->group + (7 + h->width) * sizeof *set->X;
  if (h->n >= UINT32_MAX || h->n > s->left / each || !hk_particle_set_allocate(set, h->n, h->width)) return false;
  return get(s, set->id, h->n * sizeof *set->id) && get(s, set->group, h->n * sizeof *set->group) &&
         get(s, set->mass, h->n * sizeof *set->mass) && get(s, set->X, ((6 + h->width) * h->n + 1) * sizeof *set->X);
}

/* Whether the numbers read as indices, lengths and steps are valid. The next frame is still to come: the loop would
 * wait for one that has passed for ever. */
static bool plausible(const hk_loop *loop, const header *h, const hk_particle_set *set) {
  bool fine = h->t >= 0 && h->t < (double)loop->record->frames / loop->fps && h->last_h >= 0;
  for (size_t i = 0; i < set->n && fine; i++)
    fine = set->group[i] < loop->state->model.groups && set->id[i] > 0 && set->id[i] < h->next_id &&
           (i == 0 || set->id[i] > set->id[i - 1]) && set->mass[i] >= 0 && isfinite(set->mass[i]);
  return fine;
}

static hk_status damaged_file(hk_loop *loop, const char *path) {
  return hk_error_set(loop->error, HK_IO, "%s is cut short or damaged: it cannot be gone on from", path);
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
  if (hk_pins_due(loop->pins, s->t)) hk_pins_release(loop->pins, s);
  s->next_id = h->next_id;
  loop->last_h = h->last_h;
  loop->emitted = h->emitted;
  return HK_OK;
}

hk_status hk_checkpoint_read(hk_loop *loop, hk_judgement *j, FILE *file, const char *path) {
  stream from = {.file = file};
  header h;
  progress p;
  hk_particle_set set = {0};
  walk w = {&from, get};
  if (!check_sum(&from) || !get(&from, &h, sizeof h)) return damaged_file(loop, path);
  if (h.width != loop->state->width || h.channels != loop->state->model.channels)
    return other_scene(loop, path, "its channels differ");
  if (!read_record(loop, j, &from, &h, &p)) return damaged_file(loop, path);
  if (j->last_frame.fps != loop->fps) return other_scene(loop, path, "its frames per second differ");
  if (!read_particles(&from, &h, &set) || !plausible(loop, &h, &set)) {
    hk_particle_set_free(&set);
    return damaged_file(loop, path);
  }
  hk_status status = adopt(loop, &h, &set);
  if (status != HK_OK) return status;
  if (!move_instances(&w, loop) || from.left > 0)
    return other_scene(loop, path, "its plugins, their labels or what they keep differ");
  restore_progress(loop, &p);
  return hk_snapshot_take(&j->last_good, loop->state, loop->error);
}
