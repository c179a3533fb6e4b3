/* See messages.h. A frame that comes while one waits is left out, so that the queue holds one frame at most, and the
 * numbers of those left out. */
#include "plugins/common/live/messages.h"

#include "plugins/common/elements/element_strain.h"

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
  free(m->force);
  m->strain = NULL, m->strain_room = 0;
  m->force = NULL, m->force_room = 0;
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
  for (size_t k = 0; k < model->element_lists; k++)
    if (hk_elements_strained(&model->element_list[k].elements)) return true;
  return false;
}

void hk_live_tell_run(hk_live_messages *m, const hk_view *view, const hk_frame *frame, bool forces) {
  static const char *const axis[] = {"x", "y", "z"};
  text t = {0};
  set_origin(m, view);
  m->strained = has_strain(view->model);
  m->forces = forces ? frame->forces : 0;
  add_number(&t, "fps", frame->fps);
  for (int c = 0; c < 3; c++) add_number(&t, axis[c], m->origin[c]);
  add_field(&t, "velocity", 3, "velocity");
  if (m->strained) add_field(&t, "strain", 1, "strain");
  for (size_t k = 0; k < view->model->channels; k++)
    add_field(&t, view->model->channel[k].name, view->model->channel[k].size, "channel");
  for (size_t k = 0; k < m->forces; k++) add_field(&t, frame->force_name[k], 3, "force");
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

static void note_strain(hk_live_messages *m, const hk_elements *e, size_t k, float strain) {
  for (unsigned member = 0; member < e->node.arity; member++) {
    float *at = &m->strain[hk_tuple(&e->node, k)[member]];
    if (fabsf(strain) > fabsf(*at)) *at = strain;
  }
}

/* Of every particle the strain of its elements that is largest by magnitude; returns the largest of all. */
static double measure_strain(hk_live_messages *m, const hk_view *view) {
  if (!hk_live_reserve((char **)&m->strain, &m->strain_room, (view->n + 1) * sizeof *m->strain)) return NAN;
  memset(m->strain, 0, view->n * sizeof *m->strain);
  float most = 0;
  for (size_t l = 0; l < view->model->element_lists; l++) {
    const hk_elements *e = &view->model->element_list[l].elements;
    for (size_t k = 0; hk_elements_strained(e) && k < e->node.count; k++) {
      float strain = (float)hk_element_strain(e, view->x, k);
      if (!isfinite(strain)) continue;
      if (fabsf(strain) > fabsf(most)) most = strain;
      note_strain(m, e, k, strain);
    }
  }
  return most;
}

/* n x 3 of each force. False: there is no memory, or a force failed, which it will say in the next step. */
static bool measure_forces(hk_live_messages *m, const hk_view *view, const hk_frame *f) {
  size_t each = 3 * view->n;
  if (!m->forces) return true;
  if (!hk_live_reserve((char **)&m->force, &m->force_room, (m->forces * each + 1) * sizeof *m->force)) return false;
  for (size_t k = 0; k < m->forces; k++)
    if (f->force(f, k, m->force + k * each) != HK_OK) return false;
  return true;
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
  size_t numbers = view->n * (6 + (m->strained ? 1 : 0) + channel_numbers(model) + 3 * m->forces);
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
  put_floats(&at, m->force, 3 * view->n * m->forces, NULL);
  hk_live_put_surroundings(&at, &m->around, m->origin);
}

/* Forces are evaluated for a frame that will be sent; the thread makes room meanwhile, and never takes any. */
void hk_live_tell_frame(hk_live_messages *m, const hk_view *view, const hk_frame *f) {
  if (m->queue.broken) return;
  double strain = m->strained ? measure_strain(m, view) : NAN;
  hk_live_lock(&m->queue);
  bool sent = m->queue.length < ALWAYS && (!m->strained || m->strain);
  if (m->queue.length < MOST) tell_numbers(m, view, f, strain);
  hk_live_unlock(&m->queue);
  if (!sent || !measure_forces(m, view, f)) return;
  hk_live_lock(&m->queue);
  tell_state(m, view, f);
  hk_live_unlock(&m->queue);
}
