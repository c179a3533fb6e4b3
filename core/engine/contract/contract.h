/* Whether a plugin keeps the contract of core/plugin.h, as far as its file and its exported constant show: seen before
 * any of its functions is called, so that what is wrong is one sentence and not a crash. */
#ifndef HK_CONTRACT_H
#define HK_CONTRACT_H

#include "core/engine/base/base.h"

typedef struct hk_reason_text {
  char text[512]; /* one sentence without a full stop; "": nothing is wrong */
} hk_reason_text;

/* plugin.c: what is wrong with the constant in the loaded file `path`: false with the reason. */
bool hk_contract_plugin(const hk_plugin *, const char *path, hk_reason_text *reason);

/* copy.c: a copy of a constant that keeps the contract, with the tables of its facets (below); members that a table
 * lacks are 0. The caller frees it. NULL: no memory. */
const hk_plugin *hk_contract_copy(const hk_plugin *);

/* ---- rows.c: what a row of a table of parameters or fields fills ---- */

typedef enum hk_type {
  HK_NUMBER,
  HK_INTEGER,
  HK_BOOLEAN,
  HK_STRING,
  HK_CHOICE,
  HK_VECTOR,
  HK_NUMBERS,
  HK_PARTICLES,
  HK_EDGES,
  HK_TRIANGLES,
  HK_TETRAHEDRA,
  HK_PER_TUPLE,
  HK_FUNCTION,
  HK_FIELD_PER_PARTICLE, /* of fields, beside numbers and integers */
  HK_FIELD_STATE,
  HK_FIELD_ARRAY,
  HK_FIELD_PER_TUPLE,
  HK_TYPES /* it names no member, or several */
} hk_type;

hk_type hk_param_type(const hk_param *);
hk_type hk_field_type(const hk_field *);
/* Its place in an instance; of a row that names one member. */
void *hk_param_in(const hk_param *, const void *instance);
void *hk_field_in(const hk_field *, const void *instance);
/* The pairs that a constraint joins, of its parameter p. */
static inline const hk_tuples *hk_joined_in(const hk_constraint *c, const hk_param *p, const void *instance) {
  return hk_param_in(c->joins ? &(hk_param){.edges = (hk_tuples *)(uintptr_t)c->joins} : p, instance);
}
/* The size of a row of the field table in a plugin of that version of the interface, bytes. */
size_t hk_field_size(unsigned abi);
/* Row k of the field table of a plugin's constant, whatever version it was built for. */
hk_field hk_field_row(const hk_plugin *, size_t k);

/* ---- The tables of a copy. Of a facet that the plugin does not have all members are 0 ---- */

typedef struct hk_force_tables {
  hk_force own;
  hk_implicit_facet implicit;
  hk_bounds_facet bounds;
  hk_elements_facet elements;
  hk_parts_facet parts;
  hk_steps_facet steps;
  hk_internal_facet internal;
  hk_surfaces_facet surfaces;
  hk_encounters_facet encounters;
  hk_approximation_facet approximation;
  hk_pictures_facet pictures;
  hk_by_hand_facet by_hand;
  hk_figures_facet figures;
} hk_force_tables;

typedef struct hk_integrator_tables {
  hk_integrator own;
  hk_tile_facet tile;
  hk_split_facet split;
  hk_constrained_facet constrained;
  hk_adaptive_facet adaptive;
  hk_corrected_facet corrected;
  hk_stages_facet stages;
} hk_integrator_tables;

/* Those of a copy of that kind. */
static inline const hk_force_tables *hk_force_of(const hk_plugin *copy) { return (const hk_force_tables *)copy->force; }
static inline const hk_integrator_tables *hk_integrator_of(const hk_plugin *copy) {
  return (const hk_integrator_tables *)copy->integrator;
}
/* Those to which the table of an integrator belongs, `own`. */
static inline const hk_integrator_tables *hk_integrator_tables_of(const hk_integrator *own) {
  return (const hk_integrator_tables *)own;
}

/* ---- library_file.c: a shared object cut off in its middle is mapped by dlopen and crashes later ---- */

bool hk_contract_file(const char *path, hk_reason_text *reason);

/* ---- Used by plugin.c ---- */

/* tables.c: the parameter table and the field table of a constant that is otherwise right. */
bool hk_contract_tables(const hk_plugin *, hk_reason_text *reason);
/* functions.c: the table of the kind: its size and the functions that the host calls without asking for them. */
bool hk_contract_functions(const hk_plugin *, hk_reason_text *reason);
/* facets.c: the list of facets, and their tables. */
bool hk_contract_facets(const hk_plugin *, hk_reason_text *reason);
const hk_facet *hk_facets_of(const hk_plugin *); /* its list; NULL: it has none */
void hk_contract_copy_facets(const hk_plugin *, void *tables);

/* A member that a table must have; a list of them ends with a NULL name. */
typedef struct hk_member {
  const char *name;
  size_t offset;
} hk_member;

#define HK_MEMBER(type, name)                                                                                          \
  { #name, offsetof(type, name) }
#define HK_UP_TO(type, name) (offsetof(type, name) + sizeof(((type *)0)->name))
/* Whether a table, a pointer, is long enough to have the member. */
#define HK_HAS(table, name) ((table)->size >= (size_t)((const char *)(&(table)->name + 1) - (const char *)(table)))

/* functions.c: a table of `type` in the plugin's file: its own size, at least `least` bytes, and its members. */
bool hk_contract_table(const void *table, const char *type, size_t least, const hk_member *required, hk_reason_text *);

/* ---- loaded_memory.c: constants are in memory of a loaded file, or nobody can have written them there ---- */

bool hk_loaded_memory(const void *address, size_t bytes);
bool hk_loaded_text(const char *text); /* with its end */
bool hk_loaded_word(const char *text); /* and it is a word of letters, digits and underscores */

/* reason.c: writes the reason; returns false, for `return hk_wrong(...)`. */
bool hk_wrong(hk_reason_text *reason, const char *format, ...) HK_PRINTF(2, 3);

#endif
