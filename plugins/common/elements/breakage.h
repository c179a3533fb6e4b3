/* "breakage/1": who in a run has edges or triangles that may be gone, molten or broken, for those that act along the
 * same ones by lists of their own, as heat does. */
#ifndef HK_BREAKAGE_H
#define HK_BREAKAGE_H

#include "core/plugin.h"

#define HK_BREAKAGE_INTERFACE "breakage/1"

enum { HK_BREAKAGE = 64 };

typedef struct hk_breakable {
  void (*lost)(const void *self, hk_lost_elements *out); /* as that of hk_internal_facet */
  const void *self;
} hk_breakable;

typedef struct hk_breakage {
  void *self;
  /* Called in `create`, valid as long as the run. HK_BAD_PARAM: there are too many. */
  hk_status (*enter)(void *self, const hk_breakable *);
  size_t count; /* of members; complete when all plugins have been created */
  hk_breakable member[HK_BREAKAGE];
} hk_breakage;

/* In `create` of a plugin with such elements. HK_FAILED, HK_BAD_PARAM: with a message. */
hk_status hk_breakage_enter(const hk_host *, const hk_breakable *);
/* Of all plugins how many elements are gone. */
size_t hk_breakage_count(const hk_breakage *);
/* gone: of each edge or triangle of the list whether it is gone, by the rules of the scene's surface
 * (core/plugin/gone_elements.h). Others do not go. HK_NO_MEMORY, with a message. */
hk_status hk_breakage_mark(const hk_breakage *, const hk_host *, const hk_tuples *node, bool *gone);

#endif
