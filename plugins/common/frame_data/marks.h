/* What is felt at places of a frame: the wind, at some of the particles, and points of contact. */
#ifndef HK_FRAME_MARKS_H
#define HK_FRAME_MARKS_H

#include "core/plugin.h"

enum { HK_MARK_NAME = 64, HK_MARK_NUMBERS = 6 };

typedef struct hk_frame_marks {
  char name[HK_MARK_NAME]; /* label of the force whose medium it is; "contact" */
  bool contact;            /* the vectors are normals of length 1; otherwise velocities, m/s */
  size_t force;            /* of a medium: which one */
  size_t count, total;     /* marks; how many there would be: of many, some are taken */
  double *value;           /* count x 6: place and vector */
} hk_frame_marks;

typedef struct hk_mark_lists {
  size_t count;
  hk_frame_marks *list;
  double *found; /* scratch: room x 6 */
  size_t room;
  bool short_of_memory;
} hk_mark_lists;

/* "wind" or "contact". */
static inline const char *hk_mark_kind(bool contact) { return contact ? "contact" : "wind"; }

/* In `open`: a list for each medium, and one of contacts where there can be any. HK_NO_MEMORY. */
hk_status hk_marks_open(hk_mark_lists *, const hk_host *, const hk_frame *);
/* In `frame`. */
hk_status hk_marks_take(hk_mark_lists *, const hk_view *, const hk_frame *);
void hk_marks_free(hk_mark_lists *);

#endif
