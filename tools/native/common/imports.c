/* A shared object calls functions of other ones through a table of addresses, which its relocations name. The addresses
 * of the heap's functions are replaced there by those of the functions below, those of files and clocks by those of
 * outside.h. */
#define _GNU_SOURCE 1
#include "tools/native/common/imports.h"
#include "tools/native/common/outside.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static struct {
  atomic_size_t allocated, freed;
  unsigned char fill;
} heap = {.fill = 0xa5};

static void *filled(void *memory, size_t bytes) {
  atomic_fetch_add(&heap.allocated, 1);
  if (memory) memset(memory, heap.fill, bytes);
  return memory;
}

static void *our_malloc(size_t bytes) { return filled(malloc(bytes), bytes); }

static void *our_aligned_alloc(size_t alignment, size_t bytes) {
  return filled(aligned_alloc(alignment, bytes), bytes);
}

static int our_posix_memalign(void **memory, size_t alignment, size_t bytes) {
  int failed = posix_memalign(memory, alignment, bytes);
  if (!failed) filled(*memory, bytes);
  return failed;
}

static void *our_calloc(size_t count, size_t bytes) {
  atomic_fetch_add(&heap.allocated, 1);
  return calloc(count, bytes);
}

static void *our_realloc(void *memory, size_t bytes) {
  if (!memory) return our_malloc(bytes);
  return realloc(memory, bytes);
}

static void *our_reallocarray(void *memory, size_t count, size_t bytes) {
  if (!memory) return our_calloc(count, bytes);
  return reallocarray(memory, count, bytes);
}

static char *our_strdup(const char *text) {
  atomic_fetch_add(&heap.allocated, 1);
  return strdup(text);
}

static char *our_strndup(const char *text, size_t most) {
  atomic_fetch_add(&heap.allocated, 1);
  return strndup(text, most);
}

static void our_free(void *memory) {
  if (memory) atomic_fetch_add(&heap.freed, 1);
  free(memory);
}

void hk_imports_fill(unsigned char byte) { heap.fill = byte; }

hk_heap hk_imports_heap(void) { return (hk_heap){atomic_load(&heap.allocated), atomic_load(&heap.freed)}; }

#if defined(__linux__) && defined(__LP64__)
#include <elf.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

static const hk_import heap_calls[] = {{"malloc", (uintptr_t)our_malloc},
                                       {"calloc", (uintptr_t)our_calloc},
                                       {"realloc", (uintptr_t)our_realloc},
                                       {"reallocarray", (uintptr_t)our_reallocarray},
                                       {"aligned_alloc", (uintptr_t)our_aligned_alloc},
                                       {"posix_memalign", (uintptr_t)our_posix_memalign},
                                       {"strdup", (uintptr_t)our_strdup},
                                       {"strndup", (uintptr_t)our_strndup},
                                       {"free", (uintptr_t)our_free},
                                       {NULL, 0}};

typedef struct object {
  uintptr_t inside, base;
  const ElfW(Dyn) * dynamic;
} object;

static int find_object(struct dl_phdr_info *info, size_t size, void *context) {
  object *o = context;
  const ElfW(Dyn) *dynamic = NULL;
  bool contains = false;
  (void)size;
  for (size_t k = 0; k < info->dlpi_phnum; k++) {
    const ElfW(Phdr) *part = &info->dlpi_phdr[k];
    uintptr_t begin = info->dlpi_addr + part->p_vaddr;
    if (part->p_type == PT_DYNAMIC) dynamic = (const ElfW(Dyn) *)begin;
    if (part->p_type == PT_LOAD && o->inside >= begin && o->inside < begin + part->p_memsz) contains = true;
  }
  if (contains) *o = (object){o->inside, info->dlpi_addr, dynamic};
  return contains && dynamic;
}

static void replace(uintptr_t slot, uintptr_t function) {
  uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), begin = slot / page * page;
  if (mprotect((void *)begin, slot + sizeof function - begin, PROT_READ | PROT_WRITE) == 0)
    *(uintptr_t *)slot = function;
}

/* The function that stands for that one; 0: none does. */
static uintptr_t ours(const char *name) {
  static const hk_import *const lists[] = {heap_calls, hk_outside_calls};
  for (size_t l = 0; l < sizeof lists / sizeof *lists; l++)
    for (const hk_import *f = lists[l]; f->name; f++)
      if (strcmp(name, f->name) == 0) return f->function;
  return 0;
}

static void look_through(const object *o, const ElfW(Rela) * list, size_t bytes, const ElfW(Sym) * symbol,
                         const char *text) {
  for (size_t k = 0; list && k < bytes / sizeof *list; k++) {
    uintptr_t function = ELF64_R_SYM(list[k].r_info) ? ours(text + symbol[ELF64_R_SYM(list[k].r_info)].st_name) : 0;
    if (function) replace(o->base + list[k].r_offset, function);
  }
}

bool hk_imports_watch(const void *inside) {
  object o = {(uintptr_t)inside, 0, NULL};
  const ElfW(Sym) *symbol = NULL;
  const ElfW(Rela) *by_jump = NULL, *others = NULL;
  const char *text = NULL;
  size_t jump_bytes = 0, other_bytes = 0;
  if (!dl_iterate_phdr(find_object, &o)) return false;
  for (const ElfW(Dyn) *d = o.dynamic; d->d_tag != DT_NULL; d++) {
    if (d->d_tag == DT_SYMTAB) symbol = (const ElfW(Sym) *)d->d_un.d_ptr;
    if (d->d_tag == DT_STRTAB) text = (const char *)d->d_un.d_ptr;
    if (d->d_tag == DT_JMPREL) by_jump = (const ElfW(Rela) *)d->d_un.d_ptr;
    if (d->d_tag == DT_PLTRELSZ) jump_bytes = d->d_un.d_val;
    if (d->d_tag == DT_RELA) others = (const ElfW(Rela) *)d->d_un.d_ptr;
    if (d->d_tag == DT_RELASZ) other_bytes = d->d_un.d_val;
  }
  if (!symbol || !text) return false;
  look_through(&o, by_jump, jump_bytes, symbol, text);
  look_through(&o, others, other_bytes, symbol, text);
  return true;
}
#else
bool hk_imports_watch(const void *inside) {
  (void)inside;
  return false;
}
#endif
