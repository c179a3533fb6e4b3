/* State tables: "id,x,y,z,vx,vy,vz,mass" and a column for every number of a channel, with 17 digits, which restore the
 * same doubles when read. A table must contain every particle of the scene, unless sources may have removed some. */
#include "core/numerics/population/population.h"
#include "core/run/storage/files.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER = 512 }; /* characters at most of a number with its comma, also where another program wrote it */

static const char head[] = "id,x,y,z,vx,vy,vz,mass";

typedef struct row {
  uint32_t id, index;
} row;

typedef struct table {
  const hk_snapshot *snapshot;
  const hk_state *state;
  row *row; /* by rising id; NULL: that is their order */
} table;

/* "id,x,y,z,vx,vy,vz,mass,heat,dye[1],dye[2]". Spreadsheets compute a name that begins with = + - @ unless there is an
 * apostrophe ahead. */
static void write_head(FILE *file, const hk_model *m) {
  fputs(head, file);
  for (size_t k = 0; k < m->channels; k++)
    for (size_t c = 0; c < m->channel[k].size; c++) {
      const char *name = m->channel[k].name;
      fputs(*name && strchr("=+-@\t\r", *name) ? ",'" : ",", file);
      fprintf(file, m->channel[k].size > 1 ? "%s[%zu]" : "%s", name, c + 1);
    }
}

static void write_row(FILE *file, const hk_snapshot *s, const hk_model *m, size_t i) {
  const double *x = s->X + 3 * i, *v = s->X + 3 * (s->n + i);
  fprintf(file, "%" PRIu32 ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", s->id[i], x[0], x[1], x[2], v[0], v[1], v[2],
          s->mass[i]);
  for (size_t k = 0; k < m->channels; k++)
    for (size_t c = 0; c < m->channel[k].size; c++)
      fprintf(file, ",%.17g", s->X[(6 + m->channel[k].offset) * s->n + m->channel[k].size * i + c]);
  fputc('\n', file);
}

static bool body(FILE *file, const void *what) {
  const table *t = what;
  write_head(file, &t->state->model);
  fputc('\n', file);
  for (size_t i = 0; i < t->snapshot->n; i++)
    write_row(file, t->snapshot, &t->state->model, t->row ? t->row[i].index : i);
  return fflush(file) == 0 && !ferror(file);
}

static int by_id(const void *a, const void *b) {
  const row *p = a, *q = b;
  return (p->id > q->id) - (p->id < q->id);
}

static bool rises(const hk_snapshot *s) {
  for (size_t i = 1; i < s->n; i++)
    if (s->id[i] < s->id[i - 1]) return false;
  return true;
}

hk_status hk_state_table_write(const hk_snapshot *s, const hk_state *state, const char *path, hk_error *error) {
  table t = {s, state, rises(s) ? NULL : malloc(s->n * sizeof *t.row)};
  if (!t.row && !rises(s)) return hk_error_set(error, HK_NO_MEMORY, "no memory for the rows of %s", path);
  for (uint32_t i = 0; t.row && i < s->n; i++) t.row[i] = (row){s->id[i], i};
  if (t.row) qsort(t.row, s->n, sizeof *t.row, by_id);
  hk_status status = hk_write_file(path, body, &t, error);
  free(t.row);
  return status;
}

/* ---- reading ---- */

typedef struct rows {
  char *head, *line; /* what the first line has to be; the line that is read, of `room` characters at most */
  size_t room;
  size_t count, capacity, width; /* width: numbers of a row after the id, 7 and those of channels */
  uint32_t *id;
  double *number; /* count x width */
  size_t *order;  /* rows in the order of ids */
} rows;

static void free_rows(rows *r) {
  free(r->head);
  free(r->line);
  free(r->id);
  free(r->number);
  free(r->order);
}

static bool grow(rows *r) {
  if (r->count < r->capacity) return true;
  size_t capacity = 2 * r->capacity + 64;
  uint32_t *id = realloc(r->id, capacity * sizeof *id);
  if (id) r->id = id;
  double *number = realloc(r->number, capacity * r->width * sizeof *number);
  if (number) r->number = number;
  if (id && number) r->capacity = capacity;
  return id && number;
}

static bool parse_row(rows *r, const char *line) {
  char *end;
  unsigned long id = strtoul(line, &end, 10);
  double *number = r->number + r->count * r->width;
  bool fine = end != line && *line != '-' && id >= 1 && id < UINT32_MAX;
  for (size_t k = 0; k < r->width && fine; k++) {
    const char *at = end + 1;
    fine = *end == ',';
    if (fine) number[k] = strtod(at, &end);
    fine = fine && end != at && isfinite(number[k]);
  }
  r->id[r->count] = (uint32_t)id;
  return fine && (*end == '\n' || *end == '\r' || *end == 0) && number[6] >= 0;
}

static hk_status read_rows(const hk_scene *scene, hk_loop *loop, FILE *file, const char *path, rows *r) {
  while (fgets(r->line, (int)r->room, file)) {
    if (r->count == scene->particles.n)
      return hk_error_set(loop->error, HK_BAD_PARAM, "%s: it has more particles than the scene", path);
    if (!grow(r)) return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the start state");
    if (!parse_row(r, r->line))
      return hk_error_set(loop->error, HK_IO, "%s:%zu: expected %s%s with finite numbers", path, r->count + 2, head,
                          r->width > 7 ? " and channels" : "");
    r->count++;
  }
  if (ferror(file)) return hk_io_error(loop->error, "read", path);
  return HK_OK;
}

/* Checks that a table has the scene's particles and no others, each once; particles may be missing in a scene with
 * sources, where they may have died. */
static hk_status check_ids(size_t n, hk_loop *loop, rows *r, const char *path) {
  size_t *row_of = malloc((n + 1) * sizeof *row_of);
  r->order = malloc((r->count + 1) * sizeof *r->order);
  hk_status status = HK_OK;
  if (!row_of || !r->order) status = hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the start state");
  for (size_t i = 0; i < n && status == HK_OK; i++) row_of[i] = SIZE_MAX;
  for (size_t k = 0; k < r->count && status == HK_OK; k++)
    if (r->id[k] - 1 >= n || row_of[r->id[k] - 1] != SIZE_MAX)
      status = hk_error_set(loop->error, HK_BAD_PARAM, "%s: particle %" PRIu32 " is twice in it, or not in the scene",
                            path, r->id[k]);
    else
      row_of[r->id[k] - 1] = k;
  size_t found = 0;
  for (size_t k = 0; k < n && status == HK_OK; k++) {
    size_t i = loop->state->id[k] - 1;
    if (row_of[i] != SIZE_MAX)
      r->order[found++] = row_of[i];
    else if (loop->plugins->kind[HK_SOURCE].count == 0)
      status = hk_error_set(loop->error, HK_BAD_PARAM,
                            "%s: particle %zu of the scene is not in it; a state names every particle", path, i + 1);
  }
  free(row_of);
  return status;
}

static void place(const hk_loop *loop, hk_particle_set *set, const rows *r) {
  const hk_state *s = loop->state;
  for (size_t k = 0; k < set->n; k++) {
    const double *number = r->number + r->order[k] * r->width;
    uint32_t i;
    hk_state_index(s, r->id[r->order[k]], &i); /* a particle of the scene keeps its group */
    memcpy(set->X + 3 * k, number, 3 * sizeof(double));
    memcpy(set->X + 3 * (set->n + k), number + 3, 3 * sizeof(double));
    set->mass[k] = number[6];
    set->id[k] = s->id[i];
    set->group[k] = s->group[i];
    for (size_t c = 0; c < s->model.channels; c++) {
      size_t size = s->channel[c].size, offset = 6 + s->channel[c].offset;
      const double *from = r->width > 7 ? number + 7 + s->channel[c].offset : s->X + offset * s->model.n + size * i;
      memcpy(set->X + offset * set->n + size * k, from, size * sizeof(double));
    }
  }
}

static hk_status install(hk_loop *loop, const rows *r) {
  hk_particle_set set = {0};
  if (!hk_particle_set_allocate(&set, r->count, loop->state->width)) {
    hk_particle_set_free(&set);
    return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the start state");
  }
  place(loop, &set, r);
  return hk_install(loop, &set);
}

static bool any_timed(const hk_loop *loop) {
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < loop->plugins->kind[kind].count; k++) {
      const hk_plugin_spec *spec = loop->plugins->kind[kind].item[k]->spec;
      if (spec->timed_count || spec->from > 0 || isfinite(spec->to)) return true;
    }
  return false;
}

/* Whether the scene says what happens when: forces and parameters, pins, rates, the exact solution. */
static bool depends_on_time(const hk_scene *scene, const hk_loop *loop) {
  bool depends = loop->dynamics->queries.flags & HK_DEPENDS_ON_T || scene->exact.call || any_timed(loop);
  for (size_t k = 0; k < loop->pins->count; k++)
    depends |= loop->pins->item[k].spec->kind == HK_PIN_PATH || isfinite(loop->pins->item[k].spec->release);
  for (size_t k = 0; k < scene->particles.channels; k++) depends |= scene->particles.channel[k].rate.call != NULL;
  return depends;
}

/* What a table does not hold is said. */
static void warn_of_gaps(const hk_scene *scene, hk_loop *loop, const rows *r, const char *path) {
  if (loop->state->width && r->width == 7)
    hk_warn(loop->warnings, "%s has no channels: they begin with the values that the scene gives them", path);
  if (depends_on_time(scene, loop))
    hk_warn(loop->warnings, "%s has no time: the scene, which depends on it, begins at t = 0 s; a checkpoint goes on",
            path);
}

static bool allocate_lines(rows *r, const hk_state *s) {
  size_t length = 0;
  FILE *text = open_memstream(&r->head, &length);
  if (text) write_head(text, &s->model);
  bool fine = text && fclose(text) == 0;
  r->room = length + NUMBER * (8 + s->width) + 1;
  return fine && (r->line = malloc(r->room));
}

/* The first line, of which `begun` is the beginning, is that of a table of this scene, with its channels or without. */
static hk_status check_head(hk_loop *loop, FILE *file, const char *begun, const char *path, rows *r) {
  if (!allocate_lines(r, loop->state)) return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the start state");
  size_t used = (size_t)snprintf(r->line, r->room, "%s", begun);
  if (!strchr(begun, '\n') && used + 1 < r->room && !fgets(r->line + used, (int)(r->room - used), file))
    r->line[used] = 0;
  r->line[strcspn(r->line, "\r\n")] = 0;
  bool bare = strcmp(r->line, head) == 0;
  r->width = bare ? 7 : 7 + loop->state->width;
  if (bare || strcmp(r->line, r->head) == 0) return HK_OK;
  return hk_error_set(loop->error, HK_BAD_PARAM, "%s: its columns are not %s", path, r->head);
}

hk_status hk_state_table_read(const hk_scene *scene, hk_loop *loop, FILE *file, const char *begun, const char *path) {
  rows r = {0};
  hk_status status = check_head(loop, file, begun, path, &r);
  if (status == HK_OK) status = read_rows(scene, loop, file, path, &r);
  if (status == HK_OK) status = check_ids(scene->particles.n, loop, &r, path);
  if (status == HK_OK) status = install(loop, &r);
  if (status == HK_OK) warn_of_gaps(scene, loop, &r, path);
  free_rows(&r);
  return status;
}
