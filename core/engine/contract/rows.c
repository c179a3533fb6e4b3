/* A row names the member of the instance that it fills by a pointer into an instance at HK_BASE; which of the row's
 * pointers is set says the type. */
#include "core/engine/contract/contract.h"

#include <string.h>

static const size_t of_param[] = {
    [HK_NUMBER] = offsetof(hk_param, number),         [HK_INTEGER] = offsetof(hk_param, integer),
    [HK_BOOLEAN] = offsetof(hk_param, boolean),       [HK_STRING] = offsetof(hk_param, string),
    [HK_CHOICE] = offsetof(hk_param, choice),         [HK_VECTOR] = offsetof(hk_param, vector),
    [HK_NUMBERS] = offsetof(hk_param, numbers),       [HK_PARTICLES] = offsetof(hk_param, particles),
    [HK_EDGES] = offsetof(hk_param, edges),           [HK_TRIANGLES] = offsetof(hk_param, triangles),
    [HK_TETRAHEDRA] = offsetof(hk_param, tetrahedra), [HK_PER_TUPLE] = offsetof(hk_param, per_tuple),
    [HK_FUNCTION] = offsetof(hk_param, function)};

static const size_t of_field[] = {offsetof(hk_field, number),       offsetof(hk_field, integer),
                                  offsetof(hk_field, per_particle), offsetof(hk_field, state),
                                  offsetof(hk_field, array),        offsetof(hk_field, per_tuple)};
static const hk_type type_of_field[] = {HK_NUMBER,      HK_INTEGER,     HK_FIELD_PER_PARTICLE,
                                        HK_FIELD_STATE, HK_FIELD_ARRAY, HK_FIELD_PER_TUPLE};

/* The position of the only pointer that is set, and the pointer; `count`: there is none, or several. */
static size_t only(const void *row, const size_t *offset, size_t count, uintptr_t *address) {
  size_t found = count, set = 0;
  for (size_t k = 0; k < count; k++) {
    uintptr_t here;
    memcpy(&here, (const char *)row + offset[k], sizeof here);
    if (!here) continue;
    *address = here;
    found = k;
    set++;
  }
  return set == 1 ? found : count;
}

enum { PARAMS = sizeof of_param / sizeof *of_param, FIELDS = sizeof of_field / sizeof *of_field };

static void *in(const void *instance, uintptr_t address) { return (void *)((uintptr_t)instance + (address - HK_BASE)); }

hk_type hk_param_type(const hk_param *p) {
  uintptr_t address;
  size_t k = only(p, of_param, PARAMS, &address);
  return k < PARAMS ? (hk_type)k : HK_TYPES;
}

hk_type hk_field_type(const hk_field *f) {
  uintptr_t address;
  size_t k = only(f, of_field, FIELDS, &address);
  return k < FIELDS ? type_of_field[k] : HK_TYPES;
}

void *hk_param_in(const hk_param *p, const void *instance) {
  uintptr_t address = HK_BASE;
  only(p, of_param, PARAMS, &address);
  return in(instance, address);
}

void *hk_field_in(const hk_field *f, const void *instance) {
  uintptr_t address = HK_BASE;
  only(f, of_field, FIELDS, &address);
  return in(instance, address);
}

size_t hk_field_size(unsigned abi) { return (abi & 0xffff) < 1 ? offsetof(hk_field, per_tuple) : sizeof(hk_field); }

hk_field hk_field_row(const hk_plugin *plugin, size_t k) {
  hk_field row = {0};
  size_t size = hk_field_size(plugin->abi);
  memcpy(&row, (const char *)plugin->fields + k * size, size);
  return row;
}
