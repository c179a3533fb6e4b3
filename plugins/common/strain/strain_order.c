/* The order in which a sweep visits edges, and what pins do to it. */
#include "plugins/common/strain/strain_limits.h"

#include <string.h>

static bool holds(uint8_t pin) { return pin == HK_PIN_FIXED || pin == HK_PIN_PATH; }

/* ---- ranks ---- */

/* Breadth first from the particles that are held: how many edges away the next of them is. `incident` has edges here,
 * not yet ranks. */
static void find_levels(hk_strain_limits *s) {
  size_t head = 0, tail = 0;
  for (size_t i = 0; i < s->n; i++) {
    s->level[i] = holds(s->pin[i]) ? 0 : UINT32_MAX;
    if (s->level[i] == 0) s->queue[tail++] = (uint32_t)i;
  }
  for (; head < tail; head++)
    for (size_t k = s->start[s->queue[head]]; k < s->start[s->queue[head] + 1]; k++) {
      const uint32_t *pair = s->pair[s->incident[k]];
      uint32_t other = pair[pair[0] == s->queue[head]];
      if (s->level[other] != UINT32_MAX) continue;
      s->level[other] = s->level[s->queue[head]] + 1;
      s->queue[tail++] = other;
    }
}

/* Edges by their farther end; of these first those that lead there, then those within a level. Pieces without a pin
 * come last, in the given order. */
static bool nearer_to_pins(const hk_strain_limits *s, uint32_t e, uint32_t f) {
  const uint32_t *p = s->pair[e], *q = s->pair[f];
  uint32_t a = s->level[p[0]], b = s->level[p[1]], c = s->level[q[0]], d = s->level[q[1]];
  uint32_t far_e = a > b ? a : b, far_f = c > d ? c : d;
  if (far_e != far_f) return far_e < far_f;
  bool within_e = a == b, within_f = c == d;
  return within_e != within_f ? within_f : e < f;
}

/* A heap of `count` edges, of which the one at `at` may be out of order: on its top is the last. */
static void sink(const hk_strain_limits *s, uint32_t *heap, size_t at, size_t count, hk_strain_before *before) {
  uint32_t e = heap[at];
  for (size_t child; (child = 2 * at + 1) < count; at = child) {
    if (child + 1 < count && before(s, heap[child], heap[child + 1])) child++;
    if (!before(s, e, heap[child])) break;
    heap[at] = heap[child];
  }
  heap[at] = e;
}

void hk_strain_sort(const hk_strain_limits *s, uint32_t *list, size_t count, hk_strain_before *before) {
  for (size_t at = count / 2; at-- > 0;) sink(s, list, at, count, before);
  for (size_t end = count; end-- > 1;) {
    uint32_t last = list[0];
    list[0] = list[end];
    list[end] = last;
    sink(s, list, 0, end, before);
  }
}

static void list_incident_edges(hk_strain_limits *s) {
  memset(s->start, 0, (s->n + 2) * sizeof *s->start);
  for (size_t e = 0; e < s->count; e++) s->start[s->pair[e][0] + 2]++, s->start[s->pair[e][1] + 2]++;
  for (size_t i = 2; i < s->n + 2; i++) s->start[i] += s->start[i - 1];
  for (size_t e = 0; e < s->count; e++)
    for (int end = 0; end < 2; end++) s->incident[s->start[s->pair[e][end] + 1]++] = (uint32_t)e;
}

static void rank(hk_strain_limits *s) {
  list_incident_edges(s);
  for (size_t e = 0; e < s->count; e++) s->edge_at[e] = (uint32_t)e;
  if (s->order == HK_STRAIN_OUTWARDS) {
    find_levels(s);
    hk_strain_sort(s, s->edge_at, s->count, nearer_to_pins);
  }
  for (size_t r = 0; r < s->count; r++) s->rank_of[s->edge_at[r]] = (uint32_t)r;
  for (size_t k = 0; k < 2 * s->count; k++) s->incident[k] = s->rank_of[s->incident[k]];
}

/* ---- slides ---- */

/* The filter of the host projects a vector at each particle; so the columns of all projectors take three calls. */
static void read_projectors(hk_strain_limits *s, const hk_correction *c) {
  for (int column = 0; column < 3; column++) {
    for (size_t k = 0; k < 3 * s->n; k++) s->scratch[k] = k % 3 == (size_t)column;
    c->filter(c, s->scratch);
    for (size_t i = 0; i < s->n; i++)
      for (int row = 0; s->slide[i] != HK_NO_STRAIN_SLIDE && row < 3; row++)
        s->projector[s->slide[i]][3 * row + column] = s->scratch[3 * i + (size_t)row];
  }
}

static void take_slides(hk_strain_limits *s, const hk_correction *c) {
  uint32_t slides = 0;
  for (size_t i = 0; i < s->n; i++) {
    bool slid = s->pin[i] == HK_PIN_LINE || s->pin[i] == HK_PIN_PLANE;
    s->slide[i] = slid && c->filter ? slides++ : HK_NO_STRAIN_SLIDE;
  }
  if (slides) read_projectors(s, c);
}

void hk_strain_pins(hk_strain_limits *s, const hk_view *view, const hk_correction *c) {
  bool same = s->ordered && memcmp(s->pin, view->model->pin, s->n * sizeof *s->pin) == 0;
  if (same) return;
  memcpy(s->pin, view->model->pin, s->n * sizeof *s->pin);
  take_slides(s, c);
  if (!s->ordered || s->order == HK_STRAIN_OUTWARDS) rank(s);
  s->ordered = true;
}

hk_status hk_strain_reserve(hk_strain_limits *s, const hk_host *host) {
  s->edge_at = host->allocate(host, (s->count + 1) * sizeof *s->edge_at);
  s->rank_of = host->allocate(host, (s->count + 1) * sizeof *s->rank_of);
  s->start = host->allocate(host, (s->n + 2) * sizeof *s->start);
  s->incident = host->allocate(host, (2 * s->count + 1) * sizeof *s->incident);
  s->level = host->allocate(host, (s->n + 1) * sizeof *s->level);
  s->queue = host->allocate(host, (s->n + 1) * sizeof *s->queue);
  s->pin = host->allocate(host, (s->n + 1) * sizeof *s->pin);
  s->slide = host->allocate(host, (s->n + 1) * sizeof *s->slide);
  s->projector = host->allocate(host, (s->n + 1) * sizeof *s->projector);
  s->scratch = host->allocate(host, (3 * s->n + 1) * sizeof *s->scratch);
  bool fine = s->edge_at && s->rank_of && s->start && s->incident && s->level && s->queue && s->pin && s->slide &&
              s->projector && s->scratch;
  return fine ? HK_OK : HK_NO_MEMORY;
}
