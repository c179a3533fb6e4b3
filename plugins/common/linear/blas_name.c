/* The file that dgemm_ comes from tells which BLAS is loaded, once its links are followed: systems put every BLAS
 * behind the name libblas.so.3, by alternatives (Debian, openSUSE) or by a link (Arch), and keep each in a folder or a
 * file called after it. FlexiBLAS (Fedora) is asked for its backend. Invariant: only a file called libblas or
 * librefblas in no other library's folder, or FlexiBLAS on NETLIB, counts as the reference BLAS. */
#define _GNU_SOURCE /* dladdr, RTLD_DEFAULT */
#include "plugins/common/linear/blas_name.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* How files and folders of a library begin, after "lib", and what people call it. */
static const struct {
  const char *begins, *name;
} libraries[] = {
    {"openblas", "OpenBLAS"}, {"mkl", "MKL"},      {"blis", "BLIS"}, {"atlas", "ATLAS"}, {"satlas", "ATLAS"},
    {"tatlas", "ATLAS"},      {"armpl", "Arm PL"}, {"nvpl", "NVPL"}, {"essl", "ESSL"},   {"flexiblas", "FlexiBLAS"},
};

static bool begins(const char *text, const char *with) { return strncasecmp(text, with, strlen(with)) == 0; }

/* The library that a file or folder of this name belongs to; NULL: none that is known. */
static const char *library_called(const char *part) {
  if (begins(part, "lib")) part += 3;
  for (size_t k = 0; k < sizeof libraries / sizeof *libraries; k++)
    if (begins(part, libraries[k].begins)) return libraries[k].name;
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
    blas->reference = begins(file, "libblas") || begins(file, "librefblas");
    snprintf(blas->name, sizeof blas->name, "%s", blas->reference ? "reference BLAS" : file);
  }
}

/* The function of that name, or NULL, into a pointer to functions: what dlsym gives is none in ISO C. */
static void find(const char *name, void *pointer) {
  void *found = dlsym(RTLD_DEFAULT, name);
  memcpy(pointer, &found, sizeof found);
}

/* "OpenBLAS 0.3.21" of what openblas_get_config says, which begins with it and goes on with how it was built. */
static void add_version(hk_blas *blas) {
  const char *(*config)(void);
  find("openblas_get_config", &config);
  if (!config || strcmp(blas->name, "OpenBLAS") != 0) return;
  const char *text = config();
  if (!begins(text, "OpenBLAS ")) return;
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
