/* Velocities after sweeps whose moves do not follow the laws of impact: those that came to no end, and those from the
 * pins outwards, in which one end is held that is not pinned. There the positions are what they have become, and the
 * velocities are those of before without what leads beyond the limits. Impulses along the edges take it, so that
 * momentum and, about the positions as they are, angular momentum stay, and no energy is gained. */
#include "plugins/common/strain/strain_limits.h"

#include <string.h>

/* What is left after so many sweeps is beyond a limit in the next step, and corrected there. */
enum { SWEEPS = 10 };

void hk_strain_forget(hk_strain_limits *s) {
  size_t from = 0;
  uint32_t rank;
  while (hk_marks_next(&s->moved, &from, &rank)) continue;
  s->gain = 0;
  for (; s->remembered > 0; s->remembered--) s->is_touched[s->touched[s->remembered - 1]] = false;
}

void hk_strain_stop_moved(hk_strain_limits *s, const hk_strain_state *state) {
  size_t count = 0, from = 0;
  uint32_t rank;
  for (size_t k = 0; k < s->remembered; k++)
    memcpy(state->v + 3 * (size_t)s->touched[k], s->before[k], sizeof *s->before);
  while (hk_marks_next(&s->moved, &from, &rank)) s->list[count++] = s->edge_at[rank];
  bool any = true;
  for (int sweep = 0; sweep < SWEEPS && any; sweep++) {
    any = false;
    for (size_t k = 0; k < count; k++) any |= hk_strain_stop(s, s->list[k], state);
  }
}
