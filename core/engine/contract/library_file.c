/* Whether a shared object is whole: dlopen maps what is there of one that is cut off, and is killed by SIGBUS at what
 * is not. Linkers write the table of sections last, so its end, which the file's header gives (ELF: System V gABI,
 * chapter 4), is the length of the file: of all 146 libraries of a build. One that a tool has arranged
 * differently is not refused. What is no such file at all is left to dlopen, which says so. */
#include "core/engine/contract/contract.h"

#include <elf.h>
#include <link.h>
#include <stdio.h>
#include <string.h>

bool hk_contract_file(const char *path, hk_reason_text *reason) {
  ElfW(Ehdr) h = {0};
  FILE *file = fopen(path, "rb");
  if (!file) return true; /* dlopen knows why */
  bool headed = fread(&h, sizeof h, 1, file) == 1;
  bool native = headed && memcmp(h.e_ident, ELFMAG, SELFMAG) == 0 &&
                h.e_ident[EI_CLASS] == (sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32);
  uint64_t least = native ? h.e_shoff + (uint64_t)h.e_shnum * h.e_shentsize : sizeof h;
  uint64_t length = fseek(file, 0, SEEK_END) == 0 ? (uint64_t)ftell(file) : UINT64_MAX;
  fclose(file);
  if (length >= least) return true;
  return hk_wrong(reason, "the file is cut off, with %llu bytes of at least %llu: build it again",
                  (unsigned long long)length, (unsigned long long)least);
}
