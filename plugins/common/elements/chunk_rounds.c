/* Chunks take the first round in which none of their particles is yet, which the bits of a word per particle say. On
 * meshes whose elements are numbered along the surface that makes two or three rounds; chunks that find all of the
 * word's rounds taken follow in a round each. */
#include "plugins/common/elements/chunk_rounds.h"

enum { WORD = 63 }; /* rounds that the bits of a word tell apart */

/* The round of each chunk; returns how many there are. */
static size_t colour(const hk_tuples *node, size_t chunks, uint64_t *taken, uint32_t *round) {
  size_t rounds = 0, beyond = WORD;
  for (size_t c = 0; c < chunks; c++) {
    size_t begin = c * HK_CHUNK_ELEMENTS * node->arity, end = begin + HK_CHUNK_ELEMENTS * node->arity;
    uint64_t mask = 0;
    if (end > node->count * node->arity) end = node->count * node->arity;
    for (size_t m = begin; m < end; m++) mask |= taken[node->index[m]];
    uint32_t r = 0;
    while (r < WORD && mask >> r & 1) r++;
    for (size_t m = begin; m < end && r < WORD; m++) taken[node->index[m]] |= (uint64_t)1 << r;
    round[c] = r < WORD ? r : (uint32_t)beyond++;
    if (round[c] >= rounds) rounds = round[c] + 1;
  }
  return rounds;
}

hk_status hk_chunk_rounds_sort(hk_chunk_rounds *s, const hk_host *host, size_t n, const hk_tuples *node) {
  size_t chunks = (node->count + HK_CHUNK_ELEMENTS - 1) / HK_CHUNK_ELEMENTS;
  host->release(host, s->first);
  host->release(host, s->chunk);
  uint64_t *taken = host->allocate(host, (n + 1) * sizeof *taken);
  uint32_t *round = host->allocate(host, (chunks + 1) * sizeof *round);
  *s = (hk_chunk_rounds){.elements = node->count, .chunk = host->allocate(host, (chunks + 1) * sizeof *s->chunk)};
  if (taken && round) s->rounds = colour(node, chunks, taken, round);
  s->first = host->allocate(host, (s->rounds + 2) * sizeof *s->first);
  bool fine = taken && round && s->chunk && s->first;
  for (size_t c = 0; c < chunks && fine; c++) s->first[round[c] + 2]++;
  for (size_t r = 2; r < s->rounds + 2 && fine; r++) s->first[r] += s->first[r - 1];
  for (size_t c = 0; c < chunks && fine; c++) s->chunk[s->first[round[c] + 1]++] = (uint32_t)c;
  host->release(host, taken);
  host->release(host, round);
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for the chunks of %zu elements", node->count);
}

typedef struct task {
  const hk_chunk_rounds *rounds;
  const uint32_t *chunk;
  void (*body)(const void *context, size_t begin, size_t end);
  const void *context;
} task;

static void run_chunks(void *context, size_t begin, size_t end, size_t unused) {
  const task *t = context;
  (void)unused;
  for (size_t k = begin; k < end; k++) {
    size_t first = (size_t)t->chunk[k] * HK_CHUNK_ELEMENTS, last = first + HK_CHUNK_ELEMENTS;
    t->body(t->context, first, last < t->rounds->elements ? last : t->rounds->elements);
  }
}

void hk_chunk_rounds_run(const hk_chunk_rounds *s, const hk_host *host,
                         void (*body)(const void *context, size_t begin, size_t end), const void *context) {
  for (size_t r = 0; r < s->rounds; r++) {
    task t = {s, s->chunk + s->first[r], body, context};
    host->parallel_for(host, s->first[r + 1] - s->first[r], 1, run_chunks, &t);
  }
}
