/* What a name that is not known may mean. */
#include "core/engine/text/text.h"
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const char *name_at(const void *context, size_t k) { return ((const char *const *)context)[k]; }

static void the_nearest_name_is_a_few_letters_away(void **state) {
  (void)state;
  const char *const names[] = {"spins", "gravity", "drag", "springs", "c", "k", NULL};
  assert_string_equal(hk_nearest_name("gravty", name_at, names), "gravity");
  assert_string_equal(hk_nearest_name("sprigns", name_at, names), "springs"); /* swapped letters: one change */
  assert_string_equal(hk_nearest_name("Drag", name_at, names), "drag");
  assert_string_equal(hk_nearest_name("K", name_at, names), "k"); /* a capital is nearer than another letter */
  assert_null(hk_nearest_name("universe", name_at, names));
  assert_null(hk_nearest_name("z", name_at, names));                       /* no letter is the same */
  assert_string_equal(hk_nearest_name("grav", name_at, names), "gravity"); /* the beginning of it */
}

static void a_plural_is_told_from_other_words(void **state) {
  (void)state;
  const char *const names[] = {"courant", "cell", "cameras", NULL};
  assert_string_equal(hk_singular_name("cells", name_at, names), "cell");
  assert_null(hk_singular_name("cell", name_at, names));
  assert_null(hk_singular_name("camera", name_at, names)); /* which may stand for another */
  assert_null(hk_singular_name("", name_at, names));
}

static void a_synonym_is_the_first_of_its_names_that_there_is(void **state) {
  (void)state;
  const char *const names[] = {"grid", "membrane", "mesh", NULL}, *const fewer[] = {"membrane", NULL};
  const char *folder = test_folder();
  test_write("synonyms", "# cloth mesh\n\ncloth grid membrane\nhair strand -- as a mesh\nmass_spring nets mesh\n");
  assert_string_equal(hk_synonym(folder, "cloth", name_at, names), "grid");
  assert_string_equal(hk_synonym(folder, "cloth", name_at, fewer), "membrane");
  assert_string_equal(hk_synonym(folder, "Mass-Spring", name_at, names), "mesh");
  assert_string_equal(hk_synonym(folder, "mesh", name_at, names), "mesh");
  assert_null(hk_synonym(folder, "hair", name_at, names));
  assert_null(hk_synonym(folder, "#", name_at, names));
  assert_null(hk_synonym("no such folder", "cloth", name_at, names));
}

static void a_synonym_may_have_a_note(void **state) {
  (void)state;
  char note[32];
  test_write("synonyms", "hair strand -- as a mesh\nnet mesh\n");
  hk_synonym_note(test_folder(), "hair", note, sizeof note);
  assert_string_equal(note, " (as a mesh)");
  hk_synonym_note(test_folder(), "net", note, sizeof note);
  assert_string_equal(note, "");
  hk_synonym_note(test_folder(), "hai", note, sizeof note);
  assert_string_equal(note, "");
}

static void help_begins_with_whole_words(void **state) {
  (void)state;
  assert_true(hk_begins_with_words("stiffness of a spring", "stiffness"));
  assert_true(hk_begins_with_words("rest length; left out: the initial one", "rest_length"));
  assert_true(hk_begins_with_words("Rest length", "restLength") == false);
  assert_false(hk_begins_with_words("stiffness", "stiff"));
  assert_false(hk_begins_with_words("of the air", "of")); /* too short to mean something */
  assert_false(hk_begins_with_words("", "mass"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_nearest_name_is_a_few_letters_away),
      cmocka_unit_test(a_plural_is_told_from_other_words),
      cmocka_unit_test(a_synonym_is_the_first_of_its_names_that_there_is),
      cmocka_unit_test(a_synonym_may_have_a_note),
      cmocka_unit_test(help_begins_with_whole_words),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
