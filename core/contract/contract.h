/* Whether a plugin keeps the contract of core/plugin.h, as far as its file and its exported constant show: seen before
 * any of its functions is called, so that what is wrong is one sentence and not a crash. */
#ifndef HK_CONTRACT_H
#define HK_CONTRACT_H

#include "core/base/base.h"

typedef struct hk_reason_text {
  char text[512]; /* one sentence without a full stop; "": nothing is wrong */
} hk_reason_text;

/* plugin.c: what is wrong with the constant in the loaded file `path`: false with the reason. */
bool hk_contract_plugin(const hk_plugin *, const char *path, hk_reason_text *reason);

/* copy.c: a copy of a constant that keeps the contract; members that its table lacks are 0. The caller frees it. NULL:
 * no memory. */
const hk_plugin *hk_contract_copy(const hk_plugin *);

/* ---- library_file.c: a shared object cut off in its middle is mapped by dlopen and crashes later ---- */

bool hk_contract_file(const char *path, hk_reason_text *reason);

/* ---- Used by plugin.c ---- */

/* tables.c: the parameter table and the field table of a constant that is otherwise right. */
bool hk_contract_tables(const hk_plugin *, hk_reason_text *reason);
/* functions.c: the table of the kind: its size and the functions that the host calls without asking for them. */
bool hk_contract_functions(const hk_plugin *, hk_reason_text *reason);

/* ---- loaded_memory.c: constants are in memory of a loaded file, or nobody can have written them there ---- */

bool hk_loaded_memory(const void *address, size_t bytes);
bool hk_loaded_text(const char *text); /* with its end */
bool hk_loaded_word(const char *text); /* and it is a word of letters, digits and underscores */

/* reason.c: writes the reason; returns false, for `return hk_wrong(...)`. */
bool hk_wrong(hk_reason_text *reason, const char *format, ...) HK_PRINTF(2, 3);

#endif
