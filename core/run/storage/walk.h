/* A checkpoint in memory, and the walk over it: bytes are put at its end, or taken from its beginning. */
#ifndef HK_WALK_H
#define HK_WALK_H

#include "core/run/storage/files.h"

typedef struct hk_walk {
  hk_checkpoint *into;     /* NULL: the walk reads */
  const unsigned char *at; /* next byte to be read */
  size_t left;             /* bytes that may still be read */
  /* hk_walk_put or hk_walk_get; the first argument is the walk. With `data` NULL: whether there are so many. */
  bool (*move)(void *walk, void *data, size_t bytes);
} hk_walk;

hk_walk hk_walk_write(hk_checkpoint *);
bool hk_walk_put(hk_walk *, const void *data, size_t bytes); /* false: no memory */
bool hk_walk_get(void *walk, void *data, size_t bytes);      /* false: there are not so many */
bool hk_walk_skip(hk_walk *, size_t bytes);
bool hk_walk_seal(hk_checkpoint *, size_t first); /* adds the checksum of what follows the first bytes */
bool hk_walk_open(hk_walk *, const hk_checkpoint *, size_t first); /* false: the checksum is another one */
bool hk_walk_read_file(hk_checkpoint *, const char *path);         /* false: errno */

/* ---- checkpoint_file.c: what a checkpoint begins with ---- */

bool hk_checkpoint_begin(hk_walk *, const char *words, const char *origin); /* false: no memory */
bool hk_checkpoint_put_text(hk_walk *, const char *text, size_t bytes);     /* its length first */
/* Reads the file, and the two texts that it begins with, which are in the checkpoint's memory; NULL: an empty one. */
hk_status hk_checkpoint_open(hk_checkpoint *, hk_walk *, const char *path, const char **words, const char **origin,
                             hk_error *error);
hk_status hk_checkpoint_damaged(hk_error *error, const char *path); /* sets that error */

#endif
