/* A host for functions of plugins/common that a tool calls outside of a run: messages, memory and threads. */
#ifndef HK_TOOL_HOST_H
#define HK_TOOL_HOST_H

#include "core/engine/host/host.h"

typedef struct hk_tool_host { /* does not move while it is open */
  hk_instance instance;
  hk_plugin plugin;
  hk_shared shared;
  hk_error error; /* of the last call that failed */
} hk_tool_host;

/* With a thread for each processor. Messages begin with `label`. NULL: no memory, or no thread. */
const hk_host *hk_tool_host_open(hk_tool_host *, const char *label);
void hk_tool_host_close(hk_tool_host *); /* a zeroed one is allowed */

#endif
