/* The exported constant, in the order in which the host relies on it: version, kind, texts, name, tables. */
#include "core/engine/contract/contract.h"

#include <string.h>

/* A plugin is found by its file and reported by its name. */
static bool named_as_its_file(const hk_plugin *p, const char *path, hk_reason_text *reason) {
  const char *file = strrchr(path, '/');
  file = file ? file + 1 : path;
  size_t length = strlen(p->name);
  if (strncmp(file, p->name, length) == 0 && strcmp(file + length, ".so") == 0) return true;
  return hk_wrong(reason, "its name is '%s' and its file is %s: give both the same name", p->name, file);
}

static bool texts(const hk_plugin *p, hk_reason_text *reason) {
  if (!p->name || !hk_loaded_word(p->name))
    return hk_wrong(reason, "it has no name of letters, digits and underscores");
  if (!p->summary || !hk_loaded_text(p->summary) || !*p->summary)
    return hk_wrong(reason, "it has no summary, one line that says what it does");
  if (p->reference && !hk_loaded_text(p->reference)) return hk_wrong(reason, "its reference is no text");
  return true;
}

bool hk_contract_plugin(const hk_plugin *p, const char *path, hk_reason_text *reason) {
  static const size_t most = (size_t)1 << 30; /* an instance is a struct, not the data of a scene */
  if (!hk_loaded_memory(p, sizeof p->abi)) return hk_wrong(reason, "its hk_plugin_main is not in its file");
  unsigned major = p->abi >> 16, minor = p->abi & 0xffff;
  if (major != HK_ABI_MAJOR || minor > HK_ABI_MINOR)
    return hk_wrong(reason, "it was built for plugin interface %u.%u and this hooke has %d.%d: build it again", major,
                    minor, HK_ABI_MAJOR, HK_ABI_MINOR);
  if (!hk_loaded_memory(p, sizeof *p)) return hk_wrong(reason, "its hk_plugin_main is shorter than an hk_plugin");
  if ((unsigned)p->kind >= HK_KINDS) return hk_wrong(reason, "its kind, %d, is unknown", (int)p->kind);
  if (!texts(p, reason) || !named_as_its_file(p, path, reason)) return false;
  if (p->instance_size > most) return hk_wrong(reason, "its instance_size is %zu bytes", p->instance_size);
  return hk_contract_functions(p, reason) && hk_contract_facets(p, reason) && hk_contract_tables(p, reason);
}
