/* Finished pictures on their way to files, while the next ones are drawn: a ring of copies, and a thread for each of
 * the outlets, which takes every picture in order. */
#ifndef HK_CONVEYOR_H
#define HK_CONVEYOR_H

#include "core/plugin.h"

#include <limits.h>
#include <pthread.h>

typedef struct hk_still {
  unsigned char *rgba; /* the bottom row first, 4 bytes a pixel */
  char path[PATH_MAX]; /* of its file; "": there is to be none */
} hk_still;

typedef struct hk_film_outlet {
  /* Called in the outlet's thread. False: it failed, and takes no further pictures. */
  bool (*take)(void *self, const hk_still *);
  void *self;
} hk_film_outlet;

typedef struct hk_stop { /* whether to stop, asked ten times a second by whoever waits, in that thread */
  bool (*asked)(void *context);
  void *context;
} hk_stop;

enum { HK_CONVEYOR_ROOM = 3, HK_CONVEYOR_OUTLETS = 2 };

typedef struct hk_conveyor {
  const hk_host *host;
  size_t bytes; /* of a picture */
  hk_still still[HK_CONVEYOR_ROOM];
  size_t count; /* outlets */
  struct hk_conveyor_line {
    struct hk_conveyor *owner;
    hk_film_outlet outlet;
    pthread_t thread;
    bool started, failed;
    size_t taken; /* pictures */
  } line[HK_CONVEYOR_OUTLETS];
  pthread_mutex_t lock; /* of what follows, and of failed and taken */
  pthread_cond_t changed;
  size_t put; /* pictures */
  bool ended;
} hk_conveyor;

/* HK_NO_MEMORY; HK_FAILED: there is no thread. What is open has to be closed either way. */
hk_status hk_conveyor_open(hk_conveyor *, const hk_host *, size_t bytes, const hk_film_outlet *, size_t count);
/* Copies the picture once there is room. False: it was asked to stop. */
bool hk_conveyor_put(hk_conveyor *, const unsigned char *rgba, const char *path, const hk_stop *);
/* Waits until all is taken. False: it was asked to stop. */
bool hk_conveyor_drain(hk_conveyor *, const hk_stop *);
/* Whether this outlet has failed. */
bool hk_conveyor_failed(hk_conveyor *, size_t outlet);
/* Waits for the outlets, each of which finishes the picture it has; what is left is not taken. A zeroed or closed one
 * is allowed. */
void hk_conveyor_close(hk_conveyor *);

#endif
