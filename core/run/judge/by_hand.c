/* What a user's hand did to a run that was watched. Such a run is judged by its own figures: its work is in the energy
 * balance like that of every force, and no other run can be compared with it. */
#include "core/engine/contract/contract.h"
#include "core/run/judge/judge.h"

void hk_by_hand_note(hk_loop *loop) {
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  hk_record *r = loop->record;
  double sum = 0;
  for (size_t k = 0; k < forces->count; k++) {
    const hk_instance *force = forces->item[k];
    double work = 0;
    const hk_by_hand_facet *hand = &hk_force_of(force->plugin)->by_hand;
    if (!hand->moved) continue;
    const hk_instance *outer = hk_enter(force);
    bool touched = hand->moved(force->self, &work);
    hk_leave(force, outer);
    if (!touched) continue;
    r->by_hand = true;
    sum += work;
  }
  if (r->by_hand) r->hand_work = sum;
}
