/* Whether segments and triangles meet, decided without a tolerance, as if in exact arithmetic, for all finite doubles,
 * however large, small or different (orientation.h). Callers look before whether coordinates are finite.
 *
 * Touching is meeting: a corner on a face, an edge on an edge, faces in one plane that overlap. Triangles may be
 * degenerate; such a one is the segment or the point that it is. */
#ifndef HK_EXACT_H
#define HK_EXACT_H

#include <stdbool.h>

typedef const double *hk_point; /* 3 coordinates, m */

/* Whether the segments p q and r s have a point in common. */
bool hk_segments_meet(hk_point p, hk_point q, hk_point r, hk_point s);

/* Whether the segment p q and the triangle a b c have a point in common. */
bool hk_segment_meets_triangle(hk_point p, hk_point q, hk_point a, hk_point b, hk_point c);

#endif
