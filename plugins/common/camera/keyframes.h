/* A camera on its way: where it is at some times, and smoothly between them. */
#ifndef HK_KEYFRAMES_H
#define HK_KEYFRAMES_H

#include "core/plugin.h"

enum { HK_KEYFRAME = 7 }; /* numbers of a row: t, x, y, z of the camera, x, y, z of what it looks at */

/* HK_BAD_PARAM: the numbers are no rows, their times do not rise, or a camera stands where it looks at. */
hk_status hk_keyframes_check(const hk_host *, const char *name, const hk_numbers *rows);
/* Where it is at time t: before the first row as there, after the last as there. At least one row. */
void hk_keyframes_at(const hk_numbers *rows, double t, double from[3], double look_at[3]);

#endif
