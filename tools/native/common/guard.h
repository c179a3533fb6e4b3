/* Arrays between pages that no one may touch, and a name for what a plugin does where it ends the process. A plugin
 * that writes beside an array, or into one that it may only read, gets a signal at once; the handler writes what it did
 * in a sentence, which the parent of the process reads. */
#ifndef HK_TOOLS_GUARD_H
#define HK_TOOLS_GUARD_H

#include <stdbool.h>
#include <stddef.h>

typedef enum hk_guard_side {
  HK_GUARD_BEHIND, /* the array ends at a page that cannot be touched */
  HK_GUARD_BEFORE  /* it starts behind one */
} hk_guard_side;

typedef struct hk_guarded {
  const char *name; /* for the sentence; outlives the array */
  void *at;         /* `bytes` bytes, aligned to 16 where it is guarded behind, to a page where before */
  size_t bytes;
  bool shut; /* nobody may read it either */
  char *map; /* of the system */
  size_t mapped;
} hk_guarded;

enum { HK_GUARDED_MOST = 512 }; /* arrays at a time */

/* Zeroed. False: no memory, or too many arrays. A second call with the same `guarded` frees what it had. */
bool hk_guard_get(hk_guarded *guarded, const char *name, size_t bytes, hk_guard_side side);
void hk_guard_free(hk_guarded *guarded);
/* Whether it may be written, by anyone. */
void hk_guard_allow(hk_guarded *guarded, bool writable);
/* From now on nobody may read it, until hk_guard_allow: what was handed out for one call is not kept beyond it. */
void hk_guard_shut(hk_guarded *guarded);

/* From now on a fatal signal, or an exit(), of this process writes a sentence of a line to fd, with the function that
 * was entered last, before the process ends. */
void hk_guard_watch(int fd);
/* The name of the plugin's function that is at work, a constant; NULL: none. */
void hk_guard_enter(const char *function);

#endif
