/* The name of the BLAS: what the process has mapped, and what the paths of several systems say. */
#define _GNU_SOURCE /* RTLD_DEFAULT, strcasestr */
#include "plugins/common/linear/blas_name.h"

#include <dlfcn.h>
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cholmod.h>
#include <cmocka.h>

/* CHOLMOD and its BLAS are in this process because the test calls it. */
static void load_cholmod(void) {
  int version[3];
  assert_in_range(cholmod_l_version(version), 1, INT32_MAX);
}

/* The file that the kernel has mapped where dgemm_ is; it follows links when it opens one. */
static void mapped_at_dgemm(char *file, size_t size) {
  char line[4096];
  uintptr_t at = (uintptr_t)dlsym(RTLD_DEFAULT, "dgemm_"), begin, end;
  FILE *maps = fopen("/proc/self/maps", "r");
  assert_non_null(maps);
  assert_true(at != 0);
  *file = 0;
  while (fgets(line, sizeof line, maps))
    if (sscanf(line, "%" SCNxPTR "-%" SCNxPTR, &begin, &end) == 2 && begin <= at && at < end && strchr(line, '/'))
      snprintf(file, size, "%.*s", (int)strcspn(strchr(line, '/'), "\n"), strchr(line, '/'));
  fclose(maps);
}

static void the_file_of_the_blas_is_the_one_mapped_where_dgemm_is(void **state) {
  hk_blas blas;
  char file[4096];
  (void)state;
  load_cholmod();
  hk_blas_loaded(&blas);
  mapped_at_dgemm(file, sizeof file);
  assert_true(*file);
  assert_string_equal(blas.file, file);
}

static void the_name_is_that_of_the_library_mapped(void **state) {
  static const struct {
    const char *part, *name;
  } known[] = {{"flexiblas", "FlexiBLAS"}, {"openblas", "OpenBLAS"}, {"libmkl", "MKL"},
               {"blis", "BLIS"},           {"atlas", "ATLAS"},       {"/libblas", "reference BLAS"}};
  hk_blas blas;
  char file[4096];
  size_t k = 0;
  (void)state;
  load_cholmod();
  hk_blas_loaded(&blas);
  mapped_at_dgemm(file, sizeof file);
  while (k < 6 && !strcasestr(file, known[k].part)) k++;
  if (k == 6) skip(); /* a BLAS that this list does not have */
  assert_memory_equal(blas.name, known[k].name, strlen(known[k].name));
  if (k > 0) assert_int_equal(blas.reference, k == 5); /* FlexiBLAS: its backend decides */
}

static void an_openblas_is_named_with_its_version(void **state) {
  hk_blas blas;
  int major, minor;
  (void)state;
  load_cholmod();
  hk_blas_loaded(&blas);
  if (strncmp(blas.name, "OpenBLAS", 8) != 0) skip();
  assert_int_equal(sscanf(blas.name, "OpenBLAS %d.%d", &major, &minor), 2);
}

/* Files as the systems' packages install them, links followed. */
static const struct {
  const char *file, *backend, *name;
  bool reference;
} installed[] = {
    /* Debian 12, Ubuntu */
    {"/usr/lib/x86_64-linux-gnu/blas/libblas.so.3.11.0", NULL, "reference BLAS", true},
    {"/usr/lib/aarch64-linux-gnu/blas/libblas.so.3.12.0", NULL, "reference BLAS", true},
    {"/usr/lib/x86_64-linux-gnu/openblas-pthread/libblas.so.3", NULL, "OpenBLAS", false},
    {"/usr/lib/x86_64-linux-gnu/openblas-pthread/libopenblasp-r0.3.21.so", NULL, "OpenBLAS", false},
    {"/usr/lib/x86_64-linux-gnu/openblas-serial/libblas.so.3", NULL, "OpenBLAS", false},
    {"/usr/lib/x86_64-linux-gnu/blis-openmp/libblas.so.3", NULL, "BLIS", false},
    {"/usr/lib/x86_64-linux-gnu/atlas/libblas.so.3.10.3", NULL, "ATLAS", false},
    {"/usr/lib/x86_64-linux-gnu/libmkl_rt.so", NULL, "MKL", false},
    /* Fedora */
    {"/usr/lib64/libflexiblas.so.3.4", "OPENBLAS-OPENMP", "FlexiBLAS on a backend (OPENBLAS-OPENMP)", false},
    {"/usr/lib64/libflexiblas.so.3.4", "NETLIB", "FlexiBLAS on the reference BLAS (NETLIB)", true},
    {"/usr/lib64/libflexiblas.so.3.4", "__FALLBACK__", "FlexiBLAS on the reference BLAS (__FALLBACK__)", true},
    {"/usr/lib64/libblas.so.3.12.0", NULL, "reference BLAS", true},
    {"/usr/lib64/libopenblasp-r0.3.26.so", NULL, "OpenBLAS", false},
    {"/usr/lib64/atlas/libsatlas.so.3.10", NULL, "ATLAS", false},
    /* Arch */
    {"/usr/lib/libblas.so.3.12.0", NULL, "reference BLAS", true},
    {"/usr/lib/libopenblas.so.0.3", NULL, "OpenBLAS", false},
    /* openSUSE */
    {"/usr/lib64/blas/libblas.so.3.9.0", NULL, "reference BLAS", true},
    {"/usr/lib64/openblas-pthreads/libblas.so.3", NULL, "OpenBLAS", false},
    {"/usr/lib64/libopenblas_pthreads.so.0.3", NULL, "OpenBLAS", false},
    /* elsewhere */
    {"/opt/intel/oneapi/mkl/2024.0/lib/libmkl_rt.so.2", NULL, "MKL", false},
    {"/opt/arm/lib/libarmpl_lp64.so", NULL, "Arm PL", false},
    {"/home/publisher/lib/libblas.so.3", NULL, "reference BLAS", true}, /* "blis" inside a word is no name */
    {"/opt/openblas/reference/libblas.so.3", NULL, "reference BLAS", true},
    {"/opt/fast/libvendor.so.1", NULL, "libvendor.so.1", false},
    {"libblas.so.3", NULL, "reference BLAS", true},
};

static void the_file_of_a_blas_says_whether_it_is_the_reference_one(void **state) {
  hk_blas blas;
  (void)state;
  for (size_t k = 0; k < sizeof installed / sizeof *installed; k++) {
    hk_blas_judge(&blas, installed[k].file, installed[k].backend);
    if (strcmp(blas.name, installed[k].name) != 0 || blas.reference != installed[k].reference)
      fail_msg("%s: '%s'%s", installed[k].file, blas.name, blas.reference ? ", reference" : "");
    assert_string_equal(blas.file, installed[k].file);
  }
}

static void a_description_has_the_library_and_its_blas(void **state) {
  hk_blas blas;
  char text[160], expected[160], cut[8];
  (void)state;
  load_cholmod();
  hk_blas_loaded(&blas);
  hk_blas_describe("LIBRARY 1.2", text, sizeof text);
  snprintf(expected, sizeof expected, "LIBRARY 1.2, %s", blas.name);
  assert_memory_equal(text, expected, strlen(expected));
  assert_int_equal(strstr(text, "install OpenBLAS") != NULL, blas.reference);
  hk_blas_describe("LIBRARY 1.2", cut, sizeof cut);
  assert_string_equal(cut, "LIBRARY"); /* a short buffer is filled and ends */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_file_of_the_blas_is_the_one_mapped_where_dgemm_is),
      cmocka_unit_test(the_name_is_that_of_the_library_mapped),
      cmocka_unit_test(an_openblas_is_named_with_its_version),
      cmocka_unit_test(the_file_of_a_blas_says_whether_it_is_the_reference_one),
      cmocka_unit_test(a_description_has_the_library_and_its_blas),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
