/* The facets that this host knows: one line for each. A plugin's list is checked against them before any of its code
 * runs, and copied into the tables that the host uses (contract.h), where a facet that the plugin lacks is all zero. */
#include "core/engine/contract/contract.h"
#include "core/engine/text/text.h"

#include <string.h>

typedef struct facet_rule {
  hk_kind kind;
  const char *id, *type;
  size_t size, least; /* bytes of its table as this host knows it; up to the end of the last required member */
  size_t offset;      /* of the copy in the kind's tables */
  hk_member required[3];
} facet_rule;

#define OF_FORCE(ID, member, last)                                                                                     \
  HK_FORCE, HK_##ID##_ID, "hk_" #member "_facet", sizeof(hk_##member##_facet), HK_UP_TO(hk_##member##_facet, last),    \
      offsetof(hk_force_tables, member)
#define OF_METHOD(ID, member, last)                                                                                    \
  HK_INTEGRATOR, HK_##ID##_ID, "hk_" #member "_facet", sizeof(hk_##member##_facet),                                    \
      HK_UP_TO(hk_##member##_facet, last), offsetof(hk_integrator_tables, member)

static const facet_rule rules[] = {
    {OF_FORCE(IMPLICIT, implicit, jacobian),
     {HK_MEMBER(hk_implicit_facet, pattern), HK_MEMBER(hk_implicit_facet, jacobian)}},
    {OF_FORCE(BOUNDS, bounds, size), {{NULL, 0}}},
    {OF_FORCE(ELEMENTS, elements, list), {HK_MEMBER(hk_elements_facet, list)}},
    {OF_FORCE(PARTS, parts, touch), {HK_MEMBER(hk_parts_facet, touch)}},
    {OF_FORCE(STEPS, steps, size), {{NULL, 0}}},
    {OF_FORCE(INTERNAL, internal, evolve), {HK_MEMBER(hk_internal_facet, evolve)}},
    {OF_FORCE(SURFACES, surfaces, size), {{NULL, 0}}},
    {OF_FORCE(ENCOUNTERS, encounters, find), {HK_MEMBER(hk_encounters_facet, find)}},
    {OF_FORCE(APPROXIMATION, approximation, sharpen),
     {HK_MEMBER(hk_approximation_facet, errors), HK_MEMBER(hk_approximation_facet, sharpen)}},
    {OF_FORCE(PICTURES, pictures, size), {{NULL, 0}}},
    {OF_FORCE(BY_HAND, by_hand, moved), {HK_MEMBER(hk_by_hand_facet, moved)}},
    {OF_FORCE(FIGURES, figures, list), {HK_MEMBER(hk_figures_facet, list)}},
    {OF_METHOD(TILE, tile, steps), {HK_MEMBER(hk_tile_facet, steps)}},
    {OF_METHOD(SPLIT, split, coupled_growth),
     {HK_MEMBER(hk_split_facet, select_fast), HK_MEMBER(hk_split_facet, coupled_growth)}},
    {OF_METHOD(CONSTRAINED, constrained, keeps), {{NULL, 0}}},
    {OF_METHOD(ADAPTIVE, adaptive, tolerance), {HK_MEMBER(hk_adaptive_facet, tolerance)}},
    {OF_METHOD(CORRECTED, corrected, account), {HK_MEMBER(hk_corrected_facet, account)}},
    {OF_METHOD(STAGES, stages, v_end), {{NULL, 0}}},
};

enum { RULES = sizeof rules / sizeof *rules };

static const facet_rule *rule_of(hk_kind kind, const char *id) {
  for (size_t k = 0; k < RULES; k++)
    if (rules[k].kind == kind && strcmp(rules[k].id, id) == 0) return &rules[k];
  return NULL;
}

const hk_facet *hk_facets_of(const hk_plugin *p) {
  if (p->kind == HK_FORCE) return HK_HAS(p->force, facets) ? p->force->facets : NULL;
  if (p->kind == HK_INTEGRATOR) return HK_HAS(p->integrator, facets) ? p->integrator->facets : NULL;
  return NULL;
}

/* ---- the check ---- */

typedef struct known_ids {
  hk_kind kind;
} known_ids;

/* The k-th id of this kind. */
static const char *id_at(const void *context, size_t k) {
  const known_ids *known = context;
  for (size_t r = 0; r < RULES; r++)
    if (rules[r].kind == known->kind && k-- == 0) return rules[r].id;
  return NULL;
}

static bool unknown(const hk_plugin *p, const char *id, hk_reason_text *reason) {
  const known_ids known = {p->kind};
  const char *near = hk_nearest_name(id, id_at, &known);
  if (near)
    return hk_wrong(reason, "it has the facet '%s', which this hooke does not know; did you mean '%s'?", id, near);
  return hk_wrong(reason, "it has the facet '%s', which this hooke does not know: core/plugin/facets has them all", id);
}

static bool good_table(const hk_plugin *p, const hk_stages_facet *f, hk_reason_text *reason) {
  if (f->count < 1 || f->count > HK_MOST_STAGES)
    return hk_wrong(reason, "its facet '%s' has %zu stages, and 1 to %d are possible", HK_STAGES_ID, f->count,
                    HK_MOST_STAGES);
  for (size_t k = 0; k < f->count; k++) {
    bool none = f->v[k][k] == 0 && f->x[k][k] == 0, both = f->v[k][k] > 0 && f->x[k][k] > 0;
    if (none || (both && p->integrator->flags & HK_IMPLICIT)) continue;
    return hk_wrong(reason,
                    "its facet '%s' has %g and %g on the diagonals of x and v in stage %zu: of explicit stages both "
                    "are 0, of those of an implicit method (HK_IMPLICIT) both are positive",
                    HK_STAGES_ID, f->x[k][k], f->v[k][k], k);
  }
  return true;
}

/* Of a table that is long enough. */
static bool good_stages(const hk_plugin *p, const hk_stages_facet *f, hk_reason_text *reason) {
  if (p->integrator->flags & HK_ADAPTIVE && !(HK_HAS(f, linear) && f->linear))
    return hk_wrong(reason, "it has the facet '%s', which is for methods with a fixed step", HK_STAGES_ID);
  if (HK_HAS(f, linear) && f->linear && !(f->start && f->start->count >= 3))
    return hk_wrong(reason, "its facet '%s' has `linear`, and no `start` of three stages", HK_STAGES_ID);
  if (!good_table(p, f, reason)) return false;
  if (!f->start && f->back == 0) return true;
  if (f->start && HK_HAS(f->start, start) && f->start->back == 0 && !f->start->start)
    return good_table(p, f->start, reason);
  return hk_wrong(reason, "its facet '%s' goes on from two states, and has no `start` that goes on from one",
                  HK_STAGES_ID);
}

static bool one_facet(const hk_plugin *p, const hk_facet *f, hk_reason_text *reason) {
  const facet_rule *rule = rule_of(p->kind, f->id);
  if (!rule) return unknown(p, f->id, reason);
  for (const hk_facet *other = hk_facets_of(p); other < f; other++)
    if (strcmp(other->id, f->id) == 0) return hk_wrong(reason, "it has the facet '%s' twice", f->id);
  if (strcmp(f->id, HK_INTERNAL_ID) == 0 && !(HK_HAS(p->force, energy) && p->force->energy))
    return hk_wrong(reason, "it has the facet '%s' and no energy, which is what its elements dissipate", f->id);
  if (!hk_contract_table(f->table, rule->type, rule->least, rule->required, reason)) return false;
  return strcmp(f->id, HK_STAGES_ID) != 0 || good_stages(p, f->table, reason);
}

bool hk_contract_facets(const hk_plugin *p, hk_reason_text *reason) {
  for (const hk_facet *f = hk_facets_of(p); f; f++) {
    if (!hk_loaded_memory(f, sizeof *f) || (f->id && !hk_loaded_text(f->id)))
      return hk_wrong(reason, "its list of facets has no end: row %zu is none; close it with {0}",
                      (size_t)(f - hk_facets_of(p)) + 1);
    if (!f->id) return true;
    if (!one_facet(p, f, reason)) return false;
  }
  return true;
}

/* ---- the copy ---- */

void hk_contract_copy_facets(const hk_plugin *p, void *tables) {
  for (const hk_facet *f = hk_facets_of(p); f && f->id; f++) {
    const facet_rule *rule = rule_of(p->kind, f->id);
    size_t size = *(const size_t *)f->table; /* the first member of every table */
    memcpy((char *)tables + rule->offset, f->table, size < rule->size ? size : rule->size);
  }
}
