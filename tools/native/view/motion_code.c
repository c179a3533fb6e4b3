#include "tools/native/view/motion_code.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool reserve_particles(hk_motion_code *m, size_t n) {
  if (n <= m->room) return true;
  size_t room = n + n / 2;
  uint32_t *id = realloc(m->id, room * sizeof *id);
  if (id) m->id = id;
  uint8_t *seen = realloc(m->seen, room);
  if (seen) m->seen = seen;
  bool fine = id && seen;
  for (int k = 0; k < 3 && fine; k++) {
    uint16_t *value = calloc(room * m->components, sizeof *value);
    for (size_t c = 0; c < m->components && value && m->value[k]; c++)
      memcpy(value + c * room, m->value[k] + c * m->room, m->n * sizeof *value);
    fine = value != NULL;
    if (!fine) break;
    free(m->value[k]);
    m->value[k] = value;
  }
  if (fine) m->room = room;
  return fine;
}

static bool reserve_bytes(hk_motion_code *m, size_t more) {
  if (m->bytes + more <= m->capacity) return true;
  size_t capacity = 2 * (m->bytes + more);
  unsigned char *byte = realloc(m->byte, capacity);
  if (!byte) return false;
  m->byte = byte;
  m->capacity = capacity;
  return true;
}

static uint32_t id_at(const void *id, size_t i) {
  uint32_t value;
  memcpy(&value, (const char *)id + i * sizeof value, sizeof value);
  return value;
}

/* Moves what is known of a particle to its new index, at or below the old one or, where others were born, above. */
static void gather(const hk_motion_code *m, uint16_t *to, const uint16_t *from, const size_t *old, size_t n) {
  for (size_t c = 0; c < m->components; c++)
    for (size_t i = 0; i < n; i++) to[c * m->room + i] = old[i] < SIZE_MAX ? from[c * m->room + old[i]] : 0;
}

/* Both lists of ids rise: the old index of each particle, SIZE_MAX for a new one. */
static void match(const hk_motion_code *m, size_t n, const void *id, size_t *old) {
  for (size_t i = 0, k = 0; i < n; i++) {
    uint32_t wanted = id_at(id, i);
    while (k < m->n && m->id[k] < wanted) k++;
    old[i] = k < m->n && m->id[k] == wanted ? k : SIZE_MAX;
  }
}

static bool same_particles(const hk_motion_code *m, size_t n, const void *id) {
  return n == m->n && (!id || memcmp(m->id, id, n * sizeof *m->id) == 0);
}

/* The last two frames, in the order of this one's particles. */
static bool follow(hk_motion_code *m, size_t n, const void *id) {
  if (same_particles(m, n, id)) return true;
  size_t before = m->n, *old = malloc((n + 1) * sizeof *old);
  if (!old || !reserve_particles(m, n)) {
    free(old);
    return false;
  }
  if (id)
    match(m, n, id, old);
  else
    for (size_t i = 0; i < n; i++) old[i] = SIZE_MAX;
  uint8_t *seen = malloc(before + 1);
  if (seen) {
    memcpy(seen, m->seen, before);
    for (size_t i = 0; i < n; i++) m->seen[i] = old[i] < SIZE_MAX ? seen[old[i]] : 0;
    for (int k = 1; k < 3; k++) { /* value[0] is free: this frame has not come yet */
      gather(m, m->value[0], m->value[k], old, n);
      uint16_t *other = m->value[k];
      m->value[k] = m->value[0];
      m->value[0] = other;
    }
    if (id) memcpy(m->id, id, n * sizeof *m->id);
    m->n = n;
  }
  free(old);
  free(seen);
  return seen != NULL;
}

static void quantise(hk_motion_code *m, const void *number) {
  for (size_t i = 0; i < m->n; i++) {
    double square = 0;
    for (size_t c = 0; c < m->components; c++) {
      double value;
      memcpy(&value, (const char *)number + (i * m->components + c) * sizeof value, sizeof value);
      double place = m->step > 0 ? floor((value - m->low[c]) / m->step + 0.5) : 0;
      bool finite = isfinite(value);
      uint16_t q = finite ? (uint16_t)fmin(fmax(place, 0), HK_MOTION_LEVELS) : HK_MOTION_NONE;
      m->value[0][c * m->room + i] = q;
      double off = finite ? m->low[c] + q * m->step - value : 0;
      square += off * off;
    }
    m->error = fmax(m->error, sqrt(square));
  }
}

static uint16_t difference(const hk_motion_code *m, size_t c, size_t i, int order) {
  size_t at = c * m->room + i;
  const uint16_t *now = m->value[0], *last = m->value[1], *before = m->value[2];
  int seen = m->seen[i] < order ? m->seen[i] : order;
  unsigned foretold = seen == 0 ? (i ? now[at - 1] : 0u) : seen == 1 ? last[at] : 2u * last[at] - before[at];
  unsigned d = (now[at] - foretold) & 0xffffu;
  return (uint16_t)(d < 0x8000u ? 2 * d : 2 * (0xffffu - d) + 1);
}

static double size_of(const hk_motion_code *m, int order) {
  double sum = 0;
  for (size_t c = 0; c < m->components; c++)
    for (size_t i = 0; i < m->n; i++) sum += difference(m, c, i, order);
  return sum;
}

static void write_frame(hk_motion_code *m) {
  size_t count = m->components * m->n;
  int order = size_of(m, 1) <= size_of(m, 2) ? 1 : 2;
  unsigned char *low = m->byte + m->bytes + 1, *high = low + count;
  m->byte[m->bytes] = (unsigned char)order;
  for (size_t c = 0; c < m->components; c++)
    for (size_t i = 0; i < m->n; i++) {
      uint16_t d = difference(m, c, i, order);
      *low++ = (unsigned char)(d & 0xff);
      *high++ = (unsigned char)(d >> 8);
    }
  m->bytes += 1 + 2 * count;
}

bool hk_motion_code_add(hk_motion_code *m, size_t n, const void *number, const void *id) {
  if (!reserve_particles(m, n) || !reserve_bytes(m, 1 + 2 * n * m->components) || !follow(m, n, id)) return false;
  quantise(m, number);
  write_frame(m);
  uint16_t *oldest = m->value[2];
  m->value[2] = m->value[1];
  m->value[1] = m->value[0];
  m->value[0] = oldest;
  for (size_t i = 0; i < n; i++) m->seen[i] = (uint8_t)(m->seen[i] < 2 ? m->seen[i] + 1 : 2);
  return true;
}

void hk_motion_code_begin_block(hk_motion_code *m) {
  m->bytes = 0;
  if (m->seen) memset(m->seen, 0, m->n);
}

void hk_motion_code_free(hk_motion_code *m) {
  for (int k = 0; k < 3; k++) free(m->value[k]);
  free(m->id);
  free(m->seen);
  free(m->byte);
  *m = (hk_motion_code){0};
}
