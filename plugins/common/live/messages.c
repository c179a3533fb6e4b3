/* See messages.h. A frame that comes while one waits is left out, so that the queue holds one frame at most, and the
 * numbers of those left out. */
#include "plugins/common/live/messages.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  ALWAYS = 1 << 16,
  MOST = 1 << 26
}; /* bytes: below the first no frame is left out; beyond, numbers are as well */

/* ---- R: what the run has ---- */

bool hk_live_open(hk_live_messages *m, int fd, const double origin[3]) {
  *m = (hk_live_messages){.origin = {origin[0], origin[1], origin[2]}};
  return hk_live_queue_open(&m->queue, fd);
}

void hk_live_close(hk_live_messages *m) {
  if (m->queue.open) hk_live_queue_close(&m->queue);
}

typedef struct text {
  char *bytes;
  size_t length, room;
} text;

/* A line of words with tabs between them; characters that would end a word are blanks. */
static void add_line(text *t, const char *const *word, size_t words) {
  for (size_t k = 0; k < words; k++) {
    size_t length = strlen(word[k]);
    if (!hk_live_reserve(&t->bytes, &t->room, t->length + length + 1)) return;
    for (size_t c = 0; c < length; c++) {
      bool blank = strchr("\t\r\n", word[k][c]) != NULL;
      t->bytes[t->length++] = blank ? ' ' : word[k][c];
    }
    t->bytes[t->length++] = k + 1 < words ? '\t' : '\n';
  }
}

static void add_number(text *t, const char *key, double value) {
  char digits[32];
  snprintf(digits, sizeof digits, "%.17g", value);
  add_line(t, (const char *const[]){key, digits}, 2);
}

static void add_field(text *t, const hk_frame_field *f) {
  char digits[24];
  snprintf(digits, sizeof digits, "%zu", f->components);
  add_line(t, (const char *const[]){"field", f->name, digits, hk_field_kinds[f->kind].name}, 4);
}

/* Single precision is enough for positions that are relative to the middle of the start. Of what is given that stays.
 */
static void set_origin(hk_live_messages *m, const hk_frame_data *d) {
  for (size_t c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < d->n; i++) {
      low = fmin(low, d->x[3 * i + c]);
      high = fmax(high, d->x[3 * i + c]);
    }
    if (isnan(m->origin[c])) m->origin[c] = d->n ? low / 2 + high / 2 : 0;
  }
}

static const char *unit_of(const hk_frame *frame, size_t k) {
  return frame->measure_unit ? frame->measure_unit[k] : "";
}

void hk_live_send_run(hk_live_messages *m, const hk_frame_data *d, const hk_frame *frame) {
  static const char *const axis[] = {"x", "y", "z"};
  hk_frame_field field;
  text t = {0};
  set_origin(m, d);
  add_number(&t, "fps", frame->fps);
  for (int c = 0; c < 3; c++) add_number(&t, axis[c], m->origin[c]);
  for (size_t k = 0; hk_frame_field_at(d, k, &field); k++) add_field(&t, &field);
  for (size_t k = 0; k < frame->measures; k++)
    add_line(&t, (const char *const[]){"measure", frame->measure_name[k], unit_of(frame, k)}, 3);
  for (size_t k = 0; k < d->marks.count; k++)
    add_line(&t, (const char *const[]){"mark", d->marks.list[k].name, hk_mark_kind(d->marks.list[k].contact)}, 3);
  for (size_t k = 0; k < d->groups && d->groups > 1; k++)
    add_line(&t, (const char *const[]){"group", d->group_name[k]}, 2);
  hk_live_lock(&m->queue);
  char *body = hk_live_begin(&m->queue, 'R', t.length);
  if (body) memcpy(body, t.bytes, t.length);
  hk_live_unlock(&m->queue);
  free(t.bytes);
  hk_live_send_solids(&m->queue, d);
}

/* ---- T: the topology ---- */

static void put_floats(char **at, const double *from, size_t count, const double *origin) {
  for (size_t k = 0; k < count; k++) {
    float value = (float)(from[k] - (origin ? origin[k % 3] : 0));
    hk_live_put(at, &value, sizeof value);
  }
}

static size_t count_pins(const hk_frame_data *d) {
  size_t pins = 0;
  for (size_t i = 0; i < d->n; i++) pins += d->pin[i] != HK_FREE;
  return pins;
}

void hk_live_send_topology(hk_live_messages *m, const hk_frame_data *d) {
  const hk_frame_cells *c = &d->cells;
  size_t pins = count_pins(d), groups = d->groups > 1 ? d->n : 0, radii = d->strand_radius ? d->n : 0;
  const uint32_t head[] = {++m->topology,  (uint32_t)d->n,   (uint32_t)c->segments, (uint32_t)c->triangles,
                           (uint32_t)pins, (uint32_t)groups, (uint32_t)radii};
  size_t words = sizeof head / sizeof *head + d->n + 2 * c->segments + 3 * c->triangles + pins + groups + radii;
  hk_live_lock(&m->queue);
  char *at = m->queue.broken ? NULL : hk_live_begin(&m->queue, 'T', words * sizeof(uint32_t));
  if (at) {
    hk_live_put(&at, head, sizeof head);
    hk_live_put(&at, d->id, d->n * sizeof *d->id);
    hk_live_put(&at, c->segment, c->segments * sizeof *c->segment);
    hk_live_put(&at, c->triangle, c->triangles * sizeof *c->triangle);
    for (uint32_t i = 0; i < d->n; i++)
      if (d->pin[i] != HK_FREE) hk_live_put(&at, &i, sizeof i);
    hk_live_put(&at, d->group, groups * sizeof *d->group);
    put_floats(&at, d->strand_radius, radii, NULL);
  }
  hk_live_unlock(&m->queue);
}

/* ---- N and F: a frame ---- */

/* The strain that is largest by magnitude; NAN: none is known. */
static double largest_strain(const hk_frame_data *d) {
  double most = d->strain ? 0 : NAN;
  for (size_t i = 0; d->strain && i < d->n; i++)
    if (fabs(d->strain[i]) > fabs(most)) most = d->strain[i];
  return most;
}

static void tell_figures(hk_live_messages *m, const hk_frame_data *d, const hk_frame *f) {
  double step = f->steps > m->steps ? (d->t - m->t) / (double)(f->steps - m->steps) : NAN;
  double number[] = {d->t,
                     f->kinetic,
                     f->potential,
                     f->work,
                     f->momentum[0],
                     f->momentum[1],
                     f->momentum[2],
                     f->angular_momentum[0],
                     f->angular_momentum[1],
                     f->angular_momentum[2],
                     largest_strain(d),
                     step};
  char *at = hk_live_begin(&m->queue, 'N', sizeof number + f->measures * sizeof *f->measure);
  if (!at) return;
  hk_live_put(&at, number, sizeof number);
  hk_live_put(&at, f->measure, f->measures * sizeof *f->measure);
  m->t = d->t;
  m->steps = f->steps;
}

bool hk_live_send_numbers(hk_live_messages *m, const hk_frame_data *d, const hk_frame *f) {
  if (m->queue.broken) return false;
  hk_live_lock(&m->queue);
  bool sent = m->queue.length < ALWAYS;
  if (m->queue.length < MOST) tell_figures(m, d, f);
  hk_live_unlock(&m->queue);
  return sent;
}

void hk_live_send_state(hk_live_messages *m, const hk_frame_data *d, const hk_frame *f) {
  uint32_t head[] = {(uint32_t)f->index, m->topology, (uint32_t)d->n, 0};
  size_t numbers = 3 * d->n;
  hk_frame_field field;
  for (size_t k = 0; hk_frame_field_at(d, k, &field); k++) numbers += field.components * d->n;
  hk_live_lock(&m->queue);
  char *at =
      hk_live_begin(&m->queue, 'F', sizeof head + sizeof d->t + numbers * sizeof(float) + hk_live_surroundings_size(d));
  if (at) {
    hk_live_put(&at, head, sizeof head);
    hk_live_put(&at, &d->t, sizeof d->t);
    put_floats(&at, d->x, 3 * d->n, m->origin);
    for (size_t k = 0; hk_frame_field_at(d, k, &field); k++)
      put_floats(&at, field.value, field.components * d->n, NULL);
    hk_live_put_surroundings(&at, d, m->origin);
  }
  hk_live_unlock(&m->queue);
}

void hk_live_send_doing(hk_live_messages *m, bool stopped) {
  uint32_t word = stopped;
  hk_live_lock(&m->queue);
  char *at = m->queue.broken ? NULL : hk_live_begin(&m->queue, 'D', sizeof word);
  if (at) hk_live_put(&at, &word, sizeof word);
  hk_live_unlock(&m->queue);
}

void hk_live_send_kept(hk_live_messages *m, const char *path) {
  size_t length = strlen(path);
  hk_live_lock(&m->queue);
  char *at = m->queue.broken ? NULL : hk_live_begin(&m->queue, 'K', length);
  if (at) hk_live_put(&at, path, length);
  hk_live_unlock(&m->queue);
}
