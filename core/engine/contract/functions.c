/* The table of a plugin's kind: one line for each function that the host calls without asking whether it is there, and
 * for each pair of which one is of no use alone. */
#include "core/engine/contract/contract.h"

#include <string.h>

typedef struct table_rule {
  const char *type;
  size_t least; /* bytes: up to the end of the last required member */
  hk_member required[6];
} table_rule;

#define UP_TO(type, name) #type, HK_UP_TO(type, name)

static const table_rule rules[HK_KINDS] = {
    [HK_FORCE] = {UP_TO(hk_force, add), {{0}}},
    [HK_CONSTRAINT] = {UP_TO(hk_constraint, curvature),
                       {HK_MEMBER(hk_constraint, count), HK_MEMBER(hk_constraint, pattern),
                        HK_MEMBER(hk_constraint, value), HK_MEMBER(hk_constraint, jacobian),
                        HK_MEMBER(hk_constraint, curvature)}},
    [HK_CORRECTOR] = {UP_TO(hk_corrector, correct), {HK_MEMBER(hk_corrector, correct)}},
    [HK_SOURCE] = {UP_TO(hk_source, emit), {HK_MEMBER(hk_source, emit)}},
    [HK_INTEGRATOR] = {UP_TO(hk_integrator, step), {HK_MEMBER(hk_integrator, step)}},
    [HK_SOLVER] = {UP_TO(hk_solver, solve), {HK_MEMBER(hk_solver, factorize), HK_MEMBER(hk_solver, solve)}},
    [HK_OUTPUT] = {UP_TO(hk_output, frame), {HK_MEMBER(hk_output, frame)}},
    [HK_SERVICE] = {UP_TO(hk_service, table), {HK_MEMBER(hk_service, interface), HK_MEMBER(hk_service, table)}}};

static bool is_null(const void *table, size_t offset) {
  static const char none[sizeof(void (*)(void))];
  return memcmp((const char *)table + offset, none, sizeof none) == 0;
}

bool hk_contract_table(const void *table, const char *type, size_t least, const hk_member *required,
                       hk_reason_text *reason) {
  static const size_t most = 1 << 16; /* of another time: a hundred times what there is */
  if (!table) return hk_wrong(reason, "it has no table of functions, an %s", type);
  if (!hk_loaded_memory(table, least)) return hk_wrong(reason, "its table of functions is not in its file");
  size_t size = *(const size_t *)table; /* the first member */
  if (size < least || size > most || !hk_loaded_memory(table, size))
    return hk_wrong(reason, "its table of functions gives its size as %zu bytes: write .size = sizeof(%s)", size, type);
  for (const hk_member *m = required; m->name; m++)
    if (is_null(table, m->offset)) return hk_wrong(reason, "its %s has no '%s', which it must have", type, m->name);
  return true;
}

static bool sum_of_force(const hk_force *f, hk_reason_text *reason) {
  if (f->add || (HK_HAS(f, add_part) && f->add_part)) return true;
  return hk_wrong(reason, "its hk_force has neither 'add' nor 'add_part': it must have one of them");
}

static bool numbers_of_integrator(const hk_integrator *m, hk_reason_text *reason) {
  if (m->order >= 1 && m->stages >= 0) return true;
  return hk_wrong(reason, "its order is %d with %d stages: an order is 1 or more", m->order, m->stages);
}

bool hk_contract_functions(const hk_plugin *p, hk_reason_text *reason) {
  const table_rule *rule = &rules[p->kind];
  if (!hk_contract_table(p->force, rule->type, rule->least, rule->required, reason)) return false;
  if (p->kind == HK_FORCE) return sum_of_force(p->force, reason);
  if (p->kind == HK_INTEGRATOR) return numbers_of_integrator(p->integrator, reason);
  if (p->kind == HK_SERVICE && !hk_loaded_text(p->service->interface))
    return hk_wrong(reason, "its interface is no text like \"neighbours/1\"");
  return true;
}
