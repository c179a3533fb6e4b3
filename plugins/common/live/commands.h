/* What the user who watches a run wants of it: lines from a pipe. */
#ifndef HK_LIVE_COMMANDS_H
#define HK_LIVE_COMMANDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct hk_live_commands {
  int fd;
  bool paused, closed; /* closed: nobody drives any more */
  bool keep;           /* the run is to be kept at the next frame, and ends there */
  int steps;           /* frames to go on for while it is paused */
  double pace;         /* s of the run in a second; 0: as fast as it can */
  uint32_t held;       /* id; 0: none */
  double place[3], strength;
  char text[256]; /* of a line that is not whole yet */
  size_t length;
} hk_live_commands;

void hk_live_read(hk_live_commands *, double seconds); /* all that has come; waits so long for the first */
static inline bool hk_live_stopped(const hk_live_commands *c) { return c->paused && c->steps == 0; }

#endif
