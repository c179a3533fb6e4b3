/* The file that contains dgemm_ identifies the loaded BLAS after its links are resolved: systems provide every BLAS
 * under the name libblas.so.3, by alternatives (Debian, openSUSE) or by a link (Arch), and store each in a folder or a
 * file with its own name. FlexiBLAS (Fedora) reports its backend. Invariant: only a file called libblas or librefblas
 * in no other library's folder, or FlexiBLAS on NETLIB, counts as the reference BLAS. */
#define _GNU_SOURCE /* dladdr, RTLD_DEFAULT */
#include "plugins/common/linear/blas_name.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The beginning of the names of a library's files and folders, after "lib", and its usual name. */
static const struct {
  const char *begins_with, *name;
} libraries[] = {
    {"openblas", "OpenBLAS"}, {"mkl", "MKL"},      {"blis", "BLIS"}, {"atlas", "ATLAS"}, {"satlas", "ATLAS"},
    {"tatlas", "ATLAS"},      {"armpl", "Arm PL"}, {"nvpl", "NVPL"}, {"essl", "ESSL"},   {"flexiblas", "FlexiBLAS"},
};

static bool begins_with(const char *text, const char *with) { return strncasecmp(text, with, strlen(with)) == 0; }

/* The library that a file or folder of this name belongs to; NULL: unknown. */
static const char *library_called(const char *part) {
  if (begins_with(part, "lib")) part += 3;
  for (size_t k = 0; k < sizeof libraries / sizeof *libraries; k++)
    if (begins_with(part, libraries[k].begins_with)) return libraries[k].name;
  return NULL;
}

/* The last folder of the path: begins after the slash before the last. */
static const char *last_folder(const char *path, const char *file) {
  const char *at = file > path ? file - 1 : path;
  while (at > path && at[-1] != '/') at--;
  return at;
}

void hk_blas_judge(hk_blas *blas, const char *path, const char *backend) {
  const char *slash = strrchr(path, '/'), *file = slash ? slash + 1 : path;
  const char *name = library_called(file);
  *blas = (hk_blas){.reference = false};
  snprintf(blas->file, sizeof blas->file, "%s", path);
  if (!name) name = library_called(last_folder(path, file));
  if (name && backend) {
    blas->reference = strcasestr(backend, "netlib") || strcasestr(backend, "fallback");
    snprintf(blas->name, sizeof blas->name, "%s on %s (%s)", name, blas->reference ? "the reference BLAS" : "a backend",
             backend);
  } else if (name) {
    snprintf(blas->name, sizeof blas->name, "%s", name);
  } else {
    blas->reference = begins_with(file, "libblas") || begins_with(file, "librefblas");
    snprintf(blas->name, sizeof blas->name, "%s", blas->reference ? "reference BLAS" : file);
  }
}

/* Stores the function of that name, or NULL, in a pointer to a function; ISO C does not convert the void * of dlsym. */
static void find(const char *name, void *pointer) {
  void *found = dlsym(RTLD_DEFAULT, name);
  memcpy(pointer, &found, sizeof found);
}

/* Takes "OpenBLAS 0.3.21" from the text of openblas_get_config, which begins with it and continues with build
 * options. */
static void add_version(hk_blas *blas) {
  const char *(*config)(void);
  find("openblas_get_config", &config);
  if (!config || strcmp(blas->name, "OpenBLAS") != 0) return;
  const char *text = config();
  if (!begins_with(text, "OpenBLAS ")) return;
  snprintf(blas->name, sizeof blas->name, "OpenBLAS %.*s", (int)strcspn(text + 9, " "), text + 9);
}

void hk_blas_loaded(hk_blas *blas) {
  void *dgemm = dlsym(RTLD_DEFAULT, "dgemm_");
  int (*flexiblas_backend)(char *name, size_t size);
  char backend[64] = "", path[PATH_MAX];
  Dl_info info = {0};
  if (!dgemm || !dladdr(dgemm, &info) || !info.dli_fname) {
    *blas = (hk_blas){.name = "a BLAS that cannot be found"};
    return;
  }
  find("flexiblas_current_backend", &flexiblas_backend);
  if (flexiblas_backend) flexiblas_backend(backend, sizeof backend);
  hk_blas_judge(blas, realpath(info.dli_fname, path) ? path : info.dli_fname, *backend ? backend : NULL);
  add_version(blas);
}

void hk_blas_describe(const char *library, char *text, size_t size) {
  hk_blas blas;
  hk_blas_loaded(&blas);
  snprintf(text, size, "%s, %s%s", library, blas.name, blas.reference ? " (slow: install OpenBLAS)" : "");
}

void hk_blas_warn(const hk_host *host, const char *library) {
  hk_blas blas;
  hk_blas_loaded(&blas);
  if (!blas.reference) return;
  host->warn(
      host,
      "%s runs on the reference BLAS (%s), on which large factorizations take 3 to 4 times as long: "
      "tools/install-deps run installs OpenBLAS, which is the package libopenblas0-pthread of Debian and Ubuntu, "
      "flexiblas-openblas-openmp of Fedora, blas-openblas of Arch, libopenblas_pthreads0 of openSUSE",
      library, blas.file);
}
