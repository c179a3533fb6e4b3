/* Checkpoints: time, state, who is in it, plugin fields and random streams, and the record that the verdict rests on,
 * so that a run goes on bit by bit as if it had not stopped and is judged as a whole. The walk that writes is the walk
 * that reads. */
#include "core/storage/files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char hk_checkpoint_magic[] = "hooke checkpoint 2\n";

typedef struct header {
  uint64_t n, width, channels, record_bytes, samples, warnings;
  double t, dt, last_h, dt_limit;
  uint32_t next_id, growth_expected;
} header;

typedef struct walk {
  FILE *file;
  bool (*move)(void *file, void *data, size_t bytes);
} walk;

static bool put(void *file, void *data, size_t bytes) { return bytes == 0 || fwrite(data, 1, bytes, file) == bytes; }
static bool get(void *file, void *data, size_t bytes) { return bytes == 0 || fread(data, 1, bytes, file) == bytes; }

static bool move_instance(const walk *w, hk_instance *instance, const hk_state *s) {
  char label[128] = "";
  strncpy(label, instance->label, sizeof label - 1);
  if (!w->move(w->file, label, sizeof label) || strcmp(label, instance->label) != 0) return false;
  return w->move(w->file, instance->random, sizeof instance->random) &&
         hk_fields_visit(instance, s->model.n, s->size, w->move, w->file);
}

/* Solvers keep nothing that goes on. */
static bool move_instances(const walk *w, const hk_loop *loop) {
  static const hk_kind order[] = {HK_INTEGRATOR, HK_SERVICE,   HK_SOURCE, HK_FORCE,
                                  HK_CONSTRAINT, HK_CORRECTOR, HK_OUTPUT};
  bool fine = true;
  for (size_t o = 0; o < sizeof order / sizeof *order; o++)
    for (size_t k = 0; k < loop->plugins->kind[order[o]].count && fine; k++)
      fine = move_instance(w, loop->plugins->kind[order[o]].item[k], loop->state);
  return fine;
}

typedef struct subject {
  hk_loop *loop;
  hk_judgement *judgement;
} subject;

static bool write_warnings(FILE *file, const hk_warnings *warnings) {
  bool fine = true;
  for (size_t k = 0; k < warnings->count && fine; k++) {
    uint64_t length = strlen(warnings->text[k]);
    fine = put(file, &length, sizeof length) && put(file, warnings->text[k], length);
  }
  return fine;
}

static bool body(FILE *file, const void *what) {
  const subject *of = what;
  hk_loop *loop = of->loop;
  hk_state *s = loop->state;
  header h = {.n = s->model.n, .width = s->width, .channels = s->model.channels, .record_bytes = sizeof *loop->record};
  h.samples = of->judgement->samples;
  h.warnings = loop->warnings->count;
  h.t = s->t;
  h.dt = loop->step->dt;
  h.last_h = loop->last_h;
  h.dt_limit = loop->step->dt_limit;
  h.next_id = s->next_id;
  h.growth_expected = loop->step->growth_expected;
  walk w = {file, put};
  return put(file, (void *)(uintptr_t)hk_checkpoint_magic, strlen(hk_checkpoint_magic)) && put(file, &h, sizeof h) &&
         put(file, loop->record, sizeof *loop->record) &&
         put(file, of->judgement->unresolved, h.samples * sizeof(double)) && write_warnings(file, loop->warnings) &&
         put(file, s->id, h.n * sizeof *s->id) && put(file, s->group, h.n * sizeof *s->group) &&
         put(file, s->mass, h.n * sizeof *s->mass) && put(file, s->X, s->size * sizeof *s->X) &&
         move_instances(&w, loop);
}

hk_status hk_checkpoint_write(hk_loop *loop, hk_judgement *judgement, const char *path, hk_error *error) {
  subject of = {loop, judgement};
  return hk_write_file(path, body, &of, error);
}

static bool read_warnings(FILE *file, hk_warnings *warnings, uint64_t count) {
  char text[1024];
  bool silent = warnings->silent;
  warnings->silent = true; /* they were printed when they came up */
  bool fine = true;
  for (uint64_t k = 0; k < count && fine; k++) {
    uint64_t length = 0;
    fine = get(file, &length, sizeof length) && length < sizeof text && get(file, text, length);
    text[fine ? length : 0] = 0;
    if (fine) hk_warn(warnings, "%s", text);
  }
  warnings->silent = silent;
  return fine;
}

static bool read_record(hk_loop *loop, hk_judgement *j, FILE *file, const header *h) {
  double *samples = malloc((h->samples + 1) * sizeof *samples);
  bool fine = samples && h->record_bytes == sizeof *loop->record && get(file, loop->record, sizeof *loop->record) &&
              get(file, samples, h->samples * sizeof *samples) && read_warnings(file, loop->warnings, h->warnings);
  free(j->unresolved);
  j->unresolved = samples;
  j->samples = samples ? h->samples : 0;
  return fine;
}

static bool read_particles(FILE *file, const header *h, hk_particle_set *set) {
  return hk_particle_set_allocate(set, h->n, h->width) && get(file, set->id, h->n * sizeof *set->id) &&
         get(file, set->group, h->n * sizeof *set->group) && get(file, set->mass, h->n * sizeof *set->mass) &&
         get(file, set->X, ((6 + h->width) * h->n + 1) * sizeof *set->X);
}

/* What would be taken for an index, a length or a step has to be one. */
static bool plausible(const hk_loop *loop, const header *h, const hk_particle_set *set) {
  bool fine = isfinite(h->t) && h->dt > 0 && h->last_h >= 0;
  for (size_t i = 0; i < set->n && fine; i++)
    fine = set->group[i] < loop->state->model.groups && set->id[i] > 0 && set->id[i] < h->next_id &&
           (i == 0 || set->id[i] > set->id[i - 1]) && set->mass[i] >= 0 && isfinite(set->mass[i]);
  return fine;
}

static hk_status damaged(hk_loop *loop, const char *path) {
  return hk_error_set(loop->error, HK_IO, "%s is cut short or damaged: it cannot be gone on from", path);
}

hk_status hk_checkpoint_read(hk_loop *loop, hk_judgement *j, FILE *file, const char *path) {
  header h;
  hk_particle_set set = {0};
  hk_state *s = loop->state;
  if (!get(file, &h, sizeof h)) return damaged(loop, path);
  if (h.width != s->width || h.channels != s->model.channels)
    return hk_error_set(loop->error, HK_BAD_PARAM, "%s is from a scene with other channels", path);
  bool fine = h.n < UINT32_MAX && h.samples < UINT32_MAX && read_record(loop, j, file, &h) &&
              read_particles(file, &h, &set) && plausible(loop, &h, &set);
  if (!fine) {
    hk_particle_set_free(&set);
    return damaged(loop, path);
  }
  s->t = h.t;
  hk_status status = hk_install(loop, &set);
  if (status != HK_OK) return status;
  walk w = {file, get};
  if (!move_instances(&w, loop))
    return hk_error_set(loop->error, HK_BAD_PARAM, "%s does not fit this scene: its plugins or their labels differ",
                        path);
  s->next_id = h.next_id;
  loop->last_h = h.last_h;
  loop->step->dt = h.dt;
  loop->step->dt_limit = h.dt_limit;
  loop->step->growth_expected = h.growth_expected;
  return HK_OK;
}
