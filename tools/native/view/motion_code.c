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
  uint16_t *difference = realloc(m->difference, room * sizeof *difference);
  if (difference) m->difference = difference;
  bool fine = id && seen && difference;
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

/* Moves what is known of particles to their new indices; of a new one nothing is. */
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
  return n == m->n && (n == 0 || !id || memcmp(m->id, id, n * sizeof *m->id) == 0);
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
    if (before) memcpy(seen, m->seen, before);
    for (size_t i = 0; i < n; i++) m->seen[i] = old[i] < SIZE_MAX ? seen[old[i]] : 0;
    for (int k = 1; k < 3; k++) { /* value[0] is free: this frame has not come yet */
      gather(m, m->value[0], m->value[k], old, n);
      uint16_t *other = m->value[k];
      m->value[k] = m->value[0];
      m->value[0] = other;
    }
    if (id && n) memcpy(m->id, id, n * sizeof *m->id);
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

/* What the particle's last values predict for component c. */
static unsigned predicted(const hk_motion_code *m, size_t c, size_t i, int order) {
  size_t at = c * m->room + i;
  int seen = m->seen[i] < order ? m->seen[i] : order;
  if (seen == 0) return i ? m->value[0][at - 1] : 0u;
  return seen == 1 ? m->value[1][at] : 2u * m->value[1][at] - m->value[2][at];
}

/* The differences of component c, as whole numbers from 0, to `into`; their sum. */
static double differences(const hk_motion_code *m, size_t c, int mode, uint16_t *into) {
  const uint16_t *now = m->value[0] + c * m->room;
  int order = mode & 1 ? 1 : 2;
  unsigned before = 0; /* by which the particle before is off its prediction */
  double sum = 0;
  for (size_t i = 0; i < m->n; i++) {
    unsigned off = now[i] - predicted(m, c, i, order);
    unsigned d = (off - (mode > 2 && m->seen[i] ? before : 0u)) & 0xffffu;
    before = m->seen[i] ? off : 0;
    into[i] = (uint16_t)(d < 0x8000u ? 2 * d : 2 * (0xffffu - d) + 1);
    sum += into[i];
  }
  return sum;
}

static int best_mode(const hk_motion_code *m, uint16_t *room) {
  int best = 1;
  double least = INFINITY;
  for (int mode = 1; mode <= HK_MOTION_MODES; mode++) {
    double sum = 0;
    for (size_t c = 0; c < m->components; c++) sum += differences(m, c, mode, room);
    if (sum < least) least = sum, best = mode;
  }
  return best;
}

static void write_frame(hk_motion_code *m) {
  size_t count = m->components * m->n;
  int mode = best_mode(m, m->difference);
  unsigned char *low = m->byte + m->bytes + 1, *high = low + count;
  m->byte[m->bytes] = (unsigned char)mode;
  for (size_t c = 0; c < m->components; c++) {
    differences(m, c, mode, m->difference);
    for (size_t i = 0; i < m->n; i++) {
      *low++ = (unsigned char)(m->difference[i] & 0xff);
      *high++ = (unsigned char)(m->difference[i] >> 8);
    }
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
  free(m->difference);
  free(m->byte);
  *m = (hk_motion_code){0};
}
