/* The bytes of a checkpoint. The checksum is FNV-1a on eight lanes of 64-bit words, which a processor computes side by
 * side: 40 MB take some milliseconds. Each step is one-to-one, so a change within one word always shows. */
#include "core/run/storage/walk.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LANES = 8 };

static const uint64_t basis = 1469598103934665603u, prime = 1099511628211u;

static uint64_t sum_of(const unsigned char *byte, size_t count) {
  uint64_t lane[LANES], word[LANES], sum = basis;
  size_t k = 0;
  for (int l = 0; l < LANES; l++) lane[l] = basis + (uint64_t)l;
  for (; k + sizeof word <= count; k += sizeof word) {
    memcpy(word, byte + k, sizeof word);
    for (int l = 0; l < LANES; l++) lane[l] = (lane[l] ^ word[l]) * prime;
  }
  for (int l = 0; l < LANES; l++) sum = (sum ^ lane[l]) * prime;
  for (; k < count; k++) sum = (sum ^ byte[k]) * prime;
  return sum;
}

bool hk_walk_put(hk_walk *w, const void *data, size_t bytes) {
  hk_checkpoint *c = w->into;
  if (bytes > SIZE_MAX / 4 - c->count) return false;
  if (c->count + bytes > c->capacity) {
    size_t capacity = c->count + bytes + c->capacity / 2 + 4096;
    unsigned char *grown = realloc(c->byte, capacity);
    if (!grown) return false;
    c->byte = grown;
    c->capacity = capacity;
  }
  if (bytes) memcpy(c->byte + c->count, data, bytes);
  c->count += bytes;
  return true;
}

static bool put(void *walk, void *data, size_t bytes) { return hk_walk_put(walk, data, bytes); }

hk_walk hk_walk_write(hk_checkpoint *c) { return (hk_walk){.into = c, .move = put}; }

bool hk_walk_skip(hk_walk *w, size_t bytes) {
  if (bytes > w->left) return false;
  w->at += bytes;
  w->left -= bytes;
  return true;
}

bool hk_walk_get(void *walk, void *data, size_t bytes) {
  hk_walk *w = walk;
  if (bytes > w->left) return false;
  if (!data || bytes == 0) return true;
  memcpy(data, w->at, bytes);
  return hk_walk_skip(w, bytes);
}

bool hk_walk_seal(hk_checkpoint *c, size_t first) {
  uint64_t sum = sum_of(c->byte + first, c->count - first);
  hk_walk w = hk_walk_write(c);
  return hk_walk_put(&w, &sum, sizeof sum);
}

bool hk_walk_open(hk_walk *w, const hk_checkpoint *c, size_t first) {
  uint64_t stated;
  if (c->count < first + sizeof stated) return false;
  *w = (hk_walk){.at = c->byte + first, .left = c->count - first - sizeof stated, .move = hk_walk_get};
  memcpy(&stated, w->at + w->left, sizeof stated);
  return sum_of(w->at, w->left) == stated;
}

/* A plain file: a pipe has no end that could be known, and may never say a word. */
static FILE *open_plain(const char *path) {
  struct stat info;
  int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return NULL;
  bool plain = fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode);
  FILE *file = plain ? fdopen(descriptor, "rb") : NULL;
  int cause = plain ? errno : ENOTBLK;
  if (!file) close(descriptor);
  errno = cause;
  return file;
}

bool hk_walk_read_file(hk_checkpoint *c, const char *path) {
  FILE *file = open_plain(path);
  if (!file) return false;
  long end = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
  bool fine = end >= 0 && fseek(file, 0, SEEK_SET) == 0;
  if (fine) c->byte = malloc((size_t)end + 1);
  if (fine && !c->byte) errno = ENOMEM;
  fine = fine && c->byte && fread(c->byte, 1, (size_t)end, file) == (size_t)end;
  if (fine) c->count = c->capacity = (size_t)end;
  fclose(file);
  return fine;
}
