/* Numbers of particles, frame after frame, as few bytes: the writing half of what tools/view/codec.js reads.
 *
 * A number is rounded to a multiple q of `step` above the low end of its component, 0 <= q <= HK_MOTION_LEVELS, so that
 * it is off by half a step at most; one that is not finite is HK_MOTION_NONE. A block begins with a key frame, in which
 * q is the difference to that of the particle before. In the frames after it q is the difference to what the particle's
 * last value (modes 1 and 3) or its last two values, on a straight line (2 and 4), foretell; in modes 3 and 4 what is
 * foretold is corrected by what the particle before is off. The mode is the one with the least differences in the
 * frame. A particle that is new is coded as in a key frame. Differences are modulo 2^16, so that nothing is lost. A
 * frame is the mode (a byte) and then the differences, 0, -1, 1, -2 ... as 0, 1, 2, 3 ...: the low bytes of all,
 * component by component, and then the high bytes, which are nearly all 0. */
#ifndef HK_MOTION_CODE_H
#define HK_MOTION_CODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_MOTION_LEVELS = 65534, HK_MOTION_NONE = 65535, HK_MOTION_COMPONENTS = 9, HK_MOTION_MODES = 4 };

typedef struct hk_motion_code {
  size_t components;
  double low[HK_MOTION_COMPONENTS], step;
  size_t n, room;     /* particles of the last frame, and for how many there is memory */
  uint32_t *id;       /* of the last frame, rising */
  uint16_t *value[3]; /* this frame's, the last one's and the one's before; component c of particle i at c * room + i */
  uint8_t *seen;      /* how many of the last two frames of the block have the particle */
  uint16_t *difference; /* of one component */
  unsigned char *byte;  /* of the block so far */
  size_t bytes, capacity;
  double error; /* the largest distance between what was given and what will be read, of all blocks */
} hk_motion_code;

/* Adds a frame: n x components doubles and n ids, at any addresses; `id` NULL: the same particles as in the last frame,
 * or, where the number is another, only new ones. False: no memory. */
bool hk_motion_code_add(hk_motion_code *, size_t n, const void *number, const void *id);
void hk_motion_code_begin_block(hk_motion_code *);
void hk_motion_code_free(hk_motion_code *);

#endif
