/* Finding what another plugin of the scene publishes of each particle. */
#ifndef HK_CHANNELS_FIND_PUBLISHED_H
#define HK_CHANNELS_FIND_PUBLISHED_H

#include "core/plugin.h"

#include <string.h>

/* *found: the numbers, one for each particle, that the plugin with the label publishes by the name `field`, for the
 * parameter `wanted_by`; valid as long as the run. `now`: a force wants those of a force at this evaluation, so that it
 * has to stand behind it; else they may be those of the last step. */
static inline hk_status hk_find_published(const hk_host *host, const hk_model *model, const char *label,
                                          const char *field, const char *wanted_by, bool now,
                                          const double *const **found) {
  for (size_t k = 0; k < model->publications; k++) {
    const hk_publication *p = &model->published[k];
    if (strcmp(p->label, label) != 0 || strcmp(p->name, field) != 0 || p->width != 1) continue;
    if (now && !*p->values) /* it is not there yet */
      return host->fail(host, HK_BAD_PARAM,
                        "%s: '%s' stands behind this in the scene, so that its %s is that of an earlier evaluation: "
                        "put it in front of this",
                        wanted_by, label, field);
    *found = p->values;
    return HK_OK;
  }
  return host->fail(
      host, HK_BAD_PARAM,
      "%s: nothing with the label '%s' publishes a %s of each particle; %s, and has its name as its label "
      "where it is given none",
      wanted_by, label, field,
      strcmp(field, "dissipation") == 0 ? "the force viscosity or the corrector liquid does" : "the force melt does");
}

#endif
