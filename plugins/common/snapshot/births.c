#include "plugins/common/snapshot/births.h"

size_t hk_births_note(hk_births *b, const hk_view *view, double born) {
  size_t count = 0;
  for (size_t i = 0; i < view->n; i++)
    if (b->seen[i] == 0) b->seen[i] = 1, b->birth[i] = born, count++;
  b->last = view->t;
  return count;
}

void hk_births_note_first(hk_births *b, const hk_view *view, bool shown) {
  size_t count = hk_births_note(b, view, 0);
  if (count && view->t > 0 && shown)
    view->host->warn(
        view->host,
        "age: %zu particles were born before t = %g s, nobody noted when: they are shown as old as the run; a "
        "channel with the name age and rate = function() return 1 end keeps it",
        count, view->t);
}
