/* Finding a channel of the scene that a plugin reads. */
#ifndef HK_CHANNELS_FIND_CHANNEL_H
#define HK_CHANNELS_FIND_CHANNEL_H

#include "core/plugin.h"

#include <string.h>

/* *found: the channel `name`, for the parameter `wanted_by`; valid as long as the run. `size` 0: of any size. */
static inline hk_status hk_find_channel(const hk_host *host, const hk_model *model, const char *name,
                                        const char *wanted_by, size_t size, const hk_channel **found) {
  for (size_t k = 0; k < model->channels; k++) {
    const hk_channel *channel = &model->channel[k];
    if (strcmp(channel->name, name) != 0) continue;
    *found = channel;
    if (size == 0 || channel->size == size) return HK_OK;
    return host->fail(host, HK_BAD_PARAM,
                      "%s: the channel '%s' has %zu numbers per particle, wanted are %zu: "
                      "declare one of that size",
                      wanted_by, name, channel->size, size);
  }
  return host->fail(host, HK_BAD_PARAM,
                    "%s: the scene has no channel '%s'; declare it: scene:channel(\"%s\", { initial = ... })",
                    wanted_by, name, name);
}

#endif
