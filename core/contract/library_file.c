/* The length of a shared object against what its own header speaks of (ELF: System V gABI, chapters 4 and 5). What is
 * no such file at all is left to dlopen, which says so. */
#include "core/contract/contract.h"

#include <elf.h>
#include <stdio.h>
#include <string.h>

#if UINTPTR_MAX > 0xffffffffu
typedef Elf64_Ehdr file_header;
typedef Elf64_Phdr segment_header;
enum { NATIVE_CLASS = ELFCLASS64 };
#else
typedef Elf32_Ehdr file_header;
typedef Elf32_Phdr segment_header;
enum { NATIVE_CLASS = ELFCLASS32 };
#endif

/* Where the file should end at least; 0: this cannot be read of it. */
static uint64_t least_length(FILE *file, const file_header *h) {
  uint64_t least = h->e_shoff + (uint64_t)h->e_shnum * h->e_shentsize;
  uint64_t table = h->e_phoff + (uint64_t)h->e_phnum * h->e_phentsize;
  if (table > least) least = table;
  for (unsigned k = 0; k < h->e_phnum && h->e_phentsize == sizeof(segment_header); k++) {
    segment_header s;
    if (fseek(file, (long)(h->e_phoff + k * sizeof s), SEEK_SET) != 0 || fread(&s, sizeof s, 1, file) != 1) break;
    if (s.p_type == PT_LOAD && s.p_offset + s.p_filesz > least) least = s.p_offset + s.p_filesz;
  }
  return least;
}

bool hk_contract_file(const char *path, hk_reason_text *reason) {
  file_header h;
  FILE *file = fopen(path, "rb");
  if (!file) return true; /* dlopen knows why */
  bool whole = fread(&h, sizeof h, 1, file) == 1;
  bool native = whole && memcmp(h.e_ident, ELFMAG, SELFMAG) == 0 && h.e_ident[EI_CLASS] == NATIVE_CLASS;
  uint64_t least = native ? least_length(file, &h) : sizeof h;
  uint64_t length = fseek(file, 0, SEEK_END) == 0 ? (uint64_t)ftell(file) : UINT64_MAX;
  fclose(file);
  if (length >= least) return true;
  return hk_wrong(reason, "the file is cut off, with %llu bytes of at least %llu: build it again",
                  (unsigned long long)length, (unsigned long long)least);
}
