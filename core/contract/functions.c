/* The table of a plugin's kind: one line for each function that the host calls without asking whether it is there, and
 * for each pair of which one is of no use alone. */
#include "core/contract/contract.h"

#include <string.h>

typedef struct member {
  const char *name;
  size_t offset;
} member;

typedef struct table_rule {
  const char *type;
  size_t least; /* bytes: up to the end of the last required member */
  member required[6];
} table_rule;

#define MEMBER(type, name)                                                                                             \
  { #name, offsetof(type, name) }
#define UP_TO(type, name) #type, offsetof(type, name) + sizeof(void (*)(void))

static const table_rule rules[HK_KINDS] = {
    [HK_FORCE] = {UP_TO(hk_force, add), {MEMBER(hk_force, add)}},
    [HK_CONSTRAINT] = {UP_TO(hk_constraint, curvature),
                       {MEMBER(hk_constraint, count), MEMBER(hk_constraint, pattern), MEMBER(hk_constraint, value),
                        MEMBER(hk_constraint, jacobian), MEMBER(hk_constraint, curvature)}},
    [HK_CORRECTOR] = {UP_TO(hk_corrector, correct), {MEMBER(hk_corrector, correct)}},
    [HK_SOURCE] = {UP_TO(hk_source, emit), {MEMBER(hk_source, emit)}},
    [HK_INTEGRATOR] = {UP_TO(hk_integrator, step), {MEMBER(hk_integrator, step)}},
    [HK_SOLVER] = {UP_TO(hk_solver, solve), {MEMBER(hk_solver, factorize), MEMBER(hk_solver, solve)}},
    [HK_OUTPUT] = {UP_TO(hk_output, frame), {MEMBER(hk_output, frame)}},
    [HK_SERVICE] = {UP_TO(hk_service, table), {MEMBER(hk_service, interface), MEMBER(hk_service, table)}}};

static bool is_null(const void *table, size_t offset) {
  static const char none[sizeof(void (*)(void))];
  return memcmp((const char *)table + offset, none, sizeof none) == 0;
}

static bool pairs_of_force(const hk_force *f, hk_reason_text *reason) {
  bool longer = f->size >= offsetof(hk_force, jacobian) + sizeof f->jacobian;
  if (longer && f->jacobian && !f->pattern)
    return hk_wrong(reason, "it has a jacobian without the pattern of its blocks");
  if (longer && f->pattern && !f->jacobian) return hk_wrong(reason, "it names blocks in pattern and has no jacobian");
  return true;
}

static bool numbers_of_integrator(const hk_integrator *m, hk_reason_text *reason) {
  if (m->order >= 1 && m->stages >= 0) return true;
  return hk_wrong(reason, "its order is %d with %d stages: an order is 1 or more", m->order, m->stages);
}

bool hk_contract_functions(const hk_plugin *p, hk_reason_text *reason) {
  static const size_t most = 1 << 16; /* of another time: a hundred times what there is */
  const table_rule *rule = &rules[p->kind];
  if (!p->force) return hk_wrong(reason, "it has no table of functions, an %s", rule->type);
  if (!hk_loaded_memory(p->force, rule->least)) return hk_wrong(reason, "its table of functions is not in its file");
  if (p->force->size < rule->least || p->force->size > most || !hk_loaded_memory(p->force, p->force->size))
    return hk_wrong(reason, "its table of functions gives its size as %zu bytes: write .size = sizeof(%s)",
                    p->force->size, rule->type);
  for (const member *m = rule->required; m->name; m++)
    if (is_null(p->force, m->offset))
      return hk_wrong(reason, "its %s has no '%s', which it must have", rule->type, m->name);
  if (p->kind == HK_FORCE) return pairs_of_force(p->force, reason);
  if (p->kind == HK_INTEGRATOR) return numbers_of_integrator(p->integrator, reason);
  if (p->kind == HK_SERVICE && !hk_loaded_text(p->service->interface))
    return hk_wrong(reason, "its interface is no text like \"neighbours/1\"");
  return true;
}
