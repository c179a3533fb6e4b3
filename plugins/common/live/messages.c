/* See messages.h. The run appends to a queue under a lock; the thread takes the whole queue, and writes it while the
 * next one grows. A frame that comes while one waits is left out, so that the queue holds one frame at most, and the
 * numbers of those left out. */
#include "plugins/common/live/messages.h"

#include "plugins/common/elements/element_strain.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
  ALWAYS = 1 << 16,
  MOST = 1 << 26
}; /* bytes: below the first no frame is left out; beyond, numbers are as well */

/* ---- the queue and its thread ---- */

static bool reserve(char **block, size_t *room, size_t size) {
  if (size <= *room) return true;
  char *more = realloc(*block, 2 * size);
  if (!more) return false;
  *block = more;
  *room = 2 * size;
  return true;
}

static bool write_all(int fd, const char *bytes, size_t size) {
  while (size > 0) {
    ssize_t count = write(fd, bytes, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes += count;
    size -= (size_t)count;
  }
  return true;
}

static void *deliver(void *context) {
  hk_live_messages *m = context;
  pthread_mutex_lock(&m->lock);
  for (;;) {
    while (m->length == 0 && !m->ending) pthread_cond_wait(&m->more, &m->lock);
    if (m->length == 0) break;
    char *full = m->queue;
    size_t length = m->length, room = m->room;
    m->queue = m->spare;
    m->room = m->spare_room;
    m->length = 0;
    m->spare = full;
    m->spare_room = room;
    pthread_mutex_unlock(&m->lock);
    bool written = m->broken || write_all(m->fd, full, length);
    pthread_mutex_lock(&m->lock);
    m->broken |= !written;
  }
  pthread_mutex_unlock(&m->lock);
  return NULL;
}

/* Signals are for the run's thread, and a reader that has gone is no signal. */
bool hk_live_open(hk_live_messages *m, int fd) {
  sigset_t all, before;
  *m = (hk_live_messages){.fd = fd};
  if (pthread_mutex_init(&m->lock, NULL) != 0) return false;
  if (pthread_cond_init(&m->more, NULL) != 0) {
    pthread_mutex_destroy(&m->lock);
    return false;
  }
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  m->open = pthread_create(&m->thread, NULL, deliver, m) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  if (!m->open) {
    pthread_mutex_destroy(&m->lock);
    pthread_cond_destroy(&m->more);
  }
  return m->open;
}

void hk_live_close(hk_live_messages *m) {
  if (!m->open) return;
  pthread_mutex_lock(&m->lock);
  m->ending = true;
  pthread_cond_signal(&m->more);
  pthread_mutex_unlock(&m->lock);
  pthread_join(m->thread, NULL);
  pthread_mutex_destroy(&m->lock);
  pthread_cond_destroy(&m->more);
  free(m->queue);
  free(m->spare);
  free(m->strain);
  free(m->force);
  *m = (hk_live_messages){.fd = -1};
}

/* Room for a message of `size` bytes behind its head, under the lock, or NULL. */
static char *begin(hk_live_messages *m, char letter, size_t size) {
  uint32_t head[2] = {(uint32_t)letter, (uint32_t)size};
  if (size > UINT32_MAX || !reserve(&m->queue, &m->room, m->length + sizeof head + size)) return NULL;
  memcpy(m->queue + m->length, head, sizeof head);
  char *body = m->queue + m->length + sizeof head;
  m->length += sizeof head + size;
  return body;
}

static void put(char **at, const void *data, size_t bytes) {
  if (bytes) memcpy(*at, data, bytes);
  *at += bytes;
}

static void lock(hk_live_messages *m) { pthread_mutex_lock(&m->lock); }

static void unlock(hk_live_messages *m) {
  pthread_cond_signal(&m->more);
  pthread_mutex_unlock(&m->lock);
}

/* ---- R: what the run has ---- */

typedef struct text {
  char *bytes;
  size_t length, room;
} text;

/* A line of words with tabs between them; characters that would end a word are blanks. */
static void add_line(text *t, const char *const *word, size_t words) {
  for (size_t k = 0; k < words; k++) {
    size_t length = strlen(word[k]);
    if (!reserve(&t->bytes, &t->room, t->length + length + 1)) return;
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
  lock(m);
  char *body = begin(m, 'R', t.length);
  if (body) memcpy(body, t.bytes, t.length);
  unlock(m);
  free(t.bytes);
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
  lock(m);
  char *at = m->broken ? NULL : begin(m, 'T', words * sizeof(uint32_t));
  if (at) {
    put(&at, head, sizeof head);
    put(&at, model->id, view->n * sizeof *model->id);
    for (size_t k = 0; k < pair_lists(model); k++)
      put(&at, pair_list(model, k)->index, 2 * pair_list(model, k)->count * sizeof(uint32_t));
    put(&at, model->triangles.index, 3 * triangles * sizeof(uint32_t));
    for (uint32_t i = 0; i < view->n; i++)
      if (model->pin[i] != HK_FREE) put(&at, &i, sizeof i);
  }
  unlock(m);
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
  if (!reserve((char **)&m->strain, &m->strain_room, (view->n + 1) * sizeof *m->strain)) return NAN;
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
  if (!reserve((char **)&m->force, &m->force_room, (m->forces * each + 1) * sizeof *m->force)) return false;
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
  char *at = begin(m, 'N', sizeof number + f->measures * sizeof *f->measure);
  if (!at) return;
  put(&at, number, sizeof number);
  put(&at, f->measure, f->measures * sizeof *f->measure);
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
    put(at, &value, sizeof value);
  }
}

static void tell_state(hk_live_messages *m, const hk_view *view, const hk_frame *f) {
  const hk_model *model = view->model;
  uint32_t head[] = {(uint32_t)f->index, m->topology, (uint32_t)view->n, 0};
  size_t numbers = view->n * (6 + (m->strained ? 1 : 0) + channel_numbers(model) + 3 * m->forces);
  char *at = begin(m, 'F', sizeof head + sizeof view->t + numbers * sizeof(float));
  if (!at) return;
  put(&at, head, sizeof head);
  put(&at, &view->t, sizeof view->t);
  put_floats(&at, view->x, 3 * view->n, m->origin);
  put_floats(&at, view->v, 3 * view->n, NULL);
  if (m->strained) put(&at, m->strain, view->n * sizeof *m->strain);
  for (size_t k = 0; k < model->channels; k++)
    put_floats(&at, view->y + model->channel[k].offset * view->n, model->channel[k].size * view->n, NULL);
  put_floats(&at, m->force, 3 * view->n * m->forces, NULL);
}

/* Forces are evaluated for a frame that will be sent; the thread makes room meanwhile, and never takes any. */
void hk_live_tell_frame(hk_live_messages *m, const hk_view *view, const hk_frame *f) {
  if (m->broken) return;
  double strain = m->strained ? measure_strain(m, view) : NAN;
  lock(m);
  bool sent = m->length < ALWAYS && (!m->strained || m->strain);
  if (m->length < MOST) tell_numbers(m, view, f, strain);
  unlock(m);
  if (!sent || !measure_forces(m, view, f)) return;
  lock(m);
  tell_state(m, view, f);
  unlock(m);
}
