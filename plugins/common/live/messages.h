/* Messages of a run that is watched, written by a thread of their own. A message is its letter and the bytes of what
 * follows, two uint32_t, and that:
 *
 *     R  the run, as text: lines "key<TAB>value", among them "field<TAB>name<TAB>components<TAB>kind" of the fields of
 * a frame, in their order, and "measure<TAB>name" T  uint32_t: number of the topology, n, edges, triangles, pins; ids
 * (n), edges (2 each), triangles (3 each), pins N  double: t, kinetic, potential, work (J), momentum (3), angular
 * momentum (3), largest strain, mean step since the frame before (s), then the measures F  uint32_t: frame, its
 * topology, n, 0; double: t; float: positions from the origin (3n), and the fields: velocities (3n), strain (n),
 * channels, and where they are asked for forces (3n each)
 *
 * All numbers are little-endian. N is sent at every frame, F where the reader keeps up. */
#ifndef HK_LIVE_MESSAGES_H
#define HK_LIVE_MESSAGES_H

#include "core/plugin.h"

#include <pthread.h>

typedef struct hk_live_messages {
  int fd;
  pthread_t thread;
  pthread_mutex_t lock;
  pthread_cond_t more;
  bool open, ending, broken; /* the thread runs; it ends when all is written; the reader has gone */
  char *queue, *spare;       /* what is to be written, and what the thread writes */
  size_t length, room, spare_room;
  double origin[3]; /* m */
  bool strained;
  uint32_t topology;
  double t; /* s, and steps at the frame before */
  size_t steps;
  float *strain;                  /* n */
  size_t forces;                  /* of which each is told by itself */
  double *force;                  /* forces x n x 3, N */
  size_t strain_room, force_room; /* bytes */
} hk_live_messages;

bool hk_live_open(hk_live_messages *, int fd); /* false: no memory, or no thread */
void hk_live_close(hk_live_messages *);        /* all is written, or the reader has gone; a second call does nothing */
void hk_live_tell_run(hk_live_messages *, const hk_view *, const hk_frame *, bool forces);
void hk_live_tell_topology(hk_live_messages *, const hk_view *);
void hk_live_tell_frame(hk_live_messages *, const hk_view *, const hk_frame *);

#endif
