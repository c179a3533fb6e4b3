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

bool hk_live_open(hk_live_messages *m, int fd) {
  *m = (hk_live_messages){0};
  return hk_live_queue_open(&m->queue, fd);
}

void hk_live_close(hk_live_messages *m) {
  if (!m->queue.open) return;
  hk_live_queue_close(&m->queue);
  free(m->strain);
  m->strain = NULL, m->strain_room = 0;
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

static void add_field(text *t, const char *name, size_t components, const char *kind) {
  char digits[24];
  snprintf(digits, sizeof digits, "%zu", components);
  add_line(t, (const char *const[]){"field", name, digits, kind}, 4);
}

/* Single precision is enough for positions that are relative to the middle of the start. */
static void set_origin(hk_live_messages *m, const hk_view *view) {
  for (size_t c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < view->n; i++) {
      low = fmin(low, view->x[3 * i + c]);
      high = fmax(high, view->x[3 * i + c]);
    }
    m->origin[c] = view->n ? low / 2 + high / 2 : 0;
  }
}

static bool has_strain(const hk_model *model) {
  for (size_t k = 0; k < model->element_lists; k++) {
    const hk_elements *e = &model->element_list[k].elements;
    if (hk_elements_are_edges(e) && e->rest.count) return true;
  }
  return false;
}

void hk_live_tell_run(hk_live_messages *m, const hk_view *view, const hk_frame *frame) {
  static const char *const axis[] = {"x", "y", "z"};
  text t = {0};
  set_origin(m, view);
  m->strained = has_strain(view->model);
  add_number(&t, "fps", frame->fps);
  for (int c = 0; c < 3; c++) add_number(&t, axis[c], m->origin[c]);
  add_field(&t, "velocity", 3, "velocity");
  if (m->strained) add_field(&t, "strain", 1, "strain");
  for (size_t k = 0; k < view->model->channels; k++)
    add_field(&t, view->model->channel[k].name, view->model->channel[k].size, "channel");
  for (size_t k = 0; k < frame->measures; k++)
    add_line(&t, (const char *const[]){"measure", frame->measure_name[k]}, 2);
  for (size_t k = 0; k < m->around.marks->count; k++) {
    const hk_marks *list = &m->around.marks->list[k];
    add_line(&t, (const char *const[]){"mark", list->name, list->contact ? "contact" : "wind"}, 3);
  }
  hk_live_lock(&m->queue);
  char *body = hk_live_begin(&m->queue, 'R', t.length);
  if (body) memcpy(body, t.bytes, t.length);
  hk_live_unlock(&m->queue);
  free(t.bytes);
  hk_live_tell_solids(&m->queue, &m->around);
}

/* ---- T: the topology ---- */

static size_t count_pins(const hk_model *model) {
  size_t pins = 0;
  for (size_t i = 0; i < model->n; i++) pins += model->pin[i] != HK_FREE;
  return pins;
}

/* The lists of pairs that are drawn: the scene's own edges, or where it has none those of forces and constraints. */
static size_t pair_lists(const hk_model *model) { return 1 + model->element_lists + model->join_lists; }

static const hk_tuples *pair_list(const hk_model *model, size_t k) {
  static const hk_tuples none = {.arity = 2};
  if (k == 0) return &model->edges;
  if (model->edges.count) return &none;
  if (k <= model->element_lists) {
    const hk_tuples *node = &model->element_list[k - 1].elements.node;
    return node->arity == 2 ? node : &none;
  }
  return model->join[k - 1 - model->element_lists];
}

static size_t count_pairs(const hk_model *model) {
  size_t pairs = 0;
  for (size_t k = 0; k < pair_lists(model); k++) pairs += pair_list(model, k)->count;
  return pairs;
}

void hk_live_tell_topology(hk_live_messages *m, const hk_view *view) {
  const hk_model *model = view->model;
  size_t pairs = count_pairs(model), pins = count_pins(model), triangles = model->triangles.count;
  size_t words = 5 + view->n + 2 * pairs + 3 * triangles + pins;
  uint32_t head[] = {++m->topology, (uint32_t)view->n, (uint32_t)pairs, (uint32_t)triangles, (uint32_t)pins};
  hk_live_lock(&m->queue);
  char *at = m->queue.broken ? NULL : hk_live_begin(&m->queue, 'T', words * sizeof(uint32_t));
  if (at) {
    hk_live_put(&at, head, sizeof head);
    hk_live_put(&at, model->id, view->n * sizeof *model->id);
    for (size_t k = 0; k < pair_lists(model); k++)
      hk_live_put(&at, pair_list(model, k)->index, 2 * pair_list(model, k)->count * sizeof(uint32_t));
    hk_live_put(&at, model->triangles.index, 3 * triangles * sizeof(uint32_t));
    for (uint32_t i = 0; i < view->n; i++)
      if (model->pin[i] != HK_FREE) hk_live_put(&at, &i, sizeof i);
  }
  hk_live_unlock(&m->queue);
}

/* ---- N and F: a frame ---- */

static double edge_strain(const hk_view *view, const hk_elements *e, size_t k) {
  const uint32_t *pair = hk_tuple(&e->node, k);
  double rest = hk_tuple_value(&e->rest, k), square = 0;
  for (size_t c = 0; c < 3; c++) {
    double d = view->x[3 * (size_t)pair[1] + c] - view->x[3 * (size_t)pair[0] + c];
    square += d * d;
  }
  return rest > 0 ? sqrt(square) / rest - 1 : NAN;
}

/* Of every particle the strain of its edges that is largest in size; returns the largest of all. */
static double measure_strain(hk_live_messages *m, const hk_view *view) {
  float *more = view->n > m->strain_room ? realloc(m->strain, view->n * sizeof *more) : m->strain;
  if (!more) return NAN;
  m->strain = more;
  if (view->n > m->strain_room) m->strain_room = view->n;
  memset(m->strain, 0, view->n * sizeof *m->strain);
  float most = 0;
  for (size_t l = 0; l < view->model->element_lists; l++) {
    const hk_elements *e = &view->model->element_list[l].elements;
    for (size_t k = 0; hk_elements_are_edges(e) && e->rest.count && k < e->node.count; k++) {
      float strain = (float)edge_strain(view, e, k);
      if (!isfinite(strain)) continue;
      if (fabsf(strain) > fabsf(most)) most = strain;
      for (int end = 0; end < 2; end++) {
        float *at = &m->strain[hk_tuple(&e->node, k)[end]];
        if (fabsf(strain) > fabsf(*at)) *at = strain;
      }
    }
  }
  return most;
}

static void tell_numbers(hk_live_messages *m, const hk_view *view, const hk_frame *f, double strain) {
  double step = f->steps > m->steps ? (view->t - m->t) / (double)(f->steps - m->steps) : NAN;
  double number[] = {view->t,
                     f->kinetic,
                     f->potential,
                     f->work,
                     f->momentum[0],
                     f->momentum[1],
                     f->momentum[2],
                     f->angular_momentum[0],
                     f->angular_momentum[1],
                     f->angular_momentum[2],
                     strain,
                     step};
  char *at = hk_live_begin(&m->queue, 'N', sizeof number + f->measures * sizeof *f->measure);
  if (!at) return;
  hk_live_put(&at, number, sizeof number);
  hk_live_put(&at, f->measure, f->measures * sizeof *f->measure);
  m->t = view->t;
  m->steps = f->steps;
}

static size_t channel_numbers(const hk_model *model) {
  size_t width = 0;
  for (size_t k = 0; k < model->channels; k++) width += model->channel[k].size;
  return width;
}

static void put_floats(char **at, const double *from, size_t count, const double *origin) {
  for (size_t k = 0; k < count; k++) {
    float value = (float)(from[k] - (origin ? origin[k % 3] : 0));
    hk_live_put(at, &value, sizeof value);
  }
}

static void tell_state(hk_live_messages *m, const hk_view *view, const hk_frame *f) {
  const hk_model *model = view->model;
  uint32_t head[] = {(uint32_t)f->index, m->topology, (uint32_t)view->n, 0};
  size_t numbers = view->n * (6 + (m->strained ? 1 : 0) + channel_numbers(model));
  char *at = hk_live_begin(
      &m->queue, 'F', sizeof head + sizeof view->t + numbers * sizeof(float) + hk_live_surroundings_size(&m->around));
  if (!at) return;
  hk_live_put(&at, head, sizeof head);
  hk_live_put(&at, &view->t, sizeof view->t);
  put_floats(&at, view->x, 3 * view->n, m->origin);
  put_floats(&at, view->v, 3 * view->n, NULL);
  if (m->strained) hk_live_put(&at, m->strain, view->n * sizeof *m->strain);
  for (size_t k = 0; k < model->channels; k++)
    put_floats(&at, view->y + model->channel[k].offset * view->n, model->channel[k].size * view->n, NULL);
  hk_live_put_surroundings(&at, &m->around, m->origin);
}

void hk_live_tell_frame(hk_live_messages *m, const hk_view *view, const hk_frame *f) {
  if (m->queue.broken) return;
  double strain = m->strained ? measure_strain(m, view) : NAN;
  hk_live_lock(&m->queue);
  if (m->queue.length < MOST) tell_numbers(m, view, f, strain);
  if (m->queue.length < ALWAYS && (!m->strained || m->strain)) tell_state(m, view, f);
  hk_live_unlock(&m->queue);
}
