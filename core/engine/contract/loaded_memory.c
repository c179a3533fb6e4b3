/* Constants of a plugin, and all that they point to, lie in segments of loaded files: dl_iterate_phdr lists them. An
 * address elsewhere comes from a table without an end, or from a member that was never set. */
#define _GNU_SOURCE /* dl_iterate_phdr */
#include "core/engine/contract/contract.h"

#include <ctype.h>
#include <link.h>

typedef struct search {
  uintptr_t address;
  size_t left; /* bytes from the address to the end of its segment; 0: it is in none */
} search;

static int find_segment(struct dl_phdr_info *file, size_t size, void *context) {
  search *s = context;
  (void)size;
  for (size_t k = 0; k < file->dlpi_phnum && s->left == 0; k++) {
    uintptr_t begin = file->dlpi_addr + file->dlpi_phdr[k].p_vaddr, end = begin + file->dlpi_phdr[k].p_memsz;
    bool readable = file->dlpi_phdr[k].p_type == PT_LOAD && file->dlpi_phdr[k].p_flags & PF_R;
    if (readable && s->address >= begin && s->address < end) s->left = end - s->address;
  }
  return s->left > 0;
}

static size_t bytes_from(const void *address) {
  search s = {(uintptr_t)address, 0};
  dl_iterate_phdr(find_segment, &s);
  return s.left;
}

bool hk_loaded_memory(const void *address, size_t bytes) { return bytes_from(address) >= bytes; }

bool hk_loaded_text(const char *text) {
  for (size_t k = 0, left = bytes_from(text); k < left; k++)
    if (!text[k]) return true;
  return false;
}

bool hk_loaded_word(const char *text) {
  if (!hk_loaded_text(text) || !(isalpha((unsigned char)*text) || *text == '_')) return false;
  while (isalnum((unsigned char)*text) || *text == '_') text++;
  return !*text;
}
