/* State files and checkpoints.
 *
 * A state file is a table, "id,x,y,z,vx,vy,vz,mass" with 17 digits, which read back give the same doubles. A checkpoint
 * is binary, in the machine's own byte order, and also holds the time, channels, plugin fields and random streams, so
 * that a run goes on bit by bit as if it had not stopped. Both are written beside their name and renamed, so an
 * interrupted write loses nothing; both are read after the plugins have started, so that what plugins derive from the
 * scene's start (rest lengths) stays what it was. */
#include "core/run/engine.h"
#include "core/state/particle_set.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char magic[] = "hooke checkpoint 1\n";

static hk_status io_error(hk_error *error, const char *doing, const char *path) {
  return hk_error_set(error, HK_IO, "cannot %s %s: %s", doing, path, errno ? strerror(errno) : "the file ends early");
}

/* Devices and pipes cannot be renamed onto; they are written directly. */
static bool plain_target(const char *path) {
  struct stat info;
  return stat(path, &info) != 0 || S_ISREG(info.st_mode);
}

static hk_status write_file(const char *path, bool (*body)(FILE *, const void *), const void *what, hk_error *error) {
  char temporary[PATH_MAX];
  bool rename_it = plain_target(path);
  if (snprintf(temporary, sizeof temporary, rename_it ? "%s.part" : "%s", path) >= (int)sizeof temporary)
    return hk_error_set(error, HK_IO, "the path %s is too long", path);
  errno = 0;
  FILE *file = fopen(temporary, "wb");
  if (!file) return io_error(error, "write", path);
  bool fine = body(file, what);
  fine = fclose(file) == 0 && fine;
  if (fine && rename_it) fine = rename(temporary, path) == 0;
  if (fine) return HK_OK;
  hk_status status = io_error(error, "write", path);
  if (rename_it) unlink(temporary);
  return status;
}

static bool table_body(FILE *file, const void *what) {
  const hk_snapshot *s = what;
  fputs("id,x,y,z,vx,vy,vz,mass\n", file);
  for (size_t i = 0; i < s->n; i++) {
    const double *x = s->X + 3 * i, *v = s->X + 3 * (s->n + i);
    fprintf(file, "%" PRIu32 ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", s->id[i], x[0], x[1], x[2], v[0], v[1],
            v[2], s->mass[i]);
  }
  return fflush(file) == 0 && !ferror(file);
}

hk_status hk_run_write_state(hk_run *run, const char *path, hk_error *error) {
  hk_snapshot now = {.n = run->model.n, .size = run->system.size, .X = run->X, .id = run->id, .mass = run->mass};
  return write_file(path, table_body, run->verdict == HK_DIVERGED ? &run->last_good : &now, error);
}

/* ---- fields and streams of one instance, written or read by the same walk ---- */

typedef bool (*transfer)(FILE *, void *, size_t);

static bool put(FILE *file, void *data, size_t bytes) { return bytes == 0 || fwrite(data, 1, bytes, file) == bytes; }
static bool get(FILE *file, void *data, size_t bytes) { return bytes == 0 || fread(data, 1, bytes, file) == bytes; }

static bool transfer_instance(FILE *file, hk_instance *instance, const hk_run *run, transfer move) {
  char label[128] = "";
  strncpy(label, instance->label, sizeof label - 1);
  if (!move(file, label, sizeof label) || strcmp(label, instance->label) != 0) return false;
  bool fine = move(file, instance->random, sizeof instance->random);
  for (const hk_field *f = instance->plugin->fields; f && f->name && fine; f++) {
    char *field = (char *)instance->self + f->offset;
    size_t length = f->width * (f->type == HK_FIELD_STATE ? run->system.size : run->model.n);
    if (f->flags & HK_SCRATCH) continue;
    if (f->type == HK_FIELD_NUMBER || f->type == HK_FIELD_INTEGER)
      fine = move(file, field, 8);
    else
      fine = move(file, *(double **)(void *)field, length * sizeof(double));
  }
  return fine;
}

static bool transfer_instances(FILE *file, hk_run *run, transfer move) {
  hk_scene *scene = run->scene;
  const hk_instances *lists[] = {&scene->source, &scene->force, &scene->constraint, &scene->corrector, &scene->output};
  bool fine = transfer_instance(file, scene->integrator, run, move);
  for (size_t l = 0; l < sizeof lists / sizeof *lists; l++)
    for (size_t k = 0; k < lists[l]->count && fine; k++) fine = transfer_instance(file, lists[l]->item[k], run, move);
  return fine;
}

typedef struct header {
  uint64_t n, width, frame, steps;
  double t, dt, last_h, energy_first, kinetic_max;
  uint32_t next_id, channels;
} header;

static bool checkpoint_body(FILE *file, const void *what) {
  hk_run *run = (hk_run *)(uintptr_t)what; /* the walk that writes is the walk that reads */
  header h = {run->model.n,
              run->width,
              run->frame,
              run->steps,
              run->system.t,
              run->dt,
              run->last_h,
              run->energy_first,
              run->kinetic_max,
              run->next_id,
              (uint32_t)run->model.channels};
  return put(file, (void *)(uintptr_t)magic, sizeof magic) && put(file, &h, sizeof h) &&
         put(file, run->id, h.n * sizeof *run->id) && put(file, run->group, h.n * sizeof *run->group) &&
         put(file, run->mass, h.n * sizeof *run->mass) && put(file, run->X, run->system.size * sizeof *run->X) &&
         transfer_instances(file, run, put);
}

hk_status hk_run_save(hk_run *run, const char *path, hk_error *error) {
  return write_file(path, checkpoint_body, run, error);
}

/* ---- reading ---- */

/* Old index to new: who of the scene is in the file. */
static uint32_t *map_to(const hk_run *run, const hk_particle_set *m) {
  uint32_t *map = malloc((run->model.n + 1) * sizeof *map);
  size_t j = 0;
  for (size_t i = 0; map && i < run->model.n; i++) {
    while (j < m->n && m->id[j] < run->id[i]) j++;
    map[i] = j < m->n && m->id[j] == run->id[i] ? (uint32_t)j : UINT32_MAX;
  }
  return map;
}

static hk_status install(hk_run *run, hk_particle_set *m) {
  uint32_t *map = map_to(run, m);
  if (!map) {
    hk_particle_set_free(m);
    return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the start state");
  }
  hk_status status = hk_state_install(run, map, m);
  free(map);
  return status;
}

static hk_status read_checkpoint(hk_run *run, FILE *file) {
  const char *path = run->scene->start_file;
  header h;
  hk_particle_set m = {0};
  errno = 0;
  if (!get(file, &h, sizeof h)) return io_error(&run->error, "read", path);
  if (h.width != run->width || h.channels != run->model.channels || h.n > UINT32_MAX)
    return hk_error_set(&run->error, HK_BAD_PARAM, "%s is from a scene with other channels", path);
  bool fine = hk_particle_set_allocate(&m, h.n, run->width) && get(file, m.id, h.n * sizeof *m.id) &&
              get(file, m.group, h.n * sizeof *m.group) && get(file, m.mass, h.n * sizeof *m.mass) &&
              get(file, m.X, ((6 + h.width) * h.n + 1) * sizeof *m.X);
  if (!fine) {
    hk_particle_set_free(&m);
    return io_error(&run->error, "read", path);
  }
  run->system.t = h.t;
  hk_status status = install(run, &m);
  if (status != HK_OK) return status;
  if (!transfer_instances(file, run, get))
    return hk_error_set(&run->error, HK_BAD_PARAM, "%s does not fit this scene: its plugins or their labels differ",
                        path);
  run->frame = h.frame;
  run->steps = h.steps;
  run->next_id = h.next_id;
  run->last_h = h.last_h;
  run->dt = h.dt;
  run->energy_first = h.energy_first;
  run->kinetic_max = h.kinetic_max;
  run->resumed = true;
  return HK_OK;
}

typedef struct row {
  uint32_t id;
  double number[7];
} row;

static int by_id(const void *a, const void *b) {
  uint32_t i = ((const row *)a)->id, j = ((const row *)b)->id;
  return (i > j) - (i < j);
}

static bool parse_row(const char *line, row *r) {
  char end;
  int got = sscanf(line, "%" SCNu32 ",%lf,%lf,%lf,%lf,%lf,%lf,%lf %c", &r->id, &r->number[0], &r->number[1],
                   &r->number[2], &r->number[3], &r->number[4], &r->number[5], &r->number[6], &end);
  bool finite = got == 8;
  for (int k = 0; k < 7 && finite; k++) finite = isfinite(r->number[k]);
  return finite && r->id >= 1 && r->number[6] >= 0;
}

static hk_status read_rows(hk_run *run, FILE *file, row **rows, size_t *count) {
  char line[512];
  size_t capacity = 0;
  *rows = NULL;
  *count = 0;
  while (fgets(line, sizeof line, file)) {
    if (*count == capacity) {
      row *grown = realloc(*rows, (capacity = 2 * capacity + 64) * sizeof *grown);
      if (!grown) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the start state");
      *rows = grown;
    }
    if (!parse_row(line, *rows + *count))
      return hk_error_set(&run->error, HK_IO, "%s:%zu: expected id,x,y,z,vx,vy,vz,mass", run->scene->start_file,
                          *count + 2);
    ++*count;
  }
  if (*count) qsort(*rows, *count, sizeof **rows, by_id);
  for (size_t k = 0; k < *count; k++)
    if ((*rows)[k].id > run->scene->n || (k && (*rows)[k].id == (*rows)[k - 1].id))
      return hk_error_set(&run->error, HK_BAD_PARAM, "%s: particle %" PRIu32 " is twice in it, or not in the scene",
                          run->scene->start_file, (*rows)[k].id);
  return HK_OK;
}

static void place(const hk_run *run, hk_particle_set *m, const row *rows) {
  for (size_t k = 0; k < m->n; k++) {
    size_t i = rows[k].id - 1; /* the scene's own particle: its group and channels stay */
    memcpy(m->X + 3 * k, rows[k].number, 3 * sizeof(double));
    memcpy(m->X + 3 * (m->n + k), rows[k].number + 3, 3 * sizeof(double));
    m->mass[k] = rows[k].number[6];
    m->id[k] = rows[k].id;
    m->group[k] = run->group[i];
    for (size_t c = 0; c < run->model.channels; c++) {
      size_t size = run->channel[c].size, offset = 6 + run->channel[c].offset;
      memcpy(m->X + offset * m->n + size * k, run->X + offset * run->model.n + size * i, size * sizeof(double));
    }
  }
}

static hk_status read_table(hk_run *run, FILE *file) {
  row *rows;
  size_t count;
  hk_particle_set m = {0};
  hk_status status = read_rows(run, file, &rows, &count);
  if (status == HK_OK && !hk_particle_set_allocate(&m, count, run->width)) {
    hk_particle_set_free(&m);
    status = hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the start state");
  }
  if (status == HK_OK) {
    place(run, &m, rows);
    status = install(run, &m);
  }
  free(rows);
  return status;
}

hk_status hk_state_start_file(hk_run *run) {
  const char *path = run->scene->start_file;
  char head[64] = "";
  errno = 0;
  FILE *file = fopen(path, "rb");
  if (!file) return io_error(&run->error, "read", path);
  hk_status status;
  if (get(file, head, sizeof magic) && memcmp(head, magic, sizeof magic) == 0) {
    status = read_checkpoint(run, file);
  } else {
    rewind(file);
    bool table = fgets(head, sizeof head, file) && strcmp(head, "id,x,y,z,vx,vy,vz,mass\n") == 0;
    status = table ? read_table(run, file)
                   : hk_error_set(&run->error, HK_IO,
                                  "%s is neither a checkpoint nor a table that begins with "
                                  "id,x,y,z,vx,vy,vz,mass",
                                  path);
  }
  fclose(file);
  return status;
}
