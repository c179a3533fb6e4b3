/* Intersections of surfaces, counted at frames by the plugins that keep surfaces apart. A frame with intersections
 * makes the run inaccurate; those with which a run starts whose plugins remove them count only when they become more,
 * come back, or are still there at the end. */
#include "core/engine/contract/contract.h"
#include "core/run/judge/judge.h"

#include <stdio.h>
#include <string.h>

/* The plugins see the same surfaces: one count may be of more of them, none is of others. */
static void join(hk_contact_report *all, const hk_contact_report *one) {
  if (one->intersections > all->intersections) {
    all->intersections = one->intersections;
    memcpy(all->first, one->first, sizeof all->first);
    all->first[sizeof all->first - 1] = 0;
    all->remedy = one->remedy;
  }
  all->closest = fmin(all->closest, one->closest);
  all->impulse += one->impulse;
  all->impact_energy += one->impact_energy;
  all->repairs |= one->repairs;
}

static bool ask_force(hk_loop *loop, size_t k, hk_contact_report *out) {
  const hk_instance *force = loop->plugins->kind[HK_FORCE].item[k];
  const hk_state *s = loop->state;
  if (!hk_force_of(force->plugin)->surfaces.contacts) return false;
  hk_view view = hk_force_view_at(loop->dynamics, k, s->t, s->X, s->model.n);
  const hk_instance *outer = hk_enter(force);
  bool reported = hk_force_of(force->plugin)->surfaces.contacts(force->self, &view, out);
  hk_leave(force, outer);
  return reported;
}

static bool ask_corrector(hk_loop *loop, size_t k, hk_contact_report *out) {
  const hk_instance *corrector = loop->plugins->kind[HK_CORRECTOR].item[k];
  if (!corrector->plugin->corrector->contacts) return false;
  hk_view view = hk_instance_view(corrector, &loop->state->view);
  const hk_instance *outer = hk_enter(corrector);
  bool reported = corrector->plugin->corrector->contacts(corrector->self, &view, out);
  hk_leave(corrector, outer);
  if (corrector->plugin->corrector->flags & HK_REPORTS_WORK) out->impact_energy = 0; /* the host has it */
  return reported;
}

/* False: no plugin reports contact. */
static bool ask_all(hk_loop *loop, hk_contact_report *all) {
  static const hk_kind kinds[] = {HK_FORCE, HK_CORRECTOR};
  bool any = false;
  *all = (hk_contact_report){.closest = INFINITY};
  for (size_t which = 0; which < 2; which++)
    for (size_t k = 0; k < loop->plugins->kind[kinds[which]].count; k++) {
      hk_contact_report one = {.closest = INFINITY};
      if (!(which ? ask_corrector : ask_force)(loop, k, &one)) continue;
      join(all, &one);
      any = true;
    }
  all->impact_energy -= loop->record->contact_work;
  return any;
}

static hk_status refuse_start(hk_loop *loop, const hk_contact_report *now) {
  return hk_error_set(loop->error, HK_BAD_PARAM,
                      "surfaces intersect at the start, %zu pairs of an edge and a triangle, the first %s: start them "
                      "apart; or %s",
                      now->intersections, now->first,
                      now->remedy ? now->remedy : "name a corrector that removes intersections");
}

/* Contact takes energy, or hands on what surfaces that are moved on paths give. Where none moves, what it gives from a
 * time on at which it had given least comes from nothing. */
static void note_energy(hk_record *r, double given, bool driven) {
  bool first = r->contact_frames == 0;
  if (isnan(given)) return;
  r->contact_least = first || driven ? given : fmin(r->contact_least, given);
  r->contact_rise = fmax(r->contact_rise, given - r->contact_least);
}

static void note(hk_record *r, double t, const hk_contact_report *now) {
  bool first = r->contact_frames == 0, freeing = now->repairs && now->intersections <= r->intersections[1];
  if (first) r->intersections[0] = now->intersections;
  if (now->intersections > 0 && !freeing && !(first && now->repairs)) {
    r->contact.intersections += now->intersections;
    if (r->intersecting++ == 0) {
      r->intersecting_at = t;
      memcpy(r->contact.first, now->first, sizeof r->contact.first);
    }
  }
  r->contact.closest = first ? now->closest : fmin(r->contact.closest, now->closest);
  r->contact.impulse = now->impulse;
  r->contact.impact_energy = now->impact_energy;
  r->intersections[1] = now->intersections;
  r->contact_frames++;
}

hk_status hk_contacts_note(hk_loop *loop) {
  hk_record *r = loop->record;
  hk_contact_report now;
  if (r->frames == 0 && r->steps == 0 && r->contact_frames > 0) return HK_OK; /* the start was already counted */
  if (!ask_all(loop, &now)) return HK_OK;
  if (now.intersections > 0 && !now.repairs && r->contact_frames == 0) return refuse_start(loop, &now);
  note_energy(r, -now.impact_energy, loop->pins->has_paths);
  note(r, loop->state->t, &now);
  return HK_OK;
}
